//! Solves the equations of successive steps: each from where the earlier solutions point, by fixed-point sweeps where these contract
//! strongly, else by Newton's iteration.
//!
//! Successive solutions are samples of a smooth course, so that the next one is known to many digits before anything is solved. The sweep
//! `x ← L⁻¹ right(x)` of an equation `L x = right(x)` takes off the factor by which it contracts, about the angle turned in a step; in small
//! steps one or two of them bring what is left below rounding. Whether they did is checked at every step: the change that a sweep makes,
//! times a bound for the contraction, bounds the error after it. The bound is measured, along all unknowns, at the start and every 128
//! steps; where it is not small, or sweeps do not do what they should, Newton's iteration takes over.

use crate::kernel::{Components, Kernel};
use crate::newton::{self, Solution, SolutionOf, select, size};
use crate::scalar::{Batch, Mask, Real, Scalar};

/// The most earlier solutions that the next one is extrapolated from.
const DEPTH: usize = 8;
/// The numbers of earlier solutions that are tried.
const DEPTHS: [usize; 6] = [1, 2, 3, 4, 6, 8];
/// Steps between two looks at how well extrapolation and sweeps do.
const INTERVAL: u32 = 128;
/// Sweeps contract strongly if their bound is at most this.
const STRONG: f64 = 0.5;
/// What the bound is multiplied by, for it may grow until it is measured again.
const SAFETY: f64 = 2.0;
/// The most sweeps of a step: more, and Newton's iteration is faster.
const SWEEPS: u32 = 12;
/// An error this small, in units of epsilon, is roundoff.
const ROUNDOFF: f64 = 2.0;
/// Sweeps do not change less, in units of epsilon, if only for rounding.
const NOISE: f64 = 8.0;
/// The change of the last sweep, in units of epsilon: what is evaluated before it serves for the solution too.
const LAST_CHANGE: f64 = 256.0;

/// What is remembered of the solutions of earlier steps.
#[derive(Clone, Copy, Debug)]
pub struct Solver<T, U> {
    /// Where the earlier solutions point.
    guess: Apart<U>,
    /// Earlier solutions in a ring, each one twice, so that all are in a row wherever they begin; zeros where there were none.
    solutions: [U; 2 * DEPTH],
    /// The place of the oldest, which the next one will take.
    oldest: usize,
    /// How many there were, up to [`DEPTH`].
    count: usize,
    /// Steps until the next look.
    due: u32,
    /// Whether sweeps are to be made in all lanes.
    is_strong: bool,
    /// The coefficients of the extrapolation, the oldest solution's first.
    weights: [T; DEPTH],
    /// How much a sweep may change, in units of the unknown, to be the last one; negative if sweeps are not to be made.
    slack: T,
    /// What such a change means for the residual, relative to the equation's terms.
    residual: T,
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

/// Remembers nothing.
impl<T: Batch, U: Components<T>> Default for Solver<T, U> {
    fn default() -> Self {
        let nothing = U::from_fn(|_| T::of(0.0));
        Self {
            guess: Apart([nothing; 2]),
            solutions: [nothing; 2 * DEPTH],
            oldest: 0,
            count: 0,
            due: 0,
            is_strong: false,
            weights: weights(1),
            slack: T::of(-1.0),
            residual: T::of(0.0),
        }
    }
}

impl<T: Batch, U: Components<T>> Solver<T, U> {
    /// Solves a step's equation as most are solved, from where the earlier solutions point, by sweeps. None if these do not solve it in all
    /// lanes.
    #[inline(always)]
    pub fn by_sweeps<K>(&self, kernel: &K, state: &K::State, step: &K::Step) -> Option<SolutionOf<T, K>>
    where
        K: Kernel<T, Unknown = U>,
    {
        let guess = self.guess.together();
        if guess.as_ref().is_empty() {
            let evaluation = kernel.evaluate(state, step, &guess);
            let (iterations, unsolved) = (T::each(|_| 0), T::Mask::splat(false));
            return Some(Solution { unknown: guess, evaluation, iterations, residual: T::of(0.0), unsolved });
        }
        if self.due == 0 || !self.is_strong {
            return None;
        }
        let (_, solution) = self.sweeps::<K, true>(kernel, state, step, &guess, T::Mask::splat(true))?;
        (!solution.unsolved.any()).then_some(solution)
    }

    /// Solves a step's equation by whatever it takes. If the state is `known`, the one that the last step led to, the search starts where the
    /// earlier solutions point.
    #[inline(always)]
    pub fn solve<K>(&mut self, kernel: &K, state: &K::State, step: &K::Step, known: bool) -> SolutionOf<T, K>
    where
        K: Kernel<T, Unknown = U>,
    {
        let guess = self.guess.together();
        if guess.as_ref().is_empty() {
            return newton::solve(kernel, state, step, &guess, T::Mask::splat(false));
        }
        if !known {
            *self = Self::default();
        }
        let guess = if self.count == 0 { kernel.start(state, step) } else { guess };
        let strong = T::of(0.0).below(self.slack);
        let swept =
            if strong.any() { self.sweeps::<K, false>(kernel, state, step, &guess, strong) } else { None };
        let solution = match swept {
            Some((_, swept)) if !swept.unsolved.any() => swept,
            Some((point, swept)) => {
                let left = swept.unsolved;
                // where sweeps do not do what they should they are not made again before the next look
                self.slack = T::select(left, T::of(-1.0), self.slack);
                self.is_strong = false;
                let solved = self.newton(kernel, state, step, &select(left, &guess, &point), left);
                Solution {
                    unknown: select(left, &solved.unknown, &swept.unknown),
                    evaluation: solved.evaluation,
                    iterations: newton::sum::<T>(swept.iterations, solved.iterations),
                    residual: T::select(left, solved.residual, swept.residual),
                    unsolved: solved.unsolved,
                }
            }
            None => self.newton(kernel, state, step, &guess, T::Mask::splat(true)),
        };
        if self.due == 0 {
            self.look(kernel, state, step, &solution.unknown);
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
        if self.count > 1 && solution.unsolved.any() {
            // the course was not as smooth as that
            let left = solution.unsolved;
            let start = select(left, &self.latest(), &solution.unknown);
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
    /// equation is not one for sweeps. What is rare is not compiled in line.
    #[inline(always)]
    fn sweeps<K, const IN_LINE: bool>(
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
        let mut point = *guess;
        let mut iterations = T::each(|_| 1);
        let mut sweeps = 1;
        loop {
            let evaluation = if IN_LINE {
                kernel.evaluate(state, step, &point)
            } else {
                newton::evaluated(kernel, state, step, &point)
            };
            let unknown = kernel.sweep(state, step, &evaluation.right)?;
            let (change, size) = distance(&point, &unknown);
            let open = wanted & !change.at_most(self.slack * size);
            if !open.any() || sweeps == SWEEPS {
                let (residual, unsolved) = (self.residual, open | !wanted);
                return Some((point, Solution { unknown, evaluation, iterations, residual, unsolved }));
            }
            // solved lanes wait: the same again gives the same
            point = select(open, &unknown, &point);
            iterations = T::each(|lane| iterations.as_ref()[lane] + u32::from(open.lane(lane)));
            sweeps += 1;
        }
    }

    /// The earlier solutions, the oldest first.
    #[inline(always)]
    fn window(&self) -> &[U] {
        // below DEPTH, which the compiler then knows too
        let oldest = self.oldest % DEPTH;
        &self.solutions[oldest..oldest + DEPTH]
    }

    /// Where the solutions point, from the oldest in a window of [`DEPTH`] to the `latest` at its end: the polynomial through them, one
    /// step on.
    #[inline(always)]
    fn extrapolated(weights: &[T; DEPTH], window: &[U], latest: &U) -> U {
        // two sums, for each has to wait for itself; and the latest on top, for the step has only just brought it
        const MIDDLE: usize = DEPTH / 2;
        let mut sum = *latest;
        for (i, sum) in sum.as_mut().iter_mut().enumerate() {
            let mut older = weights[0] * window[0].as_ref()[i];
            let mut newer = weights[MIDDLE] * window[MIDDLE].as_ref()[i];
            for j in 1..MIDDLE {
                older = older.plus(weights[j], window[j].as_ref()[i]);
            }
            for j in MIDDLE + 1..DEPTH - 1 {
                newer = newer.plus(weights[j], window[j].as_ref()[i]);
            }
            *sum = (older + newer).plus(weights[DEPTH - 1], *sum);
        }
        sum
    }

    /// The latest solution.
    pub(crate) fn latest(&self) -> U {
        self.window()[DEPTH - 1]
    }

    /// Remembers the solution of a step that [`solve`](Self::solve) solved.
    #[inline(always)]
    pub fn push(&mut self, unknown: &U) {
        self.push_usual(unknown);
        self.count = (self.count + 1).min(DEPTH);
    }

    /// Remembers the solution of a step that [`by_sweeps`](Self::by_sweeps) solved, and forgets the oldest.
    #[inline(always)]
    pub fn push_usual(&mut self, unknown: &U) {
        let oldest = self.oldest % DEPTH;
        // in the window that begins one later
        let window = &self.solutions[oldest + 1..=oldest + DEPTH];
        self.guess.put(&Self::extrapolated(&self.weights, window, unknown));
        self.solutions[oldest] = *unknown;
        self.solutions[oldest + DEPTH] = *unknown;
        self.oldest = oldest + 1;
        self.due = self.due.saturating_sub(1);
    }

    /// Forgets all.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Sees how many earlier solutions would have pointed best at this one, and how strongly sweeps contract there.
    #[inline(always)]
    fn look<K>(&mut self, kernel: &K, state: &K::State, step: &K::Step, solution: &U)
    where
        K: Kernel<T, Unknown = U>,
    {
        self.due = if self.count < DEPTH { 0 } else { INTERVAL };
        // with one solution there is nothing to choose, and with none the first will be the latest
        self.weights = weights(1);
        let mut least = T::of(0.0);
        for depth in DEPTHS.into_iter().filter(|&depth| depth <= self.count) {
            let candidate = weights(depth);
            let guess = Self::extrapolated(&candidate, self.window(), &self.latest());
            let (error, _) = distance(&guess, solution);
            let better = error.below(least) | T::Mask::splat(depth == 1);
            least = T::select(better, error, least);
            self.weights = core::array::from_fn(|j| T::select(better, candidate[j], self.weights[j]));
        }
        let contraction = contraction(kernel, state, step, solution);
        let bound = T::of(SAFETY) * contraction.unwrap_or(T::of(1.0));
        let strong = bound.at_most(T::of(STRONG));
        // an error of ROUNDOFF where the bound says so
        let slack = T::of(ROUNDOFF * T::EPSILON) / (bound + T::of(TINY));
        let most = T::of(LAST_CHANGE * T::EPSILON);
        let least = T::of(NOISE * T::EPSILON);
        let slack = T::select(slack.at_most(most), slack, most);
        let slack = T::select(slack.at_most(least), least, slack);
        self.slack = T::select(strong, slack, T::of(-1.0));
        self.residual = T::select(strong, bound * slack, T::of(0.0));
        self.is_strong = strong.all();
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        let mut numbers = [self.oldest, self.count, self.due as usize].map(|number| T::of(number as f64));
        visit(&mut numbers);
        // the same in all lanes
        let [oldest, count, due] = numbers.map(|number| number.lane(0).to_f64());
        (self.oldest, self.count, self.due) = (oldest as usize, (count as usize).min(DEPTH), due as u32);
        visit(core::slice::from_mut(&mut self.slack));
        visit(core::slice::from_mut(&mut self.residual));
        visit(&mut self.weights);
        self.solutions.iter_mut().for_each(|solution| visit(solution.as_mut()));
        self.is_strong = T::of(0.0).below(self.slack).all();
        let guess = Self::extrapolated(&self.weights, self.window(), &self.latest());
        self.guess.put(&guess);
    }
}

/// Nothing next to any unknown, and yet no zero.
const TINY: f64 = 1e-37;

/// The coefficients of the polynomial through the last `depth` values, one step on: `(−1)^{a−1} (depth over a)` for the value `a` steps ago.
const WEIGHTS: [[f64; DEPTH]; DEPTH] = {
    let mut weights = [[0.0; DEPTH]; DEPTH];
    let mut depth = 1;
    while depth <= DEPTH {
        let (mut a, mut binomial) = (1, 1);
        while a <= depth {
            binomial = binomial * (depth + 1 - a) / a;
            weights[depth - 1][DEPTH - a] = if a % 2 == 1 { binomial as f64 } else { -(binomial as f64) };
            a += 1;
        }
        depth += 1;
    }
    weights
};

/// [`WEIGHTS`] for a depth of 1 to [`DEPTH`].
fn weights<T: Scalar>(depth: usize) -> [T; DEPTH] {
    WEIGHTS[(depth - 1) % DEPTH].map(T::of)
}

/// The norm of the derivative of the sweep, by differences; none if there are no sweeps. The norm is that of [`distance`]: the largest sum
/// of a column. Not a number if any component is.
#[inline(always)]
fn contraction<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    unknown: &K::Unknown,
) -> Option<T> {
    let sweep = |x: &K::Unknown| kernel.sweep(state, step, &newton::evaluated(kernel, state, step, x).right);
    let here = sweep(unknown)?;
    let size = size(unknown.as_ref());
    // at rest: as far as a thousandth of a radian
    let moves = T::of(0.0).below(size);
    let offset = T::of(1e-3) * T::select(moves, size, T::of(1.0));
    let mut largest = T::of(0.0);
    for i in 0..unknown.as_ref().len() {
        let mut there = *unknown;
        there.as_mut()[i] = there.as_ref()[i] + offset;
        let (change, _) = distance(&here, &sweep(&there)?);
        let column = change / offset;
        let smaller = column.at_most(largest) | !largest.at_most(largest);
        largest = T::select(smaller, largest, column);
    }
    Some(largest)
}

/// The distance between two unknowns and the size of the second, as sums of magnitudes; not-a-number if any component is.
#[inline(always)]
fn distance<T: Batch, U: Components<T>>(a: &U, b: &U) -> (T, T) {
    let mut sums = (T::of(0.0), T::of(0.0));
    for (a, b) in a.as_ref().iter().zip(b.as_ref()) {
        sums = (sums.0 + (*a - *b).abs(), sums.1 + b.abs());
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_continue_polynomials() {
        for depth in DEPTHS {
            let weights: [f64; DEPTH] = weights(depth);
            for degree in 0..depth as i32 {
                // values at −8, …, −1, continued to 0
                let sum: f64 = weights.iter().zip(-8..0).map(|(w, t)| w * f64::from(t).powi(degree)).sum();
                let exact = if degree == 0 { 1.0 } else { 0.0 };
                assert!((sum - exact).abs() < 1e-9 * 8_f64.powi(degree), "{depth} {degree}: {sum}");
            }
        }
    }

    #[test]
    fn the_window_moves_and_forgets() {
        let mut solver = Solver::<f64, [f64; 1]>::default();
        for k in 0..40 {
            assert_eq!(solver.count, k.min(DEPTH));
            solver.push(&[k as f64]);
            assert_eq!(solver.guess.together(), [k as f64]);
            assert_eq!(solver.latest(), [k as f64]);
        }
        solver.weights = weights(8);
        solver.push(&[40.0]);
        assert_eq!(solver.guess.together(), [41.0]);
        let before = solver;
        solver.memory(&mut |_| ());
        assert_eq!(solver.guess.together(), before.guess.together());
    }
}
