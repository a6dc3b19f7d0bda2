//! Descriptions of systems, as values.

use super::{Control, Quantity, Side, State, System};
use crate::crossing::Event;

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
    /// The events: their names, and which of their zeros count.
    pub events: &'static [(&'static str, Event)],
    /// On which side of the configuration velocities and momenta are taken: [`SIDE`](crate::System::SIDE).
    pub side: Side,
}

impl Description {
    /// Describes a system that is made at run time: its name, its parameters, state and controls, its Casimirs, on which side of the configuration
    /// its velocities are, and whether it is autonomous, invariant, forced and piecewise.
    #[cfg(feature = "dynamic")]
    pub(crate) fn dynamic(
        name: &'static str,
        [parameters, state, controls]: [&'static [Quantity]; 3],
        casimirs: &'static [&'static str],
        side: Side,
        [autonomous, invariant, forced, piecewise]: [bool; 4],
    ) -> Self {
        let events = &[];
        Self {
            name,
            parameters,
            state,
            controls,
            casimirs,
            autonomous,
            invariant,
            forced,
            piecewise,
            events,
            side,
        }
    }

    /// The same with these events.
    #[cfg(feature = "dynamic")]
    pub(crate) fn with_events(self, events: &'static [(&'static str, Event)]) -> Self {
        Self { events, ..self }
    }

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
            events: S::EVENTS,
            side: S::SIDE,
        }
    }
}
