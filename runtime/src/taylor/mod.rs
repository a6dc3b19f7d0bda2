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

#[cfg(all(feature = "std", target_arch = "x86_64"))]
mod together;

use core::fmt;

use crate::error::{ParameterError, StepError};
#[cfg(feature = "std")]
use crate::run::Run;
#[cfg(feature = "std")]
use crate::scalar::instructions::Instructions;
use crate::scalar::{Batch, Components as _, Real, Scalar as _};
use crate::stepper::report::{RunError, RunReport};
use crate::stepper::{EventSeries, Inputs, StepReport, Stepping, check_deviation, check_step};
#[cfg(doc)]
use crate::system::System;
pub use crate::system::adaptive::Adaptive;
use crate::system::adaptive::LEAST_ORDER;
use crate::system::input;
use crate::system::length::Length;
use crate::system::pace::{Pace, Wanted};
use crate::system::series;
pub use crate::system::series::PowerSeries;
use crate::system::series::{Advance, Coefficients, MOST_COEFFICIENTS, Start};
#[doc(hidden)]
pub use crate::system::series::{Leading, Next, SeriesVisitor};
use crate::system::{Control, Dynamics, State};

/// The calls of [`Stepping`] that are those of a pace, and of the largest that each number of an input has been:
/// `carried` and `carried_mut` say where both are.
macro_rules! by_pace {
    () => {
        fn time(&self) -> f64 {
            self.carried().0.time()
        }

        fn set_time(&mut self, time: f64) {
            let (pace, sizes) = self.carried_mut();
            pace.set_time(time);
            sizes.fill(0.0);
        }

        fn steps_taken(&self) -> u64 {
            self.carried().0.taken
        }

        /// The length of the last step, with the sign of the way to the end that is set; before the first that way.
        fn step_size(&self) -> f64 {
            self.carried().0.step_size()
        }

        /// Takes steps of this length from now on, whatever the tolerance.
        fn set_step_size(&mut self, step: f64) -> Result<(), ParameterError> {
            crate::stepper::check_step(step)?;
            self.carried_mut().0.fixed = Some(step);
            Ok(())
        }

        fn is_adaptive(&self) -> bool {
            self.carried().0.fixed.is_none()
        }

        fn set_end(&mut self, time: f64) {
            self.carried_mut().0.end = time;
        }

        fn has_ended(&self) -> bool {
            self.carried().0.has_ended()
        }

        #[cfg(feature = "std")]
        fn snapshot(&self) -> std::vec::Vec<f64> {
            let (pace, sizes) = self.carried();
            pace.snapshot(sizes)
        }

        fn restore(&mut self, memory: &[f64]) -> Result<(), ParameterError> {
            let (pace, sizes) = self.carried_mut();
            pace.restore(sizes, memory)
        }

        fn go_on_at(&mut self, time: f64, steps: u64) {
            let (pace, _) = self.carried_mut();
            pace.set_time(time);
            pace.taken = steps;
        }

        fn steps_with(
            &mut self,
            state: &mut <Self::System as crate::system::Dynamics>::State,
            control: &<Self::System as crate::system::Dynamics>::Control,
            count: u64,
        ) -> Result<RunReport, RunError> {
            crate::taylor::steps_with(self, state, control, count)
        }
    };
}
#[cfg(feature = "std")]
pub(crate) use by_pace;

impl<S: PowerSeries> Adaptive<S> {
    /// Takes steps of this order, whatever the tolerance: from 4 to 32.
    ///
    /// The step's length then follows from the order, as if it had been chosen for the tolerance `e^{2 − 2N}`.
    pub fn with_order(mut self, order: usize) -> Self {
        self.set_order(order);
        self
    }

    pub(crate) fn set_order(&mut self, order: usize) {
        self.series.set_order(order.clamp(LEAST_ORDER, MOST_COEFFICIENTS));
    }

    /// Takes steps of this length, whatever their error.
    ///
    /// # Errors
    /// If the step is zero or not finite.
    pub fn with_step(mut self, step: f64) -> Result<Self, ParameterError> {
        check_step(step)?;
        self.pace.fixed = Some(step);
        Ok(self)
    }

    /// Takes no longer steps than this; an infinite or negative bound is none.
    pub fn with_max_step(mut self, step: f64) -> Self {
        self.pace.bound(step);
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
        self.sizes = S::ControlComponents::splat(0.0);
    }

    /// What is carried from one step to the next.
    pub(crate) fn carried(&self) -> (&Pace, &[f64]) {
        (&self.pace, self.sizes.as_ref())
    }

    /// The same.
    pub(crate) fn carried_mut(&mut self) -> (&mut Pace, &mut [f64]) {
        (&mut self.pace, self.sizes.as_mut())
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
        self.next_step(state, Inputs::Held(control))
    }

    fn next_step(&mut self, state: &mut S::State, input: Inputs<'_, S::Control>) -> Result<f64, StepError> {
        match self.pace.next()? {
            Some(wanted) => self.advance(state, input, wanted),
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
        self.next_toward(state, Inputs::Held(control), time)
    }

    fn next_toward(
        &mut self,
        state: &mut S::State,
        input: Inputs<'_, S::Control>,
        time: f64,
    ) -> Result<f64, StepError> {
        match self.pace.toward(time)? {
            Some(wanted) => self.advance(state, input, wanted),
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
        self.all_toward(state, Inputs::Held(control), time)
    }

    fn all_toward(
        &mut self,
        state: &mut S::State,
        mut input: Inputs<'_, S::Control>,
        time: f64,
    ) -> Result<RunReport, RunError> {
        let mut report = RunReport::default();
        loop {
            match self.next_toward(state, input.again(), time) {
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
        input: Inputs<'_, S::Control>,
        wanted: Wanted,
    ) -> Result<f64, StepError> {
        match input {
            Inputs::Held(control) => self.advance_with(state, control, None, wanted),
            Inputs::Driven(input) => self.advance_driven(state, input, wanted),
        }
    }

    /// Finds a step over which a polynomial is as close to the input as the tolerance, and takes it, or a part of it.
    fn advance_driven(
        &mut self,
        state: &mut S::State,
        input: &mut dyn FnMut(f64) -> S::Control,
        wanted: Wanted,
    ) -> Result<f64, StepError> {
        let mut first = 0.0;
        if self.pace.last.is_none() && self.pace.fixed.is_none() {
            let before = self.pace;
            let step = self.advance_with(&mut state.clone(), &input(self.time()), None, wanted);
            self.pace.undo(before);
            first = step?;
        }
        let zero = S::ControlComponents::<f64>::splat(0.0);
        let mut ask = |time: f64| {
            let (control, mut numbers) = (input(time).to_components(), zero);
            for (to, number) in numbers.as_mut().iter_mut().zip(control.as_ref()) {
                *to = number.to_f64();
            }
            numbers
        };
        let accuracy = (self.order(), self.tolerance);
        let (polynomial, wanted) =
            input::fitted((&self.pace, wanted, first), accuracy, &mut self.sizes, &mut ask);
        let mut control = S::ControlComponents::<S::Scalar>::splat(S::Scalar::of(0.0));
        let first = polynomial.order(0).map_or(&[][..], |first| first.as_ref());
        for (to, number) in control.as_mut().iter_mut().zip(first) {
            *to = S::Scalar::of(*number);
        }
        self.advance_with(state, &S::Control::from_components(&control), Some(&polynomial), wanted)
    }

    fn advance_with(
        &mut self,
        state: &mut S::State,
        control: &S::Control,
        input: Option<&series::Input<S>>,
        wanted: Wanted,
    ) -> Result<f64, StepError> {
        self.check(state, control)?;
        let time = S::Scalar::of(self.time());
        let (components, control_components) = (state.to_components(), control.to_components());
        let mut velocity = self.system.start_velocity(state, time, control);
        series::write_rates::<S, _>(&mut velocity, input);
        let before = self.pace.begin();
        let (checked, next) = <S::Scalar as Batch>::dispatch_wide(Advance {
            series: &mut self.series,
            start: Start {
                parameters: &self.system.to_parameters(),
                state: &components,
                time,
                control: &control_components,
                velocity: &velocity,
                input,
            },
            before: S::Scalar::all(before),
            length: S::Scalar::all(wanted.length),
        });
        let (step, share) = (checked.steps.as_ref()[0], checked.shares.as_ref()[0]);
        self.pace.took((step, share), are_finite(next.as_ref()), wanted.end)?;
        *state = S::State::from_components(&next);
        Ok(step)
    }

    /// Whether a step can start there.
    #[inline]
    fn check(&self, state: &S::State, control: &S::Control) -> Result<(), StepError> {
        check_deviation(state.deviation().to_f64())?;
        let time = S::Scalar::of(self.time());
        let are_all_finite = are_finite(state.to_components().as_ref())
            && are_finite(control.to_components().as_ref())
            && time.is_finite();
        if are_all_finite { Ok(()) } else { Err(StepError::NotFinite) }
    }
}

fn are_finite<T: Real>(numbers: &[T]) -> bool {
    numbers.iter().all(|x| x.is_finite())
}

/// Takes many trajectories to one time, each with its own steps, parameters and tolerance, all with their controls zero.
///
/// Each ends as if it were taken alone, to the last bit: members of one system go side by side in the registers of the processor, where it has wide
/// ones, and with the feature `parallel` on all cores. One that fails stays where it came to, and
/// its error stands in its place of what is returned; the rest go on.
///
/// ```
/// use coadjoint::prelude::*;
/// use coadjoint::taylor;
///
/// #[lie_poisson_system(group = SO3, taylor)]
/// #[derive(Clone)]
/// struct Body {
///     #[inertia]
///     inertia: Vector3<f64>,
/// }
///
/// let body = Body { inertia: vector![1.0, 2.0, 2.5] };
/// let state = |k: u32| BodyState {
///     attitude: UnitQuaternion::identity(),
///     momentum: vector![0.01, 2.0, 1e-4 * f64::from(k)],
/// };
/// let mut members = (0..10).map(|k| Ok((body.adaptive(1e-9)?, state(k)))).collect::<Result<Vec<_>, ParameterError>>()?;
/// for time in [1.0, 2.0, 3.0] {
///     let reports = taylor::all_to(&mut members, time);
///     assert!(reports.iter().all(Result::is_ok));
/// }
/// let (mut alone, mut trajectory) = (state(7), body.adaptive(1e-9)?);
/// [1.0, 2.0, 3.0].into_iter().try_for_each(|time| trajectory.to(&mut alone, time).map(|_| ()))?;
/// assert_eq!(members[7].1, alone);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[cfg(feature = "std")]
pub fn all_to<T>(
    members: &mut [(T, <T::System as Dynamics>::State)],
    time: f64,
) -> std::vec::Vec<Result<RunReport, RunError>>
where
    T: Beside + Send,
    <T::System as Dynamics>::State: Send,
{
    all_to_with(members, time, Instructions::widest())
}

/// As [`all_to`], with arithmetic compiled for certain instructions; where the processor has not those, each member is taken alone.
#[cfg(feature = "std")]
pub fn all_to_with<T>(
    members: &mut [(T, <T::System as Dynamics>::State)],
    time: f64,
    instructions: Instructions,
) -> std::vec::Vec<Result<RunReport, RunError>>
where
    T: Beside + Send,
    <T::System as Dynamics>::State: Send,
{
    let some = |members: &mut [(T, <T::System as Dynamics>::State)]| T::some_to(members, time, instructions);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        // some for each thread to take when it has done with others
        let parts = 4 * rayon::current_num_threads();
        let length = members.len().div_ceil(parts).next_multiple_of(MOST_LANES);
        members.par_chunks_mut(length.max(MOST_LANES)).flat_map_iter(some).collect()
    }
    #[cfg(not(feature = "parallel"))]
    some(members)
}

/// Members of an ensemble.
#[doc(hidden)]
#[cfg(feature = "std")]
pub trait Beside: Stepping + Sized {
    /// Takes each member to a time, several side by side where that is quicker.
    fn some_to(
        members: &mut [(Self, <Self::System as Dynamics>::State)],
        time: f64,
        _instructions: Instructions,
    ) -> std::vec::Vec<Result<RunReport, RunError>> {
        members.iter_mut().map(|(trajectory, state)| Run::new(trajectory, state).to(time)).collect()
    }
}

#[cfg(feature = "std")]
impl<S: PowerSeries> Beside for Adaptive<S> {
    #[cfg(target_arch = "x86_64")]
    fn some_to(
        members: &mut [(Self, S::State)],
        time: f64,
        instructions: Instructions,
    ) -> std::vec::Vec<Result<RunReport, RunError>> {
        together::some_to(members, time, instructions)
    }
}

impl<S: PowerSeries> Stepping for Adaptive<S> {
    type System = S;

    fn system(&self) -> &S {
        Self::system(self)
    }

    by_pace!();

    fn step_with(&mut self, state: &mut S::State, control: &S::Control) -> Result<StepReport, StepError> {
        Self::step_with(self, state, control).map(|_| EXPLICIT)
    }

    fn step_driven(
        &mut self,
        state: &mut S::State,
        input: &mut dyn FnMut(f64) -> S::Control,
    ) -> Result<StepReport, StepError> {
        self.next_step(state, Inputs::Driven(input)).map(|_| EXPLICIT)
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
        if self.pace.covers(start, length) {
            // within the last step, whose series are there
            *state = S::State::from_components(&self.series.state(S::Scalar::of(length)));
            return Ok(EXPLICIT);
        }
        let mut beside = self.of(S::from_parameters(&self.system.to_parameters()));
        beside.pace.set_time(start);
        beside.pace.end = f64::INFINITY;
        beside.all_toward(state, input, start + length).map_err(|error| error.cause)?;
        Ok(EXPLICIT)
    }

    fn event_series(&self) -> Option<&dyn EventSeries<S>> {
        Some(self)
    }
}

impl<S: PowerSeries> EventSeries<S> for Adaptive<S> {
    fn expand(
        &self,
        event: usize,
        state: &S::State,
        (start, length): (f64, f64),
        input: Inputs<'_, S::Control>,
        coefficients: &mut Coefficients,
    ) -> Option<(usize, f64)> {
        if self.pace.is_last(start, length) {
            return Some((self.series.event(event, length, coefficients)?, 1.0));
        }
        if !S::EVENTS_WITH_SERIES.contains(&event) {
            return None;
        }
        let mut beside = self.of(S::from_parameters(&self.system.to_parameters()));
        beside.pace.set_time(start);
        let known = match input {
            Inputs::Held(control) => {
                // be it that the state at its end is none: the series tells by itself how far it goes
                let _ =
                    beside.advance_with(&mut state.clone(), control, None, Length::Exactly(length).into());
                length
            }
            Inputs::Driven(input) => {
                // as far as a polynomial is close to it
                beside.pace.last = Some(length);
                beside.advance_driven(&mut state.clone(), input, Length::AtMost(length).into()).ok()?
            }
        };
        Some((beside.series.event(event, known, coefficients)?, known / length))
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

/// How many members are side by side at most.
#[cfg(feature = "parallel")]
const MOST_LANES: usize = 8;

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
        let (series, sizes) = (self.series.clone(), self.sizes);
        Self { system, tolerance: self.tolerance, pace: self.pace, series, sizes }
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
