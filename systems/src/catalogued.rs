//! What every system of this crate has beside its description.

use coadjoint::__private::Geometry;
use coadjoint::prelude::*;
use coadjoint::system::Schemes;
use coadjoint::{Discretized, System};

/// A system with what the program needs to show it.
///
/// The program offers what was generated: descriptions ask for `methods(Midpoint)`.
pub trait Catalogued:
    System<Scalar = f64>
    + Geometry
    + Schemes
    + Discretized<Exponential>
    + Discretized<Cayley>
    + Send
    + Sync
    + 'static
{
    /// What it is, in one line, without a full stop.
    const ABOUT: &'static str;
    /// A step that suits the example, s.
    const STEP: f64;
    /// A duration that suits the example, s.
    const DURATION: f64;
    /// A step that suits the certificates, s, where the motion at the example's states does not show how fast or slow the system can be.
    const CERTIFIED_STEP: Option<f64> = None;
    /// The units of [`System::CASIMIRS`], in their order; empty for a pure number.
    const CASIMIR_UNITS: &'static [&'static str];

    /// Parameters and an initial state worth looking at.
    fn example() -> (Self, Self::State);

    /// The system's own control law: what is held over the step that starts from this state at this time. All zeros unless it says
    /// otherwise.
    fn control(&self, _state: &Self::State, _time: f64) -> Self::Control {
        Self::Control::default()
    }

    /// The moment of inertia, if the system is a body of mass: not every positive definite matrix belongs to one.
    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        None
    }
}
