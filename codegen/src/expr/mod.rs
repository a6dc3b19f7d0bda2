//! The symbolic core: hash-consed scalar expressions, differentiation, evaluation, and small linear algebra on top.

mod arena;
mod diff;
mod display;
mod entries;
mod expression;
mod linear;
pub(crate) mod modular;
mod node;
mod number;
mod polynomial;
mod quotient;
mod rational;
mod recurrence;
mod rule;
mod series;
mod vanishing;

pub use arena::Arena;
pub use diff::{Derivative, Substitution, gradient};
pub use display::Formulas;
pub(crate) use display::sign;
pub use entries::Entries;
pub use expression::Expr;
pub(crate) use linear::uncoupled;
pub use linear::{Matrix, Vector};
pub use node::{Function, Id, Node, Stage, Sum, Symbol, SymbolInfo};
pub use number::Number;
pub(crate) use rational::Rational;
pub use recurrence::{Recurrences, Unknown};
pub use rule::DerivativeRule;
pub use series::{Part, Series};
