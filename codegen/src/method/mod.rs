//! Methods: from a system and a retraction to the equations of one step. They make expressions, never tokens.

mod discretization;
pub mod family;
pub mod linearization;
mod names;
pub mod presolve;
pub mod tangent_lift;

use crate::expr::{Arena, Expr, Stage, Symbol, Vector};
use crate::group::Retraction;
use crate::model::System;
use crate::scheme::{Member, Rule, Scheme};

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
    /// `left(x) − right(x)` for Newton's matrix alone: up to a few terms of series that are not finite sums.
    pub coarse_residual: Vector<'a>,
    /// Each positive while `x` is inside a retraction's domain.
    pub domain: Vec<Expr<'a>>,
    /// How the configuration is moved, one increment after the other.
    pub increments: Vec<Increment<'a>>,
    /// The state after the step, in the order of storage.
    pub next: Vector<'a>,
    /// What of it is bounded if the unknown is: rotations.
    pub bounded: Vec<bool>,
}

/// One move of the configuration: from `g` to `g τ(x)`, on the other side to `τ(x) g`.
pub struct Increment<'a> {
    /// `τ`
    pub retraction: Retraction,
    /// `g`, in stored coordinates.
    pub from: Vector<'a>,
    /// `x`
    pub by: Vector<'a>,
}

impl Scheme {
    /// The scheme of which this one is another name for the system, if `first` is the first of its retractions. `s = 1` is `s = 0` where nothing
    /// but momentum and advected parameters has a part in the motion, for `(dR τ_{−η})* Ad*_{τ(η)} = (dR τ_η)*`, if the retraction is odd;
    /// and on vector spaces all retractions are the identity.
    pub fn original(self, system: &System<'_>, first: Retraction) -> Self {
        let is_linear = system.group.is_linear();
        let retraction = if is_linear { first } else { self.retraction };
        let is_other_end = self.rule == Rule::Family(Member::SYMPLECTIC_EULER_B);
        let is_first = is_other_end && (is_linear || retraction.is_odd()) && system.is_left_invariant();
        let rule = if is_first { Rule::Family(Member::SYMPLECTIC_EULER_A) } else { self.rule };
        Self { retraction, rule }
    }

    /// The step that it makes of a system.
    pub fn step<'a>(self, arena: &'a Arena, system: &System<'a>) -> Step<'a> {
        let step = |system: &System<'a>| match self.rule {
            Rule::Family(member) => family::step(arena, system, self.retraction, member),
            Rule::TangentLift(member) => tangent_lift::step(arena, system, self.retraction, member),
        };
        let mut whole = step(system);
        if let Some(coarse) = system.coarse().map(|system| step(&system)) {
            // of the same equations, with symbols of their own
            let symbols = coarse.unknown.symbols().into_iter().chain(coarse.h.as_symbol());
            let same: Vec<_> = symbols.zip(whole.unknown.iter().chain([whole.h])).collect();
            whole.coarse_residual = coarse.coarse_residual.substitute(&same);
        }
        whole
    }
}

/// The step size as a symbol.
pub fn step_symbol(arena: &Arena) -> Expr<'_> {
    arena.symbol("h", Stage::Parameters)
}
