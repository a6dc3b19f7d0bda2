//! Systems as runs see them.

use core::fmt;

use super::System;

/// A system as a [`Run`](crate::Run) sees it: its type known, or erased.
///
/// Every [`System`] is one, and `dyn` [`erased::System`](crate::erased::System), whose states and controls are lists of numbers.
#[doc(hidden)]
pub trait Dynamics {
    /// The state.
    type State: Clone + fmt::Debug;
    /// The controls, held over a step.
    type Control: Clone + fmt::Debug;
    /// What another system of the same kind is told by: a system, or the numbers of its parameters.
    type Parameters: ?Sized;

    /// Names the system.
    fn name(&self) -> &'static str;
    /// Returns controls that are all zero.
    fn no_control(&self) -> Self::Control;
}

impl<S: System> Dynamics for S {
    type State = S::State;
    type Control = S::Control;
    type Parameters = S;

    fn name(&self) -> &'static str {
        S::NAME
    }

    #[inline]
    fn no_control(&self) -> S::Control {
        S::Control::default()
    }
}
