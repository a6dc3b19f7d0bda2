//! From a system to its program: everything that is emitted is derived here, but the steps themselves.

mod equations;
pub mod geometry;
mod program;

pub(crate) use program::{program, series, step};
