//! Fixed-point iteration on a step's equation, `x ← L⁻¹ right(x)`, where its first iteration was not enough.

use super::stopping::{change, is_within, select};
use super::{Convergence, LAST_CHANGE, NO_DIFFERENCE, ROUNDOFF, Solver, count};
use crate::kernel::{Evaluation, Kernel};
use crate::scalar::{Batch, Mask};

/// The most iterations of a step: where more are needed Newton's iteration is faster.
const MOST: u32 = 8;
/// What rounding changes the unknown by in an iteration, at most, in units of epsilon.
const NOISE: f64 = 4.0;
/// Changes larger than this, in units of epsilon, show the rate of contraction.
pub(super) const SHARP: f64 = 256.0;

/// What iterations led to.
pub(super) enum Iterated<T: Batch, U, I> {
    /// Solved in all lanes, with the equation evaluated so near that it makes no difference.
    Solved(U, Evaluation<U, I>, Convergence<T>),
    /// Not solved in some.
    Open(Open<T, U>),
}

/// Where iterations ended that did not solve the equation in all lanes.
pub(super) struct Open<T: Batch, U> {
    /// Where the equation was evaluated the last time, and where that led to.
    pub point: U,
    pub unknown: U,
    /// The lanes that are not solved.
    pub open: T::Mask,
    pub convergence: Convergence<T>,
}

/// The iterations after the one that led from the prediction to `first`, for as long as a few more promise to do.
#[inline(always)]
pub(super) fn iterate<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    solver: &Solver<T, K::Unknown>,
    first: &K::Unknown,
) -> Iterated<T, K::Unknown, K::Iterate> {
    let prediction = &solver.prediction;
    let Solver { mut rate, tolerance, .. } = *solver;
    let tried = solver.tries();
    let none = T::Mask::splat(false);
    let [least, most, last_change] =
        [ROUNDOFF[0], ROUNDOFF[1], LAST_CHANGE[1]].map(|x| T::of(x * T::EPSILON));
    let mut last = change::<T, _>(K::BLOCKS, prediction, first);
    let mut convergence = Convergence { tried, off: last, ..Convergence::of_one(T::of(0.0)) };
    let (mut point, mut unknown) = (*prediction, *first);
    let mut open = !is_within::<T, _>(K::BLOCKS, prediction, first, solver.limit());
    let mut again = tried & open;
    // the second shows the rate
    if !solver.measures() {
        again = again & promises(rate, last, tolerance);
    }
    let mut round = 1;
    while again.any() {
        // the other lanes wait: the same again gives the same
        point = select(again, &unknown, &point);
        let evaluation = kernel.evaluate(state, step, &point);
        let Some(next) = kernel.sweep(state, step, &evaluation.right) else { break };
        unknown = next;
        round += 1;
        count::<T>(&mut convergence.iterations, again);
        let change = change::<T, _>(K::BLOCKS, &point, &unknown);
        // a change that is small is roundoff in part
        let is_sharp = again & T::of(SHARP * T::EPSILON).below(last);
        let more = change - T::select(is_sharp, T::of(0.0), T::of(NOISE * T::EPSILON));
        if (is_sharp | (again & (rate * last).below(more))).any() {
            let seen = more / last;
            let faster = again & convergence.rate.below(seen);
            convergence.rate = T::select(faster, seen, convergence.rate);
            convergence.is_sharp = convergence.is_sharp | is_sharp;
            rate = T::select(is_sharp | (again & rate.below(seen)), seen, rate);
        }
        last = T::select(again, change, last);
        // the error that is left, relative to the unknown
        let left = rate * last;
        convergence.residual = T::select(again, left, convergence.residual);
        let is_nothing = (rate * left).at_most(T::of(NO_DIFFERENCE * T::EPSILON)) & left.at_most(most);
        open = open & !(again & last.at_most(last_change) & (left.at_most(least) | is_nothing));
        if !open.any() {
            return Iterated::Solved(unknown, evaluation, convergence);
        }
        again = if round < MOST { again & open & promises(rate, last, tolerance) } else { none };
    }
    Iterated::Open(Open { point, unknown, open, convergence })
}

/// Whether a few more iterations promise to do.
#[inline(always)]
fn promises<T: Batch>(rate: T, last: T, tolerance: T) -> T::Mask {
    let square = rate * rate;
    (square * square * rate * last).at_most(tolerance)
}
