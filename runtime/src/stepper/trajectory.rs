//! The motion as an iterator.

use core::fmt;

#[cfg(doc)]
use super::Stepper;
use super::Stepping;
use crate::error::StepError;
use crate::system::System;

/// The motion from a state on: [`Stepper::trajectory`].
pub struct Trajectory<'a, T: Stepping> {
    pub(super) stepper: &'a mut T,
    pub(super) state: <T::System as System>::State,
    pub(super) begun: bool,
    pub(super) ended: bool,
}

impl<T: Stepping> Iterator for Trajectory<'_, T> {
    /// A time, and the state then.
    type Item = Result<(f64, <T::System as System>::State), StepError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        if self.begun
            && let Err(error) = self.stepper.step_with(&mut self.state, &Default::default())
        {
            self.ended = true;
            return Some(Err(error));
        }
        self.begun = true;
        Some(Ok((self.stepper.now(), self.state.clone())))
    }
}

impl<T: Stepping> fmt::Debug for Trajectory<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { stepper, state, ended, .. } = self;
        let mut debug = f.debug_struct("Trajectory");
        debug
            .field("time", &stepper.now())
            .field("state", state)
            .field("ended", ended)
            .finish_non_exhaustive()
    }
}
