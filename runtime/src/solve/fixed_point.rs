//! Fixed-point iteration on a step's equation, `x ← L⁻¹ right(x)`, or, where the right side is `n(x)/(1 + d(x))`, `x ← L⁻¹ n(x) − d(x) x`: no
//! iterate waits for a division.

use super::constants::{FAR, FEW, ITERATIONS, QUICK, STRONG, TOLERANCE};
use super::equation::{Facts, Iterated};
use super::memory::{Convergence, Memory, is_left, rate, tolerance};
use super::newton::is_found_from_start;
use super::{Solution, count, go_on};
use crate::scalar::blocks::{change, is_within};
use crate::scalar::{Batch, Components, Mask};

/// Iterates from a guess, in lanes where it is to be [tried](Memory::tries), as long as iterations contract strongly;
/// `first` is where the first one led to, if it was made.
///
/// What is left after an iteration is its change times the rate of contraction: that of the changes before, as long as these were more than
/// rounding, or the one that was known before.
#[inline(always)]
pub(super) fn solve<T: Batch, U: Components<T>, E: Iterated<T, U> + ?Sized>(
    equation: &E,
    facts: &Facts<'_>,
    memory: &Memory<T, U>,
    guess: &U,
    first: Option<U>,
) -> Solution<T, U, E::Evaluation> {
    let Facts { blocks, convergence, .. } = *facts;
    let none = T::Mask::splat(false);
    let (mut point, mut unknown) = (*guess, *guess);
    let (mut solved, mut quick, mut again) = (none, none, memory.tries());
    // of changes, one after the other, that are no rounding
    let (mut iterations, mut residual, mut sharp) = (T::all(0), T::of(0.0), [T::of(1.0), memory.rate]);
    let (mut last, mut round) = (T::of(FAR), 0);
    let start = if facts.finds_any { Some(equation.start()) } else { None };
    let is_as_fast = memory.is_as_fast(convergence);
    let few = if convergence.is_newton() { FEW + 1 } else { 1 };
    let mut measures = !is_as_fast;
    if let Some(first) = first {
        (unknown, round, iterations) = (first, 1, T::all(1));
        last = change::<T, _>(blocks, guess, &first);
        solved = is_within::<T, _>(blocks, guess, &first, memory.tolerance);
        quick = solved;
        residual = memory.tolerance;
        again = again & !solved;
    }
    let evaluation = loop {
        // the other lanes wait
        point = go_on::<T, _>(again, &unknown, &point);
        let (next, evaluation) = equation.iterate(&point);
        unknown = go_on::<T, _>(again, &next, &unknown);
        round += 1;
        count::<T>(&mut iterations, again);
        let now = change::<T, _>(blocks, &point, &unknown);
        let (least, most) = (T::of(TOLERANCE[0] * T::EPSILON), T::of(TOLERANCE[2] * T::EPSILON));
        if round > 1 {
            let mut is_sharp = again & convergence.shows(last);
            if convergence.is_newton() {
                // what is below is rounding, and no rate where there is another one
                is_sharp = is_sharp & (least.lt(now) | T::of(1.0).le(sharp[0]));
            }
            sharp = [T::select(is_sharp, last, sharp[0]), T::select(is_sharp, now, sharp[1])];
        }
        let mut is_last = none;
        if is_as_fast.any() {
            is_last = again & is_as_fast & now.le(memory.tolerance) & is_left(convergence, now, last);
        }
        if !is_as_fast.all() {
            let is_small = if round == 1 {
                is_within::<T, _>(blocks, &point, &unknown, memory.tolerance)
            } else {
                let most = match convergence {
                    Convergence::Linear => most,
                    _ => tolerance(rate(convergence, sharp, memory.rate), convergence),
                };
                now.le(least) | (now.le(most) & sharp[1].le(T::of(QUICK) * sharp[0]))
            };
            is_last = is_last | (again & !is_as_fast & is_small);
        }
        if let Some(start) = &start {
            // it may be another solution
            let is_far = !is_found_from_start(equation, blocks, start, &unknown, is_last);
            (is_last, again) = (is_last & !is_far, again & !is_far);
        }
        solved = solved | is_last;
        if round <= few {
            quick = quick | is_last;
        }
        residual = T::select(is_last, now, residual);
        let goes_on = now.le(T::of(STRONG) * last) | (is_as_fast & T::Mask::splat(round < few));
        again = again & !is_last & goes_on & T::Mask::splat(round < ITERATIONS);
        if round == few {
            measures = measures | again;
        }
        if !again.any() {
            break evaluation;
        }
        last = now;
    };
    let rate = T::select(measures, rate(convergence, sharp, memory.rate), memory.rate);
    let residual = convergence.left(rate, residual);
    Solution { point, unknown, evaluation, solved, quick, iterations, residual, rate }
}
