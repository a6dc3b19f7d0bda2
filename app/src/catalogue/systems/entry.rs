//! Systems as the program sees them, each behind the same [`Entry`].

use std::path::PathBuf;
use std::sync::Arc;

use coadjoint::erased::{self, Description, Flat, RetractionKind};
use coadjoint::prelude::*;
use coadjoint::system::{Isolated, Quantity};
use coadjoint::{Discretized, Kind, RightLift, Role, System};
use serde::{Deserialize, Serialize};

use super::super::{Example, Observables, scene::Scene};
use super::input::Input;
use super::observable::Observable;
use super::plotted::PlottedQuantities;
use super::quantities::components;

/// One system of a program, its type erased: parameters and states are flat lists of numbers.
#[derive(Clone)]
#[must_use]
pub struct Entry {
    /// Its name on the command line.
    pub name: String,
    /// A description in one line.
    pub about: &'static str,
    /// The text of its file, from which the generated code can be shown; empty where it was not given.
    pub source: &'static str,
    /// The step it is run with unless another is asked for, s.
    pub step: f64,
    /// The duration it is run for unless another is asked for, s.
    pub duration: f64,
    /// The step that suits its certificates, where the motion of its example does not show how fast or slow it can be,
    /// s.
    pub certified_step: Option<f64>,
    /// Its parameters, state, controls and Casimirs.
    pub description: Description,
    /// The example's parameters and initial state.
    pub example: Setup,
    /// Whether somebody chose these. If not, a run has to say what its parameters and its advected quantities are.
    pub has_example: bool,
    /// The file that it was read from, where it is not compiled.
    pub file: Option<PathBuf>,
    /// The unit of its energy.
    pub energy_unit: &'static str,
    casimir_units: &'static [&'static str],
    build: Arc<BuildFn>,
    /// Its own control law with these parameters. None if it has no controls.
    pub(crate) control: Option<Arc<ControlFn>>,
    /// Builds the method that carries the momentum in space, with these parameters and this step. None if something
    /// acts on it.
    pub(crate) right_lift: Option<Arc<MethodFn>>,
    /// The moment of inertia, if it is a body of mass, by its parameters.
    pub(crate) body_inertia: Arc<InertiaFn>,
    /// Completes the scene by its state alone with what these parameters tell.
    pub(crate) scene: Arc<SceneFn>,
    /// The quantities that pictures show.
    pub(crate) plotted: PlottedQuantities,
    /// The controls that are shown with a state: none where they are not known.
    pub(crate) controls: &'static [Quantity],
    /// Quantities of its own that are shown behind them.
    pub(crate) observables: Vec<Observable>,
}

/// Builds a method on a retraction, with these parameters and this step. None on retractions that not every system has
/// steps with.
pub(crate) type MethodFn =
    dyn Fn(&[f64], RetractionKind, f64) -> Option<Box<dyn erased::Method<f64>>> + Send + Sync;

/// Builds the system with these parameters; what is missing is as in the example.
pub type BuildFn = dyn Fn(&[f64]) -> Arc<dyn erased::EnsembleSystem> + Send + Sync;

type ControlFn = dyn Fn(&[f64]) -> ControlLaw + Send + Sync;
type InertiaFn = dyn Fn(&[f64]) -> Option<Matrix3<f64>> + Send + Sync;
type SceneFn = dyn Fn(&[f64], Scene) -> Scene + Send + Sync;

/// Writes what is held over the step from a state at a time.
pub type ControlLaw = Box<dyn Fn(&[f64], f64, &mut [f64]) + Send + Sync>;

/// Parameters, an initial state and controls, in the order of the system's quantities.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// The parameters' components.
    pub parameters: Vec<f64>,
    /// The initial state's components.
    pub state: Vec<f64>,
    /// The controls' components, where they are held all the time; where there is none, the system's own law chooses.
    pub controls: Vec<Option<f64>>,
    /// Controls that are functions of time; of those that it has no column for, what is not held is zero.
    pub input: Option<Arc<Input>>,
}

impl Entry {
    /// The entry of a system, under its own name.
    pub fn of<S: Example>() -> Self {
        const { assert!(S::CASIMIR_UNITS.is_empty() || S::CASIMIR_UNITS.len() == S::CASIMIRS.len()) };
        let description = Description::of::<S>();
        let example = flat(&S::example());
        let build =
            |parameters: &[f64]| -> Arc<dyn erased::EnsembleSystem> { Arc::new(system::<S>(parameters)) };
        Self {
            name: snake_case(S::NAME),
            about: S::ABOUT,
            source: "",
            step: S::STEP,
            duration: S::DURATION,
            certified_step: S::CERTIFIED_STEP,
            description,
            plotted: PlottedQuantities::of(
                &*build(&example.parameters),
                &example.state,
                description.controls,
            ),
            controls: description.controls,
            observables: Vec::new(),
            example,
            has_example: true,
            file: None,
            energy_unit: S::ENERGY_UNIT,
            casimir_units: S::CASIMIR_UNITS,
            build: Arc::new(build),
            control: if description.controls.is_empty() { None } else { Some(Arc::new(control::<S>)) },
            right_lift: None,
            body_inertia: Arc::new(|parameters| system::<S>(parameters).body_inertia()),
            scene: Arc::new(|parameters, by_state| system::<S>(parameters).scene(by_state)),
        }
        .with_observables(S::observables(Observables::default()).erased())
    }

    /// The entry of a system that is known as the program runs alone: what it is, and what builds it. It has no example; a run says what it starts
    /// from.
    pub fn made(description: Description, build: Arc<BuildFn>) -> Self {
        let example = Setup {
            parameters: description.parameters.iter().flat_map(ones).collect(),
            state: description.state.iter().flat_map(identity).collect(),
            controls: vec![None; components(description.controls).count()],
            input: None,
        };
        Self {
            name: snake_case(description.name),
            about: "",
            source: "",
            step: 0.01,
            duration: 10.0,
            certified_step: None,
            description,
            plotted: PlottedQuantities::of(
                &*build(&example.parameters),
                &example.state,
                description.controls,
            ),
            controls: description.controls,
            observables: Vec::new(),
            example,
            has_example: false,
            file: None,
            energy_unit: "",
            casimir_units: &[],
            build,
            control: match description.controls {
                [] => None,
                _ => Some(Arc::new(|_| Box::new(|_, _, to| to.fill(0.0)))),
            },
            right_lift: None,
            body_inertia: Arc::new(|_| None),
            scene: Arc::new(|_, by_state| by_state),
        }
    }

    /// The same system under another name, with another example: what is `about` it, and a step and a duration that
    /// suit it, s.
    pub fn preset<S: Example>(
        self,
        name: &str,
        about: &'static str,
        example: &(S, S::State),
        (step, duration): (f64, f64),
    ) -> Self {
        Self { name: name.to_owned(), about, step, duration, example: flat(example), ..self }
    }

    /// With the text of the file that describes it, for `show`: `include_str!("heavy_top.rs")`.
    pub fn with_source(self, source: &'static str) -> Self {
        Self { source, ..self }
    }

    /// With the method `right-lift`, for a system on which nothing acts: its steps carry the momentum in space.
    pub fn with_right_lift<S>(self) -> Self
    where
        S: Example
            + Isolated
            + Discretized<SymplecticEulerA<Exponential>>
            + Discretized<SymplecticEulerA<Cayley>>,
    {
        Self { right_lift: Some(Arc::new(right_lift::<S>)), ..self }
    }

    /// With more quantities that are shown beside its state.
    pub fn with_observables(mut self, observables: impl IntoIterator<Item = Observable>) -> Self {
        for observable in observables {
            self.plotted.push(&observable);
            self.observables.push(observable);
        }
        self
    }

    /// The system with these parameters; what is missing is as in the example.
    pub fn system(&self, parameters: &[f64]) -> Arc<dyn erased::EnsembleSystem> {
        (self.build)(parameters)
    }

    /// Builds the control law: the controls that are held, and for the others its own law; or what an input says, whatever the state. None if it has
    /// no controls.
    pub fn law(&self, setup: &Setup) -> Option<ControlLaw> {
        let own = self.control.as_ref()?(&setup.parameters);
        let (held, input) = (setup.controls.clone(), setup.input.clone());
        Some(Box::new(move |state, time, to| {
            if input.is_none() {
                own(state, time, to);
            }
            for (to, held) in to.iter_mut().zip(&held) {
                *to = held.unwrap_or(*to);
            }
            if let Some(input) = &input {
                input.write(time, to);
            }
        }))
    }

    /// Evaluates the energy at a time, with the controls that a law chooses there.
    pub(crate) fn energy(
        &self,
        system: &dyn erased::System,
        law: Option<&ControlLaw>,
        (state, time): (&[f64], f64),
    ) -> f64 {
        let control = law.map(|law| self.chosen(law, (state, time)));
        system.energy(state, time, &control.unwrap_or_default())
    }

    /// The controls that a law chooses.
    pub(crate) fn chosen(&self, law: &ControlLaw, (state, time): (&[f64], f64)) -> Vec<f64> {
        let mut controls = vec![0.0; self.example.controls.len()];
        law(state, time, &mut controls);
        controls
    }

    /// The same, of whose states it is not known which controls were at work.
    pub(crate) fn without_controls(self) -> Self {
        let system = self.system(&self.example.parameters);
        let plotted = PlottedQuantities::of(&*system, &self.example.state, &[]);
        let own = self.observables;
        Self { controls: &[], plotted, observables: Vec::new(), ..self }.with_observables(own)
    }

    /// Collects the numbers that are shown of a state: its own, the controls, and its observables.
    pub(crate) fn shown(
        &self,
        system: &dyn erased::System,
        (state, time): (&[f64], f64),
        controls: &[f64],
    ) -> Vec<f64> {
        let own = self.observables.iter().map(|own| own.value(system, state, time, controls));
        let shown = if self.controls.is_empty() { &[] } else { controls };
        state.iter().chain(shown).copied().chain(own).collect()
    }

    /// Whether its energy is an invariant of the motion: no force acts, and neither time nor controls have a part in
    /// it.
    pub fn conserves_energy(&self) -> bool {
        self.description.autonomous && self.description.controls.is_empty()
    }

    /// Whether there is the method `right-lift`.
    pub fn has_right_lift(&self) -> bool {
        self.right_lift.is_some()
    }

    /// The names of the columns of a trajectory: time, every component of the state and of the controls, energy,
    /// its observables.
    pub fn columns(&self) -> Vec<String> {
        let mut columns = vec!["time".to_owned()];
        let components = [self.description.state, self.controls].into_iter().flat_map(components);
        columns.extend(components.map(|component| component.name));
        columns.push("energy".to_owned());
        columns.extend(self.observables.iter().map(|own| own.name.clone()));
        columns
    }

    /// Its Casimirs, with their units.
    pub fn casimirs(&self) -> impl Iterator<Item = (&'static str, &'static str)> + '_ {
        let units = self.casimir_units.iter().copied().chain(std::iter::repeat(""));
        self.description.casimirs.iter().copied().zip(units)
    }
}

impl std::fmt::Debug for Entry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Entry").field("name", &self.name).field("about", &self.about).finish_non_exhaustive()
    }
}

/// Numbers that any parameter may be.
fn ones(quantity: &Quantity) -> Vec<f64> {
    let count = quantity.components.len();
    match quantity.kind {
        Kind::SymmetricMatrix(rows) => {
            (0..count).map(|k| f64::from(u8::from(k.is_multiple_of(rows + 1)))).collect()
        }
        _ => vec![1.0; count],
    }
}

/// The identity where a quantity is a configuration, zeros where it is not.
fn identity(quantity: &Quantity) -> Vec<f64> {
    let is_one = |k: usize| match quantity.kind {
        _ if quantity.role != Role::Configuration => false,
        Kind::UnitComplex | Kind::UnitQuaternion | Kind::RigidMotion2 | Kind::RigidMotion3 => k == 0,
        Kind::Matrix(_, columns) => k.is_multiple_of(columns + 1),
        _ => false,
    };
    (0..quantity.components.len()).map(|k| f64::from(u8::from(is_one(k)))).collect()
}

/// `heavy_top` for `HeavyTop`, `heavy_top_on_se3` for `HeavyTopOnSE3`.
pub(crate) fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    let mut before: Option<char> = None;
    for letter in name.chars() {
        if letter.is_uppercase() && before.is_some_and(|before| !before.is_uppercase()) {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
        before = Some(letter);
    }
    snake
}

/// A system and its state as flat lists; its own law chooses all controls.
fn flat<S: System<Scalar = f64>>((system, state): &(S, S::State)) -> Setup {
    Setup {
        parameters: system.to_parameters().as_ref().to_vec(),
        state: state.to_components().as_ref().to_vec(),
        controls: vec![None; S::Control::default().to_components().as_ref().len()],
        input: None,
    }
}

/// The numbers as an array; what is missing is as in the example.
fn filled<A: AsMut<[f64]>>(mut array: A, numbers: &[f64]) -> A {
    array.as_mut().iter_mut().zip(numbers).for_each(|(to, number)| *to = *number);
    array
}

/// The system with these parameters.
fn system<S: Example>(parameters: &[f64]) -> S {
    S::from_parameters(&filled(S::example().0.to_parameters(), parameters))
}

impl<S: Example> Observables<S> {
    /// Erases the type of the system.
    pub(crate) fn erased(self) -> impl Iterator<Item = Observable> {
        self.0.into_iter().map(|(name, unit, value)| {
            let example = S::example().1.to_components();
            Observable::new(name, unit.to_owned(), move |erased, state, time, control| {
                let state = S::State::from_components(&filled(example, state));
                let none = S::Control::default().to_components();
                let control = S::Control::from_components(&filled(none, control));
                value(&system::<S>(&erased.parameters()), &state, time, &control)
            })
        })
    }
}

fn control<S: Example>(parameters: &[f64]) -> ControlLaw {
    let system = system::<S>(parameters);
    let example = S::example().1.to_components();
    Box::new(move |state, time, to| {
        let state = S::State::from_components(&filled(example, state));
        let control = system.control(&state, time).to_components();
        to.iter_mut().zip(control.as_ref()).for_each(|(to, number)| *to = *number);
    })
}

fn right_lift<S>(
    parameters: &[f64],
    retraction: RetractionKind,
    step: f64,
) -> Option<Box<dyn erased::Method<f64>>>
where
    S: Example
        + Isolated
        + Discretized<SymplecticEulerA<Exponential>>
        + Discretized<SymplecticEulerA<Cayley>>,
{
    type Lifted<S, R> = <S as Discretized<RightLift<SymplecticEulerA<R>>>>::Method<f64>;
    match retraction {
        RetractionKind::Exponential => Some(Flat::<Lifted<S, Exponential>, false>::boxed(parameters, step)),
        RetractionKind::Cayley => Some(Flat::<Lifted<S, Cayley>, false>::boxed(parameters, step)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_in_snake_case() {
        for (name, snake) in
            [("HeavyTop", "heavy_top"), ("HeavyTopOnSE3", "heavy_top_on_se3"), ("SE3Body", "se3_body")]
        {
            assert_eq!(snake_case(name), snake);
        }
    }
}
