//! Runs of any system of the catalogue, with parameters and states as flat lists of numbers.

use std::error::Error as _;
use std::ops::ControlFlow;
use std::time::Instant;

use coadjoint::certify::{Certification, CertifyError, Report};
use coadjoint::ensemble::EnsembleError;
use coadjoint::prelude::*;
use coadjoint::stepper::Stepping;
use coadjoint::{RunError, RunReport};
use thiserror::Error;

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
}

impl Retraction {
    /// Both.
    pub const ALL: [Retraction; 2] = [Retraction::Exponential, Retraction::Cayley];

    /// Its name on the command line and in file names.
    pub fn name(self) -> &'static str {
        match self {
            Retraction::Exponential => "exponential",
            Retraction::Cayley => "cayley",
        }
    }
}

/// What a step makes of its retraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The system's standard step of order 2: `euler-a` where nothing but momentum and advected parameters has a part in the motion,
    /// else `verlet`.
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

/// The scheme of a job's method and order with a retraction.
macro_rules! scheme_on {
    ($S:ident, $R:ty, $job:expr) => {
        match $job.method {
            Method::Standard => Ok(composed!($S, $R, $job.order)),
            Method::Midpoint => Ok(composed!($S, Midpoint<$R>, $job.order)),
            Method::Verlet => Ok(composed!($S, StormerVerlet<$R>, $job.order)),
            method if $job.order != Order::Two => Err(not_symmetric(method, $job.order)),
            Method::EulerA => Ok(<$S as Schemes>::built::<SymplecticEulerA<$R>> as Build<$S>),
            Method::EulerB => Ok(<$S as Schemes>::built::<SymplecticEulerB<$R>> as Build<$S>),
        }
    };
}

/// A symmetric scheme of order 2, or of a composition of its steps.
macro_rules! composed {
    ($S:ident, $M:ty, $order:expr) => {
        match $order {
            Order::Two => <$S as Schemes>::built::<$M> as Build<$S>,
            Order::Four => <$S as Schemes>::built::<Order4<$M>>,
            Order::Six => <$S as Schemes>::built::<Order6<$M>>,
            Order::Eight => <$S as Schemes>::built::<Order8<$M>>,
            Order::Ten => <$S as Schemes>::built::<Order10<$M>>,
        }
    };
}

fn not_symmetric(method: Method, order: Order) -> SimulationError {
    let symmetric: Vec<&str> =
        Method::ALL.into_iter().filter(|method| method.is_symmetric()).map(Method::name).collect();
    SimulationError::NotSymmetric {
        order: order.number(),
        method: method.name(),
        symmetric: symmetric.join(", "),
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

/// How far to go, and how.
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

/// Where a run is: what it goes on from, to the last bit the same.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Whereabouts {
    /// The state's components.
    pub state: Vec<f64>,
    /// What the stepper carries.
    pub memory: Vec<f64>,
}

/// What a run shows at every step, the initial state included.
#[derive(Clone, Copy)]
pub struct Sample<'a> {
    /// Steps taken so far.
    pub index: u64,
    /// Time, s.
    pub time: f64,
    /// The state's components.
    pub state: &'a [f64],
    /// Energy.
    pub energy: f64,
    /// The Casimirs.
    pub casimirs: &'a [f64],
    /// What the stepper carries.
    memory: &'a dyn Fn() -> Vec<f64>,
}

impl Sample<'_> {
    /// Where the run is.
    pub fn whereabouts(&self) -> Whereabouts {
        Whereabouts { state: self.state.to_vec(), memory: (self.memory)() }
    }
}

impl std::fmt::Debug for Sample<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Sample")
            .field("index", &self.index)
            .field("state", &self.state)
            .finish_non_exhaustive()
    }
}

/// Sees every sample; may end the run.
pub type Watch<'a> = dyn FnMut(&Sample<'_>) -> ControlFlow<()> + 'a;

/// A run that cannot be made, or not to its end.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// No stepper can be built with these parameters or this step.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The motion could not be computed to its end.
    #[error("{}: {}", .0, .0.source)]
    Motion(#[from] RunError),
    /// A certificate could not be measured.
    #[error(transparent)]
    Certificate(#[from] CertifyError),
    /// An ensemble cannot be made.
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

/// The example of a system as flat lists.
pub fn example<S: Catalogued + 'static>() -> Setup {
    flat(&S::example())
}

/// A system and its state as flat lists.
pub fn flat<S: System<Scalar = f64>>((system, state): &(S, S::State)) -> Setup {
    Setup {
        parameters: system.to_parameters().as_ref().to_vec(),
        state: state.to_components().as_ref().to_vec(),
    }
}

/// Checks parameters; a note says what is odd about valid ones.
///
/// # Errors
/// If no stepper can be built with them.
pub fn check<S: Catalogued + 'static>(setup: &Setup) -> Result<Option<String>, ParameterError> {
    let (system, _) = realize::<S>(setup);
    system.validate()?;
    Ok(system.body_inertia().and_then(|inertia| triangle_note(&inertia)))
}

/// Makes a run, with the system's own control law: from the setup's state at time 0, or on from where an earlier run was.
///
/// # Errors
/// If parameters or step are not valid, or a step cannot be taken.
pub fn simulate<S: Catalogued + 'static>(
    setup: &Setup,
    job: &Job,
    from: Option<&Whereabouts>,
    watch: &mut Watch<'_>,
) -> Result<RunReport, SimulationError> {
    let (system, mut state) = realize::<S>(setup);
    if let Some(from) = from {
        let mut components = state.to_components();
        fill(components.as_mut(), &from.state);
        state = S::State::from_components(&components);
    }
    let memory = from.map(|from| from.memory.as_slice());
    run(&system, &mut state, job, memory, &mut Messenger(watch))
}

/// Measures the time that a step takes with nobody watching, ns: the best of three short runs; none without steps.
///
/// # Errors
/// If parameters or step are not valid, or a step cannot be taken.
pub fn time_per_step<S: Catalogued + 'static>(
    setup: &Setup,
    job: &Job,
) -> Result<Option<f64>, SimulationError> {
    /// Enough to tell nanoseconds, and still short.
    const STEPS: u64 = 50_000;
    let job = Job { steps: job.steps.min(STEPS), ..*job };
    if job.steps == 0 {
        return Ok(None);
    }
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let (system, mut state) = realize::<S>(setup);
        let start = Instant::now();
        run(&system, &mut state, &job, None, &mut ())?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok(Some(best / job.steps as f64 * 1e9))
}

/// Measures what a scheme claims of its steps, at three states of the example: its start, and two that it comes to; with the system's own
/// control law.
///
/// # Errors
/// If parameters are not valid, or a step cannot be taken.
pub fn certify<S: Catalogued + 'static>(
    setup: &Setup,
    method: Method,
    retraction: Retraction,
) -> Result<Report, SimulationError> {
    let (system, mut state) = realize::<S>(setup);
    let mut states = vec![state.clone()];
    let mut stepper = system.stepper::<Exponential>(S::STEP)?;
    let control = |state: &S::State, time: f64| system.control(state, time);
    Run::new(&mut stepper, &mut state)
        .controlled_by(control)
        .every(40, |tick| states.push(tick.state.clone()))
        .steps(80)?;
    states.remove(0);
    let controls: Vec<S::Control> = states.iter().map(|state| system.control(state, 0.0)).collect();
    let mut certification = Certification::new(&system).states(&states).controls(&controls);
    if let Some(step) = S::CERTIFIED_STEP {
        certification = certification.step(step);
    }
    let method = if method == Method::Standard { standard::<S>() } else { method };
    Ok(match (method, retraction) {
        (Method::EulerA, Retraction::Exponential) => certification.run::<SymplecticEulerA>(),
        (Method::EulerA, Retraction::Cayley) => certification.run::<SymplecticEulerA<Cayley>>(),
        (Method::EulerB, Retraction::Exponential) => certification.run::<SymplecticEulerB>(),
        (Method::EulerB, Retraction::Cayley) => certification.run::<SymplecticEulerB<Cayley>>(),
        (Method::Midpoint, Retraction::Exponential) => certification.run::<Midpoint>(),
        (Method::Midpoint, Retraction::Cayley) => certification.run::<Midpoint<Cayley>>(),
        (_, Retraction::Exponential) => certification.run::<StormerVerlet>(),
        (_, Retraction::Cayley) => certification.run::<StormerVerlet<Cayley>>(),
    }?)
}

/// What a system's standard step is: `euler-a` or `verlet`.
pub fn standard<S: Catalogued + 'static>() -> Method {
    let name = std::any::type_name::<S::Standard<Exponential>>();
    if name == std::any::type_name::<SymplecticEulerA<Exponential>>() {
        Method::EulerA
    } else {
        Method::Verlet
    }
}

/// Builds the stepper of a job's scheme. A run is the same for all schemes, and so compiled once for a system, not once for each of its
/// schemes.
type Build<S> = fn(&S, f64) -> Result<Box<dyn Stepping<System = S>>, ParameterError>;

/// The schemes of one system. A trait with this method provided, because the compiler keeps such methods with the type that has them: it
/// compiles systems beside each other, and anew only those that changed.
trait Schemes: Catalogued + 'static {
    fn built<M: 'static>(&self, step: f64) -> Result<Box<dyn Stepping<System = Self>>, ParameterError>
    where
        Self: Discretized<M>,
    {
        Ok(Box::new(self.stepper::<M>(step)?))
    }
}

impl<S: Catalogued + 'static> Schemes for S {}

/// Makes the run of a job, or goes on with it.
fn run<S: Catalogued + 'static>(
    system: &S,
    state: &mut S::State,
    job: &Job,
    memory: Option<&[f64]>,
    observer: &mut dyn Observer<S>,
) -> Result<RunReport, SimulationError> {
    let mut stepper = builder::<S>(job)?(system, job.step)?;
    if let Some(memory) = memory {
        stepper.recall(memory)?;
    }
    let left = job.steps.saturating_sub(stepper.steps_taken());
    let control = |state: &S::State, time: f64| system.control(state, time);
    Ok(Run::new(stepper.as_mut(), state).resumed().controlled_by(control).observe(observer).steps(left)?)
}

/// How to build the stepper of the scheme that a job asks for.
fn builder<S: Catalogued + 'static>(job: &Job) -> Result<Build<S>, SimulationError> {
    match job.retraction {
        Retraction::Exponential => scheme_on!(S, Exponential, job),
        Retraction::Cayley => scheme_on!(S, Cayley, job),
    }
}

/// Shows a run's ticks to a [`Watch`].
struct Messenger<'a, 'w>(&'a mut Watch<'w>);

impl<S: System<Scalar = f64>> Observer<S> for Messenger<'_, '_> {
    fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        let components = tick.state.to_components();
        let casimirs = tick.system.casimirs(tick.state);
        let sample = Sample {
            index: tick.index,
            time: tick.time,
            state: components.as_ref(),
            energy: tick.system.energy_at(tick.state, tick.time),
            casimirs: casimirs.as_ref(),
            memory: &|| tick.memory(),
        };
        (self.0)(&sample)
    }
}

/// The system and state with these components.
pub(crate) fn realize<S: Catalogued + 'static>(setup: &Setup) -> (S, S::State) {
    let (system, state) = S::example();
    let mut parameters = system.to_parameters();
    fill(parameters.as_mut(), &setup.parameters);
    let mut components = state.to_components();
    fill(components.as_mut(), &setup.state);
    (S::from_parameters(&parameters), S::State::from_components(&components))
}

fn fill(target: &mut [f64], values: &[f64]) {
    for (target, value) in target.iter_mut().zip(values) {
        *target = *value;
    }
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
