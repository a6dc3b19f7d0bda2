//! Where the solutions of earlier steps point.
//!
//! Successive solutions are samples of a smooth course: a polynomial through the last of them, or near to more of them, continued by one step,
//! is the next one to many digits. Of several polynomials that one is taken which would have pointed best at the latest solution.
//!
//! Let `x₀` be the next solution and `x₁`, `x₂`, … the earlier ones, the latest first. A polynomial through the latest of them gives
//! `x₀ = Σ_j w_j x_j`, and what rounding left in the solutions counts by as much as the `w_j` are large. They are smaller where the polynomial
//! only has to be near to more solutions. Of such we take those that are odd about the middle of sixteen steps, which have half as many
//! products:
//!
//! ```text
//! x₀ − x₁₆ = Σ_{j = 1}^{7} w_j (x_j − x_{16 − j})
//! ```
//!
//! Of polynomials in the distance from `x₈` this holds for all even powers, whatever `w` is. To hold up to the degree `2m` it has to hold for
//! the odd powers up to `2m − 1`, and of all `w` for which it does we take the least. They are larger than those of least squares, which need not be
//! odd, by less than a fifth.

use super::stopping::{change, select};
use super::terms::{Formula, Piece, Term, Weight, computed};
use crate::kernel::Components;
use crate::scalar::{Batch, Mask, Real, Scalar, Work};
use crate::simd::lanes::{Portable, Processor};

/// The most earlier solutions that the next one is extrapolated from.
pub(crate) const WINDOW: usize = 16;
/// How many are kept: the next power of two, so that places are found by a mask.
const KEPT: usize = WINDOW.next_power_of_two();
/// How many coefficients there are.
pub(super) const RECENT: usize = WINDOW / 2;
/// The polynomials that are tried. Those through the latest solutions: through how many.
const THROUGH: [usize; 6] = [1, 2, 3, 4, 6, RECENT];
/// Those near to all: of which degrees.
const NEAR: [usize; 3] = [6, 8, 10];
/// How many that makes.
const FITS: usize = THROUGH.len() + NEAR.len();
/// By how much an error is to be smaller than a change that may be the last, for it may grow until the next calibration.
const MARGIN: f64 = 4.0;
/// What is left of an error at the next calibration.
const LASTING: f64 = 0.5;

/// The last solutions, and how the next one follows from them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Predictor<T: Batch, U> {
    /// The solutions in a ring, each one twice, so that all are in a row wherever they begin; zeros where there were none.
    solutions: [Term<T, U>; 2 * KEPT],
    /// The place of the oldest, which the next one will take.
    oldest: usize,
    /// How many there were, up to [`WINDOW`].
    count: usize,
    /// Their coefficients, the latest solution's first.
    weights: [Weight<T>; RECENT],
    /// Where these are of a polynomial near to all.
    is_near: T::Mask,
    /// Whether they are so in all lanes, and in any: kept, so that not every step has to find out.
    near: [bool; 2],
    /// The polynomials' errors, those found at the latest calibration and what is left of earlier ones.
    errors: [T; FITS],
}

/// Knows no solution.
impl<T: Batch, U: Components<T>> Default for Predictor<T, U> {
    fn default() -> Self {
        let nothing = U::splat(T::of(0.0));
        Self {
            solutions: [Term::new(nothing); 2 * KEPT],
            oldest: 0,
            count: 0,
            weights: terms(&numbers(&THROUGH_ALL[0])),
            is_near: T::Mask::splat(false),
            near: [false; 2],
            errors: [T::of(0.0); FITS],
        }
    }
}

impl<T: Batch, U: Components<T>> Predictor<T, U> {
    /// How many solutions there were, up to [`WINDOW`].
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The earlier solutions, the oldest first.
    #[inline(always)]
    fn window(&self) -> &[Term<T, U>] {
        // below KEPT, which the compiler then knows too
        let oldest = self.oldest % KEPT;
        &self.solutions[oldest + KEPT - WINDOW..oldest + KEPT]
    }

    /// Forgets all solutions.
    pub(crate) fn forget(&mut self) {
        // of one solution nothing is learned: states that are new at every step need not have it undone
        if self.count > 1 {
            self.unlearn();
        }
        self.count = 0;
    }

    fn unlearn(&mut self) {
        self.weights = terms(&numbers(&THROUGH_ALL[0]));
        self.set_near(T::Mask::splat(false));
        self.errors = [T::of(0.0); FITS];
    }

    /// The latest solution.
    pub(crate) fn latest(&self) -> U {
        self.window()[WINDOW - 1].components
    }

    /// Remembers a solution, and forgets the oldest: to be [counted](Self::count_more).
    #[inline(always)]
    pub(crate) fn push<P: Processor>(&mut self, unknown: &U) {
        let oldest = self.oldest % KEPT;
        self.solutions[oldest].keep::<P>(unknown);
        self.solutions[oldest + KEPT].keep::<P>(unknown);
        self.oldest = oldest + 1;
    }

    /// Counts so many solutions more.
    #[inline(always)]
    pub(crate) fn count_more(&mut self, solutions: u64) {
        self.count = WINDOW.min(self.count + (solutions as usize).min(WINDOW));
    }

    /// Where the solutions point.
    pub(crate) fn next(&self) -> U {
        let (predictor, weights) = (self, &self.weights);
        let [all, any] = self.near;
        if !any {
            return T::dispatch(Next { predictor, weights, near: false });
        }
        let near = T::dispatch(Next { predictor, weights, near: true });
        if all {
            near
        } else {
            select(self.is_near, &near, &T::dispatch(Next { predictor, weights, near: false }))
        }
    }

    /// What the solutions that there are will contribute to the guess after the next solution: [`then`](Self::then) it takes that one.
    #[inline(always)]
    pub(crate) fn begun<P: Processor>(&self) -> U {
        // the window begins one later then
        let next = self.oldest % KEPT + KEPT - WINDOW + 1;
        self.earlier::<P>(&self.solutions[next..next + WINDOW - 1])
    }

    /// Where the solutions will point after this one, from what was [begun](Self::begun).
    #[inline(always)]
    pub(crate) fn then(&self, begun: &U, unknown: &U) -> U {
        continued(&self.weights, begun, unknown)
    }

    /// What all solutions of a window but the latest, which may be missing there, contribute to the next one.
    #[inline(always)]
    fn earlier<P: Processor>(&self, window: &[Term<T, U>]) -> U {
        let [all, any] = self.near;
        let (through, near) = (Through(&self.weights, window), Near(&self.weights, window));
        let like = &window[0].components;
        if all {
            return computed::<P, _, _>(&near, like);
        }
        let mut sum = computed::<P, _, _>(&through, like);
        if any {
            let near = computed::<P, _, _>(&near, like);
            sum = select(self.is_near, &near, &sum);
        }
        sum
    }

    /// Continues, in some lanes, the latest solutions, as many as `order` says there.
    pub(crate) fn continue_through(&mut self, order: T, lanes: T::Mask) {
        for lane in (0..T::LANES).filter(|lane| lanes.lane(*lane)) {
            let weights = &THROUGH_ALL[(order.lane(lane).to_f64() as usize).clamp(1, RECENT) - 1];
            for (mine, weight) in self.weights.iter_mut().zip(weights) {
                let mut value = mine.value();
                value.set_lane(lane, <T::Number as Scalar>::of(*weight));
                *mine = Weight::new(value);
            }
        }
        self.set_near(self.is_near & !lanes);
    }

    /// Takes the polynomial that points best at this solution, and pointed well at those before. Errors relative to the unknown, of which one
    /// below `tolerance` is none.
    #[inline(always)]
    pub(crate) fn choose(&mut self, blocks: &[usize], solution: &U, tolerance: T) {
        let [mut of_through, mut of_near] = [Best::none(); 2];
        let mut errors = self.errors;
        let (errors_through, errors_near) = errors.split_at_mut(THROUGH.len());
        for ((weights, points), lasting) in THROUGH_SOME.iter().zip(THROUGH).zip(errors_through) {
            if points > self.count {
                break;
            }
            let weights = numbers(weights);
            let guess = T::dispatch(Next { predictor: self, weights: &terms(&weights), near: false });
            of_through.take_better(&weights, change(blocks, &guess, solution), lasting);
        }
        for (weights, lasting) in NEAR_ALL.iter().zip(errors_near) {
            if WINDOW > self.count {
                break;
            }
            let weights = numbers(weights);
            let guess = T::dispatch(Next { predictor: self, weights: &terms(&weights), near: true });
            of_near.take_better(&weights, change(blocks, &guess, solution), lasting);
        }
        // Those through the latest only where the others do not do: lanes with polynomials of both kinds take the time of both.
        let does = (T::of(MARGIN) * of_near.error).le(tolerance);
        let is_near = does | of_near.error.lt(of_through.error);
        self.errors = errors;
        let mut j = 0;
        while j < RECENT {
            self.weights[j] = Weight::new(T::select(is_near, of_near.weights[j], of_through.weights[j]));
            j += 1;
        }
        self.set_near(is_near);
    }

    #[inline(always)]
    fn set_near(&mut self, is_near: T::Mask) {
        self.is_near = is_near;
        self.near = [is_near.all(), is_near.any()];
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub(crate) fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        let mut numbers = [T::of(self.oldest as f64), T::of(self.count as f64)];
        visit(&mut numbers);
        // the same in all lanes
        let [oldest, count] = [numbers[0].lane(0).to_f64() as usize, numbers[1].lane(0).to_f64() as usize];
        (self.oldest, self.count) = (oldest, count.min(WINDOW));
        let mut weights = [T::of(0.0); RECENT];
        weights.iter_mut().zip(&self.weights).for_each(|(weight, mine)| *weight = mine.value());
        visit(&mut weights);
        self.weights = terms(&weights);
        let mut is_near = T::select(self.is_near, T::of(1.0), T::of(0.0));
        visit(core::slice::from_mut(&mut is_near));
        self.set_near(T::of(0.0).lt(is_near));
        visit(&mut self.errors);
        self.solutions.iter_mut().for_each(|solution| visit(solution.components.as_mut()));
        if self.count <= 1 {
            self.unlearn();
        }
    }
}

/// The best of some polynomials.
#[derive(Clone, Copy)]
struct Best<T> {
    error: T,
    weights: [T; RECENT],
}

impl<T: Batch> Best<T> {
    /// With one solution there is nothing to choose, and with none the first will be the latest.
    fn none() -> Self {
        Self { error: T::of(f64::INFINITY), weights: numbers(&THROUGH_ALL[0]) }
    }

    /// Takes another one, of which this is the error now, where it is better. What it `was` is remembered: an error changes its sign now and
    /// then, and is small for a while.
    #[inline(always)]
    fn take_better(&mut self, weights: &[T; RECENT], now: T, was: &mut T) {
        let before = T::of(LASTING) * *was;
        let error = T::select(now.lt(before), before, now);
        *was = error;
        let better = error.lt(self.error);
        self.error = T::select(better, error, self.error);
        let mut j = 0;
        while j < RECENT {
            self.weights[j] = T::select(better, weights[j], self.weights[j]);
            j += 1;
        }
    }
}

/// Where solutions point, by a polynomial through or near to them, out of line.
struct Next<'a, T: Batch, U> {
    predictor: &'a Predictor<T, U>,
    weights: &'a [Weight<T>; RECENT],
    near: bool,
}

impl<T: Batch, U: Components<T>> Work for Next<'_, T, U> {
    type Home = ();
    type Result = U;

    #[inline(always)]
    fn done(self) -> U {
        let Self { predictor, weights, near } = self;
        let window = predictor.window();
        let latest = &window[WINDOW - 1].components;
        let earlier = if near {
            computed::<Portable, _, _>(&Near(weights, window), latest)
        } else {
            computed::<Portable, _, _>(&Through(weights, window), latest)
        };
        continued(weights, &earlier, latest)
    }
}

/// The component `i` of `x_j`, and those after it. The latest may be missing in the window.
#[inline(always)]
fn x<T: Batch, U: Components<T>, X: Piece<T>>(window: &[Term<T, U>], j: usize, i: usize) -> X {
    X::of(&window[WINDOW - j], i)
}

/// `Σ_{j > 1} w_j x_j` of the coefficients and solutions of a polynomial through these.
struct Through<'a, T: Batch, U>(&'a [Weight<T>; RECENT], &'a [Term<T, U>]);

impl<T: Batch, U: Components<T>> Formula<T> for Through<'_, T, U> {
    #[inline(always)]
    fn at<X: Piece<T>>(&self, i: usize) -> X {
        let Self([_, w2, w3, w4, w5, w6, w7, w8], window) = self;
        // two sums, for each has to wait for itself
        let older = x::<_, _, X>(window, 8, i).times(w8);
        let older = older.plus(w7, x(window, 7, i)).plus(w6, x(window, 6, i)).plus(w5, x(window, 5, i));
        let newer = x::<_, _, X>(window, 4, i).times(w4);
        let newer = newer.plus(w3, x(window, 3, i)).plus(w2, x(window, 2, i));
        older.and(newer)
    }
}

/// `x₁₆ − w₁ x₁₅ + Σ_{j > 1} w_j (x_j − x_{16 − j})` of the coefficients and solutions of a polynomial near to these.
struct Near<'a, T: Batch, U>(&'a [Weight<T>; RECENT], &'a [Term<T, U>]);

impl<T: Batch, U: Components<T>> Near<'_, T, U> {
    /// `x_j − x_{16 − j}`
    #[inline(always)]
    fn difference<X: Piece<T>>(&self, j: usize, i: usize) -> X {
        let Self(_, window) = self;
        x::<_, _, X>(window, j, i).less(x(window, WINDOW - j, i))
    }
}

impl<T: Batch, U: Components<T>> Formula<T> for Near<'_, T, U> {
    #[inline(always)]
    fn at<X: Piece<T>>(&self, i: usize) -> X {
        let Self([w1, w2, w3, w4, w5, w6, w7, _], window) = self;
        let inner = self.difference::<X>(7, i).times(w7);
        let inner = inner.plus(w6, self.difference(6, i)).plus(w5, self.difference(5, i));
        let outer = self.difference::<X>(4, i).times(w4);
        let outer = outer.plus(w3, self.difference(3, i)).plus(w2, self.difference(2, i));
        x::<_, _, X>(window, WINDOW, i).minus(w1, x(window, WINDOW - 1, i)).and(inner.and(outer))
    }
}

/// The same with the latest.
#[inline(always)]
fn continued<T: Batch, U: Components<T>>(weights: &[Weight<T>; RECENT], earlier: &U, latest: &U) -> U {
    let mut sum = *earlier;
    let mut i = 0;
    while i < U::LENGTH {
        sum.as_mut()[i] = weights[0].value().mul_add(latest.as_ref()[i], earlier.as_ref()[i]);
        i += 1;
    }
    sum
}

/// Coefficients as they are kept. A loop: mapped arrays are a dozen functions more to compile.
#[inline(always)]
fn terms<T: Copy>(weights: &[T; RECENT]) -> [Weight<T>; RECENT] {
    let mut terms = [Weight::new(weights[0]); RECENT];
    let mut j = 0;
    while j < RECENT {
        terms[j] = Weight::new(weights[j]);
        j += 1;
    }
    terms
}

/// The numbers of the kind.
#[inline(always)]
fn numbers<T: Scalar>(weights: &[f64; RECENT]) -> [T; RECENT] {
    let mut numbers = [T::of(0.0); RECENT];
    let mut j = 0;
    while j < RECENT {
        numbers[j] = T::of(weights[j]);
        j += 1;
    }
    numbers
}

/// The coefficients of the polynomials through 1, 2, … of the latest solutions: binomial coefficients with alternating signs.
const THROUGH_ALL: [[f64; RECENT]; RECENT] = {
    let mut weights = [[0.0; RECENT]; RECENT];
    let mut points = 1;
    while points <= RECENT {
        let (mut coefficient, mut j) = (-1.0, 0);
        while j < points {
            coefficient *= -((points - j) as f64 / (j + 1) as f64);
            weights[points - 1][j] = coefficient;
            j += 1;
        }
        points += 1;
    }
    weights
};

/// Those of them that are tried.
const THROUGH_SOME: [[f64; RECENT]; THROUGH.len()] = {
    let mut weights = [[0.0; RECENT]; THROUGH.len()];
    let mut fit = 0;
    while fit < THROUGH.len() {
        weights[fit] = THROUGH_ALL[THROUGH[fit] - 1];
        fit += 1;
    }
    weights
};

/// The coefficients of the polynomials near to all: `w_j = 2 S(j) / (1 − 2 S(0))`.
///
/// `S(j) = Σ_k t_k(0) t_k(j) / Σ_y t_k(y)²` with the odd ones of the discrete Chebyshev polynomials `t_k`, which are orthogonal on the places
/// `0, …, 16`: what is left of the indicator of place 0, less that of place 16, where all odd polynomials of the degree are taken off.
const NEAR_ALL: [[f64; RECENT]; NEAR.len()] = {
    let mut weights = [[0.0; RECENT]; NEAR.len()];
    let mut fit = 0;
    while fit < NEAR.len() {
        let (above, below) = odd_kernel(NEAR[fit] as i128, 0);
        let rest = (below - 2 * above) as f64 / below as f64;
        let mut j = 1;
        while j < RECENT {
            let (above, below) = odd_kernel(NEAR[fit] as i128, j as i128);
            weights[fit][j - 1] = 2.0 * above as f64 / below as f64 / rest;
            j += 1;
        }
        fit += 1;
    }
    weights
};

/// `S(x)`, as a fraction.
const fn odd_kernel(degree: i128, x: i128) -> (i128, i128) {
    let n = WINDOW as i128 + 1;
    let (mut numerator, mut denominator) = (0, 1);
    // t_{k−1} and t_k, at 0 and at x, and Σ t_k² = n (n² − 1) … (n² − k²) / (2k + 1), times 2k + 1
    let (mut before, mut now) = ([0, 0], [1, 1]);
    let mut square = n;
    let mut k = 0;
    while k < degree {
        if k % 2 == 1 {
            let (mut above, mut below) = (now[0] * now[1] * (2 * k + 1), square);
            let shared = gcd(above, below);
            (above, below) = (above / shared, below / shared);
            let shared = gcd(denominator, below);
            numerator = numerator * (below / shared) + above * (denominator / shared);
            denominator = denominator / shared * below;
            let shared = gcd(numerator, denominator);
            (numerator, denominator) = (numerator / shared, denominator / shared);
        }
        // (k + 1) t_{k+1}(y) = (2k + 1)(2y − n + 1) t_k(y) − k (n² − k²) t_{k−1}(y)
        let here = (2 * k + 1) * (1 - n) * now[0] - k * (n * n - k * k) * before[0];
        let there = (2 * k + 1) * (2 * x - n + 1) * now[1] - k * (n * n - k * k) * before[1];
        before = now;
        now = [here / (k + 1), there / (k + 1)];
        k += 1;
        square *= n * n - k * k;
    }
    (numerator, denominator)
}

/// The greatest common divisor; 1 if both are zero.
const fn gcd(a: i128, b: i128) -> i128 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    if a == 0 { 1 } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All fits, with the highest degree of polynomials that they continue.
    fn fits() -> impl Iterator<Item = (bool, [f64; RECENT], usize)> {
        let near = NEAR_ALL.into_iter().zip(NEAR).map(|(weights, degree)| (true, weights, degree));
        THROUGH.into_iter().map(|points| (false, THROUGH_ALL[points - 1], points - 1)).chain(near)
    }

    /// How much the solutions at −1, −2, … count.
    fn all_weights(near: bool, weights: &[f64; RECENT]) -> [f64; WINDOW] {
        let mut all = [0.0; WINDOW];
        if near {
            all[WINDOW - 1] = 1.0;
            for (j, weight) in (1..).zip(&weights[..RECENT - 1]) {
                (all[j - 1], all[WINDOW - j - 1]) = (*weight, -weight);
            }
        } else {
            all[..RECENT].copy_from_slice(weights);
        }
        all
    }

    #[test]
    fn weights_continue_polynomials() {
        for (near, weights, degree) in fits() {
            let all = all_weights(near, &weights);
            for power in 0..=degree as i32 {
                let terms = (1..).zip(all).map(|(j, weight)| weight * f64::from(-j).powi(power));
                let (sum, size) = terms.fold((0.0, 1.0), |(sum, size), term| (sum + term, size + term.abs()));
                let exact = if power == 0 { 1.0 } else { 0.0 };
                assert!((sum - exact).abs() < 1e-15 * size, "{near} {degree} {power}: {sum}");
            }
            // and not the next one
            let next = degree as i32 + 1;
            let sum: f64 = (1..).zip(all).map(|(j, weight)| weight * f64::from(-j).powi(next)).sum();
            assert!(sum.abs() > 0.5, "{near} {degree}: {sum}");
        }
        // through as many points as there are coefficients
        assert_eq!(THROUGH_ALL[7], [8.0, -28.0, 56.0, -70.0, 56.0, -28.0, 8.0, -1.0]);
    }

    /// The size of the coefficients of least squares for all solutions, of which there are none smaller: by orthogonal polynomials on them,
    /// made one after the other.
    fn least_size(degree: usize) -> f64 {
        // at the solutions, and at the next one, which is the last
        let places: [f64; WINDOW + 1] = core::array::from_fn(|x| x as f64 / 8.0 - 1.0);
        let dot = |p: &[f64; WINDOW + 1], q: &[f64; WINDOW + 1]| -> f64 {
            p.iter().zip(q).take(WINDOW).map(|(p, q)| p * q).sum()
        };
        let mut before: Vec<[f64; WINDOW + 1]> = Vec::new();
        let mut square = 0.0;
        for power in 0..=degree as i32 {
            let mut polynomial = places.map(|x| x.powi(power));
            // twice, for the first time leaves some
            for other in before.iter().chain(&before) {
                let share = dot(&polynomial, other);
                polynomial.iter_mut().zip(other).for_each(|(p, q)| *p -= share * q);
            }
            let size = dot(&polynomial, &polynomial).sqrt();
            polynomial.iter_mut().for_each(|p| *p /= size);
            square += polynomial[WINDOW].powi(2);
            before.push(polynomial);
        }
        square.sqrt()
    }

    /// What rounding left in the solutions counts for little more than with least squares, and for more the higher the degree.
    #[test]
    fn weights_near_to_all_are_small() {
        let mut last = 0.0;
        for (_, weights, degree) in fits().filter(|(near, ..)| *near) {
            let size = all_weights(true, &weights).iter().map(|weight| weight * weight).sum::<f64>().sqrt();
            let least = least_size(degree);
            assert!(least < size && size < 1.2 * least && size > last, "{degree}: {size}, not {least}");
            last = size;
        }
    }

    #[test]
    fn the_window_moves_and_forgets() {
        let mut course = Predictor::<f64, [f64; 1]>::default();
        for k in 0..40 {
            assert_eq!(course.count(), k.min(WINDOW));
            course.push::<Portable>(&[k as f64]);
            course.count_more(1);
            assert_eq!(course.next(), [k as f64]);
            assert_eq!(course.latest(), [k as f64]);
        }
        for (fit, (near, weights, _)) in fits().enumerate().skip(1) {
            course.weights = weights.map(Weight::new);
            course.set_near(near);
            let next = 40.0 + fit as f64;
            let soon = course.then(&course.begun::<Portable>(), &[next - 1.0]);
            course.push::<Portable>(&[next - 1.0]);
            let [guess] = course.next();
            assert!((guess - next).abs() < 1e-12, "{near} {weights:?}: {guess}");
            assert_eq!(soon, [guess], "begun before the solution");
            let mut same = course;
            same.memory(&mut |_| ());
            assert_eq!(same.next(), [guess]);
        }
    }
}
