//! Systems as runs see them.

use core::fmt;

use super::System;
use crate::crossing::Event;
use crate::scalar::{Real, Scalar};

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
    /// The events of the description, by their names.
    fn events(&self) -> &'static [(&'static str, Event)];
    /// What is zero at one of them.
    fn event(&self, event: usize, state: &Self::State, time: f64, control: &Self::Control) -> f64;
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

    fn events(&self) -> &'static [(&'static str, Event)] {
        S::EVENTS
    }

    fn event(&self, event: usize, state: &S::State, time: f64, control: &S::Control) -> f64 {
        self.event_at(event, state, S::Scalar::of(time), control).to_f64()
    }
}
