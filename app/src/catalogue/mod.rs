//! The systems of a program, what each says of itself, and the facts that follow from that.

mod example;
pub mod scene;
pub mod shape;
#[cfg(feature = "program")]
mod systems;

pub use example::{Example, Observables};
#[cfg(feature = "program")]
pub use systems::*;
