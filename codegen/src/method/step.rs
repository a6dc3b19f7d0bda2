//! One step, as expressions.

use crate::expr::{Arena, Expr, Matrix, Stage, Symbol, Vector};
use crate::group::Retraction;

/// One step: solve `left(x) = right(x)` for the unknown `x`, then update the state.
pub struct Step<'a> {
    /// The step size, a symbol.
    pub h: Expr<'a>,
    /// Symbols of stage *step* that are given at the beginning of a step and not kept by the caller: time and controls.
    pub given: Vec<Symbol>,
    /// The symbols `x`, of stage *iteration*; none if the step is explicit.
    pub unknown: Vector<'a>,
    /// The lengths of the blocks of `x` that have a unit in common.
    pub blocks: Vec<usize>,
    /// A first approximation of `x` from the state.
    pub start: Vector<'a>,
    /// `left(x)`
    pub left: Vector<'a>,
    /// `right(x)`
    pub right: Vector<'a>,
    /// Newton's matrix, the Jacobian of `left(x) − right(x)`: up to a few terms of series that are not finite sums.
    pub matrix: Matrix<'a>,
    /// What is iterated, as long as that contracts.
    pub iteration: Iteration<'a>,
    /// Each positive while `x` is inside a retraction's domain.
    pub domain: Vec<Expr<'a>>,
    /// How the configuration is moved, one increment after the other.
    pub increments: Vec<Increment<'a>>,
    /// Values that Newton's matrix leaves out: where the iterations end they change by no more than the solution has yet to
    /// change, and the state after a [chord](Iteration::Chord)'s step is made of those of the last iteration.
    pub slow: Vector<'a>,
    /// The state after the step, in the order of storage.
    pub next: Vector<'a>,
    /// Its components that are bounded if the unknown is: rotations.
    pub bounded: Vec<bool>,
}

/// An iteration on a step's equation.
#[derive(Clone, Debug, PartialEq)]
pub enum Iteration<'a> {
    /// `x ← left⁻¹(right(x))`, which contracts by about the angle of a step.
    FixedPoint,
    /// The simplified Newton iteration with this matrix: of first terms. A step ends from the last iterate, not from
    /// what was evaluated for it, but for what is [slow](Step::slow).
    Chord(Matrix<'a>),
    /// The same with nearly the true Jacobian, so that little is left after an iteration.
    Newton(Matrix<'a>),
    /// Newton's method itself, where the left side is not linear with constant coefficients.
    TrueNewton,
}

impl<'a> Step<'a> {
    /// `left(x) − right(x)` of another step with the same equations and symbols of its own, in this step's.
    pub(super) fn residual_of(&self, other: &Self) -> Vector<'a> {
        let symbols = other.unknown.symbols().into_iter().chain(other.h.as_symbol());
        let same: Vec<_> = symbols.zip(self.unknown.iter().chain([self.h])).collect();
        (&other.left - &other.right).substitute(&same)
    }
}

/// One move of the configuration: from some `g` to `g τ(x)`, on the other side to `τ(x) g`.
pub struct Increment<'a> {
    /// `τ`
    pub retraction: Retraction,
    /// `x`
    pub by: Vector<'a>,
}

/// The step size as a symbol.
pub fn step_symbol(arena: &Arena) -> Expr<'_> {
    arena.symbol("h", Stage::Parameters)
}
