//! A step that is one equation, from its kernel: the whole story.

use super::memory::Memory;
use super::newton::Newton;
use super::predictor::Predictor;
use super::rescue::{Rescue, Rescued};
use super::{Solution, SolutionOf, fixed_point};
use crate::error::StepError;
use crate::kernel::{self, AtState, Kernel, finite, is_inside, is_surely_finite};
use crate::method::{AdvanceN, Advanced, Clock, Failure, Method, Outcome, StepsReport};
use crate::scalar::blocks::{is_within, select};
use crate::scalar::simd::lanes::{Portable, Processor};
use crate::scalar::simd::loads::{apart, one_by_one};
use crate::scalar::{Batch, Components, Mask, Scalar, Work};

/// One generated kernel: a step is one equation, solved from where the solutions of earlier steps point.
#[derive(Clone, Copy)]
pub struct OneStep<T: Batch, K: Kernel<T>> {
    kernel: K,
    memory: Memory<T, K::Unknown>,
}

/// Where the solutions before point, while many steps are taken.
#[derive(Clone, Copy, Debug)]
pub struct Guess<U>(Option<U>);

impl<U> Default for Guess<U> {
    #[inline(always)]
    fn default() -> Self {
        Self(None)
    }
}

impl<T: Batch, K: Kernel<T>> Method for OneStep<T, K> {
    type Home = K;
    type Scalar = T;
    type Parameters = K::Parameters;
    type State = K::State;
    type Control = K::Control;

    fn new(parameters: &K::Parameters, step: T) -> Self {
        Self { kernel: kernel::new(parameters, step), memory: Memory::default() }
    }

    const HAS_FAST_PATH: bool = K::HAS_FIXED_POINT_UPDATE || Self::IS_EXPLICIT;
    /// The next solution.
    type FastPath = Guess<K::Unknown>;

    #[inline(always)]
    fn ready_for(&self) -> u64 {
        if const { Self::HAS_FAST_PATH } { self.memory.ready_for() } else { 0 }
    }

    #[inline(always)]
    fn enter(&self) -> Self::FastPath {
        Guess(Some(self.memory.predictor.next()))
    }

    #[inline(always)]
    fn advance_fast<P: Processor>(
        &mut self,
        Guess(guess): &mut Self::FastPath,
        state: &K::State,
        time: T,
        control: &K::Control,
    ) -> Result<K::State, (usize, K::State)> {
        let Some(guess) = guess else { return Err((0, *state)) };
        match fast_path::<P, _, _>(&self.kernel, &mut self.memory, guess, state, time, control) {
            Ok(next) => Ok(next),
            Err(_) => Err((0, *state)),
        }
    }

    #[inline(always)]
    fn leave(&mut self, Guess(guess): &mut Self::FastPath, steps: u64, _stages: usize) {
        if let Some(guess) = guess {
            self.memory.predictor.set_next(guess);
        }
        self.memory.took(steps);
    }

    #[inline(always)]
    fn on_fast_path(&self) -> (T::Each<u32>, T) {
        if const { Self::IS_EXPLICIT } {
            (T::all(0), T::of(0.0))
        } else {
            (T::all(1), self.memory.rate * self.memory.tolerance)
        }
    }

    #[inline(always)]
    fn advance_from(
        &mut self,
        _stage: usize,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
    ) -> Outcome<T, K::State> {
        // copies, so that the fast path needs no addresses
        let (state, control) = (*state, *control);
        T::dispatch(SlowPath { method: self, state: &state, time, control: &control, known, first: None })
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
        if known && self.ready_for() > 0 {
            let mut guess = self.memory.predictor.next();
            match fast_path::<Portable, _, _>(
                &self.kernel,
                &mut self.memory,
                &mut guess,
                state,
                time,
                control,
            ) {
                Ok(next) => {
                    self.memory.predictor.set_next(&guess);
                    self.memory.took(1);
                    let (iterations, residual) = self.on_fast_path();
                    return Ok(Advanced { state: next, iterations, residual });
                }
                Err(ended) => first = ended,
            }
        }
        // in line, so that numbers stay in registers: a step with four iterations takes a third less
        if known && const { K::HAS_FIXED_POINT_UPDATE && Self::IS_SMALL } && self.memory.is_regular() {
            let Self { kernel, memory } = self;
            let step = &kernel.begin(state, time, control);
            let equation = &AtState { kernel: &*kernel, state, step };
            let solution = fixed_point::solve(equation, memory, &memory.predictor.next(), first);
            if solution.solved.all() {
                let accepted = accept(equation, &solution, time, control);
                if accepted.good.all() {
                    memory.learn(K::BLOCKS, &solution.unknown, solution.rate);
                    let Solution { iterations, residual, .. } = solution;
                    return Ok(Advanced { state: accepted.next, iterations, residual });
                }
            }
        }
        // copies, so that the fast path needs no addresses
        let (state, control) = (*state, *control);
        T::dispatch(SlowPath { method: self, state: &state, time, control: &control, known, first })
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.memory.memory(visit);
    }
}

impl<T: Batch, K: Kernel<T>> OneStep<T, K> {
    /// Whether there is nothing to solve for.
    const IS_EXPLICIT: bool = <K::Unknown as Components<T>>::LENGTH == 0;
    /// Whether a step is short, so that a call for it counts; to compile a long one once more takes long.
    const IS_SMALL: bool = <K::Places<T> as Components<T>>::LENGTH <= 400;

    /// The solution of the last step's equation.
    pub(crate) fn solution(&self) -> K::Unknown {
        self.memory.predictor.latest()
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

/// The state after a step as nearly all are: one iteration, from where the solutions before it point, changes the unknown by little, and
/// everything is finite. The `guess` is the next step's then. Else nothing has changed, and if there was an iteration, this is where it led to.
#[inline(always)]
fn fast_path<P: Processor, T: Batch, K: Kernel<T>>(
    kernel: &K,
    memory: &mut Memory<T, K::Unknown>,
    guess: &mut K::Unknown,
    state: &K::State,
    time: T,
    control: &K::Control,
) -> Result<K::State, Option<K::Unknown>> {
    let step = kernel.begin(state, time, control);
    let evaluation = kernel.evaluate(state, &step, guess);
    let (mut unknown, mut then) = (*guess, *guess);
    if const { !OneStep::<T, K>::IS_EXPLICIT } {
        unknown = kernel.fixed_point_update(state, &step, &evaluation.right);
        if !is_within::<T, _>(K::BLOCKS, guess, &unknown, memory.tolerance).all() {
            return Err(Some(unknown));
        }
        // before what follows from this solution, for the next step waits for it
        then = apart::<T, _>(&Predictor::then(&memory.predictor.begun::<P>(), &unknown));
    }
    let next = kernel.finish(state, &step, &unknown, &evaluation);
    let inside = is_inside(kernel, state, &step, &unknown, &evaluation).all();
    if !(inside & is_surely_finite::<T, K>(&next, control).all()) {
        return Err(None);
    }
    if const { !OneStep::<T, K>::IS_EXPLICIT } {
        memory.predictor.push::<P>(&unknown);
        *guess = then;
    }
    Ok(next)
}

/// A step, with all that can happen.
struct SlowPath<'a, T: Batch, K: Kernel<T>> {
    method: &'a mut OneStep<T, K>,
    state: &'a K::State,
    time: T,
    control: &'a K::Control,
    /// Whether the state is the one that the last step led to.
    known: bool,
    /// Where the first iteration on the fast path led to, if there was one.
    first: Option<K::Unknown>,
}

impl<T: Batch, K: Kernel<T>> Work for SlowPath<'_, T, K> {
    type Home = K;
    type Result = Outcome<T, K::State>;

    #[inline(always)]
    fn done(self) -> Outcome<T, K::State> {
        let Self { method: OneStep { kernel, memory }, state, time, control, known, first } = self;
        let state = &one_by_one::<T, _>(state);
        if !known {
            memory.forget();
        }
        let step = &kernel.begin(state, time, control);
        let equation = &AtState { kernel: &*kernel, state, step };
        let (mut solution, mut errors, mut is_rescued) =
            (solve(equation, memory, first), T::all(None), false);
        loop {
            let Accepted { next, good, inside } = accept(equation, &solution, time, control);
            let Solution { iterations, residual, .. } = solution;
            let advanced = Advanced { state: next, iterations, residual };
            if good.all() {
                memory.learn(K::BLOCKS, &solution.unknown, solution.rate);
                return Ok(advanced);
            }
            let given = finite(state) & finite(control) & time.is_finite();
            if is_rescued {
                if good.any() {
                    memory.learn(K::BLOCKS, &solution.unknown, solution.rate);
                } else {
                    memory.forget();
                }
                let errors = T::each(|lane| {
                    let late =
                        if inside.lane(lane) { StepError::NotFinite } else { StepError::OutsideDomain };
                    let error = errors.as_ref()[lane].unwrap_or(late);
                    let is_given = given.lane(lane);
                    (!good.lane(lane)).then_some(if is_given { error } else { StepError::NotFinite })
                });
                return Err(Failure { errors, advanced });
            }
            errors = rescue(equation, &mut solution, given & !good);
            is_rescued = true;
        }
    }
}

/// The solution by what is fast: fixed-point iterations where they contract strongly, else Newton's method.
#[inline(always)]
fn solve<T: Batch, K: Kernel<T>>(
    equation: &AtState<'_, T, K>,
    memory: &Memory<T, K::Unknown>,
    first: Option<K::Unknown>,
) -> SolutionOf<T, K> {
    let remembers = memory.predictor.remembers();
    let guess = match remembers {
        true if memory.is_due() && K::HAS_FIXED_POINT_UPDATE => memory.predictor.latest(),
        true => memory.predictor.next(),
        false => equation.start(),
    };
    if const { <K::Unknown as Components<T>>::LENGTH == 0 } {
        return Solution::of(equation, &guess, T::Mask::splat(true), memory.rate);
    }
    let (mut before, mut elsewhere, mut rate) = (None, T::Mask::splat(remembers), memory.rate);
    if const { K::HAS_FIXED_POINT_UPDATE } && memory.tries().any() {
        let solution = fixed_point::solve(equation, memory, &guess, first);
        if solution.solved.all() {
            return solution;
        }
        (elsewhere, rate) = (elsewhere & !memory.is_strong(), solution.rate);
        before = Some(solution);
    }
    T::dispatch(Newton { equation, before: before.as_ref(), from: &guess, elsewhere, rate })
}

/// Solves the lanes that are `wanted` once more, from nothing that is remembered. Returns what is wrong with them.
#[inline(always)]
fn rescue<T: Batch, K: Kernel<T>>(
    equation: &AtState<'_, T, K>,
    solution: &mut SolutionOf<T, K>,
    wanted: T::Mask,
) -> T::Each<Option<StepError>> {
    let (start, mut errors, mut failed, mut lane) = (&equation.start(), T::all(None), T::of(0.0), 0);
    while lane < T::LANES {
        if wanted.lane(lane) {
            match T::dispatch(Rescue { equation, blocks: K::BLOCKS, start, lane }) {
                Ok(Rescued { unknown, residual, evaluations }) => {
                    let mut k = 0;
                    while k < K::Unknown::LENGTH {
                        solution.unknown.as_mut()[k].set_lane(lane, unknown.as_ref()[k].lane(lane));
                        k += 1;
                    }
                    solution.residual.set_lane(lane, residual.lane(lane));
                    solution.iterations.as_mut()[lane] = evaluations;
                }
                Err(error) => {
                    errors.as_mut()[lane] = Some(error);
                    failed.set_lane(lane, Scalar::of(1.0));
                }
            }
        }
        lane += 1;
    }
    solution.point = select(wanted, &solution.unknown, &solution.point);
    solution.solved = solution.solved | wanted;
    // with all lanes solved it does no more than to evaluate
    let (before, elsewhere) = (Some(&*solution), T::Mask::splat(false));
    let (from, rate) = (&solution.point, solution.rate);
    let evaluated = T::dispatch(Newton { equation, before, from, elsewhere, rate });
    *solution = evaluated;
    solution.solved = solution.solved & failed.le(T::of(0.0));
    errors
}

/// The end of a step from the solution of its equation.
struct Accepted<T: Batch, S> {
    next: S,
    /// The lanes in which nothing is wrong, and those in which the solution is inside the retraction's domain.
    good: T::Mask,
    inside: T::Mask,
}

#[inline(always)]
fn accept<T: Batch, K: Kernel<T>>(
    equation: &AtState<'_, T, K>,
    solution: &SolutionOf<T, K>,
    time: T,
    control: &K::Control,
) -> Accepted<T, K::State> {
    let AtState { kernel, state, step } = *equation;
    let Solution { unknown, evaluation, solved, .. } = solution;
    let next = kernel.finish(state, step, unknown, evaluation);
    let inside = is_inside(kernel, state, step, unknown, evaluation);
    // a component that is not finite before the step is not finite after it
    let good = *solved & inside & finite(&next) & finite(control) & time.is_finite();
    Accepted { next, good, inside }
}
