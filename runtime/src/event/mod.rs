//! Events: the moments at which a quantity of state and time is zero.
//!
//! [`Run::event`](crate::Run::event) adds one to a run. What is watched is a function of state and time; how it is watched says an [`Event`]; what is
//! to happen says a function that is given the [`Occurrence`].
//!
//! ```
//! use coadjoint::prelude::*;
//! use coadjoint::{Event, Run};
//!
//! /// A ball above a table.
//! #[lie_poisson_system(group = R1, potential = mass * gravity * position.x)]
//! struct Ball {
//!     #[inertia]
//!     mass: f64,
//!     gravity: f64,
//! }
//!
//! let mut state = BallState { position: vector![1.25], momentum: vector![0.0] };
//! let mut stepper = Ball { mass: 0.1, gravity: 10.0 }.stepper::<Exponential>(0.03)?;
//! let mut bounces = Vec::new();
//! Run::new(&mut stepper, &mut state)
//!     .event(Event::falling(), |state, _| state.position.x, |bounce| {
//!         bounces.push(bounce.time());
//!         bounce.state_mut().momentum *= -0.8;
//!     })
//!     .to(3.0)?;
//! // it falls for half a second, and is in the air for as long as it falls and rises again
//! assert!((bounces[0] - 0.5).abs() < 1e-15 && (bounces[1] - 1.3).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The guide has [more on events](crate::guide::events).

mod occurrence;
pub(crate) mod roots;
pub(crate) mod search;
mod tracker;
pub(crate) mod within;

pub use occurrence::Occurrence;
pub(crate) use occurrence::{Moment, SetParameters};
#[doc(hidden)]
pub use within::{Samples, Watched, Within};

/// How a quantity meets zero, in the direction of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// From below to above.
    Rising,
    /// From above to below.
    Falling,
    /// It touches zero but for rounding, and does not change its sign.
    Touch,
}

/// How a quantity is watched: which zeros count, whether they end the run, and how closely one looks.
///
/// A zero is found where values of different signs are seen. They are looked at where steps end, and where the parabola through the last of these does
/// not tell that there is one zero or none in between, at four points within the step. Whatever has two zeros between two of these points, and at
/// them no dip towards zero, can be missed: [`points`](Self::points) says how many to look at in every step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use = "`Run::event` watches it"]
pub struct Event {
    only: Option<Crossing>,
    is_terminal: bool,
    points: Option<u32>,
}

impl Event {
    /// Every zero counts, also where the quantity touches zero and does not change its sign.
    pub const fn any() -> Self {
        Self { only: None, is_terminal: false, points: None }
    }

    /// Zeros count that the quantity passes from below to above, in the direction of the run.
    pub const fn rising() -> Self {
        Self { only: Some(Crossing::Rising), ..Self::any() }
    }

    /// Zeros count that the quantity passes from above to below, in the direction of the run.
    pub const fn falling() -> Self {
        Self { only: Some(Crossing::Falling), ..Self::any() }
    }

    /// The run ends at the first of them: state and stepper are then at that moment, and a next run goes on from there.
    pub const fn terminal(self) -> Self {
        Self { is_terminal: true, ..self }
    }

    /// Looks at so many points within every step, evenly spaced, whatever the values at its ends; 0 for the ends alone, 64 at most. To look at
    /// one of them takes as long as a step from a new state.
    pub const fn points(self, points: u32) -> Self {
        let points = if points > MOST_POINTS { MOST_POINTS } else { points };
        Self { points: Some(points), ..self }
    }

    fn counts(&self, crossing: Crossing) -> bool {
        self.only.is_none_or(|only| only == crossing)
    }
}

/// Points within a step, at most.
const MOST_POINTS: u32 = 64;
