//! What takes a step: one solved equation, or several steps composed.

use crate::error::StepError;
use crate::kernel::{Components, Kernel};
use crate::newton;
use crate::scalar::Real;
use crate::stepper::StepReport;

/// A discretization of one system with one step size, on flat arrays.
pub trait Method: Clone {
    /// `f64` or `f32`.
    type Scalar: Real;
    /// The system's parameters.
    type Parameters: Components<Self::Scalar>;
    /// The state.
    type State: Components<Self::Scalar>;

    /// The method for these parameters and this step.
    fn new(parameters: &Self::Parameters, step: Self::Scalar) -> Self;

    /// The state after a step. If the state is `known`, the one that the last step led to, the solution is sought from the last one
    /// on, which only makes it faster.
    ///
    /// # Errors
    /// If the state is not finite, the step's equation cannot be solved, or its solution lies outside the retraction's domain.
    fn advance(&mut self, state: &Self::State, known: bool) -> Result<(Self::State, StepReport), StepError>;
}

/// One generated kernel: a step is one equation, solved by Newton's iteration from the last solution.
#[derive(Clone, Copy, Debug)]
pub struct OneStep<T: Real, K: Kernel<T>> {
    kernel: K,
    /// The last solution.
    unknown: Option<K::Unknown>,
}

impl<T: Real, K: Kernel<T>> Method for OneStep<T, K> {
    type Scalar = T;
    type Parameters = K::Parameters;
    type State = K::State;

    fn new(parameters: &K::Parameters, step: T) -> Self {
        Self { kernel: K::new(parameters, step), unknown: None }
    }

    #[inline]
    fn advance(&mut self, state: &K::State, known: bool) -> Result<(K::State, StepReport), StepError> {
        if !finite(state.as_ref()) {
            return Err(StepError::NotFinite);
        }
        let start = match self.unknown {
            Some(unknown) if known => unknown,
            _ => self.kernel.start(state),
        };
        let begun = self.kernel.begin(state);
        let solution = newton::solve(&self.kernel, state, &begun, start)?;
        if !(self.kernel.domain(&solution.unknown, &solution.evaluation) > T::of(0.0)) {
            return Err(StepError::OutsideDomain);
        }
        let next = self.kernel.finish(state, &begun, &solution.unknown, &solution.evaluation);
        if !finite(next.as_ref()) {
            return Err(StepError::NotFinite);
        }
        self.unknown = Some(solution.unknown);
        Ok((next, StepReport { iterations: solution.iterations, residual: solution.residual }))
    }
}

#[inline(always)]
fn finite<T: Real>(components: &[T]) -> bool {
    components.iter().all(|x| x.is_finite())
}
