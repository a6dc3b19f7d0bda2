//! Newton's iteration on a step's equation.

use super::stopping::{ROUNDOFF, relative, select};
use super::{Convergence, Solution, SolutionOf, count};
use crate::kernel::{Components, Kernel};
use crate::scalar::{Batch, Mask, Work};

/// More evaluations than any solvable step takes: convergence is quadratic once near, and a step that is not near after this many is too
/// large.
const MAX_EVALUATIONS: u32 = 40;
/// A residual up to here may be roundoff, in units of epsilon, where the last correction says that no more is left.
const STAGNATION: f64 = 256.0;
/// Below this a halved correction that makes the residual no smaller is none.
const SHORTEST: f64 = 1e-3;
/// By how much the unknown is changed to see how large the terms of its equation are, in units of epsilon.
const PERTURBATION: f64 = 4.0;

/// Evaluations of a step that is easy to solve, and one more.
const REGULAR: u32 = 8;

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

/// Solves the equation in the `wanted` lanes from `start` on; in other lanes the unknown stays where it is.
///
/// A solution is found when the residual is down to roundoff, or near to it and the square of the last correction is below it. A correction
/// that makes the residual no smaller is halved.
///
/// Where terms cancel, the right side of a block may be roundoff and nothing else, as that of the torques on a body that moves straight on. It
/// says nothing about what roundoff is then. When a correction first fails, the terms' own size is asked for: it is how much the residual
/// changes with the unknown, which is changed by a few units in the last place.
pub(super) fn solve<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    start: &K::Unknown,
    wanted: T::Mask,
) -> SolutionOf<T, K> {
    T::dispatch(Newton { kernel, state, step, start, wanted })
}

struct Newton<'a, T: Batch, K: Kernel<T>> {
    kernel: &'a K,
    state: &'a K::State,
    step: &'a K::Step,
    start: &'a K::Unknown,
    wanted: T::Mask,
}

impl<T: Batch, K: Kernel<T>> Work for Newton<'_, T, K> {
    type Home = K;
    type Result = SolutionOf<T, K>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { kernel, state, step, start, wanted } = self;
        let none = T::Mask::splat(false);
        let [roundoff, stagnation] = [ROUNDOFF, STAGNATION].map(|limit| T::of(limit * T::EPSILON));
        let mut unknown = *start;
        let mut convergence = Convergence::of_one(T::of(f64::INFINITY));
        convergence.iterations = T::all(0);
        let (mut correction, mut scale) = (*start, T::of(1.0));
        let mut moved = T::of(f64::INFINITY);
        let (mut trial, mut open, mut unsolved) = (*start, wanted, none);
        let mut evaluations = 0;
        if const { T::LANES == 1 } && wanted.all() {
            // Nearly always each correction makes the residual smaller until nothing is left. The same as below, where that is so, and in half of
            // the time: there is less to keep in mind.
            let mut stagnates = false;
            while evaluations < REGULAR {
                let evaluation = kernel.evaluate(state, step, &trial);
                let then = relative::<T, _>(K::BLOCKS, &evaluation.residual, &evaluation.right);
                evaluations += 1;
                let quadratic = (T::of(16.0) * (moved * moved)).le(T::of(T::EPSILON));
                if stagnates {
                    return Solution { unknown, evaluation, convergence, unsolved };
                }
                if !then.lt(convergence.residual).all() {
                    if !convergence.residual.le(stagnation).all() {
                        break;
                    }
                    (stagnates, trial) = (true, unknown);
                    continue;
                }
                (unknown, convergence.residual) = (trial, then);
                if (then.le(roundoff) | (then.le(stagnation) & quadratic)).all() {
                    return Solution { unknown, evaluation, convergence, unsolved };
                }
                correction = kernel.correction(state, step, &unknown, &evaluation);
                count::<T>(&mut convergence.iterations, wanted);
                moved = relative::<T, _>(K::BLOCKS, &correction, &unknown);
                if evaluations == 1 {
                    convergence.off = moved;
                }
                let mut i = 0;
                while i < K::Unknown::LENGTH {
                    trial.as_mut()[i] = unknown.as_ref()[i] - correction.as_ref()[i];
                    i += 1;
                }
            }
            // what is not so easy, from the start
            (unknown, trial, evaluations, moved) = (*start, *start, 0, T::of(f64::INFINITY));
            convergence = Convergence::of_one(T::of(f64::INFINITY));
            convergence.iterations = T::all(0);
        }
        let (mut asked, mut terms) = (Terms::Unasked, K::Unknown::splat(T::of(0.0)));
        loop {
            let evaluation = kernel.evaluate(state, step, &trial);
            let mut size = evaluation.right;
            if asked != Terms::Unasked {
                if asked == Terms::Perturbed {
                    (asked, terms, trial) = (Terms::Here, evaluation.residual, unknown);
                    continue;
                }
                let mut i = 0;
                while i < K::Unknown::LENGTH {
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
            let then = relative::<T, _>(K::BLOCKS, &evaluation.residual, &size);
            evaluations += 1;
            let better = then.lt(convergence.residual);
            let missed = open & !better;
            let quadratic = (T::of(16.0) * (moved * moved)).le(T::of(T::EPSILON));
            if missed.any() {
                unknown = select(open & better, &trial, &unknown);
                convergence.residual = T::select(open & better, then, convergence.residual);
                // the full correction was small and did not help: what is left is what rounding leaves
                let near = convergence.residual.le(stagnation) & (quadratic | missed) & T::of(1.0).le(scale);
                open = open & !(convergence.residual.le(roundoff) | near);
                if asked == Terms::Unasked && evaluations > 1 && (missed & open).any() {
                    asked = Terms::Perturbed;
                    scale = T::of(1.0);
                    convergence.residual = T::select(open, T::of(f64::INFINITY), convergence.residual);
                    let mut i = 0;
                    while i < K::Unknown::LENGTH {
                        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
                        trial.as_mut()[i] =
                            T::of(1.0 + sign * PERTURBATION * T::EPSILON) * unknown.as_ref()[i];
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
                let near = convergence.residual.le(stagnation) & quadratic & T::of(1.0).le(scale);
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
                let newest = kernel.correction(state, step, &trial, &evaluation);
                correction = if missed.any() { select(renewed, &newest, &correction) } else { newest };
                let size = relative::<T, _>(K::BLOCKS, &correction, &unknown);
                moved = T::select(renewed, size, moved);
                if evaluations == 1 {
                    convergence.off = size;
                }
                count::<T>(&mut convergence.iterations, renewed);
            }
            scale = T::select(better, T::of(1.0), T::of(0.5) * scale);
            let mut i = 0;
            while i < K::Unknown::LENGTH {
                let shorter = unknown.as_ref()[i] - scale * correction.as_ref()[i];
                trial.as_mut()[i] = T::select(open, shorter, unknown.as_ref()[i]);
                i += 1;
            }
        }
    }
}
