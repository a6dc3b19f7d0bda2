//! Structure-preserving steppers for mechanics on Lie groups.
//!
//! Describe a rigid body, a spacecraft or a quadrotor as a struct with [`lie_poisson_system`]: its group, inertia, potential and forces. The
//! macro derives the equations and writes an integrator for exactly that system. It keeps momentum, Casimirs and attitude to rounding.
//! This crate holds what all integrators share: states, solving, errors, runs and observers.
//!
//! ```
//! use coadjoint::prelude::*;
//!
//! /// A rigid body that turns about a fixed point under gravity.
//! #[lie_poisson_system(
//!     group = SO3,
//!     advected(gamma: R3),                      // the vertical, seen from the body
//!     potential = weight * gamma.dot(&chi),
//! )]
//! #[derive(Clone, Debug, PartialEq)]
//! pub struct HeavyTop {
//!     /// Principal moments of inertia about the fixed point, kg m².
//!     #[inertia]
//!     pub inertia: Vector3<f64>,
//!     /// Mass times gravity, N.
//!     pub weight: f64,
//!     /// From the fixed point to the centre of mass, body frame, m.
//!     pub chi: Vector3<f64>,
//! }
//!
//! let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
//! let mut state = HeavyTopState {
//!     attitude: UnitQuaternion::identity(),
//!     momentum: vector![1.0, 1.0, 1.0],
//!     gamma: Vector3::z(),
//! };
//! let before = top.energy(&state);
//! let mut stepper = top.stepper::<Cayley>(0.01)?;
//! for _ in 0..1_000 {
//!     stepper.step(&mut state)?;
//! }
//! assert!((top.energy(&state) - before).abs() < 1e-3);
//! assert!((state.gamma.norm() - 1.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The [guide] has one page for each question. The [prelude] has what a description and its first steps need; import the rest by name.
//!
//! # Features
//!
//! - `std`, on by default: runs that record, ensembles, certificates, systems whose types are erased. Steps need none of them.
//! - `parallel`: ensembles on all cores, by rayon. Without it on one, with the same digits.
//! - `serde`: states, controls and certificates, and nalgebra's types in fields, have serde's traits;
//!   [how](guide::storing).
//!
//! Conventions: attitudes turn body coordinates into space coordinates, `momentum` and `advected` quantities
//! are in body coordinates, units are the user's (SI throughout our own systems).
#![cfg_attr(not(feature = "std"), no_std)]
// on docs.rs, items say which feature they need
#![cfg_attr(docsrs, feature(doc_cfg))]

// The macro writes `::coadjoint::…`; this lets it be used inside this crate's own documentation and tests.
extern crate self as coadjoint;

mod bytecode;
#[cfg(feature = "std")]
pub mod certify;
mod clamp;
#[cfg(feature = "std")]
mod compensated;
pub mod composition;
mod crossing;
pub mod derivative;
#[cfg(feature = "std")]
mod double;
#[cfg(feature = "std")]
pub mod ensemble;
#[cfg(feature = "std")]
pub mod erased;
pub mod error;
pub mod event;
#[cfg(feature = "std")]
mod flat;
#[cfg(feature = "std")]
mod fused;
#[cfg(feature = "std")]
pub mod guide;
mod inertia;
mod interval;
mod kernel;
mod legendre;
mod literals;
mod method;
pub mod observe;
pub mod prelude;
mod retraction;
pub mod run;
mod scalar;
pub mod scheme;
#[cfg(feature = "std")]
mod schemes;
mod serialization;
mod snapshot;
mod solve;
mod spline;
pub mod stepper;
pub mod system;
pub mod taylor;
#[cfg(all(test, feature = "std"))]
mod tests;
mod tick;

#[cfg(feature = "std")]
pub use certify::certify;
/// Functions of your own in expressions: `#[expression]` above one, and descriptions in the same crate may call it.
///
/// ```
/// use coadjoint::prelude::*;
///
/// mod air {
///     use coadjoint::prelude::*;
///
///     pub(super) const SCALE: f64 = 8_500.0;
///
///     /// Density at a height.
///     #[expression]
///     pub fn density(sea_level: f64, height: f64) -> f64 {
///         sea_level * (-height.max(0.0) / SCALE).exp()
///     }
///
///     /// Drag of a shape with this product of area and coefficient.
///     #[expression]
///     pub fn drag(area: f64, sea_level: f64, position: &Vector3<f64>, velocity: &Vector3<f64>) -> Vector3<f64> {
///         -0.5 * density(sea_level, position.z) * area * velocity.norm() * velocity
///     }
/// }
///
/// #[lie_poisson_system(
///     group = R3,
///     potential = mass * gravity * position.z,
///     force = air::drag(area, sea_level, &position, &velocity),
///     derivatives(parameters),
/// )]
/// struct Shell {
///     #[inertia]
///     mass: f64,
///     gravity: f64,
///     area: f64,
///     sea_level: f64,
/// }
///
/// let shell = Shell { mass: 40.0, gravity: 9.81, area: 0.005, sea_level: 1.225 };
/// let mut state = ShellState { position: Vector3::zeros(), momentum: vector![16_000.0, 0.0, 20_000.0] };
/// let mut stepper = shell.stepper::<Exponential>(0.05)?;
/// for _ in 0..400 {
///     stepper.step(&mut state)?;
/// }
/// // it is a function as any other, too
/// assert!(air::density(shell.sea_level, state.position.z) < 0.8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Arguments are numbers, vectors and matrices, or references to them. The body is [what a description may contain](guide::language), in the
/// arguments and constants alone; it is differentiated as if it was written out where it is called. Constants and functions that it names are looked up
/// where the system stands, in the module that the call says, here as `air::SCALE`: they have to be visible there, and imported where the function is
/// imported by its name alone. Of a function that is not marked the compiler says that there is no macro of its name.
pub use coadjoint_macros::expression;
/// ```
/// use coadjoint::prelude::*;
///
/// lie_group! {
///     /// Maps of the plane that keep areas.
///     Areas = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] }
/// }
///
/// /// A drop that spins and shears, tied by a spring to a mark in space, which it sees move.
/// #[lie_poisson_system(group = Areas!, advected(mark: dual(R2)), potential = stiffness * mark.norm_squared())]
/// struct Drop {
///     #[inertia]
///     inertia: Vector3<f64>,
///     stiffness: f64,
/// }
///
/// let drop = Drop { inertia: vector![1.0, 2.0, 2.0], stiffness: 1.0 };
/// let momentum = vector![0.1, 0.5, -0.5];
/// let mut state = DropState { element: Matrix2::identity(), momentum, mark: vector![1.0, 0.0] };
/// let mut stepper = drop.stepper::<Exponential>(0.01)?;
/// for _ in 0..100 {
///     stepper.step(&mut state)?;
/// }
/// assert!((state.element.determinant() - 1.0).abs() < 1e-14);
/// assert!((state.element * state.mark - vector![1.0, 0.0]).norm() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// [`assert_group_laws!`] tests its laws in one line. The guide has [more on groups](guide::groups).
pub use coadjoint_macros::lie_group;
/// Derives a structure-preserving stepper from the description of a mechanical system.
///
/// ```
/// use coadjoint::prelude::*;
///
/// /// A pendulum with a motor in its bearing.
/// #[lie_poisson_system(group = SO2, potential = -weight * angle.cos_angle(), control(motor: R1), force = motor)]
/// struct Pendulum {
///     #[inertia]
///     inertia: f64,
///     weight: f64,
/// }
///
/// let pendulum = Pendulum { inertia: 1.0, weight: 9.81 };
/// let mut state = PendulumState { angle: UnitComplex::new(0.5), momentum: vector![0.0] };
/// let mut stepper = pendulum.stepper::<Exponential>(0.01)?;
/// stepper.step_with(&mut state, &PendulumControl { motor: vector![0.2] })?;
/// assert!(state.momentum.x < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// The guide explains how to [describe](guide::describing) a system, and lists [everything a description may contain](guide::language). A
/// [`Stepper`] takes the steps, with one of the schemes that [choosing](guide::choosing) compares.
pub use coadjoint_macros::lie_poisson_system;
#[cfg(feature = "std")]
pub use compensated::Compensated;
#[cfg(feature = "std")]
pub use ensemble::Ensemble;
pub use error::{ParameterError, StepError};
pub use event::{Crossing, Event, Occurrence};
#[cfg(feature = "std")]
pub use fused::Fused;
pub use interval::Interval;
pub use legendre::LegendreError;
pub use nalgebra;
#[cfg(feature = "std")]
pub use observe::Record;
pub use observe::{Invariants, Observer};
pub use retraction::markers::*;
pub use run::{Run, RunError, RunReport, Tick};
pub use scheme::markers::*;
pub use scheme::{RightLift, StormerVerlet};
#[cfg(feature = "std")]
#[doc(hidden)]
pub use schemes::CoefficientSet;
#[cfg(feature = "std")]
pub use schemes::{ConservedCasimirs, ParseSchemeError, Properties, Scheme, SchemeType};
#[cfg(feature = "serde")]
pub use serde;
pub use spline::Spline;
pub use stepper::{StepReport, Stepper};
pub use system::{Control, Discretized, Kind, NoControl, Quantity, Role, Side, State, System};

/// What generated code reaches for; not for people, and free to change with every version.
#[doc(hidden)]
pub mod __private {
    pub use crate::__copied as copied;
    pub use crate::__serialization as serialization;
    pub use crate::Spline;
    pub use crate::clamp::Clamp;
    pub use crate::derivative::{
        Derives, Differentiable, Entry, Linearized, LinearizedSchemes, LinearizedVisitor, add_product,
    };
    pub use crate::error::ParameterError;
    #[cfg(feature = "std")]
    pub use crate::fused::FusedScalar;
    pub use crate::inertia::{require_finite, require_positive_definite, require_symmetric, symmetric_part};
    pub use crate::kernel::{Blocks, Evaluation, Kernel, Program};
    pub use crate::legendre::{finite, newton};
    pub use crate::method::{Method, Outcome};
    pub use crate::retraction::RetractionKind;
    pub use crate::scalar::stumpff::family;
    pub use crate::scalar::{Batch, Components, Scalar};
    pub use crate::scheme::markers::*;
    pub use crate::scheme::{Rule, StormerVerlet};
    pub use crate::solve::step::OneStep;
    pub use crate::system::{
        Control, Generated, Geometry, Isolated, Kind, NoControl, Quantity, Retracted, Role, Schemes, Side,
        State, Stored, System, Visitor, larger, quantity,
    };
    pub use crate::taylor::{Leading, Next, PowerSeries, SeriesVisitor};
    pub use coadjoint_macros::lie_poisson_system_with;
    pub use nalgebra;
}
