//! What takes steps, whatever the scheme.

use super::report::{RunError, RunReport};
use super::{StepReport, Stepper};
use crate::error::{ParameterError, StepError};
use crate::scalar::{Real, Scalar};
use crate::system::series::Coefficients;
use crate::system::{Dynamics, MethodOf, System};

/// What takes steps: a [`Stepper`] of whatever scheme.
///
/// As `dyn Stepping<System = S>` it is one whose scheme is chosen while the program runs:
///
/// ```
/// use coadjoint::prelude::*;
/// use coadjoint::{Run, System};
/// use coadjoint::stepper::Stepping;
///
/// #[lie_poisson_system(group = SO3)]
/// struct Body {
///     #[inertia]
///     inertia: Vector3<f64>,
/// }
///
/// fn stepper(body: &Body, scheme: &str) -> Result<Box<dyn Stepping<System = Body>>, ParameterError> {
///     Ok(match scheme {
///         "cayley" => Box::new(body.stepper::<Cayley>(0.1)?),
///         _ => Box::new(body.stepper::<Exponential>(0.1)?),
///     })
/// }
///
/// let body = Body { inertia: vector![1.0, 2.0, 2.5] };
/// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.4, -0.8, 1.5] };
/// let report = Run::new(stepper(&body, "cayley")?.as_mut(), &mut state).steps(10)?;
/// assert_eq!(report.steps, 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Stepping {
    /// The system that it takes steps of.
    type System: Dynamics + ?Sized;

    /// [`Stepper::system`]
    fn system(&self) -> &Self::System;
    /// [`Stepper::time`]
    fn time(&self) -> f64;
    /// [`Stepper::set_time`]
    fn set_time(&mut self, time: f64);
    /// [`Stepper::steps_taken`]
    fn steps_taken(&self) -> u64;
    /// [`Stepper::step_size`]
    fn step_size(&self) -> f64;
    /// [`Stepper::set_step_size`]
    ///
    /// # Errors
    /// As there.
    fn set_step_size(&mut self, step: f64) -> Result<(), ParameterError>;
    /// Whether steps are as long as a tolerance allows: [Taylor steps](crate::taylor::Adaptive).
    fn is_adaptive(&self) -> bool {
        false
    }
    /// Takes no step past this time from now on, if steps are as long as a tolerance allows; an infinite time is none.
    fn set_end(&mut self, _time: f64) {}
    /// Whether that time is reached.
    fn has_ended(&self) -> bool {
        false
    }
    /// [`Stepper::snapshot`]
    #[cfg(feature = "std")]
    fn snapshot(&self) -> std::vec::Vec<f64>;
    /// [`Stepper::restore`]
    ///
    /// # Errors
    /// As there.
    fn restore(&mut self, memory: &[f64]) -> Result<(), ParameterError>;
    /// [`Stepper::step_with`]
    ///
    /// # Errors
    /// As there.
    fn step_with(
        &mut self,
        state: &mut <Self::System as Dynamics>::State,
        control: &<Self::System as Dynamics>::Control,
    ) -> Result<StepReport, StepError>;
    /// [`Stepper::step_driven`]
    ///
    /// # Errors
    /// As there.
    fn step_driven(
        &mut self,
        state: &mut <Self::System as Dynamics>::State,
        input: &mut dyn FnMut(f64) -> <Self::System as Dynamics>::Control,
    ) -> Result<StepReport, StepError>;
    /// [`Stepper::steps_with`]
    ///
    /// # Errors
    /// As there.
    fn steps_with(
        &mut self,
        state: &mut <Self::System as Dynamics>::State,
        control: &<Self::System as Dynamics>::Control,
        count: u64,
    ) -> Result<RunReport, RunError>;

    /// Takes other parameters: [`Stepper::set_system`], or of a system whose type is erased
    /// [`set_parameters`](crate::erased::Stepper::set_parameters).
    ///
    /// # Errors
    /// As there.
    #[doc(hidden)]
    fn set_parameters(
        &mut self,
        parameters: &<Self::System as Dynamics>::Parameters,
    ) -> Result<(), ParameterError>;
    /// Takes a step from a start and of a length of its own, beside those that this stepper takes: it is as before.
    ///
    /// # Errors
    /// As [`Stepper::step_with`]; the state is then as before.
    #[doc(hidden)]
    fn step_beside(
        &self,
        state: &mut <Self::System as Dynamics>::State,
        from: (f64, f64),
        input: Inputs<'_, <Self::System as Dynamics>::Control>,
    ) -> Result<StepReport, StepError>;
    /// What knows the power series of events of the description, if anything does.
    #[doc(hidden)]
    fn event_series(&self) -> Option<&dyn EventSeries<Self::System>> {
        None
    }
    /// The next step starts at this time, after so many steps.
    #[doc(hidden)]
    fn go_on_at(&mut self, time: f64, steps: u64);
}

/// Knows the power series of events of a description.
#[doc(hidden)]
pub trait EventSeries<S: Dynamics + ?Sized> {
    /// Writes the series of an event from a state on, over a time that starts somewhere and has a length, or over a share of it where what acts is
    /// not known further. How many coefficients there are, and that share, in which they are. None if there is none.
    fn expand(
        &self,
        event: usize,
        state: &S::State,
        from: (f64, f64),
        input: Inputs<'_, S::Control>,
        coefficients: &mut Coefficients,
    ) -> Option<(usize, f64)>;
}

/// What acts on the system over a step.
#[doc(hidden)]
pub enum Inputs<'a, C> {
    /// A control that is held.
    Held(&'a C),
    /// A function of time.
    Driven(&'a mut dyn FnMut(f64) -> C),
}

impl<C> Inputs<'_, C> {
    /// The same, once more.
    pub(crate) fn again(&mut self) -> Inputs<'_, C> {
        match self {
            Self::Held(control) => Inputs::Held(control),
            Self::Driven(input) => Inputs::Driven(input),
        }
    }
}

/// The calls that are the stepper's own, whatever its type.
macro_rules! as_by_itself {
    () => {
        #[inline]
        fn time(&self) -> f64 {
            Self::time(self)
        }

        #[inline]
        fn set_time(&mut self, time: f64) {
            Self::set_time(self, time);
        }

        #[inline]
        fn steps_taken(&self) -> u64 {
            Self::steps_taken(self)
        }

        #[cfg(feature = "std")]
        #[inline]
        fn snapshot(&self) -> std::vec::Vec<f64> {
            Self::snapshot(self)
        }

        #[inline]
        fn restore(&mut self, memory: &[f64]) -> Result<(), crate::error::ParameterError> {
            Self::restore(self, memory)
        }
    };
}
#[cfg(feature = "std")]
pub(crate) use as_by_itself;

impl<S: System, M, D: MethodOf<S>> Stepping for Stepper<S, M, D> {
    type System = S;

    #[inline]
    fn system(&self) -> &S {
        &self.system
    }

    as_by_itself!();

    #[inline]
    fn step_size(&self) -> f64 {
        self.step.to_f64()
    }

    #[inline]
    fn set_step_size(&mut self, step: f64) -> Result<(), ParameterError> {
        Stepper::set_step_size(self, S::Scalar::of(step))
    }

    #[inline]
    fn step_with(&mut self, state: &mut S::State, control: &S::Control) -> Result<StepReport, StepError> {
        self.step_apart(state, control)
    }

    fn step_driven(
        &mut self,
        state: &mut S::State,
        input: &mut dyn FnMut(f64) -> S::Control,
    ) -> Result<StepReport, StepError> {
        Stepper::step_driven(self, state, input)
    }

    #[inline]
    fn steps_with(
        &mut self,
        state: &mut S::State,
        control: &S::Control,
        count: u64,
    ) -> Result<RunReport, RunError> {
        Stepper::steps_with(self, state, control, count)
    }

    fn set_parameters(&mut self, system: &S) -> Result<(), ParameterError> {
        self.set_system(system)
    }

    fn step_beside(
        &self,
        state: &mut S::State,
        (start, length): (f64, f64),
        input: Inputs<'_, S::Control>,
    ) -> Result<StepReport, StepError> {
        // it is built of what this one was built of
        let beside = Self::new(&self.system, S::Scalar::of(length));
        let mut beside = beside.map_err(|_| StepError::NotFinite)?;
        beside.set_time(start);
        match input {
            Inputs::Held(control) => beside.step_apart(state, control),
            Inputs::Driven(input) => beside.step_driven(state, input),
        }
    }

    fn go_on_at(&mut self, time: f64, steps: u64) {
        (self.start, self.taken, self.before, self.left) = (time, 0, steps, None);
    }
}
