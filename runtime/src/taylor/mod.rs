//! Taylor steps: one trajectory to many digits, with steps as long as a tolerance allows.
//!
//! The motion is a power series in time whose coefficients follow from each other by recurrences, which the generator derives for descriptions with the key
//! `taylor`. The end of a step is put back on the group and the coadjoint orbit by the group element that was integrated along: Casimirs and
//! attitude are kept to rounding at every tolerance, the energy to the tolerance. A step is no symplectic map: over very long times the steps of
//! [`Stepper`](crate::Stepper) keep more.
//!
//! ```
//! use coadjoint::prelude::*;
//!
//! /// A rigid body that turns about a fixed point under gravity.
//! #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi), taylor)]
//! struct Top {
//!     #[inertia]
//!     inertia: Vector3<f64>,
//!     weight: f64,
//!     chi: Vector3<f64>,
//! }
//!
//! let top = Top { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: vector![0.3, 0.2, 1.0] };
//! let mut state =
//!     TopState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0], gamma: Vector3::z() };
//! let energy = top.energy(&state);
//! let mut trajectory = top.adaptive(1e-12)?;
//! trajectory.to(&mut state, 100.0)?;
//! assert_eq!(trajectory.time(), 100.0);
//! assert!((top.energy(&state) - energy).abs() < 1e-11);
//! assert!((state.gamma.norm() - 1.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use core::fmt;

mod pace;

use crate::error::{ParameterError, StepError};
use crate::scalar::{Batch, Real, Scalar as _};
use crate::stepper::report::{RunError, RunReport};
use crate::stepper::{Inputs, StepReport, Stepping, check_deviation};
#[cfg(doc)]
use crate::system::System;
pub use crate::system::adaptive::Adaptive;
use crate::system::adaptive::LEAST_ORDER;
pub use crate::system::series::PowerSeries;
use crate::system::series::{Advance, MOST_COEFFICIENTS, Start};
#[doc(hidden)]
pub use crate::system::series::{Leading, Next, SeriesVisitor};
use crate::system::{Control, Dynamics, State};
pub(crate) use pace::{Pace, Wanted};

impl<S: PowerSeries> Adaptive<S> {
    /// Takes steps of this order, whatever the tolerance: from 4 to 32.
    ///
    /// The step's length then follows from the order, as if it had been chosen for the tolerance `e^{2 − 2N}`.
    pub fn with_order(mut self, order: usize) -> Self {
        self.series.set_order(order.clamp(LEAST_ORDER, MOST_COEFFICIENTS));
        self
    }

    /// Takes steps of this length, whatever their error.
    ///
    /// # Errors
    /// If the step is zero or not finite.
    pub fn with_step(mut self, step: f64) -> Result<Self, ParameterError> {
        self.pace.set_step_size(step)?;
        Ok(self)
    }

    /// Takes no longer steps than this; an infinite or negative bound is none.
    pub fn with_max_step(mut self, step: f64) -> Self {
        self.pace.most = if step > 0.0 { step } else { f64::INFINITY };
        self
    }

    /// The system, as it was when this was built.
    pub fn system(&self) -> &S {
        &self.system
    }

    /// The tolerance.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The order of the steps.
    pub fn order(&self) -> usize {
        self.series.order()
    }

    /// The time at which the next step starts.
    pub fn time(&self) -> f64 {
        self.pace.time()
    }

    /// Sets the time: the next step starts at `time`.
    pub fn set_time(&mut self, time: f64) {
        self.pace.set_time(time);
    }

    /// The steps taken.
    pub fn steps_taken(&self) -> u64 {
        self.pace.taken
    }

    /// The length of the last step; 0 before the first.
    pub fn last_step(&self) -> f64 {
        self.pace.last.unwrap_or(0.0)
    }

    /// Takes one step forward in time with all controls zero. Returns its length.
    ///
    /// # Errors
    /// As [`step_with`](Self::step_with).
    pub fn step(&mut self, state: &mut S::State) -> Result<f64, StepError> {
        self.step_with(state, &S::Control::default())
    }

    /// Takes one step forward in time with `control` held. Returns its length.
    ///
    /// # Errors
    /// If the state, the time or the control is not finite, or the state's configuration not on its group; or if the step would be so short that time
    /// does not go on, as before a singularity. State and time are then as before the call.
    pub fn step_with(&mut self, state: &mut S::State, control: &S::Control) -> Result<f64, StepError> {
        match self.pace.next()? {
            Some(length) => self.advance(state, control, length),
            None => Ok(0.0),
        }
    }

    /// Takes one step toward a time with `control` held, and no farther. Returns its length; 0 where it is that time.
    ///
    /// # Errors
    /// As [`step_with`](Self::step_with); and if the time is not finite.
    pub fn step_toward(
        &mut self,
        state: &mut S::State,
        control: &S::Control,
        time: f64,
    ) -> Result<f64, StepError> {
        match self.pace.toward(time)? {
            Some(length) => self.advance(state, control, length),
            None => Ok(0.0),
        }
    }

    /// Takes steps until a time with all controls zero, forward or backward. The last one ends there.
    ///
    /// # Errors
    /// If a step cannot be taken; state and time are then the last ones that were reached.
    pub fn to(&mut self, state: &mut S::State, time: f64) -> Result<RunReport, RunError> {
        self.to_with(state, &S::Control::default(), time)
    }

    /// Takes steps until a time with `control` held.
    ///
    /// # Errors
    /// As [`to`](Self::to).
    pub fn to_with(
        &mut self,
        state: &mut S::State,
        control: &S::Control,
        time: f64,
    ) -> Result<RunReport, RunError> {
        let mut report = RunReport::default();
        loop {
            match self.step_toward(state, control, time) {
                Ok(0.0) => return Ok(report),
                Ok(_) => report.count(&EXPLICIT),
                Err(cause) => return Err(RunError::new(self.steps_taken() + 1, self.time(), report, cause)),
            }
        }
    }

    /// The state within the last step, from 0 at its start to 1 at its end: on the group and the orbit, and as accurate as the end. None before the
    /// first step, and outside of it.
    pub fn at(&self, share: f64) -> Option<S::State> {
        let within = self.pace.share(share)?;
        Some(S::State::from_components(&self.series.state(S::Scalar::of(within))))
    }

    fn advance(
        &mut self,
        state: &mut S::State,
        control: &S::Control,
        length: Wanted,
    ) -> Result<f64, StepError> {
        check_deviation(state.deviation().to_f64())?;
        let time = S::Scalar::of(self.time());
        let components = state.to_components();
        let control_components = control.to_components();
        let is_finite = |numbers: &[S::Scalar]| numbers.iter().all(|x| x.is_finite());
        if !is_finite(components.as_ref()) || !is_finite(control_components.as_ref()) || !time.is_finite() {
            return Err(StepError::NotFinite);
        }
        let velocity = self.system.start_velocity(state, time, control);
        let before = self.pace.begin();
        let (step, next) = <S::Scalar as Batch>::dispatch_wide(Advance {
            series: &mut self.series,
            start: Start {
                parameters: &self.system.to_parameters(),
                state: &components,
                time,
                control: &control_components,
                velocity: &velocity,
            },
            before,
            length: length.length,
        });
        self.pace.took(step, is_finite(next.as_ref()), length.end)?;
        *state = S::State::from_components(&next);
        Ok(step)
    }
}

impl<S: PowerSeries> Stepping for Adaptive<S> {
    type System = S;

    fn system(&self) -> &S {
        Self::system(self)
    }

    fn time(&self) -> f64 {
        Self::time(self)
    }

    fn set_time(&mut self, time: f64) {
        Self::set_time(self, time);
    }

    fn steps_taken(&self) -> u64 {
        Self::steps_taken(self)
    }

    /// The length of the last step, with the sign of the way to the end that is set; before the first that way.
    fn step_size(&self) -> f64 {
        self.pace.step_size()
    }

    /// Takes steps of this length from now on, whatever the tolerance.
    fn set_step_size(&mut self, step: f64) -> Result<(), ParameterError> {
        self.pace.set_step_size(step)
    }

    fn is_adaptive(&self) -> bool {
        self.pace.fixed.is_none()
    }

    fn set_end(&mut self, time: f64) {
        self.pace.end = time;
    }

    fn has_ended(&self) -> bool {
        self.pace.has_ended()
    }

    #[cfg(feature = "std")]
    fn snapshot(&self) -> std::vec::Vec<f64> {
        self.pace.snapshot().to_vec()
    }

    fn restore(&mut self, memory: &[f64]) -> Result<(), ParameterError> {
        self.pace.restore(memory)
    }

    fn step_with(&mut self, state: &mut S::State, control: &S::Control) -> Result<StepReport, StepError> {
        Self::step_with(self, state, control).map(|_| EXPLICIT)
    }

    fn step_driven(
        &mut self,
        _: &mut S::State,
        _: &mut dyn FnMut(f64) -> S::Control,
    ) -> Result<StepReport, StepError> {
        Err(StepError::NotDriven)
    }

    fn steps_with(
        &mut self,
        state: &mut S::State,
        control: &S::Control,
        count: u64,
    ) -> Result<RunReport, RunError> {
        steps_with(self, state, control, count)
    }

    fn set_parameters(&mut self, system: &S) -> Result<(), ParameterError> {
        system.validate()?;
        self.system = S::from_parameters(&system.to_parameters());
        self.pace.leave();
        Ok(())
    }

    fn step_beside(
        &self,
        state: &mut S::State,
        (start, length): (f64, f64),
        input: Inputs<'_, S::Control>,
    ) -> Result<StepReport, StepError> {
        let Inputs::Held(control) = input else { return Err(StepError::NotDriven) };
        if self.pace.covers(start, length) {
            // within the last step, whose series are there
            *state = S::State::from_components(&self.series.state(S::Scalar::of(length)));
            return Ok(EXPLICIT);
        }
        let mut beside = self.of(S::from_parameters(&self.system.to_parameters()));
        beside.pace.set_time(start);
        beside.pace.end = f64::INFINITY;
        beside.to_with(state, control, start + length).map_err(|error| error.cause)?;
        Ok(EXPLICIT)
    }

    fn go_on_at(&mut self, time: f64, steps: u64) {
        self.pace.set_time(time);
        self.pace.taken = steps;
    }
}

/// Takes steps one by one.
pub(crate) fn steps_with<T: Stepping + ?Sized>(
    stepper: &mut T,
    state: &mut <T::System as Dynamics>::State,
    control: &<T::System as Dynamics>::Control,
    count: u64,
) -> Result<RunReport, RunError> {
    let mut report = RunReport::default();
    while report.steps < count {
        match stepper.step_with(state, control) {
            Ok(step) => report.count(&step),
            Err(cause) => {
                let (step, time) = (stepper.steps_taken() + 1, stepper.time());
                return Err(RunError::new(step, time, report, cause));
            }
        }
    }
    Ok(report)
}

/// There is no equation to solve.
pub(crate) const EXPLICIT: StepReport = StepReport { iterations: 0, residual: 0.0 };

impl<S: PowerSeries + Clone> Clone for Adaptive<S> {
    fn clone(&self) -> Self {
        self.of(self.system.clone())
    }
}

impl<S: PowerSeries> Adaptive<S> {
    /// The same for a system.
    fn of(&self, system: S) -> Self {
        Self { system, tolerance: self.tolerance, pace: self.pace, series: self.series.clone() }
    }
}

impl<S: PowerSeries> fmt::Debug for Adaptive<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Adaptive")
            .field("system", &S::NAME)
            .field("tolerance", &self.tolerance)
            .field("order", &self.order())
            .field("time", &self.time())
            .finish_non_exhaustive()
    }
}
