//! What takes a step: [one solved equation](crate::solve), or several steps composed.
//!
//! Over one number or over several side by side: what fails then fails in its lane, and the others go on.

use crate::error::StepError;
use crate::scalar::simd::lanes::{Portable, Processor};
use crate::scalar::{Batch, Components, LongWork, On, Real, Scalar, Work};
use crate::snapshot::visit_flag;

/// A discretization of one system with one step size, on flat arrays.
pub trait Method: Clone + Send + Sync {
    /// With what its steps are compiled: a kernel of its.
    type CallSite: Send + Sync + 'static;
    /// `f64`, `f32`, or lanes of them.
    type Scalar: Batch;
    /// The system's parameters.
    type Parameters: Components<Self::Scalar>;
    /// The state.
    type State: Components<Self::Scalar>;
    /// The controls.
    type Control: Components<Self::Scalar>;

    /// The method for these parameters and this step.
    fn new(parameters: &Self::Parameters, step: Self::Scalar) -> Self;

    /// Takes a step that starts at `time`, with `control` held until it ends. If the state is `known`, the one that the
    /// last step led to, the solution is sought from the last ones on, which only makes it faster; the time is then that of a step like the last.
    ///
    /// # Errors
    /// If state, time or control is not finite, the step's equation cannot be solved, or its solution lies outside the retraction's
    /// domain, in any lane. If in all, nothing is remembered of it.
    #[inline(always)]
    fn advance(
        &mut self,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
        known: bool,
    ) -> Outcome<Self::Scalar, Self::State> {
        self.advance_from(None, state, time, control, known)
    }

    /// Takes steps, up to `most`, with `control` held all the time; fewer if one fails, of which nothing remains where the state is of one
    /// member. In lanes it has led on where nothing was wrong: it is not to be taken again, and is left in `failed`. Faster than one by one, with
    /// the same result. `WIDE`: compiled for each kind of processor, or for the one that the program is built for.
    #[inline(always)]
    fn advance_n<const WIDE: bool>(
        &mut self,
        state: &mut Self::State,
        clock: Clock,
        control: &Self::Control,
        known: bool,
        most: u64,
        failed: Option<&mut Option<Failure<Self::Scalar, Self::State>>>,
    ) -> StepsReport<Self::Scalar> {
        let work = AdvanceN { method: self, state, clock, control, most, known, failed };
        if const { WIDE } {
            Self::Scalar::dispatch_wide(work)
        } else {
            Self::Scalar::dispatch(On::<Portable, _>::new(work))
        }
    }

    /// Takes a step, or what is left of one `from` a stage on, compiled in line as far as [`advance`](Self::advance) is.
    ///
    /// # Errors
    /// As there.
    #[inline(always)]
    fn advance_in_line(
        &mut self,
        from: Option<usize>,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
        known: bool,
    ) -> Outcome<Self::Scalar, Self::State> {
        match from {
            Some(_) => self.advance_from(from, state, time, control, known),
            None => self.advance(state, time, control, known),
        }
    }

    /// Takes a step as [`advance`](Self::advance) does, compiled once for all that do not need it in line.
    ///
    /// # Errors
    /// As there.
    #[inline(always)]
    fn advance_apart<const WIDE: bool>(
        &mut self,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
        known: bool,
    ) -> Outcome<Self::Scalar, Self::State> {
        self.advance_as_many::<WIDE>(state, time, control, known)
    }

    /// Takes a step as one of [many](Self::advance_n).
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    #[inline(always)]
    fn advance_as_many<const WIDE: bool>(
        &mut self,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
        known: bool,
    ) -> Outcome<Self::Scalar, Self::State> {
        if const { Self::Scalar::LANES == 1 && !Self::HAS_FAST_PATH } {
            return Self::Scalar::dispatch(Stage { method: self, from: None, state, time, control, known });
        }
        let (mut next, mut failure) = (*state, None);
        let failed = Some(&mut failure);
        let report = self.advance_n::<WIDE>(&mut next, Clock::at(time), control, known, 1, failed);
        match failure {
            Some(failure) => Err(failure),
            None => {
                let StepsReport { max_iterations: iterations, max_residual: residual, .. } = report;
                Ok(Advanced { state: next, iterations, residual })
            }
        }
    }

    /// How many equations a step solves, one after the other.
    const STAGES: usize = 1;
    /// Whether there is a fast path: else [many steps](Self::advance_n) of one number are left to [`advance`](Self::advance).
    const HAS_FAST_PATH: bool = false;
    /// What is remembered of earlier steps, as it is kept while many are taken on the fast path: in registers, as far as there are any.
    type FastPath: Clone + Send + Sync + Default;

    /// For how many steps all stages are likely to be on the fast path.
    #[inline(always)]
    fn ready_for(&self) -> u64 {
        0
    }
    /// The fast path, where steps are ready for it.
    #[inline(always)]
    fn enter(&self) -> Self::FastPath {
        Self::FastPath::default()
    }
    /// The state after a step on the fast path; or, if a stage needs more than there is on it, the state from which that is to be taken, and its
    /// number. Not an enum, whose variants would overlap: parts of a register.
    #[inline(always)]
    fn advance_fast<P: Processor>(
        &mut self,
        _path: &mut Self::FastPath,
        state: &Self::State,
        _time: Self::Scalar,
        _control: &Self::Control,
    ) -> (Self::State, Option<usize>) {
        (*state, Some(0))
    }
    /// Remembers what was on the fast path: so many steps, and so many stages of one more. How many iterations more these took than the
    /// fewest, all together and in one step at most.
    #[inline(always)]
    fn leave(&mut self, _path: &mut Self::FastPath, _steps: u64, _stages: usize) -> (u64, u32) {
        (0, 0)
    }
    /// The fewest iterations of a step on the fast path, and a bound of the residual that it leaves.
    #[inline(always)]
    fn on_fast_path(&self) -> (<Self::Scalar as Batch>::Each<u32>, Self::Scalar) {
        (Self::Scalar::all(0), Self::Scalar::of(0.0))
    }
    /// As [`advance`](Self::advance); if a stage is given, which needs more than there is on the fast path, from that one on: the state is
    /// then the one after the stages before it.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    fn advance_from(
        &mut self,
        from: Option<usize>,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
        known: bool,
    ) -> Outcome<Self::Scalar, Self::State>;

    /// Holds over each step that it is made of the control at its middle, of a function of the share of the whole step; none: the one control that
    /// it is called with. Of a step that is not made of others, that is the one at its middle.
    fn set_inputs(&mut self, _inputs: Option<&mut dyn FnMut(f64) -> Self::Control>) {}

    /// Shows what the method carries from one step to the next, in pieces of always the same lengths, to be read or replaced. What is in
    /// no piece follows from the parameters and the step.
    fn memory(&mut self, visit: &mut dyn FnMut(&mut [Self::Scalar]));
}

/// When steps are taken: the next one at `start + taken · step`.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Where steps are counted from.
    pub start: f64,
    /// How long each of them is.
    pub step: f64,
    /// How many there were.
    pub taken: u64,
}

impl Clock {
    /// When the step after so many more starts: not accumulated, so that it does not drift.
    #[inline(always)]
    pub fn after(&self, steps: u64) -> f64 {
        self.start + (self.taken + steps) as f64 * self.step
    }

    /// For one step that starts at this time, the same in all lanes.
    #[inline(always)]
    pub(crate) fn at<T: Batch>(time: T) -> Self {
        Self { start: time.lane(0).to_f64(), step: 0.0, taken: 0 }
    }
}

/// How some steps went, in each lane.
#[derive(Clone, Copy, Debug)]
pub struct StepsReport<T: Batch> {
    /// Steps taken.
    pub steps: u64,
    /// Iterations of all of them together.
    pub iterations: T::Each<u64>,
    /// The most iterations that one step took.
    pub max_iterations: T::Each<u32>,
    /// The largest residual left in a step's equation.
    pub max_residual: T,
}

impl<T: Batch> StepsReport<T> {
    /// Counts so many steps that took as many iterations each, and some more all together, and at most.
    #[inline(always)]
    pub(crate) fn count(&mut self, steps: u64, each: &T::Each<u32>, residual: T, more: (u64, u32)) {
        if steps == 0 {
            return;
        }
        let counts = self.iterations.as_mut().iter_mut().zip(self.max_iterations.as_mut());
        for ((all, most), iterations) in counts.zip(each.as_ref()) {
            *all += (steps * u64::from(*iterations)).wrapping_add(more.0);
            *most = (*most).max(iterations.wrapping_add(more.1));
        }
        let larger = self.max_residual.lt(residual);
        self.max_residual = T::select(larger, residual, self.max_residual);
    }
}

impl<T: Batch> Default for StepsReport<T> {
    #[inline(always)]
    fn default() -> Self {
        Self { steps: 0, iterations: T::all(0), max_iterations: T::all(0), max_residual: T::of(0.0) }
    }
}

/// Steps of a method, until one fails.
pub(crate) struct AdvanceN<'a, M: Method> {
    pub(crate) method: &'a mut M,
    pub(crate) state: &'a mut M::State,
    pub(crate) clock: Clock,
    pub(crate) control: &'a M::Control,
    pub(crate) most: u64,
    /// Whether the state is the one that the last step led to.
    pub(crate) known: bool,
    /// What went wrong, if the step that fails is to count in lanes where it does not. Else nothing remains of it.
    pub(crate) failed: Option<&'a mut Option<Failure<M::Scalar, M::State>>>,
}

impl<M: Method> LongWork for AdvanceN<'_, M> {
    type CallSite = M::CallSite;
    type Result = StepsReport<M::Scalar>;

    #[inline(always)]
    fn done<P: Processor>(self) -> StepsReport<M::Scalar> {
        let Self { method, state, clock, control, most, mut known, failed } = self;
        let mut report = StepsReport::default();
        if const { M::Scalar::LANES == 1 && !M::HAS_FAST_PATH } {
            return report;
        }
        // not in memory
        let mut now = *state;
        while report.steps < most {
            let (mut from, mut at) = (None, now);
            let ready_for = method.ready_for();
            if known && ready_for > 0 {
                let until = most.min(report.steps.saturating_add(ready_for));
                let (before, mut path) = (report.steps, method.enter());
                let mut halted = None;
                while report.steps < until {
                    let time = M::Scalar::of(clock.after(report.steps));
                    let (next, halts) = method.advance_fast::<P>(&mut path, &now, time, control);
                    if halts.is_some() {
                        (halted, at) = (halts, next);
                        break;
                    }
                    now = next;
                    report.steps += 1;
                }
                let steps = report.steps - before;
                let more = method.leave(&mut path, steps, halted.unwrap_or(0));
                let (iterations, residual) = method.on_fast_path();
                report.count(steps, &iterations, residual, more);
                if halted.is_none() {
                    continue;
                }
                from = halted;
            }
            let time = M::Scalar::of(clock.after(report.steps));
            match M::Scalar::dispatch(Stage { method, from, state: &at, time, control, known }) {
                Ok(Advanced { state, iterations, residual }) => {
                    (now, known) = (state, true);
                    report.steps += 1;
                    report.count(1, &iterations, residual, (0, 0));
                }
                Err(failure) => {
                    if let Some(failed) = failed {
                        *failed = Some(failure);
                    }
                    break;
                }
            }
        }
        *state = now;
        report
    }
}

/// Where a step has led to.
#[derive(Clone, Copy, Debug)]
pub struct Advanced<T: Batch, S> {
    /// The state after the step.
    pub state: S,
    /// Iterations made, those of all stages together.
    pub iterations: T::Each<u32>,
    /// The residual left in the step's equation, relative to its terms; of several stages the largest.
    pub residual: T,
}

impl<T: Batch, S> Advanced<T, S> {
    /// The same with another state.
    #[cfg(feature = "dynamic")]
    pub(crate) fn with<X>(self, state: X) -> Advanced<T, X> {
        Advanced { state, iterations: self.iterations, residual: self.residual }
    }
}

/// A step that could not be taken in all lanes.
#[derive(Clone, Copy)]
pub struct Failure<T: Batch, S> {
    /// What went wrong, for each lane.
    pub errors: T::Each<Option<StepError>>,
    /// Where the step has led to in lanes where nothing did.
    pub advanced: Advanced<T, S>,
}

/// What comes of a step.
pub type Outcome<T, S> = Result<Advanced<T, S>, Failure<T, S>>;

impl<T: Batch, S> Failure<T, S> {
    /// The error of the first lane that has one.
    pub fn first(&self) -> StepError {
        let error = self.errors.as_ref().iter().find_map(|error| *error);
        // there is one, or it would be no failure
        error.unwrap_or(StepError::NotFinite)
    }
}

/// A step, or what is left of one from a stage on, apart from those on the fast path.
pub(crate) struct Stage<'a, B: Method> {
    pub(crate) method: &'a mut B,
    /// The first stage to be taken, if it needs more than there is on the fast path.
    pub(crate) from: Option<usize>,
    pub(crate) state: &'a B::State,
    pub(crate) time: B::Scalar,
    pub(crate) control: &'a B::Control,
    pub(crate) known: bool,
}

impl<B: Method> Work for Stage<'_, B> {
    type CallSite = B::CallSite;
    type Result = Outcome<B::Scalar, B::State>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { method, from, state, time, control, known } = self;
        method.advance_from(from, state, time, control, known)
    }
}

/// What comes of a step whose state is written elsewhere.
#[cfg(feature = "std")]
pub(crate) type Counted<T> = Outcome<T, ()>;

/// Sums up the stages of a composed step: iterations, the largest residual, and the errors of each lane.
pub(crate) struct StageAccumulator<T: Batch> {
    errors: T::Each<Option<StepError>>,
    is_flawless: bool,
    iterations: T::Each<u32>,
    residual: T,
}

impl<T: Batch> StageAccumulator<T> {
    pub(crate) fn new() -> Self {
        Self { errors: T::all(None), is_flawless: true, iterations: T::all(0), residual: T::of(0.0) }
    }

    /// Takes a stage.
    ///
    /// # Errors
    /// If something went wrong in every lane.
    #[inline(always)]
    pub(crate) fn stage<B: Method<Scalar = T>>(
        &mut self,
        method: &mut B,
        from: Option<usize>,
        state: &B::State,
        time: T,
        control: &B::Control,
        known: bool,
    ) -> Result<B::State, Failure<T, B::State>> {
        self.count(method.advance_in_line(from, state, time, control, known))
    }

    /// Counts a stage that was taken. Where it leads to.
    ///
    /// # Errors
    /// If something went wrong in every lane.
    #[inline(always)]
    pub(crate) fn count<S>(&mut self, outcome: Outcome<T, S>) -> Result<S, Failure<T, S>> {
        let Advanced { state, iterations, residual } = match outcome {
            Ok(advanced) => advanced,
            Err(failure) => {
                self.is_flawless = false;
                for (error, other) in self.errors.as_mut().iter_mut().zip(failure.errors.as_ref()) {
                    *error = error.or(*other);
                }
                if self.errors.as_ref().iter().all(Option::is_some) {
                    return Err(Failure { errors: self.errors, ..failure });
                }
                failure.advanced
            }
        };
        self.iterations = sum::<T>(self.iterations, iterations);
        let larger = self.residual.lt(residual);
        self.residual = T::select(larger, residual, self.residual);
        Ok(state)
    }

    /// Where the stages have led to.
    pub(crate) fn end<S>(self, state: S) -> Outcome<T, S> {
        let advanced = Advanced { state, iterations: self.iterations, residual: self.residual };
        if self.is_flawless { Ok(advanced) } else { Err(Failure { errors: self.errors, advanced }) }
    }
}

/// A method and its adjoint, composed: half a step with `A`, then half a step with `B`, which starts at the time at which the first ends.
#[derive(Clone, Copy, Debug)]
pub struct AdjointPair<A: Method, B> {
    pub(crate) first: A,
    pub(crate) second: B,
    /// Half of the step.
    pub(crate) half: A::Scalar,
    /// Whether both halves remember solutions of one and the same step.
    whole: bool,
}

impl<A, B> Method for AdjointPair<A, B>
where
    A: Method,
    B: Method<Scalar = A::Scalar, Parameters = A::Parameters, State = A::State, Control = A::Control>,
{
    type CallSite = A::CallSite;
    type Scalar = A::Scalar;
    type Parameters = A::Parameters;
    type State = A::State;
    type Control = A::Control;

    fn new(parameters: &A::Parameters, step: A::Scalar) -> Self {
        let half = A::Scalar::of(0.5) * step;
        Self { first: A::new(parameters, half), second: B::new(parameters, half), half, whole: false }
    }

    const STAGES: usize = A::STAGES + B::STAGES;
    const HAS_FAST_PATH: bool = A::HAS_FAST_PATH && B::HAS_FAST_PATH;
    type FastPath = (A::FastPath, B::FastPath);

    #[inline(always)]
    fn ready_for(&self) -> u64 {
        if self.whole { self.first.ready_for().min(self.second.ready_for()) } else { 0 }
    }

    #[inline(always)]
    fn enter(&self) -> Self::FastPath {
        (self.first.enter(), self.second.enter())
    }

    #[inline(always)]
    fn advance_fast<P: Processor>(
        &mut self,
        (first, second): &mut Self::FastPath,
        state: &A::State,
        time: A::Scalar,
        control: &A::Control,
    ) -> (A::State, Option<usize>) {
        let (middle, halted) = self.first.advance_fast::<P>(first, state, time, control);
        if halted.is_some() {
            return (middle, halted);
        }
        let (next, halted) = self.second.advance_fast::<P>(second, &middle, time + self.half, control);
        (next, halted.map(|stage| A::STAGES + stage))
    }

    #[inline(always)]
    fn leave(&mut self, (first, second): &mut Self::FastPath, steps: u64, stages: usize) -> (u64, u32) {
        let is_through = stages >= A::STAGES;
        let one = self.first.leave(first, steps + u64::from(is_through), if is_through { 0 } else { stages });
        let other = self.second.leave(second, steps, stages.saturating_sub(A::STAGES));
        (one.0.wrapping_add(other.0), one.1.wrapping_add(other.1))
    }

    #[inline(always)]
    fn on_fast_path(&self) -> (<A::Scalar as Batch>::Each<u32>, A::Scalar) {
        let (first, second) = (self.first.on_fast_path(), self.second.on_fast_path());
        let larger = A::Scalar::select(first.1.lt(second.1), second.1, first.1);
        (sum::<A::Scalar>(first.0, second.0), larger)
    }

    #[inline(always)]
    fn advance_from(
        &mut self,
        from: Option<usize>,
        state: &A::State,
        time: A::Scalar,
        control: &A::Control,
        known: bool,
    ) -> Outcome<A::Scalar, A::State> {
        let known = known && self.whole;
        // until both are through
        self.whole = false;
        let mut accumulator = StageAccumulator::new();
        let within = from.and_then(|stage| stage.checked_sub(A::STAGES));
        let middle = match within {
            Some(_) => *state,
            None => accumulator.stage(&mut self.first, from, state, time, control, known)?,
        };
        let next = accumulator.stage(&mut self.second, within, &middle, time + self.half, control, known)?;
        self.whole = true;
        accumulator.end(next)
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [A::Scalar])) {
        visit_flag(&mut self.whole, visit);
        self.first.memory(visit);
        self.second.memory(visit);
    }
}

/// What is counted in each lane, together.
#[inline(always)]
pub(crate) fn sum<T: Batch>(mut a: T::Each<u32>, b: T::Each<u32>) -> T::Each<u32> {
    for (a, b) in a.as_mut().iter_mut().zip(b.as_ref()) {
        // no sum of iterations is near the largest number, which the optimizer need not prove
        *a = a.wrapping_add(*b);
    }
    a
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;

    /// Goes nowhere, and fails after the time in its control.
    #[derive(Clone)]
    struct Half {
        /// Whether it was told, the last time, that it knows the state.
        known: bool,
    }

    impl Method for Half {
        type CallSite = ();
        type Scalar = f64;
        type Parameters = [f64; 0];
        type State = [f64; 0];
        type Control = [f64; 1];

        fn new(_: &[f64; 0], _: f64) -> Self {
            Self { known: false }
        }

        type FastPath = ();

        fn advance_from(
            &mut self,
            _: Option<usize>,
            _: &[f64; 0],
            time: f64,
            &[limit]: &[f64; 1],
            known: bool,
        ) -> Outcome<f64, [f64; 0]> {
            self.known = known;
            let advanced = Advanced { state: [], iterations: [1], residual: time };
            if time > limit {
                return Err(Failure { errors: [Some(StepError::OutsideDomain)], advanced });
            }
            Ok(advanced)
        }

        fn memory(&mut self, _: &mut dyn FnMut(&mut [f64])) {}
    }

    #[test]
    fn an_adjoint_pair_remembers_whole_steps_only() {
        let mut pair = AdjointPair::<Half, Half>::new(&[], 2.0);
        let mut advance = |limit: f64| {
            let outcome = pair.advance(&[], 3.0, &[limit], true);
            let report = outcome.map(|to| (to.iterations, to.residual)).map_err(|failure| failure.first());
            (report, [pair.first.known, pair.second.known])
        };
        let solved = Ok(([2], 4.0));
        // nothing to remember yet
        assert_eq!(advance(9.0), (solved, [false, false]));
        assert_eq!(advance(9.0), (solved, [true, true]));
        // the second half fails: what the first one remembers is of another step
        assert_eq!(advance(3.5), (Err(StepError::OutsideDomain), [true, true]));
        assert_eq!(advance(9.0), (solved, [false, false]));
        assert_eq!(advance(9.0), (solved, [true, true]));
    }
}
