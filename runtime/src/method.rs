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

    /// The state after a step. What is remembered from earlier steps only makes it faster.
    ///
    /// # Errors
    /// If the state is not finite, the step's equation cannot be solved, or its solution lies outside the retraction's domain.
    fn advance(&mut self, state: &Self::State) -> Result<(Self::State, StepReport), StepError>;
}

/// One generated kernel: a step is one equation, solved by Newton's iteration from the last solution.
#[derive(Clone, Copy, Debug)]
pub struct OneStep<T, K: Kernel<T>>
where
    T: Real,
{
    kernel: K,
    memory: Option<Memory<K::State, K::Unknown>>,
}

/// The last solution and the state it led to.
#[derive(Clone, Copy, Debug)]
struct Memory<S, U> {
    state: S,
    unknown: U,
}

impl<T: Real, K: Kernel<T>> Method for OneStep<T, K> {
    type Scalar = T;
    type Parameters = K::Parameters;
    type State = K::State;

    fn new(parameters: &K::Parameters, step: T) -> Self {
        Self { kernel: K::new(parameters, step), memory: None }
    }

    #[inline]
    fn advance(&mut self, state: &K::State) -> Result<(K::State, StepReport), StepError> {
        if !finite(state.as_ref()) {
            return Err(StepError::NotFinite);
        }
        // the last velocity is a good guess only if the state is where we left it
        let start = match &self.memory {
            Some(memory) if memory.state == *state => memory.unknown,
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
        self.memory = Some(Memory { state: next, unknown: solution.unknown });
        Ok((next, StepReport { iterations: solution.iterations, residual: solution.residual }))
    }
}

#[inline(always)]
fn finite<T: Real>(components: &[T]) -> bool {
    components.iter().all(|x| x.is_finite())
}
