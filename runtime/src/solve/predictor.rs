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
use crate::scalar::rows::{Formula, Piece, Row, computed};
use crate::scalar::simd::lanes::{Portable, Processor};
use crate::scalar::{Batch, Components, Mask, Real, Scalar};

/// How many differences are kept.
pub(crate) const DIFFERENCES: usize = 10;
/// How many of their sums may be in registers in long runs.
const HALF: usize = DIFFERENCES / 2;
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
const PATIENCE: [u8; 2] = [1, 32];

/// The differences of the last solutions that point to the next one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Predictor<T: Batch, U> {
    /// The sums of differences.
    sums: [Row<T, U, 0>; DIFFERENCES],
    /// How far they are known, in each lane.
    extents: T::Each<Extent>,
}

/// How far the differences of one lane are known.
#[derive(Clone, Copy, Debug)]
struct Extent {
    /// How many differences there are. All others are zero, but for the sums from the [most in any lane](Predictor::count) on, which are not to be
    /// read.
    order: u8,
    /// For so many steps no difference more is looked for.
    wait: u8,
    /// For so many after the next one that is of no use.
    patience: u8,
}

/// That of no solution.
const NOTHING: Extent = Extent { order: 0, wait: 0, patience: PATIENCE[0] };

/// Knows no solution.
impl<T: Batch, U: Components<T>> Default for Predictor<T, U> {
    fn default() -> Self {
        Self { sums: [Row::new(U::splat(T::of(0.0))); DIFFERENCES], extents: T::all(NOTHING) }
    }
}

impl<T: Batch, U: Components<T>> Predictor<T, U> {
    /// How many differences there are in any lane.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        let (mut count, mut lane) = (0, 0);
        while lane < T::LANES {
            count = count.max(self.extents.as_ref()[lane].order);
            lane += 1;
        }
        // no more than there is place for, which the compiler then knows too
        usize::from(count).min(DIFFERENCES)
    }

    /// Whether all differences are there, in all lanes.
    #[inline(always)]
    pub(crate) fn is_full(&self) -> bool {
        let (mut is_full, mut lane) = (true, 0);
        while lane < T::LANES {
            is_full &= usize::from(self.extents.as_ref()[lane].order) >= DIFFERENCES;
            lane += 1;
        }
        is_full
    }

    /// How many differences more there is place for.
    #[inline(always)]
    pub(crate) fn room(&self) -> u64 {
        (DIFFERENCES - self.count()).max(1) as u64
    }

    /// Forgets all solutions.
    #[inline(always)]
    pub(crate) fn forget(&mut self) {
        self.extents = T::all(NOTHING);
    }

    /// The latest solution.
    pub(crate) fn latest(&self) -> U {
        let [first, second, ..] = &self.sums;
        if self.count() > 1 { less::<T, _>(&first.components, &second.components) } else { first.components }
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
        let (low, high) = self.sums.split_at_mut(HALF);
        followed::<P, _, _, _>(low, high, missed)
    }

    /// The sums for many steps of [`follow`](Wide::follow), where they are taken faster so.
    #[inline(always)]
    pub(crate) fn widened<P: Processor>(&self) -> Option<Wide<T, U>> {
        if !const { P::FOURS && T::PAIRS && U::LENGTH % 4 == 3 } {
            return None;
        }
        let nothing = Row::new(U::splat(T::of(0.0)));
        let mut wide = Wide { low: Half([nothing; HALF]), high: Half([nothing; DIFFERENCES - HALF]) };
        let mut k = 0;
        while k < DIFFERENCES {
            wide.row(k).components = self.sums[k].components;
            k += 1;
        }
        Some(wide)
    }

    /// Takes them back.
    #[inline(always)]
    pub(crate) fn take(&mut self, wide: &mut Wide<T, U>) {
        let mut k = 0;
        while k < DIFFERENCES {
            self.sums[k].components = wide.row(k).components;
            k += 1;
        }
    }

    /// Takes the first solution.
    #[inline(always)]
    pub(crate) fn begin(&mut self, solution: &U) {
        self.sums[0].components = *solution;
        self.extents = T::all(Extent { order: 1, ..NOTHING });
    }

    /// Takes one more solution if no difference more is looked for, and says whether it did: what [`learn`](Self::learn) does then, of one lane.
    #[inline(always)]
    pub(crate) fn keep_to(&mut self, solution: &U, off: T) -> bool {
        let extent = &mut self.extents.as_mut()[0];
        if extent.wait == 0 || !off.le(T::of(LOST)).all() {
            return false;
        }
        extent.wait -= 1;
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
        let (full, one, nothing) = (T::of(DIFFERENCES as f64), T::of(1.0), T::of(0.0));
        let good = good | weighted::<T, _>(weights, &missed).le(T::of(SMALL));
        if good.all() && self.is_full() {
            self.follow::<Portable>(&missed);
            return;
        }
        let [order, wait, patience] = self.extents();
        let follows = good & full.le(order);
        let waits = !follows & nothing.lt(wait) & off.le(T::of(LOST));
        let looks = !follows & !waits;
        let wait = T::select(waits, wait - one, T::select(looks, nothing, wait));
        let order = T::select(looks & order.lt(full), order + one, order);
        // the compiler knows that −0 is nothing to add
        let (mut sum, mut k) = (U::splat(T::of(-0.0)), self.count());
        // so many differences there are from each one on
        let (mut there, mut count) = (order - T::of(k as f64), k);
        if k < DIFFERENCES && nothing.lt(there).any() {
            self.sums[k].components = scaled(self.gain(k, there, follows), &missed);
            count += 1;
        }
        while k > 0 {
            k -= 1;
            there = there + one;
            self.add(k, &mut sum, self.gain(k, there, follows), &missed);
        }
        let useful = self.drop_useless(weights, looks, order, count);
        let is_useless = useful.lt(order);
        let [least, most] = PATIENCE.map(|steps| T::of(f64::from(steps)));
        let (shorter, longer) = (T::of(0.5) * patience, patience + patience);
        let wait = T::select(is_useless, patience, wait);
        let patience = T::select(
            is_useless,
            T::select(most.lt(longer), most, longer),
            T::select(!looks, patience, T::select(shorter.lt(least), least, shorter)),
        );
        self.extend([useful, wait, patience]);
    }

    /// Order, wait and patience as numbers.
    #[inline(always)]
    fn extents(&self) -> [T; 3] {
        let (mut numbers, mut lane) = ([T::of(0.0); 3], 0);
        while lane < T::LANES {
            let Extent { order, wait, patience } = self.extents.as_ref()[lane];
            numbers[0].set_lane(lane, <T::Number as Scalar>::of(order.into()));
            numbers[1].set_lane(lane, <T::Number as Scalar>::of(wait.into()));
            numbers[2].set_lane(lane, <T::Number as Scalar>::of(patience.into()));
            lane += 1;
        }
        numbers
    }

    /// Sets them.
    #[inline(always)]
    fn extend(&mut self, [order, wait, patience]: [T; 3]) {
        let mut lane = 0;
        while lane < T::LANES {
            self.extents.as_mut()[lane] = Extent {
                order: (order.lane(lane).to_f64() as u8).min(DIFFERENCES as u8),
                wait: wait.lane(lane).to_f64() as u8,
                patience: patience.lane(lane).to_f64() as u8,
            };
            lane += 1;
        }
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

    /// Drops in these lanes the highest differences that are neither small nor smaller than the ones before them. Returns how many there are then,
    /// of `order`, and no more than `count` in any lane.
    #[inline(always)]
    fn drop_useless(&mut self, weights: &U, lanes: T::Mask, mut order: T, count: usize) -> T {
        let mut k = count;
        while k > 1 {
            k -= 1;
            // that they are there the compiler does not see
            let [Some(before), Some(highest)] = [k - 1, k].map(|k| self.sums.get(k)) else { return order };
            let highest = highest.components;
            let before = less::<T, _>(&before.components, &highest);
            let [size, before] = [weighted::<T, _>(weights, &highest), weighted::<T, _>(weights, &before)];
            let is_useful = size.le(T::of(SMALL)) | size.le(T::of(USEFUL) * before);
            let is_there = T::of(k as f64).lt(order);
            let useless = lanes & is_there & order.le(T::of(k as f64 + 1.0)) & !is_useful;
            if useless.any() {
                order = T::select(useless, T::of(k as f64), order);
                for sum in self.sums.iter_mut().take(k + 1) {
                    let rest = less::<T, _>(&sum.components, &highest);
                    sum.components = select(useless, &rest, &sum.components);
                }
            } else if is_there.all() {
                break;
            }
        }
        order
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub(crate) fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        let mut extents = self.extents();
        extents.iter_mut().for_each(|number| visit(core::slice::from_mut(number)));
        self.extend(extents);
        self.sums.iter_mut().for_each(|sum| visit(sum.components.as_mut()));
    }
}

/// The sums of a [`Predictor`], each with a number after it: three doubles and that one are loaded together.
pub(crate) struct Wide<T, U> {
    low: Half<T, U>,
    high: Half<T, U>,
}

#[repr(align(32))]
struct Half<T, U>([Row<T, U, 1>; HALF]);

impl<T: Batch, U: Components<T>> Wide<T, U> {
    /// One of the sums.
    #[inline(always)]
    fn row(&mut self, k: usize) -> &mut Row<T, U, 1> {
        if k < HALF { &mut self.low.0[k] } else { &mut self.high.0[k - HALF] }
    }

    /// Leaves half of the sums in memory. Of sixteen registers all would take ten, and leave too few for the step itself.
    #[inline(always)]
    pub(crate) fn keep_half_in_memory(&mut self) {
        core::hint::black_box(&mut self.high);
    }

    /// As [`Predictor::follow`].
    #[inline(always)]
    pub(crate) fn follow<P: Processor>(&mut self, missed: &U) -> U {
        followed::<P, _, _, _>(&mut self.low.0, &mut self.high.0, missed)
    }
}

/// The prediction after the solution that was missed by so much.
#[inline(always)]
fn followed<P: Processor, T: Batch, U: Components<T>, const SPARE: usize>(
    low: &mut [Row<T, U, SPARE>],
    high: &mut [Row<T, U, SPARE>],
    missed: &U,
) -> U {
    let mut next = computed::<P, _, _, _>(&mut Follow { low, high, missed }, missed);
    let mut i = 0;
    while i < U::LENGTH {
        next.as_mut()[i] = T::of(ALL_GAINS[0]).mul_add(missed.as_ref()[i], next.as_ref()[i]);
        i += 1;
    }
    next
}

/// [`followed`], piece by piece. Computed is the first sum without what was missed: what that adds is added by itself, since the next step waits
/// for it.
struct Follow<'a, T, U, const SPARE: usize> {
    low: &'a mut [Row<T, U, SPARE>],
    high: &'a mut [Row<T, U, SPARE>],
    missed: &'a U,
}

impl<T: Batch, U: Components<T>, const SPARE: usize> Formula<T> for Follow<'_, T, U, SPARE> {
    const SPARE: usize = SPARE;

    #[inline(always)]
    fn at<X: Piece<T>>(&mut self, i: usize) -> X {
        let missed = X::gathered(self.missed.as_ref(), i);
        let mut k = DIFFERENCES - 1;
        let mut sum = X::of(&self.high[k - HALF], i);
        sum.plus(T::of(ALL_GAINS[k]), missed).put(&mut self.high[k - HALF], i);
        while k > 0 {
            k -= 1;
            let row = if k < HALF { &mut self.low[k] } else { &mut self.high[k - HALF] };
            sum = sum.and(X::of(row, i));
            sum.plus(T::of(ALL_GAINS[k]), missed).put(row, i);
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
        predictor.extents[0].wait = 4;
        assert_eq!(after(&mut predictor, (4..8).map(other)), 0);
        assert_eq!((predictor.count(), predictor.extents[0].wait), (4, 0));
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
        after(&mut predictor, (300..300 + i32::from(PATIENCE[1]) + 3 * DIFFERENCES as i32).map(smooth));
        assert!(predictor.is_full(), "{}", predictor.count());
        assert_eq!(predictor.extents[0].patience, PATIENCE[0]);
    }
}
