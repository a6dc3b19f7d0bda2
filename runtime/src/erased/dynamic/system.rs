//! Systems whose functions are made at run time.

use std::boxed::Box;
use std::string::ToString;
use std::sync::Arc;
use std::vec::Vec;

use super::kernel::MOST_IN_LANES;
use super::linearization::linearization;
use super::method::{equation, method};
use super::pair::pair;
use super::step::{Called, Step};
use super::taylor::{DynamicTaylor, SeriesFunctions};
use crate::crossing::Event;
use crate::ensemble::members::{BlockBuilder, Member, Members};
use crate::ensemble::{EnsembleError, Instructions};
use crate::erased::adaptive::TaylorSteps;
use crate::erased::composition::composed;
use crate::erased::equation::Equation;
use crate::erased::field;
use crate::erased::jacobian::Linearization;
use crate::erased::system::{At, EnsembleSystem, Geometry, System, length};
use crate::error::{ParameterError, StepError};
use crate::flat::{Method, NotGenerated};
use crate::inertia::{require_finite, require_positive_definite, require_symmetric, symmetrize};
use crate::legendre::{self, LegendreError};
use crate::retraction::RetractionKind;
#[cfg(feature = "machine")]
use crate::scalar::simd::frame::MachineLanes;
use crate::scalar::simd::frame::{Wide, has_lanes};
use crate::scheme::Rule;
use crate::schemes::Scheme;
use crate::system::{Description, Kind, Quantity, Role, Side, Stored, larger};

/// The functions of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SystemFunction {
    /// The energy.
    Energy,
    /// The velocity that belongs to the momentum, in closed form.
    Velocity,
    /// What vanishes at the velocity that belongs to the momentum, and Newton's correction of a velocity.
    VelocityNewton,
    /// The momentum that belongs to a velocity, in closed form.
    Momentum,
    /// What vanishes at the momentum that belongs to a velocity, and Newton's correction of the state's momentum.
    MomentumNewton,
    /// The Casimirs.
    Casimirs,
    /// How far matrices are off their groups.
    Deviation,
    /// The pivots of an inertia, by its place among them.
    Pivots(usize),
    /// The displaced state.
    Displacement(RetractionKind),
    /// The differential of the energy.
    Differential,
    /// The Hamiltonian vector of a covector.
    HamiltonianVector,
    /// The forces as a tangent vector.
    Force,
    /// What is zero at an event, by its place among them.
    Event(usize),
}

/// What a function of a system may ask for. What it does not ask for may be empty.
#[derive(Clone, Copy, Debug, Default)]
pub struct Given<'a> {
    /// The parameters.
    pub parameters: &'a [f64],
    /// The state.
    pub state: &'a [f64],
    /// The time.
    pub time: f64,
    /// The controls.
    pub control: &'a [f64],
    /// A velocity.
    pub velocity: &'a [f64],
    /// A tangent vector or a covector.
    pub tangent: &'a [f64],
}

/// The arithmetic of a system, beside its steps.
pub trait SystemFunctions: Send + Sync + 'static {
    /// What a function returns; none if there is no such function.
    fn call(&self, function: SystemFunction, given: &Given<'_>) -> Option<Vec<f64>>;
    /// Whether it asks for the velocity.
    fn asks_for_velocity(&self, function: SystemFunction) -> bool;
}

/// A parameter that is an inertia.
#[derive(Clone, Copy, Debug)]
pub struct Inertia {
    /// Its name.
    pub name: &'static str,
    /// How many rows it has, if it is a matrix.
    pub rows: Option<usize>,
}

/// Describes a system: its name, its parameters, state and controls, its Casimirs, on which side of the configuration its velocities are, and
/// whether it is autonomous, invariant, forced and piecewise.
pub fn description(
    name: &'static str,
    quantities: [&'static [Quantity]; 3],
    casimirs: &'static [&'static str],
    side: Side,
    facts: [bool; 4],
) -> Description {
    Description::dynamic(name, quantities, casimirs, side, facts)
}

/// The same with these events: their names, and which of their zeros count.
pub fn with_events(described: Description, events: &'static [(&'static str, Event)]) -> Description {
    described.with_events(events)
}

/// All that there is of a system but for its parameters' values.
pub struct Definition {
    /// What it is.
    pub description: Description,
    /// The constants behind the parameters.
    pub constants: Vec<f64>,
    /// The parameters that are inertias.
    pub inertias: Vec<Inertia>,
    /// Its dimension.
    pub dimension: usize,
    /// Whether the momentum that belongs to a velocity is not to be found.
    pub is_momentum_singular: bool,
    /// Its functions.
    pub functions: Box<dyn SystemFunctions>,
    /// Its steps.
    pub steps: Vec<Arc<Step>>,
    /// The power series of its motion, if the description asks for them.
    pub series: Option<Arc<dyn SeriesFunctions>>,
}

impl core::fmt::Debug for Definition {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Definition").field("description", &self.description).finish_non_exhaustive()
    }
}

/// A system that was made at run time, with its parameters.
#[derive(Clone, Debug)]
pub struct DynamicSystem {
    definition: Arc<Definition>,
    /// The parameters as they were given, without constants.
    fields: Vec<f64>,
}

impl DynamicSystem {
    /// A system with these parameters; those that are missing are zero.
    pub fn new(definition: Arc<Definition>, parameters: &[f64]) -> Self {
        let mut fields = std::vec![0.0; length(definition.description.parameters)];
        crate::flat::copy(&mut fields, parameters);
        Self { definition, fields }
    }

    /// What it was made of.
    pub fn definition(&self) -> &Arc<Definition> {
        &self.definition
    }

    fn field(&self, name: &str) -> &[f64] {
        let mut all = Quantity::with_ranges(self.definition.description.parameters);
        all.find(|(quantity, _)| quantity.name == name).map_or(&[], |(_, range)| &self.fields[range])
    }

    fn call(&self, function: SystemFunction, given: &Given<'_>) -> Option<Vec<f64>> {
        let parameters = &self.parameters();
        let mut given = Given { parameters, ..*given };
        let velocity;
        if given.velocity.is_empty() && self.definition.functions.asks_for_velocity(function) {
            velocity = self.velocity(&given);
            given.velocity = &velocity;
        }
        self.definition.functions.call(function, &given)
    }

    /// What a function returns that all systems have.
    fn value(&self, function: SystemFunction, given: &Given<'_>) -> Vec<f64> {
        self.call(function, given).unwrap_or_default()
    }

    /// The velocity of a state: a closed form, or by Newton's method.
    pub(super) fn velocity(&self, given: &Given<'_>) -> Vec<f64> {
        let functions = &self.definition.functions;
        functions.call(SystemFunction::Velocity, given).unwrap_or_else(|| {
            let newton = |velocity: &[f64]| {
                let given = Given { velocity, ..*given };
                functions.call(SystemFunction::VelocityNewton, &given).unwrap_or_default()
            };
            legendre::newton_of(self.definition.dimension, newton)
        })
    }

    fn step(&self, map: RetractionKind, rule: Rule) -> Option<&Arc<Step>> {
        self.definition.steps.iter().find(|step| step.schemes.contains(&(map, rule)))
    }

    /// What takes the steps of a scheme, of one state or of several side by side.
    fn composed<T: Called>(
        &self,
        scheme: &Scheme,
        parameters: &[T],
        step: T,
    ) -> Result<Box<dyn Method<T>>, EnsembleError> {
        let Description { name, invariant, .. } = self.definition.description;
        let mut generated = |map, rule, step| match self.step(map, rule) {
            Some(of) => Ok(method(of, parameters, step)),
            None => {
                let has_map = self.step(map, Rule::Family(0, 1)).is_some();
                let key = if has_map { "methods" } else { "retractions" };
                Err(NotGenerated { scheme: scheme.to_string(), system: name, key }.into())
            }
        };
        composed(scheme, invariant, step, &mut generated, &mut |map, step| self.halves(map, parameters, step))
    }

    fn side_by_side<T: Called + BlockBuilder>(
        &self,
        scheme: &Scheme,
        members: &[Member],
        step: f64,
    ) -> Result<Members, EnsembleError> {
        Members::of::<T, _>(members, step, |parameters, step| self.composed(scheme, parameters, step))
    }

    /// What takes a step of two halves, if machine code takes both at a time.
    fn halves<T: Called>(
        &self,
        map: RetractionKind,
        parameters: &[T],
        step: T,
    ) -> Option<Box<dyn Method<T>>> {
        let (first, second) = (Rule::Family(0, 1), (map, Rule::Family(1, 1)));
        let steps = &self.definition.steps;
        let place = steps.iter().position(|step| step.schemes.contains(&second))?;
        pair(self.step(map, first)?, (&steps[place], place), parameters, step)
    }

    /// The state, or as many numbers.
    fn state(&self, state: &[f64]) -> Vec<f64> {
        let mut own = std::vec![0.0; length(self.definition.description.state)];
        crate::flat::copy(&mut own, state);
        own
    }

    /// The places of the momenta.
    fn momenta(&self) -> impl Iterator<Item = usize> + '_ {
        let all = Quantity::with_ranges(self.definition.description.state);
        all.filter(|(quantity, _)| quantity.role == Role::Momentum).flat_map(|(_, range)| range)
    }

    fn with_momentum(&self, state: &[f64], momentum: &[f64]) -> Vec<f64> {
        let mut state = self.state(state);
        self.momenta().zip(momentum).for_each(|(place, momentum)| state[place] = *momentum);
        state
    }
}

impl Geometry for DynamicSystem {
    fn description(&self) -> Description {
        self.definition.description
    }

    fn parameters(&self) -> Vec<f64> {
        let mut parameters = self.fields.clone();
        for (quantity, range) in Quantity::with_ranges(self.definition.description.parameters) {
            if let Kind::SymmetricMatrix(rows) = quantity.kind {
                let entries = self.fields[range.clone()].to_vec();
                symmetrize(&entries, &mut parameters[range], rows);
            }
        }
        parameters.extend(&self.definition.constants);
        parameters
    }

    fn validate(&self) -> Result<(), ParameterError> {
        for quantity in self.definition.description.parameters {
            require_finite(quantity.name, self.field(quantity.name))?;
        }
        for (place, inertia) in self.definition.inertias.iter().enumerate() {
            if let Some(rows) = inertia.rows {
                require_symmetric(inertia.name, self.field(inertia.name), rows)?;
            }
            let pivots = self.value(SystemFunction::Pivots(place), &Given::default());
            require_positive_definite(inertia.name, &pivots)?;
        }
        Ok(())
    }

    fn deviation(&self, state: &[f64]) -> f64 {
        let state = self.state(state);
        let of_matrices = self.call(SystemFunction::Deviation, &Given { state: &state, ..Given::default() });
        let mut largest = of_matrices.and_then(|largest| largest.first().copied()).unwrap_or(0.0);
        for (quantity, range) in Quantity::with_ranges(self.definition.description.state) {
            if quantity.role == Role::Configuration {
                largest = larger(largest, deviation(quantity.kind, &state[range]));
            }
        }
        largest
    }

    fn with_velocity(&self, state: &[f64], time: f64, control: &[f64]) -> Result<Vec<f64>, LegendreError> {
        let state = self.state(state);
        let velocity: Vec<f64> = self.momenta().map(|place| state[place]).collect();
        let parameters = &self.parameters();
        let given = Given { parameters, state: &state, time, control, velocity: &velocity, tangent: &[] };
        let Definition { functions, dimension, is_momentum_singular, .. } = &*self.definition;
        let momentum = match functions.call(SystemFunction::Momentum, &given) {
            _ if *is_momentum_singular => std::vec![f64::NAN; *dimension],
            Some(momentum) => momentum,
            None => legendre::newton_of(*dimension, |momentum: &[f64]| {
                let state = &self.with_momentum(&state, momentum);
                functions.call(SystemFunction::MomentumNewton, &Given { state, ..given }).unwrap_or_default()
            }),
        };
        match momentum.iter().all(|component| component.is_finite()) {
            true => Ok(self.with_momentum(&state, &momentum)),
            false => Err(LegendreError),
        }
    }

    fn energy(&self, state: &[f64], time: f64, control: &[f64]) -> f64 {
        let given = Given { state, time, control, ..Given::default() };
        self.value(SystemFunction::Energy, &given).first().copied().unwrap_or(f64::NAN)
    }

    fn casimirs(&self, state: &[f64]) -> Vec<f64> {
        self.value(SystemFunction::Casimirs, &Given { state, ..Given::default() })
    }

    fn event(&self, event: usize, state: &[f64], time: f64, control: &[f64]) -> f64 {
        let given = Given { state, time, control, ..Given::default() };
        self.value(SystemFunction::Event(event), &given).first().copied().unwrap_or(f64::NAN)
    }

    fn displace(&self, state: &[f64], map: RetractionKind, by: &[f64]) -> Vec<f64> {
        let given = Given { state, tangent: by, ..Given::default() };
        // what there is not is displaced by the exponential
        self.call(SystemFunction::Displacement(map), &given)
            .unwrap_or_else(|| self.value(SystemFunction::Displacement(RetractionKind::Exponential), &given))
    }

    fn differential(&self, state: &[f64], time: f64, control: &[f64]) -> Vec<f64> {
        self.value(SystemFunction::Differential, &Given { state, time, control, ..Given::default() })
    }

    fn hamiltonian_vector(&self, state: &[f64], covector: &[f64]) -> Vec<f64> {
        let given = Given { state, tangent: covector, ..Given::default() };
        self.value(SystemFunction::HamiltonianVector, &given)
    }

    fn force(&self, state: &[f64], time: f64, control: &[f64]) -> Vec<f64> {
        self.value(SystemFunction::Force, &Given { state, time, control, ..Given::default() })
    }

    fn motion(&self, state: &[f64], time: f64, control: &[f64]) -> Vec<f64> {
        let mut motion = self.hamiltonian_vector(state, &Geometry::differential(self, state, time, control));
        let force = Geometry::force(self, state, time, control);
        motion.iter_mut().zip(force).for_each(|(component, force)| *component += force);
        motion
    }

    fn vector_field(&self, state: &[f64], time: f64, control: &[f64]) -> Vec<f64> {
        field::vector_field(self, state, time, control)
    }
}

/// How far a configuration is off its group, but for matrices.
fn deviation(kind: Kind, numbers: &[f64]) -> f64 {
    fn of<S: Stored<f64, N>, const N: usize>(numbers: &[f64]) -> f64 {
        S::from_array(crate::flat::array(numbers)).deviation(0.0)
    }
    match kind {
        Kind::UnitComplex => of::<nalgebra::UnitComplex<f64>, 2>(numbers),
        Kind::UnitQuaternion => of::<nalgebra::UnitQuaternion<f64>, 4>(numbers),
        Kind::RigidMotion2 => of::<nalgebra::Isometry2<f64>, 4>(numbers),
        Kind::RigidMotion3 => of::<nalgebra::Isometry3<f64>, 7>(numbers),
        _ => 0.0,
    }
}

impl System for DynamicSystem {
    fn with_parameters(&self, parameters: &[f64]) -> Arc<dyn System> {
        let mut own = Geometry::parameters(self);
        crate::flat::copy(&mut own, parameters);
        Arc::new(Self::new(self.definition.clone(), &own))
    }

    fn method(&self, map: RetractionKind, rule: Rule, step: f64) -> Option<Box<dyn Method<f64>>> {
        self.step(map, rule).map(|of| method(of, &Geometry::parameters(self), step))
    }

    fn power_series(&self, tolerance: f64) -> Option<Result<Box<dyn TaylorSteps>, ParameterError>> {
        let functions = self.definition.series.clone()?;
        Some(DynamicTaylor::boxed(self, functions, tolerance))
    }

    fn pair(&self, map: RetractionKind, step: f64) -> Option<Box<dyn Method<f64>>> {
        self.halves(map, &Geometry::parameters(self), step)
    }

    fn linearization(
        &self,
        map: RetractionKind,
        rule: Rule,
        at: &At<'_>,
    ) -> Option<Result<Linearization, StepError>> {
        let step = self.step(map, rule)?;
        let derivative = step.derivative.as_deref()?;
        Some(linearization(step, derivative, &Geometry::parameters(self), at))
    }

    fn equation(&self, map: RetractionKind, rule: Rule, at: &At<'_>) -> Option<Box<dyn Equation>> {
        self.step(map, rule).map(|step| equation(step, &Geometry::parameters(self), at))
    }
}

impl EnsembleSystem for DynamicSystem {
    /// Nothing is compiled for each scheme here: all that there are steps for. A few are side by side where machine code takes many steps, and many
    /// where each is taken by the solver.
    fn members(
        &self,
        scheme: &Scheme,
        members: &[Member],
        step: f64,
        _: Instructions,
    ) -> Result<Members, EnsembleError> {
        let all = |holds: fn(&Step) -> bool| self.definition.steps.iter().all(|step| holds(step));
        let are_small = all(|step| step.layout.unknown.len() <= MOST_IN_LANES);
        #[cfg(feature = "machine")]
        if are_small && all(|step| step.functions.has_march()) {
            return self.side_by_side::<MachineLanes>(scheme, members, step);
        }
        if are_small && has_lanes() {
            self.side_by_side::<Wide>(scheme, members, step)
        } else {
            self.side_by_side::<f64>(scheme, members, step)
        }
    }
}
