//! Runs of any system of the catalogue, with parameters and states as flat lists of numbers.

use std::error::Error as _;
use std::ops::ControlFlow;
use std::time::Instant;

use coadjoint::__private::Map;
use coadjoint::certify::{CertifyError, Report, certify_erased};
use coadjoint::composition::{KahanLi6, KahanLi8, SofroniouSpaletta10, Suzuki4};
use coadjoint::ensemble::EnsembleError;
pub use coadjoint::erased::Sample;
use coadjoint::erased::{self, Controls, RunOptions, Scheme, StepperError};
use coadjoint::prelude::*;
use coadjoint::system::Quantity;
use coadjoint::{RunError, RunReport};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::catalogue::Entry;
use crate::catalogued::Catalogued;

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
    /// Those with which there are steps of every system.
    pub const COMMON: [Retraction; 2] = [Retraction::Exponential, Retraction::Cayley];

    /// Those with which there are steps of this system.
    pub fn of(entry: &Entry) -> Vec<Self> {
        let system = (entry.system)(&(entry.example)().parameters);
        let is_there = |retraction: &Self| {
            let first = Scheme::member(retraction.map(), 0, 1);
            erased::Stepper::new(&*system, &first, entry.step).is_ok()
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

/// The integration method, which is built on a retraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The system's standard step of order 2: `euler-a` where nothing but momentum and advected parameters has a part in the motion and the
    /// retraction is odd, else `verlet`.
    #[default]
    Standard,
    /// The symplectic Euler step: the paper's reduced step, of order 2 where it is the standard, else of order 1.
    EulerA,
    /// The adjoint of `euler-a`.
    EulerB,
    /// The implicit midpoint step, of order 2.
    Midpoint,
    /// Störmer and Verlet: half a step of `euler-a`, then half a step of `euler-b`; of order 2.
    Verlet,
}

impl Method {
    /// All of them.
    pub const ALL: [Method; 5] =
        [Method::Standard, Method::EulerA, Method::EulerB, Method::Midpoint, Method::Verlet];

    /// Its name on the command line and in file names.
    pub fn name(self) -> &'static str {
        match self {
            Method::Standard => "standard",
            Method::EulerA => "euler-a",
            Method::EulerB => "euler-b",
            Method::Midpoint => "midpoint",
            Method::Verlet => "verlet",
        }
    }

    /// Whether it is symmetric and of order 2 for every system, so that steps of higher order can be composed of it.
    pub fn is_symmetric(self) -> bool {
        !matches!(self, Method::EulerA | Method::EulerB)
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

/// Parameters and an initial state, in the order of the system's quantities.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// The parameters' components.
    pub parameters: Vec<f64>,
    /// The initial state's components.
    pub state: Vec<f64>,
}

/// What to run: the scheme, the step and the number of steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// The scheme's method.
    pub method: Method,
    /// The scheme's retraction.
    pub retraction: Retraction,
    /// The scheme's order.
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
        Self { state: sample.state.to_vec(), memory: sample.snapshot() }
    }
}

/// Observes samples; may end the run.
pub type SampleObserver<'a> = dyn FnMut(&Sample<'_>) -> ControlFlow<()> + 'a;

/// An error of a simulation.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// No stepper can be built with these parameters, this scheme or this step, or it is not the one that an earlier run was made with.
    #[error(transparent)]
    Stepper(#[from] StepperError),
    /// The motion could not be computed to its end.
    #[error(transparent)]
    Motion(#[from] RunError),
    /// A certificate could not be measured.
    #[error(transparent)]
    Certificate(#[from] CertifyError),
    /// An ensemble cannot be built.
    #[error("{}: {}", .0, .0.source().map(ToString::to_string).unwrap_or_default())]
    Ensemble(#[from] EnsembleError),
    /// Steps of higher order are composed of symmetric ones.
    #[error(
        "order {order} is composed of symmetric steps, which method {method} does not make for every system; take one of {symmetric}"
    )]
    NotSymmetric {
        /// The order asked for.
        order: u32,
        /// The method asked for.
        method: &'static str,
        /// Those whose steps are symmetric.
        symmetric: String,
    },
}

/// The scheme of a method with a retraction, of an order.
///
/// # Errors
/// If an order above 2 is asked for of a method whose steps are not symmetric.
pub fn scheme(method: Method, retraction: Retraction, order: Order) -> Result<Scheme, SimulationError> {
    let map = retraction.map();
    let base = match method {
        Method::Standard => Scheme::Standard(map),
        Method::EulerA => Scheme::member(map, 0, 1),
        Method::EulerB => Scheme::member(map, 1, 1),
        Method::Midpoint => Scheme::member(map, 1, 2),
        Method::Verlet => Scheme::StormerVerlet(map),
    };
    if order != Order::Two && !method.is_symmetric() {
        let symmetric = Method::ALL.into_iter().filter(|method| method.is_symmetric()).map(Method::name);
        return Err(SimulationError::NotSymmetric {
            order: order.number(),
            method: method.name(),
            symmetric: symmetric.collect::<Vec<_>>().join(", "),
        });
    }
    Ok(match order {
        Order::Two => base,
        Order::Four => Scheme::composed::<Suzuki4>(base),
        Order::Six => Scheme::composed::<KahanLi6>(base),
        Order::Eight => Scheme::composed::<KahanLi8>(base),
        Order::Ten => Scheme::composed::<SofroniouSpaletta10>(base),
    })
}

/// Takes so many steps of a system with its own control law from the time 0, and shows the initial state and the state after each step, with its
/// index and time.
///
/// # Errors
/// If parameters or step are not valid, or a step cannot be taken.
pub fn each_step<S: Catalogued>(
    system: &S,
    start: &S::State,
    (method, retraction, order): (Method, Retraction, Order),
    (step, steps): (f64, u64),
    mut observe: impl FnMut(u64, f64, &S::State),
) -> Result<(), SimulationError> {
    let mut stepper = erased::Stepper::new(system, &scheme(method, retraction, order)?, step)?;
    let mut components = start.to_components();
    for index in 0..=steps {
        let (state, time) = (S::State::from_components(&components), stepper.time());
        observe(index, time, &state);
        if index < steps {
            let control = system.control(&state, time).to_components();
            let step = |cause| RunError::new(index + 1, time, RunReport::default(), cause);
            stepper.step(components.as_mut(), control.as_ref()).map_err(step)?;
        }
    }
    Ok(())
}

impl Entry {
    /// Checks parameters; returns a note where valid ones are unphysical.
    ///
    /// # Errors
    /// If no stepper can be built with them.
    pub fn check(&self, setup: &Setup) -> Result<Option<String>, ParameterError> {
        (self.system)(&setup.parameters).validate()?;
        Ok((self.body_inertia)(&setup.parameters).and_then(|inertia| triangle_note(&inertia)))
    }

    /// Makes a run, with the system's own control law: from the setup's state at time 0, or on from a checkpoint. The observer
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
        let system = (self.system)(&setup.parameters);
        let scheme = scheme(job.method, job.retraction, job.order)?;
        let mut stepper = erased::Stepper::new(&*system, &scheme, job.step)?;
        let mut state = setup.state.clone();
        if let Some(from) = from {
            state.clone_from(&from.state);
            stepper.restore(&from.memory).map_err(StepperError::from)?;
        }
        let law = self.control.map(|control| control(&setup.parameters));
        let controls = law.as_ref().map_or(Controls::Held(&[]), |law| Controls::Chosen(law));
        let steps = job.steps.saturating_sub(stepper.steps_taken());
        Ok(erased::run(&mut stepper, &mut state, &RunOptions { steps, controls, next }, observer)?)
    }

    /// Measures the time that a step takes without an observer, ns: the best of three short runs; none without steps.
    ///
    /// # Errors
    /// If parameters or step are not valid, or a step cannot be taken.
    pub fn time_per_step(&self, setup: &Setup, job: &Job) -> Result<Option<f64>, SimulationError> {
        /// Enough to tell nanoseconds, and still short.
        const STEPS: u64 = 50_000;
        let job = Job { steps: job.steps.min(STEPS), ..*job };
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

    /// Measures the claims of a scheme, at the states of the example after 40 and after 80 steps; with the system's own
    /// control law.
    ///
    /// # Errors
    /// If parameters are not valid, or a step cannot be taken.
    pub fn certify(
        &self,
        setup: &Setup,
        method: Method,
        retraction: Retraction,
    ) -> Result<Report, SimulationError> {
        let job = Job {
            method: Method::Standard,
            retraction: Retraction::Exponential,
            order: Order::Two,
            step: self.step,
            steps: 80,
        };
        let mut states = Vec::new();
        self.simulate(setup, &job, None, &|index| index + 40, &mut |sample| {
            states.push(sample.state.to_vec());
            ControlFlow::Continue(())
        })?;
        let controls: Vec<Vec<f64>> = match self.control {
            Some(control) => {
                let law = control(&setup.parameters);
                states.iter().map(|state| chosen(&law, self.description.controls, state)).collect()
            }
            None => Vec::new(),
        };
        let system = (self.system)(&setup.parameters);
        let method = if method == Method::Standard { self.standard(retraction) } else { method };
        let scheme = scheme(method, retraction, Order::Two)?;
        Ok(certify_erased(&*system, &scheme, &states, &controls, self.certified_step)?)
    }

    /// What its standard scheme of order 2 is with a retraction: `euler-a` or `verlet`.
    pub fn standard(&self, retraction: Retraction) -> Method {
        match Scheme::Standard(retraction.map()).resolved(self.description.invariant) {
            Scheme::StormerVerlet(_) => Method::Verlet,
            _ => Method::EulerA,
        }
    }
}

/// What a law chooses at a state at time 0.
fn chosen(law: &erased::Law<'_>, controls: &[Quantity], state: &[f64]) -> Vec<f64> {
    let mut control = vec![0.0; controls.iter().map(|quantity| quantity.components.len()).sum()];
    law(state, 0.0, &mut control);
    control
}

/// The moments of a body of mass satisfy the triangle inequality: each is at most the sum of the other two.
fn triangle_note(inertia: &Matrix3<f64>) -> Option<String> {
    let mut moments: [f64; 3] = inertia.symmetric_eigenvalues().into();
    moments.sort_by(f64::total_cmp);
    let [small, middle, large] = moments;
    (large > (small + middle) * (1.0 + 1e-12)).then(|| {
        format!(
            "no body of mass has principal moments of inertia {small}, {middle}, {large}: \
             the largest exceeds the sum of the others"
        )
    })
}
