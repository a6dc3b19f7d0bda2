//! Methods: from a system and a retraction to the equations of one step. They make expressions, never tokens.
//!
//! A method is a file and its row in [`METHODS`]: parsing, messages and emission follow from the row.

mod discretization;
pub mod family;
pub mod hamilton_jacobi;
pub mod linearization;
mod motion;
mod names;
pub mod presolve;
mod step;
pub mod tangent_lift;
pub mod taylor;

pub use step::{Increment, Iteration, Step, step_symbol};

use crate::expr::Arena;
use crate::group::Retraction;
use crate::model::System;
use crate::scheme::{Member, Method, Parameter, Rule, Scheme};

/// What makes a method's step of a system, by its parameter.
#[derive(Clone, Copy)]
pub enum StepOf {
    /// By the share of the step before the intermediate point.
    Share(for<'a> fn(&'a Arena, &System<'a>, Retraction, Member) -> Step<'a>),
    /// By the order.
    Order(for<'a> fn(&'a Arena, &System<'a>, Retraction, u32) -> Step<'a>),
}

/// The methods, each with what makes its steps.
pub const METHODS: [(&Method, StepOf); 3] = [
    (&family::METHOD, StepOf::Share(family::step)),
    (&tangent_lift::METHOD, StepOf::Share(tangent_lift::step)),
    (&hamilton_jacobi::METHOD, StepOf::Order(hamilton_jacobi::step)),
];

/// The rules that every system has steps by: both ends of the family.
pub const STANDARD: [Rule; 2] = [FIRST, LAST];

const FIRST: Rule = family::METHOD.member(Member::SYMPLECTIC_EULER_A);
const LAST: Rule = family::METHOD.member(Member::SYMPLECTIC_EULER_B);

/// The methods as users name them.
pub fn known() -> Vec<&'static Method> {
    METHODS.into_iter().map(|(method, _)| method).collect()
}

impl Scheme {
    /// The scheme of which this one is another name for the system, if `first` is the first of its retractions. `s = 1`
    /// is `s = 0` where nothing but momentum and advected parameters has a part in the motion, for
    /// `(dR τ_{−η})* Ad*_{τ(η)} = (dR τ_η)*`, if the retraction is odd; and on vector spaces all retractions are the
    /// identity.
    pub fn original(self, system: &System<'_>, first: Retraction) -> Self {
        let is_linear = system.group.is_linear();
        let retraction = if is_linear { first } else { self.retraction };
        let is_other_end = self.rule == LAST;
        let is_first = is_other_end && (is_linear || retraction.is_odd()) && system.is_left_invariant();
        let rule = if is_first { FIRST } else { self.rule };
        Self { retraction, rule }
    }

    /// The step that it makes of a system.
    pub fn step<'a>(self, arena: &'a Arena, system: &System<'a>) -> Step<'a> {
        let Rule { method, parameter } = self.rule;
        let (_, step_of) = METHODS.into_iter().find(|(known, _)| *known == method).unwrap_or(METHODS[0]);
        let step = |retraction| match (step_of, parameter) {
            (StepOf::Share(step), Parameter::Share(member)) => step(arena, system, retraction, member),
            (StepOf::Order(step), Parameter::Order(order)) => step(arena, system, retraction, order),
            // no method is made with the other's parameter
            _ => family::step(arena, system, retraction, Member::MIDPOINT),
        };
        let mut whole = step(self.retraction);
        // steps of an order see to it themselves
        if system.group.is_summed(self.retraction) && !self.rule.is_of_order() {
            let residual = whole.residual_of(&step(Retraction::Coarse));
            whole.matrix = residual.jacobian(&whole.unknown.symbols());
        }
        whole
    }
}
