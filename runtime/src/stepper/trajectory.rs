//! The motion as an iterator.

use super::Stepping;
use crate::error::StepError;
use crate::system::Dynamics;

type StateOf<T> = <<T as Stepping>::System as Dynamics>::State;

/// The motion from a state on, without controls: times and states, the first one now, until a step could not be taken.
pub(crate) fn trajectory<T: Stepping>(
    stepper: &mut T,
    from: StateOf<T>,
) -> impl Iterator<Item = Result<(f64, StateOf<T>), StepError>> + '_ {
    let control = stepper.system().no_control();
    let (mut state, mut has_begun, mut has_ended) = (from, false, false);
    core::iter::from_fn(move || {
        if has_ended {
            return None;
        }
        if has_begun && let Err(error) = stepper.step_with(&mut state, &control) {
            has_ended = true;
            return Some(Err(error));
        }
        has_begun = true;
        Some(Ok((stepper.time(), state.clone())))
    })
}
