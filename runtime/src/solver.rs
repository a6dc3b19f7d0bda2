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

use crate::kernel::{Components, Kernel};
use crate::newton::{self, Solution, SolutionOf, select, size};
use crate::scalar::{Batch, Mask, Real, Scalar, Work};

/// The most earlier solutions that the next one is extrapolated from.
const WINDOW: usize = 12;
/// How many are kept: the next power of two, so that places are found by a mask.
const KEPT: usize = WINDOW.next_power_of_two();
/// So many of the most recent ones do for most systems.
const RECENT: usize = 8;
/// The polynomials that are tried: through how many of the solutions, or as near to them as can be, and of what degree.
const FITS: [(usize, usize); 7] = [(1, 0), (2, 1), (3, 2), (4, 3), (6, 5), (RECENT, 7), (WINDOW, 9)];
/// Steps between two looks at how well extrapolation and sweeps do: at first, and in the long run.
const INTERVALS: [u32; 2] = [128, 1024];
/// How often between two such looks sweeps may fail to do what they should, each time with a look of its own.
const PATIENCE: f64 = 3.0;
/// By how much the square of an error is to be smaller than a change that may be the last, for it may grow until it is looked at again.
const MARGIN: f64 = 25.0;
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
    /// Earlier solutions in a ring, each one twice, so that all are in a row wherever they begin; zeros where there were none.
    solutions: [U; 2 * KEPT],
    /// The place of the oldest, which the next one will take.
    oldest: usize,
    /// How many there were, up to [`WINDOW`].
    count: usize,
    /// Steps until the next look.
    due: u32,
    /// Steps from the next look to the one after it.
    interval: u32,
    /// Whether sweeps are to be made in all lanes.
    is_strong: bool,
    /// The coefficients of the extrapolation, the oldest solution's first.
    weights: [T; WINDOW],
    /// Whether those of solutions that are not recent are nothing.
    is_short: bool,
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
        Self { more: T::each(|_| 0), most: T::each(|_| 1) }
    }

    fn count(&mut self, iterations: &T::Each<u32>) {
        let counts = self.more.as_mut().iter_mut().zip(self.most.as_mut());
        for ((more, most), iterations) in counts.zip(iterations.as_ref()) {
            *more += u64::from(*iterations - 1);
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

/// Remembers nothing.
impl<T: Batch, U: Components<T>> Default for Solver<T, U> {
    fn default() -> Self {
        let nothing = U::from_fn(|_| T::of(0.0));
        Self {
            guess: Apart([nothing; 2]),
            solutions: [nothing; 2 * KEPT],
            oldest: 0,
            count: 0,
            due: 0,
            interval: INTERVALS[0],
            is_strong: false,
            weights: weights(0),
            is_short: true,
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

    /// Whether there is nothing to solve for.
    #[inline(always)]
    pub(crate) fn is_idle(&self) -> bool {
        self.guess.0[0].as_ref().is_empty()
    }

    /// Whether the next step is one like most: to be solved by sweeps, without a look.
    #[inline(always)]
    pub fn is_settled(&self) -> bool {
        self.is_idle() || self.due != 0 && self.is_strong
    }

    /// Solves a step's equation as most are solved, from where the earlier solutions point, by sweeps. None if these do not solve it in all
    /// lanes.
    ///
    /// After a solution the guess is the next step's: [`push_usual`](Self::push_usual) it, or [`aim`](Self::aim) anew.
    #[inline(always)]
    pub fn by_sweeps<K>(&mut self, kernel: &K, state: &K::State, step: &K::Step) -> Option<SolutionOf<T, K>>
    where
        K: Kernel<T, Unknown = U>,
    {
        let guess = self.guess.together();
        if guess.as_ref().is_empty() {
            let evaluation = kernel.evaluate(state, step, &guess);
            let (iterations, unsolved) = (T::each(|_| 0), T::Mask::splat(false));
            return Some(Solution { unknown: guess, evaluation, iterations, residual: T::of(0.0), unsolved });
        }
        // The order is that in which the processor, which does not see far ahead, is to go: what the next guess takes from the solutions
        // that there are while this one is waited for, and the next guess before what follows from this solution, for the next step waits
        // for it.
        // the window begins one later then
        let next = self.oldest % KEPT + KEPT - WINDOW + 1;
        let earlier = earlier(&self.weights, &self.solutions[next..next + WINDOW - 1], self.is_short);
        let mut point = guess;
        let mut iterations = T::each(|_| 1);
        let mut sweeps = 1;
        loop {
            let evaluation = kernel.evaluate(state, step, &point);
            let unknown = kernel.sweep(state, step, &evaluation.right)?;
            self.guess.put(&continued(&self.weights, &earlier, &unknown));
            let open = !squared_distance(&point, &unknown).at_most(self.tolerance);
            if !open.any() {
                let (residual, unsolved) = (self.residual, T::Mask::splat(false));
                if sweeps > 1 {
                    self.effort.count(&iterations);
                }
                return Some(Solution { unknown, evaluation, iterations, residual, unsolved });
            }
            if sweeps == SWEEPS {
                self.aim();
                return None;
            }
            // solved lanes wait: the same again gives the same
            point = select(open, &unknown, &point);
            iterations = T::each(|lane| iterations.as_ref()[lane] + u32::from(open.lane(lane)));
            sweeps += 1;
        }
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
        let mut wanting = T::Mask::splat(self.due == 0);
        if self.due == 0 {
            self.failures = T::of(0.0);
        }
        let strong = T::of(0.0).below(self.tolerance);
        let swept = if strong.any() { self.sweeps(kernel, state, step, &guess, strong) } else { None };
        let solution = match swept {
            Some((_, swept)) if !swept.unsolved.any() => swept,
            Some((point, swept)) => {
                let left = swept.unsolved;
                // where sweeps do not do what they should there has to be a look, and if it does not help, Newton's iteration until the next
                let failed = left & strong;
                self.failures = T::select(failed, self.failures + T::of(1.0), self.failures);
                let hopeful = self.failures.at_most(T::of(PATIENCE));
                wanting = wanting | (failed & hopeful);
                self.tolerance = T::select(failed & !hopeful, T::of(-1.0), self.tolerance);
                self.is_strong = T::of(0.0).below(self.tolerance).all();
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
        if wanting.any() {
            self.look(kernel, state, step, &solution.unknown, wanting);
        }
        if self.due == 0 && self.count == WINDOW {
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
        let mut point = *guess;
        let mut iterations = T::each(|_| 1);
        let mut sweeps = 1;
        loop {
            let evaluation = newton::evaluated(kernel, state, step, &point);
            let unknown = kernel.sweep(state, step, &evaluation.right)?;
            let open = wanted & !squared_distance(&point, &unknown).at_most(self.tolerance);
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
        // below KEPT, which the compiler then knows too
        let oldest = self.oldest % KEPT;
        &self.solutions[oldest + KEPT - WINDOW..oldest + KEPT]
    }

    /// The latest solution.
    pub(crate) fn latest(&self) -> U {
        self.window()[WINDOW - 1]
    }

    /// Remembers the solution of a step that [`solve`](Self::solve) solved.
    #[inline(always)]
    pub fn push(&mut self, unknown: &U) {
        self.push_usual(unknown);
        self.count = (self.count + 1).min(WINDOW);
        self.aim();
    }

    /// Remembers the solution of a step that [`by_sweeps`](Self::by_sweeps) solved, and forgets the oldest.
    #[inline(always)]
    pub fn push_usual(&mut self, unknown: &U) {
        let oldest = self.oldest % KEPT;
        T::keep(&mut self.solutions[oldest], unknown);
        T::keep(&mut self.solutions[oldest + KEPT], unknown);
        self.oldest = oldest + 1;
        self.due = self.due.saturating_sub(1);
    }

    /// Sets the guess to where the solutions point.
    #[inline(always)]
    pub fn aim(&mut self) {
        T::outline(Aim(self));
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
        let contraction = contraction(kernel, state, step, solution);
        let bound = T::of(SAFETY) * contraction.unwrap_or(T::of(1.0));
        let per_bound = T::of(1.0) / (bound + T::of(TINY));
        // the error that is left
        let error = T::of(NO_DIFFERENCE) * per_bound;
        let [least, most] = ROUNDOFF.map(T::of);
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
        // with one solution there is nothing to choose, and with none the first will be the latest
        let mut best = weights(0);
        let mut least = T::of(0.0);
        for (fit, (points, _)) in
            FITS.into_iter().enumerate().filter(|(_, (points, _))| *points <= self.count)
        {
            let candidate = weights(fit);
            let guess = extrapolated(&candidate, self.window(), points <= RECENT);
            let error = squared_distance(&guess, solution);
            let better = error.below(least) | T::Mask::splat(fit == 0);
            // more than the recent ones only where these do not do
            let better =
                better & (T::Mask::splat(points <= RECENT) | !(T::of(MARGIN) * least).at_most(tolerance));
            least = T::select(better, error, least);
            best = core::array::from_fn(|j| T::select(better, candidate[j], best[j]));
        }
        self.weights = core::array::from_fn(|j| T::select(wanting, best[j], self.weights[j]));
        self.is_short = is_short(&self.weights);
        self.residual = T::select(wanting, T::select(strong, bound * slack, T::of(0.0)), self.residual);
        self.is_strong = T::of(0.0).below(self.tolerance).all();
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        let numbers = [self.oldest, self.count, self.due as usize, self.interval as usize];
        let mut numbers = numbers.map(|number| T::of(number as f64));
        visit(&mut numbers);
        // the same in all lanes
        let [oldest, count, due, interval] = numbers.map(|number| number.lane(0).to_f64());
        (self.oldest, self.count) = (oldest as usize, (count as usize).min(WINDOW));
        (self.due, self.interval) = (due as u32, interval as u32);
        visit(core::slice::from_mut(&mut self.tolerance));
        visit(core::slice::from_mut(&mut self.residual));
        visit(core::slice::from_mut(&mut self.failures));
        visit(&mut self.weights);
        self.solutions.iter_mut().for_each(|solution| visit(solution.as_mut()));
        self.is_strong = T::of(0.0).below(self.tolerance).all();
        self.is_short = is_short(&self.weights);
        self.aim();
    }
}

/// Whether all but the recent solutions have no weight, in any lane.
fn is_short<T: Batch>(weights: &[T; WINDOW]) -> bool {
    weights[..WINDOW - RECENT].iter().all(|weight| Batch::abs(*weight).at_most(T::of(0.0)).all())
}

/// Sets the guess to where the solutions point.
struct Aim<'a, T: Batch, U>(&'a mut Solver<T, U>);

impl<T: Batch, U: Components<T>> Work for Aim<'_, T, U> {
    type Result = ();

    #[inline(always)]
    fn done(self) {
        let guess = extrapolated(&self.0.weights, self.0.window(), self.0.is_short);
        self.0.guess.put(&guess);
    }
}

/// Where the solutions point, the oldest first: the polynomial through them, one step on.
#[inline(always)]
fn extrapolated<T: Batch, U: Components<T>>(weights: &[T; WINDOW], window: &[U], is_short: bool) -> U {
    continued(weights, &earlier(weights, window, is_short), &window[WINDOW - 1])
}

/// What all solutions but the latest contribute to it.
#[inline(always)]
fn earlier<T: Batch, U: Components<T>>(weights: &[T; WINDOW], window: &[U], is_short: bool) -> U {
    // two sums, for each has to wait for itself
    const RECENTLY: usize = WINDOW - RECENT;
    const MIDDLE: usize = RECENTLY + RECENT / 2;
    let mut sum = T::combined(
        &weights[RECENTLY..MIDDLE],
        &window[RECENTLY..MIDDLE],
        &weights[MIDDLE..WINDOW - 1],
        &window[MIDDLE..WINDOW - 1],
    );
    if !is_short {
        const HALF: usize = RECENTLY / 2;
        let long_ago =
            T::combined(&weights[..HALF], &window[..HALF], &weights[HALF..RECENTLY], &window[HALF..RECENTLY]);
        for (sum, long_ago) in sum.as_mut().iter_mut().zip(long_ago.as_ref()) {
            *sum = *sum + *long_ago;
        }
    }
    sum
}

/// The same with the latest.
#[inline(always)]
fn continued<T: Scalar, U: Components<T>>(weights: &[T; WINDOW], earlier: &U, latest: &U) -> U {
    let mut sum = *earlier;
    for (sum, latest) in sum.as_mut().iter_mut().zip(latest.as_ref()) {
        *sum = sum.plus(weights[WINDOW - 1], *latest);
    }
    sum
}

/// Nothing next to any unknown, and yet no zero.
const TINY: f64 = 1e-37;

/// The coefficients that the [`FITS`] give to the solutions, the oldest first.
const WEIGHTS: [[f64; WINDOW]; FITS.len()] = {
    let mut weights = [[0.0; WINDOW]; FITS.len()];
    let mut fit = 0;
    while fit < FITS.len() {
        let (points, degree) = FITS[fit];
        let mut place = 0;
        while place < points {
            weights[fit][WINDOW - points + place] = weight(points as i128, degree as i128, place as i128);
            place += 1;
        }
        fit += 1;
    }
    weights
};

/// The coefficient of the value at `x`, of those at `0, …, n − 1`, in the value at `n` of the polynomial of this degree that is nearest to them
/// all: `Σ_k t_k(n) t_k(x) / Σ_y t_k(y)²` with the discrete Chebyshev polynomials `t_k`, which are orthogonal on these places. Exact, but for
/// the last division.
const fn weight(n: i128, degree: i128, x: i128) -> f64 {
    let (mut numerator, mut denominator) = (0, 1);
    // t_{k−1} and t_k, there and here, and Σ t_k² = n (n² − 1) … (n² − k²) / (2k + 1), times 2k + 1
    let (mut before, mut now) = ([0, 0], [1, 1]);
    let mut square = n;
    let mut k = 0;
    loop {
        let (mut above, mut below) = (now[0] * now[1] * (2 * k + 1), square);
        let shared = gcd(above, below);
        (above, below) = (above / shared, below / shared);
        let shared = gcd(denominator, below);
        numerator = numerator * (below / shared) + above * (denominator / shared);
        denominator = denominator / shared * below;
        let shared = gcd(numerator, denominator);
        (numerator, denominator) = (numerator / shared, denominator / shared);
        if k == degree {
            return numerator as f64 / denominator as f64;
        }
        // (k + 1) t_{k+1}(y) = (2k + 1)(2y − n + 1) t_k(y) − k (n² − k²) t_{k−1}(y)
        let there = (2 * k + 1) * (n + 1) * now[0] - k * (n * n - k * k) * before[0];
        let here = (2 * k + 1) * (2 * x - n + 1) * now[1] - k * (n * n - k * k) * before[1];
        before = now;
        now = [there / (k + 1), here / (k + 1)];
        k += 1;
        square *= n * n - k * k;
    }
}

/// The greatest common divisor; 1 if both are zero.
const fn gcd(a: i128, b: i128) -> i128 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    if a == 0 { 1 } else { a }
}

/// The coefficients of one of the [`FITS`].
fn weights<T: Scalar>(fit: usize) -> [T; WINDOW] {
    WEIGHTS[fit % FITS.len()].map(T::of)
}

/// The norm of the derivative of the sweep, by differences: the root of the sum of all entries' squares, which bounds how much longer the
/// sweep makes any change. None if there are no sweeps; not a number if any component is.
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

/// The sum of the squares of the components; not-a-number if any component is. Most kernels compute it too, in this order, and the compiler
/// makes one of both.
#[inline(always)]
fn square<T: Scalar, U: Components<T>>(x: &U) -> T {
    // no closures, which would not be compiled for the processor that the caller is compiled for
    let [first, rest @ ..] = x.as_ref() else { return T::of(0.0) };
    let mut sum = *first * *first;
    for x in rest {
        sum = sum.plus(*x, *x);
    }
    sum
}

/// The square of the distance between two unknowns; not-a-number if any component is.
#[inline(always)]
fn squared_distance<T: Scalar, U: Components<T>>(a: &U, b: &U) -> T {
    let mut difference = *a;
    for (a, b) in difference.as_mut().iter_mut().zip(b.as_ref()) {
        *a = *a - *b;
    }
    square(&difference)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_continue_polynomials() {
        for (fit, (points, degree)) in FITS.into_iter().enumerate() {
            let weights: [f64; WINDOW] = weights(fit);
            assert!(weights[..WINDOW - points].iter().all(|weight| *weight == 0.0));
            for power in 0..=degree as i32 {
                // values at −11, …, −1, continued to 0
                let times = -(WINDOW as i32)..0;
                let sum: f64 = weights.iter().zip(times).map(|(w, t)| w * f64::from(t).powi(power)).sum();
                let exact = if power == 0 { 1.0 } else { 0.0 };
                let size = f64::from(points as u32).powi(power);
                assert!((sum - exact).abs() < 1e-12 * size, "{points} {degree} {power}: {sum}");
            }
        }
        // through as many points as there are coefficients
        let exact: [f64; WINDOW] = weights(5);
        assert_eq!(exact[WINDOW - 8..], [-1.0, 8.0, -28.0, 56.0, -70.0, 56.0, -28.0, 8.0]);
        // nearest to more of them: roundings count for less than with as many as the degree asks for
        let size = |weights: [f64; WINDOW]| weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
        assert!(size(weights(6)) < size(exact) && size(weights(6)) > 90.0);
    }

    #[test]
    fn the_window_moves_and_forgets() {
        let mut solver = Solver::<f64, [f64; 1]>::default();
        for k in 0..40 {
            assert_eq!(solver.count, k.min(WINDOW));
            solver.push(&[k as f64]);
            assert_eq!(solver.guess.together(), [k as f64]);
            assert_eq!(solver.latest(), [k as f64]);
        }
        for (fit, (points, degree)) in FITS.into_iter().enumerate().skip(1) {
            solver.weights = weights(fit);
            solver.is_short = is_short(&solver.weights);
            assert_eq!(solver.is_short, points <= RECENT);
            let next = 40.0 + fit as f64;
            solver.push(&[next - 1.0]);
            let [guess] = solver.guess.together();
            assert!((guess - next).abs() < 1e-10, "{points} {degree}: {guess}");
            let before = solver;
            solver.memory(&mut |_| ());
            assert_eq!(solver.guess.together(), before.guess.together());
        }
    }
}
