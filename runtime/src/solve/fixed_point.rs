//! Fixed-point iteration on a step's equation, `x ← L⁻¹ right(x)`.

use super::stopping::{change, is_within, select};
use super::{Convergence, LAST_CHANGE, NO_DIFFERENCE, ROUNDOFF, count};
use crate::kernel::{Evaluation, Kernel};
use crate::scalar::{Batch, Mask, Work};

/// The most iterations of a step: where more are needed Newton's iteration is faster.
const MOST: u32 = 8;
/// What rounding changes the unknown by in an iteration, at most, in units of epsilon.
const NOISE: f64 = 4.0;
/// Changes larger than this, in units of epsilon, show the rate of contraction.
pub(super) const SHARP: f64 = 256.0;

/// What is known before.
pub(super) struct Known<'a, T: Batch, U> {
    pub prediction: &'a U,
    /// Where the first iteration led to, if there was one.
    pub first: Option<U>,
    /// The rate of contraction.
    pub rate: T,
    /// The relative change of a last iteration, and of the first if it is to be the last.
    pub tolerance: T,
    pub limit: T,
    /// In which lanes.
    pub tried: T::Mask,
    /// Whether the rate is to be measured, by one more iteration.
    pub measures: bool,
}

/// How far iterations went.
pub(super) struct Iterated<T: Batch, U, I> {
    /// Where the equation was evaluated the last time, and where that led to.
    pub point: U,
    pub unknown: U,
    /// None if that was before.
    pub evaluation: Option<Evaluation<U, I>>,
    pub iterations: T::Each<u32>,
    /// What is left of the residual.
    pub residual: T,
    /// The lanes that are not solved.
    pub open: T::Mask,
    pub convergence: Convergence<T>,
}

/// The same out of line.
pub(super) fn iterate<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    known: Known<'_, T, K::Unknown>,
) -> Iterated<T, K::Unknown, K::Iterate> {
    T::outline(Iterate { kernel, state, step, known })
}

struct Iterate<'a, T: Batch, K: Kernel<T>> {
    kernel: &'a K,
    state: &'a K::State,
    step: &'a K::Step,
    known: Known<'a, T, K::Unknown>,
}

impl<T: Batch, K: Kernel<T>> Work for Iterate<'_, T, K> {
    type Home = K;
    type Result = Iterated<T, K::Unknown, K::Iterate>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { kernel, state, step, known } = self;
        iterated(kernel, state, step, known)
    }
}

/// Iterates for as long as a few more iterations promise to do.
#[inline(always)]
pub(super) fn iterated<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    known: Known<'_, T, K::Unknown>,
) -> Iterated<T, K::Unknown, K::Iterate> {
    let Known { prediction, first, mut rate, tolerance, limit, tried, measures } = known;
    let (none, nothing) = (T::Mask::splat(false), T::of(0.0));
    let [least, most, last_change] =
        [ROUNDOFF[0], ROUNDOFF[1], LAST_CHANGE[1]].map(|x| T::of(x * T::EPSILON));
    let (mut point, mut unknown, mut evaluation, mut open) = (*prediction, *prediction, None, !none);
    let (mut iterations, mut residual, mut last) = (T::all(0), nothing, nothing);
    let mut convergence = Convergence { tried, off: nothing, rate: nothing, is_sharp: none };
    let mut round = 0;
    if let Some(first) = first {
        (unknown, last, iterations) = (first, change::<T, _>(K::BLOCKS, prediction, &first), T::all(1));
        (convergence.off, round) = (last, 1);
        open = !is_within::<T, _>(K::BLOCKS, prediction, &first, limit);
    }
    while round < MOST && open.any() {
        let square = rate * rate;
        let promises = (square * square * rate * last).at_most(tolerance);
        let again = tried & open & (promises | T::Mask::splat(round == 0 || measures && round == 1));
        if !again.any() {
            break;
        }
        if round > 0 {
            // solved lanes wait: the same again gives the same
            point = select(again, &unknown, &point);
        }
        let here = kernel.evaluate(state, step, &point);
        let Some(next) = kernel.sweep(state, step, &here.right) else { break };
        evaluation = Some(here);
        unknown = if round == 0 { next } else { select(again, &next, &unknown) };
        let change = change::<T, _>(K::BLOCKS, &point, &unknown);
        count::<T>(&mut iterations, again);
        if round == 0 {
            (last, convergence.off) = (change, change);
            open = !is_within::<T, _>(K::BLOCKS, prediction, &unknown, limit);
        } else {
            let is_sharp = again & T::of(SHARP * T::EPSILON).below(last);
            let seen = (change - T::of(NOISE * T::EPSILON)) / last;
            convergence.rate = T::select(again & convergence.rate.below(seen), seen, convergence.rate);
            convergence.is_sharp = convergence.is_sharp | is_sharp;
            rate = T::select(is_sharp | rate.below(seen), change / last, rate);
            last = T::select(again, change, last);
            // the error that is left, relative to the unknown
            let left = rate * last;
            residual = T::select(again, left, residual);
            let is_nothing = (rate * left).at_most(T::of(NO_DIFFERENCE * T::EPSILON)) & left.at_most(most);
            open = open & !(again & last.at_most(last_change) & (left.at_most(least) | is_nothing));
        }
        round += 1;
    }
    Iterated { point, unknown, evaluation, iterations, residual, open, convergence }
}
