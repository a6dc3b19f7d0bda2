//! The systems of a program, their types erased.

pub(crate) mod casimir;
mod entry;
mod input;
mod observable;
pub(crate) mod plotted;
pub(crate) mod quantities;
pub mod suggest;

use std::sync::{Arc, OnceLock};

#[cfg(feature = "description")]
pub(crate) use entry::snake_case;
pub use entry::{BuildFn, ControlLaw, Entry, Setup};
pub use input::{Input, Interpolation};
pub use observable::Observable;
pub use quantities::{component_name, component_unit, unit};

use crate::error::SetupError;

/// The program that has the systems, and its version: what it writes names them.
static PROGRAM: OnceLock<[&str; 2]> = OnceLock::new();

/// Names the program and its version.
pub(crate) fn program() -> [&'static str; 2] {
    *PROGRAM.get().unwrap_or(&["coadjoint", env!("CARGO_PKG_VERSION")])
}

/// Sets the name of the program and its version, once.
pub(crate) fn set_program(name: &'static str, version: &'static str) {
    let _ = PROGRAM.set([name, version]);
}

/// The systems of a program, in the order in which they are listed.
#[derive(Clone, Debug)]
pub struct Catalogue(Arc<[Entry]>);

impl Catalogue {
    /// Collects systems.
    pub fn new(entries: impl IntoIterator<Item = Entry>) -> Self {
        Self(entries.into_iter().collect())
    }

    /// The same with one more system in the first place; it takes that of another of its name.
    pub fn with(&self, entry: Entry) -> Self {
        let others = self.0.iter().filter(|other| other.name != entry.name).cloned();
        Self(std::iter::once(entry.clone()).chain(others).collect())
    }

    /// Lists all systems.
    pub fn entries(&self) -> &[Entry] {
        &self.0
    }

    /// Finds the system of this name; `heavy-top` and `HeavyTop` find `heavy_top` too.
    pub fn find(&self, name: &str) -> Option<&Entry> {
        let plain = |name: &str| name.to_lowercase().replace(['_', '-', ' '], "");
        self.0.iter().find(|entry| plain(&entry.name) == plain(name))
    }

    /// Finds the system of this name.
    ///
    /// # Errors
    /// If there is none; the message names one that is near.
    pub fn system(&self, name: &str) -> Result<&Entry, SetupError> {
        self.find(name).ok_or_else(|| {
            let hint = suggest::did_you_mean(name, self.0.iter().map(|entry| entry.name.as_str()));
            SetupError::new(format!("there is no system `{name}`{hint} (`list` shows all)"))
        })
    }

    /// Erases the type of one of the systems: its steps are compiled with the catalogue, and not again for the caller.
    ///
    /// # Errors
    /// If it is not among them.
    pub fn erased<S: coadjoint::System<Scalar = f64>>(
        &self,
        system: &S,
    ) -> Result<Arc<dyn coadjoint::erased::System>, SetupError> {
        Ok(self.system(S::NAME)?.system(system.to_parameters().as_ref()))
    }
}
