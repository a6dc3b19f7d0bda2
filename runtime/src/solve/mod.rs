//! Solves the equations of successive steps, `left(x) = right(x)`.
//!
//! Successive solutions are samples of a smooth trajectory: the [`predictor`] continues them by one step, and in small steps the next solution
//! is known to many digits before anything is solved. A fixed-point iteration takes off the factor by which it contracts, about the angle turned
//! in a step, and mostly brings what is left below rounding. [`step`] is the whole story:
//!
//! 1. the fast path: one iteration from the prediction, of Newton's method a few;
//! 2. [fixed-point iterations](fixed_point), where they contract strongly;
//! 3. [Newton's method](newton); and what these two do not solve, once more as if nothing were remembered;
//! 4. the [rescue](rescue), a lane at a time: damped corrections and continuation, from nothing that is remembered;
//! 5. acceptance: the next state, inside the retraction's domain, and finite.
//!
//! The first, and the second of one step alone, are compiled for each kernel; all else once for all kernels with as many unknowns, through a table
//! ([`equation`]).
//!
//! A step is solved when its residual is what rounding leaves of the terms that it is made of, however they cancel. Mostly that is seen from the
//! size of its right side; where it is not, the residual is evaluated once more over numbers that carry their errors
//! ([`Equation::roundoff`](crate::kernel::Equation::roundoff)). What is [remembered](memory) saves time, and nothing else.

mod constants;
mod equation;
mod fixed_point;
mod memory;
mod newton;
mod predictor;
mod rescue;
pub(crate) mod step;

#[cfg(feature = "std")]
use crate::error::StepError;
#[cfg(feature = "std")]
use crate::kernel::{AtState, Kernel};
use crate::scalar::blocks::select;
use crate::scalar::{Batch, Components, Mask};

/// A solution of a step's equation, or what has become of the search for it.
#[derive(Clone, Copy)]
struct Solution<T: Batch, U, V> {
    /// Where the equation was evaluated the last time.
    point: U,
    /// The unknown, so near to that that it makes no difference.
    unknown: U,
    /// What is known of that point.
    evaluation: V,
    /// The lanes that are solved.
    solved: T::Mask,
    /// Those of them that are solved as on the fast path: alone they leave it only where it is not there.
    quick: T::Mask,
    iterations: T::Each<u32>,
    /// What is left, relative to the equation's terms.
    residual: T,
    /// The factor by which fixed-point iterations contract, as far as it is known.
    rate: T,
}

impl<T: Batch, U: Copy, V> Solution<T, U, V> {
    /// The same where the equation is seen through a table.
    #[inline(always)]
    fn without_evaluation(&self) -> Solution<T, U, ()> {
        let Self { point, unknown, solved, quick, iterations, residual, rate, .. } = *self;
        Solution { point, unknown, evaluation: (), solved, quick, iterations, residual, rate }
    }
}

/// Solves a step's equation from nothing that is remembered.
///
/// # Errors
/// If no solution is found.
#[cfg(feature = "std")]
pub(crate) fn cold<T: Batch, K: Kernel<T>>(equation: &AtState<'_, T, K>) -> Result<K::Unknown, StepError> {
    use crate::scalar::Work;
    let start = &equation.start();
    if const { <K::Unknown as Components<T>>::LENGTH == 0 } {
        return Ok(*start);
    }
    let work = rescue::Rescue { equation, blocks: equation.kernel.blocks(), start, lane: 0 };
    work.done().map(|rescued| rescued.unknown)
}

/// The next iterate, in the lanes that go on. One number alone goes on, or there is no next iterate: it is not to wait for what decides that.
#[inline(always)]
fn go_on<T: Batch, U: Components<T>>(again: T::Mask, next: &U, last: &U) -> U {
    if const { T::LANES == 1 } { *next } else { select(again, next, last) }
}

/// Counts one more in the lanes where the mask is true.
#[inline(always)]
fn count<T: Batch>(counts: &mut T::Each<u32>, mask: T::Mask) {
    for (lane, count) in counts.as_mut().iter_mut().enumerate() {
        *count = count.wrapping_add(u32::from(mask.lane(lane)));
    }
}
