//! Where the solutions of earlier steps point.
//!
//! Successive solutions are samples of a smooth course: the polynomial through the latest of them, continued by one step, is the next one to many
//! digits. With backward differences, `∇⁰x = x` and `∇ᵏ⁺¹x = ∇ᵏx − ∇ᵏx` of the step before, it is `x + ∇x + ∇²x + …`. What is kept are the sums of the
//! differences from each order on, continued by one step, of which the first is the prediction:
//!
//! ```text
//! s_k = ∇ᵏx + ∇ᵏ⁺¹x + … + ∇⁹x        s_k ← s_{k+1} + s_k + g_k (x − s_0), from the highest order down, with the next solution x
//! ```
//!
//! With all `g_k = 1` that is interpolation, and rounding of the solutions counts up to two hundredfold in what it predicts. Where the prediction is
//! off by little more than that, the highest differences follow more slowly, by [`GAINS`]: then rounding counts a quarter of that, at the price of
//! twice the tenth difference. That is what a polynomial near to twice as many solutions does, with half of the memory.
//!
//! Where controls jump from step to step, all differences but a few are made of the jumps. Whether one more is of use takes longer to find out
//! than to solve the equation: after each that is not, it is asked [twice as many steps](PATIENCE) later, as in multistep methods of variable
//! order.

use super::stopping::{select, weighted};
use super::{LOST, added, less};
use crate::scalar::simd::lanes::{Portable, Processor};
use crate::scalar::terms::{Formula, Piece, Term, computed};
use crate::scalar::{Batch, Components, Mask, Real};

/// How many differences are kept.
pub(crate) const DIFFERENCES: usize = 10;
/// How much of what a prediction is off goes into the highest differences.
const GAINS: [f64; DIFFERENCES] = [1.0, 1.0, 1.0, 1.0, 0.8491, 1.1077, 0.3899, 0.9992, 0.0282, 0.4321];
/// Their sums from each order on.
const ALL_GAINS: [f64; DIFFERENCES] = {
    let mut all = GAINS;
    let mut k = DIFFERENCES - 1;
    while k > 0 {
        k -= 1;
        all[k] += all[k + 1];
    }
    all
};
/// Differences up to here may be little more than rounding.
const SMALL: f64 = 1e-12;
/// A difference that is not smaller than the one before it by this factor is of no use.
const USEFUL: f64 = 0.8;

/// For how many steps at least and at most no difference more is looked for, after one that was of no use.
const PATIENCE: [f64; 2] = [1.0, 32.0];

/// The differences of the last solutions that point to the next one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Predictor<T: Batch, U> {
    /// The sums of differences.
    sums: [Term<T, U>; DIFFERENCES],
    /// How many differences there are. All others are zero.
    order: T,
    /// For so many steps no difference more is looked for.
    wait: T,
    /// For so many after the next one that is of no use.
    patience: T,
    /// The most that there are in any lane: the sums from here on are not to be read.
    count: u8,
    /// Whether all are there in all lanes.
    is_full: bool,
}

/// Knows no solution.
impl<T: Batch, U: Components<T>> Default for Predictor<T, U> {
    fn default() -> Self {
        let sums = [Term::new(U::splat(T::of(0.0))); DIFFERENCES];
        let [nothing, patience] = [0.0, PATIENCE[0]].map(T::of);
        Self { sums, order: nothing, wait: nothing, patience, count: 0, is_full: false }
    }
}

impl<T: Batch, U: Components<T>> Predictor<T, U> {
    /// How many differences there are in any lane.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        // no more than there is place for, which the compiler then knows too
        usize::from(self.count).min(DIFFERENCES)
    }

    /// Whether all differences are there.
    #[inline(always)]
    pub(crate) fn is_full(&self) -> bool {
        self.is_full
    }

    /// How many differences more there is place for.
    #[inline(always)]
    pub(crate) fn room(&self) -> u64 {
        (DIFFERENCES - self.count()).max(1) as u64
    }

    /// Forgets all solutions.
    #[inline(always)]
    pub(crate) fn forget(&mut self) {
        (self.order, self.count, self.is_full) = (T::of(0.0), 0, false);
        (self.wait, self.patience) = (T::of(0.0), T::of(PATIENCE[0]));
    }

    /// The latest solution.
    pub(crate) fn latest(&self) -> U {
        let [first, second, ..] = &self.sums;
        if self.count > 1 { less::<T, _>(&first.components, &second.components) } else { first.components }
    }

    /// The next solution, if there is any before it.
    #[inline(always)]
    pub(crate) fn next(&self) -> U {
        self.sums[0].components
    }

    /// Takes the solution that differs from the [next](Self::next) by so much, where that is little and all differences are there. Returns the
    /// one after it.
    #[inline(always)]
    pub(crate) fn follow<P: Processor>(&mut self, missed: &U) -> U {
        let mut next = computed::<P, _, _>(&mut Follow { sums: &mut self.sums, missed }, missed);
        let mut i = 0;
        while i < U::LENGTH {
            next.as_mut()[i] = T::of(ALL_GAINS[0]).mul_add(missed.as_ref()[i], next.as_ref()[i]);
            i += 1;
        }
        next
    }

    /// Takes the first solution.
    #[inline(always)]
    pub(crate) fn begin(&mut self, solution: &U) {
        self.sums[0].components = *solution;
        (self.order, self.count) = (T::of(1.0), 1);
    }

    /// Where no difference more is looked for: not yet, and the prediction was off by no more than a guess may be.
    #[inline(always)]
    fn waits(&self, off: T) -> T::Mask {
        T::of(0.0).lt(self.wait) & off.le(T::of(LOST))
    }

    /// Takes one more solution if no difference more is looked for, and says whether it did: what [`learn`](Self::learn) does then, of one lane.
    #[inline(always)]
    pub(crate) fn keep_to(&mut self, solution: &U, off: T) -> bool {
        if !self.waits(off).all() {
            return false;
        }
        self.wait = self.wait - T::of(1.0);
        let missed = less::<T, _>(solution, &self.sums[0].components);
        // the compiler knows that −0 is nothing to add
        let (mut sum, mut there, mut k) = (U::splat(T::of(-0.0)), T::of(0.0), self.count());
        while k > 0 {
            k -= 1;
            there = there + T::of(1.0);
            self.add(k, &mut sum, there, &missed);
        }
        true
    }

    /// Takes one more solution that was predicted so far off, and keeps the differences that are of use: their sizes count by these weights. In
    /// the lanes where the prediction was `good` it [follows](Self::follow), as where little was missed.
    #[inline(always)]
    pub(crate) fn learn(&mut self, weights: &U, solution: &U, good: T::Mask, off: T) {
        let missed = less::<T, _>(solution, &self.sums[0].components);
        let (full, one) = (T::of(DIFFERENCES as f64), T::of(1.0));
        let good = good | weighted::<T, _>(weights, &missed).le(T::of(SMALL));
        let follows = good & full.le(self.order);
        if follows.all() && self.is_full {
            self.follow::<Portable>(&missed);
            return;
        }
        let waits = !follows & self.waits(off);
        let looks = !follows & !waits;
        self.wait = T::select(waits, self.wait - one, T::select(looks, T::of(0.0), self.wait));
        let order = T::select(looks, self.order + one, self.order);
        self.order = T::select(full.le(order), full, order);
        // the compiler knows that −0 is nothing to add
        let (mut sum, mut k) = (U::splat(T::of(-0.0)), self.count());
        // so many differences there are from each one on
        let mut there = self.order - T::of(k as f64);
        if looks.any() && k < DIFFERENCES {
            self.sums[k].components = scaled(self.gain(k, there, follows), &missed);
            self.count += 1;
        }
        while k > 0 {
            k -= 1;
            there = there + one;
            self.add(k, &mut sum, self.gain(k, there, follows), &missed);
        }
        let order = self.order;
        self.drop_useless(weights, looks);
        let is_useless = self.order.lt(order);
        let [least, most] = PATIENCE.map(T::of);
        let (shorter, longer) = (T::of(0.5) * self.patience, self.patience + self.patience);
        self.wait = T::select(is_useless, self.patience, self.wait);
        self.patience = T::select(
            is_useless,
            T::select(most.lt(longer), most, longer),
            T::select(!looks, self.patience, T::select(shorter.lt(least), least, shorter)),
        );
        self.is_full = self.count() == DIFFERENCES && full.le(self.order).all();
    }

    /// Adds to a sum of differences the one before it, as it was, and so many times what was missed.
    #[inline(always)]
    fn add(&mut self, k: usize, before: &mut U, gain: T, missed: &U) {
        let old = &mut self.sums[k].components;
        *before = added::<T, _>(before, old);
        let mut i = 0;
        while i < U::LENGTH {
            old.as_mut()[i] = gain.mul_add(missed.as_ref()[i], before.as_ref()[i]);
            i += 1;
        }
    }

    /// How much of what was missed goes into a sum of so many differences.
    #[inline(always)]
    fn gain(&self, k: usize, differences: T, follows: T::Mask) -> T {
        if const { T::LANES == 1 } {
            return differences;
        }
        let there = T::select(T::of(0.0).lt(differences), differences, T::of(0.0));
        T::select(follows, T::of(ALL_GAINS[k]), there)
    }

    /// Drops in these lanes the highest differences that are neither small nor smaller than the ones before them.
    #[inline(always)]
    fn drop_useless(&mut self, weights: &U, lanes: T::Mask) {
        let mut k = self.count();
        while k > 1 {
            k -= 1;
            // that they are there the compiler does not see
            let [Some(before), Some(highest)] = [k - 1, k].map(|k| self.sums.get(k)) else { return };
            let highest = highest.components;
            let before = less::<T, _>(&before.components, &highest);
            let [size, before] = [weighted::<T, _>(weights, &highest), weighted::<T, _>(weights, &before)];
            let is_useful = size.le(T::of(SMALL)) | size.le(T::of(USEFUL) * before);
            let is_there = T::of(k as f64).lt(self.order);
            let useless = lanes & is_there & self.order.le(T::of(k as f64 + 1.0)) & !is_useful;
            if useless.any() {
                self.order = T::select(useless, T::of(k as f64), self.order);
                for sum in self.sums.iter_mut().take(k + 1) {
                    let rest = less::<T, _>(&sum.components, &highest);
                    sum.components = select(useless, &rest, &sum.components);
                }
            } else if is_there.all() {
                break;
            }
            if !T::of(k as f64).lt(self.order).any() {
                self.count = k as u8;
            }
        }
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub(crate) fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        let mut count = [T::of(f64::from(self.count))];
        visit(&mut count);
        // the same in all lanes
        self.count = (count[0].lane(0).to_f64() as u8).min(DIFFERENCES as u8);
        for number in [&mut self.order, &mut self.wait, &mut self.patience] {
            visit(core::slice::from_mut(number));
        }
        self.sums.iter_mut().for_each(|sum| visit(sum.components.as_mut()));
        self.is_full = self.count() == DIFFERENCES && T::of(DIFFERENCES as f64).le(self.order).all();
    }
}

/// [`Predictor::follow`], piece by piece. Computed is the first sum without what was missed: what that adds is added by itself, since the next step
/// waits for it.
struct Follow<'a, T: Batch, U> {
    sums: &'a mut [Term<T, U>; DIFFERENCES],
    missed: &'a U,
}

impl<T: Batch, U: Components<T>> Formula<T> for Follow<'_, T, U> {
    #[inline(always)]
    fn at<X: Piece<T>>(&mut self, i: usize) -> X {
        let missed = X::gathered(self.missed.as_ref(), i);
        let mut k = DIFFERENCES - 1;
        let mut sum = X::of(&self.sums[k], i);
        sum.plus(T::of(ALL_GAINS[k]), missed).put(&mut self.sums[k], i);
        while k > 0 {
            k -= 1;
            sum = sum.and(X::of(&self.sums[k], i));
            sum.plus(T::of(ALL_GAINS[k]), missed).put(&mut self.sums[k], i);
        }
        sum
    }
}

/// So many times an unknown.
#[inline(always)]
fn scaled<T: Batch, U: Components<T>>(factor: T, of: &U) -> U {
    let mut scaled = *of;
    let mut i = 0;
    while i < U::LENGTH {
        scaled.as_mut()[i] = factor * of.as_ref()[i];
        i += 1;
    }
    scaled
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;

    /// After these solutions, one after the other.
    fn after(predictor: &mut Predictor<f64, [f64; 1]>, solutions: impl IntoIterator<Item = f64>) -> u32 {
        let mut learned = 0;
        for x in solutions {
            if predictor.count() == 0 {
                predictor.begin(&[x]);
            } else if !predictor.keep_to(&[x], 0.0) {
                predictor.learn(&[1.0], &[x], false, 0.0);
                learned += 1;
            }
        }
        learned
    }

    fn smooth(step: i32) -> f64 {
        1.0 + (0.01 * f64::from(step)).sin()
    }

    /// Between −1 and 1, with no pattern.
    fn noise(step: i32) -> f64 {
        2.0 * (f64::from(step) * 0.618_033_988_75).rem_euclid(1.0) - 1.0
    }

    #[test]
    fn differences_that_are_kept_to_interpolate() {
        let cubic = |step: i32| 0.01_f64.mul_add(f64::from(step), 1.0).powi(3);
        let other = |step: i32| 2.0 - 3.0 * cubic(step);
        let mut predictor = Predictor::default();
        after(&mut predictor, (0..4).map(cubic));
        assert!((predictor.next()[0] - cubic(4)).abs() < 1e-14);
        // as many as there are differences lie on the other one, whatever was before
        predictor.wait = 4.0;
        assert_eq!(after(&mut predictor, (4..8).map(other)), 0);
        assert_eq!((predictor.count(), predictor.wait), (4, 0.0));
        let off = (predictor.next()[0] - other(8)).abs();
        assert!(off < 1e-13, "{off:e}");
    }

    #[test]
    fn jumps_are_looked_through_now_and_then() {
        for size in [1e-9_f64, 1e-6, 1e-3] {
            let mut predictor = Predictor::default();
            after(&mut predictor, (0..100).map(|k| size.mul_add(noise(k), smooth(k))));
            let jumping = (100..500).map(|k| size.mul_add(noise(k), smooth(k)));
            let learned = after(&mut predictor, jumping);
            assert!((6..60).contains(&learned), "{size}: {learned} of 400");
            assert!((1..DIFFERENCES).contains(&predictor.count()), "{size}: {}", predictor.count());
            // nor is the prediction off by much more than the jumps
            let off = (predictor.next()[0] - smooth(500)).abs();
            assert!(off < 100.0 * size, "{size}: {off:e}");
        }
    }

    #[test]
    fn all_differences_come_back_where_jumps_end() {
        let mut predictor = Predictor::default();
        after(&mut predictor, (0..300).map(|k| 1e-6_f64.mul_add(noise(k), smooth(k))));
        assert!(!predictor.is_full(), "{}", predictor.count());
        after(&mut predictor, (300..300 + PATIENCE[1] as i32 + 3 * DIFFERENCES as i32).map(smooth));
        assert!(predictor.is_full(), "{}", predictor.count());
        assert_eq!(predictor.patience, PATIENCE[0]);
    }
}
