//! The step that a retraction alone stands for.

use super::Program;
use crate::expr::Number;
use crate::scheme::{Member, Parameter, Retraction, Scheme};

impl Program {
    /// The [step](super::StepProgram) of a scheme by its place, under that name or under another.
    pub fn step(&self, scheme: Scheme) -> Option<usize> {
        self.steps.iter().position(|step| step.scheme == scheme || step.aliases.contains(&scheme))
    }

    /// The standard step of order 2: its parts by their places, and the share of the whole step that each takes. One part where nothing but
    /// momentum and advected parameters has a part in the motion and the retraction is odd, else [two halves](Self::stormer_verlet).
    ///
    /// A second part starts where and when the first one ends. Controls are held over all of them. None where the retraction makes no steps.
    pub fn standard(&self, retraction: Retraction) -> Option<Vec<(usize, Number)>> {
        match self.interface.is_left_invariant && retraction.is_odd() {
            true => Some(vec![(self.member(retraction, Member::SYMPLECTIC_EULER_A)?, Number::ONE)]),
            false => self.stormer_verlet(retraction),
        }
    }

    /// Half a step with the first member of the family, then half a step with the last one, which is its adjoint.
    pub fn stormer_verlet(&self, retraction: Retraction) -> Option<Vec<(usize, Number)>> {
        let half = Number::ratio(1, 2);
        let [first, last] = [Member::SYMPLECTIC_EULER_A, Member::SYMPLECTIC_EULER_B];
        Some(vec![(self.member(retraction, first)?, half), (self.member(retraction, last)?, half)])
    }

    /// The member of the family that bare retractions stand for one of.
    fn member(&self, retraction: Retraction, member: Member) -> Option<usize> {
        let is_it = |scheme: &Scheme| {
            scheme.retraction == retraction
                && scheme.rule.method.bare.is_some()
                && scheme.rule.parameter == Parameter::Share(member)
        };
        self.steps.iter().position(|step| is_it(&step.scheme) || step.aliases.iter().any(is_it))
    }
}
