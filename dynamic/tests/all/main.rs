//! Systems made of texts.
#![allow(clippy::unwrap_used)]

mod errors;
mod hostile;
mod own;
mod same;
