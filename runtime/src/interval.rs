//! Dense output: the states within a step.

use core::fmt;

use crate::error::StepError;
use crate::scalar::Scalar;
use crate::stepper::{Inputs, StepReport, Stepping};
use crate::system::Dynamics;
use crate::system::series::Coefficients;

type StateOf<T> = <<T as Stepping>::System as Dynamics>::State;
type ControlOf<T> = <<T as Stepping>::System as Dynamics>::Control;

/// The motion within a step, as whatever produces it knows it: shares of the step go from 0 at its start to 1 at its end.
pub trait Dense<S: Dynamics + ?Sized> {
    /// The time at a share of the step.
    fn time(&self, share: f64) -> f64;
    /// The smallest difference of shares that makes one of times: some units of their roundoff.
    fn resolution(&self) -> f64;
    /// Writes the state at a share of the step.
    ///
    /// # Errors
    /// If there is none.
    fn at(&mut self, share: f64, state: &mut S::State) -> Result<(), StepError>;
    /// The state at its start.
    fn before(&self) -> &S::State;
    /// What is zero at an event of the description, in a state at a time of the step.
    fn event(&mut self, event: usize, state: &S::State, time: f64) -> f64;
    /// Writes the coefficients of an event of the description in powers of the share of a part of the step, the constant one first. The part starts at a
    /// share of the step; how many coefficients there are, and the share where it ends, if they are known: then nothing within it need be looked
    /// at to find its zeros.
    fn series(
        &mut self,
        _event: usize,
        _from: f64,
        _coefficients: &mut Coefficients,
    ) -> Option<(usize, f64)> {
        None
    }
}

/// A step that was taken, and the motion within it: dense output.
///
/// The state within the step is where the scheme's own shorter step leads to from the state before it. It is on its group, and on its coadjoint orbit, as
/// those at the ends are; it has the order of the scheme, and a smaller error; and it is continuous. To compute it takes as long as a step
/// from a new state.
///
/// ```
/// use coadjoint::Interval;
/// use coadjoint::prelude::*;
///
/// #[lie_poisson_system(group = SO3)]
/// struct Body {
///     #[inertia]
///     inertia: Vector3<f64>,
/// }
///
/// let body = Body { inertia: vector![1.0, 2.0, 2.5] };
/// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
/// let norm = state.momentum.norm();
/// let mut stepper = body.stepper::<Cayley>(0.1)?;
/// for _ in 0..10 {
///     let interval = Interval::step(&mut stepper, &mut state, NoControl::default())?;
///     assert_eq!(interval.at(1.0)?, *interval.after());
///     let middle = interval.at(0.5)?;
///     assert!((middle.momentum.norm() - norm).abs() < 1e-14);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A [`Run`](crate::Run) shows such states with [`save_at`](crate::Run::save_at).
pub struct Interval<'a, T: Stepping + ?Sized> {
    stepper: &'a T,
    before: StateOf<T>,
    after: &'a StateOf<T>,
    control: ControlOf<T>,
    start: f64,
    report: StepReport,
}

impl<'a, T: Stepping + ?Sized> Interval<'a, T> {
    /// Takes a step with a control that is held.
    ///
    /// # Errors
    /// As [`Stepper::step_with`](crate::Stepper::step_with); state and time are then as before.
    pub fn step(
        stepper: &'a mut T,
        state: &'a mut StateOf<T>,
        control: ControlOf<T>,
    ) -> Result<Self, StepError> {
        let (before, start) = (state.clone(), stepper.time());
        let report = stepper.step_with(state, &control)?;
        Ok(Self { stepper, before, after: state, control, start, report })
    }

    /// The state before the step.
    pub fn before(&self) -> &StateOf<T> {
        &self.before
    }

    /// The state after the step.
    pub fn after(&self) -> &StateOf<T> {
        self.after
    }

    /// The time at which the step starts.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// The time at which the step ends.
    pub fn end(&self) -> f64 {
        self.stepper.time()
    }

    /// How the step went.
    pub fn report(&self) -> StepReport {
        self.report
    }

    /// The state at a share of the step, from 0 at its start to 1 at its end.
    ///
    /// # Errors
    /// If there is no such share, or the shorter step cannot be taken, for the reasons that a step cannot be.
    pub fn at(&self, share: f64) -> Result<StateOf<T>, StepError> {
        let mut state = self.before.clone();
        self.part().at(share, &mut state)?;
        Ok(state)
    }

    /// The state at a time within the step.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn at_time(&self, time: f64) -> Result<StateOf<T>, StepError> {
        let mut part = self.part();
        let (share, mut state) = (part.share(time), self.before.clone());
        let outcome =
            if share.is_finite() { part.at(share, &mut state) } else { Err(StepError::OutOfReach { time }) };
        outcome.map(|()| state)
    }

    fn part(&self) -> Part<'_, T> {
        Part {
            stepper: self.stepper,
            input: Inputs::Held(&self.control),
            before: &self.before,
            after: self.after,
            start: self.start,
            end: self.stepper.time(),
            length: self.stepper.step_size(),
        }
    }
}

impl<T: Stepping + ?Sized> fmt::Debug for Interval<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Interval")
            .field("start", &self.start)
            .field("before", &self.before)
            .field("end", &self.end())
            .field("after", &self.after)
            .finish_non_exhaustive()
    }
}

/// A step, or the last part of one.
pub(crate) struct Part<'a, T: Stepping + ?Sized> {
    pub(crate) stepper: &'a T,
    pub(crate) input: Inputs<'a, ControlOf<T>>,
    pub(crate) before: &'a StateOf<T>,
    pub(crate) after: &'a StateOf<T>,
    pub(crate) start: f64,
    pub(crate) end: f64,
    /// From one to the other, without the roundoff of times.
    pub(crate) length: f64,
}

impl<T: Stepping + ?Sized> Part<'_, T> {
    /// The share at a time.
    pub(crate) fn share(&self, time: f64) -> f64 {
        // at the ends exactly, also where the step is below the roundoff of the times
        if time == self.start {
            0.0
        } else if time == self.end {
            1.0
        } else {
            (time - self.start) / (self.end - self.start)
        }
    }
}

/// Takes a power series of shares of a part to that share of it over which its terms become as small as their number can make them, and tells this
/// share. None if a coefficient is not finite.
fn converging(coefficients: &mut [f64]) -> Option<f64> {
    let count = coefficients.len();
    if count < 3 || coefficients.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let rest = Scalar::exp(-2.0 * count as f64).clamp(f64::EPSILON, 1e-6);
    let mut whole = 1.0;
    // each time the terms are closer to those of the share that is sought
    for _ in 0..MOST_CUTS {
        let size = coefficients.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let mut share = 1.0_f64;
        for (power, x) in coefficients.iter().enumerate().skip(count - 2) {
            if x.abs() > rest * size {
                share = share.min(Scalar::powf(rest * size / x.abs(), 1.0 / power as f64));
            }
        }
        if share == 1.0 {
            break;
        }
        share *= 0.95;
        whole *= share;
        let mut power = 1.0;
        for x in coefficients.iter_mut() {
            *x *= power;
            power *= share;
        }
    }
    Some(whole)
}

/// How often a part is made shorter, at most.
const MOST_CUTS: u32 = 100;

impl<T: Stepping + ?Sized> Dense<T::System> for Part<'_, T> {
    fn time(&self, share: f64) -> f64 {
        if share >= 1.0 { self.end } else { self.start + share * (self.end - self.start) }
    }

    fn resolution(&self) -> f64 {
        let largest = self.start.abs().max(self.end.abs());
        // half of four
        (2.0 * f64::EPSILON * (largest / self.length.abs()).max(1.0)).min(0.125)
    }

    fn at(&mut self, share: f64, state: &mut StateOf<T>) -> Result<(), StepError> {
        if !(0.0..=1.0).contains(&share) {
            return Err(StepError::OutOfReach { time: self.time(share) });
        }
        let length = share * self.length;
        state.clone_from(if share == 1.0 { self.after } else { self.before });
        if share == 1.0 || length == 0.0 {
            return Ok(());
        }
        self.stepper.step_beside(state, (self.start, length), self.input.again()).map(|_| ())
    }

    fn before(&self) -> &StateOf<T> {
        self.before
    }

    fn event(&mut self, event: usize, state: &StateOf<T>, time: f64) -> f64 {
        let system = self.stepper.system();
        match &mut self.input {
            Inputs::Held(control) => system.event(event, state, time, control),
            Inputs::Driven(input) => system.event(event, state, time, &input(time)),
        }
    }

    fn series(&mut self, event: usize, from: f64, coefficients: &mut Coefficients) -> Option<(usize, f64)> {
        let (start, length) = (self.start + from * (self.end - self.start), self.length - from * self.length);
        let mut state = self.before.clone();
        if from > 0.0 {
            self.at(from, &mut state).ok()?;
        }
        let series = self.stepper.event_series()?;
        let (count, known) =
            series.expand(event, &state, (start, length), self.input.again(), coefficients)?;
        let part = known * converging(coefficients.get_mut(..count)?)?;
        Some((count, if part < 1.0 { from + part * (1.0 - from) } else { 1.0 }))
    }
}
