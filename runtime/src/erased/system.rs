//! Systems on slices.

use core::marker::PhantomData;
use std::boxed::Box;
use std::string::ToString;
use std::sync::Arc;
use std::vec::Vec;

use super::adaptive::{OfSeries, TaylorSteps};
use super::composition::composed;
use super::equation::{Equation, equation};
use super::jacobian::{Linearization, OfDerivatives};
use crate::crossing::Event;
use crate::derivative::LinearizedSchemes;
use crate::ensemble::members::{Builder, Member, Members};
use crate::ensemble::{EnsembleError, Instructions};
use crate::error::{ParameterError, StepError};
use crate::flat::{Flat, Method, NotGenerated, array};
use crate::legendre::LegendreError;
use crate::retraction::RetractionKind;
use crate::scalar::Batch;
use crate::scheme::{Base, Rule};
use crate::schemes::Scheme;
use crate::solve::step::OneStep;
use crate::stepper::check_state;
use crate::system::{
    self, Control, Description, Dynamics, Generated, Kind, Quantity, Role, Schemes, State, Visitor,
};

/// How many numbers these quantities are.
pub(crate) fn length(quantities: &[Quantity]) -> usize {
    quantities.iter().map(|quantity| quantity.components.len()).sum()
}

/// Whether a list has as many numbers as a state.
pub(crate) fn check_length(state: &[f64], expected: usize) -> Result<(), StepError> {
    if state.len() == expected { Ok(()) } else { Err(StepError::Length { expected }) }
}

/// Whether a list is a state of a system that is finite and on its group, more or less.
pub(crate) fn check(system: &(impl Geometry + ?Sized), state: &[f64]) -> Result<(), StepError> {
    check_length(state, length(system.description().state))?;
    check_state(state, system.deviation(state))
}

/// A system with its parameters and its geometry, on slices; any [`system::Geometry`] over `f64` is one. Not to be imported from outside: the
/// calls of [`system::System`] would be ambiguous.
///
/// Slices have the lengths of the system's arrays: what is missing counts as zero, what is too much does not count.
pub trait Geometry {
    /// What it is.
    fn description(&self) -> Description;
    /// Its parameters.
    fn parameters(&self) -> Vec<f64>;
    /// [`System::validate`](crate::System::validate)
    ///
    /// # Errors
    /// As there.
    fn validate(&self) -> Result<(), ParameterError>;
    /// [`State::deviation`](crate::State::deviation)
    fn deviation(&self, state: &[f64]) -> f64;
    /// The state with the velocity that stands in `state` in the places of momenta: see
    /// [`System::momentum_of`](crate::System::momentum_of).
    ///
    /// # Errors
    /// As there.
    fn with_velocity(&self, state: &[f64], time: f64, control: &[f64]) -> Result<Vec<f64>, LegendreError>;
    /// [`System::energy_at`](crate::System::energy_at)
    fn energy(&self, state: &[f64], time: f64, control: &[f64]) -> f64;
    /// [`System::casimirs`](crate::System::casimirs)
    fn casimirs(&self, state: &[f64]) -> Vec<f64>;
    /// [`System::event_at`](crate::System::event_at)
    fn event(&self, event: usize, state: &[f64], time: f64, control: &[f64]) -> f64;
    /// [`system::Geometry::displace`]
    fn displace(&self, state: &[f64], map: RetractionKind, by: &[f64]) -> Vec<f64>;
    /// [`system::Geometry::differential`]
    fn differential(&self, state: &[f64], time: f64, control: &[f64]) -> Vec<f64>;
    /// [`system::Geometry::hamiltonian_vector`]
    fn hamiltonian_vector(&self, state: &[f64], covector: &[f64]) -> Vec<f64>;
    /// [`system::Geometry::force`]
    fn force(&self, state: &[f64], time: f64, control: &[f64]) -> Vec<f64>;
    /// [`system::Geometry::motion`]
    fn motion(&self, state: &[f64], time: f64, control: &[f64]) -> Vec<f64>;
    /// The motion as the derivative of the state's numbers, as they are stored, by time: what a method wants that takes them for coordinates of
    /// a vector space. Of a rotation it is `½ q ω` where the quaternion is of unit length, and continued smoothly where it is not.
    fn vector_field(&self, state: &[f64], time: f64, control: &[f64]) -> Vec<f64>;
}

fn state_of<S: system::System<Scalar = f64>>(state: &[f64]) -> S::State {
    S::State::from_components(&array(state))
}

fn control_of<S: system::System<Scalar = f64>>(control: &[f64]) -> S::Control {
    S::Control::from_components(&array(control))
}

/// What a state has at a time and with controls, in the coordinates of tangent vectors.
macro_rules! tangents {
    ($($name:ident),*) => {
        $(fn $name(&self, state: &[f64], time: f64, control: &[f64]) -> Vec<f64> {
            let control = control_of::<S>(control);
            system::Geometry::$name(self, &state_of::<S>(state), time, &control).as_ref().to_vec()
        })*
    };
}

impl<S: system::Geometry<Scalar = f64>> Geometry for S {
    fn description(&self) -> Description {
        Description::of::<S>()
    }

    fn parameters(&self) -> Vec<f64> {
        self.to_parameters().as_ref().to_vec()
    }

    fn validate(&self) -> Result<(), ParameterError> {
        system::System::validate(self)
    }

    fn deviation(&self, state: &[f64]) -> f64 {
        state_of::<S>(state).deviation()
    }

    fn with_velocity(&self, state: &[f64], time: f64, control: &[f64]) -> Result<Vec<f64>, LegendreError> {
        let state = state_of::<S>(state);
        let momentum = self.momentum_of(&self.momentum(&state), &state, time, &control_of::<S>(control))?;
        Ok(self.with_momentum(&state, &momentum).to_components().as_ref().to_vec())
    }

    fn energy(&self, state: &[f64], time: f64, control: &[f64]) -> f64 {
        self.energy_at(&state_of::<S>(state), time, &control_of::<S>(control))
    }

    fn casimirs(&self, state: &[f64]) -> Vec<f64> {
        system::System::casimirs(self, &state_of::<S>(state)).as_ref().to_vec()
    }

    fn event(&self, event: usize, state: &[f64], time: f64, control: &[f64]) -> f64 {
        self.event_at(event, &state_of::<S>(state), time, &control_of::<S>(control))
    }

    fn displace(&self, state: &[f64], map: RetractionKind, by: &[f64]) -> Vec<f64> {
        let displaced = system::Geometry::displace(self, &state_of::<S>(state), map, &array(by));
        displaced.to_components().as_ref().to_vec()
    }

    tangents!(differential, force, motion);

    fn hamiltonian_vector(&self, state: &[f64], covector: &[f64]) -> Vec<f64> {
        let state = state_of::<S>(state);
        system::Geometry::hamiltonian_vector(self, &state, &array(covector)).as_ref().to_vec()
    }

    fn vector_field(&self, state: &[f64], time: f64, control: &[f64]) -> Vec<f64> {
        super::field::vector_field(self, state, time, control)
    }
}

/// A system with all that was generated for it, its type erased; any system over `f64` that the macro made is one, and one that was made
/// [of a text](crate::guide::at_run_time), and nothing else can be.
///
/// A `&dyn System` has, without an import, these calls on slices too, as [`system::System`] and [`system::Geometry`] have them on states:
/// `description()`, `parameters()`, `validate()`, `deviation(state)`, `with_velocity(state, time, control)`, `energy(state, time, control)`, `casimirs(state)`, `event(place, state, time, control)`, `displace(state, map, by)`,
/// `differential(state, time, control)`, `hamiltonian_vector(state, covector)`, `force(state, time, control)` and `motion(state, time, control)`; besides,
/// `vector_field(state, time, control)`, the motion as the derivative of the stored numbers. Slices have the lengths of the system's arrays: what
/// is missing counts as zero, what is too much does not count.
pub trait System: Geometry + Send + Sync + 'static {
    /// The same system with other parameters; what is missing is as in this one.
    fn with_parameters(&self, parameters: &[f64]) -> Arc<dyn System>;

    /// What takes a generated step of this length; none if it was not generated.
    #[doc(hidden)]
    fn method(&self, map: RetractionKind, rule: Rule, step: f64) -> Option<Box<dyn Method<f64>>>;

    /// What takes a step of this length that is half a step of a method and half a step of its adjoint, where that is one piece.
    #[doc(hidden)]
    fn pair(&self, _map: RetractionKind, _step: f64) -> Option<Box<dyn Method<f64>>> {
        None
    }

    /// What takes Taylor steps to a tolerance; none if no power series were generated.
    #[doc(hidden)]
    fn power_series(&self, _tolerance: f64) -> Option<Result<Box<dyn TaylorSteps>, ParameterError>> {
        None
    }

    /// The derivative of a generated step, and where the step leads to; none if it was not generated.
    #[doc(hidden)]
    fn linearization(
        &self,
        map: RetractionKind,
        rule: Rule,
        at: &At<'_>,
    ) -> Option<Result<Linearization, StepError>>;

    /// The equation of a generated step; none if it was not generated.
    #[doc(hidden)]
    fn equation(&self, map: RetractionKind, rule: Rule, at: &At<'_>) -> Option<Box<dyn Equation>>;
}

/// A [`System`] of which there are [ensembles](super::Ensemble); any system over `f64` that the macro made is one too.
///
/// Steps of many states side by side are compiled for each kind of processor. Only where a system becomes a `dyn EnsembleSystem` does that happen.
pub trait EnsembleSystem: System {
    /// Members side by side, with a scheme that is made of standard steps.
    ///
    /// # Errors
    /// If a step that it is made of was not generated, or is not compiled for several side by side.
    #[doc(hidden)]
    fn members(
        &self,
        scheme: &Scheme,
        members: &[Member],
        step: f64,
        instructions: Instructions,
    ) -> Result<Members, EnsembleError>;
}

/// Where a step starts, and how long it is.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct At<'a> {
    /// The length of the step.
    pub step: f64,
    /// The state at its start.
    pub state: &'a [f64],
    /// The time at its start.
    pub time: f64,
    /// The control held until its end.
    pub control: &'a [f64],
}

impl<'a> At<'a> {
    /// Returns the start of a step of this length from a state at a time, with a control.
    pub fn new(step: f64, state: &'a [f64], time: f64, control: &'a [f64]) -> Self {
        Self { step, state, time, control }
    }
}

impl<S> System for S
where
    S: Schemes + LinearizedSchemes + system::Geometry<Scalar = f64> + Send + Sync + 'static,
{
    fn with_parameters(&self, parameters: &[f64]) -> Arc<dyn System> {
        let mut own = self.to_parameters();
        crate::flat::copy(own.as_mut(), parameters);
        Arc::new(S::from_parameters(&own))
    }

    fn method(&self, map: RetractionKind, rule: Rule, step: f64) -> Option<Box<dyn Method<f64>>> {
        let parameters = self.to_parameters();
        S::visit(map, rule, OfMethods::<f64, true> { parameters: parameters.as_ref(), step }).flatten()
    }

    fn power_series(&self, tolerance: f64) -> Option<Result<Box<dyn TaylorSteps>, ParameterError>> {
        S::visit_series(OfSeries { system: self, tolerance })
    }

    fn linearization(
        &self,
        map: RetractionKind,
        rule: Rule,
        at: &At<'_>,
    ) -> Option<Result<Linearization, StepError>> {
        S::visit_linearized(map, rule, OfDerivatives { parameters: self.to_parameters().as_ref(), at })
    }

    fn equation(&self, map: RetractionKind, rule: Rule, at: &At<'_>) -> Option<Box<dyn Equation>> {
        S::visit(map, rule, OfEquations { parameters: self.to_parameters().as_ref(), at })
    }
}

impl<S> EnsembleSystem for S
where
    S: Schemes + LinearizedSchemes + system::Geometry<Scalar = f64> + Send + Sync + 'static,
{
    fn members(
        &self,
        scheme: &Scheme,
        members: &[Member],
        step: f64,
        instructions: Instructions,
    ) -> Result<Members, EnsembleError> {
        let members = |instructions| {
            Members::new::<f64, _>(instructions, members, step, &Standard::<S>(scheme, PhantomData))
        };
        match members(instructions) {
            #[cfg(target_arch = "x86_64")]
            Err(_) if instructions == Instructions::Avx512 => members(Instructions::Avx2),
            members => members,
        }
    }
}

impl Dynamics for dyn System {
    type State = Vec<f64>;
    type Control = Vec<f64>;
    type Parameters = [f64];

    fn name(&self) -> &'static str {
        self.description().name
    }

    fn no_control(&self) -> Vec<f64> {
        std::vec![0.0; length(self.description().controls)]
    }

    fn events(&self) -> &'static [(&'static str, Event)] {
        self.description().events
    }

    fn event(&self, event: usize, state: &Vec<f64>, time: f64, control: &Vec<f64>) -> f64 {
        Geometry::event(self, event, state, time, control)
    }
}

/// Whether a step is the system's standard one, or a part of it.
const fn is_standard<S: system::System>(rule: Rule) -> bool {
    matches!(rule, Rule::Family(0, 1)) || !S::INVARIANT && matches!(rule, Rule::Family(1, 1))
}

/// Whether a step of one state is compiled for the widest registers too, so as to be taken together with others: where it is the standard one by
/// itself. The others are rarely taken for long, and each would be compiled twice more.
const fn is_taken_together<S: system::System>(map: RetractionKind, rule: Rule) -> bool {
    S::INVARIANT && map.is_matrix_function() && is_standard::<S>(rule)
}

/// Whether steps of as many states side by side are compiled: with the Cayley map in registers of any width, with the exponential in those of four.
/// In wider ones too, a program would take a quarter longer to compile. Where all configurations are vectors both maps are one, and bear this name.
const fn is_compiled<S: system::System>(map: RetractionKind, lanes: usize) -> bool {
    if lanes <= 4 || matches!(map, RetractionKind::Cayley) {
        return map.is_matrix_function();
    }
    let quantities = <S::State as State>::QUANTITIES;
    let mut k = 0;
    while k < quantities.len() {
        let is_vector = matches!(quantities[k].kind, Kind::Scalar | Kind::Vector(_));
        if matches!(quantities[k].role, Role::Configuration) && !is_vector {
            return false;
        }
        k += 1;
    }
    map.is_matrix_function()
}

/// A scheme made of standard steps, of states side by side.
struct Standard<'a, S>(&'a Scheme, PhantomData<fn() -> S>);

impl<S: Schemes> Builder for Standard<'_, S> {
    type Error = EnsembleError;
    // for each system a fifth of what there is to compile
    const PAIRS: bool = false;

    fn method<T: Batch>(&self, parameters: &[T], step: T) -> Result<Box<dyn Method<T>>, EnsembleError> {
        let mut generated = |map, rule, step| {
            let method = S::visit(map, rule, OfMethods::<T, false> { parameters, step }).flatten();
            let scheme = || self.0.to_string();
            method.ok_or_else(|| match is_standard::<S>(rule) && map.is_matrix_function() {
                true => NotGenerated { scheme: scheme(), system: S::NAME, key: "retractions" }.into(),
                false => EnsembleError::NotStandard { scheme: scheme() },
            })
        };
        composed(self.0, S::INVARIANT, step, &mut generated, &mut |_, _| None)
    }
}

/// Steps, of one state or of several side by side; all of them, or those alone that the [`Standard`] one is made of.
struct OfMethods<'a, T, const ALL: bool> {
    parameters: &'a [T],
    step: T,
}

impl<T: Batch, S: system::System, const ALL: bool> Visitor<S> for OfMethods<'_, T, ALL> {
    type Output = Option<Box<dyn Method<T>>>;

    fn visit<M: Base>(self) -> Self::Output
    where
        S: Generated<M>,
    {
        // what is not asked for is not compiled
        if const { !(ALL || is_compiled::<S>(M::MAP, T::LANES) && is_standard::<S>(M::RULE)) } {
            return None;
        }
        Some(if const { T::LANES > 1 || is_taken_together::<S>(M::MAP, M::RULE) } {
            Flat::<OneStep<T, S::Kernel<T>>, true>::boxed(self.parameters, self.step)
        } else {
            Flat::<OneStep<T, S::Kernel<T>>, false>::boxed(self.parameters, self.step)
        })
    }
}

/// The equations of steps.
struct OfEquations<'a> {
    parameters: &'a [f64],
    at: &'a At<'a>,
}

impl<S: system::System> Visitor<S> for OfEquations<'_> {
    type Output = Box<dyn Equation>;

    fn visit<M: Base>(self) -> Self::Output
    where
        S: Generated<M>,
    {
        equation::<S::Kernel<f64>>(self.parameters, self.at)
    }
}
