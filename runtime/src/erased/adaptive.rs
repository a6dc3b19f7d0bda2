//! Taylor steps of any system.

use core::fmt;
use std::boxed::Box;
use std::string::ToString;
use std::sync::Arc;
use std::vec::Vec;

use super::stepper::StepperError;
use super::system::{System, check_length, length};
use crate::error::{ParameterError, StepError};
use crate::flat::{NotGenerated, array, copy};
use crate::stepper::report::{RunError, RunReport};
use crate::stepper::{EventSeries, Inputs, StepReport, Stepping};
use crate::system::pace::Pace;
use crate::system::series::Coefficients;
use crate::system::{self, Control, State};
use crate::taylor::{self, PowerSeries, SeriesVisitor, by_pace};

/// Takes Taylor steps along one trajectory of a system, each as long as a tolerance allows: [`taylor::Adaptive`] with its types erased.
///
/// ```
/// use coadjoint::erased;
/// use coadjoint::prelude::*;
/// use coadjoint::Run;
/// use std::sync::Arc;
///
/// #[lie_poisson_system(group = SO3, taylor)]
/// struct Body {
///     #[inertia]
///     inertia: Vector3<f64>,
/// }
///
/// let body: Arc<dyn erased::System> = Arc::new(Body { inertia: vector![1.0, 2.0, 2.5] });
/// let mut state = vec![1.0, 0.0, 0.0, 0.0, 0.4, -0.8, 1.5];
/// let energy = body.energy(&state, 0.0, &[]);
/// let mut trajectory = erased::Adaptive::new(body.clone(), 1e-12)?;
/// Run::new(&mut trajectory, &mut state).to(100.0)?;
/// assert_eq!(trajectory.time(), 100.0);
/// assert!((body.energy(&state, 0.0, &[]) - energy).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Adaptive {
    system: Arc<dyn System>,
    tolerance: f64,
    steps: Box<dyn TaylorSteps>,
}

/// What takes Taylor steps, on slices.
#[doc(hidden)]
pub trait TaylorSteps: EventSeries<dyn System> + Send + Sync {
    /// The time, and the largest that each number of an input has been.
    fn carried(&self) -> (&Pace, &[f64]);
    /// The same.
    fn carried_mut(&mut self) -> (&mut Pace, &mut [f64]);
    fn order(&self) -> usize;
    fn set_order(&mut self, order: usize);
    fn step_beside(
        &self,
        state: &mut [f64],
        from: (f64, f64),
        input: Inputs<'_, Vec<f64>>,
    ) -> Result<StepReport, StepError>;
    fn step_driven(
        &mut self,
        state: &mut [f64],
        input: &mut dyn FnMut(f64) -> Vec<f64>,
    ) -> Result<StepReport, StepError>;
    fn step_with(&mut self, state: &mut [f64], control: &[f64]) -> Result<f64, StepError>;
    fn at(&self, share: f64) -> Option<Vec<f64>>;
}

impl<S: PowerSeries<Scalar = f64> + Send + Sync> TaylorSteps for taylor::Adaptive<S> {
    fn carried(&self) -> (&Pace, &[f64]) {
        Self::carried(self)
    }

    fn carried_mut(&mut self) -> (&mut Pace, &mut [f64]) {
        Self::carried_mut(self)
    }

    fn step_beside(
        &self,
        state: &mut [f64],
        from: (f64, f64),
        input: Inputs<'_, Vec<f64>>,
    ) -> Result<StepReport, StepError> {
        let mut next = S::State::from_components(&array(state));
        let report = match input {
            Inputs::Held(control) => {
                let control = S::Control::from_components(&array(control));
                Stepping::step_beside(self, &mut next, from, Inputs::Held(&control))
            }
            Inputs::Driven(input) => {
                let mut input = |time: f64| S::Control::from_components(&array(&input(time)));
                Stepping::step_beside(self, &mut next, from, Inputs::Driven(&mut input))
            }
        }?;
        copy(state, next.to_components().as_ref());
        Ok(report)
    }

    fn step_driven(
        &mut self,
        state: &mut [f64],
        input: &mut dyn FnMut(f64) -> Vec<f64>,
    ) -> Result<StepReport, StepError> {
        let mut next = S::State::from_components(&array(state));
        let mut input = |time: f64| S::Control::from_components(&array(&input(time)));
        let report = Stepping::step_driven(self, &mut next, &mut input)?;
        copy(state, next.to_components().as_ref());
        Ok(report)
    }

    fn order(&self) -> usize {
        Self::order(self)
    }

    fn set_order(&mut self, order: usize) {
        Self::set_order(self, order);
    }

    fn step_with(&mut self, state: &mut [f64], control: &[f64]) -> Result<f64, StepError> {
        let mut next = S::State::from_components(&array(state));
        let length = Self::step_with(self, &mut next, &S::Control::from_components(&array(control)))?;
        copy(state, next.to_components().as_ref());
        Ok(length)
    }

    fn at(&self, share: f64) -> Option<Vec<f64>> {
        Some(Self::at(self, share)?.to_components().as_ref().to_vec())
    }
}

impl<S: PowerSeries<Scalar = f64>> EventSeries<dyn System> for taylor::Adaptive<S> {
    fn expand(
        &self,
        event: usize,
        state: &Vec<f64>,
        from: (f64, f64),
        input: Inputs<'_, Vec<f64>>,
        coefficients: &mut Coefficients,
    ) -> Option<(usize, f64)> {
        let state = S::State::from_components(&array(state));
        let control = |numbers: &[f64]| S::Control::from_components(&array(numbers));
        match input {
            Inputs::Held(held) => EventSeries::<S>::expand(
                self,
                event,
                &state,
                from,
                Inputs::Held(&control(held)),
                coefficients,
            ),
            Inputs::Driven(input) => {
                let input = &mut |time: f64| control(&input(time));
                EventSeries::<S>::expand(self, event, &state, from, Inputs::Driven(input), coefficients)
            }
        }
    }
}

/// Makes what takes the Taylor steps of a system.
pub(super) struct OfSeries<'a, S> {
    pub(super) system: &'a S,
    pub(super) tolerance: f64,
}

impl<S: system::System<Scalar = f64> + Send + Sync + 'static> SeriesVisitor<S> for OfSeries<'_, S> {
    type Output = Result<Box<dyn TaylorSteps>, ParameterError>;

    fn visit(self) -> Self::Output
    where
        S: PowerSeries,
    {
        Ok(Box::new(taylor::Adaptive::new(self.system, self.tolerance)?))
    }
}

impl Adaptive {
    /// Builds what takes the Taylor steps of a system to a tolerance: see [`System::adaptive`](crate::System::adaptive).
    ///
    /// # Errors
    /// If the parameters are not valid, the tolerance is not between 0 and 1, or the description has not the key `taylor`.
    pub fn new(system: Arc<dyn System>, tolerance: f64) -> Result<Self, StepperError> {
        let steps = system.power_series(tolerance).ok_or_else(|| NotGenerated {
            scheme: "Taylor".to_string(),
            system: system.description().name,
            key: "taylor",
        })??;
        Ok(Self { system, tolerance, steps })
    }

    /// The system.
    pub fn system(&self) -> &Arc<dyn System> {
        &self.system
    }

    /// The order of the steps.
    pub fn order(&self) -> usize {
        self.steps.order()
    }

    /// Takes steps of this order, whatever the tolerance: see [`taylor::Adaptive::with_order`].
    pub fn with_order(mut self, order: usize) -> Self {
        self.steps.set_order(order);
        self
    }

    /// Takes no longer steps than this: see [`taylor::Adaptive::with_max_step`].
    pub fn with_max_step(mut self, step: f64) -> Self {
        self.carried_mut().0.bound(step);
        self
    }

    /// The time at which the next step starts.
    pub fn time(&self) -> f64 {
        self.carried().0.time()
    }

    /// Takes one step with `control` held. Returns its length: see [`taylor::Adaptive::step_with`].
    ///
    /// # Errors
    /// As there, and if the state has not as many numbers as one of the system.
    pub fn step_with(&mut self, state: &mut [f64], control: &[f64]) -> Result<f64, StepError> {
        check_length(state, length(self.system.description().state))?;
        self.steps.step_with(state, control)
    }

    fn carried(&self) -> (&Pace, &[f64]) {
        self.steps.carried()
    }

    fn carried_mut(&mut self) -> (&mut Pace, &mut [f64]) {
        self.steps.carried_mut()
    }

    /// The state within the last step: see [`taylor::Adaptive::at`].
    pub fn at(&self, share: f64) -> Option<Vec<f64>> {
        self.steps.at(share)
    }
}

impl Stepping for Adaptive {
    type System = dyn System;

    fn system(&self) -> &(dyn System + 'static) {
        &*self.system
    }

    by_pace!();

    fn set_parameters(&mut self, parameters: &[f64]) -> Result<(), ParameterError> {
        let (expected, got) = (self.system.parameters().len(), parameters.len());
        if got != expected {
            return Err(ParameterError::Length { expected, got });
        }
        let system = self.system.with_parameters(parameters);
        let (tolerance, memory, most) = (self.tolerance, self.snapshot(), self.carried().0.most);
        let series = system.power_series(tolerance).ok_or(ParameterError::Tolerance { tolerance })?;
        (self.system, self.steps) = (system, series?);
        self.carried_mut().0.bound(most);
        self.restore(&memory)
    }

    fn step_beside(
        &self,
        state: &mut Vec<f64>,
        from: (f64, f64),
        input: Inputs<'_, Vec<f64>>,
    ) -> Result<StepReport, StepError> {
        check_length(state, length(self.system.description().state))?;
        self.steps.step_beside(state, from, input)
    }

    fn event_series(&self) -> Option<&dyn EventSeries<dyn System>> {
        Some(&*self.steps)
    }

    fn step_with(&mut self, state: &mut Vec<f64>, control: &Vec<f64>) -> Result<StepReport, StepError> {
        Self::step_with(self, state, control).map(|_| taylor::EXPLICIT)
    }

    fn step_driven(
        &mut self,
        state: &mut Vec<f64>,
        input: &mut dyn FnMut(f64) -> Vec<f64>,
    ) -> Result<StepReport, StepError> {
        check_length(state, length(self.system.description().state))?;
        self.steps.step_driven(state, input)
    }
}

impl taylor::Beside for Adaptive {}

impl fmt::Debug for Adaptive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Adaptive")
            .field("system", &self.system.description().name)
            .field("order", &self.order())
            .field("time", &self.time())
            .finish_non_exhaustive()
    }
}
