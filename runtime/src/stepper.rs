//! The stepper: a kernel, its step, and the memory that makes Newton's iteration short.

use core::fmt;

use crate::error::{ParameterError, StepError};
use crate::kernel::Kernel;
use crate::newton;
use crate::scalar::{Real, Scalar};
use crate::system::{Discretized, State, System};

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Newton corrections made.
    pub iterations: u32,
    /// The residual left in the step's equation, relative to its terms: a few units of roundoff.
    pub residual: f64,
}

/// Takes steps of one size through the motion of one system, with the scheme `M`.
///
/// Built by [`System::stepper`]. The result of a step depends on the state alone, up to roundoff: the stepper only
/// remembers where the last solution was, to start the next one there.
pub struct Stepper<S: Discretized<M>, M> {
    kernel: S::Kernel<S::Scalar>,
    step: S::Scalar,
    memory: Option<Memory<S, M>>,
}

type Unknown<S, M> =
    <<S as Discretized<M>>::Kernel<<S as System>::Scalar> as Kernel<<S as System>::Scalar>>::Unknown;

/// The last solution and the state it led to.
struct Memory<S: Discretized<M>, M> {
    state: S::StateComponents<S::Scalar>,
    unknown: Unknown<S, M>,
}

impl<S: Discretized<M>, M> Stepper<S, M> {
    pub(crate) fn new(system: &S, step: S::Scalar) -> Result<Self, ParameterError> {
        system.validate()?;
        if !step.is_finite() || step == S::Scalar::of(0.0) {
            return Err(ParameterError::Step { step: step.to_f64() });
        }
        Ok(Self { kernel: S::Kernel::new(&system.to_parameters(), step), step, memory: None })
    }

    /// The step size.
    pub fn step_size(&self) -> S::Scalar {
        self.step
    }

    /// Takes one step.
    ///
    /// # Errors
    /// If the state is not finite, the step's equation cannot be solved, or its solution lies outside the retraction's
    /// domain. The state is then as before the call.
    pub fn step(&mut self, state: &mut S::State) -> Result<StepReport, StepError> {
        let components = state.to_components();
        if !finite(components.as_ref()) {
            return Err(StepError::NotFinite);
        }
        // the last velocity is a good guess only if the state is where we left it
        let start = match &self.memory {
            Some(memory) if memory.state == components => memory.unknown,
            _ => self.kernel.start(&components),
        };
        let begun = self.kernel.begin(&components);
        let solution = newton::solve(&self.kernel, &components, &begun, start)?;
        if !(self.kernel.domain(&solution.unknown, &solution.evaluation) > S::Scalar::of(0.0)) {
            return Err(StepError::OutsideDomain);
        }
        let next = self.kernel.finish(&components, &begun, &solution.unknown, &solution.evaluation);
        if !finite(next.as_ref()) {
            return Err(StepError::NotFinite);
        }
        *state = S::State::from_components(&next);
        self.memory = Some(Memory { state: next, unknown: solution.unknown });
        Ok(StepReport { iterations: solution.iterations, residual: solution.residual })
    }
}

#[inline(always)]
fn finite<T: Real>(components: &[T]) -> bool {
    components.iter().all(|x| x.is_finite())
}

impl<S: Discretized<M>, M> Clone for Stepper<S, M> {
    fn clone(&self) -> Self {
        Self { kernel: self.kernel, step: self.step, memory: self.memory.as_ref().map(Memory::copy) }
    }
}

impl<S: Discretized<M>, M> Memory<S, M> {
    fn copy(&self) -> Self {
        Self { state: self.state, unknown: self.unknown }
    }
}

impl<S: Discretized<M>, M> fmt::Debug for Stepper<S, M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stepper").field("system", &S::NAME).field("step", &self.step).finish_non_exhaustive()
    }
}
