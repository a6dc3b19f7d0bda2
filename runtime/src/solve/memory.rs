//! What a step remembers of the ones before it: it saves time, and nothing else.

use super::constants::{HARDLY, INTERVALS, SHARP, STRONG, TERMS, TOLERANCE};
use super::predictor::Predictor;
use crate::scalar::{Batch, Components, Mask, Real, Scalar};

/// What is remembered of the solutions of earlier steps.
#[derive(Clone, Copy)]
pub(super) struct Memory<T: Batch, U> {
    /// Where the earlier solutions point.
    pub(super) predictor: Predictor<T, U>,
    /// The factor by which fixed-point iterations contract, as far as it is known.
    pub(super) rate: T,
    /// The relative change of an iteration that may be the last; negative where iterations do not contract strongly.
    pub(super) tolerance: T,
    /// By how much larger than the unknown the terms are that cancel to it, where that is most; from 1 to [`TERMS`]'s last.
    terms: T,
    /// One in lanes in which predictions have been off by rounding, and by more than the tolerance, since the last measurement.
    missed: T,
    /// Steps until the next measurement of the rate.
    due: u16,
    /// Steps from the next measurement to the one after it.
    interval: u16,
    /// Whether the next step is likely to need one iteration: kept, for it is asked in each step.
    is_ready: bool,
}

impl<T: Batch, U: Components<T>> Default for Memory<T, U> {
    fn default() -> Self {
        Self {
            predictor: Predictor::default(),
            rate: T::of(STRONG),
            tolerance: T::of(TOLERANCE[0] * T::EPSILON),
            terms: T::of(1.0),
            missed: T::of(0.0),
            due: INTERVALS[0],
            interval: INTERVALS[0],
            is_ready: U::LENGTH == 0,
        }
    }
}

impl<T: Batch, U: Components<T>> Memory<T, U> {
    /// For how many steps one iteration is likely to be enough.
    #[inline(always)]
    pub(super) fn ready_for(&self) -> u64 {
        if const { U::LENGTH == 0 } {
            u64::MAX
        } else if self.is_ready {
            self.due.into()
        } else {
            0
        }
    }

    /// So many steps needed one iteration.
    #[inline(always)]
    pub(super) fn took(&mut self, steps: u64) {
        if const { U::LENGTH > 0 } {
            self.due = u64::from(self.due).saturating_sub(steps) as u16;
            self.is_ready &= self.due > 0;
        }
    }

    /// The lanes in which iterations contract strongly.
    #[inline(always)]
    pub(super) fn is_strong(&self) -> T::Mask {
        self.rate.le(T::of(STRONG))
    }

    /// The lanes in which iterations are to be tried: one at least, or there is nothing to be tried.
    #[inline(always)]
    pub(super) fn tries(&self) -> T::Mask {
        self.is_strong() | T::Mask::splat(self.is_due())
    }

    /// Whether the rate is to be measured: the iteration then begins at the latest solution, so far off that the rate shows.
    #[inline(always)]
    pub(super) fn is_due(&self) -> bool {
        self.due == 0
    }

    /// Whether a few iterations, or corrections, are likely to be enough for the next step.
    #[inline(always)]
    pub(super) fn is_regular(&self) -> bool {
        U::LENGTH > 0 && self.due > 0 && self.predictor.remembers() && self.is_strong().all()
    }

    /// Forgets all.
    #[inline(always)]
    pub(super) fn forget(&mut self) {
        self.predictor.forget();
        (self.due, self.interval) = (INTERVALS[0], INTERVALS[0]);
        (self.rate, self.tolerance) = (T::of(STRONG), T::of(TOLERANCE[0] * T::EPSILON));
        (self.terms, self.missed) = (T::of(1.0), T::of(0.0));
        self.is_ready = U::LENGTH == 0;
    }

    /// Remembers a step that was not on the fast path: its solution, the rate of contraction as it was seen, and the iterations. Returns whether the
    /// terms are to be measured.
    #[inline(always)]
    pub(super) fn learn(
        &mut self,
        blocks: &[usize],
        solution: &U,
        rate: T,
        iterations: &T::Each<u32>,
    ) -> bool {
        if const { U::LENGTH == 0 } {
            return false;
        }
        if !rate.is_same(self.rate).all() {
            self.rate = rate;
            self.tolerance = tolerance(rate, self.terms);
        }
        let is_near = self.predictor.learn(blocks, solution);
        let mut is_wanted = false;
        if self.due == 0 {
            self.due = self.interval;
            self.interval = (4 * self.interval).min(INTERVALS[1]);
            is_wanted = T::of(1.0).lt(self.terms + self.missed).any();
        } else {
            if is_near.any() {
                let mut lane = 0;
                while lane < T::LANES {
                    if is_near.lane(lane) && iterations.as_ref()[lane] > 1 {
                        self.missed.set_lane(lane, Scalar::of(1.0));
                    }
                    lane += 1;
                }
            }
            self.due -= 1;
        }
        self.settle();
        is_wanted
    }

    /// Takes how much larger the terms are than the unknown, in lanes where that is asked for.
    pub(super) fn measured(&mut self, terms: T) {
        let [share, most] = TERMS;
        let is_wanted = T::of(1.0).lt(self.terms + self.missed);
        self.terms = T::select(is_wanted, clamped(T::of(share) * terms, [1.0, most]), self.terms);
        self.missed = T::of(0.0);
        self.tolerance = tolerance(self.rate, self.terms);
    }

    fn settle(&mut self) {
        self.is_ready = self.due > 0 && self.predictor.is_full() && self.is_strong().all();
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub(super) fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.predictor.memory(visit);
        let mut numbers = [T::of(f64::from(self.due)), T::of(f64::from(self.interval))];
        visit(&mut numbers);
        // the same in all lanes
        let [due, interval] = [numbers[0].lane(0).to_f64() as u16, numbers[1].lane(0).to_f64() as u16];
        (self.due, self.interval) = (due, interval.min(INTERVALS[1]));
        let mut numbers = [self.rate, self.terms, self.missed];
        visit(&mut numbers);
        [self.rate, self.terms, self.missed] = numbers;
        self.tolerance = tolerance(self.rate, self.terms);
        self.settle();
    }
}

/// The relative change of an iteration that may be the last, where iterations contract by this factor, and terms are so much larger.
#[inline(always)]
pub(super) fn tolerance<T: Batch>(rate: T, terms: T) -> T {
    let [least, most, _] = TOLERANCE;
    let units = least_of(T::of(most) * terms, T::of(HARDLY) / (rate * rate));
    let units = T::select(units.lt(T::of(least)), T::of(least), units);
    T::select(rate.le(T::of(STRONG)), T::of(T::EPSILON) * units, T::of(-1.0))
}

/// A rate of contraction from two changes, one after the other.
#[inline(always)]
pub(super) fn rate<T: Batch>([last, now]: [T; 2]) -> T {
    clamped(now / last, [1.0 / SHARP, 1.0])
}

/// No closure, which would not be compiled for the processor that the caller is compiled for.
#[inline(always)]
fn clamped<T: Batch>(x: T, [least, most]: [f64; 2]) -> T {
    let x = least_of(T::of(most), x);
    T::select(x.lt(T::of(least)), T::of(least), x)
}

#[inline(always)]
fn least_of<T: Batch>(most: T, x: T) -> T {
    T::select(most.lt(x), most, x)
}
