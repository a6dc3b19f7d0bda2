//! Methods: from a system and a retraction to the equations of one step. They make expressions, never tokens.

mod discretization;
pub mod family;
pub mod linearization;
mod names;
pub mod presolve;
mod step;
pub mod tangent_lift;

pub use step::{Increment, Step, step_symbol};

use crate::expr::Arena;
use crate::group::Retraction;
use crate::model::System;
use crate::scheme::{Member, Rule, Scheme};

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
