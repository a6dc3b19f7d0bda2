//! Systems and steppers whose types are erased: parameters, states and controls are flat lists of `f64`, and systems and schemes are chosen
//! while the program runs.
//!
//! What stands here is compiled once, in this crate, for all systems and schemes: the stepper, the run, compositions, certificates and the
//! members of ensembles. What is left for each system is its arithmetic behind one function table. A program for any system is built on this;
//! where the system is known, a [`Stepper`](crate::Stepper) has the same steps, to the last bit, and takes less for each call.
//!
//! ```
//! use coadjoint::erased;
//! use coadjoint::prelude::*;
//! use std::sync::Arc;
//!
//! #[lie_poisson_system(group = SO3)]
//! struct Body {
//!     #[inertia]
//!     inertia: Vector3<f64>,
//! }
//!
//! let body: Arc<dyn erased::System> = Arc::new(Body { inertia: vector![1.0, 2.0, 2.5] });
//! assert_eq!(body.parameters(), [1.0, 2.0, 2.5]);
//! // attitude (w, x, y, z) and momentum
//! let mut state = [1.0, 0.0, 0.0, 0.0, 0.4, -0.8, 1.5];
//! let energy = body.energy(&state, 0.0, &[]);
//! let mut stepper = erased::Stepper::new(body.clone(), &"Cayley".parse()?, 0.01)?;
//! let report = stepper.steps(&mut state, &[], 10_000)?;
//! assert_eq!((report.steps, stepper.time()), (10_000, 100.0));
//! assert!((body.energy(&state, 0.0, &[]) - energy).abs() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adaptive;
mod composition;
#[cfg(feature = "dynamic")]
#[doc(hidden)]
pub mod dynamic;
mod ensemble;
mod equation;
mod field;
mod jacobian;
mod stepper;
mod system;
mod trial;

pub use crate::ensemble::members::{MemberInput, MemberLaw};
pub use crate::flat::NotGenerated;
#[doc(hidden)]
pub use crate::flat::{Flat, Method};
pub use crate::retraction::RetractionKind;
pub use crate::system::Description;
pub use adaptive::Adaptive;
#[doc(hidden)]
pub use adaptive::TaylorSteps;
pub use ensemble::Ensemble;
#[doc(hidden)]
pub use equation::{Equation, Program};
#[doc(hidden)]
pub use jacobian::Linearization;
pub use jacobian::{Jacobian, JacobianError};
pub use stepper::{Stepper, StepperError};
pub use system::{At, EnsembleSystem, System};
#[doc(hidden)]
pub use trial::{Solved, Trial, Units, units};

pub(crate) use crate::flat::array;
pub(crate) use composition::method;
pub(crate) use equation::equation;
pub(crate) use system::{Geometry, check};
