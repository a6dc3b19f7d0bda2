//! Newton's iteration on a step's equation.

use super::stopping::{ROUNDOFF, relative, select};
use super::{Solution, SolutionOf, count};
use crate::kernel::{Components, Kernel};
use crate::scalar::{Batch, Mask};

/// More evaluations than any solvable step takes: convergence is quadratic once near, and a step that is not near after this many is too
/// large.
const MAX_EVALUATIONS: u32 = 40;
/// A residual up to here may be roundoff, in units of epsilon, where the last correction says that no more is left.
const STAGNATION: f64 = 256.0;
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

/// Solves the equation in the `wanted` lanes from `start` on; in other lanes the unknown stays where it is. Returns the size of the first
/// correction too.
///
/// A solution is found when the residual is down to roundoff, or near to it and the square of the last correction is below it. A correction
/// that makes the residual no smaller is halved.
///
/// Where terms cancel, the right side of a block may be roundoff and nothing else, as that of the torques on a body that moves straight on. It
/// says nothing about what roundoff is then. When a correction first fails, the terms' own size is asked for: it is how much the residual
/// changes with the unknown, which is changed by a few units in the last place.
#[inline(always)]
pub(super) fn solve<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    start: &K::Unknown,
    wanted: T::Mask,
) -> (SolutionOf<T, K>, T) {
    let none = T::Mask::splat(false);
    let [roundoff, stagnation] = [ROUNDOFF, STAGNATION].map(|limit| T::of(limit * T::EPSILON));
    let (mut unknown, mut residual) = (*start, T::of(f64::INFINITY));
    let (mut correction, mut scale) = (*start, T::of(1.0));
    let (mut moved, mut first) = (T::of(f64::INFINITY), T::of(0.0));
    let (mut trial, mut open, mut unsolved) = (*start, wanted, none);
    let mut iterations = T::all(0);
    let mut evaluations = 0;
    // the terms' size where it was asked for, in the order of these
    let (mut asked, mut terms) = (Terms::Unasked, K::Unknown::splat(T::of(0.0)));
    loop {
        let evaluation = kernel.evaluate(state, step, &trial);
        match asked {
            Terms::Unasked | Terms::Known => (),
            Terms::Perturbed => {
                (asked, terms, trial) = (Terms::Here, evaluation.residual, unknown);
                continue;
            }
            Terms::Here => {
                asked = Terms::Known;
                let mut i = 0;
                while i < K::Unknown::LENGTH {
                    let changed = (terms.as_ref()[i] - evaluation.residual.as_ref()[i]).abs();
                    terms.as_mut()[i] = T::of(1.0 / (PERTURBATION * T::EPSILON)) * changed;
                    i += 1;
                }
            }
        }
        let mut size = evaluation.right;
        let mut i = 0;
        while i < K::Unknown::LENGTH && asked == Terms::Known {
            size.as_mut()[i] = size.as_ref()[i].abs() + terms.as_ref()[i];
            i += 1;
        }
        let then = relative::<T, _>(K::BLOCKS, &evaluation.residual, &size);
        if !open.any() {
            return (Solution { unknown, evaluation, iterations, residual, unsolved }, first);
        }
        evaluations += 1;
        let better = open & then.below(residual);
        let missed = open & !better;
        unknown = select(better, &trial, &unknown);
        residual = T::select(better, then, residual);
        // the full correction was small and did not help: what is left is what rounding leaves
        let is_full = T::of(1.0).at_most(scale);
        let quadratic = T::of(16.0) * (moved * moved);
        let near = residual.at_most(stagnation) & (quadratic.at_most(T::of(T::EPSILON)) | !better);
        let solved = residual.at_most(roundoff) | (near & is_full);
        open = open & !solved;
        if asked == Terms::Unasked && evaluations > 1 && (missed & open).any() {
            asked = Terms::Perturbed;
            (residual, scale) = (T::select(open, T::of(f64::INFINITY), residual), T::of(1.0));
            let mut i = 0;
            while i < K::Unknown::LENGTH {
                let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
                trial.as_mut()[i] = T::of(1.0 + sign * PERTURBATION * T::EPSILON) * unknown.as_ref()[i];
                i += 1;
            }
            continue;
        }
        // nor is there anything to correct where the start is nowhere
        let lost = missed & open & (scale.below(T::of(SHORTEST)) | T::Mask::splat(evaluations == 1));
        unsolved = unsolved | lost;
        open = open & !lost;
        if evaluations == MAX_EVALUATIONS {
            // where it stagnates this was a slow way, but down to roundoff
            unsolved = unsolved | (open & !residual.at_most(stagnation));
            open = none;
        }
        if !open.any() {
            // the evaluation of the solution, unless it is this one
            if !missed.any() {
                return (Solution { unknown, evaluation, iterations, residual, unsolved }, first);
            }
            trial = unknown;
            continue;
        }
        let renewed = open & better;
        if renewed.any() {
            let newest = kernel.correction(state, step, &trial, &evaluation);
            correction = select(renewed, &newest, &correction);
            let size = relative::<T, _>(K::BLOCKS, &correction, &unknown);
            moved = T::select(renewed, size, moved);
            let is_first = evaluations == 1;
            first = T::select(renewed & T::Mask::splat(is_first), size, first);
            count::<T>(&mut iterations, renewed);
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
