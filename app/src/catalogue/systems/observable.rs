//! Numbers that are shown beside a state.

use std::fmt;
use std::sync::Arc;

use coadjoint::erased;

/// Evaluates a number of a system in a state, at a time and with controls.
type ObservableFn = dyn Fn(&dyn erased::System, &[f64], f64, &[f64]) -> f64 + Send + Sync;

/// A number of a system in a state, with its name and its unit.
#[derive(Clone)]
pub struct Observable {
    /// Its name.
    pub name: String,
    /// Its unit, empty for a pure number.
    pub unit: String,
    of: Arc<ObservableFn>,
}

impl Observable {
    /// Names what is evaluated: of a system in a state, at a time and with controls.
    pub fn new(
        name: &str,
        unit: String,
        of: impl Fn(&dyn erased::System, &[f64], f64, &[f64]) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.to_owned(), unit, of: Arc::new(of) }
    }

    /// Evaluates it.
    pub fn value(&self, system: &dyn erased::System, state: &[f64], time: f64, control: &[f64]) -> f64 {
        (self.of)(system, state, time, control)
    }
}

impl fmt::Debug for Observable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Observable")
            .field("name", &self.name)
            .field("unit", &self.unit)
            .finish_non_exhaustive()
    }
}
