//! The stepper: a method with its step, for people to call.

use core::fmt;

use crate::error::{ParameterError, StepError};
use crate::method::Method;
use crate::scalar::{Real, Scalar};
#[cfg(doc)]
use crate::system::System;
use crate::system::{Discretized, State};

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Newton corrections made, in all steps of a composition together.
    pub iterations: u32,
    /// The residual left in the step's equation, relative to its terms: a few units of roundoff. Of a
    /// composition, the largest.
    pub residual: f64,
}

/// Takes steps of one size through the motion of one system, with the scheme `M`.
///
/// Built by [`System::stepper`]. The result of a step depends on the state alone, up to roundoff: the stepper only
/// remembers where the last solution was, to start the next one there.
pub struct Stepper<S: Discretized<M>, M> {
    method: S::Method,
    step: S::Scalar,
}

impl<S: Discretized<M>, M> Stepper<S, M> {
    pub(crate) fn new(system: &S, step: S::Scalar) -> Result<Self, ParameterError> {
        system.validate()?;
        if !step.is_finite() || step == S::Scalar::of(0.0) {
            return Err(ParameterError::Step { step: step.to_f64() });
        }
        Ok(Self { method: S::Method::new(&system.to_parameters(), step), step })
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
    #[inline]
    pub fn step(&mut self, state: &mut S::State) -> Result<StepReport, StepError> {
        let (next, report) = self.method.advance(&state.to_components())?;
        *state = S::State::from_components(&next);
        Ok(report)
    }
}

impl<S: Discretized<M>, M> Clone for Stepper<S, M> {
    fn clone(&self) -> Self {
        Self { method: self.method.clone(), step: self.step }
    }
}

impl<S: Discretized<M>, M> fmt::Debug for Stepper<S, M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stepper").field("system", &S::NAME).field("step", &self.step).finish_non_exhaustive()
    }
}
