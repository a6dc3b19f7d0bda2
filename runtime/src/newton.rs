//! Newton's iteration on a [`Kernel`]'s equation.

use crate::error::StepError;
use crate::kernel::{Evaluation, Kernel};
use crate::scalar::Real;

/// More iterations than any solvable step takes: convergence is quadratic once near, and a step that is not near
/// after this many is too large.
pub const MAX_ITERATIONS: u32 = 24;

/// A residual this small, relative to the equation's terms, is roundoff: no further iteration can be told from noise.
const ROUNDOFF: f64 = 2.0;
/// Where rounding keeps the residual above [`ROUNDOFF`], it may stagnate up to here (in units of epsilon).
const STAGNATION: f64 = 256.0;

/// A solution of the step's equation.
#[derive(Clone, Copy, Debug)]
pub struct Solution<U, I> {
    /// The unknown.
    pub unknown: U,
    /// The equation evaluated there.
    pub evaluation: Evaluation<U, I>,
    /// Newton corrections made.
    pub iterations: u32,
    /// The residual's largest component relative to the right side's, in f64 whatever the scalar.
    pub residual: f64,
}

/// Solves the step's equation from `unknown` on, until the residual is down to roundoff or stagnates there.
///
/// Never panics and makes at most [`MAX_ITERATIONS`] corrections.
///
/// # Errors
/// [`StepError::NoConvergence`] if the residual does not come down to roundoff.
#[inline]
pub fn solve<T: Real, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    mut unknown: K::Unknown,
) -> Result<Solution<K::Unknown, K::Iterate>, StepError> {
    let epsilon = T::EPSILON.to_f64();
    let mut evaluation = kernel.evaluate(state, step, &unknown);
    let mut residual = relative(&evaluation);
    let mut iterations = 0;
    while !(residual <= ROUNDOFF * epsilon) {
        if iterations == MAX_ITERATIONS {
            if residual <= STAGNATION * epsilon {
                break; // a slow way, but down to roundoff
            }
            return Err(StepError::NoConvergence { iterations, residual });
        }
        iterations += 1;
        let correction = kernel.correction(state, step, &unknown, &evaluation);
        let candidate = subtract::<T, _>(unknown, &correction, T::of(1.0));
        let candidate_evaluation = kernel.evaluate(state, step, &candidate);
        let candidate_residual = relative(&candidate_evaluation);
        if candidate_residual < residual {
            (unknown, evaluation, residual) = (candidate, candidate_evaluation, candidate_residual);
        } else if residual <= STAGNATION * epsilon {
            break; // stagnation at roundoff: the better of the two stays
        } else {
            // far from the solution the full correction can overshoot: shorten it
            let Some(shorter) = backtrack(kernel, state, step, &unknown, &correction, residual) else {
                return Err(StepError::NoConvergence { iterations, residual });
            };
            (unknown, evaluation, residual) = shorter;
        }
    }
    Ok(Solution { unknown, evaluation, iterations, residual })
}

type Point<K, T> =
    (<K as Kernel<T>>::Unknown, Evaluation<<K as Kernel<T>>::Unknown, <K as Kernel<T>>::Iterate>, f64);

/// The first of the corrections scaled by ½, ¼, … that makes the residual smaller.
#[cold]
fn backtrack<T: Real, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    unknown: &K::Unknown,
    correction: &K::Unknown,
    residual: f64,
) -> Option<Point<K, T>> {
    let mut scale = 1.0;
    for _ in 0..10 {
        scale *= 0.5;
        let candidate = subtract::<T, _>(*unknown, correction, T::of(scale));
        let evaluation = kernel.evaluate(state, step, &candidate);
        let candidate_residual = relative(&evaluation);
        if candidate_residual < residual {
            return Some((candidate, evaluation, candidate_residual));
        }
    }
    None
}

#[inline(always)]
fn subtract<T: Real, U: AsRef<[T]> + AsMut<[T]>>(mut unknown: U, correction: &U, scale: T) -> U {
    for (x, d) in unknown.as_mut().iter_mut().zip(correction.as_ref()) {
        *x = *x - scale * *d;
    }
    unknown
}

/// The residual's largest component relative to the right side's; not-a-number if any component is.
#[inline(always)]
fn relative<T: Real, U: AsRef<[T]>, I>(evaluation: &Evaluation<U, I>) -> f64 {
    let residual = largest(evaluation.residual.as_ref());
    let right = largest(evaluation.right.as_ref());
    // a system at rest without forces: 0 = 0
    if residual == 0.0 && right == 0.0 { 0.0 } else { residual / right }
}

#[inline(always)]
fn largest<T: Real>(components: &[T]) -> f64 {
    let mut largest = 0.0;
    for component in components {
        let magnitude = component.abs().to_f64();
        // written so that not-a-number stays
        if !(magnitude <= largest) {
            largest = magnitude;
        }
    }
    largest
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use core::sync::atomic::{AtomicU32, Ordering};

    static EVALUATIONS: AtomicU32 = AtomicU32::new(0);

    /// Has no unknown, and counts how often it is evaluated.
    #[derive(Clone, Copy)]
    struct Explicit;

    impl Kernel<f64> for Explicit {
        type Parameters = [f64; 0];
        type State = [f64; 1];
        type Control = [f64; 0];
        type Unknown = [f64; 0];
        type Step = ();
        type Iterate = u32;

        fn new(_: &[f64; 0], _: f64) -> Self {
            Self
        }

        fn begin(&self, _: &[f64; 1], _: f64, _: &[f64; 0]) {}

        fn start(&self, _: &[f64; 1], _: &()) -> [f64; 0] {
            []
        }

        fn evaluate(&self, _: &[f64; 1], _: &(), _: &[f64; 0]) -> Evaluation<[f64; 0], u32> {
            let iterate = EVALUATIONS.fetch_add(1, Ordering::Relaxed);
            Evaluation { residual: [], right: [], iterate }
        }

        fn correction(&self, _: &[f64; 1], _: &(), _: &[f64; 0], _: &Evaluation<[f64; 0], u32>) -> [f64; 0] {
            unreachable!("nothing to correct")
        }

        fn domain(
            &self,
            _: &Self::State,
            _: &Self::Step,
            _: &[f64; 0],
            _: &Evaluation<[f64; 0], u32>,
        ) -> f64 {
            1.0
        }

        fn finish(&self, state: &[f64; 1], _: &(), _: &[f64; 0], _: &Evaluation<[f64; 0], u32>) -> [f64; 1] {
            *state
        }
    }

    #[test]
    fn without_an_unknown_the_equation_is_evaluated_once() {
        let solution = solve(&Explicit, &[1.0], &(), []).expect("nothing to solve");
        assert_eq!((solution.iterations, solution.residual), (0, 0.0));
        assert_eq!((solution.evaluation.iterate, EVALUATIONS.load(Ordering::Relaxed)), (0, 1));
    }
}
