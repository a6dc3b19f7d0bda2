//! Newton's iteration with corrections that are halved where they are too long, in all lanes.

use super::newton::{STAGNATION, is_roundoff};
use super::stopping::{ROUNDOFF, relative, select};
use super::{Convergence, Solution, count};
use crate::kernel::{Corrected, Equation};
use crate::scalar::{Batch, Components, Mask, Work};

/// More evaluations than any solvable step takes: convergence is quadratic once near, and a step that is not near after this many is too
/// large.
const MAX_EVALUATIONS: u32 = 40;
/// Below this a halved correction that makes the residual no smaller is none.
const SHORTEST: f64 = 1e-3;
/// By how much the unknown is changed to see how large the terms of its equation are, in units of epsilon.
const PERTURBATION: f64 = 4.0;

/// Whether the size of the equation's terms is known.
#[derive(Clone, Copy, PartialEq)]
enum Terms {
    Unasked,
    /// The equation is being evaluated near the unknown.
    Perturbed,
    /// The equation is being evaluated at the unknown.
    Here,
    Known,
}

/// [`solve`], out of line: once for all equations with as many unknowns.
pub(super) struct Damped<'a, T: Batch, U> {
    pub equation: &'a dyn Corrected<U>,
    pub blocks: &'static [usize],
    pub start: &'a U,
    pub wanted: T::Mask,
}

impl<T: Batch, U: Components<T>> Work for Damped<'_, T, U> {
    type Home = ();
    type Result = Solution<T, U, U>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { equation, blocks, start, wanted } = self;
        solve(&equation, blocks, start, wanted)
    }
}

/// Solves the equation in the `wanted` lanes from `start` on; in other lanes the unknown stays where it is.
///
/// A solution is found when the residual is down to roundoff, or near to it and the square of the last correction is below it. A correction
/// that makes the residual no smaller is halved.
///
/// Where terms cancel, the right side of a block may be roundoff and nothing else, as that of the torques on a body that moves straight on. It
/// says nothing about what roundoff is then. When a correction first fails, the terms' own size is asked for: it is how much the residual
/// changes with the unknown, which is changed by a few units in the last place.
#[inline(always)]
pub(super) fn solve<T: Batch, U: Components<T>, E: Equation<U>>(
    equation: &E,
    blocks: &[usize],
    start: &U,
    wanted: T::Mask,
) -> Solution<T, U, E::Iterate> {
    let none = T::Mask::splat(false);
    let (roundoff, stagnation) = (T::of(ROUNDOFF * T::EPSILON), T::of(STAGNATION * T::EPSILON));
    let mut unknown = *start;
    let mut convergence = Convergence::of_one(T::of(f64::INFINITY));
    convergence.iterations = T::all(0);
    let (mut correction, mut scale) = (*start, T::of(1.0));
    let mut moved = T::of(f64::INFINITY);
    let (mut trial, mut open, mut unsolved) = (*start, wanted, none);
    let mut evaluations = 0;
    let (mut asked, mut terms) = (Terms::Unasked, U::splat(T::of(0.0)));
    loop {
        let evaluation = equation.evaluate(&trial);
        let mut size = evaluation.right;
        if asked != Terms::Unasked {
            if asked == Terms::Perturbed {
                (asked, terms, trial) = (Terms::Here, evaluation.residual, unknown);
                continue;
            }
            let mut i = 0;
            while i < U::LENGTH {
                if asked == Terms::Here {
                    let changed = (terms.as_ref()[i] - evaluation.residual.as_ref()[i]).abs();
                    terms.as_mut()[i] = T::of(1.0 / (PERTURBATION * T::EPSILON)) * changed;
                }
                size.as_mut()[i] = size.as_ref()[i].abs() + terms.as_ref()[i];
                i += 1;
            }
            asked = Terms::Known;
        }
        if !open.any() {
            return Solution { unknown, evaluation, convergence, unsolved };
        }
        let then = relative::<T, _>(blocks, &evaluation.residual, &size);
        evaluations += 1;
        let better = then.lt(convergence.residual);
        let missed = open & !better;
        if missed.any() {
            unknown = select(open & better, &trial, &unknown);
            convergence.residual = T::select(open & better, then, convergence.residual);
            // the full correction was small and did not help: what is left is what rounding leaves
            let near =
                is_roundoff(convergence.residual, moved) | (missed & convergence.residual.le(stagnation));
            let near = near & T::of(1.0).le(scale);
            open = open & !(convergence.residual.le(roundoff) | near);
            if asked == Terms::Unasked && evaluations > 1 && (missed & open).any() {
                asked = Terms::Perturbed;
                scale = T::of(1.0);
                convergence.residual = T::select(open, T::of(f64::INFINITY), convergence.residual);
                let mut i = 0;
                while i < U::LENGTH {
                    let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
                    trial.as_mut()[i] = T::of(1.0 + sign * PERTURBATION * T::EPSILON) * unknown.as_ref()[i];
                    i += 1;
                }
                continue;
            }
            // nor is there anything to correct where the start is nowhere
            let lost = missed & open & (scale.lt(T::of(SHORTEST)) | T::Mask::splat(evaluations == 1));
            unsolved = unsolved | lost;
            open = open & !lost;
        } else {
            // nearly always; where nothing is open it was evaluated again where it was
            (unknown, convergence.residual) = (trial, then);
            let near = is_roundoff(convergence.residual, moved) & T::of(1.0).le(scale);
            open = open & !(convergence.residual.le(roundoff) | near);
        }
        if evaluations == MAX_EVALUATIONS {
            // where it stagnates this was a slow way, but down to roundoff
            unsolved = unsolved | (open & !convergence.residual.le(stagnation));
            open = none;
        }
        if !open.any() {
            // the evaluation of the solution, unless it is this one
            if !missed.any() {
                return Solution { unknown, evaluation, convergence, unsolved };
            }
            trial = unknown;
            continue;
        }
        let renewed = open & better;
        if renewed.any() {
            let newest = equation.correction(&trial, &evaluation);
            correction = if missed.any() { select(renewed, &newest, &correction) } else { newest };
            let size = relative::<T, _>(blocks, &correction, &unknown);
            moved = T::select(renewed, size, moved);
            if evaluations == 1 {
                convergence.off = size;
            }
            count::<T>(&mut convergence.iterations, renewed);
        }
        scale = T::select(better, T::of(1.0), T::of(0.5) * scale);
        let mut i = 0;
        while i < U::LENGTH {
            let shorter = unknown.as_ref()[i] - scale * correction.as_ref()[i];
            trial.as_mut()[i] = T::select(open, shorter, unknown.as_ref()[i]);
            i += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Evaluation;

    /// `exp(64 (x − 1)) = 1`, of which each correction leaves 32 times its square.
    struct Curved;

    impl Equation<[f64; 1]> for Curved {
        type Iterate = f64;

        fn evaluate(&self, [x]: &[f64; 1]) -> Evaluation<[f64; 1], f64> {
            let left = (64.0 * (x - 1.0)).exp();
            Evaluation { residual: [left - 1.0], right: [1.0], iterate: 64.0 * left }
        }

        fn correction(&self, _: &[f64; 1], evaluation: &Evaluation<[f64; 1], f64>) -> [f64; 1] {
            [evaluation.residual[0] / evaluation.iterate]
        }
    }

    #[test]
    fn what_a_short_correction_leaves_is_not_taken_for_roundoff() {
        let mut from = 1e-6;
        while from < 1e-2 {
            let solution = solve(&Curved, &[1], &[1.0 + from], true);
            assert!(!solution.unsolved && solution.convergence.residual <= 8.0 * f64::EPSILON, "{from:e}");
            from *= 1.03;
        }
    }
}
