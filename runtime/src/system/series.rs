//! Power series of a motion: what is generated, and how their coefficients are computed.

use core::fmt;

use super::System;
use crate::kernel::Blocks;
use crate::scalar::simd::lanes::Processor;
use crate::scalar::{Components, LongWork, Real, Scalar};

/// The highest order of a Taylor step: more than doubles have digits for.
pub(crate) const MOST_COEFFICIENTS: usize = 32;

/// The power series of a system's motion, by recurrences. Implemented by descriptions with the key `taylor`.
///
/// What has a series are the element of the group by which a step moves the configuration, its translations of the spaces of advected parameters, and what the
/// motion is made of. Each product of two series is a *lane*; all lanes are summed side by side.
#[diagnostic::on_unimplemented(
    message = "there are no power series of the motion of `{Self}`",
    note = "they are generated with the key `taylor` in the description"
)]
pub trait PowerSeries: System {
    /// What depends on state, time and control at the start of a step.
    type Kept<T: Scalar>: Components<T>;
    /// A number for everything that has a series.
    type Coefficients<T: Scalar>: Components<T>;
    /// A number for each lane, and some that are nobody's: so many that they fill registers.
    type Lanes<T: Scalar>: Components<T>;
    /// The velocity at the start, where it has a series; else nothing.
    type Velocity<T: Scalar>: Components<T>;

    /// The lengths of the blocks of what has a series that have a unit in common.
    const BLOCKS: Blocks;

    /// The velocity at the start of a step, if it has a series.
    fn start_velocity(
        &self,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
    ) -> Self::Velocity<Self::Scalar>;
    /// The coefficients of order 0.
    fn leading<T: Scalar>(
        parameters: &Self::Parameters<T>,
        state: &Self::StateComponents<T>,
        time: T,
        control: &Self::ControlComponents<T>,
        velocity: &Self::Velocity<T>,
    ) -> Leading<Self, T>;
    /// The coefficients of one order, from those of what has a series and the lanes' sums of lower ones.
    fn next<T: Scalar>(
        kept: &Self::Kept<T>,
        coefficients: &Self::Coefficients<T>,
        sums: &Self::Lanes<T>,
        order: T,
    ) -> Next<Self, T>;
    /// The state where the step has come to.
    fn finish<T: Scalar>(kept: &Self::Kept<T>, end: &Self::Coefficients<T>) -> Self::StateComponents<T>;
}

/// What looks at a system's power series, where there are any.
pub trait SeriesVisitor<S> {
    /// What it makes of them.
    type Output;
    /// Makes it.
    fn visit(self) -> Self::Output
    where
        S: PowerSeries;
}

/// The coefficients of order 0 of a motion.
pub struct Leading<S: PowerSeries, T: Scalar> {
    /// What later orders need again.
    pub kept: S::Kept<T>,
    /// What has a series.
    pub start: S::Coefficients<T>,
    /// Its change.
    pub change: S::Coefficients<T>,
}

/// The coefficients of one order of a motion.
pub struct Next<S: PowerSeries, T: Scalar> {
    /// Of the changes of what has a series.
    pub change: S::Coefficients<T>,
    /// Of both operands of all lanes.
    pub operands: [S::Lanes<T>; 2],
}

impl<S: PowerSeries, T: Scalar> fmt::Debug for Next<S, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Next").field("change", &self.change).finish_non_exhaustive()
    }
}

impl<S: PowerSeries, T: Scalar> fmt::Debug for Leading<S, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Leading")
            .field("start", &self.start)
            .field("change", &self.change)
            .finish_non_exhaustive()
    }
}

/// The operands of all lanes of one order, as wide registers like them.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Row<L>(L);

/// The power series of one step, and room for what they are made of.
pub(crate) struct Series<S: PowerSeries, T: Scalar> {
    kept: S::Kept<T>,
    left: [Row<S::Lanes<T>>; MOST_COEFFICIENTS],
    right: [Row<S::Lanes<T>>; MOST_COEFFICIENTS],
    coefficients: [S::Coefficients<T>; MOST_COEFFICIENTS + 1],
    order: usize,
}

impl<S: PowerSeries, T: Scalar> Clone for Series<S, T> {
    fn clone(&self) -> Self {
        let Self { kept, left, right, coefficients, order } = *self;
        Self { kept, left, right, coefficients, order }
    }
}

impl<S: PowerSeries, T: Real> Series<S, T> {
    /// Room for series of this order.
    pub(crate) fn new(order: usize) -> Self {
        let zero = T::of(0.0);
        let rows = [Row(S::Lanes::splat(zero)); MOST_COEFFICIENTS];
        let coefficients = [S::Coefficients::splat(zero); MOST_COEFFICIENTS + 1];
        Self { kept: S::Kept::splat(zero), left: rows, right: rows, coefficients, order }
    }

    pub(crate) fn order(&self) -> usize {
        self.order
    }

    pub(crate) fn set_order(&mut self, order: usize) {
        self.order = order;
    }

    /// Computes all coefficients of the motion from a state on.
    #[inline(always)]
    fn expand<P: Processor>(&mut self, start: &Start<'_, S, T>) {
        let Start { parameters, state, time, control, velocity } = start;
        let Leading { kept, start, change } = S::leading(parameters, state, *time, control, velocity);
        self.kept = kept;
        (self.coefficients[0], self.coefficients[1]) = (start, change);
        for k in 1..self.order.min(MOST_COEFFICIENTS) {
            let sums = self.multiply::<P>(k);
            let Next { mut change, operands: [left, right] } =
                S::next(&self.kept, &self.coefficients[k], &sums, T::of(k as f64));
            (self.left[k].0, self.right[k].0) = (left, right);
            let share = T::of(1.0 / (k as f64 + 1.0));
            for x in change.as_mut() {
                *x = *x * share;
            }
            self.coefficients[k + 1] = change;
        }
    }

    /// `Σ_j a_j b_{k−j}` from 1 to `k − 1` of all lanes, side by side in registers.
    #[inline(always)]
    fn multiply<P: Processor>(&self, k: usize) -> S::Lanes<T> {
        let mut sums = S::Lanes::splat(T::of(0.0));
        match P::DOUBLES {
            8 if T::IS_DOUBLE => self.multiply_by::<P, 8>(k, &mut sums),
            4 if T::IS_DOUBLE => self.multiply_by::<P, 4>(k, &mut sums),
            2 if T::IS_DOUBLE => self.multiply_by::<P, 2>(k, &mut sums),
            _ => {
                for (lane, sum) in sums.as_mut().iter_mut().enumerate() {
                    self.terms(k, |a, b| *sum = a.as_ref()[lane].mul_add(b.as_ref()[lane], *sum));
                }
            }
        }
        sums
    }

    #[inline(always)]
    fn multiply_by<P: Processor, const W: usize>(&self, k: usize, sums: &mut S::Lanes<T>) {
        let mut at = 0;
        while at + 4 * W <= S::Lanes::<T>::LENGTH {
            self.multiply_registers::<P, W, 4>(k, at, sums);
            at += 4 * W;
        }
        while at + 2 * W <= S::Lanes::<T>::LENGTH {
            self.multiply_registers::<P, W, 2>(k, at, sums);
            at += 2 * W;
        }
        while at + W <= S::Lanes::<T>::LENGTH {
            self.multiply_registers::<P, W, 1>(k, at, sums);
            at += W;
        }
    }

    #[inline(always)]
    fn multiply_registers<P: Processor, const W: usize, const N: usize>(
        &self,
        k: usize,
        at: usize,
        sums: &mut S::Lanes<T>,
    ) {
        let load = |lanes: &S::Lanes<T>, n: usize| {
            let mut numbers = [T::of(0.0); W];
            numbers.copy_from_slice(&lanes.as_ref()[at + n * W..][..W]);
            P::doubles(&numbers)
        };
        let mut sum = [P::doubles(&[T::of(0.0); W]); N];
        self.terms(k, |a, b| {
            for (n, sum) in sum.iter_mut().enumerate() {
                *sum = P::mul_add(load(a, n), load(b, n), *sum);
            }
        });
        for (n, sum) in sum.into_iter().enumerate() {
            sums.as_mut()[at + n * W..][..W].copy_from_slice(&P::numbers::<T, W>(sum));
        }
    }

    /// The pairs `a_j`, `b_{k−j}`.
    #[inline(always)]
    fn terms(&self, k: usize, mut term: impl FnMut(&S::Lanes<T>, &S::Lanes<T>)) {
        for (a, b) in self.left[1..k].iter().zip(self.right[1..k].iter().rev()) {
            term(&a.0, &b.0);
        }
    }

    /// The values a time `h` after the start.
    #[inline(always)]
    fn sum(&self, h: T) -> S::Coefficients<T> {
        let mut sum = self.coefficients[self.order];
        for k in (0..self.order).rev() {
            for (x, &c) in sum.as_mut().iter_mut().zip(self.coefficients[k].as_ref()) {
                *x = x.mul_add(h, c);
            }
        }
        sum
    }

    /// The state a time `h` after the start.
    #[inline(always)]
    pub(crate) fn state(&self, h: T) -> S::StateComponents<T> {
        S::finish(&self.kept, &self.sum(h))
    }
}

impl<S: PowerSeries, T: Real> Terms for Series<S, T> {
    #[inline(always)]
    fn last(&self) -> usize {
        self.order
    }

    #[inline(always)]
    fn blocks(&self) -> &[usize] {
        S::BLOCKS
    }

    #[inline(always)]
    fn largest(&self, order: usize, from: usize, length: usize) -> f64 {
        let numbers = &self.coefficients[order].as_ref()[from..from + length];
        numbers.iter().fold(0.0, |largest: f64, x| {
            let size = x.to_f64().abs();
            if size > largest { size } else { largest }
        })
    }
}

/// The terms of the series of a step, which tell how long it may be.
pub(crate) trait Terms {
    /// The order of the last.
    fn last(&self) -> usize;
    /// The lengths of the blocks of what has a series that have a unit in common.
    fn blocks(&self) -> &[usize];
    /// The largest coefficient of one order in a block that begins there.
    fn largest(&self, order: usize, from: usize, length: usize) -> f64;

    /// How long the step is, after one of the length `before`.
    #[inline(always)]
    fn step(&self, before: Option<f64>, length: Length) -> f64 {
        match length {
            Length::Exactly(step) => step,
            Length::AtMost(most) => {
                let guess = before.map_or_else(|| self.first_guess(), f64::abs);
                let longest = if guess < f64::INFINITY { self.longest_step(guess) } else { guess };
                // what is zero at its start in every unit that changes has no size there
                let longest = if longest < f64::INFINITY { longest } else { self.first_guess() };
                if longest < most.abs() { longest.copysign(most) } else { most }
            }
        }
    }

    /// How large the step may be for the last two terms to be as small as the order can make them: `e^{−2N}` of what the series is of, which is
    /// the largest of its first three terms in a step of the length that is guessed.
    ///
    /// That is the rule of Jorba and Zou, Experimental Mathematics 14 (2005) 99, for each unit by itself. Infinite where these terms are zero.
    #[inline(always)]
    fn longest_step(&self, guess: f64) -> f64 {
        let last = self.last();
        let mut least = [f64::INFINITY; 2];
        let mut from = 0;
        for &length in self.blocks() {
            let [zeroth, first, second] = [0, 1, 2].map(|k| self.largest(k, from, length));
            let size = zeroth.max(first * guess).max(second * guess * guess);
            for (k, least) in [last - 1, last].into_iter().zip(&mut least) {
                let ratio = size / self.largest(k, from, length);
                // zero by zero says nothing, nor does what is below all numbers
                if size > 0.0 && ratio < *least {
                    *least = ratio;
                }
            }
            from += length;
        }
        let n = last as f64;
        root(least[0], n - 1.0).min(root(least[1], n)) * self.margin()
    }

    /// A first guess of the step's length, by the first term that is not zero and the last ones.
    #[cold]
    fn first_guess(&self) -> f64 {
        let mut guess = f64::INFINITY;
        let mut from = 0;
        for &length in self.blocks() {
            for k in [self.last() - 1, self.last()] {
                let of = |k: usize| self.largest(k, from, length);
                if let Some(first) = (0..k).find(|&k| of(k) > 0.0) {
                    guess = guess.min(root(of(first) / of(k), (k - first) as f64));
                }
            }
            from += length;
        }
        guess * self.margin()
    }

    /// How much shorter a step is than the series converges.
    #[inline(always)]
    fn margin(&self) -> f64 {
        Scalar::exp(-0.7 / (self.last() as f64 - 1.0) - 2.0)
    }
}

/// `x^{1/k}`, also of what is infinite.
#[inline(always)]
fn root(x: f64, k: f64) -> f64 {
    if x < f64::INFINITY { Scalar::powf(x, 1.0 / k) } else { x }
}

/// Where a step starts.
pub(crate) struct Start<'s, S: System + PowerSeries, T: Scalar> {
    pub(crate) parameters: &'s S::Parameters<T>,
    pub(crate) state: &'s S::StateComponents<T>,
    pub(crate) time: T,
    pub(crate) control: &'s S::ControlComponents<T>,
    pub(crate) velocity: &'s S::Velocity<T>,
}

/// One step: its series, how long it may be, and where it leads.
pub(crate) struct Advance<'s, S: PowerSeries, T: Scalar> {
    pub(crate) series: &'s mut Series<S, T>,
    pub(crate) start: Start<'s, S, T>,
    /// The length of the step before, if there was one.
    pub(crate) before: Option<f64>,
    /// How long it has to be, or may be at most, backwards in time if negative.
    pub(crate) length: Length,
}

/// How long a step is to be.
#[derive(Clone, Copy)]
pub(crate) enum Length {
    /// So long.
    Exactly(f64),
    /// As long as its terms allow, and no longer than this.
    AtMost(f64),
}

impl<S: PowerSeries, T: Real> LongWork for Advance<'_, S, T> {
    type CallSite = S::Kept<T>;
    /// The length of the step, and the state at its end.
    type Result = (f64, S::StateComponents<T>);

    #[inline(always)]
    fn done<P: Processor>(self) -> Self::Result {
        let Self { series, start, before, length } = self;
        series.expand::<P>(&start);
        let step = series.step(before, length);
        (step, series.state(T::of(step)))
    }
}
