//! The motion as an iterator.

use core::fmt;

#[cfg(doc)]
use super::Stepper;
use super::Stepping;
use crate::error::StepError;
use crate::system::Dynamics;

/// The motion from a state on: [`Stepper::trajectory`].
pub struct Trajectory<'a, T: Stepping> {
    stepper: &'a mut T,
    state: <T::System as Dynamics>::State,
    begun: bool,
    ended: bool,
}

impl<'a, T: Stepping> Trajectory<'a, T> {
    pub(crate) fn new(stepper: &'a mut T, state: <T::System as Dynamics>::State) -> Self {
        Self { stepper, state, begun: false, ended: false }
    }
}

impl<T: Stepping> Iterator for Trajectory<'_, T> {
    /// A time, and the state then.
    type Item = Result<(f64, <T::System as Dynamics>::State), StepError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        if self.begun
            && let Err(error) = {
                let control = self.stepper.system().no_control();
                self.stepper.step_with(&mut self.state, &control)
            }
        {
            self.ended = true;
            return Some(Err(error));
        }
        self.begun = true;
        Some(Ok((self.stepper.time(), self.state.clone())))
    }
}

impl<T: Stepping> fmt::Debug for Trajectory<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { stepper, state, ended, .. } = self;
        let mut debug = f.debug_struct("Trajectory");
        debug
            .field("time", &stepper.time())
            .field("state", state)
            .field("ended", ended)
            .finish_non_exhaustive()
    }
}
