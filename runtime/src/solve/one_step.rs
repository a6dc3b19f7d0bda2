//! A step that is one equation, from its kernel.

use super::stopping::{is_within, select};
use super::{Convergence, Solution, Solver, newton};
use crate::error::StepError;
use crate::kernel::{Components, Evaluation, Kernel};
use crate::method::{Advanced, Clock, Failure, Method, Outcome, StepsReport};
use crate::scalar::{Batch, LongWork, Mask, Real, Work};
use crate::simd::lanes::{Portable, Processor};

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
        if const { Self::HAS_FAST_PATH } && known && self.solver.is_fast() {
            let (prediction, limit) = (self.solver.prediction(), self.solver.limit());
            match self.fast::<Portable>(state, time, control, &prediction, limit) {
                Ok((next, prediction)) => {
                    self.solver.took(1, &prediction);
                    let Convergence { iterations, residual, .. } = self.solver.on_fast_path();
                    return Ok(Advanced { state: next, iterations, residual });
                }
                Err(unknown) => first = unknown,
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

/// The state after a step on the fast path, and the prediction for the next one. Else where the first iteration led to if it was not enough.
type Fast<T, K> =
    Result<(<K as Kernel<T>>::State, <K as Kernel<T>>::Unknown), Option<<K as Kernel<T>>::Unknown>>;

impl<T: Batch, K: Kernel<T>> OneStep<T, K> {
    /// Whether there is a fast path: where there is nothing to solve for, or fixed-point iterations solve it.
    const HAS_FAST_PATH: bool = K::HAS_FIXED_POINT_UPDATE || <K::Unknown as Components<T>>::LENGTH == 0;

    /// A step as nearly all are: one iteration that changes the unknown by no more than `limit`, and everything finite.
    #[inline(always)]
    fn fast<P: Processor>(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        prediction: &K::Unknown,
        limit: T,
    ) -> Fast<T, K> {
        let Self { kernel, solver } = self;
        let begun = kernel.begin(state, time, control);
        let evaluation = kernel.evaluate(state, &begun, prediction);
        let (mut unknown, mut then) = (*prediction, *prediction);
        if const { !Solver::<T, K::Unknown>::IS_IDLE } {
            unknown = kernel.fixed_point_update(state, &begun, &evaluation.right).ok_or(None)?;
            if !is_within::<T, _>(K::BLOCKS, prediction, &unknown, limit).all() {
                return Err(Some(unknown));
            }
            then = solver.next::<P>(&unknown);
        }
        let next = kernel.finish(state, &begun, &unknown, &evaluation);
        let inside = is_inside(kernel, state, &begun, &unknown, &evaluation).all();
        if inside & is_surely_finite::<T, K>(&next, control).all() {
            solver.keep::<P>(&unknown);
            return Ok((next, then));
        }
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
            if const { OneStep::<T, K>::HAS_FAST_PATH } && known && method.solver.is_fast() {
                let until_due = most.min(report.steps.saturating_add(method.solver.expected()));
                let mut prediction = method.solver.prediction();
                let limit = method.solver.limit();
                let (before, mut done) = (report.steps, true);
                while report.steps < until_due {
                    let time = T::of(clock.after(report.steps));
                    match method.fast::<P>(&now, time, control, &prediction, limit) {
                        Ok((next, then)) => (now, prediction) = (next, then),
                        Err(unknown) => {
                            (first, done) = (unknown, false);
                            break;
                        }
                    }
                    report.steps += 1;
                }
                let steps = report.steps - before;
                if const { !Solver::<T, K::Unknown>::IS_IDLE } {
                    method.solver.took(steps, &prediction);
                }
                report.count(steps, &method.solver.on_fast_path());
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
                        report
                            .count(1, &Convergence { iterations, residual, ..method.solver.on_fast_path() });
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
    /// Where the first iteration led to, if there was one.
    first: Option<K::Unknown>,
    /// Whether the step counts if it fails in some lanes.
    lossy: bool,
}

impl<T: Batch, K: Kernel<T>> Work for Slow<'_, T, K> {
    type Home = K;
    type Result = Outcome<T, K::State>;

    #[inline(always)]
    fn done(self) -> Outcome<T, K::State> {
        let Self { method: OneStep { kernel, solver }, state, time, control, known, first, lossy } = self;
        if !known {
            solver.forget();
        }
        let begun = kernel.begin(state, time, control);
        let mut solution = solver.solve(kernel, state, &begun, first);
        let (mut next, mut unknown, mut good) = (*state, solution.unknown, T::Mask::splat(false));
        // what is remembered saves time, and nothing else: where it misleads, once more without it
        let mut again = known && solver.remembers();
        let (inside, reached, convergence) = loop {
            let Solution { evaluation, convergence, unsolved, .. } = solution;
            let there = kernel.finish(state, &begun, &solution.unknown, &evaluation);
            let inside = is_inside(kernel, state, &begun, &solution.unknown, &evaluation);
            // a component that is not finite before the step is not finite after it
            let reached = finite(&there) & finite(control) & time.is_finite();
            (next, unknown) = (select(good, &next, &there), select(good, &unknown, &solution.unknown));
            good = good | (!unsolved & inside & reached);
            if const { Solver::<T, K::Unknown>::IS_IDLE } || good.all() || !again {
                break (inside, reached, convergence);
            }
            again = false;
            let from = select(good, &unknown, &kernel.start(state, &begun));
            solution = newton::solve(kernel, state, &begun, &from, !good);
            solution.convergence = convergence.then(&solution.convergence, good);
        };
        let (Convergence { iterations, residual, .. }, unsolved) = (convergence, solution.unsolved);
        let advanced = Advanced { state: next, iterations, residual };
        if good.all() {
            solver.learn(&unknown, K::BLOCKS, &convergence);
            return Ok(advanced);
        }
        if lossy && good.any() {
            solver.learn(&unknown, K::BLOCKS, &convergence);
        } else if lossy {
            solver.forget();
        }
        let given = finite(state) & finite(control) & time.is_finite();
        let errors = T::each(|lane| {
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
            if !inside.lane(lane) {
                return Some(StepError::OutsideDomain);
            }
            (!reached.lane(lane)).then_some(StepError::NotFinite)
        });
        Err(Failure { errors, advanced })
    }
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

/// Whether all numbers of a lane are finite: no branch.
#[inline(always)]
fn finite<T: Batch, C: Components<T>>(components: &C) -> T::Mask {
    // what is finite times nothing is nothing, and nothing else is; four sums, for each has to wait for itself
    let mut sums = [T::of(0.0); 4];
    let mut k = 0;
    while k < C::LENGTH {
        sums[k % 4] = sums[k % 4] + T::of(0.0) * components.as_ref()[k];
        k += 1;
    }
    ((sums[0] + sums[1]) + (sums[2] + sums[3])).le(T::of(0.0))
}
