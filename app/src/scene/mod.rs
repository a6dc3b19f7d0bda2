//! Scenes: bodies, arrows, rods and springs in space, and their places at each sample of a run.

#[cfg(feature = "program")]
mod default;
#[cfg(feature = "program")]
mod frames;

#[cfg(feature = "program")]
pub use frames::Track;
#[cfg(feature = "program")]
pub(crate) use {
    default::{axes, check, scene},
    frames::{Frames, rounded},
};

pub use crate::catalogue::scene::*;
