//! What a function is given that is called at an event.

use core::fmt;

use super::Crossing;
use crate::error::ParameterError;
use crate::system::Dynamics;

/// An event that has come: its moment, and what may be changed there.
///
/// What is changed acts from this moment on: the rest of the step is taken from here, and the steps behind it are where they were.
pub struct Occurrence<'a, S: Dynamics + ?Sized> {
    pub(super) crossing: Crossing,
    pub(super) moment: &'a mut (dyn Here<S> + 'a),
    pub(super) stops: bool,
}

/// A moment within a step.
pub struct Moment<'a, S: Dynamics + ?Sized> {
    pub(crate) time: f64,
    /// The state that led here.
    pub(crate) before: &'a S::State,
    /// The state with which it goes on.
    pub(crate) state: &'a mut S::State,
    pub(crate) control: &'a mut S::Control,
    /// Whether another control can be held.
    pub(crate) is_held: bool,
    pub(crate) stepper: &'a mut dyn SetParameters<S>,
    /// Whether anything was changed.
    pub(crate) is_changed: bool,
    pub(crate) is_control_changed: bool,
}

/// What a moment has.
pub(super) trait Here<S: Dynamics + ?Sized> {
    fn time(&self) -> f64;
    fn before(&self) -> &S::State;
    fn state(&self) -> &S::State;
    fn state_mut(&mut self) -> &mut S::State;
    fn control(&self) -> &S::Control;
    fn control_mut(&mut self) -> Option<&mut S::Control>;
    fn system(&self) -> &S;
    fn set_parameters(&mut self, parameters: &S::Parameters) -> Result<(), ParameterError>;
}

impl<S: Dynamics + ?Sized> Here<S> for Moment<'_, S> {
    fn time(&self) -> f64 {
        self.time
    }
    fn before(&self) -> &S::State {
        self.before
    }
    fn state(&self) -> &S::State {
        self.state
    }
    fn state_mut(&mut self) -> &mut S::State {
        self.is_changed = true;
        self.state
    }
    fn control(&self) -> &S::Control {
        self.control
    }
    fn control_mut(&mut self) -> Option<&mut S::Control> {
        if !self.is_held {
            return None;
        }
        (self.is_changed, self.is_control_changed) = (true, true);
        Some(self.control)
    }
    fn system(&self) -> &S {
        self.stepper.system()
    }
    fn set_parameters(&mut self, parameters: &S::Parameters) -> Result<(), ParameterError> {
        self.stepper.set_parameters(parameters)?;
        self.is_changed = true;
        Ok(())
    }
}

/// A stepper as far as an event may reach into it.
pub(crate) trait SetParameters<S: Dynamics + ?Sized> {
    fn system(&self) -> &S;
    fn set_parameters(&mut self, parameters: &S::Parameters) -> Result<(), ParameterError>;
}

impl<S: Dynamics + ?Sized> Occurrence<'_, S> {
    /// The time of the event, to rounding: the first number at which the quantity has passed zero, or is zero.
    pub fn time(&self) -> f64 {
        self.moment.time()
    }

    /// How zero was met.
    pub fn crossing(&self) -> Crossing {
        self.crossing
    }

    /// The system that moves.
    pub fn system(&self) -> &S {
        self.moment.system()
    }

    /// The state that led here: the limit from before.
    pub fn before(&self) -> &S::State {
        self.moment.before()
    }

    /// The state with which the motion goes on: the limit from behind. It is that [before](Self::before) but for what this event, and others of this moment
    /// that were added earlier, have changed.
    pub fn state(&self) -> &S::State {
        self.moment.state()
    }

    /// The state with which the motion goes on, to be changed.
    pub fn state_mut(&mut self) -> &mut S::State {
        self.moment.state_mut()
    }

    /// The control here: that held over the step, or the input at this time.
    pub fn control(&self) -> &S::Control {
        self.moment.control()
    }

    /// The control, to be changed: that of the rest of the step, and for as long as no law chooses another. None where the run is
    /// [driven](crate::Run::driven_by): the input is a function of time.
    pub fn control_mut(&mut self) -> Option<&mut S::Control> {
        self.moment.control_mut()
    }

    /// Takes the steps of a system with other parameters from here on: a system of the same type, or a list of its parameters where types are
    /// [erased](crate::erased).
    ///
    /// # Errors
    /// If they are not those of a system that can move; nothing has changed then.
    pub fn set_parameters(&mut self, parameters: &S::Parameters) -> Result<(), ParameterError> {
        self.moment.set_parameters(parameters)
    }

    /// Ends the run here, as a [terminal](super::Event::terminal) event does.
    pub fn stop(&mut self) {
        self.stops = true;
    }
}

impl<S: Dynamics + ?Sized> fmt::Debug for Occurrence<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Occurrence")
            .field("time", &self.time())
            .field("crossing", &self.crossing)
            .field("state", self.state())
            .finish_non_exhaustive()
    }
}
