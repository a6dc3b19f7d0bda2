//! Systems made of texts.
#![allow(clippy::unwrap_used)]

mod errors;
mod hostile;
#[cfg(feature = "jit")]
mod machine;
mod memory;
mod own;
mod rest;
mod same;
mod tangents;
