//! Where the solutions of earlier steps point.
//!
//! Successive solutions are samples of a smooth course: a polynomial through the last of them, or as near to them as can be, continued by one
//! step, is the next one to many digits. Of several polynomials that one is taken which would have pointed best at the latest solution.

use crate::kernel::Components;
use crate::lanes::{Portable, Processor};
use crate::scalar::{Batch, Mask, Real, Scalar, Term, Work};

/// The most earlier solutions that the next one is extrapolated from.
pub(crate) const WINDOW: usize = 16;
/// How many are kept: the next power of two, so that places are found by a mask.
const KEPT: usize = WINDOW.next_power_of_two();
/// So many of the most recent ones do for many systems.
const RECENT: usize = 8;
/// Where they do not, so many more are taken at a time.
const MORE: usize = 4;
/// The polynomials that are tried: through how many of the solutions, or as near to them as can be, and of what degree. The nearest to many
/// has less of their rounding in it.
const FITS: [(usize, usize); 9] = [
    (1, 0),
    (2, 1),
    (3, 2),
    (4, 3),
    (6, 5),
    (RECENT, 7),
    (RECENT + MORE, 8),
    (RECENT + MORE, 9),
    (WINDOW, 10),
];
/// By how much the square of an error is to be smaller than a change that may be the last, for it may grow until it is looked at again.
const MARGIN: f64 = 16.0;
/// What is left of the square of an error at the next look.
const LASTING: f64 = 0.25;

/// The last solutions, and how the next one follows from them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extrapolation<T: Batch, U> {
    /// The solutions in a ring, each one twice, so that all are in a row wherever they begin; zeros where there were none.
    solutions: [Term<T, U>; 2 * KEPT],
    /// The place of the oldest, which the next one will take.
    oldest: usize,
    /// How many there were, up to [`WINDOW`].
    count: usize,
    /// Their coefficients, the oldest solution's first.
    weights: [T; WINDOW],
    /// How many of the latest solutions have a coefficient that is not zero: [`RECENT`] or so many times [`MORE`] more.
    reach: usize,
    /// The squares of the polynomials' errors, those found at the latest look and what is left of earlier ones.
    errors: [T; FITS.len()],
}

/// Knows no solution.
impl<T: Batch, U: Components<T>> Default for Extrapolation<T, U> {
    fn default() -> Self {
        let nothing = U::from_fn(|_| T::of(0.0));
        Self {
            solutions: [Term::new(nothing); 2 * KEPT],
            oldest: 0,
            count: 0,
            weights: weights(0),
            reach: RECENT,
            errors: [T::of(0.0); FITS.len()],
        }
    }
}

impl<T: Batch, U: Components<T>> Extrapolation<T, U> {
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

    /// The latest solution.
    pub(crate) fn latest(&self) -> U {
        self.window()[WINDOW - 1].components
    }

    /// Remembers a solution, and forgets the oldest.
    #[inline(always)]
    pub(crate) fn push(&mut self, unknown: &U) {
        self.replace_oldest::<Portable>(unknown);
        self.count = (self.count + 1).min(WINDOW);
    }

    /// The same where there are as many as can be.
    #[inline(always)]
    pub(crate) fn replace_oldest<P: Processor>(&mut self, unknown: &U) {
        let oldest = self.oldest % KEPT;
        T::keep::<P, _>(&mut self.solutions[oldest], unknown);
        T::keep::<P, _>(&mut self.solutions[oldest + KEPT], unknown);
        self.oldest = oldest + 1;
    }

    /// Where the solutions point.
    pub(crate) fn next(&self) -> U {
        T::outline(Next(self))
    }

    /// What the solutions that there are will contribute to the guess after the next solution: [`then`](Self::then) it takes that one.
    #[inline(always)]
    pub(crate) fn begun<P: Processor>(&self) -> U {
        // the window begins one later then
        let next = self.oldest % KEPT + KEPT - WINDOW + 1;
        earlier::<P, _, _>(&self.weights, &self.solutions[next..next + WINDOW - 1], self.reach)
    }

    /// Where the solutions will point after this one, from what was [begun](Self::begun).
    #[inline(always)]
    pub(crate) fn then(&self, begun: &U, unknown: &U) -> U {
        continued(&self.weights, begun, unknown)
    }

    /// Takes, in the `wanting` lanes, the polynomial that points best at this solution, and pointed well at those of earlier looks. An error of
    /// which the square is below `tolerance` is none.
    #[inline(always)]
    pub(crate) fn choose(&mut self, solution: &U, wanting: T::Mask, tolerance: T) {
        // with one solution there is nothing to choose, and with none the first will be the latest
        let mut best = weights(0);
        let mut least = T::of(0.0);
        let mut errors = self.errors;
        for ((fit, (points, _)), lasting) in FITS.into_iter().enumerate().zip(&mut errors) {
            if points > self.count {
                break;
            }
            let candidate = weights(fit);
            let guess = extrapolated(&candidate, self.window(), points.max(RECENT));
            // an error changes its sign now and then, and is small for a while
            let (now, before) = (squared_distance(&guess, solution), T::of(LASTING) * *lasting);
            let error = T::select(now.below(before), before, now);
            *lasting = T::select(wanting, error, *lasting);
            let better = error.below(least) | T::Mask::splat(fit == 0);
            // more than the recent ones only where fewer do not do
            let better =
                better & (T::Mask::splat(points <= RECENT) | !(T::of(MARGIN) * least).at_most(tolerance));
            least = T::select(better, error, least);
            best = core::array::from_fn(|j| T::select(better, candidate[j], best[j]));
        }
        self.errors = errors;
        self.weights = core::array::from_fn(|j| T::select(wanting, best[j], self.weights[j]));
        self.reach = reach(&self.weights);
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub(crate) fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        let mut numbers = [self.oldest, self.count].map(|number| T::of(number as f64));
        visit(&mut numbers);
        // the same in all lanes
        let [oldest, count] = numbers.map(|number| number.lane(0).to_f64() as usize);
        (self.oldest, self.count) = (oldest, count.min(WINDOW));
        visit(&mut self.weights);
        visit(&mut self.errors);
        self.solutions.iter_mut().for_each(|solution| visit(solution.components.as_mut()));
        self.reach = reach(&self.weights);
    }
}

/// How many of the latest solutions have a weight in any lane, rounded up to what [`earlier`] takes together.
fn reach<T: Batch>(weights: &[T; WINDOW]) -> usize {
    let any = |weights: &[T]| weights.iter().any(|weight| T::of(0.0).below(Batch::abs(*weight)).any());
    if any(&weights[..WINDOW - RECENT - MORE]) {
        WINDOW
    } else if any(&weights[WINDOW - RECENT - MORE..WINDOW - RECENT]) {
        RECENT + MORE
    } else {
        RECENT
    }
}

/// Where the solutions point, out of line.
struct Next<'a, T: Batch, U>(&'a Extrapolation<T, U>);

impl<T: Batch, U: Components<T>> Work for Next<'_, T, U> {
    type Result = U;

    #[inline(always)]
    fn done(self) -> U {
        extrapolated(&self.0.weights, self.0.window(), self.0.reach)
    }
}

/// Where the solutions point, the oldest first: the polynomial through them, one step on.
#[inline(always)]
fn extrapolated<T: Batch, U: Components<T>>(weights: &[T; WINDOW], window: &[Term<T, U>], reach: usize) -> U {
    continued(weights, &earlier::<Portable, _, _>(weights, window, reach), &window[WINDOW - 1].components)
}

/// What all solutions but the latest contribute to it.
#[inline(always)]
fn earlier<P: Processor, T: Batch, U: Components<T>>(
    weights: &[T; WINDOW],
    window: &[Term<T, U>],
    reach: usize,
) -> U {
    // two sums, for each has to wait for itself
    const RECENTLY: usize = WINDOW - RECENT;
    const MIDDLE: usize = RECENTLY + RECENT / 2;
    let mut sum = T::combined::<P, _>(
        &weights[RECENTLY..MIDDLE],
        &window[RECENTLY..MIDDLE],
        &weights[MIDDLE..WINDOW - 1],
        &window[MIDDLE..WINDOW - 1],
    );
    if reach > RECENT {
        add_before::<P, T, U, RECENTLY>(&mut sum, weights, window);
    }
    if reach > RECENT + MORE {
        add_before::<P, T, U, { RECENTLY - MORE }>(&mut sum, weights, window);
    }
    sum
}

/// Adds what [`MORE`] solutions before this place contribute.
#[inline(always)]
fn add_before<P: Processor, T: Batch, U: Components<T>, const PLACE: usize>(
    sum: &mut U,
    weights: &[T; WINDOW],
    window: &[Term<T, U>],
) {
    let (start, middle) = (PLACE - MORE, PLACE - MORE / 2);
    let before = T::combined::<P, _>(
        &weights[start..middle],
        &window[start..middle],
        &weights[middle..PLACE],
        &window[middle..PLACE],
    );
    for (sum, before) in sum.as_mut().iter_mut().zip(before.as_ref()) {
        *sum = *sum + *before;
    }
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

/// The sum of the squares of the components; not-a-number if any component is. Most kernels compute it too, in this order, and the compiler
/// makes one of both.
#[inline(always)]
pub(crate) fn square<T: Scalar, U: Components<T>>(x: &U) -> T {
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
pub(crate) fn squared_distance<T: Scalar, U: Components<T>>(a: &U, b: &U) -> T {
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
                // values at −15, …, −1, continued to 0
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
        let size = |fit: usize| weights::<f64>(fit).iter().map(|weight| weight * weight).sum::<f64>().sqrt();
        let [through, eight, nine, ten] = [5, 6, 7, 8].map(size);
        assert!(30.0 < eight && eight < ten && ten < nine && nine < through && through < 120.0);
    }

    #[test]
    fn the_window_moves_and_forgets() {
        let mut course = Extrapolation::<f64, [f64; 1]>::default();
        for k in 0..40 {
            assert_eq!(course.count(), k.min(WINDOW));
            course.push(&[k as f64]);
            assert_eq!(course.next(), [k as f64]);
            assert_eq!(course.latest(), [k as f64]);
        }
        for (fit, (points, degree)) in FITS.into_iter().enumerate().skip(1) {
            course.weights = weights(fit);
            course.reach = reach(&course.weights);
            assert_eq!(course.reach, points.max(RECENT));
            let next = 40.0 + fit as f64;
            let soon = course.then(&course.begun::<Portable>(), &[next - 1.0]);
            course.push(&[next - 1.0]);
            let [guess] = course.next();
            assert!((guess - next).abs() < 1e-10, "{points} {degree}: {guess}");
            assert_eq!(soon, [guess], "begun before the solution");
            let mut same = course;
            same.memory(&mut |_| ());
            assert_eq!(same.next(), [guess]);
        }
    }
}
