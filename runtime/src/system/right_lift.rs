//! Steps that carry the momentum that is constant.

use super::{Discretized, Isolated};
use crate::method::{Method, Outcome, StageAccumulator};
use crate::scalar::{Batch, Components, Scalar};
use crate::scheme::RightLift;
use crate::snapshot::visit_flag;

#[diagnostic::do_not_recommend]
impl<S, M> Discretized<RightLift<M>> for S
where
    S: Isolated + Discretized<M>,
{
    type Method<T: Batch> = ConservedMomentum<S, <S as Discretized<M>>::Method<T>>;
}

/// A method that carries from step to step the momentum that is constant.
pub struct ConservedMomentum<S: Isolated, B: Method> {
    pub(crate) base: B,
    /// Whether there was a step.
    has_stepped: bool,
    /// The momentum since then.
    conserved: S::Conserved<B::Scalar>,
}

impl<S: Isolated, B: Method> Clone for ConservedMomentum<S, B> {
    fn clone(&self) -> Self {
        Self { base: self.base.clone(), has_stepped: self.has_stepped, conserved: self.conserved }
    }
}

impl<S, B> Method for ConservedMomentum<S, B>
where
    S: Isolated,
    B: Method,
    B: Method<State = S::StateComponents<<B as Method>::Scalar>>,
{
    type CallSite = B::CallSite;
    type Scalar = B::Scalar;
    type Parameters = B::Parameters;
    type State = B::State;
    type Control = B::Control;

    fn new(parameters: &B::Parameters, step: B::Scalar) -> Self {
        let nothing = S::Conserved::splat(B::Scalar::of(0.0));
        Self { base: B::new(parameters, step), has_stepped: false, conserved: nothing }
    }

    type FastPath = ();

    #[inline(always)]
    fn advance_from(
        &mut self,
        _from: Option<usize>,
        state: &B::State,
        time: B::Scalar,
        control: &B::Control,
        known: bool,
    ) -> Outcome<B::Scalar, B::State> {
        let conserved = if known && self.has_stepped { self.conserved } else { S::conserved(state) };
        let mut accumulator = StageAccumulator::new();
        let next = accumulator.stage(&mut self.base, None, state, time, control, known)?;
        (self.has_stepped, self.conserved) = (true, conserved);
        accumulator.end(S::with_conserved(&next, &conserved))
    }

    fn set_inputs(&mut self, inputs: Option<&mut dyn FnMut(f64) -> B::Control>) {
        self.base.set_inputs(inputs);
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [B::Scalar])) {
        visit_flag(&mut self.has_stepped, visit);
        visit(self.conserved.as_mut());
        self.base.memory(visit);
    }
}
