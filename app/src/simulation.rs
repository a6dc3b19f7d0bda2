//! Runs of any system of the catalogue, with parameters and states as flat lists of numbers.

mod certificates;
mod classical;
mod error;
mod method;
mod too_far;

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

pub(crate) use classical::tangent_places;
use coadjoint::__private::Map;
use coadjoint::RunReport;
use coadjoint::composition::{KahanLi6, KahanLi8, SofroniouSpaletta10, Suzuki4};
use coadjoint::erased::{self, StepperError};
use coadjoint::observe::Observer;
use coadjoint::prelude::*;
use coadjoint::scheme::Rule;
use coadjoint::{Run, Scheme, Tick};

pub use error::SimulationError;
pub use method::{Classical, Method};
use serde::{Deserialize, Serialize};

use crate::entry::{ControlLaw, Entry};

/// The map from the Lie algebra to the group that a step is built on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Retraction {
    /// The exponential map: the most accurate step of a given size.
    #[value(alias = "exp")]
    Exponential,
    /// The Cayley map: rational, and defined for every angle.
    #[value(alias = "cay")]
    Cayley,
    /// Canonical coordinates of the second kind: turns about the axes, one after the other. Not odd, to compare with; there for some systems.
    #[value(alias = "ccsk")]
    SecondKind,
}

impl Retraction {
    /// All of them.
    pub const ALL: [Retraction; 3] = [Retraction::Exponential, Retraction::Cayley, Retraction::SecondKind];
    /// Those with which most systems have steps.
    pub const COMMON: [Retraction; 2] = [Retraction::Exponential, Retraction::Cayley];

    /// Those with which there are steps of this system.
    pub fn of(entry: &Entry) -> Vec<Self> {
        let system = entry.system(&entry.example.parameters);
        let is_there = |retraction: &Self| {
            let first = Scheme::member(retraction.map(), 0, 1);
            erased::Stepper::new(system.clone(), &first, entry.step).is_ok()
        };
        Self::ALL.into_iter().filter(is_there).collect()
    }

    /// Its name on the command line and in file names.
    pub fn name(self) -> &'static str {
        match self {
            Retraction::Exponential => "exponential",
            Retraction::Cayley => "cayley",
            Retraction::SecondKind => "second-kind",
        }
    }

    fn map(self) -> Map {
        match self {
            Retraction::Exponential => Map::Exponential,
            Retraction::Cayley => Map::Cayley,
            Retraction::SecondKind => Map::SecondKind,
        }
    }
}

/// The order asked for: 2 for the method itself, higher ones composed of its steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
pub enum Order {
    /// The method itself.
    #[default]
    #[value(name = "2")]
    Two,
    /// Five steps in one.
    #[value(name = "4")]
    Four,
    /// Nine steps in one.
    #[value(name = "6")]
    Six,
    /// Seventeen steps in one.
    #[value(name = "8")]
    Eight,
    /// Thirty-five steps in one.
    #[value(name = "10")]
    Ten,
}

impl Order {
    /// All of them.
    pub const ALL: [Order; 5] = [Order::Two, Order::Four, Order::Six, Order::Eight, Order::Ten];

    /// As a number.
    pub fn number(self) -> u32 {
        match self {
            Order::Two => 2,
            Order::Four => 4,
            Order::Six => 6,
            Order::Eight => 8,
            Order::Ten => 10,
        }
    }
}

/// Parameters, an initial state and controls, in the order of the system's quantities.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// The parameters' components.
    pub parameters: Vec<f64>,
    /// The initial state's components.
    pub state: Vec<f64>,
    /// The controls' components, where they are held all the time; where there is none, the system's own law chooses.
    pub controls: Vec<Option<f64>>,
}

/// What to run: the scheme, the step and the number of steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// The scheme's method.
    pub method: Method,
    /// The scheme's retraction; of no meaning to a classical method.
    pub retraction: Retraction,
    /// The scheme's order; that of the method itself where steps of it cannot be composed.
    pub order: Order,
    /// The step, s.
    pub step: f64,
    /// How many of them.
    pub steps: u64,
}

/// The state of a run from which it can be resumed, bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The state's components.
    pub state: Vec<f64>,
    /// What the stepper carries.
    pub memory: Vec<f64>,
}

impl Checkpoint {
    /// The checkpoint at a sample.
    pub fn at(sample: &Sample<'_>) -> Self {
        Self { state: sample.state.to_vec(), memory: (sample.snapshot)() }
    }
}

/// Observes samples; may end the run.
pub type SampleObserver<'a> = dyn FnMut(&Sample<'_>) -> ControlFlow<()> + 'a;

/// The scheme of a method with a retraction, of an order.
///
/// # Errors
/// If an order above 2 is asked for of a method whose steps are not symmetric, or the method is no scheme.
pub fn scheme(method: Method, retraction: Retraction, order: Order) -> Result<Scheme, SimulationError> {
    let map = retraction.map();
    let base = match method {
        Method::Standard => Scheme::Standard(map),
        Method::EulerA => Scheme::member(map, 0, 1),
        Method::EulerB => Scheme::member(map, 1, 1),
        Method::Midpoint => Scheme::member(map, 1, 2),
        Method::Verlet => Scheme::StormerVerlet(map),
        Method::Family(numerator, denominator) => Scheme::member(map, numerator, denominator),
        Method::TangentLift(numerator, denominator) => {
            Scheme::Step(map, Rule::TangentLift(numerator, denominator))
        }
        Method::RightLift | Method::Classical(_) => return Err(SimulationError::NotCertified { method }),
    };
    check_order(method, order)?;
    Ok(match order {
        Order::Two => base,
        Order::Four => Scheme::composed::<Suzuki4>(base),
        Order::Six => Scheme::composed::<KahanLi6>(base),
        Order::Eight => Scheme::composed::<KahanLi8>(base),
        Order::Ten => Scheme::composed::<SofroniouSpaletta10>(base),
    })
}

/// Whether steps of this order can be composed of the method's.
fn check_order(method: Method, order: Order) -> Result<(), SimulationError> {
    if order == Order::Two || method.is_symmetric() {
        return Ok(());
    }
    let symmetric = Method::COMMON.into_iter().filter(|method| method.is_symmetric());
    let symmetric = symmetric.map(|method| method.to_string()).collect::<Vec<_>>().join(", ");
    Err(SimulationError::NotSymmetric { order: order.number(), method, symmetric })
}

/// A stepper that takes the steps of a classical method of any system, by its vector field.
///
/// # Errors
/// If the parameters are not valid, or the step is zero or not finite.
pub fn classical_stepper(
    system: Arc<dyn erased::System>,
    method: Classical,
    step: f64,
) -> Result<erased::Stepper, ParameterError> {
    classical::stepper(method, system, step)
}

/// One sample of a run: the initial state, or the state after a step.
pub struct Sample<'a> {
    /// Steps taken so far.
    pub index: u64,
    /// The time.
    pub time: f64,
    /// The state.
    pub state: &'a [f64],
    /// The energy, with the controls of the step that starts here.
    pub energy: f64,
    /// The Casimirs.
    pub casimirs: &'a [f64],
    /// Returns what the stepper carries here: see [`erased::Stepper::snapshot`].
    pub snapshot: &'a dyn Fn() -> Vec<f64>,
}

/// Shows samples of a run.
struct Shown<'a, 'o> {
    entry: &'a Entry,
    law: Option<&'a ControlLaw>,
    held: &'a [f64],
    next: &'a dyn Fn(u64) -> u64,
    observer: &'a mut SampleObserver<'o>,
}

impl Observer<dyn erased::System> for Shown<'_, '_> {
    fn observe(&mut self, tick: &Tick<'_, dyn erased::System>) -> ControlFlow<()> {
        let (index, time, state) = (tick.index, tick.time, &tick.state[..]);
        let energy = match self.law {
            Some(_) => self.entry.energy(tick.system, self.law, (state, time)),
            None => tick.system.energy(state, time, self.held),
        };
        let (casimirs, snapshot) = (&tick.system.casimirs(state)[..], &|| tick.snapshot());
        (self.observer)(&Sample { index, time, state, energy, casimirs, snapshot })
    }

    fn next(&self, index: u64) -> u64 {
        (self.next)(index)
    }
}

impl Entry {
    /// Checks parameters; returns a note where valid ones are unphysical.
    ///
    /// # Errors
    /// If no stepper can be built with them.
    pub fn check(&self, setup: &Setup) -> Result<Option<String>, ParameterError> {
        self.system(&setup.parameters).validate()?;
        Ok((self.body_inertia)(&setup.parameters).and_then(|inertia| triangle_note(&inertia)))
    }

    /// What acts on the system from outside: the controls that are held, and for the others its own law. None if it has no controls.
    pub fn law(&self, setup: &Setup) -> Option<ControlLaw> {
        let own = self.control?(&setup.parameters);
        let held = setup.controls.clone();
        Some(Box::new(move |state, time, to| {
            own(state, time, to);
            for (to, held) in to.iter_mut().zip(&held) {
                *to = held.unwrap_or(*to);
            }
        }))
    }

    /// The energy of a system of this kind at a time, with the controls that a law chooses there.
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

    /// Whether its energy is an invariant of the motion: no force acts, and neither time nor controls have a part in it.
    pub fn conserves_energy(&self) -> bool {
        self.description.autonomous && self.description.controls.is_empty()
    }

    /// What takes the steps of a run.
    ///
    /// # Errors
    /// If parameters or step are not valid, or there are no such steps.
    pub(crate) fn stepper(
        &self,
        system: Arc<dyn erased::System>,
        job: &Job,
    ) -> Result<erased::Stepper, SimulationError> {
        let &Job { method, retraction, order, step, .. } = job;
        let stepper = match method {
            Method::Classical(classical) => {
                check_order(method, order)?;
                classical_stepper(system, classical, step)
            }
            Method::RightLift => {
                check_order(method, order)?;
                let lifted = self.right_lift.ok_or(SimulationError::NotIsolated { system: self.name })?;
                lifted(&system.parameters(), retraction, step)
                    .ok_or(SimulationError::NotLifted { retraction: retraction.name() })?;
                let make = move |system: &Arc<dyn erased::System>, step| {
                    lifted(&system.parameters(), retraction, step)
                };
                erased::Stepper::with_methods(system, step, make)
            }
            _ => return Ok(erased::Stepper::new(system, &scheme(method, retraction, order)?, step)?),
        };
        Ok(stepper.map_err(StepperError::from)?)
    }

    /// Makes a run, with the controls of the setup: from the setup's state at time 0, or on from a checkpoint. The observer
    /// sees the initial state, the samples whose indices `next` gives, and the last one.
    ///
    /// # Errors
    /// If parameters or step are not valid, or a step cannot be taken.
    pub fn simulate(
        &self,
        setup: &Setup,
        job: &Job,
        from: Option<&Checkpoint>,
        next: &dyn Fn(u64) -> u64,
        observer: &mut SampleObserver<'_>,
    ) -> Result<RunReport, SimulationError> {
        let system = self.system(&setup.parameters);
        let mut stepper = self.stepper(system.clone(), job)?;
        let mut state = setup.state.clone();
        if let Some(from) = from {
            state.clone_from(&from.state);
            stepper.restore(&from.memory).map_err(StepperError::from)?;
        }
        let held: Option<Vec<f64>> = setup.controls.iter().copied().collect();
        let law = if held.is_some() { None } else { self.law(setup) };
        let held = held.unwrap_or_default();
        let steps = job.steps.saturating_sub(stepper.steps_taken());
        let shown = Shown { entry: self, law: law.as_ref(), held: &held, next, observer };
        let run = Run::new(&mut stepper, &mut state).observe(shown);
        let ran = match &law {
            Some(law) => {
                run.controlled_by(|state: &Vec<f64>, time| self.chosen(law, (state, time))).steps(steps)
            }
            None => run.with_control(held.clone()).steps(steps),
        };
        ran.map_err(|error| too_far::explained(error, &*system, &state, job))
    }

    /// Measures the time that a step takes without an observer, ns: the best of three short runs; none without steps.
    ///
    /// # Errors
    /// If parameters or step are not valid, or a step cannot be taken.
    pub fn time_per_step(&self, setup: &Setup, job: &Job) -> Result<Option<f64>, SimulationError> {
        /// Enough to tell nanoseconds, and still short; those of methods that are written to be right, not to be fast, take longer.
        const STEPS: [u64; 2] = [50_000, 500];
        let most = STEPS[usize::from(job.method.classical().is_some())];
        let job = Job { steps: job.steps.min(most), ..*job };
        if job.steps == 0 {
            return Ok(None);
        }
        let mut best = f64::INFINITY;
        for _ in 0..3 {
            let start = Instant::now();
            self.simulate(setup, &job, None, &|_| u64::MAX, &mut |_| ControlFlow::Continue(()))?;
            best = best.min(start.elapsed().as_secs_f64());
        }
        Ok(Some(best / job.steps as f64 * 1e9))
    }

    /// Whether there are steps of a method on the exponential map or the Cayley map.
    pub(crate) fn has_method(&self, method: Method) -> bool {
        let system = self.system(&self.example.parameters);
        let is_there = |retraction: Retraction| {
            let job = Job { method, retraction, order: Order::Two, step: self.step, steps: 0 };
            self.stepper(system.clone(), &job).is_ok()
        };
        Retraction::COMMON.into_iter().any(is_there)
    }

    /// The order that a job's step has.
    pub fn order(&self, job: &Job) -> u32 {
        match job.method {
            Method::Classical(classical) => classical.order(),
            Method::RightLift => 2,
            method if method.is_symmetric() => job.order.number(),
            Method::TangentLift(..) => 1,
            // of the family's other members it is 2 only where they are all symmetric
            _ if self.standard(job.retraction) == Method::EulerA => 2,
            _ => 1,
        }
    }

    /// What its standard scheme of order 2 is with a retraction: `euler-a` or `verlet`.
    pub fn standard(&self, retraction: Retraction) -> Method {
        match Scheme::Standard(retraction.map()).resolved(self.description.invariant) {
            Scheme::StormerVerlet(_) => Method::Verlet,
            _ => Method::EulerA,
        }
    }
}

/// The moments of a body of mass satisfy the triangle inequality: each is at most the sum of the other two.
fn triangle_note(inertia: &Matrix3<f64>) -> Option<String> {
    let mut moments: [f64; 3] = crate::linear::symmetric_eigen(inertia).0.into();
    moments.sort_by(f64::total_cmp);
    let [small, middle, large] = moments;
    (large > (small + middle) * (1.0 + 1e-12)).then(|| {
        format!(
            "no body of mass has principal moments of inertia {small}, {middle}, {large}: \
             the largest exceeds the sum of the others"
        )
    })
}
