//! Descriptions of systems, as values.

use super::{Control, Quantity, Side, State, System};

/// Describes a system, but for its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Description {
    /// The struct's name.
    pub name: &'static str,
    /// The parameters; constants of the description follow them in lists of numbers.
    pub parameters: &'static [Quantity],
    /// What the state consists of.
    pub state: &'static [Quantity],
    /// The controls.
    pub controls: &'static [Quantity],
    /// The names of the Casimirs.
    pub casimirs: &'static [&'static str],
    /// Whether energy is an invariant of the motion: [`AUTONOMOUS`](crate::System::AUTONOMOUS).
    pub autonomous: bool,
    /// Whether momentum and advected parameters alone have a part in the motion: [`INVARIANT`](crate::System::INVARIANT).
    pub invariant: bool,
    /// Whether a force acts: [`FORCED`](crate::System::FORCED).
    pub forced: bool,
    /// Whether energy or forces are written piece by piece: [`PIECEWISE`](crate::System::PIECEWISE).
    pub piecewise: bool,
    /// On which side of the configuration velocities and momenta are taken: [`SIDE`](crate::System::SIDE).
    pub side: Side,
}

impl Description {
    /// Describes the system `S`.
    pub const fn of<S: System>() -> Self {
        Self {
            name: S::NAME,
            parameters: S::PARAMETERS,
            state: S::State::QUANTITIES,
            controls: S::Control::QUANTITIES,
            casimirs: S::CASIMIRS,
            autonomous: S::AUTONOMOUS,
            invariant: S::INVARIANT,
            forced: S::FORCED,
            piecewise: S::PIECEWISE,
            side: S::SIDE,
        }
    }
}
