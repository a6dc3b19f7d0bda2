//! Solves the equations of successive steps: each from where the earlier solutions point, by fixed-point sweeps where these contract
//! strongly, else by Newton's iteration.
//!
//! Successive solutions are samples of a smooth course, so that the next one is known to many digits before anything is solved. The sweep
//! `x ← L⁻¹ right(x)` of an equation `L x = right(x)` takes off the factor by which it contracts, about the angle turned in a step; in small
//! steps one or two of them bring what is left below rounding. Whether they did is checked at every step: the change that a sweep makes,
//! times a bound for the contraction, bounds the error after it. The bound is measured, along all unknowns, at the start and from time to
//! time; where it is not small, or sweeps do not do what they should, Newton's iteration takes over. What a sweep may change is compared
//! with the unknown's size at that time: sweeps contract as the angle turned in a step, so that when the motion gets faster or slower the
//! error remains what it was, relative to the unknown.

use crate::extrapolation::{Extrapolation, WINDOW, square, squared_distance};
use crate::kernel::{Components, Evaluation, Kernel};
use crate::lanes::Processor;
use crate::newton::{self, Solution, SolutionOf, select, size};
use crate::scalar::{Batch, Mask, Real, Work};

/// Steps between two looks at how well extrapolation and sweeps do: at first, and in the long run.
const INTERVALS: [u32; 2] = [128, 1024];
/// How often between two such looks sweeps may fail to do what they should, each time with a look of its own.
const PATIENCE: f64 = 3.0;
/// Sweeps contract strongly if their bound is at most this.
const STRONG: f64 = 0.5;
/// What the bound is multiplied by, for it may grow until it is measured again.
const SAFETY: f64 = 2.0;
/// The most sweeps of a step: more, and Newton's iteration is faster.
const SWEEPS: u32 = 12;
/// An error of the unknown this small, in units of epsilon, is roundoff, and never is one that is larger than this.
const ROUNDOFF: [f64; 2] = [2.0, 8.0];
/// An error this small, in units of epsilon, makes no difference to the state, next to what is rounded there. The unknown changes the state
/// by about as much as sweeps contract: by the angle turned in a step.
const NO_DIFFERENCE: f64 = 0.1;
/// Sweeps do not change less, in units of epsilon, if only for rounding.
const NOISE: f64 = 8.0;
/// The change of the last sweep, in units of epsilon: what is evaluated before it serves for the solution too.
const LAST_CHANGE: f64 = 256.0;

/// What is remembered of the solutions of earlier steps.
#[derive(Clone, Copy, Debug)]
pub struct Solver<T: Batch, U> {
    /// Where the earlier solutions point.
    guess: Apart<U>,
    /// The earlier solutions.
    course: Extrapolation<T, U>,
    /// Steps until the next look.
    due: u32,
    /// Steps from the next look to the one after it.
    interval: u32,
    /// Whether sweeps are to be made in all lanes.
    is_strong: bool,
    /// The square of the change that a sweep may make to be the last one; negative if sweeps are not to be made.
    tolerance: T,
    /// What such a change means for the residual, relative to the equation's terms.
    residual: T,
    /// How often sweeps failed since the last look that was due.
    failures: T,
    /// What steps solved by sweeps took beyond one sweep each.
    effort: Effort<T>,
}

/// Sweeps beyond the first of each step, and the most sweeps of one.
#[derive(Clone, Copy)]
pub(crate) struct Effort<T: Batch> {
    pub more: T::Each<u64>,
    pub most: T::Each<u32>,
}

impl<T: Batch> core::fmt::Debug for Effort<T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (more, most) = (self.more.as_ref(), self.most.as_ref());
        f.debug_struct("Effort").field("more", &more).field("most", &most).finish()
    }
}

impl<T: Batch> Effort<T> {
    fn none() -> Self {
        Self { more: T::all(0), most: T::all(1) }
    }

    fn count(&mut self, iterations: &T::Each<u32>) {
        let counts = self.more.as_mut().iter_mut().zip(self.most.as_mut());
        for ((more, most), iterations) in counts.zip(iterations.as_ref()) {
            *more += u64::from(iterations.saturating_sub(1));
            *most = (*most).max(*iterations);
        }
    }
}

/// Components that do not lie side by side: `i` is in the first or second array as it is even or odd.
///
/// What is stored in pieces of one size and loaded in pieces of another has to wait until it is in the cache, and the next step waits for it.
/// Side by side the compiler would load other pairs than it stored.
#[derive(Clone, Copy, Debug)]
struct Apart<U>([U; 2]);

impl<U> Apart<U> {
    #[inline(always)]
    fn together<T>(&self) -> U
    where
        U: Components<T>,
        T: Copy,
    {
        let mut together = self.0[0];
        for (i, component) in together.as_mut().iter_mut().enumerate() {
            *component = self.0[i % 2].as_ref()[i];
        }
        together
    }

    #[inline(always)]
    fn put<T>(&mut self, components: &U)
    where
        U: Components<T>,
        T: Copy,
    {
        for (i, component) in components.as_ref().iter().enumerate() {
            self.0[i % 2].as_mut()[i] = *component;
        }
    }
}

/// Sweeps from a point on.
struct Sweeps<'a, T: Batch, K: Kernel<T>> {
    kernel: &'a K,
    state: &'a K::State,
    step: &'a K::Step,
    point: K::Unknown,
    /// In which lanes.
    wanted: T::Mask,
    /// The square of the change that the last one may make.
    tolerance: T,
    /// How many there were.
    made: u32,
    /// How many there will have been after the next, in each lane.
    iterations: T::Each<u32>,
}

/// What sweeps led to.
struct Swept<T: Batch, U, I> {
    /// Where the equation was evaluated the last time.
    point: U,
    unknown: U,
    evaluation: Evaluation<U, I>,
    iterations: T::Each<u32>,
    /// The lanes in which they were not enough.
    open: T::Mask,
}

impl<T: Batch, U: Copy, I: Copy> Swept<T, U, I> {
    #[inline(always)]
    fn solution(&self, residual: T) -> Solution<T, U, I> {
        let (unknown, evaluation) = (self.unknown, self.evaluation);
        Solution { unknown, evaluation, iterations: self.iterations, residual, unsolved: self.open }
    }
}

impl<T: Batch, K: Kernel<T>> Work for Sweeps<'_, T, K> {
    type Home = K;
    type Result = Option<Swept<T, K::Unknown, K::Iterate>>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { kernel, state, step, mut point, wanted, tolerance, mut made, mut iterations } = self;
        loop {
            let evaluation = kernel.evaluate(state, step, &point);
            let unknown = kernel.sweep(state, step, &evaluation.right)?;
            made = made.saturating_add(1);
            let open = wanted & !squared_distance(&point, &unknown).at_most(tolerance);
            if !open.any() || made >= SWEEPS {
                return Some(Swept { point, unknown, evaluation, iterations, open });
            }
            // solved lanes wait: the same again gives the same
            point = select(open, &unknown, &point);
            newton::count::<T>(&mut iterations, open);
        }
    }
}

/// Remembers nothing.
impl<T: Batch, U: Components<T>> Default for Solver<T, U> {
    fn default() -> Self {
        let nothing = U::splat(T::of(0.0));
        Self {
            guess: Apart([nothing; 2]),
            course: Extrapolation::default(),
            due: 0,
            interval: INTERVALS[0],
            is_strong: false,
            tolerance: T::of(-1.0),
            residual: T::of(0.0),
            failures: T::of(0.0),
            effort: Effort::none(),
        }
    }
}

impl<T: Batch, U: Components<T>> Solver<T, U> {
    /// What steps that were solved by sweeps took since this was asked the last time, and the residual that they left.
    pub(crate) fn effort(&mut self) -> (Effort<T>, T) {
        (core::mem::replace(&mut self.effort, Effort::none()), self.residual)
    }

    /// Whether there is nothing to solve for: known when the code is compiled.
    const IS_IDLE: bool = U::LENGTH == 0;

    /// Whether there is nothing to solve for.
    #[inline(always)]
    pub(crate) fn is_idle(&self) -> bool {
        Self::IS_IDLE
    }

    /// How many of the next steps are like most: to be solved by sweeps, without a look.
    #[inline(always)]
    pub fn usual(&self) -> u64 {
        if self.is_idle() {
            u64::MAX
        } else if self.is_strong {
            self.due.into()
        } else {
            0
        }
    }

    /// Where the earlier solutions point.
    #[inline(always)]
    pub fn guess(&self) -> U {
        self.guess.together()
    }

    /// Takes back what [`by_sweeps`](Self::by_sweeps) made of the guess.
    #[inline(always)]
    pub fn set_guess(&mut self, guess: &U) {
        self.guess.put(guess);
    }

    /// Solves a step's equation as most are solved, from where the earlier solutions point, by sweeps. None if these do not solve it in all
    /// lanes.
    ///
    /// After a solution the guess is the next step's: [`push_usual`](Self::push_usual) it. Part of that is computed while something is waited
    /// for: the state, where the step is by itself, as one of several with methods of their own is; else the solution.
    #[inline(always)]
    pub fn by_sweeps<P: Processor, const BY_ITSELF: bool, K>(
        &mut self,
        kernel: &K,
        state: &K::State,
        step: &K::Step,
        guess: &mut U,
    ) -> Option<SolutionOf<T, K>>
    where
        K: Kernel<T, Unknown = U>,
    {
        if const { Self::IS_IDLE } {
            return Some(evaluated(kernel, state, step, guess));
        }
        // The processor does not see far ahead: the order is that in which it is to go.
        let begun = if const { BY_ITSELF } { Some(self.course.begun::<P>()) } else { None };
        let point = *guess;
        let evaluation = kernel.evaluate(state, step, &point);
        let unknown = kernel.sweep(state, step, &evaluation.right)?;
        let open = !squared_distance(&point, &unknown).at_most(self.tolerance);
        let swept = if open.any() {
            // solved lanes wait: the same again gives the same
            let point = select(open, &unknown, &point);
            let mut iterations = T::all(1);
            newton::count::<T>(&mut iterations, open);
            // copies, so that the usual way needs no addresses
            let (kernel, state, step) = (*kernel, *state, *step);
            let (kernel, state, step) = (&kernel, &state, &step);
            let wanted = T::Mask::splat(true);
            let sweeps =
                Sweeps { kernel, state, step, point, wanted, tolerance: self.tolerance, made: 1, iterations };
            let swept = T::outline(sweeps)?;
            if swept.open.any() {
                return None;
            }
            self.effort.count(&swept.iterations);
            swept
        } else {
            Swept { point, unknown, evaluation, iterations: T::all(1), open }
        };
        // the next guess before what follows from this solution, for the next step waits for it
        let begun = match begun {
            Some(begun) => begun,
            None => self.course.begun::<P>(),
        };
        *guess = self.course.then(&begun, &swept.unknown);
        Some(swept.solution(self.residual))
    }

    /// Solves a step's equation by whatever it takes. If the state is `known`, the one that the last step led to, the search starts where the
    /// earlier solutions point.
    #[inline(always)]
    pub fn solve<K>(&mut self, kernel: &K, state: &K::State, step: &K::Step, known: bool) -> SolutionOf<T, K>
    where
        K: Kernel<T, Unknown = U>,
    {
        let guess = self.guess.together();
        if const { Self::IS_IDLE } {
            return evaluated(kernel, state, step, &guess);
        }
        if !known {
            *self = Self::default();
        }
        let guess = if self.course.count() == 0 { kernel.start(state, step) } else { guess };
        let mut wanting = T::Mask::splat(self.due == 0);
        if self.due == 0 {
            self.failures = T::of(0.0);
        }
        let strong = T::of(0.0).below(self.tolerance);
        let swept = if const { K::SWEEPS } && strong.any() {
            self.sweeps(kernel, state, step, &guess, strong)
        } else {
            None
        };
        let solution = match swept {
            Some((_, swept)) if !swept.unsolved.any() => swept,
            // one place for Newton's iteration, after sweeps or without: it is much to compile
            swept => {
                let (start, left) = match &swept {
                    Some((point, swept)) => (select(swept.unsolved, &guess, point), swept.unsolved),
                    None => (guess, T::Mask::splat(true)),
                };
                let solved = self.newton(kernel, state, step, &start, left);
                match swept {
                    None => solved,
                    Some((_, swept)) => {
                        // where sweeps do not do what they should there has to be a look, and if it does not help, Newton's iteration until the
                        // next
                        let failed = left & strong;
                        self.failures = T::select(failed, self.failures + T::of(1.0), self.failures);
                        let hopeful = self.failures.at_most(T::of(PATIENCE));
                        wanting = wanting | (failed & hopeful);
                        self.tolerance = T::select(failed & !hopeful, T::of(-1.0), self.tolerance);
                        self.is_strong = T::of(0.0).below(self.tolerance).all();
                        Solution {
                            unknown: select(left, &solved.unknown, &swept.unknown),
                            evaluation: solved.evaluation,
                            iterations: newton::sum::<T>(swept.iterations, solved.iterations),
                            residual: T::select(left, solved.residual, swept.residual),
                            unsolved: solved.unsolved,
                        }
                    }
                }
            }
        };
        if wanting.any() {
            self.look(kernel, state, step, &solution.unknown, wanting);
        }
        if self.due == 0 && self.course.count() == WINDOW {
            self.due = self.interval;
            self.interval = (2 * self.interval).min(INTERVALS[1]);
        }
        solution
    }

    /// Newton's iteration in the `wanted` lanes.
    #[inline(always)]
    fn newton<K>(
        &self,
        kernel: &K,
        state: &K::State,
        step: &K::Step,
        start: &U,
        wanted: T::Mask,
    ) -> SolutionOf<T, K>
    where
        K: Kernel<T, Unknown = U>,
    {
        let mut solution = newton::solve(kernel, state, step, start, wanted);
        if self.course.count() > 1 && solution.unsolved.any() {
            // the course was not as smooth as that
            let left = solution.unsolved;
            let start = select(left, &self.course.latest(), &solution.unknown);
            let again = newton::solve(kernel, state, step, &start, left);
            solution = Solution {
                iterations: newton::sum::<T>(solution.iterations, again.iterations),
                residual: T::select(left, again.residual, solution.residual),
                ..again
            };
        }
        solution
    }

    /// Sweeps until the change is small enough in the `wanted` lanes. Returns where the equation was evaluated the last time, too. None if the
    /// equation is not one for sweeps.
    #[inline(always)]
    fn sweeps<K>(
        &self,
        kernel: &K,
        state: &K::State,
        step: &K::Step,
        guess: &U,
        wanted: T::Mask,
    ) -> Option<(U, SolutionOf<T, K>)>
    where
        K: Kernel<T, Unknown = U>,
    {
        let (point, wanted, tolerance) = (*guess, wanted, self.tolerance);
        let sweeps = Sweeps { kernel, state, step, point, wanted, tolerance, made: 0, iterations: T::all(1) };
        let swept = T::outline(sweeps)?;
        let unsolved = swept.open | !wanted;
        let solution = swept.solution(self.residual);
        Some((swept.point, Solution { unsolved, ..solution }))
    }

    /// The latest solution.
    pub(crate) fn latest(&self) -> U {
        self.course.latest()
    }

    /// Remembers the solution of a step that [`solve`](Self::solve) solved.
    #[inline(always)]
    pub fn push(&mut self, unknown: &U) {
        self.course.push(unknown);
        self.due = self.due.saturating_sub(1);
        self.guess.put(&self.course.next());
    }

    /// Remembers the solution of a step that [`by_sweeps`](Self::by_sweeps) solved. These steps are [counted](Self::took) later.
    #[inline(always)]
    pub fn push_usual<P: Processor>(&mut self, unknown: &U) {
        self.course.replace_oldest::<P>(unknown);
    }

    /// So many [usual](Self::usual) steps were taken.
    #[inline(always)]
    pub fn took(&mut self, steps: u64) {
        self.due = u64::from(self.due).saturating_sub(steps) as u32;
    }

    /// Forgets all.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Sees, in the `wanting` lanes, how many earlier solutions would have pointed best at this one, and how strongly sweeps contract there.
    #[inline(always)]
    fn look<K>(&mut self, kernel: &K, state: &K::State, step: &K::Step, solution: &U, wanting: T::Mask)
    where
        K: Kernel<T, Unknown = U>,
    {
        let contraction = if const { K::SWEEPS } {
            T::outline(Contraction { kernel, state, step, unknown: solution })
        } else {
            None
        };
        let bound = T::of(SAFETY) * contraction.unwrap_or(T::of(1.0));
        let per_bound = T::of(1.0) / (bound + T::of(TINY));
        // the error that is left
        let error = T::of(NO_DIFFERENCE) * per_bound;
        let [least, most] = [T::of(ROUNDOFF[0]), T::of(ROUNDOFF[1])];
        let error = T::select(error.at_most(most), error, most);
        let error = T::select(error.at_most(least), least, error);
        let slack = T::of(T::EPSILON) * error * per_bound;
        let most = T::of(LAST_CHANGE * T::EPSILON);
        let least = T::of(NOISE * T::EPSILON);
        let slack = T::select(slack.at_most(most), slack, most);
        let slack = T::select(slack.at_most(least), least, slack);
        let size = square(solution);
        let tolerance = slack * slack * size;
        // neither too small nor too large for numbers of the kind, with room for what is to come
        let sizeable =
            T::of(T::LEAST / T::EPSILON).at_most(tolerance) & size.at_most(T::of(T::EPSILON / T::LEAST));
        let strong = bound.at_most(T::of(STRONG)) & sizeable;
        let tolerance = T::select(strong, tolerance, T::of(-1.0));
        self.tolerance = T::select(wanting, tolerance, self.tolerance);
        self.course.choose(solution, wanting, tolerance);
        self.residual = T::select(wanting, T::select(strong, bound * slack, T::of(0.0)), self.residual);
        self.is_strong = T::of(0.0).below(self.tolerance).all();
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.course.memory(visit);
        let mut numbers = [T::of(f64::from(self.due)), T::of(f64::from(self.interval))];
        visit(&mut numbers);
        // the same in all lanes
        let [due, interval] = [numbers[0].lane(0).to_f64() as u32, numbers[1].lane(0).to_f64() as u32];
        (self.due, self.interval) = (due, interval.min(INTERVALS[1]));
        visit(core::slice::from_mut(&mut self.tolerance));
        visit(core::slice::from_mut(&mut self.residual));
        visit(core::slice::from_mut(&mut self.failures));
        self.is_strong = T::of(0.0).below(self.tolerance).all();
        self.guess.put(&self.course.next());
    }
}

/// The equation of an explicit step, which has nothing to solve for.
#[inline(always)]
fn evaluated<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    nothing: &K::Unknown,
) -> SolutionOf<T, K> {
    let evaluation = kernel.evaluate(state, step, nothing);
    let (iterations, unsolved) = (T::all(0), T::Mask::splat(false));
    Solution { unknown: *nothing, evaluation, iterations, residual: T::of(0.0), unsolved }
}

/// Nothing next to any unknown, and yet no zero.
const TINY: f64 = 1e-37;

/// The norm of the derivative of the sweep, by differences: the root of the sum of all entries' squares, which bounds how much longer the
/// sweep makes any change. None if there are no sweeps; not a number if any component is.
struct Contraction<'a, T: Batch, K: Kernel<T>> {
    kernel: &'a K,
    state: &'a K::State,
    step: &'a K::Step,
    unknown: &'a K::Unknown,
}

impl<T: Batch, K: Kernel<T>> Work for Contraction<'_, T, K> {
    type Home = K;
    type Result = Option<T>;

    #[inline(always)]
    fn done(self) -> Option<T> {
        let Self { kernel, state, step, unknown } = self;
        let sweep =
            |x: &K::Unknown| kernel.sweep(state, step, &newton::evaluated(kernel, state, step, x).right);
        let here = sweep(unknown)?;
        let size = size(unknown.as_ref());
        // at rest: as far as a thousandth of a radian
        let moves = T::of(0.0).below(size);
        let offset = T::of(1e-3) * T::select(moves, size, T::of(1.0));
        let per_offset = T::of(1.0) / offset;
        let mut squares = T::of(0.0);
        for i in 0..unknown.as_ref().len() {
            let mut there = *unknown;
            there.as_mut()[i] = there.as_ref()[i] + offset;
            for (here, there) in here.as_ref().iter().zip(sweep(&there)?.as_ref()) {
                let slope = per_offset * (*there - *here);
                squares = squares.plus(slope, slope);
            }
        }
        Some(squares.sqrt())
    }
}
