//! A step that is one equation, from its kernel.

use super::predictor::Wide;
use super::stopping::{change, is_within, select};
use super::{Beginning, Convergence, Open, SECOND, Solution, SolutionOf, Solver, less};
use crate::error::StepError;
use crate::kernel::{self, Evaluation, Kernel};
use crate::method::{Advanced, Clock, Failure, Method, Outcome, StepsReport};
use crate::scalar::simd::lanes::{Portable, Processor};
use crate::scalar::simd::loads::one_by_one;
use crate::scalar::{Batch, Components, LongWork, Mask, Real, Work};

/// One generated kernel: a step is one equation, solved from where the solutions of earlier steps point.
#[derive(Clone, Copy)]
pub struct OneStep<T: Batch, K: Kernel<T>> {
    kernel: K,
    solver: Solver<T, K::Unknown>,
}

impl<T: Batch, K: Kernel<T>> Method for OneStep<T, K> {
    type Home = K;
    type Scalar = T;
    type Parameters = K::Parameters;
    type State = K::State;
    type Control = K::Control;

    fn new(parameters: &K::Parameters, step: T) -> Self {
        Self { kernel: kernel::new(parameters, step), solver: Solver::default() }
    }

    #[inline(always)]
    fn advance(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
    ) -> Outcome<T, K::State> {
        if const { T::LANES > 1 } {
            // one piece of code for one step and for many
            let (mut next, mut failure) = (*state, None);
            let (clock, failed) = (Clock::at(time), Some(&mut failure));
            let work = AdvanceN { method: self, state: &mut next, clock, control, most: 1, known, failed };
            let StepsReport { max_iterations, max_residual, .. } = T::dispatch_wide(work);
            return match failure {
                Some(failure) => Err(failure),
                None => Ok(Advanced { state: next, iterations: max_iterations, residual: max_residual }),
            };
        }
        let mut first = None;
        // nearly all steps go this way
        let most = self.solver.most();
        if const { Self::HAS_FAST_PATH } && known && most > 0 {
            let (prediction, tolerance) = (self.solver.prediction(), self.solver.tolerance());
            match self.fast::<Portable>(state, time, control, &prediction, None, (tolerance, most)) {
                Ok((next, _, iterations)) => {
                    self.solver.took(1);
                    let Convergence { iterations, residual, .. } = self.solver.on_fast_path(iterations);
                    return Ok(Advanced { state: next, iterations, residual });
                }
                Err(ended) => first = ended,
            }
        }
        // copies, so that the fast path needs no addresses
        let (state, control) = (*state, *control);
        let (state, control) = (&state, &control);
        T::dispatch(Slow { method: self, state, time, control, known, first, lossy: true })
    }

    #[inline(always)]
    fn advance_n(
        &mut self,
        state: &mut K::State,
        clock: Clock,
        control: &K::Control,
        most: u64,
    ) -> StepsReport<T> {
        T::dispatch_wide(AdvanceN { method: self, state, clock, control, most, known: true, failed: None })
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.solver.memory(visit);
    }
}

/// The state after a step on the fast path, the prediction for the next one, and how many iterations were made. Else where the first iteration
/// led to, if they were not enough.
type Fast<T, K> =
    Result<(<K as Kernel<T>>::State, <K as Kernel<T>>::Unknown, u32), Option<<K as Kernel<T>>::Unknown>>;

impl<T: Batch, K: Kernel<T>> OneStep<T, K> {
    /// Whether there is a fast path: where there is nothing to solve for, or fixed-point iterations solve it.
    const HAS_FAST_PATH: bool = K::HAS_FIXED_POINT_UPDATE || <K::Unknown as Components<T>>::LENGTH == 0;

    /// A step as nearly all are: an iteration that changes the unknown by no more than `tolerance`; or a few, no more than `most`, that contract as it
    /// is known; and everything finite. Earlier solutions are remembered in `wide` instead of the solver, if it is given.
    #[inline(always)]
    fn fast<P: Processor>(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        prediction: &K::Unknown,
        wide: Option<&mut Wide<T, K::Unknown>>,
        (tolerance, most): (T, u32),
    ) -> Fast<T, K> {
        let Self { kernel, solver } = self;
        let begun = kernel.begin(state, time, control);
        let (mut unknown, mut evaluation, mut iterations) =
            (*prediction, kernel.evaluate(state, &begun, prediction), 1);
        let mut off = T::of(0.0);
        if const { !Solver::<T, K::Unknown>::IS_IDLE } {
            unknown = kernel.fixed_point_update(state, &begun, &evaluation.right);
            if !is_within::<T, _>(K::BLOCKS, prediction, &unknown, tolerance).all() {
                // apart from the first: as one loop they take a tenth longer where that is enough
                let first = unknown;
                off = change::<T, _>(K::BLOCKS, prediction, &first);
                let mut last = off;
                if const { T::LANES > 1 } || !solver.continues(last) {
                    return Err(Some(first));
                }
                loop {
                    let point = unknown;
                    evaluation = kernel.evaluate(state, &begun, &point);
                    unknown = kernel.cleared_update(state, &begun, &point, &evaluation);
                    iterations += 1;
                    let now = change::<T, _>(K::BLOCKS, &point, &unknown);
                    if !solver.contracts(last, now) {
                        return Err(Some(first));
                    }
                    let is_solved = if iterations == 2 {
                        is_within::<T, _>(K::BLOCKS, &point, &unknown, T::of(SECOND) * tolerance).all()
                    } else {
                        solver.solves(now)
                    };
                    if is_solved {
                        break;
                    }
                    if iterations == most {
                        return Err(Some(first));
                    }
                    last = now;
                }
            }
        }
        let mut then = *prediction;
        if const { !Solver::<T, K::Unknown>::IS_IDLE } {
            then = if Solver::<T, K::Unknown>::is_growing(most) {
                solver.grow(&unknown, off, K::BLOCKS)
            } else {
                let missed = less::<T, _>(&unknown, prediction);
                match wide {
                    Some(wide) => wide.follow::<P>(&missed),
                    None => solver.follow::<P>(&missed),
                }
            };
        }
        let next = kernel.finish(state, &begun, &unknown, &evaluation);
        let inside = is_inside(kernel, state, &begun, &unknown, &evaluation).all();
        if inside & is_surely_finite::<T, K>(&next, control).all() {
            return Ok((next, then, iterations));
        }
        solver.forget();
        Err(None)
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
}

/// Steps of [`OneStep`], until one fails.
pub(crate) struct AdvanceN<'a, T: Batch, K: Kernel<T>> {
    pub(crate) method: &'a mut OneStep<T, K>,
    pub(crate) state: &'a mut K::State,
    pub(crate) clock: Clock,
    pub(crate) control: &'a K::Control,
    pub(crate) most: u64,
    /// Whether the state is the one that the last step led to.
    pub(crate) known: bool,
    /// What went wrong, if the step that fails is to count in lanes where it does not. Else nothing remains of it.
    pub(crate) failed: Option<&'a mut Option<Failure<T, K::State>>>,
}

impl<T: Batch, K: Kernel<T>> LongWork for AdvanceN<'_, T, K> {
    type Home = K;
    type Result = StepsReport<T>;

    #[inline(always)]
    fn done<P: Processor>(self) -> StepsReport<T> {
        let Self { method, state, clock, control, most, mut known, failed } = self;
        let mut report = StepsReport::default();
        // not in memory
        let mut now = *state;
        while report.steps < most {
            let mut first = None;
            let most_iterations = method.solver.most();
            if const { OneStep::<T, K>::HAS_FAST_PATH } && known && most_iterations > 0 {
                let until_due = most.min(report.steps.saturating_add(method.solver.expected()));
                let mut prediction = method.solver.prediction();
                let limits = (method.solver.tolerance(), most_iterations);
                let mut wide = method.solver.widened::<P>();
                if let Some(wide) = &mut wide {
                    wide.keep_half_in_memory();
                }
                let (before, mut done) = (report.steps, true);
                let (mut more, mut deepest) = (0, 1);
                while report.steps < until_due {
                    let time = T::of(clock.after(report.steps));
                    let wide = wide.as_mut();
                    match method.fast::<P>(&now, time, control, &prediction, wide, limits) {
                        Ok((next, then, iterations)) => {
                            (now, prediction) = (next, then);
                            more += u64::from(iterations) - 1;
                            deepest = deepest.max(iterations);
                        }
                        Err(ended) => {
                            (first, done) = (ended, false);
                            break;
                        }
                    }
                    report.steps += 1;
                }
                if let Some(wide) = &mut wide
                    && !Solver::<T, K::Unknown>::is_growing(most_iterations)
                {
                    method.solver.take(wide);
                }
                let steps = report.steps - before;
                if const { !Solver::<T, K::Unknown>::IS_IDLE } {
                    method.solver.took(steps);
                }
                let Convergence { iterations, residual, .. } = method.solver.on_fast_path(1);
                report.count(steps, &iterations, residual);
                report.count_more(more, deepest);
                if done {
                    continue;
                }
            }
            if const { Solver::<T, K::Unknown>::IS_IDLE } && failed.is_none() {
                // what fails is seen by whoever takes the step alone
                break;
            }
            if report.steps < most {
                let time = T::of(clock.after(report.steps));
                let (given, lossy) = (now, failed.is_some());
                match T::dispatch(Slow { method, state: &given, time, control, known, first, lossy }) {
                    Ok(advanced) => {
                        let Advanced { iterations, residual, .. } = advanced;
                        (now, known) = (advanced.state, true);
                        report.steps += 1;
                        report.count(1, &iterations, residual);
                    }
                    Err(failure) => {
                        if let Some(failed) = failed {
                            *failed = Some(failure);
                        }
                        break;
                    }
                }
            }
        }
        *state = now;
        report
    }
}

/// A step, with all that can happen.
struct Slow<'a, T: Batch, K: Kernel<T>> {
    method: &'a mut OneStep<T, K>,
    state: &'a K::State,
    time: T,
    control: &'a K::Control,
    /// Whether the state is the one that the last step led to.
    known: bool,
    /// Where the first iteration on the fast path led to, if there was one.
    first: Option<K::Unknown>,
    /// Whether the step counts if it fails in some lanes.
    lossy: bool,
}

impl<T: Batch, K: Kernel<T>> Work for Slow<'_, T, K> {
    type Home = K;
    type Result = Outcome<T, K::State>;

    #[inline(always)]
    fn done(self) -> Outcome<T, K::State> {
        let Self { method, state, time, control, known, first, lossy } = self;
        let OneStep { kernel, solver } = &mut *method;
        let state = &one_by_one::<T, _>(state);
        if !known {
            solver.forget();
        }
        let begun = kernel.begin(state, time, control);
        let begun = &BegunStep { kernel: &*kernel, state, step: &begun, time, control };
        let (ended, trial) = match solver.iterate(kernel, state, begun.step, first) {
            Ok(solution) => {
                let trial = Conclusion { begun, solution: &solution }.here();
                if trial.good.all() {
                    return Ok(trial.learned(K::BLOCKS, solver));
                }
                (None, Some(trial))
            }
            // there is nothing else to be tried
            Err(_) if const { !K::HAS_FIXED_POINT_UPDATE } => {
                let beginning = solver.beginning(K::BLOCKS, &kernel.start(state, begun.step), None);
                let solution = &beginning.corrected(kernel, state, begun.step);
                let trial = Conclusion { begun, solution }.here();
                if trial.good.all() {
                    return Ok(trial.learned(K::BLOCKS, solver));
                }
                (None, Some(trial))
            }
            Err(ended) => (ended, None),
        };
        T::dispatch(Corrected {
            begun,
            state,
            time,
            control: control.as_ref(),
            blocks: K::BLOCKS,
            solver,
            known,
            lossy,
            ended: ended.as_ref(),
            trial: trial.as_ref(),
        })
    }
}

/// A step that fixed-point iterations do not solve, or with which something went wrong, by Newton's corrections; and what went wrong if they do
/// not help. A function of its own, once for all steps with as many unknowns and numbers of a state.
struct Corrected<'a, T: Batch, U, S> {
    begun: &'a dyn Begun<T, U, S>,
    state: &'a S,
    time: T,
    control: &'a [T],
    blocks: &'static [usize],
    solver: &'a mut Solver<T, U>,
    known: bool,
    lossy: bool,
    /// Where iterations ended, if there were any.
    ended: Option<&'a Open<T, U>>,
    /// What came of the solution by iterations, if there was one.
    trial: Option<&'a Trial<T, U, S>>,
}

impl<T: Batch, U: Components<T>, S: Components<T>> Work for Corrected<'_, T, U, S> {
    type Home = ();
    type Result = Outcome<T, S>;

    #[inline(always)]
    fn done(self) -> Outcome<T, S> {
        let Self { begun, state, time, control, blocks, solver, known, lossy, ended, trial } = self;
        let start = begun.start();
        let mut trial = match trial {
            Some(trial) => *trial,
            None => begun.corrected(&solver.beginning(blocks, &start, ended)),
        };
        // what is remembered saves time, and nothing else: where it misleads, once more without it
        let remembers = known && solver.remembers() && !const { Solver::<T, U>::IS_IDLE };
        if remembers && !trial.good.all() {
            let Trial { good, unknown, convergence, .. } = trial;
            let from = select(good, &unknown, &start);
            trial = trial.or(&begun.corrected(&Beginning { from, wanted: !good, unknown, convergence }));
        }
        if trial.good.all() || (lossy && trial.good.any()) {
            let advanced = trial.learned(blocks, solver);
            if trial.good.all() {
                return Ok(advanced);
            }
        } else if lossy {
            solver.forget();
        }
        let Trial { good, unsolved, inside, .. } = trial;
        let Convergence { iterations, residual, .. } = trial.convergence;
        let mut given = finite(state) & time.is_finite();
        for number in control {
            given = given & number.is_finite();
        }
        let errors = errors::<T>([given, good, unsolved, inside], &iterations, residual);
        Err(Failure { errors, advanced: Advanced { state: trial.next, iterations, residual } })
    }
}

/// A step that has begun, through a table: for code that is compiled once for all kernels.
///
/// `extern "C"`, for such functions do not unwind: steps are without panics, which a call through a table would hide.
trait Begun<T: Batch, U, S> {
    /// A first approximation of the unknown.
    extern "C" fn start(&self) -> U;
    /// The step, solved by Newton's iteration.
    extern "C" fn corrected(&self, beginning: &Beginning<T, U>) -> Trial<T, U, S>;
}

/// A step of a kernel that has begun.
struct BegunStep<'a, T: Batch, K: Kernel<T>> {
    kernel: &'a K,
    state: &'a K::State,
    step: &'a K::Step,
    time: T,
    control: &'a K::Control,
}

// called from here alone
#[allow(improper_ctypes_definitions)]
impl<T: Batch, K: Kernel<T>> Begun<T, K::Unknown, K::State> for BegunStep<'_, T, K> {
    extern "C" fn start(&self) -> K::Unknown {
        if const { T::LANES > 1 } { T::dispatch(Start(self)) } else { Start(self).done() }
    }

    extern "C" fn corrected(&self, beginning: &Beginning<T, K::Unknown>) -> Trial<T, K::Unknown, K::State> {
        let attempt = Attempt { begun: self, beginning };
        if const { T::LANES > 1 } { T::dispatch(attempt) } else { attempt.done() }
    }
}

/// [`Begun::start`], compiled for the processor that the kernel is for.
struct Start<'a, T: Batch, K: Kernel<T>>(&'a BegunStep<'a, T, K>);

impl<T: Batch, K: Kernel<T>> Work for Start<'_, T, K> {
    type Home = K;
    type Result = K::Unknown;

    #[inline(always)]
    fn done(self) -> K::Unknown {
        self.0.kernel.start(self.0.state, self.0.step)
    }
}

/// A step that is solved by Newton's iteration.
struct Attempt<'a, T: Batch, K: Kernel<T>> {
    begun: &'a BegunStep<'a, T, K>,
    beginning: &'a Beginning<T, K::Unknown>,
}

impl<T: Batch, K: Kernel<T>> Work for Attempt<'_, T, K> {
    type Home = K;
    type Result = Trial<T, K::Unknown, K::State>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { begun, beginning } = self;
        let solution = &beginning.corrected(begun.kernel, begun.state, begun.step);
        T::dispatch(Conclusion { begun, solution })
    }
}

/// A step whose equation is solved.
#[derive(Clone, Copy)]
struct Trial<T: Batch, U, S> {
    /// The state after it.
    next: S,
    unknown: U,
    convergence: Convergence<T>,
    /// The lanes in which nothing went wrong.
    good: T::Mask,
    /// The lanes that are not solved, and those inside the retraction's domain.
    unsolved: T::Mask,
    inside: T::Mask,
}

impl<T: Batch, U: Components<T>, S: Components<T>> Trial<T, U, S> {
    /// This where it went well, else the same step taken in another way.
    #[inline(always)]
    fn or(&self, other: &Self) -> Self {
        let (next, unknown) =
            (select(self.good, &self.next, &other.next), select(self.good, &self.unknown, &other.unknown));
        Self { next, unknown, good: self.good | other.good, ..*other }
    }

    /// Where the step has led to, of which the solver learns.
    #[inline(always)]
    fn learned(&self, blocks: &[usize], solver: &mut Solver<T, U>) -> Advanced<T, S> {
        let Convergence { iterations, residual, .. } = self.convergence;
        solver.learn(&self.unknown, blocks, &self.convergence);
        Advanced { state: self.next, iterations, residual }
    }
}

/// The end of a step, from the solution of its equation.
struct Conclusion<'a, T: Batch, K: Kernel<T>> {
    begun: &'a BegunStep<'a, T, K>,
    solution: &'a SolutionOf<T, K>,
}

impl<T: Batch, K: Kernel<T>> Conclusion<'_, T, K> {
    /// In lanes it is long, and comes rarely: once for all that needs it.
    #[inline(always)]
    fn here(self) -> Trial<T, K::Unknown, K::State> {
        if const { T::LANES > 1 } { T::dispatch(self) } else { self.done() }
    }
}

impl<T: Batch, K: Kernel<T>> Work for Conclusion<'_, T, K> {
    type Home = K;
    type Result = Trial<T, K::Unknown, K::State>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { begun: &BegunStep { kernel, state, step, time, control }, solution } = self;
        let Solution { unknown, evaluation, convergence, unsolved } = solution;
        let next = kernel.finish(state, step, unknown, evaluation);
        let inside = is_inside(kernel, state, step, unknown, evaluation);
        // a component that is not finite before the step is not finite after it
        let good = !*unsolved & inside & finite(&next) & finite(control) & time.is_finite();
        Trial { next, unknown: *unknown, convergence: *convergence, good, unsolved: *unsolved, inside }
    }
}

/// What went wrong in each lane, if anything did: in which lanes what was given is finite, nothing went wrong, the equation is not solved, and its
/// solution is inside the retraction's domain.
fn errors<T: Batch>(
    [given, good, unsolved, inside]: [T::Mask; 4],
    iterations: &T::Each<u32>,
    residual: T,
) -> T::Each<Option<StepError>> {
    T::each(|lane| {
        if good.lane(lane) {
            return None;
        }
        if !given.lane(lane) {
            return Some(StepError::NotFinite);
        }
        if unsolved.lane(lane) {
            let (iterations, residual) = (iterations.as_ref()[lane], residual.lane(lane).to_f64());
            return Some(StepError::NoConvergence { iterations, residual });
        }
        Some(if inside.lane(lane) { StepError::NotFinite } else { StepError::OutsideDomain })
    })
}

/// Whether a solution is inside the retraction's domain.
#[inline(always)]
fn is_inside<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    unknown: &K::Unknown,
    evaluation: &Evaluation<K::Unknown, K::Iterate>,
) -> T::Mask {
    match kernel.domain(state, step, unknown, evaluation) {
        Some(margin) => T::of(0.0).lt(margin),
        None => T::Mask::splat(true),
    }
}

/// Whether all numbers of a lane are finite after a step, of which state and solution were; not so if their sum is too large.
#[inline(always)]
fn is_surely_finite<T: Batch, K: Kernel<T>>(state: &K::State, control: &K::Control) -> T::Mask {
    // four sums, for each has to wait for itself; the compiler knows that −0 is nothing to add
    let mut sums = [T::of(-0.0); 4];
    let mut terms = 0;
    let mut k = 0;
    while k < K::State::LENGTH {
        if !K::is_bounded(k) {
            sums[terms % 4] = sums[terms % 4] + state.as_ref()[k];
            terms += 1;
        }
        k += 1;
    }
    k = 0;
    while k < K::Control::LENGTH {
        sums[terms % 4] = sums[terms % 4] + control.as_ref()[k];
        (terms, k) = (terms + 1, k + 1);
    }
    (T::of(0.0) * ((sums[0] + sums[1]) + (sums[2] + sums[3]))).le(T::of(0.0))
}

/// Whether all numbers of a lane are finite.
#[inline(always)]
fn finite<T: Batch, C: Components<T>>(components: &C) -> T::Mask {
    // four sums, for each has to wait for itself; the compiler knows that −0 is nothing to add
    let mut sums = [T::of(-0.0); 4];
    let mut k = 0;
    while k < C::LENGTH {
        sums[k % 4] = sums[k % 4] + components.as_ref()[k];
        k += 1;
    }
    let mut are_finite = ((sums[0] + sums[1]) + (sums[2] + sums[3])).is_finite();
    if !are_finite.all() {
        // the sum may be too large
        are_finite = T::Mask::splat(true);
        k = 0;
        while k < C::LENGTH {
            are_finite = are_finite & components.as_ref()[k].is_finite();
            k += 1;
        }
    }
    are_finite
}
