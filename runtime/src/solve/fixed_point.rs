//! Fixed-point iteration on a step's equation, `x ← L⁻¹ right(x)`, and where the right side is `n(x)/(1 + d(x))`, `x ← L⁻¹ n(x) − d(x) x`.
//!
//! Both have the same solution. The first one is for a prediction, which is known before the state is, so that the quotient is there in time, and
//! is part of what comes after. Every other iterate waits for the one before it, and is not to wait for a division. They contract alike, by no
//! more than [`SAFETY`] apart.

use super::stopping::{change, is_within, select};
use super::{Convergence, LAST_CHANGE, QUICK, ROUNDOFF, SAFETY, SECOND, STRONG, Solver, count};
use crate::kernel::{Evaluation, Kernel};
use crate::scalar::{Batch, Components, Mask};

/// The most iterations of a step: where more are needed Newton's iteration is faster.
pub(super) const MOST: u8 = 12;
/// What rounding changes the unknown by in an iteration, at most, in units of epsilon.
pub(super) const NOISE: f64 = 4.0;
/// The change of a last iteration, in units of epsilon. What is evaluated before it serves for the solution too, and turns with it: by a few
/// times what is left after it, less than a quarter of a unit; or in a plane, where iterations may contract by more than the angle of a step, by
/// this change times the angle.
const NEAR: f64 = 16.0;
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
pub(crate) struct Open<T: Batch, U> {
    /// Where the equation was evaluated the last time, and where that led to.
    pub(super) point: U,
    pub(super) unknown: U,
    /// The lanes that are not solved.
    pub(super) open: T::Mask,
    pub(super) convergence: Convergence<T>,
}

/// Iterations from a guess on, as long as a few more promise to do; `first` is where the first one led to, if that is known.
///
/// The error that is left is the last change times the rate of contraction: that of the changes before, as long as these were more than
/// roundoff, or the one that was known before.
#[inline(always)]
pub(super) fn iterate<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    solver: &Solver<T, K::Unknown>,
    guess: &K::Unknown,
    first: Option<K::Unknown>,
) -> Iterated<T, K::Unknown, K::Iterate> {
    let (none, tried, measures) = (T::Mask::splat(false), solver.tries(), solver.measures());
    let (mut point, mut unknown, mut last, mut round) = (*guess, *guess, T::of(0.0), 0);
    let mut open = !none;
    if let Some(first) = first {
        (unknown, round) = (first, 1);
        last = change::<T, _>(K::BLOCKS, &point, &unknown);
        open = !is_solved::<T, K>(&point, &unknown, last, solver.tolerance);
    }
    // each by itself, since a record would be in memory
    let (mut off, mut residual, mut iterations, mut is_quick) = (last, T::of(0.0), T::all(round), !open);
    let mut rate = Rate::new(solver);
    let mut again = open & tried;
    if round > 0 && !measures {
        again = again & are_enough(rate.assumed, last);
    }
    while again.any() {
        // the other lanes wait
        point = select(again, &unknown, &point);
        let evaluation = kernel.evaluate(state, step, &point);
        // as on the fast path, where the first one is from where earlier solutions point
        let next = if round == 0 && solver.remembers() {
            kernel.fixed_point_update(state, step, &evaluation.right)
        } else {
            kernel.cleared_update(state, step, &point, &evaluation)
        };
        (unknown, round) = (select(again, &next, &unknown), round + 1);
        count::<T>(&mut iterations, again);
        let now = change::<T, _>(K::BLOCKS, &point, &unknown);
        let mut more = T::Mask::splat(round < MOST.into());
        let slower = again & !now.le(rate.bound * last + units::<T>(NOISE));
        if slower.any() {
            if round == 1 {
                off = now;
                more = more & (T::Mask::splat(measures) | are_enough(rate.assumed, now));
            } else {
                rate.look(slower, last, now);
                let contracts = now.le(T::of(STRONG) * last) & are_enough(rate.assumed, now);
                more = more & (!slower | contracts);
            }
        }
        let is_near = again & now.le(T::of(K::BLOCKS.len() as f64) * units::<T>(LAST_CHANGE[1]));
        if is_near.any() && !(round == 1 && measures) {
            let [solved, quick] =
                accepted::<T, K>(solver, [&point, &unknown], now, rate.assumed, (round, slower));
            is_quick = is_quick | (is_near & quick);
            let left = T::select(is_quick, solver.rate * solver.tolerance, rate.assumed * now);
            residual = T::select(is_near & solved, left, residual);
            open = open & !(is_near & solved);
            if !open.any() {
                let Rate { seen, is_sharp, .. } = rate;
                let convergence =
                    Convergence { iterations, residual, tried, off, rate: seen, is_sharp, is_quick };
                return Iterated::Solved(unknown, evaluation, convergence);
            }
        }
        (again, last) = (again & open & more, now);
    }
    let Rate { seen, is_sharp, .. } = rate;
    let convergence = Convergence { iterations, residual, tried, off, rate: seen, is_sharp, is_quick };
    Iterated::Open(Open { point, unknown, open, convergence })
}

/// The rate of contraction.
struct Rate<T: Batch> {
    assumed: T,
    /// While changes become smaller by this factor, the rate is not looked at.
    bound: T,
    /// That of the changes of this step.
    seen: T,
    is_sharp: T::Mask,
}

impl<T: Batch> Rate<T> {
    #[inline(always)]
    fn new<U: Components<T>>(solver: &Solver<T, U>) -> Self {
        let bound = T::of(if solver.measures() { 0.0 } else { SAFETY }) * solver.rate;
        Self { assumed: solver.rate, bound, seen: T::of(0.0), is_sharp: T::Mask::splat(false) }
    }

    /// Sees two changes, one after the other, in some lanes.
    #[inline(always)]
    fn look(&mut self, lanes: T::Mask, last: T, now: T) {
        // what is certainly more than roundoff
        let seen = (now - units::<T>(NOISE)) / last;
        let is_sharp = lanes & units::<T>(SHARP).lt(last);
        self.is_sharp = self.is_sharp | is_sharp;
        self.seen = T::select(is_sharp | (lanes & self.seen.lt(seen)), seen, self.seen);
        let assumed = T::select(is_sharp | (lanes & self.assumed.lt(seen)), seen, self.assumed);
        let least = T::of(1.0 / SHARP);
        self.assumed = T::select(assumed.lt(least), least, assumed);
        self.bound = T::of(SAFETY) * self.assumed;
    }
}

/// Where an iteration with a small change was the last, and where it was so as on the fast path, whichever the path is: an iteration or two that
/// contract as it was known.
#[inline(always)]
fn accepted<T: Batch, K: Kernel<T>>(
    solver: &Solver<T, K::Unknown>,
    [from, to]: [&K::Unknown; 2],
    change: T,
    rate: T,
    (round, slower): (u32, T::Mask),
) -> [T::Mask; 2] {
    let solved = is_last(change, rate * change);
    if round > QUICK.into() || solver.measures() {
        return [solved, T::Mask::splat(false)];
    }
    let is_first = T::Mask::splat(round == 1);
    let limit = T::of(if round == 1 { 1.0 } else { SECOND }) * solver.tolerance;
    let quick = is_solved::<T, K>(from, to, change, limit) & (is_first | !slower);
    [quick | (solved & slower & !is_first), quick]
}

/// Whether an iteration was the last, with such a change after which so much is left.
#[inline(always)]
pub(super) fn is_last<T: Batch>(change: T, left: T) -> T::Mask {
    let (nothing, small, least) = (units::<T>(0.25), units::<T>(LAST_CHANGE[0]), units::<T>(ROUNDOFF[0]));
    (change.le(units::<T>(NEAR)) & left.le(nothing)) | (change.le(small) & left.le(least))
}

/// Whether no block changes by more than `tolerance` times its size: what the fast path asks for too. Of one block that is the change.
#[inline(always)]
fn is_solved<T: Batch, K: Kernel<T>>(from: &K::Unknown, to: &K::Unknown, change: T, tolerance: T) -> T::Mask {
    if const { K::BLOCKS.len() > 1 } {
        return is_within::<T, _>(K::BLOCKS, from, to, tolerance);
    }
    change.le(tolerance)
}

/// The largest change after which no more than [`MOST`] iterations are enough, for the inverse of the rate of contraction.
#[inline(always)]
pub(super) fn reach<T: Batch>(inverse: T) -> T {
    units::<T>(LAST_CHANGE[1]) * tenth_power(inverse)
}

/// Whether after such a change no more than [`MOST`] iterations are enough that contract at this rate.
#[inline(always)]
pub(super) fn are_enough<T: Batch>(rate: T, change: T) -> T::Mask {
    (tenth_power(rate) * change).le(units::<T>(LAST_CHANGE[1]))
}

#[inline(always)]
fn tenth_power<T: Batch>(x: T) -> T {
    let square = x * x;
    let fourth = square * square;
    fourth * fourth * square
}

/// So many units of epsilon.
#[inline(always)]
fn units<T: Batch>(x: f64) -> T {
    T::of(x * T::EPSILON)
}
