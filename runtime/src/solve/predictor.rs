//! Where the solutions of earlier steps point.
//!
//! Successive solutions are samples of a smooth trajectory: a polynomial through the latest of them, or near to more of them, continued by one
//! step, is the next one to many digits. Let `x₀` be the next solution and `x₁`, `x₂`, … the earlier ones, the latest first. The polynomial through
//! `p` of them gives
//!
//! ```text
//! x₀ = Σ_{j = 1}^{p} (−1)^{j+1} C(p, j) x_j
//! ```
//!
//! and what rounding left in the solutions counts `C(2p, p)^½` fold. It counts for less where the polynomial only has to be near to more of them.
//! Of such we take one that is odd about the middle of sixteen steps, which has half as many products:
//!
//! ```text
//! x₀ − x₁₆ = Σ w_j (x_j − x_{16 − j}),   j = 1, 2, 3, 5, 7
//! ```
//!
//! Of even powers of the distance from `x₈` this holds whatever `w` is. That it holds of the odd ones up to the ninth, and so of all polynomials of
//! degree 10, determines five weights. Of all choices of five differences [this one](PAIRS) magnifies rounding least, 61 fold, hardly more than the
//! best weights of all seven (59.5); and its weights are exact.
//!
//! Where a step is [long](crate::kernel::Kernel::IS_LONG), 61 times what its many operations leave of rounding can be more than one iteration takes
//! off. Where the motion is slow besides, odd powers up to the seventh are enough, and [other weights](CALM) of the same differences count rounding 19
//! fold. Which ones lead nearer to a solution is looked at where a step needs more than the fast path.
//!
//! Newton's method takes off so much that rounding is no matter, and is there for steps so large that sixteen of them are too many to look back:
//! its guess is the polynomial through eight, of what solutions are apart from their equations' [first approximations](crate::kernel::Kernel::start).

use super::constants::{LOST, LOW, SMALL, THROUGH};
use crate::kernel::Kernel;
use crate::scalar::blocks::{is_within, less, plus, select, weighted, weights};
use crate::scalar::rows::{Formula, Piece, Row, computed};
use crate::scalar::simd::lanes::{Portable, Processor};
#[cfg(feature = "dynamic")]
use crate::scalar::simd::march::Remembered;
use crate::scalar::{Batch, Components, Mask, Scalar, Work};

/// How many solutions are kept: a power of two, so that places are found by a mask.
pub(super) const WINDOW: usize = 16;

/// The `j` of which there is a difference `x_j − x_{16 − j}`.
const PAIRS: [usize; 5] = [1, 2, 3, 5, 7];

/// Their weights, exact as numbers of any kind.
const WEIGHTS: [f64; 5] = [231.0 / 32.0, -20.0, 735.0 / 32.0, -637.0 / 32.0, 715.0 / 32.0];

/// Those for slow motion, exact too. The least that a polynomial of degree 8 can be continued with is 18 fold.
const CALM: [f64; 5] = [1353.0 / 256.0, -10.0, 1785.0 / 256.0, -91.0 / 256.0, -715.0 / 256.0];

/// The first half of the weights of the polynomial through eight.
const BINOMIAL: [f64; 4] = [8.0, -28.0, 56.0, -70.0];

/// What the solutions of a kernel are continued by.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Continuation {
    /// The polynomial through eight, of Newton's method.
    Eighth,
    /// One that is odd about the middle of sixteen.
    Odd,
    /// The same, with the weights that lead nearer.
    Chosen,
}

impl Continuation {
    /// That of a kernel's solutions.
    #[inline(always)]
    pub(super) fn of<T: Scalar, K: Kernel<T>>(kernel: &K) -> Self {
        match kernel.is_newton() {
            true => Self::Eighth,
            false if kernel.is_long() => Self::Chosen,
            false => Self::Odd,
        }
    }

    /// How many solutions it goes through, or near to.
    #[inline(always)]
    fn points(self) -> usize {
        if self == Self::Eighth { THROUGH } else { WINDOW }
    }
}

/// Where the solutions before point, and the place that the next one will take: in registers while many steps are taken.
pub(crate) type Guess<U> = (U, u32);

/// The solutions that point to the next one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Predictor<T: Batch, U> {
    /// The latest solutions, in a ring; each with a number after it, so that three doubles and that one are loaded together.
    ring: [Row<T, U, 1>; WINDOW],
    /// The next solution, if there are any before it; for Newton's method what it is apart from the first approximation.
    next: U,
    /// The latest solution, for Newton's method.
    solution: U,
    /// How many of the solutions are of use, in each lane; one more than all where the weights for slow motion lead nearer.
    count: T,
    /// The place of the oldest, which the next one will take.
    oldest: u32,
    /// Whether all are of use in all lanes: kept, for it is asked in each step.
    is_full: bool,
}

/// Knows no solution.
impl<T: Batch, U: Components<T>> Default for Predictor<T, U> {
    fn default() -> Self {
        let nothing = U::splat(T::of(0.0));
        Self {
            ring: [Row::new(nothing); WINDOW],
            next: nothing,
            solution: nothing,
            count: T::of(0.0),
            oldest: 0,
            is_full: false,
        }
    }
}

impl<T: Batch, U: Components<T>> Predictor<T, U> {
    /// Whether there are earlier solutions, in all lanes.
    #[inline(always)]
    pub(super) fn remembers(&self) -> bool {
        T::of(0.0).lt(self.count).all()
    }

    /// The lanes in which all are of use.
    #[inline(always)]
    pub(super) fn are_all(&self, by: Continuation) -> T::Mask {
        T::of(by.points() as f64).le(self.count)
    }

    /// Whether all are of use, in all lanes.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.is_full
    }

    /// Forgets all solutions.
    #[inline(always)]
    pub(super) fn forget(&mut self) {
        (self.count, self.is_full) = (T::of(0.0), false);
    }

    /// How many solutions are of use, and whether all are.
    #[inline(always)]
    pub(super) fn count(&self) -> (T, bool) {
        (self.count, self.is_full)
    }

    /// Takes as many of them as of use again.
    #[inline(always)]
    pub(super) fn recall(&mut self, count: (T, bool)) {
        (self.count, self.is_full) = count;
    }

    /// The next solution, if there is any before it.
    #[inline(always)]
    pub(super) fn next(&self) -> U {
        self.next
    }

    /// `x_j`, from the latest on, for `j` up to [`WINDOW`].
    #[inline(always)]
    fn row(&self, oldest: u32, j: usize) -> &Row<T, U, 1> {
        &self.ring[(oldest as usize + WINDOW - j) % WINDOW]
    }

    /// The latest that was kept.
    #[inline(always)]
    pub(super) fn latest(&self) -> U {
        self.row(self.oldest, 1).components
    }

    /// The latest solution, for Newton's method.
    #[inline(always)]
    pub(super) fn solution(&self) -> U {
        self.solution
    }

    /// Notes it.
    #[inline(always)]
    pub(super) fn note(&mut self, solution: &U) {
        self.solution = *solution;
    }

    /// The weights of the differences.
    #[inline(always)]
    pub(super) fn weights(&self, by: Continuation) -> [T; 5] {
        let usual = all_of(WEIGHTS);
        if by != Continuation::Chosen {
            return usual;
        }
        let calm = all_of(CALM);
        // no closure, which would not be compiled for the processor that the caller is compiled for
        let is_calm = T::of(WINDOW as f64).lt(self.count);
        let [a, b, c, d, e] = calm;
        let [f, g, h, i, j] = usual;
        [
            T::select(is_calm, a, f),
            T::select(is_calm, b, g),
            T::select(is_calm, c, h),
            T::select(is_calm, d, i),
            T::select(is_calm, e, j),
        ]
    }

    /// What the solutions that there are contribute to the one after the next, where [all are of use](Self::is_full).
    #[inline(always)]
    pub(super) fn begun<P: Processor>(&self, oldest: u32, by: Continuation, weights: &[T; 5]) -> U {
        computed::<P, _, _, _>(&mut Begun { predictor: self, oldest, by, weights }, &self.next)
    }

    /// The solution after this one, from what was [begun](Self::begun).
    #[inline(always)]
    pub(super) fn then(begun: &U, solution: &U, by: Continuation, weights: &[T; 5]) -> U {
        plus(begun, if by == Continuation::Eighth { T::of(BINOMIAL[0]) } else { weights[0] }, solution)
    }

    /// Where all solutions point with these weights, of which this is the latest.
    #[inline(always)]
    fn by_all(&self, latest: &U, by: Continuation, weights: &[T; 5]) -> U {
        // begun a step ago; one by one, which is half as much to compile, and no slower where it is not the fast path
        let mut begun = Begun { predictor: self, oldest: self.oldest.wrapping_sub(1), by, weights };
        let mut next = *latest;
        let mut i = 0;
        while i < U::LENGTH {
            next.as_mut()[i] = begun.at(i);
            i += 1;
        }
        Self::then(&next, latest, by, weights)
    }

    /// Chooses the weights that would have led nearer to this solution, in some lanes.
    #[inline(always)]
    fn choose(&mut self, sizes: &U, solution: &U, wanted: T::Mask) {
        let (weights, latest) = ([all_of(CALM), all_of(WEIGHTS)], self.latest());
        let (mut off, mut k) = ([T::of(0.0); 2], 0);
        // in one piece of code
        while k < 2 {
            let next = self.by_all(&latest, Continuation::Chosen, &weights[k]);
            off[k] = weighted::<T, _>(sizes, &next, solution);
            k += 1;
        }
        let ([calm, usual], all, one_more) = (off, T::of(WINDOW as f64), T::of((WINDOW + 1) as f64));
        self.count = T::select(wanted, T::select(calm.lt(usual), one_more, all), self.count);
    }

    /// Takes the next solution. Returns the place that the one after it will take.
    #[inline(always)]
    pub(super) fn keep<P: Processor>(&mut self, oldest: u32, solution: &U) -> u32 {
        let place = oldest as usize % WINDOW;
        computed::<P, _, _, _>(&mut Keep(&mut self.ring[place], solution), solution);
        oldest.wrapping_add(1)
    }

    #[inline(always)]
    fn push(&mut self, solution: &U) {
        self.oldest = self.keep::<Portable>(self.oldest, solution);
    }

    /// What the fast path goes on from.
    #[inline(always)]
    pub(super) fn guess(&self) -> Guess<U> {
        (self.next, self.oldest)
    }

    /// Sets where the fast path has led to.
    #[inline(always)]
    pub(super) fn set(&mut self, guess: &Guess<U>) {
        (self.next, self.oldest) = *guess;
    }

    /// All that is remembered, to be gone on from by machine code.
    #[cfg(feature = "dynamic")]
    pub(super) fn remembered(&mut self) -> Remembered<'_, T, U> {
        let Self { ring, next, solution, oldest, .. } = self;
        Remembered { ring, next, solution, oldest: *oldest }
    }

    /// Takes what that has led to.
    #[cfg(feature = "dynamic")]
    pub(super) fn marched(&mut self, oldest: u32) {
        self.oldest = oldest;
    }

    /// Takes one more solution, whatever there is: `IN_LINE`, or by a call.
    #[inline(always)]
    pub(super) fn learn<const IN_LINE: bool>(
        &mut self,
        by: Continuation,
        blocks: &[usize],
        start: Option<&U>,
        solution: &U,
        quick: T::Mask,
    ) {
        let kept = start.map_or(*solution, |start| less(solution, start));
        if start.is_some() {
            self.note(solution);
        }
        if !self.remembers() {
            self.learn_first(&kept);
            return;
        }
        let next = from_start(start, &self.next);
        let is_near = is_within::<T, _>(blocks, &next, solution, T::of(SMALL * T::EPSILON));
        let sizes = &weights::<T, _>(blocks, solution);
        let (kept, next) = (&kept, &next);
        let learn = Learn { predictor: self, by, start, solution, kept, next, is_near, sizes, quick };
        if const { IN_LINE } { learn.learned::<IN_LINE>(by) } else { T::dispatch(learn) }
    }

    /// Takes the first solution after a state that no step has led to: there is nothing to compare it with.
    #[inline(never)]
    fn learn_first(&mut self, solution: &U) {
        self.count = T::of(1.0);
        self.push(solution);
        self.next = plus(&U::splat(T::of(0.0)), T::of(1.0), solution);
    }

    /// Predicts the next solution, where this is the latest.
    #[inline(always)]
    fn predict(&mut self, latest: &U, by: Continuation) {
        let most = T::of(THROUGH as f64);
        let is_full = self.are_all(by);
        self.is_full = is_full.all();
        let mut next = self.next;
        if !self.is_full {
            next = self.through(Scalar::min(self.count, most));
        }
        // in the order in which the fast path adds
        if is_full.any() {
            next = select(is_full, &self.by_all(latest, by, &self.weights(by)), &next);
        }
        self.next = next;
    }

    /// The next solution from the polynomial through so many of the latest, up to [`THROUGH`].
    #[inline(always)]
    fn through(&self, points: T) -> U {
        let (mut sum, mut weight, mut j) = (U::splat(T::of(0.0)), T::of(-1.0), 1);
        while j <= THROUGH {
            // of one solution more than there are points it is zero, and what stands there is not read
            weight = weight * ((T::of(j as f64 - 1.0) - points) * T::of(1.0 / j as f64));
            let is_there = T::of(j as f64).le(points);
            if !is_there.any() {
                break;
            }
            let term = select(is_there, &self.row(self.oldest, j).components, &U::splat(T::of(0.0)));
            sum = plus(&sum, weight, &term);
            j += 1;
        }
        sum
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub(super) fn memory(&mut self, visit: &mut dyn FnMut(&mut [T]), by: Continuation) {
        visit(core::slice::from_mut(&mut self.count));
        if by == Continuation::Eighth {
            visit(self.solution.as_mut());
        }
        // the latest first: where the ring begins is of no interest
        let mut j = 1;
        while j <= WINDOW {
            let place = (self.oldest as usize + WINDOW - j) % WINDOW;
            visit(self.ring[place].components.as_mut());
            j += 1;
        }
        if self.remembers() {
            self.predict(&self.latest(), by);
        } else {
            self.is_full = false;
        }
    }
}

/// Takes one more solution, whatever there is: once for all kernels with as many unknowns.
struct Learn<'a, T: Batch, U> {
    predictor: &'a mut Predictor<T, U>,
    by: Continuation,
    start: Option<&'a U>,
    solution: &'a U,
    /// What is kept of it.
    kept: &'a U,
    /// The solution as it was predicted.
    next: &'a U,
    /// Whether that was off by rounding.
    is_near: T::Mask,
    /// The [weights] of the solution.
    sizes: &'a U,
    quick: T::Mask,
}

impl<T: Batch, U: Components<T>> Work for Learn<'_, T, U> {
    type CallSite = ();
    type Result = ();

    #[inline(always)]
    fn done(self) {
        let by = self.by;
        self.learned::<false>(by);
    }
}

impl<T: Batch, U: Components<T>> Learn<'_, T, U> {
    /// Where a few of the earlier solutions predict it better than all, as where a control has jumped, the others are forgotten. What one lane
    /// learns, others beside it make no difference to: where all were of use and the step was as `quick` as on the fast path, it would have been
    /// taken there.
    #[inline(always)]
    fn learned<const IN_LINE: bool>(self, by: Continuation) {
        let Self { predictor, start, solution, kept, next, sizes, quick, .. } = self;
        let mut is_near = T::Mask::splat(false);
        if predictor.is_full || const { T::LANES > 1 } {
            let is_full = predictor.are_all(by);
            // of steps that are learned in line there are no others
            if const { !IN_LINE } && by == Continuation::Chosen {
                predictor.choose(sizes, solution, is_full & !quick);
            }
            is_near = is_full & (quick | self.is_near);
        }
        if !is_near.all() {
            let off = weighted::<T, _>(sizes, next, solution);
            let (one, low, full) = (T::of(1.0), T::of(LOW as f64), T::of(WINDOW as f64));
            let before = predictor.count;
            // by one solution alone large steps are off by as much, and the motion shows by two
            let is_first = T::Mask::splat(by == Continuation::Eighth) & before.lt(T::of(2.0));
            let is_of_use = is_first | off.le(T::of(LOST));
            let known = T::select(is_of_use, before, T::of(0.0));
            predictor.count = T::select(known.lt(full), known + one, known);
            let is_long = low.lt(known);
            if is_long.any() {
                let by_few = from_start(start, &predictor.through(low));
                let small = T::of(SMALL * T::EPSILON);
                let is_jump = is_long & small.lt(off) & weighted::<T, _>(sizes, &by_few, solution).lt(off);
                predictor.count = T::select(is_jump, low, predictor.count);
            }
            predictor.count = T::select(is_near, before, predictor.count);
        }
        predictor.push(kept);
        predictor.predict(kept, by);
    }
}

/// The solution of which this is kept.
#[inline(always)]
fn from_start<T: Batch, U: Components<T>>(start: Option<&U>, kept: &U) -> U {
    match start {
        Some(start) => plus(start, T::of(1.0), kept),
        None => *kept,
    }
}

/// Weights in all lanes.
#[inline(always)]
fn all_of<T: Batch>([a, b, c, d, e]: [f64; 5]) -> [T; 5] {
    [T::of(a), T::of(b), T::of(c), T::of(d), T::of(e)]
}

/// All that the next solution but one is made of but the next one, piece by piece: a step from now the `x_j` are one place newer.
struct Begun<'a, T: Batch, U> {
    predictor: &'a Predictor<T, U>,
    oldest: u32,
    by: Continuation,
    weights: &'a [T; 5],
}

impl<T: Batch, U: Components<T>> Formula<T> for Begun<'_, T, U> {
    const SPARE: usize = 1;

    #[inline(always)]
    fn at<X: Piece<T>>(&mut self, i: usize) -> X {
        if self.by == Continuation::Eighth {
            eighth(self.predictor, self.oldest, i)
        } else {
            earlier(self.predictor, self.oldest, self.weights, i)
        }
    }
}

/// `Σ_{j > 1} (−1)^{j+1} C(8, j) x_j`
#[inline(always)]
fn eighth<T: Batch, U: Components<T>, X: Piece<T>>(predictor: &Predictor<T, U>, oldest: u32, i: usize) -> X {
    let at = |j: usize| X::of(predictor.row(oldest, j - 1), i);
    let [a, b, c, d] = const { BINOMIAL };
    let inner = at(4).times(T::of(d)).plus(T::of(c), at(3).and(at(5)));
    let outer = at(7).times(T::of(a)).plus(T::of(b), at(2).and(at(6)));
    inner.and(outer.less(at(THROUGH)))
}

/// `x₁₆ − w₁ x₁₅ + Σ_{j > 1} w_j (x_j − x_{16 − j})`, in two chains side by side, for the next step waits for it.
#[inline(always)]
fn earlier<T: Batch, U: Components<T>, X: Piece<T>>(
    predictor: &Predictor<T, U>,
    oldest: u32,
    weights: &[T; 5],
    i: usize,
) -> X {
    let &[a, b, c, d, e] = weights;
    // no closures, which are called where there are many
    macro_rules! at {
        ($j:expr) => {
            X::of(predictor.row(oldest, const { $j - 1 }), i)
        };
    }
    macro_rules! difference {
        ($pair:literal) => {
            at!(PAIRS[$pair]).less(at!(WINDOW - PAIRS[$pair]))
        };
    }
    let inner = difference!(4).times(e).plus(d, difference!(3));
    let outer = difference!(2).times(c).plus(b, difference!(1));
    let last = at!(WINDOW).plus(-a, at!(WINDOW - PAIRS[0]));
    last.and(inner.and(outer))
}

/// Keeps a solution, piece by piece: stored as it will be loaded.
struct Keep<'a, T, U>(&'a mut Row<T, U, 1>, &'a U);

impl<T: Batch, U: Components<T>> Formula<T> for Keep<'_, T, U> {
    const SPARE: usize = 1;

    #[inline(always)]
    fn at<X: Piece<T>>(&mut self, i: usize) -> X {
        let piece = X::gathered(self.1.as_ref(), i);
        piece.put(self.0, i);
        piece
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;

    /// The weights with which odd polynomials are continued to the distance of half a window from its middle, of degree 9: those of Lagrange, of
    /// `p(x)/x` as a polynomial of `x²`.
    fn weights_of(pairs: [usize; 5]) -> [f64; 5] {
        let half = (WINDOW / 2) as f64;
        let at = pairs.map(|j| half - j as f64);
        // numbers of fewer digits than a double has: each is rounded once
        let product = |i: usize, x: f64| {
            let others = (0..5).filter(|k| *k != i).map(|k| x * x - at[k] * at[k]);
            x * others.product::<f64>()
        };
        core::array::from_fn(|i| product(i, half) / product(i, at[i]))
    }

    fn magnifies(weights: [f64; 5]) -> f64 {
        (1.0 + weights.iter().map(|w| 2.0 * w * w).sum::<f64>()).sqrt()
    }

    #[test]
    fn weights_continue_polynomials_and_magnify_least() {
        for (weights, degree) in [(WEIGHTS, 9), (CALM, 7)] {
            for power in (1..=degree).step_by(2) {
                let at = |j: usize| ((8.0 - j as f64) / 8.0).powi(power);
                let sum: f64 = weights.iter().zip(PAIRS).map(|(w, j)| w * at(j)).sum();
                assert!((sum - 1.0).abs() < 1e-14, "{power}: {sum}");
            }
        }
        assert_eq!(WEIGHTS, weights_of(PAIRS));
        assert!((magnifies(CALM) - 19.2).abs() < 0.1);
        // of all choices of five of seven
        let mut all = Vec::new();
        for (first, second) in (1..=7).flat_map(|i| (i + 1..=7).map(move |k| (i, k))) {
            let mut left = (1..=7).filter(|j| *j != first && *j != second);
            all.push(magnifies(weights_of(core::array::from_fn(|_| left.next().expect("five are left")))));
        }
        let least = all.into_iter().fold(f64::INFINITY, f64::min);
        assert!(magnifies(WEIGHTS) == least && (least - 61.2).abs() < 0.1, "{least}");
    }

    use std::vec::Vec;

    fn after(
        predictor: &mut Predictor<f64, [f64; 1]>,
        by: Continuation,
        solutions: impl IntoIterator<Item = f64>,
    ) {
        for x in solutions {
            predictor.learn::<false>(by, &[1], None, &[x], false);
            assert_eq!(predictor.latest(), [x], "{predictor:?}");
        }
    }

    #[test]
    fn polynomials_are_continued() {
        let all = [Continuation::Odd, Continuation::Chosen];
        for (by, degree) in all.into_iter().flat_map(|by| (1..=10).map(move |degree| (by, degree))) {
            let polynomial = |step: i32| 0.005_f64.mul_add(f64::from(step), 1.0).powi(degree);
            let mut predictor = Predictor::default();
            for step in 0..40 {
                after(&mut predictor, by, [polynomial(step)]);
                let off = (predictor.next()[0] / polynomial(step + 1) - 1.0).abs();
                let enough = if degree < THROUGH as i32 { degree } else { WINDOW as i32 - 1 };
                assert!(step < enough || off < 1e-12, "{degree}, {step}: {off:e}");
            }
            assert!(predictor.is_full());
            // and along the fast path
            for step in 40..60 {
                let x = [polynomial(step)];
                let weights = predictor.weights(by);
                let begun = predictor.begun::<Portable>(predictor.oldest, by, &weights);
                let then = Predictor::then(&begun, &x, by, &weights);
                let oldest = predictor.keep::<Portable>(predictor.oldest, &x);
                predictor.set(&(then, oldest));
                assert!((then[0] / polynomial(step + 1) - 1.0).abs() < 1e-12, "{degree}, {step}");
            }
        }
    }

    /// Between −1 and 1, with no pattern.
    fn noise(step: i32) -> f64 {
        2.0 * (f64::from(step) * 0.618_033_988_75).rem_euclid(1.0) - 1.0
    }

    #[test]
    fn weights_follow_how_fast_the_motion_is() {
        let off = |by: Continuation, rate: f64| {
            let rounded = |step: i32| (rate * f64::from(step)).sin() + 2.0 + 1e-15 * noise(step);
            let mut predictor = Predictor::default();
            after(&mut predictor, by, (0..50).map(rounded));
            let mut squares = 0.0;
            for step in 50..200 {
                squares += (predictor.next()[0] - rounded(step)).powi(2);
                after(&mut predictor, by, [rounded(step)]);
            }
            squares
        };
        let [slow, fast] =
            [1e-4, 0.06].map(|rate| off(Continuation::Chosen, rate) / off(Continuation::Odd, rate));
        // the weights that lead nearer once do so mostly
        assert!(slow < 0.6, "slow motion is predicted with less rounding: {slow}");
        assert!((fast - 1.0).abs() < 1e-6, "fast motion as ever: {fast}");
    }

    #[test]
    fn where_solutions_jump_few_of_them_predict() {
        let smooth = |step: i32| 1.0 + (0.01 * f64::from(step)).sin();
        for size in [1e-9_f64, 1e-6, 1e-3] {
            let mut predictor = Predictor::default();
            after(&mut predictor, Continuation::Odd, (0..100).map(smooth));
            assert!(predictor.is_full());
            let mut worst = 0.0_f64;
            for step in 100..300 {
                let x = size.mul_add(noise(step), smooth(step));
                worst = worst.max((predictor.next()[0] - x).abs() * f64::from(u8::from(step > 110)));
                after(&mut predictor, Continuation::Odd, [x]);
            }
            assert!(worst < 1e-5 + 40.0 * size, "{size}: off by {worst:e}");
            after(&mut predictor, Continuation::Odd, (300..300 + 2 * WINDOW as i32).map(smooth));
            assert!(predictor.is_full(), "{size}: all are of use where jumps end");
        }
    }
}
