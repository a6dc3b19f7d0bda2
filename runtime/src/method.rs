//! What takes a step: one solved equation, or several steps composed.
//!
//! Over one number or over several side by side: what fails then fails in its lane, and the others go on.

use crate::error::StepError;
use crate::geometry::Isolated;
use crate::kernel::{Components, Kernel};
use crate::lanes::{Portable, Processor};
use crate::memory::visit_flag;
use crate::newton::{self, SolutionOf};
use crate::scalar::{Batch, LongWork, Mask, Real, Scalar, Work};
use crate::solver::Solver;

/// A discretization of one system with one step size, on flat arrays.
pub trait Method: Clone + Send + Sync {
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

    /// The state after a step that starts at `time`, with `control` held until it ends. If the state is `known`, the one that the
    /// last step led to, the solution is sought from the last ones on, which only makes it faster; the time is then that of a step like the last.
    ///
    /// # Errors
    /// If state, time or control is not finite, the step's equation cannot be solved, or its solution lies outside the retraction's
    /// domain, in any lane. If in all, nothing is remembered of it.
    fn advance(
        &mut self,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
        known: bool,
    ) -> Outcome<Self::Scalar, Self::State>;

    /// Takes steps, up to `most`, with `control` held all the time, for as long as they are as most steps are; from a state that is
    /// known. Faster than one by one, with the same result; a method may take none, and leave all to [`advance`](Self::advance).
    #[inline(always)]
    fn march(
        &mut self,
        _state: &mut Self::State,
        _clock: Clock,
        _control: &Self::Control,
        _most: u64,
    ) -> Marched<Self::Scalar> {
        Marched::default()
    }

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
}

/// How some steps went, in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Marched<T: Batch> {
    /// Steps taken.
    pub steps: u64,
    /// Iterations of all of them together.
    pub iterations: T::Each<u64>,
    /// The most iterations that one step took.
    pub max_iterations: T::Each<u32>,
    /// The largest residual left in a step's equation.
    pub max_residual: T,
}

impl<T: Batch> Default for Marched<T> {
    #[inline(always)]
    fn default() -> Self {
        Self {
            steps: 0,
            iterations: T::each(|_| 0),
            max_iterations: T::each(|_| 0),
            max_residual: T::of(0.0),
        }
    }
}

/// Where a step has led to.
#[derive(Clone, Copy, Debug)]
pub struct Advanced<T: Batch, S> {
    /// The state after the step.
    pub state: S,
    /// Iterations made, those of all parts together.
    pub iterations: T::Each<u32>,
    /// The residual left in the step's equation, relative to its terms; of several parts the largest.
    pub residual: T,
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

/// One generated kernel: a step is one equation, solved from where the solutions of earlier steps point.
#[derive(Clone, Copy, Debug)]
pub struct OneStep<T: Batch, K: Kernel<T>> {
    kernel: K,
    solver: Solver<T, K::Unknown>,
}

impl<T: Batch, K: Kernel<T>> Method for OneStep<T, K> {
    type Scalar = T;
    type Parameters = K::Parameters;
    type State = K::State;
    type Control = K::Control;

    fn new(parameters: &K::Parameters, step: T) -> Self {
        Self { kernel: K::new(parameters, step), solver: Solver::default() }
    }

    #[inline(always)]
    fn advance(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
    ) -> Outcome<T, K::State> {
        // Nearly all steps go this way. Whatever is not as usual sends them the other.
        if known && self.solver.usual() > 0 {
            let mut guess = self.solver.guess();
            if let Some(advanced) = self.usual::<Portable>(state, time, control, &mut guess) {
                self.solver.took(1);
                self.solver.set_guess(&guess);
                return Ok(advanced);
            }
        }
        self.anyhow(state, time, control, known)
    }

    #[inline(always)]
    fn march(&mut self, state: &mut K::State, clock: Clock, control: &K::Control, most: u64) -> Marched<T> {
        // out of line: once for all that take steps with it
        T::outline_long(March::new(self, state, clock, control, most)).unwrap_or_default()
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.solver.memory(visit);
    }
}

/// Steps of [`OneStep`] as nearly all are.
pub(crate) struct March<'a, T: Batch, K: Kernel<T>> {
    method: &'a mut OneStep<T, K>,
    state: &'a mut K::State,
    clock: Clock,
    control: &'a K::Control,
    most: u64,
}

impl<'a, T: Batch, K: Kernel<T>> March<'a, T, K> {
    #[inline(always)]
    pub(crate) fn new(
        method: &'a mut OneStep<T, K>,
        state: &'a mut K::State,
        clock: Clock,
        control: &'a K::Control,
        most: u64,
    ) -> Self {
        Self { method, state, clock, control, most }
    }
}

impl<T: Batch, K: Kernel<T>> LongWork for March<'_, T, K> {
    type Result = Marched<T>;

    #[inline(always)]
    fn done<P: Processor>(self) -> Marched<T> {
        let Self { method, state, clock, control, most } = self;
        method.solver.effort();
        // not in memory
        let (mut now, mut guess) = (*state, method.solver.guess());
        let most = most.min(method.solver.usual());
        let mut steps = 0;
        while steps < most {
            let mut next = guess;
            let Some(advanced) = method.usual::<P>(&now, T::of(clock.after(steps)), control, &mut next)
            else {
                break;
            };
            (now, guess) = (advanced.state, next);
            steps += 1;
        }
        *state = now;
        method.solver.took(steps);
        method.solver.set_guess(&guess);
        let (effort, residual) = method.solver.effort();
        if steps == 0 || method.solver.is_idle() {
            return Marched { steps, ..Marched::default() };
        }
        let iterations = T::each(|lane| steps + effort.more.as_ref()[lane]);
        Marched { steps, iterations, max_iterations: effort.most, max_residual: residual }
    }
}

/// A step of [`OneStep`], with all that can happen.
struct Anyhow<'a, T: Batch, K: Kernel<T>> {
    method: &'a mut OneStep<T, K>,
    state: &'a K::State,
    time: T,
    control: &'a K::Control,
    known: bool,
}

impl<T: Batch, K: Kernel<T>> Work for Anyhow<'_, T, K> {
    type Result = Outcome<T, K::State>;

    #[inline(always)]
    fn done(self) -> Outcome<T, K::State> {
        let Self { method, state, time, control, known } = self;
        let given = finite(state) & finite(control) & time.is_finite();
        let begun = method.kernel.begin(state, time, control);
        let solution = method.solver.solve(&method.kernel, state, &begun, known);
        let inside = method.is_inside(state, &begun, &solution);
        let advanced = method.finish(state, &begun, &solution);
        let reached = finite(&advanced.state);
        let good = given & !solution.unsolved & inside & reached;
        if good.any() {
            method.solver.push(&solution.unknown);
        } else {
            method.solver.forget();
        }
        if good.all() {
            return Ok(advanced);
        }
        let errors = T::each(|lane| {
            if !given.lane(lane) {
                return Some(StepError::NotFinite);
            }
            if solution.unsolved.lane(lane) {
                let iterations = solution.iterations.as_ref()[lane];
                let residual = solution.residual.lane(lane).to_f64();
                return Some(StepError::NoConvergence { iterations, residual });
            }
            if !inside.lane(lane) {
                return Some(StepError::OutsideDomain);
            }
            (!reached.lane(lane)).then_some(StepError::NotFinite)
        });
        Err(Failure { errors, advanced })
    }
}

impl<T: Batch, K: Kernel<T>> OneStep<T, K> {
    /// A step by whatever it takes.
    #[inline(always)]
    fn anyhow(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
    ) -> Outcome<T, K::State> {
        // copies, so that the other way needs no addresses
        let (state, control) = (*state, *control);
        T::outline(Anyhow { method: self, state: &state, time, control: &control, known })
    }

    /// A step as nearly all are, from a guess that becomes the next one's. None if something is not as usual, be it a number that is not
    /// finite: then nothing else has changed, but that sweeps beyond the first are counted if they were made and what followed was not usual.
    #[inline(always)]
    fn usual<P: Processor>(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        guess: &mut K::Unknown,
    ) -> Option<Advanced<T, K::State>> {
        let begun = self.kernel.begin(state, time, control);
        let solution = self.solver.by_sweeps::<P, _>(&self.kernel, state, &begun, guess)?;
        let advanced = self.finish(state, &begun, &solution);
        let usual =
            self.is_inside(state, &begun, &solution) & self.is_surely_finite(&advanced.state, control);
        if usual.all() {
            self.solver.push_usual::<P>(&solution.unknown);
            return Some(advanced);
        }
        // asked for here too, so that the compiler does not put it off until it is known that the step is usual: the next one waits for it
        core::hint::black_box(*guess);
        None
    }

    /// Whether all numbers of a lane are finite after a usual step, of which state and solution were; not so if their sum is too large.
    #[inline(always)]
    fn is_surely_finite(&self, state: &K::State, control: &K::Control) -> T::Mask {
        // four sums, for each has to wait for itself; the compiler knows that −0 is nothing to add
        let mut sums = [T::of(-0.0); 4];
        let mut terms = 0;
        for (k, component) in state.as_ref().iter().enumerate() {
            if !K::is_bounded(k) {
                sums[terms % 4] = sums[terms % 4] + *component;
                terms += 1;
            }
        }
        for component in control.as_ref() {
            sums[terms % 4] = sums[terms % 4] + *component;
            terms += 1;
        }
        (T::of(0.0) * ((sums[0] + sums[1]) + (sums[2] + sums[3]))).at_most(T::of(0.0))
    }

    /// The solution of the last step's equation.
    pub(crate) fn solution(&self) -> K::Unknown {
        self.solver.latest()
    }

    /// The state after a step whose equation has this solution.
    pub(crate) fn next(
        &self,
        state: &K::State,
        time: T,
        control: &K::Control,
        unknown: &K::Unknown,
    ) -> K::State {
        let begun = self.kernel.begin(state, time, control);
        let evaluation = self.kernel.evaluate(state, &begun, unknown);
        self.kernel.finish(state, &begun, unknown, &evaluation)
    }

    #[inline(always)]
    fn is_inside(&self, state: &K::State, begun: &K::Step, solution: &SolutionOf<T, K>) -> T::Mask {
        T::of(0.0).below(self.kernel.domain(state, begun, &solution.unknown, &solution.evaluation))
    }

    #[inline(always)]
    fn finish(
        &self,
        state: &K::State,
        begun: &K::Step,
        solution: &SolutionOf<T, K>,
    ) -> Advanced<T, K::State> {
        let state = self.kernel.finish(state, begun, &solution.unknown, &solution.evaluation);
        Advanced { state, iterations: solution.iterations, residual: solution.residual }
    }
}

/// Whether all numbers of a lane are finite: no branch.
#[inline(always)]
fn finite<T: Batch, C: Components<T>>(components: &C) -> T::Mask {
    // what is finite times nothing is nothing, and nothing else is; four sums, for each has to wait for itself
    let mut sums = [T::of(0.0); 4];
    for (k, component) in components.as_ref().iter().enumerate() {
        sums[k % 4] = sums[k % 4] + T::of(0.0) * *component;
    }
    ((sums[0] + sums[1]) + (sums[2] + sums[3])).at_most(T::of(0.0))
}

/// A step that is part of another.
struct Part<'a, B: Method> {
    method: &'a mut B,
    state: &'a B::State,
    time: B::Scalar,
    control: &'a B::Control,
    known: bool,
}

impl<B: Method> Work for Part<'_, B> {
    type Result = Outcome<B::Scalar, B::State>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        self.method.advance(self.state, self.time, self.control, self.known)
    }
}

/// A step that consists of others.
pub(crate) struct Course<T: Batch> {
    errors: T::Each<Option<StepError>>,
    is_flawless: bool,
    iterations: T::Each<u32>,
    residual: T,
}

impl<T: Batch> Course<T> {
    pub(crate) fn new() -> Self {
        Self {
            errors: T::each(|_| None),
            is_flawless: true,
            iterations: T::each(|_| 0),
            residual: T::of(0.0),
        }
    }

    /// Takes a part of the step. Not inlined: what is composed of several is compiled once for all that it is part of, and next to a step
    /// a call is nothing.
    ///
    /// # Errors
    /// If something went wrong in every lane.
    pub(crate) fn part<B: Method<Scalar = T>>(
        &mut self,
        method: &mut B,
        state: &B::State,
        time: T,
        control: &B::Control,
        known: bool,
    ) -> Result<B::State, Failure<T, B::State>> {
        let advanced = match T::outline(Part { method, state, time, control, known }) {
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
        self.iterations = newton::sum::<T>(self.iterations, advanced.iterations);
        let larger = self.residual.below(advanced.residual);
        self.residual = T::select(larger, advanced.residual, self.residual);
        Ok(advanced.state)
    }

    /// Where the parts have led to.
    pub(crate) fn end<S>(self, state: S) -> Outcome<T, S> {
        let advanced = Advanced { state, iterations: self.iterations, residual: self.residual };
        if self.is_flawless { Ok(advanced) } else { Err(Failure { errors: self.errors, advanced }) }
    }
}

/// Half a step with the method `A`, then half a step with `B`, which starts at the time at which the first ends.
#[derive(Clone, Copy, Debug)]
pub struct Halves<A: Method, B> {
    pub(crate) first: A,
    pub(crate) second: B,
    /// Half of the step.
    pub(crate) half: A::Scalar,
    /// Whether both halves remember solutions of one and the same step.
    whole: bool,
}

impl<A, B> Method for Halves<A, B>
where
    A: Method,
    B: Method<Scalar = A::Scalar, Parameters = A::Parameters, State = A::State, Control = A::Control>,
{
    type Scalar = A::Scalar;
    type Parameters = A::Parameters;
    type State = A::State;
    type Control = A::Control;

    fn new(parameters: &A::Parameters, step: A::Scalar) -> Self {
        let half = A::Scalar::of(0.5) * step;
        Self { first: A::new(parameters, half), second: B::new(parameters, half), half, whole: false }
    }

    #[inline]
    fn advance(
        &mut self,
        state: &A::State,
        time: A::Scalar,
        control: &A::Control,
        known: bool,
    ) -> Outcome<A::Scalar, A::State> {
        let known = known && self.whole;
        // until both are through
        self.whole = false;
        let mut course = Course::new();
        let middle = course.part(&mut self.first, state, time, control, known)?;
        let next = course.part(&mut self.second, &middle, time + self.half, control, known)?;
        self.whole = true;
        course.end(next)
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [A::Scalar])) {
        visit_flag(&mut self.whole, visit);
        self.first.memory(visit);
        self.second.memory(visit);
    }
}

/// A method between whose steps the momentum is carried in space coordinates.
pub struct Carried<S: Isolated, B: Method> {
    pub(crate) base: B,
    /// Whether there was a step.
    has_stepped: bool,
    /// The momentum since then.
    spatial: S::Spatial<B::Scalar>,
}

impl<S: Isolated, B: Method> Clone for Carried<S, B> {
    fn clone(&self) -> Self {
        Self { base: self.base.clone(), has_stepped: self.has_stepped, spatial: self.spatial }
    }
}

impl<S, B> Method for Carried<S, B>
where
    S: Isolated,
    B: Method,
    B: Method<State = S::StateComponents<<B as Method>::Scalar>>,
{
    type Scalar = B::Scalar;
    type Parameters = B::Parameters;
    type State = B::State;
    type Control = B::Control;

    fn new(parameters: &B::Parameters, step: B::Scalar) -> Self {
        let nothing = S::Spatial::from_fn(|_| B::Scalar::of(0.0));
        Self { base: B::new(parameters, step), has_stepped: false, spatial: nothing }
    }

    #[inline]
    fn advance(
        &mut self,
        state: &B::State,
        time: B::Scalar,
        control: &B::Control,
        known: bool,
    ) -> Outcome<B::Scalar, B::State> {
        let spatial = if known && self.has_stepped { self.spatial } else { S::in_space(state) };
        let mut course = Course::new();
        let next = course.part(&mut self.base, state, time, control, known)?;
        (self.has_stepped, self.spatial) = (true, spatial);
        course.end(S::in_body(&next, &spatial))
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [B::Scalar])) {
        visit_flag(&mut self.has_stepped, visit);
        visit(self.spatial.as_mut());
        self.base.memory(visit);
    }
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
        type Scalar = f64;
        type Parameters = [f64; 0];
        type State = [f64; 0];
        type Control = [f64; 1];

        fn new(_: &[f64; 0], _: f64) -> Self {
            Self { known: false }
        }

        fn advance(
            &mut self,
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
    fn halves_remember_whole_steps_only() {
        let mut halves = Halves::<Half, Half>::new(&[], 2.0);
        let mut advance = |limit: f64| {
            let outcome = halves.advance(&[], 3.0, &[limit], true);
            let report = outcome.map(|to| (to.iterations, to.residual)).map_err(|failure| failure.first());
            (report, [halves.first.known, halves.second.known])
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
