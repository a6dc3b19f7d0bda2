//! The stepper: a method with its step, for people to call.

use core::fmt;

use crate::error::{ParameterError, StepError};
use crate::method::Method;
use crate::scalar::{Real, Scalar};
#[cfg(doc)]
use crate::system::System;
use crate::system::{Control, Discretized, State};

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
/// Built by [`System::stepper`]. The result of a step depends on the state, the time and the control alone, up to roundoff: the
/// stepper only remembers where the last solution was, to start the next one there. It counts the time from 0, or from where
/// [`set_time`](Self::set_time) put it; systems that do not depend on time take no notice.
pub struct Stepper<S: Discretized<M>, M> {
    system: S,
    method: S::Method,
    step: S::Scalar,
    /// The time before the steps counted by `taken`.
    start: f64,
    /// Steps since `start`.
    taken: u64,
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
        let method = S::Method::new(&parameters, step);
        Ok(Self { system, method, step, start: 0.0, taken: 0, left: None })
    }

    /// The system, as it was when the stepper was built.
    pub fn system(&self) -> &S {
        &self.system
    }

    /// The step size.
    pub fn step_size(&self) -> S::Scalar {
        self.step
    }

    /// The time, at which the next step starts: the start plus the steps taken since, not accumulated, so that it does not drift.
    pub fn time(&self) -> S::Scalar {
        S::Scalar::of(self.now())
    }

    /// Sets the time: the next step starts at `time`.
    pub fn set_time(&mut self, time: S::Scalar) {
        self.start_at(time.to_f64());
    }

    /// The time, in f64 whatever the scalar.
    pub(crate) fn now(&self) -> f64 {
        self.start + self.taken as f64 * self.step.to_f64()
    }

    pub(crate) fn start_at(&mut self, time: f64) {
        (self.start, self.taken) = (time, 0);
    }

    /// Takes one step with all controls zero.
    ///
    /// # Errors
    /// As [`step_with`](Self::step_with).
    #[inline]
    pub fn step(&mut self, state: &mut S::State) -> Result<StepReport, StepError> {
        self.step_with(state, &S::Control::default())
    }

    /// Takes one step with `control` held from its start to its end.
    ///
    /// # Errors
    /// If the state, the time or the control is not finite, or the state's configuration not on its group, the step's equation
    /// cannot be solved, or its solution lies outside the retraction's domain. State and time are then as before the call.
    #[inline]
    pub fn step_with(&mut self, state: &mut S::State, control: &S::Control) -> Result<StepReport, StepError> {
        let components = state.to_components();
        let known = self.left == Some(components);
        if !known {
            on_group(state)?;
        }
        let control = control.to_components();
        let (next, report) = self.method.advance(&components, self.time(), &control, known)?;
        *state = S::State::from_components(&next);
        self.left = Some(next);
        self.taken += 1;
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
        let Self { step, start, taken, left, .. } = *self;
        Self { system, method: self.method.clone(), step, start, taken, left }
    }
}

impl<S: Discretized<M>, M> fmt::Debug for Stepper<S, M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stepper")
            .field("system", &S::NAME)
            .field("scheme", &core::any::type_name::<M>())
            .field("step", &self.step)
            .field("time", &self.time())
            .finish_non_exhaustive()
    }
}
