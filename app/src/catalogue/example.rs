//! The example of a system: all that the program needs beside the system's description.

use coadjoint::System;
use coadjoint::derivative::LinearizedSchemes;
use coadjoint::prelude::*;
use coadjoint::system::{Geometry, Schemes};

use super::scene::Scene;

/// A system with an example: all that the program needs beside what `#[lie_poisson_system]` generates.
///
/// Only [`example`](Self::example) has to be given.
pub trait Example:
    System<Scalar = f64> + Geometry + Schemes + LinearizedSchemes + Send + Sync + 'static
{
    /// A description in one line, without a full stop.
    const ABOUT: &'static str = "";
    /// A step that suits the example, s.
    const STEP: f64 = 0.01;
    /// A duration that suits the example, s.
    const DURATION: f64 = 10.0;
    /// A step that suits the certificates, s, where the motion at the example's states does not show how fast or slow
    /// the system can be.
    const CERTIFIED_STEP: Option<f64> = None;
    /// The unit of its energy.
    const ENERGY_UNIT: &'static str = "J";
    /// The units of its [Casimirs](System::CASIMIRS), in their order.
    ///
    /// Empty for pure numbers; no units at all where none are known.
    const CASIMIR_UNITS: &'static [&'static str] = &[];

    /// Parameters and an initial state worth looking at.
    fn example() -> (Self, Self::State);

    /// The system's own control law: what is held over the step that starts from this state at this time. All zeros
    /// unless it says otherwise.
    fn control(&self, _state: &Self::State, _time: f64) -> Self::Control {
        Self::Control::default()
    }

    /// Lists quantities of its own, which tables, plots, pages and ensembles show beside the state.
    ///
    /// `own.with("height", "m", |pendulum, state, _time, _control| -pendulum.length * state.angle.cos_angle())`
    fn observables(own: Observables<Self>) -> Observables<Self> {
        own
    }

    /// The moment of inertia, if the system is a body of mass: not every positive definite matrix belongs to one.
    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        None
    }

    /// Builds its scene from the one by its state: a body for each configuration and arrows for momenta and
    /// advected vectors, with what only the system knows.
    fn scene(&self, by_state: Scene) -> Scene {
        by_state
    }

    /// The system as the program lists it: under its own name, `heavy_top` for `HeavyTop`.
    #[cfg(feature = "program")]
    fn entry() -> super::Entry {
        super::Entry::of::<Self>()
    }
}

/// A function of a system, its state, the time and the controls.
type ObservableFn<S> = dyn Fn(&S, &<S as System>::State, f64, &<S as System>::Control) -> f64 + Send + Sync;

/// Quantities of a system's own: [`Example::observables`].
#[must_use]
pub struct Observables<S: System>(pub(crate) Vec<(&'static str, &'static str, Box<ObservableFn<S>>)>);

impl<S: System> Observables<S> {
    /// Adds a quantity of this name, unit and value, by the system, its state, the time and the controls. The name is
    /// that of a column, as `pointing_error`; the unit of a pure number is empty.
    pub fn with(
        mut self,
        name: &'static str,
        unit: &'static str,
        value: impl Fn(&S, &S::State, f64, &S::Control) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.0.push((name, unit, Box::new(value)));
        self
    }
}

impl<S: System> Default for Observables<S> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<S: System> std::fmt::Debug for Observables<S> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.0.iter().map(|(name, unit, _)| (name, unit))).finish()
    }
}
