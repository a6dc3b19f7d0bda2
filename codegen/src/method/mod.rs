//! Methods: from a system and a retraction to the equations of one step. They make expressions, never tokens.

pub mod family;
pub mod linearization;
mod names;
pub mod presolve;
pub mod tangent_lift;

use crate::expr::{Arena, Expr, Stage, Symbol, Vector};
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
    /// Each positive while `x` is inside a retraction's domain.
    pub domain: Vec<Expr<'a>>,
    /// How the configuration of each factor is moved, one increment after the other.
    pub increments: Vec<Vec<Increment<'a>>>,
    /// The state after the step, in the order of storage.
    pub next: Vector<'a>,
    /// What of it is bounded if the unknown is: rotations.
    pub bounded: Vec<bool>,
}

/// One move of a configuration: from `g` to `g τ(x)`, on the other side to `τ(x) g`.
pub struct Increment<'a> {
    /// `g`, in stored coordinates.
    pub from: Vector<'a>,
    /// `x`
    pub by: Vector<'a>,
}

impl Rule {
    /// The rule of which this one is another name for the system: `s = 1` is `s = 0` where nothing but momentum and advected parameters has
    /// a part in the motion, for `(dR τ_{−η})* Ad*_{τ(η)} = (dR τ_η)*`.
    pub fn original(self, system: &System<'_>) -> Self {
        if self == Self::Family(Member::SYMPLECTIC_EULER_B) && system.is_left_invariant() {
            return Self::Family(Member::SYMPLECTIC_EULER_A);
        }
        self
    }
}

impl Scheme {
    /// The step that it makes of a system.
    pub fn step<'a>(self, arena: &'a Arena, system: &System<'a>) -> Step<'a> {
        match self.rule {
            Rule::Family(member) => family::step(arena, system, self.retraction, member),
            Rule::TangentLift(member) => tangent_lift::step(arena, system, self.retraction, member),
        }
    }
}

/// The step size as a symbol.
pub fn step_symbol(arena: &Arena) -> Expr<'_> {
    arena.symbol("h", Stage::Parameters)
}
