//! The stepper of any system and scheme.

use core::fmt;
use std::boxed::Box;
use std::sync::{Arc, Mutex, PoisonError};
use std::vec::Vec;

use nalgebra::DVector;
use thiserror::Error;

use super::adaptive::Adaptive;
use super::composition;
use super::field::ByFunction;
use super::jacobian::{self, Jacobian, JacobianError};
use super::system::{At, System, check, check_length, length};
use crate::derivative::Parts;
use crate::error::{ParameterError, StepError};
use crate::flat::{self, Method, NotGenerated};
use crate::method::{Advanced, Clock, Counted};
use crate::schemes::Scheme;
use crate::snapshot::{self, visit_flag};
use crate::stepper::report::{RunError, RunReport};
use crate::stepper::stepping::as_by_itself;
use crate::stepper::{EventSeries, Inputs, StepReport, Stepping, check_deviation, check_step, trajectory};
use crate::system::Dynamics;

/// Takes steps of one size through the motion of one system, with one scheme: [`Stepper`](crate::Stepper) with its types erased.
pub struct Stepper {
    system: Arc<dyn System>,
    /// None of a method of one's own.
    scheme: Option<Scheme>,
    make: Box<MakeMethod>,
    /// Behind a lock that is held by a snapshot alone: what is shown of it could be replaced.
    method: Mutex<Box<dyn Method<f64>>>,
    step: f64,
    /// The time before the steps counted by `taken`.
    start: f64,
    /// Steps since `start`, all of this size.
    taken: u64,
    /// Steps before these, of other sizes.
    before: u64,
    /// Whether there was a step that the next one goes on from, and the state that the last one led to.
    has_left: bool,
    left: Vec<f64>,
    /// Whether that is a state that a step led to: a method of one's own may have left its group with it.
    is_own: bool,
    /// Where the next step leads to, until it is known to succeed.
    next: Vec<f64>,
    /// What knows the power series of events within the steps, if they are made of Taylor steps.
    series: Option<Adaptive>,
}

/// Makes what takes the steps of a system of this size; none if they were not generated.
type MakeMethod = dyn Fn(&Arc<dyn System>, f64) -> Option<Box<dyn Method<f64>>> + Send + Sync;

/// A stepper that cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StepperError {
    /// The parameters, or the step, are not valid.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A step that the scheme is made of was not generated.
    #[error(transparent)]
    NotGenerated(#[from] NotGenerated),
}

impl Stepper {
    /// Builds a stepper with the given step; negative steps go back in time.
    ///
    /// # Errors
    /// If the parameters are not valid, the step is zero or not finite, or the scheme's steps were not generated.
    pub fn new(system: Arc<dyn System>, scheme: &Scheme, step: f64) -> Result<Self, StepperError> {
        let own = scheme.clone();
        let stepper = Self::assembled(system, step, move |system, step| -> Result<_, StepperError> {
            Ok(composition::method(&own, &**system, step)?)
        })?;
        Ok(Self { scheme: Some(scheme.clone()), ..stepper })
    }

    /// Builds a stepper whose steps were not generated: those of a method of one's own.
    ///
    /// The function writes the state after a step to its last argument, and returns how many iterations that took.
    ///
    /// ```
    /// use coadjoint::erased::{self, At, System};
    /// use coadjoint::prelude::*;
    /// use std::sync::{Arc, Mutex, PoisonError};
    ///
    /// #[lie_poisson_system(group = SO3)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// let body = Arc::new(Body { inertia: vector![1.0, 2.0, 2.5] });
    /// let euler = |system: &dyn System, at: &At<'_>, next: &mut [f64]| {
    ///     let rates = system.vector_field(at.state, at.time, at.control);
    ///     next.iter_mut().zip(at.state).zip(rates).for_each(|((next, x), rate)| *next = x + at.step * rate);
    ///     Ok(0)
    /// };
    /// let mut stepper = erased::Stepper::from_fn(body, 1e-3, euler)?;
    /// let mut state = [1.0, 0.0, 0.0, 0.0, 0.4, -0.8, 1.5];
    /// stepper.step(&mut state, &[])?;
    /// assert_eq!(state[1], 1e-3 * 0.5 * 0.4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If the parameters are not valid, or the step is zero or not finite.
    pub fn from_fn(
        system: Arc<dyn System>,
        step: f64,
        function: impl Fn(&dyn System, &At<'_>, &mut [f64]) -> Result<u32, StepError> + Send + Sync + 'static,
    ) -> Result<Self, ParameterError> {
        let function = Arc::new(function);
        Self::with_methods(system, step, move |system, step| {
            Some(Box::new(ByFunction { system: system.clone(), step, function: function.clone() }))
        })
    }

    /// Builds a stepper that takes its steps by the method that the function makes for a system and a step.
    ///
    /// # Errors
    /// If the parameters are not valid, the step is zero or not finite, or no method is made.
    #[doc(hidden)]
    pub fn with_methods(
        system: Arc<dyn System>,
        step: f64,
        make: impl Fn(&Arc<dyn System>, f64) -> Option<Box<dyn Method<f64>>> + Send + Sync + 'static,
    ) -> Result<Self, ParameterError> {
        Self::assembled(system, step, move |system, step| {
            make(system, step).ok_or(ParameterError::Step { step })
        })
    }

    fn assembled<E: From<ParameterError>>(
        system: Arc<dyn System>,
        step: f64,
        make: impl Fn(&Arc<dyn System>, f64) -> Result<Box<dyn Method<f64>>, E> + Send + Sync + 'static,
    ) -> Result<Self, E> {
        system.validate()?;
        check_step(step)?;
        let method = Mutex::new(make(&system, step)?);
        let make = Box::new(move |system: &Arc<dyn System>, step| make(system, step).ok());
        let left = std::vec![0.0; length(system.description().state)];
        let (next, scheme) = (left.clone(), None);
        let (start, taken, before, has_left, is_own) = (0.0, 0, 0, false, false);
        let series = None;
        Ok(Self {
            system,
            scheme,
            make,
            method,
            step,
            start,
            taken,
            before,
            has_left,
            left,
            is_own,
            next,
            series,
        })
    }

    /// Looks for events of the description in their power series, as Taylor steps do.
    #[doc(hidden)]
    pub fn with_series(self, series: Adaptive) -> Self {
        Self { series: Some(series), ..self }
    }

    /// The system.
    pub fn system(&self) -> &Arc<dyn System> {
        &self.system
    }

    /// The step size.
    pub fn step_size(&self) -> f64 {
        self.step
    }

    /// Takes steps of this size from now on: see [`Stepper::set_step_size`](crate::Stepper::set_step_size).
    ///
    /// # Errors
    /// If the step is zero or not finite; the stepper is then as before.
    pub fn set_step_size(&mut self, step: f64) -> Result<(), ParameterError> {
        check_step(step)?;
        self.method = Mutex::new((self.make)(&self.system, step).ok_or(ParameterError::Step { step })?);
        (self.start, self.before, self.taken) = (self.time(), self.steps_taken(), 0);
        (self.step, self.has_left) = (step, false);
        Ok(())
    }

    /// Takes the steps of the system with other parameters from now on: see [`Stepper::set_system`](crate::Stepper::set_system).
    ///
    /// # Errors
    /// If there are not as many, or they are not those of a system that can move; the stepper is then as before.
    pub fn set_parameters(&mut self, parameters: &[f64]) -> Result<(), ParameterError> {
        let (expected, got) = (self.system.parameters().len(), parameters.len());
        if got != expected {
            return Err(ParameterError::Length { expected, got });
        }
        let system = self.system.with_parameters(parameters);
        system.validate()?;
        let step = self.step;
        let method = (self.make)(&system, step).ok_or(ParameterError::Step { step })?;
        if let Some(series) = &mut self.series {
            Stepping::set_parameters(series, parameters)?;
        }
        (self.method, self.system, self.has_left) = (Mutex::new(method), system, false);
        Ok(())
    }

    /// Forgets all steps: time 0, and no step taken.
    pub fn reset(&mut self) {
        (self.start, self.taken, self.before, self.has_left) = (0.0, 0, 0, false);
    }

    /// The motion from a state on: see [`Stepper::trajectory`](crate::Stepper::trajectory).
    pub fn trajectory(
        &mut self,
        from: &[f64],
    ) -> impl Iterator<Item = Result<(f64, Vec<f64>), StepError>> + '_ {
        trajectory(self, from.to_vec())
    }

    /// The time, at which the next step starts: see [`Stepper::time`](crate::Stepper::time).
    pub fn time(&self) -> f64 {
        self.clock().after(0)
    }

    /// Sets the time: the next step starts at `time`.
    pub fn set_time(&mut self, time: f64) {
        (self.start, self.taken, self.before) = (time, 0, 0);
        // at no time in particular the next step is not one like the last
        self.has_left &= time.is_finite();
    }

    /// The steps taken since the start, or since the time was set.
    pub fn steps_taken(&self) -> u64 {
        self.before + self.taken
    }

    /// What is carried from one step to the next: see [`Stepper::snapshot`](crate::Stepper::snapshot).
    pub fn snapshot(&self) -> Vec<f64> {
        let (mut has_left, mut left) = (self.has_left, self.left.clone());
        let mut method = self.method.lock().unwrap_or_else(PoisonError::into_inner);
        snapshot::written(self.start, [self.taken, self.before], &mut |visit| {
            show(&mut has_left, &mut left, &mut **method, visit);
        })
    }

    /// Takes back what [`snapshot`](Self::snapshot) gave, of a stepper for the same system, scheme and step.
    ///
    /// # Errors
    /// If it has not as many numbers as the memory of this stepper.
    pub fn restore(&mut self, memory: &[f64]) -> Result<(), ParameterError> {
        let method = self.method.get_mut().unwrap_or_else(PoisonError::into_inner);
        (self.start, [self.taken, self.before]) = snapshot::read(memory, &mut |visit| {
            show(&mut self.has_left, &mut self.left, &mut **method, visit);
        })?;
        // a state that is not one is to be refused, if it is that with which the run goes on; a method of one's own may have led to it
        let is_state = check_deviation(self.system.deviation(&self.left)).is_ok();
        self.is_own = self.has_left && (is_state || self.scheme.is_none());
        self.has_left = self.is_own && self.start.is_finite();
        Ok(())
    }

    /// Takes one step: see [`Stepper::step_with`](crate::Stepper::step_with).
    ///
    /// # Errors
    /// As there, or if the state has not as many numbers as the system's; state and time are then as before the call.
    pub fn step(&mut self, state: &mut [f64], control: &[f64]) -> Result<StepReport, StepError> {
        let report = if self.is_left_at(state) {
            self.follow(control)?
        } else {
            self.check(state)?;
            self.start(state, control)?
        };
        state.copy_from_slice(&self.left);
        Ok(report)
    }

    /// Takes one step driven by an input: see [`Stepper::step_driven`](crate::Stepper::step_driven).
    ///
    /// A method of [one's own](Self::from_fn) is given the control at the middle of the step.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn step_driven(
        &mut self,
        state: &mut [f64],
        mut input: impl FnMut(f64) -> Vec<f64>,
    ) -> Result<StepReport, StepError> {
        let (start, step) = (self.time(), self.step);
        let mut at = |share: f64| input(start + share * step);
        let controls = length(self.system.description().controls);
        let mut write = |share: f64, control: &mut [f64]| flat::copy(control, &at(share));
        method(&mut self.method).set_inputs(controls, Some(&mut write));
        let report = self.step(state, &at(0.5));
        method(&mut self.method).set_inputs(controls, None);
        report
    }

    /// Takes one step, and gives the derivatives of the next state: see
    /// [`Stepper::step_with_jacobian`](crate::Stepper::step_with_jacobian).
    ///
    /// ```
    /// use coadjoint::erased;
    /// use coadjoint::prelude::*;
    /// use std::sync::{Arc, Mutex, PoisonError};
    ///
    /// #[lie_poisson_system(group = SO3, derivatives)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// let body = Arc::new(Body { inertia: vector![1.0, 2.0, 2.5] });
    /// let mut stepper = erased::Stepper::new(body, &"Order4<Cayley>".parse()?, 0.01)?;
    /// let mut state = [1.0, 0.0, 0.0, 0.0, 0.4, -0.8, 1.5];
    /// let (jacobian, _) = stepper.step_with_jacobian(&mut state, &[])?;
    /// assert_eq!(jacobian.state.shape(), (6, 6));
    /// // more momentum, more turn: about h / inertia
    /// assert!((jacobian.state[(0, 3)] - 0.01).abs() < 1e-4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`step`](Self::step), or if the step has [no derivative](StepError::NoDerivative), or none was generated. State and time are then as before.
    pub fn step_with_jacobian(
        &mut self,
        state: &mut [f64],
        control: &[f64],
    ) -> Result<(Jacobian, StepReport), JacobianError> {
        self.check(state)?;
        let at = At { step: self.step, state, time: self.time(), control };
        let jacobian = jacobian::jacobian(&*self.system, self.scheme()?, &at)?;
        let report = self.step(state, control)?;
        Ok((jacobian, report))
    }

    /// Differentiates a function of the state at the end of some steps, backwards: [`CheckpointedTape`](crate::derivative::CheckpointedTape)
    /// with its types erased.
    ///
    /// `states` are those at the start of each step, the first of them at this time; `control` gives the controls of each step, counted
    /// from 0; `costate` is the function's derivative at the end, in [left-trivialized coordinates](crate::derivative#coordinates). What
    /// comes back are the derivatives with respect to the first state, to the controls of each step, and to the parameters: no numbers where the
    /// description does not ask for them. `derivatives(adjoint)` is for typed steppers.
    ///
    /// ```
    /// use coadjoint::erased;
    /// use coadjoint::prelude::*;
    /// use std::sync::Arc;
    ///
    /// #[lie_poisson_system(group = SO3, derivatives)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// let inertia = vector![1.0, 2.0, 2.5];
    /// let mut stepper = erased::Stepper::new(Arc::new(Body { inertia }), &"Cayley".parse()?, 0.01)?;
    /// let mut state = vec![1.0, 0.0, 0.0, 0.0, 0.4, -0.8, 1.5];
    /// let mut states = Vec::new();
    /// for _ in 0..1_000 {
    ///     states.push(state.clone());
    ///     stepper.step(&mut state, &[])?;
    /// }
    /// // how the momentum's x component at the end depends on the start and on the moments of inertia
    /// let gradient = stepper.gradient(0.0, &states, |_| vec![], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0])?;
    /// // all is well where the moments grow and the momentum with them: the motion is the same
    /// let along = gradient.parameters.dot(&inertia) + gradient.state.rows(3, 3).dot(&vector![0.4, -0.8, 1.5]);
    /// assert!((along - state[4]).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If a step cannot be taken from one of the states, has [no derivative](StepError::NoDerivative), or none was generated.
    pub fn gradient(
        &self,
        time: f64,
        states: &[impl AsRef<[f64]>],
        mut control: impl FnMut(usize) -> Vec<f64>,
        costate: &[f64],
    ) -> Result<Parts<DVector<f64>, Vec<DVector<f64>>>, JacobianError> {
        let scheme = self.scheme()?;
        let description = self.system.description();
        let mut state = DVector::zeros(description.state.last().map_or(0, |last| last.tangent().end));
        flat::copy(state.as_mut_slice(), costate);
        let mut parameters = None;
        let mut controls = Vec::with_capacity(states.len());
        for (k, start) in states.iter().enumerate().rev() {
            let start = start.as_ref();
            check(&*self.system, start)?;
            let (time, control) = (time + k as f64 * self.step, control(k));
            let at = At { step: self.step, state: start, time, control: &control };
            let jacobian = jacobian::jacobian(&*self.system, scheme, &at)?;
            let by_parameters = jacobian.parameters.tr_mul(&state);
            parameters = Some(
                parameters
                    .map_or_else(|| by_parameters.clone(), |before: DVector<f64>| before + &by_parameters),
            );
            controls.push(jacobian.control.tr_mul(&state));
            state = jacobian.state.tr_mul(&state);
        }
        controls.reverse();
        let parameters = parameters.unwrap_or_else(|| DVector::zeros(length(description.parameters)));
        Ok(Parts { state, control: controls, parameters })
    }

    /// The scheme; none of a method of one's own.
    fn scheme(&self) -> Result<&Scheme, JacobianError> {
        let missing = || JacobianError::NotGenerated {
            key: "derivatives",
            scheme: "a method of one's own".into(),
            system: self.system.description().name,
        };
        self.scheme.as_ref().ok_or_else(missing)
    }

    /// Whether steps can start from a state from elsewhere.
    fn check(&self, state: &[f64]) -> Result<(), StepError> {
        check_length(state, self.left.len())?;
        if self.is_own && self.is_left(state) {
            return Ok(());
        }
        check_deviation(self.system.deviation(state))
    }

    /// Takes a step from a state from elsewhere.
    fn start(&mut self, state: &[f64], control: &[f64]) -> Result<StepReport, StepError> {
        let time = self.time();
        let outcome = method(&mut self.method).advance(state, &mut self.next, time, control, false);
        self.arrive(outcome)
    }

    /// Takes a step from where the last one led to.
    #[inline]
    fn follow(&mut self, control: &[f64]) -> Result<StepReport, StepError> {
        let time = self.time();
        let outcome = method(&mut self.method).advance(&self.left, &mut self.next, time, control, true);
        self.arrive(outcome)
    }

    #[inline]
    fn arrive(&mut self, outcome: Counted<f64>) -> Result<StepReport, StepError> {
        let Advanced { iterations, residual, .. } = outcome.map_err(|failure| failure.first())?;
        core::mem::swap(&mut self.left, &mut self.next);
        (self.has_left, self.is_own) = (true, true);
        self.taken += 1;
        // of the only lane
        Ok(StepReport { iterations: iterations.iter().sum(), residual })
    }

    /// Takes `count` steps with `control` held all the time: see [`Stepper::steps_with`](crate::Stepper::steps_with).
    ///
    /// # Errors
    /// If a step cannot be taken; state and time are then the last ones that were reached.
    pub fn steps(&mut self, state: &mut [f64], control: &[f64], count: u64) -> Result<RunReport, RunError> {
        let mut report = RunReport::default();
        let mut known = self.is_left_at(state);
        // not every method takes steps together
        let mut batches = true;
        let outcome = loop {
            if known && batches {
                let (clock, most) = (self.clock(), count - report.steps);
                let method = method(&mut self.method);
                let (advanced, failure) =
                    method.advance_n(&mut self.left, &mut self.next, clock, control, most);
                batches = advanced.steps > 0;
                self.taken += advanced.steps;
                report.add_steps(&advanced);
                if let Some(failure) = failure {
                    break Err(failure.first());
                }
            }
            if report.steps == count {
                break Ok(());
            }
            let step = match known {
                true => self.follow(control),
                false => self.check(state).and_then(|()| self.start(state, control)),
            };
            match step {
                Ok(step) => report.count(&step),
                Err(cause) => break Err(cause),
            }
            known = true;
        };
        // else it is where it was
        if report.steps > 0 {
            state.copy_from_slice(&self.left);
        }
        outcome
            .map(|()| report)
            .map_err(|cause| RunError::new(self.steps_taken() + 1, self.time(), report, cause))
    }

    fn clock(&self) -> Clock {
        Clock { start: self.start, step: self.step, taken: self.taken }
    }

    fn is_left_at(&self, state: &[f64]) -> bool {
        self.has_left && self.is_left(state)
    }

    /// Whether a state is the one that the last step led to.
    fn is_left(&self, state: &[f64]) -> bool {
        let differences = self.left.iter().zip(state).map(|(a, b)| a.to_bits() ^ b.to_bits());
        state.len() == self.left.len() && differences.fold(0, |all, bits| all | bits) == 0
    }
}

/// What takes the steps.
#[inline]
fn method(method: &mut Mutex<Box<dyn Method<f64>>>) -> &mut dyn Method<f64> {
    &mut **method.get_mut().unwrap_or_else(PoisonError::into_inner)
}

/// Shows all numbers that are carried, besides the time: in the order in which the typed stepper does.
fn show(
    has_left: &mut bool,
    left: &mut [f64],
    method: &mut dyn Method<f64>,
    visit: &mut dyn FnMut(&mut [f64]),
) {
    visit_flag(has_left, visit);
    visit(left);
    method.memory(visit);
}

impl Stepping for Stepper {
    type System = dyn System;

    fn system(&self) -> &(dyn System + 'static) {
        &*self.system
    }

    as_by_itself!();

    fn step_size(&self) -> f64 {
        self.step
    }

    fn set_step_size(&mut self, step: f64) -> Result<(), ParameterError> {
        Self::set_step_size(self, step)
    }

    fn step_with(&mut self, state: &mut Vec<f64>, control: &Vec<f64>) -> Result<StepReport, StepError> {
        self.step(state, control)
    }

    fn step_driven(
        &mut self,
        state: &mut Vec<f64>,
        input: &mut dyn FnMut(f64) -> Vec<f64>,
    ) -> Result<StepReport, StepError> {
        Self::step_driven(self, state, input)
    }

    fn steps_with(
        &mut self,
        state: &mut Vec<f64>,
        control: &Vec<f64>,
        count: u64,
    ) -> Result<RunReport, RunError> {
        self.steps(state, control, count)
    }

    fn set_parameters(&mut self, parameters: &[f64]) -> Result<(), ParameterError> {
        Self::set_parameters(self, parameters)
    }

    fn step_beside(
        &self,
        state: &mut Vec<f64>,
        (start, length): (f64, f64),
        input: Inputs<'_, Vec<f64>>,
    ) -> Result<StepReport, StepError> {
        check_length(state, self.left.len())?;
        if self.scheme.is_some() {
            check_deviation(self.system.deviation(state))?;
        }
        let mut method = (self.make)(&self.system, length).ok_or(StepError::NotFinite)?;
        let mut next = state.clone();
        let outcome = match input {
            Inputs::Held(control) => method.advance(state, &mut next, start, control, false),
            Inputs::Driven(input) => {
                let mut at = |share: f64| input(start + share * length);
                let controls = self.system.no_control().len();
                let mut write = |share: f64, control: &mut [f64]| flat::copy(control, &at(share));
                method.set_inputs(controls, Some(&mut write));
                method.advance(state, &mut next, start, &at(0.5), false)
            }
        };
        let Advanced { iterations, residual, .. } = outcome.map_err(|failure| failure.first())?;
        *state = next;
        Ok(StepReport { iterations: iterations.iter().sum(), residual })
    }

    fn event_series(&self) -> Option<&dyn EventSeries<dyn System>> {
        self.series.as_ref()?.event_series()
    }

    fn go_on_at(&mut self, time: f64, steps: u64) {
        (self.start, self.taken, self.before, self.has_left) = (time, 0, steps, false);
    }
}

impl fmt::Debug for Stepper {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stepper")
            .field("system", &self.system.description().name)
            .field("step", &self.step)
            .field("time", &self.time())
            .finish_non_exhaustive()
    }
}
