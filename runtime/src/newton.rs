//! Newton's iteration on a [`Kernel`]'s equation.

use crate::kernel::{Components, Evaluation, Kernel};
use crate::scalar::{Batch, Mask, Scalar, Work};

/// More iterations than any solvable step takes: convergence is quadratic once near, and a step that is not near
/// after this many is too large.
pub const MAX_ITERATIONS: u32 = 24;

/// A residual this small, relative to the equation's terms, is roundoff: no further iteration can be told from noise.
const ROUNDOFF: f64 = 2.0;
/// Where rounding keeps the residual above [`ROUNDOFF`], it may stagnate up to here (in units of epsilon).
const STAGNATION: f64 = 256.0;
/// Down there a correction that is no noise makes the residual smaller by far more than this factor.
const PROGRESS: f64 = 0.25;

/// A solution of the step's equation.
#[derive(Clone, Copy, Debug)]
pub struct Solution<T: Batch, U, I> {
    /// The unknown.
    pub unknown: U,
    /// The equation evaluated there, or so near that it makes no difference.
    pub evaluation: Evaluation<U, I>,
    /// Iterations made.
    pub iterations: T::Each<u32>,
    /// The residual's size relative to the right side's, as sums of magnitudes.
    pub residual: T,
    /// The lanes in which the residual did not come down to roundoff.
    pub unsolved: T::Mask,
}

/// The solution of a kernel's equation.
pub type SolutionOf<T, K> = Solution<T, <K as Kernel<T>>::Unknown, <K as Kernel<T>>::Iterate>;

/// Solves the step's equation in the `wanted` lanes from `start` on, until the residual is down to roundoff or stagnates there; in other
/// lanes the unknown stays where it starts.
///
/// Never panics and makes at most [`MAX_ITERATIONS`] corrections.
pub fn solve<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    start: &K::Unknown,
    wanted: T::Mask,
) -> SolutionOf<T, K> {
    T::outline(Solve { kernel, state, step, start, wanted })
}

struct Solve<'a, T: Batch, K: Kernel<T>> {
    kernel: &'a K,
    state: &'a K::State,
    step: &'a K::Step,
    start: &'a K::Unknown,
    wanted: T::Mask,
}

impl<T: Batch, K: Kernel<T>> Work for Solve<'_, T, K> {
    type Home = K;
    type Result = SolutionOf<T, K>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { kernel, state, step, start, wanted } = self;
        let roundoff = T::of(ROUNDOFF * T::EPSILON);
        let stagnation = T::of(STAGNATION * T::EPSILON);
        let mut unknown = *start;
        let mut evaluation = evaluated(kernel, state, step, &unknown);
        let mut residual = relative(&evaluation);
        let mut open = wanted & !residual.at_most(roundoff);
        let mut unsolved = T::Mask::splat(false);
        let mut iterations = T::all(0);
        for round in 0.. {
            if !open.any() {
                break;
            }
            if round == MAX_ITERATIONS {
                // where it stagnates this was a slow way, but down to roundoff
                unsolved = unsolved | (open & !residual.at_most(stagnation));
                break;
            }
            count::<T>(&mut iterations, open);
            let correction = kernel.correction(state, step, &unknown, &evaluation);
            let candidate = subtract(open, &unknown, &correction, T::of(1.0));
            let there = evaluated(kernel, state, step, &candidate);
            let then = relative(&there);
            let better = open & then.below(residual);
            let worse = open & !better;
            let stagnates = residual.at_most(stagnation) & !then.at_most(T::of(PROGRESS) * residual);
            if !worse.any() {
                // where nothing was wanted, nothing has changed
                (unknown, evaluation) = (candidate, there);
                residual = T::select(open, then, residual);
            } else {
                let before = unknown;
                unknown = select(better, &candidate, &before);
                residual = T::select(better, then, residual);
                // far from the solution the full correction can overshoot: shorten it
                let far = worse & !stagnates;
                if far.any() {
                    let (unknown, correction, residual) = (&mut unknown, &correction, &mut residual);
                    let backtrack = Backtrack { kernel, state, step, unknown, correction, residual, far };
                    let lost = T::outline(backtrack);
                    unsolved = unsolved | lost;
                    open = open & !lost;
                }
                if better.any() || far.any() {
                    evaluation = evaluated(kernel, state, step, &unknown);
                }
            }
            // stagnation at roundoff: the better of the two stays
            open = open & !stagnates & !residual.at_most(roundoff);
        }
        Solution { unknown, evaluation, iterations, residual, unsolved }
    }
}

/// [`Kernel::evaluate`] outside of line: where the same is done in several places, one of them is enough to compile.
pub(crate) fn evaluated<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    unknown: &K::Unknown,
) -> Evaluation<K::Unknown, K::Iterate> {
    T::outline(Evaluate { kernel, state, step, unknown })
}

struct Evaluate<'a, T: Scalar, K: Kernel<T>> {
    kernel: &'a K,
    state: &'a K::State,
    step: &'a K::Step,
    unknown: &'a K::Unknown,
}

impl<T: Batch, K: Kernel<T>> Work for Evaluate<'_, T, K> {
    type Home = K;
    type Result = Evaluation<K::Unknown, K::Iterate>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        self.kernel.evaluate(self.state, self.step, self.unknown)
    }
}

/// The first of the corrections scaled by ½, ¼, … that makes the residual smaller. Returns the `far` lanes in which none does.
struct Backtrack<'a, T: Batch, K: Kernel<T>> {
    kernel: &'a K,
    state: &'a K::State,
    step: &'a K::Step,
    unknown: &'a mut K::Unknown,
    correction: &'a K::Unknown,
    residual: &'a mut T,
    far: T::Mask,
}

impl<T: Batch, K: Kernel<T>> Work for Backtrack<'_, T, K> {
    type Home = K;
    type Result = T::Mask;

    #[inline(always)]
    fn done(self) -> T::Mask {
        let Self { kernel, state, step, unknown, correction, residual, far } = self;
        let mut open = far;
        let mut scale = 1.0;
        for _ in 0..10 {
            scale *= 0.5;
            let candidate = subtract(open, unknown, correction, T::of(scale));
            let then = relative(&evaluated(kernel, state, step, &candidate));
            let better = open & then.below(*residual);
            *unknown = select(better, &candidate, unknown);
            *residual = T::select(better, then, *residual);
            open = open & !better;
            if !open.any() {
                break;
            }
        }
        open
    }
}

/// What is counted in each lane, together.
#[inline(always)]
pub(crate) fn sum<T: Batch>(mut a: T::Each<u32>, b: T::Each<u32>) -> T::Each<u32> {
    for (a, b) in a.as_mut().iter_mut().zip(b.as_ref()) {
        *a += *b;
    }
    a
}

/// Counts one more in the lanes where the mask is true.
#[inline(always)]
pub(crate) fn count<T: Batch>(counts: &mut T::Each<u32>, mask: T::Mask) {
    for (lane, count) in counts.as_mut().iter_mut().enumerate() {
        *count = count.saturating_add(u32::from(mask.lane(lane)));
    }
}

/// `yes` where the mask is true, `no` elsewhere.
#[inline(always)]
pub(crate) fn select<T: Batch, U: Components<T>>(mask: T::Mask, yes: &U, no: &U) -> U {
    let mut selected = *no;
    for (selected, yes) in selected.as_mut().iter_mut().zip(yes.as_ref()) {
        *selected = T::select(mask, *yes, *selected);
    }
    selected
}

/// `unknown − scale correction` where the mask is true.
#[inline(always)]
fn subtract<T: Batch, U: Components<T>>(mask: T::Mask, unknown: &U, correction: &U, scale: T) -> U {
    // a correction that is not wanted need not be finite
    let mut moved = *unknown;
    for (moved, correction) in moved.as_mut().iter_mut().zip(correction.as_ref()) {
        *moved = *moved - scale * *correction;
    }
    select(mask, &moved, unknown)
}

/// The residual's size relative to the right side's; not-a-number if any component is.
#[inline(always)]
fn relative<T: Batch, U: AsRef<[T]>, I>(evaluation: &Evaluation<U, I>) -> T {
    let residual = size(evaluation.residual.as_ref());
    let right = size(evaluation.right.as_ref());
    // a system at rest without forces: 0 = 0
    let nothing = T::of(0.0);
    let is_zero = residual.at_most(nothing) & right.at_most(nothing);
    T::select(is_zero, nothing, residual / right)
}

/// The sum of the magnitudes.
#[inline(always)]
pub(crate) fn size<T: Batch>(components: &[T]) -> T {
    let mut sum = T::of(0.0);
    for component in components {
        sum = sum + component.abs();
    }
    sum
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

        fn sweep(&self, _: &[f64; 1], _: &(), _: &[f64; 0]) -> Option<[f64; 0]> {
            None
        }

        fn finish(&self, state: &[f64; 1], _: &(), _: &[f64; 0], _: &Evaluation<[f64; 0], u32>) -> [f64; 1] {
            *state
        }
    }

    #[test]
    fn without_an_unknown_the_equation_is_evaluated_once() {
        let solution = solve(&Explicit, &[1.0], &(), &[], true);
        assert_eq!((solution.iterations, solution.residual, solution.unsolved), ([0], 0.0, false));
        assert_eq!((solution.evaluation.iterate, EVALUATIONS.load(Ordering::Relaxed)), (0, 1));
    }
}
