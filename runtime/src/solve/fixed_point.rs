//! Fixed-point iteration on a step's equation, `x ← L⁻¹ right(x)`, where its first iteration was not enough.

use super::stopping::{change, is_within, select};
use super::{Convergence, LAST_CHANGE, ROUNDOFF, STRONG, Solver, count};
use crate::kernel::{Evaluation, Kernel};
use crate::scalar::{Batch, Mask};

/// The most iterations of a step: where more are needed Newton's iteration is faster.
const MOST: u32 = 8;
/// What rounding changes the unknown by in an iteration, at most, in units of epsilon.
const NOISE: f64 = 4.0;
/// The change of a last iteration, in units of epsilon. What is evaluated before it serves for the solution too, and turns with it, by a few
/// times what is left after it: that is less than a unit then, but where the last change is roundoff itself.
const NEAR: f64 = 32.0;
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

/// The iterations after the one that led from the prediction to `first`, if a few more promise to do.
///
/// The error that is left is the last change times the rate of contraction: that of the changes before, as long as these were more than
/// roundoff, or the one that was known before.
#[inline(always)]
pub(super) fn iterate<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    solver: &Solver<T, K::Unknown>,
    first: &K::Unknown,
) -> Iterated<T, K::Unknown, K::Iterate> {
    let prediction = &solver.prediction;
    let (none, nothing) = (T::Mask::splat(false), T::of(0.0));
    let (unit, least, small) = (units::<T>(1.0), units::<T>(ROUNDOFF[0]), units::<T>(LAST_CHANGE[0]));
    let (near, sharp, noise) = (units::<T>(NEAR), units::<T>(SHARP), units::<T>(NOISE));
    let mut last = change::<T, _>(K::BLOCKS, prediction, first);
    let tried = solver.tries();
    let mut convergence = Convergence { tried, off: last, ..Convergence::of_one(nothing) };
    let (mut point, mut unknown) = (*prediction, *first);
    let mut open = !is_within::<T, _>(K::BLOCKS, prediction, first, solver.limit());
    let mut again = tried & open;
    // the second shows the rate
    if !solver.measures() {
        let square = solver.rate * solver.rate;
        again = again & (square * square * solver.rate * last).le(solver.tolerance);
    }
    // the rate of contraction as a fraction, and where it was seen
    let (mut to, mut from, mut seen) = (solver.rate, T::of(1.0), none);
    let mut round = 1;
    while again.any() {
        // the other lanes wait: the same again gives the same
        point = select(again, &unknown, &point);
        let evaluation = kernel.evaluate(state, step, &point);
        let Some(next) = kernel.fixed_point_update(state, step, &evaluation.right) else { break };
        (unknown, round) = (next, round + 1);
        count::<T>(&mut convergence.iterations, again);
        let change = change::<T, _>(K::BLOCKS, &point, &unknown);
        let is_sharp = again & sharp.lt(last);
        (to, from) = (T::select(is_sharp, change, to), T::select(is_sharp, last, from));
        (seen, convergence.is_sharp) = (seen | is_sharp, convergence.is_sharp | is_sharp);
        let is_last = again & change.le(near);
        if is_last.any() {
            // what is certainly more than roundoff
            let more = change - noise;
            let exceeds = is_last & !is_sharp & (to * last).lt(more * from);
            (to, from) = (T::select(exceeds, more, to), T::select(exceeds, last, from));
            seen = seen | exceeds;
            let rate = to / from;
            // relative to the unknown
            let left = rate * change;
            convergence.residual = T::select(is_last, left, convergence.residual);
            open = open & !(is_last & (left.le(unit) | (change.le(small) & left.le(least))));
        }
        if !open.any() {
            convergence.rate = T::select(seen, to / from, nothing);
            return Iterated::Solved(unknown, evaluation, convergence);
        }
        let contracts = is_last | change.le(T::of(STRONG) * last);
        again = if round < MOST { again & open & contracts } else { none };
        last = change;
    }
    convergence.rate = T::select(seen, to / from, nothing);
    Iterated::Open(Open { point, unknown, open, convergence })
}

/// So many units of epsilon.
#[inline(always)]
fn units<T: Batch>(x: f64) -> T {
    T::of(x * T::EPSILON)
}
