//! What takes steps, whatever the scheme.

use super::report::{RunError, RunReport};
use super::{StepReport, Stepper};
use crate::error::{ParameterError, StepError};
use crate::scalar::{Real, Scalar};
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
}
