//! The stepper: a method with its step, for people to call.

pub(crate) mod report;
pub(crate) mod stepping;
mod trajectory;

use core::fmt;
use core::marker::PhantomData;

use crate::error::{ParameterError, StepError};
use crate::method::{Advanced, Clock};
use crate::scalar::simd::loads::{apart, one_by_one};
use crate::scalar::{Components, Real, Scalar};
use crate::snapshot::{self, visit_flag};
pub use crate::system::stepper::Stepper;
pub(crate) use crate::system::stepper::check_step;
use crate::system::{Control, MethodOf, State, System};
use report::{RunError, RunReport};
pub use stepping::Stepping;
#[doc(hidden)]
pub use stepping::{EventSeries, Inputs};
pub(crate) use trajectory::trajectory;

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StepReport {
    /// Iterations made, fixed-point updates and Newton corrections alike, in all steps of a composition together.
    pub iterations: u32,
    /// The residual left in the step's equation, relative to its terms: a few units of roundoff. Of a
    /// composition, the largest.
    pub residual: f64,
}

/// How far a state's configuration may be off its group when it is handed in: more than files of few digits leave, and so little
/// that the first step puts it back.
const LARGEST_DEVIATION: f64 = 1e-3;

impl<S: System, M, D: MethodOf<S>> Stepper<S, M, D> {
    /// The system, as it was when the stepper was built.
    pub fn system(&self) -> &S {
        &self.system
    }

    /// The step size.
    pub fn step_size(&self) -> S::Scalar {
        self.step
    }

    /// The time in f64 whatever the scalar, at which the next step starts: the start plus the steps taken since, not accumulated, so that it does not drift.
    #[inline]
    pub fn time(&self) -> f64 {
        self.clock().after(0)
    }

    /// The time as a number of the system's.
    #[inline(always)]
    fn now(&self) -> S::Scalar {
        S::Scalar::of(self.time())
    }

    /// The steps taken since the start, or since the time was set.
    pub fn steps_taken(&self) -> u64 {
        self.before + self.taken
    }

    /// Sets the time: the next step starts at `time`.
    #[inline]
    pub fn set_time(&mut self, time: f64) {
        (self.start, self.taken, self.before) = (time, 0, 0);
        self.forget_at_no_time();
    }

    /// Forgets all steps: time 0, and no step taken.
    pub fn reset(&mut self) {
        (self.start, self.taken, self.before, self.left) = (0.0, 0, 0, None);
    }

    /// Takes steps of this size from now on. Time and count go on.
    ///
    /// ```
    /// use coadjoint::prelude::*;
    ///
    /// #[lie_poisson_system(group = SO3)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.4, -0.8, 1.5] };
    /// let mut stepper = Body { inertia: vector![1.0, 2.0, 2.5] }.stepper::<Cayley>(0.1)?;
    /// stepper.step(&mut state)?;
    /// stepper.set_step_size(0.05)?;
    /// stepper.step(&mut state)?;
    /// assert_eq!((stepper.time(), stepper.steps_taken()), (0.1 + 0.05, 2));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If the step is zero or not finite; the stepper is then as before.
    pub fn set_step_size(&mut self, step: S::Scalar) -> Result<(), ParameterError> {
        check_step(step.to_f64())?;
        (self.start, self.before, self.taken) = (self.time(), self.steps_taken(), 0);
        (self.step, self.left) = (step, None);
        self.method = D::new(&self.system.to_parameters(), step);
        Ok(())
    }

    /// Takes the steps of a system with other parameters from now on. Time and count go on.
    ///
    /// # Errors
    /// If the parameters are not those of a system that can move; the stepper is then as before.
    pub fn set_system(&mut self, system: &S) -> Result<(), ParameterError> {
        system.validate()?;
        let parameters = system.to_parameters();
        self.method = D::new(&parameters, self.step);
        (self.system, self.left) = (S::from_parameters(&parameters), None);
        Ok(())
    }

    /// The motion from a state on, as an iterator of times and states, the first one now; without controls. It ends after a step that could
    /// not be taken.
    ///
    /// ```
    /// use coadjoint::prelude::*;
    ///
    /// #[lie_poisson_system(group = SO3)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// let start = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
    /// let mut stepper = Body { inertia: vector![1.0, 2.0, 2.5] }.stepper::<Cayley>(0.1)?;
    /// for moment in stepper.trajectory(start).take(101) {
    ///     let (time, state) = moment?;
    ///     println!("{time:6.1} {:9.6}", state.momentum.x);
    /// }
    /// assert_eq!(stepper.time(), 10.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn trajectory(
        &mut self,
        from: S::State,
    ) -> impl Iterator<Item = Result<(f64, S::State), StepError>> + '_ {
        trajectory(self, from)
    }

    /// What the stepper carries from one step to the next, besides the state: the time, and where the last solution was. Written
    /// down with the state and given to [`restore`](Self::restore), a run goes on as if it had not been interrupted, to the last bit.
    ///
    /// ```
    /// use coadjoint::prelude::*;
    ///
    /// #[lie_poisson_system(group = SO3)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    /// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.4, -0.8, 1.5] };
    /// let mut stepper = body.stepper::<Cayley>(0.1)?;
    /// for _ in 0..10 {
    ///     stepper.step(&mut state)?;
    /// }
    /// let (memory, mut saved) = (stepper.snapshot(), state);
    ///
    /// let mut other = body.stepper::<Cayley>(0.1)?;
    /// other.restore(&memory)?;
    /// stepper.step(&mut state)?;
    /// other.step(&mut saved)?;
    /// assert_eq!((saved, other.time()), (state, stepper.time()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[cfg(feature = "std")]
    #[inline]
    pub fn snapshot(&self) -> std::vec::Vec<f64> {
        // what is shown could be replaced, so that a copy is shown
        let (mut method, mut left) = (self.method.clone(), self.left);
        snapshot::written(self.start, [self.taken, self.before], &mut |visit| {
            Self::visit(&mut left, &mut method, visit)
        })
    }

    /// Takes back what [`snapshot`](Self::snapshot) gave, of a stepper for the same system, scheme and step.
    ///
    /// The numbers are believed: those of another system, scheme or step, of which there are as many, or numbers that were changed, are not found out. With
    /// [`RightLift`](crate::RightLift) and [`Compensated`](crate::Compensated) a part of the state is among them, with the others what is remembered
    /// saves time alone.
    ///
    /// # Errors
    /// If it has not as many numbers as the memory of this stepper.
    #[inline]
    pub fn restore(&mut self, memory: &[f64]) -> Result<(), ParameterError> {
        (self.start, [self.taken, self.before]) = snapshot::read(memory, &mut |visit| {
            Self::visit(&mut self.left, &mut self.method, visit);
        })?;
        // a state that is not one is to be refused, if it is that with which the run goes on
        self.left = self.left.filter(|left| {
            let deviation = S::State::from_components(left).deviation();
            check_deviation(deviation.to_f64()).is_ok()
        });
        self.forget_at_no_time();
        Ok(())
    }

    /// At no time in particular the next step is not one like the last.
    fn forget_at_no_time(&mut self) {
        if !self.start.is_finite() {
            self.left = None;
        }
    }

    /// Shows all numbers that are carried, besides the time.
    #[inline]
    fn visit(
        left: &mut Option<S::StateComponents<S::Scalar>>,
        method: &mut D,
        visit: &mut dyn FnMut(&mut [S::Scalar]),
    ) {
        let mut is_known = left.is_some();
        visit_flag(&mut is_known, visit);
        let mut state = left.unwrap_or_else(|| S::StateComponents::splat(S::Scalar::of(0.0)));
        visit(state.as_mut());
        *left = is_known.then_some(state);
        method.memory(visit);
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
        // the step before may have stored it a moment ago, in other pieces
        let components = apart::<S::Scalar, _>(&state.to_components());
        if !self.is_left_at(&components) {
            return self.step_anew(state, control);
        }
        match self.method.advance(&components, self.now(), &control.to_components(), true) {
            Ok(Advanced { state: next, iterations, residual }) => {
                *state = S::State::from_components(&next);
                self.left = Some(next);
                self.taken += 1;
                // of the only lane
                let iterations = iterations.as_ref().iter().sum();
                Ok(StepReport { iterations, residual: residual.to_f64() })
            }
            Err(failure) => Err(failure.first()),
        }
    }

    /// Takes one step driven by an input, a function of time: see [`Run::driven_by`](crate::Run::driven_by).
    ///
    /// # Errors
    /// As [`step_with`](Self::step_with).
    pub fn step_driven(
        &mut self,
        state: &mut S::State,
        mut input: impl FnMut(f64) -> S::Control,
    ) -> Result<StepReport, StepError> {
        let (start, step) = (self.time(), self.step.to_f64());
        let mut at = |share: f64| input(start + share * step);
        self.method.set_inputs(Some(&mut |share| at(share).to_components()));
        let report = self.step_apart(state, &at(0.5));
        self.method.set_inputs(None);
        report
    }

    /// A step from a state that no step has led to, apart from the others: what it needs in memory they keep in registers.
    #[inline(never)]
    fn step_anew(&mut self, state: &mut S::State, control: &S::Control) -> Result<StepReport, StepError> {
        check_deviation(state.deviation().to_f64())?;
        let (time, control) = (self.now(), control.to_components());
        // not by the fast path, which knows nothing yet
        match self.method.advance_from(None, &state.to_components(), time, &control, false) {
            // in a function with the same lines above, what is in registers there would go through memory
            Ok(Advanced { state: next, iterations, residual }) => {
                let next = one_by_one::<S::Scalar, _>(&next);
                *state = S::State::from_components(&next);
                self.left = Some(next);
                self.taken += 1;
                let iterations = iterations.as_ref().iter().sum();
                Ok(StepReport { iterations, residual: residual.to_f64() })
            }
            Err(failure) => Err(failure.first()),
        }
    }

    /// Takes `count` steps with `control` held all the time. The result is that of as many single steps, to the last bit, and it takes less
    /// time: what happens once a step for the caller's sake, happens once here.
    ///
    /// ```
    /// use coadjoint::prelude::*;
    ///
    /// #[lie_poisson_system(group = SO3)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    /// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.4, -0.8, 1.5] };
    /// let energy = body.energy(&state);
    /// let mut stepper = body.stepper::<Cayley>(0.01)?;
    /// let report = stepper.steps_with(&mut state, &NoControl::default(), 10_000)?;
    /// assert_eq!((report.steps, stepper.time()), (10_000, 100.0));
    /// assert!((body.energy(&state) - energy).abs() < 1e-4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If a step cannot be taken, as [`step_with`](Self::step_with); state and time are then the last ones that were reached.
    #[inline]
    pub fn steps_with(
        &mut self,
        state: &mut S::State,
        control: &S::Control,
        count: u64,
    ) -> Result<RunReport, RunError> {
        let mut report = RunReport::default();
        while report.steps < count {
            let mut components = state.to_components();
            if self.is_left_at(&components) {
                let most = count - report.steps;
                let control = &control.to_components();
                let advanced =
                    self.method.advance_n::<true>(&mut components, self.clock(), control, true, most, None);
                *state = S::State::from_components(&components);
                self.left = Some(components);
                self.taken += advanced.steps;
                report.add_steps(&advanced);
                if report.steps == count {
                    break;
                }
            }
            match self.step_apart(state, control) {
                Ok(step) => report.count(&step),
                Err(cause) => return Err(RunError::new(self.steps_taken() + 1, self.time(), report, cause)),
            }
        }
        Ok(report)
    }

    /// [`step_with`](Self::step_with), compiled once for all that do not need it inlined.
    #[inline(never)]
    fn step_apart(&mut self, state: &mut S::State, control: &S::Control) -> Result<StepReport, StepError> {
        self.step_with(state, control)
    }

    #[inline(always)]
    fn clock(&self) -> Clock {
        Clock { start: self.start, step: self.step.to_f64(), taken: self.taken }
    }

    /// Whether a state is the one that the last step led to.
    #[inline(always)]
    fn is_left_at(&self, state: &S::StateComponents<S::Scalar>) -> bool {
        match &self.left {
            Some(left) => is_same(one_by_one::<S::Scalar, _>(left).as_ref(), state.as_ref()),
            None => false,
        }
    }
}

/// Whether all numbers are the same, without a branch.
#[inline(always)]
pub(crate) fn is_same<T: Real>(a: &[T], b: &[T]) -> bool {
    a.iter().zip(b).fold(true, |same, (a, b)| same & a.is_same(*b))
}

/// A state from elsewhere is on its group, more or less.
#[cold]
#[inline]
pub(crate) fn check_deviation(deviation: f64) -> Result<(), StepError> {
    if !deviation.is_finite() {
        Err(StepError::NotFinite)
    } else if deviation > LARGEST_DEVIATION {
        Err(StepError::NotOnGroup { deviation })
    } else {
        Ok(())
    }
}

/// A state from elsewhere is finite and on its group, more or less.
#[cfg(feature = "std")]
pub(crate) fn check_state(components: &[f64], deviation: f64) -> Result<(), StepError> {
    if components.iter().all(|x| x.is_finite()) {
        check_deviation(deviation)
    } else {
        Err(StepError::NotFinite)
    }
}

impl<S: System, M, D: MethodOf<S>> Clone for Stepper<S, M, D> {
    fn clone(&self) -> Self {
        let system = S::from_parameters(&self.system.to_parameters());
        let Self { step, start, taken, before, left, .. } = *self;
        Self { system, method: self.method.clone(), scheme: PhantomData, step, start, taken, before, left }
    }
}

impl<S: System, M, D: MethodOf<S>> fmt::Debug for Stepper<S, M, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stepper")
            .field("system", &S::NAME)
            .field("scheme", &core::any::type_name::<M>())
            .field("step", &self.step)
            .field("time", &self.time())
            .finish_non_exhaustive()
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::composition::Order6;
    use crate::retraction::{Cayley, Exponential};
    use crate::scheme::{StormerVerlet, SymplecticEulerA};
    use crate::system::Discretized;
    use crate::system::{NoControl, System};
    use crate::tests::{Body, BodyState, Oscillator, OscillatorControl, OscillatorState};
    use nalgebra::{UnitQuaternion, Vector3};

    const DRIVEN: Oscillator = Oscillator { mass: 1.5, stiffness: 4.0, drive: 0.7 };
    const START: OscillatorState = OscillatorState::new(0.3, -0.2);

    #[test]
    fn an_explicit_step_is_reported_as_solved() {
        let mut state = START;
        let mut stepper = DRIVEN.stepper::<StormerVerlet>(0.1).expect("valid");
        let report = stepper.step(&mut state).expect("explicit");
        assert_eq!(report, StepReport { iterations: 0, residual: 0.0 });
        assert_ne!(state, START);
    }

    /// Forth and, with the controls in reverse, back.
    fn comes_back<M>()
    where
        Oscillator: Discretized<M>,
    {
        let control = |k: u32| OscillatorControl::new(f64::from(k % 7) - 2.5);
        let mut state = START;
        let mut there: Stepper<_, M> = DRIVEN.stepper(0.05).expect("valid");
        there.set_time(1.25);
        for k in 0..900 {
            there.step_with(&mut state, &control(k)).expect("explicit");
        }
        assert!(state.distance(&START) > 0.1, "{state:?}");
        let mut back: Stepper<_, M> = DRIVEN.stepper(-0.05).expect("valid");
        back.set_time(there.time());
        for k in (0..900).rev() {
            back.step_with(&mut state, &control(k)).expect("explicit");
        }
        assert!(state.distance(&START) < 1e-12, "{state:?}");
        assert!((back.time() - 1.25).abs() < 1e-13);
    }

    #[test]
    fn symmetric_steps_are_undone() {
        comes_back::<StormerVerlet>();
        comes_back::<Exponential>();
        comes_back::<Order6<Exponential>>();
    }

    #[test]
    fn time_counts_steps_and_does_not_drift() {
        let mut state = START;
        let mut stepper = DRIVEN.stepper::<StormerVerlet>(0.1).expect("valid");
        assert_eq!(stepper.time(), 0.0);
        stepper.set_time(5.0);
        for _ in 0..1000 {
            stepper.step(&mut state).expect("explicit");
        }
        assert_eq!(stepper.time(), 105.0);
        assert_eq!(stepper.clone().time(), 105.0);
        stepper.set_time(-1.0);
        assert_eq!(stepper.time(), -1.0);
        stepper.step(&mut state).expect("explicit");
        assert_eq!(stepper.time(), -0.9);
    }

    #[test]
    fn a_step_depends_on_time_and_control() {
        let after = |time: f64, force: Option<f64>| {
            let mut state = START;
            let mut stepper = DRIVEN.stepper::<SymplecticEulerA>(0.5).expect("valid");
            stepper.set_time(time);
            match force {
                Some(force) => stepper.step_with(&mut state, &OscillatorControl::new(force)),
                None => stepper.step(&mut state),
            }
            .expect("explicit");
            state.momentum.x
        };
        let expected = |time: f64, force: f64| -0.2 + 0.5 * (0.7 * time.sin() - 4.0 * 0.3 + force);
        for (time, force) in [(0.0, 0.0), (1.0, 0.0), (1.0, 3.0), (-20.0, -1.0)] {
            let (is, should_be): (f64, f64) = (after(time, Some(force)), expected(time, force));
            assert!((is - should_be).abs() < 1e-15, "{is} instead of {should_be}");
        }
        assert_eq!(after(1.0, None), after(1.0, Some(0.0)));
    }

    #[test]
    fn an_error_leaves_state_and_time() {
        let mut state = START;
        let mut stepper = DRIVEN.stepper::<Order6<Exponential>>(0.25).expect("valid");
        stepper.step(&mut state).expect("explicit");
        let (before, time) = (state, stepper.time());
        for force in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
            let report = stepper.step_with(&mut state, &OscillatorControl::new(force));
            assert_eq!(report, Err(StepError::NotFinite));
            assert_eq!((&state, stepper.time()), (&before, time));
        }
        stepper.set_time(f64::INFINITY);
        assert_eq!(stepper.step(&mut state), Err(StepError::NotFinite));
        assert_eq!((&state, stepper.time()), (&before, f64::INFINITY));

        // and what comes next is as if nothing had been
        stepper.set_time(time);
        stepper.step(&mut state).expect("explicit");
        let mut undisturbed = START;
        let mut stepper = DRIVEN.stepper::<Order6<Exponential>>(0.25).expect("valid");
        for _ in 0..2 {
            stepper.step(&mut undisturbed).expect("explicit");
        }
        assert_eq!(state, undisturbed);
    }

    #[test]
    fn what_is_off_its_group_is_refused() {
        let body = Body { inertia: Vector3::new(1.0, 2.0, 3.0) };
        let attitude = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(1.5, 0.0, 0.0, 0.0));
        let mut state = BodyState { attitude, momentum: Vector3::x() };
        let mut stepper = body.stepper::<Cayley>(0.1).expect("valid");
        let error = stepper.step_with(&mut state, &NoControl::default()).expect_err("too long");
        assert_eq!(error, StepError::NotOnGroup { deviation: 0.5 });
        assert_eq!(stepper.time(), 0.0);
        assert_eq!(
            std::format!("{error}"),
            "the configuration is off its group by 5.0e-1: rotations have unit length, matrices satisfy the equations of their group"
        );
    }

    /// In generic code a bare retraction is a scheme like any other.
    #[test]
    fn a_bare_retraction_is_the_standard_scheme() {
        fn step<S: Discretized<M>, M>(system: &S, mut state: S::State) -> S::State {
            let mut stepper = system.stepper::<M>(S::Scalar::of(0.1)).expect("valid");
            stepper.step(&mut state).expect("solvable");
            state
        }
        let body = Body { inertia: Vector3::new(1.0, 2.0, 3.0) };
        let state =
            BodyState { attitude: UnitQuaternion::identity(), momentum: Vector3::new(0.3, -0.5, 0.8) };
        assert_eq!(step::<_, Cayley>(&body, state), step::<_, SymplecticEulerA<Cayley>>(&body, state));
        assert_eq!(step::<_, Exponential>(&DRIVEN, START), step::<_, StormerVerlet>(&DRIVEN, START));
    }
}
