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
    system: S,
    method: S::Method,
    step: S::Scalar,
    /// The state that the last step led to.
    left: Option<S::StateComponents<S::Scalar>>,
}

/// How far a state's configuration may be off its group when it is handed in: more than files of few digits leave, and so little
/// that the first step puts it back.
const LARGEST_DEVIATION: f64 = 1e-3;

impl<S: Discretized<M>, M> Stepper<S, M> {
    pub(crate) fn new(system: &S, step: S::Scalar) -> Result<Self, ParameterError> {
        system.validate()?;
        if !step.is_finite() || step == S::Scalar::of(0.0) {
            return Err(ParameterError::Step { step: step.to_f64() });
        }
        let parameters = system.to_parameters();
        let system = S::from_parameters(&parameters);
        Ok(Self { system, method: S::Method::new(&parameters, step), step, left: None })
    }

    /// The system, as it was when the stepper was built.
    pub fn system(&self) -> &S {
        &self.system
    }

    /// The step size.
    pub fn step_size(&self) -> S::Scalar {
        self.step
    }

    /// Takes one step.
    ///
    /// # Errors
    /// If the state is not finite or its configuration not on its group, the step's equation cannot be solved, or its solution
    /// lies outside the retraction's domain. The state is then as before the call.
    #[inline]
    pub fn step(&mut self, state: &mut S::State) -> Result<StepReport, StepError> {
        let components = state.to_components();
        let known = self.left == Some(components);
        if !known {
            on_group(state)?;
        }
        let (next, report) = self.method.advance(&components, known)?;
        *state = S::State::from_components(&next);
        self.left = Some(next);
        Ok(report)
    }
}

/// A state from elsewhere is on its group, more or less.
#[cold]
fn on_group<S: State>(state: &S) -> Result<(), StepError> {
    let deviation = state.deviation().to_f64();
    // what is not finite is so named by the step
    let off = deviation.is_finite() && deviation > LARGEST_DEVIATION;
    if off { Err(StepError::NotOnGroup { deviation }) } else { Ok(()) }
}

impl<S: Discretized<M>, M> Clone for Stepper<S, M> {
    fn clone(&self) -> Self {
        let system = S::from_parameters(&self.system.to_parameters());
        Self { system, method: self.method.clone(), step: self.step, left: self.left }
    }
}

impl<S: Discretized<M>, M> fmt::Debug for Stepper<S, M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stepper")
            .field("system", &S::NAME)
            .field("scheme", &core::any::type_name::<M>())
            .field("step", &self.step)
            .finish_non_exhaustive()
    }
}
