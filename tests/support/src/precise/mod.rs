//! Symbolic forms with 71 digits: a number type for the generator's formulas, definitions to hold them against, and what random
//! expressions and kernels are evaluated with.

pub mod definition;
pub mod descriptions;
pub mod formula;
pub mod interpreter;
pub mod matrix;
pub mod newton;
pub mod real;
pub mod residuals;
pub mod trees;
