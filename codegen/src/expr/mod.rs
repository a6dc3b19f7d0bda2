//! The symbolic core: hash-consed scalar expressions, differentiation, evaluation, and small linear algebra on top.

mod arena;
mod diff;
mod display;
mod eval;
mod linear;
mod number;

pub use arena::{Arena, Expr, Function, Id, Node, Stage, Sum, Symbol, SymbolInfo};
pub use diff::{Derivative, Substitution, gradient};
pub use display::Formulas;
pub use eval::Value;
pub use linear::{Matrix, Vector};
pub use number::Number;
