//! Newton's iteration on a step's equation.

use super::damped::{self, Damped};
use super::stopping::{ROUNDOFF, relative};
use super::{Convergence, Solution, SolutionOf, count};
use crate::kernel::{AtState, Corrected, Equation, Kernel};
use crate::scalar::{Batch, Components, Mask, Work};

/// A residual up to here may be roundoff, in units of epsilon, where the last correction says that no more is left.
pub(super) const STAGNATION: f64 = 256.0;
/// A residual up to here makes hardly a difference, in units of epsilon.
const SMALL: f64 = 8.0;
/// What the square of the last correction is multiplied by for what is left after it: where hardly a difference is made, and where much is.
const CURVATURE: [f64; 2] = [16.0, 1_048_576.0];
/// Evaluations of a step that is easy to solve, and one more.
const REGULAR: u32 = 8;

/// Solves the equation in the `wanted` lanes from `start` on; in other lanes the unknown stays where it is.
///
/// A solution is found when the residual is down to roundoff, or near to it and the square of the last correction is below it.
pub(super) fn solve<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    start: &K::Unknown,
    wanted: T::Mask,
) -> SolutionOf<T, K> {
    T::dispatch(Newton { equation: AtState { kernel, state, step }, start, wanted })
}

/// Whether a residual is down to roundoff: or near to it, after a correction of this size whose square is below it.
#[inline(always)]
pub(super) fn is_roundoff<T: Batch>(residual: T, moved: T) -> T::Mask {
    let (epsilon, square) = (T::of(T::EPSILON), moved * moved);
    let [hardly, much] = CURVATURE;
    let small = residual.le(T::of(SMALL) * epsilon) & (T::of(hardly) * square).le(epsilon);
    let large = residual.le(T::of(STAGNATION) * epsilon) & (T::of(much) * square).le(epsilon);
    residual.le(T::of(ROUNDOFF) * epsilon) | small | large
}

struct Newton<'a, T: Batch, K: Kernel<T>> {
    equation: AtState<'a, T, K>,
    start: &'a K::Unknown,
    wanted: T::Mask,
}

impl<T: Batch, K: Kernel<T>> Work for Newton<'_, T, K> {
    type Home = K;
    type Result = SolutionOf<T, K>;

    // Nearly always each correction makes the residual smaller until nothing is left. The same as the damped iteration, where that is so, and in
    // half of the time: there is less to keep in mind.
    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { equation, start, wanted } = self;
        if const { T::LANES > 1 } {
            return damped::solve(&equation, K::BLOCKS, start, wanted);
        }
        let stagnation = T::of(STAGNATION * T::EPSILON);
        let (mut unknown, mut trial, mut unsolved) = (*start, *start, T::Mask::splat(false));
        let mut convergence = Convergence::of_one(T::of(f64::INFINITY));
        convergence.iterations = T::all(0);
        let mut moved = T::of(f64::INFINITY);
        let (mut evaluations, mut is_solved) = (0, !wanted.any());
        loop {
            let evaluation = equation.evaluate(&trial);
            if is_solved {
                return Solution { unknown, evaluation, convergence, unsolved };
            }
            let then = relative::<T, _>(K::BLOCKS, &evaluation.residual, &evaluation.right);
            evaluations += 1;
            let is_better = then.lt(convergence.residual).all();
            if is_better {
                (unknown, convergence.residual) = (trial, then);
                if is_roundoff(then, moved).all() {
                    return Solution { unknown, evaluation, convergence, unsolved };
                }
            } else if convergence.residual.le(stagnation).all() {
                (is_solved, trial) = (true, unknown);
                continue;
            }
            if !is_better || evaluations == REGULAR {
                // what is not so easy, from the start; through a table, so that it is compiled once for all kernels
                let equation: &dyn Corrected<K::Unknown> = &equation;
                let solution = T::dispatch(Damped { equation, blocks: K::BLOCKS, start, wanted });
                (unknown, trial, is_solved) = (solution.unknown, solution.unknown, true);
                (convergence, unsolved) = (solution.convergence, solution.unsolved);
                continue;
            }
            let correction = equation.correction(&unknown, &evaluation);
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
    }
}
