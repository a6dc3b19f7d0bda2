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

pub use crate::crossing::{Crossing, Event};
pub use occurrence::Occurrence;
pub(crate) use occurrence::{Moment, SetParameters};
#[doc(hidden)]
pub use within::{Condition, Described, Samples, Watched, Within};
