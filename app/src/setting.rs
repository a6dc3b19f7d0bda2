//! What users set of a system, by the names of its quantities or of single components: values, spreads, scans.

mod assign;
mod names;
mod rotation;
mod scan;
mod spread;
mod transport;

pub(crate) use assign::Changes;
pub(crate) use names::{Names, laid_out};
pub(crate) use rotation::rotation;
pub(crate) use scan::Scan;
pub use spread::{Drawn, Variation};

#[cfg(test)]
mod tests;
