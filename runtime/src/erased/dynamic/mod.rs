//! Systems that are made while a program runs: their arithmetic is behind functions of numbers in a frame, and what solves their equations is what
//! solves all others.
//!
//! This is what the crate `coadjoint-dynamic` makes systems with, from descriptions as text. Nothing here knows where the functions come from.

mod kernel;
mod linearization;
mod method;
mod pair;
mod step;
mod system;
mod taylor;

pub use crate::scalar::Work;
pub use crate::scalar::simd::frame::{LANES, MACHINE_LANES, side_by_side};
pub use crate::scalar::simd::march::{March, Marching};
pub use crate::scheme::Rule;
pub use kernel::{MOST_UNKNOWNS, row_length};
pub use step::{Layout, Lengths, Solution, Step, StepDerivative, StepFunction, StepFunctions};
pub use system::{
    Definition, DynamicSystem, Given, Inertia, SystemFunction, SystemFunctions, description, with_events,
};
pub use taylor::SeriesFunctions;

/// Whether a product and a sum are rounded once, in all that the program computes.
pub const FUSED: bool = crate::scalar::FUSED;
