//! Methods: from a system and a retraction to the equations of one step. They make expressions, never tokens.

pub mod lie_poisson;

use crate::expr::{Arena, Expr, Vector};

/// One step: solve `left(x) = right(x)` for the unknown `x`, then update the state.
pub struct Step<'a> {
    /// The step size, a symbol.
    pub h: Expr<'a>,
    /// The symbols `x`, of stage *iteration*.
    pub unknown: Vector<'a>,
    /// A first approximation of `x` from the state.
    pub start: Vector<'a>,
    /// `left(x)`
    pub left: Vector<'a>,
    /// `right(x)`
    pub right: Vector<'a>,
    /// Positive while `x` is inside the retraction's domain.
    pub domain: Option<Expr<'a>>,
    /// The state after the step, in the order of storage.
    pub next: Vector<'a>,
}

/// The step size as a symbol.
pub fn step_symbol(arena: &Arena) -> Expr<'_> {
    arena.symbol("h", crate::expr::Stage::Parameters)
}
