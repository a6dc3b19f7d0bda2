//! How long a Taylor step may be: as its last terms say, and as far as the series keep to their equation.

use crate::scalar::{Batch, Scalar};

/// A step that is shorter than this share of the time leads nowhere.
pub(crate) const SHORTEST: f64 = 4.0 * f64::EPSILON;

/// How long a step is to be.
#[derive(Clone, Copy)]
pub(crate) enum Length {
    /// So long.
    Exactly(f64),
    /// As long as its terms allow, and no longer than this.
    AtMost(f64),
}

/// At how many places within a step the series are held against their equation.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Look {
    /// At none: they keep to it at the end of the step, or nothing is asked of it.
    No,
    /// At its end.
    AtEnd,
    /// At many, for the series say nothing about how long it may be.
    Within,
}

impl Look {
    /// Where to look in a step, with its length as wanted, as taken and as the series would have it, and the defect at its end.
    #[inline(always)]
    pub(crate) fn at(length: Length, [step, natural]: [f64; 2], defect: f64) -> Self {
        match length {
            Length::AtMost(_) if step.is_finite() && natural > LONG * step.abs() => Self::Within,
            Length::AtMost(_) if step.is_finite() && !(defect <= 1.0) => Self::AtEnd,
            _ => Self::No,
        }
    }
}

/// Changes numbers by some units of roundoff, 4 to 8, to either side: each by others, from a place among all on, for equal changes of terms that cancel
/// cancel too.
#[inline(always)]
pub(crate) fn perturb<T: Batch>(numbers: &mut [T], from: usize) {
    for (place, x) in numbers.iter_mut().enumerate() {
        let share = (0.618_033_988_75 * (from + place) as f64) % 1.0;
        let by = if share < 0.5 { 4.0 + 8.0 * share } else { -8.0 * share };
        *x = *x * T::of(1.0 + by * T::EPSILON);
    }
}

/// How large something with a series is in a step, by its coefficients of orders 0 and 1 and by what it comes to.
#[inline(always)]
pub(crate) fn size<T: Batch>(zeroth: T, first: T, end: T, step: T) -> T {
    zeroth.abs() + end.abs() + (first * step).abs()
}

/// What rounding alone may leave of the derivative of a series: it tells by what it is at other numbers within rounding.
#[inline(always)]
pub(crate) fn noise<T: Batch>(rate: T, perturbed: T) -> T {
    let noise = (perturbed - rate).abs();
    T::select(noise.is_finite(), T::of(16.0) * noise, T::of(0.0))
}

/// How far series miss their equation, in units of what they may: the sum of all blocks, each of which may be off by a share of its size.
/// Not a number where they lead beyond what there are numbers for.
#[inline(always)]
pub(crate) fn defect<T: Batch>(
    blocks: &[usize],
    controls: Option<usize>,
    [sizes, misses]: [&[T]; 2],
    step: T,
    allowed: f64,
) -> T {
    let (zero, mut all, mut i) = (T::of(0.0), T::of(0.0), 0);
    for &length in blocks {
        if controls.is_some_and(|controls| i >= controls) {
            break;
        }
        let (mut size, mut miss, to) = (zero, zero, i + length);
        while i < to {
            (size, miss) = (size + sizes[i], miss + misses[i]);
            i += 1;
        }
        // nothing is no part of nothing
        let part = miss * step.abs() / (size * T::of(allowed));
        all = all + T::select(miss.le(zero), zero, part);
    }
    all
}

/// The terms of the series of a step, or of some side by side, which tell how long it may be.
pub(crate) trait Terms {
    /// Something for each of the steps that are side by side.
    type Each<X: Copy + Send + Sync>: Copy + AsRef<[X]> + AsMut<[X]>;
    /// The same number for each of them.
    fn each(value: f64) -> Self::Each<f64>;
    /// The order of the last.
    fn last(&self) -> usize;
    /// The lengths of the blocks of what has a series that have a unit in common.
    fn blocks(&self) -> &[usize];
    /// Where what is held begins among what has a series.
    fn held(&self) -> usize;
    /// The largest coefficient of one order in a block that begins there.
    fn largest(&self, order: usize, from: usize, length: usize) -> Self::Each<f64>;

    /// What its last terms may be.
    fn rule(&self) -> Rule;
    /// How far the series miss their equation at times after the start, in a step of this length: see [`defect`].
    fn defect(&mut self, at: &Self::Each<f64>, step: &Self::Each<f64>) -> Self::Each<f64>;

    /// The largest defect at the places looked at: the end of the step, or many of them where there are.
    #[inline(always)]
    fn largest_defect(&mut self, steps: &Self::Each<f64>, look: &[Look]) -> Self::Each<f64> {
        let mut largest = self.defect(steps, steps);
        for share in PLACES {
            if !look.contains(&Look::Within) {
                break;
            }
            let mut at = *steps;
            for at in at.as_mut() {
                *at *= share;
            }
            let defects = self.defect(&at, steps);
            for ((largest, defect), look) in largest.as_mut().iter_mut().zip(defects.as_ref()).zip(look) {
                // what is not a number is larger than all, also than what comes after
                if *look == Look::Within && *largest <= 1.0 && !(defect <= largest) {
                    *largest = *defect;
                }
            }
        }
        largest
    }

    /// The longest steps up to these over which the series keep to their equation wherever it is looked at. What jumps is closed in on, and
    /// crossed by a step that changes no more than the tolerance.
    #[inline(always)]
    fn shorten(&mut self, steps: &Self::Each<f64>, look: &[Look], time: &[f64]) -> Checked<Self::Each<f64>> {
        let Rule { accuracy, .. } = self.rule();
        let least =
            |lane: usize| (accuracy * steps.as_ref()[lane].abs()).max(2.0 * SHORTEST * time[lane].abs());
        let (mut low, mut high, mut trial) = (*steps, *steps, *steps);
        let mut shares = Self::each(f64::INFINITY);
        for (lane, trial) in trial.as_mut().iter_mut().enumerate() {
            *trial = if look[lane] == Look::No { 0.0 } else { *trial };
        }
        // these may be right but for rounding
        let mut defects = self.largest_defect(&trial, look);
        for (lane, trial) in trial.as_ref().iter().enumerate() {
            if *trial != 0.0 && !(defects.as_ref()[lane] <= 1.0) {
                low.as_mut()[lane] = 0.0;
            }
        }
        loop {
            for (lane, trial) in trial.as_mut().iter_mut().enumerate() {
                let [low, high] = [low.as_ref()[lane], high.as_ref()[lane]];
                *trial = if (high - low).abs() > 0.5 * least(lane) { low + 0.5 * (high - low) } else { 0.0 };
            }
            if trial.as_ref().iter().all(|trial| *trial == 0.0) {
                break;
            }
            defects = self.largest_defect(&trial, look);
            for (lane, (trial, defect)) in trial.as_ref().iter().zip(defects.as_ref()).enumerate() {
                let [low, high] = [&mut low.as_mut()[lane], &mut high.as_mut()[lane]];
                if *trial == 0.0 {
                    continue;
                }
                if *defect <= 1.0 {
                    *low = *trial;
                }
                // where it grows little by little there is no more to be had
                if !(*defect <= 1e-3) {
                    *high = *trial;
                }
            }
        }
        let mut shorter = low;
        for (lane, step) in shorter.as_mut().iter_mut().enumerate() {
            let whole = steps.as_ref()[lane];
            if step.abs() < least(lane) {
                *step = if least(lane) < whole.abs() { least(lane).copysign(whole) } else { whole };
            }
            if *step != whole {
                shares.as_mut()[lane] = step.abs() / least(lane);
            }
        }
        Checked { steps: shorter, shares }
    }

    /// How long the step is, after one of the length `before`, and how long the series would have it.
    #[inline(always)]
    fn step(&self, before: &[Option<f64>], length: &[Length]) -> [Self::Each<f64>; 2] {
        let mut guess = Self::each(0.0);
        for ((lane, guess), length) in guess.as_mut().iter_mut().enumerate().zip(length) {
            *guess = match length {
                Length::Exactly(step) => step.abs(),
                Length::AtMost(_) => before[lane].map_or_else(|| self.first_guess(lane), f64::abs),
            };
        }
        let is_chosen = length.iter().any(|length| matches!(length, Length::AtMost(_)));
        let mut steps = if is_chosen { self.longest_step(guess.as_ref()) } else { guess };
        let mut natural = steps;
        for (lane, step) in steps.as_mut().iter_mut().enumerate() {
            *step = match length[lane] {
                Length::Exactly(step) => step,
                Length::AtMost(most) => {
                    let longest = if guess.as_ref()[lane] < f64::INFINITY { *step } else { f64::INFINITY };
                    // what is zero at its start in every unit that changes has no size there
                    let longest = if longest < f64::INFINITY { longest } else { self.first_guess(lane) };
                    natural.as_mut()[lane] = longest;
                    if longest < most.abs() { longest.copysign(most) } else { most }
                }
            };
        }
        [steps, natural]
    }

    /// How large the step may be for the last two terms to be as small as the order can make them: `e^{−2N}` of what the series is of, which is
    /// the largest of its first three terms in a step of the length that is guessed.
    ///
    /// That is the rule of Jorba and Zou, Experimental Mathematics 14 (2005) 99, for each unit by itself. Infinite where these terms are zero.
    #[inline(always)]
    fn longest_step(&self, guess: &[f64]) -> Self::Each<f64> {
        let last = self.last();
        let mut least = [Self::each(f64::INFINITY), Self::each(f64::INFINITY)];
        let mut from = 0;
        for &length in self.blocks() {
            if from >= self.held() {
                break;
            }
            // not by a map, whose closure would be compiled apart, for any processor
            let (zeroth, first) = (self.largest(0, from, length), self.largest(1, from, length));
            let second = self.largest(2, from, length);
            for (k, least) in [last - 1, last].into_iter().zip(&mut least) {
                let largest = self.largest(k, from, length);
                for (lane, least) in least.as_mut().iter_mut().enumerate() {
                    let (zeroth, first) = (zeroth.as_ref()[lane], first.as_ref()[lane]);
                    let (second, largest) = (second.as_ref()[lane], largest.as_ref()[lane]);
                    let guess = guess[lane];
                    let size = zeroth.max(first * guess).max(second * guess * guess);
                    let ratio = size / largest;
                    // zero by zero says nothing, nor does what is below all numbers
                    *least = if size > 0.0 && ratio < *least { ratio } else { *least };
                }
            }
            from += length;
        }
        let n = last as f64;
        let [mut steps, other] = least;
        for (step, other) in steps.as_mut().iter_mut().zip(other.as_ref()) {
            *step = root(*step, n - 1.0).min(root(*other, n)) * self.rule().margin;
        }
        steps
    }

    /// A first guess of the step's length, by the first term that is not zero and the last ones.
    #[cold]
    fn first_guess(&self, lane: usize) -> f64 {
        let mut guess = f64::INFINITY;
        let mut from = 0;
        for &length in self.blocks() {
            for k in [self.last() - 1, self.last()] {
                let of = |k: usize| self.largest(k, from, length).as_ref()[lane];
                if let Some(first) = (0..k).find(|&k| of(k) > 0.0) {
                    guess = guess.min(root(of(first) / of(k), (k - first) as f64));
                }
            }
            from += length;
        }
        guess * self.rule().margin
    }
}

/// How a step is chosen that ends with terms of some order.
#[derive(Clone, Copy)]
pub(crate) struct Rule {
    /// How much shorter a step is than the series converges.
    margin: f64,
    /// The error of a step, relative to the size of what it is of.
    accuracy: f64,
    /// How much the change of something in a step may be off, relative to its size: the last term's derivative is as many times larger as its order.
    pub(crate) allowed: f64,
}

impl Rule {
    /// For series that end with this order, in numbers of this roundoff.
    pub(crate) fn new(order: usize, unit: f64) -> Self {
        let last = order as f64;
        let accuracy = Scalar::exp(2.0 - 2.0 * last).max(64.0 * unit);
        Self { margin: Scalar::exp(-0.7 / (last - 1.0) - 2.0), accuracy, allowed: (last + 1.0) * accuracy }
    }
}

/// Steps that have been looked at, and how many of the least ones each is as long as: infinitely many if it was left as it is.
pub(crate) struct Checked<E> {
    pub(crate) steps: E,
    pub(crate) shares: E,
}

/// A step is looked at at many places where the series would have it so many times as long, as polynomials would.
const LONG: f64 = 1e6;

/// The places looked at within a step, far from all that is periodic: the multiples of the golden section without what is whole of them.
const PLACES: [f64; 16] = [
    0.618, 0.236, 0.854, 0.472, 0.090, 0.708, 0.326, 0.944, 0.562, 0.180, 0.798, 0.416, 0.034, 0.652, 0.271,
    0.889,
];

/// `x^{1/k}`, also of what is infinite.
#[inline(always)]
fn root(x: f64, k: f64) -> f64 {
    if x < f64::INFINITY { Scalar::powf(x, 1.0 / k) } else { x }
}
