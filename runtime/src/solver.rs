//! Solves the equations of successive steps: each from where the earlier solutions point, by fixed-point sweeps where these contract
//! strongly, else by Newton's iteration.
//!
//! Successive solutions are samples of a smooth course, so that the next one is known to many digits before anything is solved. The sweep
//! `x ← L⁻¹ right(x)` of an equation `L x = right(x)` takes off the factor by which it contracts, about the angle turned in a step; one or two
//! of them bring what is left below rounding. Whether they did is checked at every step: the change that a sweep makes, times a bound for the
//! contraction, bounds the error after it. The bound is measured, along all unknowns, at the start and every 64 steps; where it is not
//! small, or sweeps do not do what they should, Newton's iteration takes over.

use crate::kernel::{Components, Kernel};
use crate::newton::{self, Solution, SolutionOf, select, size};
use crate::scalar::{Batch, Mask, Real, Scalar};

/// The most earlier solutions that the next one is extrapolated from.
const DEPTH: usize = 8;
/// The numbers of earlier solutions that are tried.
const DEPTHS: [usize; 6] = [1, 2, 3, 4, 6, 8];
/// Steps between two looks at how well extrapolation and sweeps do.
const INTERVAL: u32 = 64;
/// Sweeps contract strongly if their bound is at most this.
const STRONG: f64 = 0.1;
/// What the bound is multiplied by, for it may grow until it is measured again.
const SAFETY: f64 = 2.0;
/// The most sweeps of a step.
const SWEEPS: u32 = 6;
/// Those after which it is no longer a step like the others.
const FEW: u32 = 2;
/// An error this small, in units of epsilon, is roundoff.
const ROUNDOFF: f64 = 2.0;
/// The change of the last sweep, in units of epsilon: what is evaluated before it serves for the solution too.
const LAST_CHANGE: f64 = 256.0;

/// What is remembered of the solutions of earlier steps.
#[derive(Clone, Copy, Debug)]
pub struct Solver<T, U> {
    /// Earlier solutions, the oldest first: those from `first` on, [`DEPTH`] of them, zeros where there were none.
    solutions: [U; 2 * DEPTH],
    first: usize,
    /// How many there were, up to [`DEPTH`].
    count: usize,
    /// Steps until the next look.
    due: u32,
    /// The coefficients of the extrapolation, in the same order.
    weights: [T; DEPTH],
    /// A bound for the contraction of sweeps.
    contraction: T,
    /// How much a sweep may change, in units of the unknown, to be the last one; negative if sweeps are not to be made.
    slack: T,
}

/// Remembers nothing.
impl<T: Batch, U: Components<T>> Default for Solver<T, U> {
    fn default() -> Self {
        let zero = T::of(0.0);
        Self {
            solutions: [U::from_fn(|_| zero); 2 * DEPTH],
            first: 0,
            count: 0,
            due: 0,
            weights: weights(1),
            contraction: T::of(1.0),
            slack: T::of(-1.0),
        }
    }
}

impl<T: Batch, U: Components<T>> Solver<T, U> {
    /// Solves a step's equation as most are solved, from where the earlier solutions point, by a few sweeps. None if these do not solve it
    /// in all lanes.
    #[inline(always)]
    pub fn few_sweeps<K>(&self, kernel: &K, state: &K::State, step: &K::Step) -> Option<SolutionOf<T, K>>
    where
        K: Kernel<T, Unknown = U>,
    {
        if self.solutions[0].as_ref().is_empty() {
            let unknown = self.solutions[0];
            let evaluation = kernel.evaluate(state, step, &unknown);
            let unsolved = T::Mask::splat(false);
            return Some(Solution { unknown, evaluation, iterations: 0, residual: T::of(0.0), unsolved });
        }
        if self.due == 0 || !self.is_strong().all() {
            return None;
        }
        let mut point = self.extrapolated(&self.weights);
        for iterations in 1..=FEW {
            let evaluation = kernel.evaluate(state, step, &point);
            let unknown = kernel.sweep(state, step, &evaluation.right)?;
            let (change, size) = distance(&point, &unknown);
            let solved = change.at_most(self.slack * size);
            if solved.all() {
                let residual = self.contraction * change / (size + T::of(TINY));
                return Some(Solution { unknown, evaluation, iterations, residual, unsolved: !solved });
            }
            // solved lanes wait: the same again gives the same
            point = select(solved, &point, &unknown);
        }
        None
    }

    /// Solves a step's equation by whatever it takes. If the state is `known`, the one that the last step led to, the search starts where the
    /// earlier solutions point.
    #[inline(always)]
    pub fn solve<K>(&mut self, kernel: &K, state: &K::State, step: &K::Step, known: bool) -> SolutionOf<T, K>
    where
        K: Kernel<T, Unknown = U>,
    {
        if self.solutions[0].as_ref().is_empty() {
            return newton::solve(kernel, state, step, &self.solutions[0], T::Mask::splat(false));
        }
        if !known {
            *self = Self::default();
        }
        let guess =
            if self.count == 0 { kernel.start(state, step) } else { self.extrapolated(&self.weights) };
        let strong = self.is_strong();
        let swept = if strong.any() { self.sweeps(kernel, state, step, &guess, strong) } else { None };
        let solution = match swept {
            Some((_, swept)) if !swept.unsolved.any() => swept,
            Some((point, swept)) => {
                let left = swept.unsolved;
                // where sweeps do not do what they should they are not made again before the next look
                self.slack = T::select(left, T::of(-1.0), self.slack);
                let solved = self.newton(kernel, state, step, &select(left, &guess, &point), left);
                Solution {
                    unknown: select(left, &solved.unknown, &swept.unknown),
                    evaluation: solved.evaluation,
                    iterations: swept.iterations + solved.iterations,
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

    /// Whether sweeps contract strongly.
    #[inline(always)]
    fn is_strong(&self) -> T::Mask {
        T::of(0.0).below(self.slack)
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
                iterations: solution.iterations + again.iterations,
                residual: T::select(left, again.residual, solution.residual),
                ..again
            };
        }
        solution
    }

    /// Sweeps until the change is small enough in the `wanted` lanes. Returns where the equation was evaluated the last time, too.
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
        let mut point = *guess;
        let mut iterations = 0;
        loop {
            iterations += 1;
            let evaluation = newton::evaluated(kernel, state, step, &point);
            let unknown = kernel.sweep(state, step, &evaluation.right)?;
            let (change, size) = distance(&point, &unknown);
            let solved = change.at_most(self.slack * size);
            if (solved | !wanted).all() || iterations == SWEEPS {
                let residual = self.contraction * change / (size + T::of(TINY));
                let solution =
                    Solution { unknown, evaluation, iterations, residual, unsolved: !(solved & wanted) };
                return Some((point, solution));
            }
            // solved lanes wait: the same again gives the same
            point = select(wanted & !solved, &unknown, &point);
        }
    }

    /// Where the earlier solutions point: the polynomial through them, one step on.
    #[inline(always)]
    fn extrapolated(&self, weights: &[T; DEPTH]) -> U {
        // below DEPTH, which the compiler then knows too
        let first = self.first % DEPTH;
        let window = &self.solutions[first..first + DEPTH];
        // two sums, for each has to wait for itself; the latest comes last, for the step before has only just brought it
        let (mut older, mut newer) = (self.solutions[0], self.solutions[0]);
        for (i, (older, newer)) in older.as_mut().iter_mut().zip(newer.as_mut()).enumerate() {
            *older = weights[0] * window[0].as_ref()[i];
            *newer = weights[DEPTH / 2] * window[DEPTH / 2].as_ref()[i];
        }
        for j in 1..DEPTH / 2 {
            for (i, (older, newer)) in older.as_mut().iter_mut().zip(newer.as_mut()).enumerate() {
                *older = *older + weights[j] * window[j].as_ref()[i];
                *newer = *newer + weights[DEPTH / 2 + j] * window[DEPTH / 2 + j].as_ref()[i];
            }
        }
        for (older, newer) in older.as_mut().iter_mut().zip(newer.as_ref()) {
            *older = *older + *newer;
        }
        older
    }

    fn latest(&self) -> U {
        self.solutions[self.first % DEPTH + DEPTH - 1]
    }

    /// Remembers the solution of a step that [`solve`](Self::solve) solved.
    #[inline(always)]
    pub fn push(&mut self, unknown: U) {
        self.push_usual(unknown);
        self.count = (self.count + 1).min(DEPTH);
    }

    /// Remembers the solution of a step that [`few_sweeps`](Self::few_sweeps) solved, and forgets the oldest.
    #[inline(always)]
    pub fn push_usual(&mut self, unknown: U) {
        let first = self.first % DEPTH;
        self.solutions[first + DEPTH] = unknown;
        self.first = first + 1;
        if self.first == DEPTH {
            self.solutions.copy_within(DEPTH.., 0);
            self.first = 0;
        }
        self.due = self.due.saturating_sub(1);
    }

    /// Sees how many earlier solutions would have pointed best at this one, and how strongly sweeps contract there.
    #[inline(always)]
    fn look<K>(&mut self, kernel: &K, state: &K::State, step: &K::Step, solution: &U)
    where
        K: Kernel<T, Unknown = U>,
    {
        self.due = if self.count + 1 < DEPTH { 0 } else { INTERVAL };
        // with one solution there is nothing to choose, and with none the first will be the latest
        self.weights = weights(1);
        let mut least = T::of(0.0);
        for depth in DEPTHS.into_iter().filter(|&depth| depth <= self.count) {
            let candidate = weights(depth);
            let (error, _) = distance(&self.extrapolated(&candidate), solution);
            let better = error.below(least) | T::Mask::splat(depth == 1);
            least = T::select(better, error, least);
            self.weights = core::array::from_fn(|j| T::select(better, candidate[j], self.weights[j]));
        }
        let contraction = contraction(kernel, state, step, solution);
        let bound = T::of(SAFETY) * contraction.unwrap_or(T::of(1.0));
        let strong = bound.at_most(T::of(STRONG));
        self.contraction = T::select(strong, bound, T::of(1.0));
        // an error of ROUNDOFF where the bound says so
        let slack = T::of(ROUNDOFF * T::EPSILON) / (bound + T::of(TINY));
        let most = T::of(LAST_CHANGE * T::EPSILON);
        let slack = T::select(slack.at_most(most), slack, most);
        self.slack = T::select(strong, slack, T::of(-1.0));
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        let mut numbers = [self.first, self.count, self.due as usize].map(|number| T::of(number as f64));
        visit(&mut numbers);
        // the same in all lanes
        let [first, count, due] = numbers.map(|number| number.lane(0).to_f64());
        (self.first, self.count, self.due) = (first as usize, (count as usize).min(DEPTH), due as u32);
        visit(core::slice::from_mut(&mut self.contraction));
        visit(core::slice::from_mut(&mut self.slack));
        visit(&mut self.weights);
        self.solutions.iter_mut().for_each(|solution| visit(solution.as_mut()));
    }
}

/// Nothing next to any unknown, and yet no zero.
const TINY: f64 = 1e-37;

/// The coefficients of the polynomial through the last `depth` values, one step on: `(−1)^{a−1} (depth over a)` for the value `a` steps ago.
fn weights<T: Scalar>(depth: usize) -> [T; DEPTH] {
    let mut weights = [T::of(0.0); DEPTH];
    let mut binomial = 1.0;
    for (a, weight) in (1..=depth).zip(weights.iter_mut().rev()) {
        binomial *= (depth + 1 - a) as f64 / a as f64;
        *weight = T::of(if a % 2 == 1 { binomial } else { -binomial });
    }
    weights
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
            assert_eq!(solver.count, (k as usize).min(DEPTH));
            solver.push([f64::from(k)]);
            assert_eq!(solver.extrapolated(&weights(1)), [f64::from(k)]);
            assert_eq!(solver.latest(), [f64::from(k)]);
        }
        assert_eq!(solver.extrapolated(&weights(8)), [40.0]);
    }
}
