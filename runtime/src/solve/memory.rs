//! What a step remembers of the ones before it: it saves time, and nothing else.

use super::constants::{FORGETS, HARDLY, INTERVALS, LEFT, NEWTON, SHARP, SMALL, STRONG, TOLERANCE};
use super::equation::Facts;
use super::predictor::{Continuation, Predictor};
use crate::kernel::Kernel;
use crate::scalar::{Batch, Components, Mask, Real};

/// How the iterations of a kernel's update converge.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Convergence {
    /// A change is a part of the one before.
    Linear,
    /// It is a small part: simplified Newton steps.
    Strong,
    /// It is a part of the square of the one before: Newton's method.
    Quadratic,
}

impl Convergence {
    /// That of a kernel's iterations.
    #[inline(always)]
    pub(super) fn of<T: Batch, K: Kernel<T>>(kernel: &K) -> Self {
        match kernel.is_newton() {
            true if kernel.has_true_jacobian() => Self::Quadratic,
            true => Self::Strong,
            false => Self::Linear,
        }
    }

    /// Whether they are Newton's.
    #[inline(always)]
    pub(super) fn is_newton(self) -> bool {
        self != Self::Linear
    }

    /// What is left after a change.
    #[inline(always)]
    pub(super) fn left<T: Batch>(self, rate: T, change: T) -> T {
        if self == Self::Quadratic { rate * change * change } else { rate * change }
    }

    /// Whether a change shows the rate.
    #[inline(always)]
    pub(super) fn shows<T: Batch>(self, change: T) -> T::Mask {
        match self {
            Self::Quadratic => T::of(SMALL * T::EPSILON).lt(change * change),
            _ => T::of(SHARP * T::EPSILON).lt(change),
        }
    }
}

/// What is remembered of the solutions of earlier steps.
#[derive(Clone, Copy)]
pub(super) struct Memory<T: Batch, U> {
    /// Where the earlier solutions point.
    pub(super) predictor: Predictor<T, U>,
    /// The factor by which fixed-point iterations contract, as far as it is known.
    pub(super) rate: T,
    /// The relative change of an iteration that may be the last; negative where iterations do not contract strongly.
    pub(super) tolerance: T,
    /// Steps until the next measurement of the rate.
    due: u16,
    /// Steps from the next measurement to the one after it.
    interval: u16,
    /// Whether the next step is likely to need one iteration: kept, for it is asked in each step.
    is_ready: bool,
}

/// The numbers of a memory that tell how much of it is of use.
#[derive(Clone, Copy)]
pub(super) struct Aside<T: Batch> {
    count: (T, bool),
    rate: T,
    tolerance: T,
    due: u16,
    interval: u16,
    is_ready: bool,
}

impl<T: Batch, U: Components<T>> Default for Memory<T, U> {
    fn default() -> Self {
        Self {
            predictor: Predictor::default(),
            rate: T::of(STRONG),
            tolerance: T::of(TOLERANCE[0] * T::EPSILON),
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

    /// The lanes in which iterations end where they do on the fast path, and show no other rate: where that takes a
    /// step of Newton's method in one lane and not in another, both are taken beside it, to the same digits.
    #[inline(always)]
    pub(super) fn is_as_fast(&self, convergence: Convergence) -> T::Mask {
        match convergence {
            Convergence::Strong if !self.is_due() => self.predictor.are_all(Continuation::Eighth),
            Convergence::Quadratic => T::Mask::splat(!self.is_due() && self.predictor.remembers()),
            _ => T::Mask::splat(false),
        }
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
        self.is_ready = U::LENGTH == 0;
    }

    /// Forgets all, until it is [taken up](Self::take_up).
    #[inline(always)]
    pub(super) fn set_aside(&mut self) -> Aside<T> {
        let Self { rate, tolerance, due, interval, is_ready, .. } = *self;
        let aside = Aside { count: self.predictor.count(), rate, tolerance, due, interval, is_ready };
        self.forget();
        aside
    }

    /// Remembers again what was [set aside](Self::set_aside).
    #[inline(always)]
    pub(super) fn take_up(&mut self, aside: Aside<T>) {
        let Aside { count, rate, tolerance, due, interval, is_ready } = aside;
        self.predictor.recall(count);
        (self.rate, self.tolerance) = (rate, tolerance);
        (self.due, self.interval, self.is_ready) = (due, interval, is_ready);
    }

    /// Remembers a step that was not taken on the fast path: its solution, and the rate of contraction as it was seen.
    /// Lanes that are solved as `quick` as there learn no more than there. It is compiled `IN_LINE`, or once for all kernels with as many
    /// unknowns.
    #[inline(always)]
    pub(super) fn learn<const IN_LINE: bool>(
        &mut self,
        facts: &Facts<'_>,
        start: impl FnOnce() -> U,
        solution: &U,
        quick: T::Mask,
        rate: T,
    ) {
        if const { U::LENGTH == 0 } {
            return;
        }
        // after any step the one follows from the other, so that memory that is taken up anew is the same
        if !(self.predictor.remembers() && rate.is_same(self.rate).all()) {
            (self.rate, self.tolerance) = (rate, tolerance(rate, facts.convergence));
        }
        let quick = quick & T::Mask::splat(self.due > 0);
        if self.due == 0 {
            self.due = self.interval;
            self.interval = (4 * self.interval).min(INTERVALS[1]);
        } else {
            self.due -= 1;
        }
        let start = if facts.convergence.is_newton() { Some(start()) } else { None };
        self.predictor.learn::<IN_LINE>(facts.by, facts.blocks, start.as_ref(), solution, quick);
        self.settle();
    }

    fn settle(&mut self) {
        self.is_ready = self.due > 0 && self.predictor.is_full() && self.is_strong().all();
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    ///
    /// Of the kernel it knows nothing but these two: it is compiled once for all that have as many unknowns.
    pub(super) fn memory(
        &mut self,
        convergence: Convergence,
        by: Continuation,
        visit: &mut dyn FnMut(&mut [T]),
    ) {
        self.predictor.memory(visit, by);
        let mut numbers = [T::of(f64::from(self.due)), T::of(f64::from(self.interval))];
        visit(&mut numbers);
        // the same in all lanes
        let [due, interval] = [numbers[0].lane(0).to_f64() as u16, numbers[1].lane(0).to_f64() as u16];
        (self.due, self.interval) = (due, interval.min(INTERVALS[1]));
        visit(core::slice::from_mut(&mut self.rate));
        self.tolerance = match self.predictor.remembers() {
            true => tolerance(self.rate, convergence),
            false => T::of(TOLERANCE[0] * T::EPSILON),
        };
        self.settle();
    }
}

/// The relative change of an iteration that may be the last, where iterations converge at this rate.
#[inline(always)]
pub(super) fn tolerance<T: Batch>(rate: T, convergence: Convergence) -> T {
    let ([least, most, _], unit) = (TOLERANCE, T::of(T::EPSILON));
    let change = match convergence {
        Convergence::Linear => unit * clamped(T::of(HARDLY) / (rate * rate), [least, most]),
        Convergence::Strong => unit * clamped(T::of(NEWTON[0]) / rate, [least, NEWTON[1]]),
        Convergence::Quadratic => (T::of(NEWTON[0] * T::EPSILON) / rate).sqrt(),
    };
    T::select(rate.le(T::of(STRONG)), change, T::of(-1.0))
}

/// Whether a change, after another one, leaves no more than rounding, as far as the rate shows.
#[inline(always)]
pub(super) fn is_left<T: Batch>(convergence: Convergence, now: T, last: T) -> T::Mask {
    let (square, bound) = (now * now, T::of(LEFT * T::EPSILON) * last);
    match convergence {
        Convergence::Quadratic => (square * now).le(bound * last),
        _ => square.le(bound),
    }
}

/// A rate of convergence from two changes, one after the other, where another one was known.
#[inline(always)]
pub(super) fn rate<T: Batch>(convergence: Convergence, [last, now]: [T; 2], known: T) -> T {
    let bounds = match convergence {
        Convergence::Linear => return clamped(now / last, [1.0 / SHARP, 1.0]),
        Convergence::Strong => [NEWTON[0] / NEWTON[1], 1.0],
        Convergence::Quadratic => [1.0 / SHARP, 1.0],
    };
    let rate = if convergence == Convergence::Quadratic { now / (last * last) } else { now / last };
    let least = T::of(FORGETS) * known;
    clamped(T::select(rate.lt(least), least, rate), bounds)
}

/// No closure, which would not be compiled for the processor that the caller is compiled for.
#[inline(always)]
fn clamped<T: Batch>(x: T, [least, most]: [f64; 2]) -> T {
    let x = T::select(T::of(most).lt(x), T::of(most), x);
    T::select(x.lt(T::of(least)), T::of(least), x)
}
