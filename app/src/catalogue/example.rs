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
