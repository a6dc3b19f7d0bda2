//! A step that is one equation, from its kernel: the whole story.

use super::constants::{FAR, FEW};
use super::equation::{Begun, BegunStep, Ended, Facts, Iterated, ended};
use super::memory::{Convergence, Memory, is_left};
use super::newton::{Newton, is_found_from_start};
use super::predictor::{Continuation, Guess, Predictor};
use super::rescue::{Rescue, Rescued};
use super::{Solution, fixed_point, go_on};
use crate::error::StepError;
use crate::kernel::{self, AtState, Evaluation, Kernel, is_inside, is_surely_finite};
#[cfg(feature = "dynamic")]
use crate::method::Clock;
use crate::method::{Advanced, Failure, Method, Outcome};
use crate::scalar::blocks::{change, is_within, less, plus, select};
use crate::scalar::simd::lanes::{Portable, Processor};
use crate::scalar::simd::loads::{apart, apart_here, one_by_one};
#[cfg(feature = "dynamic")]
use crate::scalar::simd::{
    frame::Framed,
    march::{Lent, Marched},
};
use crate::scalar::{Batch, Components, Mask, Scalar, Work};

/// One generated kernel: a step is one equation, solved from where the solutions of earlier steps point.
#[derive(Clone, Copy)]
pub struct OneStep<T: Batch, K: Kernel<T>> {
    kernel: K,
    memory: Memory<T, K::Unknown>,
}

impl<T: Batch, K: Kernel<T>> Method for OneStep<T, K> {
    type CallSite = K;
    type Scalar = T;
    type Parameters = K::Parameters;
    type State = K::State;
    type Control = K::Control;

    fn new(parameters: &K::Parameters, step: T) -> Self {
        Self { kernel: kernel::new(parameters, step), memory: Memory::default() }
    }

    const HAS_FAST_PATH: bool = true;
    /// There is one wherever steps are [ready](Method::ready_for).
    type FastPath = Option<Ahead<K::Unknown>>;

    #[inline(always)]
    fn ready_for(&self) -> u64 {
        self.memory.ready_for()
    }

    #[inline(always)]
    fn enter(&self) -> Self::FastPath {
        Some(Ahead { guess: self.memory.predictor.guess(), more: (0, 0) })
    }

    #[inline(always)]
    fn advance_fast<P: Processor>(
        &mut self,
        path: &mut Self::FastPath,
        state: &K::State,
        time: T,
        control: &K::Control,
    ) -> (K::State, Option<usize>) {
        let Some(ahead) = path else { return (*state, Some(0)) };
        let (next, done) = fast_path::<P, _, _>(&self.kernel, &mut self.memory, ahead, state, time, control);
        (next, done.err().map(|_| 0))
    }

    #[inline(always)]
    fn leave(&mut self, path: &mut Self::FastPath, steps: u64, _stages: usize) -> (u64, u32) {
        self.memory.took(steps);
        path.as_ref().map_or((0, 0), |ahead| {
            self.memory.predictor.set(&ahead.guess);
            ahead.more
        })
    }

    #[inline(always)]
    fn on_fast_path(&self) -> (T::Each<u32>, T) {
        if const { Self::IS_EXPLICIT } {
            (T::all(0), T::of(0.0))
        } else {
            (T::all(1), Convergence::of(&self.kernel).left(self.memory.rate, self.memory.tolerance))
        }
    }

    #[inline(always)]
    fn advance_from(
        &mut self,
        _stage: Option<usize>,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
    ) -> Outcome<T, K::State> {
        // copies, so that the fast path needs no addresses
        let (state, control) = (*state, *control);
        T::dispatch(Slow { method: self, state: &state, time, control: &control, known, first: None })
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
            return self.advance_as_many::<true>(state, time, control, known);
        }
        self.advance_one::<true>(state, time, control, known)
    }

    #[inline(always)]
    fn advance_apart<const WIDE: bool>(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
    ) -> Outcome<T, K::State> {
        if const { T::LANES > 1 } {
            return self.advance_as_many::<WIDE>(state, time, control, known);
        }
        self.advance_one::<false>(state, time, control, known)
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        let Self { kernel, memory } = self;
        memory.memory(Convergence::of(kernel), Continuation::of(kernel), visit);
    }
}

impl<T: Batch, K: Kernel<T>> OneStep<T, K> {
    /// Takes a step of one number: on the fast path, or farther, which is compiled `IN_LINE` as far as it is as most steps are.
    #[inline(always)]
    fn advance_one<const IN_LINE: bool>(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
    ) -> Outcome<T, K::State> {
        let mut first = None;
        // nearly all steps go this way
        if known && self.ready_for() > 0 {
            let Self { kernel, memory } = self;
            let mut ahead = Ahead { guess: memory.predictor.guess(), more: (0, 0) };
            let (next, done) = fast_path::<Portable, _, _>(kernel, memory, &mut ahead, state, time, control);
            match done {
                Ok(()) => {
                    memory.predictor.set(&ahead.guess);
                    memory.took(1);
                    let (mut iterations, residual) = self.on_fast_path();
                    let more = ahead.more.1;
                    iterations.as_mut().iter_mut().for_each(|all| *all = all.wrapping_add(more));
                    return Ok(Advanced { state: next, iterations, residual });
                }
                Err(ended) => first = ended,
            }
        }
        self.advance_farther::<IN_LINE>(state, time, control, known, first)
    }

    /// Takes a step that needs more than there is on the fast path, where a `first` iteration may have been made.
    #[inline(always)]
    pub(crate) fn advance_farther<const IN_LINE: bool>(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
        first: Option<K::Unknown>,
    ) -> Outcome<T, K::State> {
        // in line, so that numbers stay in registers: a step with four iterations takes a third less
        if known && const { IN_LINE && !K::IS_LONG } && self.memory.is_regular() {
            let Self { kernel, memory } = self;
            let (step, facts) = (&kernel.begin(state, time, control), Facts::of(kernel));
            let equation = &AtState { kernel: &*kernel, state, step };
            let guess = predicted(equation, &facts, memory);
            let solution = fixed_point::solve(equation, &facts, memory, &guess, first);
            if let Some(advanced) = advanced::<_, _, true>(equation, &facts, memory, &solution, time, control)
            {
                return Ok(advanced);
            }
        }
        // copies, so that the fast path needs no addresses
        let (state, control) = (*state, *control);
        T::dispatch(Slow { method: self, state: &state, time, control: &control, known, first })
    }

    /// What machine code takes steps on the fast path with, on this frame, up to `most`.
    #[cfg(feature = "dynamic")]
    pub(crate) fn lent<'a>(&'a mut self, frame: &'a mut [T::Row], clock: Clock, most: u64) -> Lent<'a>
    where
        T: Framed,
    {
        let Memory { predictor, tolerance, .. } = &mut self.memory;
        let Clock { start, step, taken } = clock;
        let weights = predictor.weights(Continuation::of(&self.kernel));
        Lent::new(frame, predictor.remembered(), *tolerance, &weights, (start, step, taken), most)
    }

    /// Remembers what was taken so: so many steps.
    #[cfg(feature = "dynamic")]
    pub(crate) fn marched(&mut self, marched: &Marched, steps: u64) {
        self.memory.predictor.marched(marched.oldest);
        self.memory.took(steps);
    }

    /// The steps of a kernel that is there.
    #[cfg(feature = "dynamic")]
    pub(crate) fn of(kernel: K) -> Self {
        Self { kernel, memory: Memory::default() }
    }

    /// The kernel.
    #[cfg(feature = "dynamic")]
    pub(crate) fn kernel(&self) -> K {
        self.kernel
    }

    /// Whether there is nothing to solve for.
    const IS_EXPLICIT: bool = <K::Unknown as Components<T>>::LENGTH == 0;

    /// The solution of the last step's equation.
    pub(crate) fn solution(&self) -> K::Unknown {
        if self.kernel.is_newton() {
            self.memory.predictor.solution()
        } else {
            self.memory.predictor.latest()
        }
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

/// Where the solutions before point, and how many iterations more than one steps took, all together and at most.
#[derive(Clone, Copy)]
pub struct Ahead<U> {
    guess: Guess<U>,
    more: (u64, u32),
}

/// Takes a step as nearly all are: one iteration, from where the solutions before it point, changes the unknown by little, and everything is
/// finite; of Newton's method a few iterations. The `guess` is the next step's then. Else nothing has changed, and if there was one iteration,
/// this is where it led to.
///
/// Numbers that the next step waits for are computed one by one: the compiler would put them together, and take them apart again.
#[inline(always)]
fn fast_path<P: Processor, T: Batch, K: Kernel<T>>(
    kernel: &K,
    memory: &mut Memory<T, K::Unknown>,
    ahead: &mut Ahead<K::Unknown>,
    state: &K::State,
    time: T,
    control: &K::Control,
) -> (K::State, Result<(), Option<K::Unknown>>) {
    let step = kernel.begin(state, time, control);
    let (mut point, oldest) = ahead.guess;
    let mut start = None;
    if kernel.is_newton() {
        let first = kernel.start(state, &step);
        (point, start) = (plus(&first, T::of(1.0), &point), Some(first));
    }
    let (mut unknown, mut kept, mut then, mut more) = (point, point, point, 0);
    let mut last = T::of(FAR);
    let evaluation = loop {
        let evaluation = kernel.evaluate(state, &step, &point);
        if const { OneStep::<T, K>::IS_EXPLICIT } {
            break evaluation;
        }
        unknown = apart::<T, _>(&kernel.fixed_point_update(state, &step, &point, &evaluation));
        if !kernel.is_newton() {
            if is_within::<T, _>(kernel.blocks(), &point, &unknown, memory.tolerance).all() {
                break evaluation;
            }
            return (*state, Err(Some(unknown)));
        }
        let now = change::<T, _>(kernel.blocks(), &point, &unknown);
        // as far as the rate is known, and as far as it shows
        let is_last = now.le(memory.tolerance) & is_left(Convergence::of(kernel), now, last);
        if is_last.all() {
            break evaluation;
        }
        if more == FEW {
            // one step or many: from where it began, for both
            return (*state, Err(None));
        }
        // in lanes that have ended nothing changes
        point = go_on::<T, _>(!is_last, &unknown, &point);
        (last, more) = (T::select(is_last, last, now), more + 1);
    };
    if const { !OneStep::<T, K>::IS_EXPLICIT } {
        if let Some(start) = &start
            && kernel.finds_any()
        {
            let equation = &AtState { kernel, state, step: &step };
            if !is_found_from_start(equation, kernel.blocks(), start, &unknown, T::Mask::splat(true)).all() {
                return (*state, Err(None));
            }
        }
        // before what follows from this solution, for the next step waits for it
        kept = start.map_or(unknown, |start| apart::<T, _>(&less(&unknown, &start)));
        let by = Continuation::of(kernel);
        let weights = memory.predictor.weights(by);
        let begun = memory.predictor.begun::<P>(oldest, by, &weights);
        then = apart_here::<T, _>(&Predictor::then(&begun, &kept, by, &weights));
    }
    let next = apart::<T, _>(&kernel.finish(state, &step, &unknown, &evaluation));
    let inside = is_inside(kernel, state, &step, &unknown, &evaluation).all();
    if !(inside & is_surely_finite::<T, K>(&next, control).all()) {
        return (*state, Err(None));
    }
    if const { !OneStep::<T, K>::IS_EXPLICIT } {
        ahead.guess = (then, memory.predictor.keep::<P>(oldest, &kept));
        if kernel.is_newton() {
            memory.predictor.note(&unknown);
        }
        ahead.more = (ahead.more.0.wrapping_add(u64::from(more)), ahead.more.1.max(more));
    }
    (next, Ok(()))
}

/// A step of a kernel, with all that can happen.
struct Slow<'a, T: Batch, K: Kernel<T>> {
    method: &'a mut OneStep<T, K>,
    state: &'a K::State,
    time: T,
    control: &'a K::Control,
    /// Whether the state is the one that the last step led to.
    known: bool,
    /// Where the first iteration on the fast path led to, if there was one.
    first: Option<K::Unknown>,
}

impl<T: Batch, K: Kernel<T>> Work for Slow<'_, T, K> {
    type CallSite = K;
    type Result = Outcome<T, K::State>;

    #[inline(always)]
    fn done(self) -> Outcome<T, K::State> {
        let Self { method: OneStep { kernel, memory }, state, time, control, known, first } = self;
        let state = &one_by_one::<T, _>(state);
        if !known {
            memory.forget();
        }
        let (step, facts) = (&kernel.begin(state, time, control), Facts::of(kernel));
        let at = AtState { kernel: &*kernel, state, step };
        let mut before = None;
        // one step alone: numbers stay in registers; in lanes there are too few
        if const { T::LANES == 1 && K::Unknown::LENGTH > 0 } && memory.tries().any() {
            let guess = guess(&at, &facts, memory);
            let solution = fixed_point::solve(&at, &facts, memory, &guess, first);
            if let Some(advanced) = advanced::<_, _, false>(&at, &facts, memory, &solution, time, control) {
                return Ok(advanced);
            }
            before = Some((guess, solution.without_evaluation()));
        }
        let mut begun = BegunStep { at, time, control, next: *state };
        let Taken { errors, iterations, residual } =
            T::dispatch(SlowPath { equation: &mut begun, facts, memory, first, before });
        let advanced = Advanced { state: begun.next, iterations, residual };
        match errors {
            None => Ok(advanced),
            Some(errors) => Err(Failure { errors, advanced }),
        }
    }
}

/// The way that all kernels with as many unknowns have in common.
struct SlowPath<'a, T: Batch, U> {
    equation: &'a mut dyn Begun<T, U>,
    facts: Facts<'a>,
    memory: &'a mut Memory<T, U>,
    first: Option<U>,
    /// Iterations that were made, with where they began.
    before: Option<(U, Solution<T, U, ()>)>,
}

/// A step that was taken so, or was not.
struct Taken<T: Batch> {
    /// What is wrong, if anything is.
    errors: Option<T::Each<Option<StepError>>>,
    iterations: T::Each<u32>,
    residual: T,
}

/// Out of line: once for all equations with as many unknowns.
impl<T: Batch, U: Components<T>> Work for SlowPath<'_, T, U> {
    type CallSite = ();
    type Result = Taken<T>;

    #[inline(always)]
    fn done(self) -> Taken<T> {
        let Self { equation, ref facts, memory, mut first, before: mut made } = self;
        let (mut unsolved, mut aside) = (None, None);
        let mut solution = loop {
            let (begin, mut before) = match made.take() {
                Some((begin, before)) => (begin, Some(before)),
                None => (guess(equation, facts, memory), None),
            };
            if const { U::LENGTH > 0 } && before.is_none() && memory.tries().any() {
                before = Some(fixed_point::solve(equation, facts, memory, &begin, first));
            }
            let solution = match before {
                Some(solution) if solution.solved.all() => solution,
                // a copy, so that iterations need no address
                _ => by_newton(equation, facts, memory, begin, before),
            };
            let solution = match unsolved {
                Some(unsolved) => completed(&unsolved, &solution),
                None => solution,
            };
            if solution.solved.all() || !memory.predictor.remembers() {
                break solution;
            }
            // once more as if nothing were remembered: what is hard to solve is solved as in a first step
            (unsolved, aside, first) = (Some(solution), Some(memory.set_aside()), None);
        };
        if let Some(aside) = aside {
            memory.take_up(aside);
        }
        let (mut errors, mut is_rescued) = (T::all(None), false);
        loop {
            let Solution { iterations, residual, solved, .. } = solution;
            let Ended { inside, finite, given } = equation.finish(&solution.point, &solution.unknown);
            let good = solved & inside & finite;
            if !good.all() && !is_rescued {
                errors = rescue(equation, facts, &mut solution, given & !good);
                is_rescued = true;
                continue;
            }
            if good.any() {
                let Solution { unknown, quick, rate, .. } = &solution;
                memory.learn::<false>(facts, || Iterated::start(equation), unknown, *quick, *rate);
            } else {
                memory.forget();
            }
            if good.all() {
                return Taken { errors: None, iterations, residual };
            }
            let errors = T::each(|lane| {
                let late = if inside.lane(lane) { StepError::NotFinite } else { StepError::OutsideDomain };
                let error = errors.as_ref()[lane].unwrap_or(late);
                let is_given = given.lane(lane);
                (!good.lane(lane)).then_some(if is_given { error } else { StepError::NotFinite })
            });
            return Taken { errors: Some(errors), iterations, residual };
        }
    }
}

/// Where the search for a solution begins.
#[inline(always)]
fn guess<T: Batch, U: Components<T>, E: Iterated<T, U> + ?Sized>(
    equation: &E,
    facts: &Facts<'_>,
    memory: &Memory<T, U>,
) -> U {
    let (remembers, is_due) = (memory.predictor.remembers(), memory.is_due());
    let is_newton = facts.convergence.is_newton();
    if remembers && !is_newton {
        return if is_due { memory.predictor.latest() } else { memory.predictor.next() };
    }
    let start = equation.start();
    if remembers && !is_due { plus(&start, T::of(1.0), &memory.predictor.next()) } else { start }
}

/// Where the solutions before point.
#[inline(always)]
fn predicted<T: Batch, U: Components<T>, E: Iterated<T, U> + ?Sized>(
    equation: &E,
    facts: &Facts<'_>,
    memory: &Memory<T, U>,
) -> U {
    let next = memory.predictor.next();
    let is_newton = facts.convergence.is_newton();
    if is_newton { plus(&equation.start(), T::of(1.0), &next) } else { next }
}

/// The solution by Newton's method, in the lanes in which fixed-point iterations did not lead to one.
#[inline(always)]
fn by_newton<T: Batch, U: Components<T>>(
    equation: &dyn Begun<T, U>,
    facts: &Facts<'_>,
    memory: &Memory<T, U>,
    from: U,
    before: Option<Solution<T, U, ()>>,
) -> Solution<T, U, ()> {
    if const { U::LENGTH == 0 } {
        let (all, none, residual) = (T::Mask::splat(true), T::Mask::splat(false), T::of(0.0));
        return Solution {
            point: from,
            unknown: from,
            evaluation: (),
            solved: all,
            quick: none,
            iterations: T::all(0),
            residual,
            rate: memory.rate,
        };
    }
    let (mut elsewhere, mut rate) = (T::Mask::splat(memory.predictor.remembers()), memory.rate);
    let mut from = from;
    if let Some(before) = &before {
        // iterations that contract strongly lead to one solution alone; Newton's do so to any, and may have come to it
        let is_sure = memory.is_strong() & T::Mask::splat(!facts.convergence.is_newton());
        (elsewhere, rate) = (elsewhere & !is_sure, before.rate);
        if facts.finds_any {
            from = before.unknown;
        }
    }
    T::dispatch(Newton { equation, facts, before: before.as_ref(), from: &from, elsewhere, rate })
}

/// A solution that was found in some lanes, completed by another one in the others.
#[inline(always)]
fn completed<T: Batch, U: Components<T>>(
    before: &Solution<T, U, ()>,
    other: &Solution<T, U, ()>,
) -> Solution<T, U, ()> {
    if const { T::LANES == 1 } {
        return Solution { quick: T::Mask::splat(false), ..*other };
    }
    let (known, mut completed) = (before.solved, *before);
    completed.unknown = select(known, &before.unknown, &other.unknown);
    completed.point = select(known, &before.point, &other.point);
    completed.residual = T::select(known, before.residual, other.residual);
    completed.rate = T::select(known, before.rate, other.rate);
    completed.quick = known & before.quick;
    completed.solved = known | other.solved;
    let mut lane = 0;
    while lane < T::LANES {
        if !known.lane(lane) {
            completed.iterations.as_mut()[lane] = other.iterations.as_ref()[lane];
        }
        lane += 1;
    }
    completed
}

/// Solves the lanes that are `wanted` once more, from nothing that is remembered. Returns what is wrong with them.
#[inline(always)]
fn rescue<T: Batch, U: Components<T>>(
    equation: &dyn Begun<T, U>,
    facts: &Facts<'_>,
    solution: &mut Solution<T, U, ()>,
    wanted: T::Mask,
) -> T::Each<Option<StepError>> {
    let start = &Iterated::start(equation);
    let (mut errors, mut failed, mut lane) = (T::all(None), T::of(0.0), 0);
    while lane < T::LANES {
        if wanted.lane(lane) {
            match T::dispatch(Rescue { equation, blocks: facts.blocks, start, lane }) {
                Ok(Rescued { unknown, residual, evaluations }) => {
                    let mut k = 0;
                    while k < U::LENGTH {
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
    solution.quick = solution.quick & !wanted;
    solution.solved = (solution.solved | wanted) & failed.le(T::of(0.0));
    errors
}

/// Where a step has led to, if its equation is solved in all lanes and nothing is wrong. What it learns of the step is compiled in line, a
/// twentieth of the instructions of steps with two iterations and a sixth of the time of those whose control jumps, in one place of each kernel.
#[inline(always)]
fn advanced<T: Batch, K: Kernel<T>, const IN_LINE: bool>(
    equation: &AtState<'_, T, K>,
    facts: &Facts<'_>,
    memory: &mut Memory<T, K::Unknown>,
    solution: &Solution<T, K::Unknown, Evaluation<K::Unknown, K::Iterate>>,
    time: T,
    control: &K::Control,
) -> Option<Advanced<T, K::State>> {
    if !solution.solved.all() {
        return None;
    }
    let Solution { unknown, evaluation, quick, iterations, residual, rate, .. } = solution;
    let next = equation.kernel.finish(equation.state, equation.step, unknown, evaluation);
    let Ended { inside, finite, .. } = ended(equation, unknown, evaluation, time, control, &next);
    if !(inside & finite).all() {
        return None;
    }
    memory.learn::<IN_LINE>(facts, || equation.start(), unknown, *quick, *rate);
    let (iterations, residual) = (*iterations, *residual);
    Some(Advanced { state: next, iterations, residual })
}
