//! Runs of any system of the catalogue, with parameters and states as flat lists of numbers.

use std::ops::ControlFlow;
use std::time::Instant;

use coadjoint::prelude::*;

use crate::catalogued::Catalogued;
use crate::error::Error;

/// The map from the Lie algebra to the group that a step is built on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
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

/// The order of the step: 2 as generated, higher ones composed of such steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Order {
    /// The generated step itself.
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

impl std::fmt::Display for Order {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let order = match self {
            Order::Two => 2,
            Order::Four => 4,
            Order::Six => 6,
            Order::Eight => 8,
            Order::Ten => 10,
        };
        write!(f, "{order}")
    }
}

/// Calls a function for the scheme that a job asks for.
macro_rules! with_scheme {
    ($job:expr, $function:ident::<$S:ident>($($argument:expr),*)) => {
        with_scheme!(@match $job, $function, $S, ($($argument),*), Exponential Cayley)
    };
    (@match $job:expr, $function:ident, $S:ident, $arguments:tt, $($R:ident)*) => {
        match ($job.retraction, $job.order) {
            $(
                (Retraction::$R, Order::Two) => with_scheme!(@call $function, $S, $R, $arguments),
                (Retraction::$R, Order::Four) => with_scheme!(@call $function, $S, Order4<$R>, $arguments),
                (Retraction::$R, Order::Six) => with_scheme!(@call $function, $S, Order6<$R>, $arguments),
                (Retraction::$R, Order::Eight) => with_scheme!(@call $function, $S, Order8<$R>, $arguments),
                (Retraction::$R, Order::Ten) => with_scheme!(@call $function, $S, Order10<$R>, $arguments),
            )*
        }
    };
    (@call $function:ident, $S:ident, $M:ty, ($($argument:expr),*)) => {
        $function::<$S, $M>($($argument),*)
    };
}

/// Parameters and an initial state, in the order of the system's quantities.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// The parameters' components.
    pub parameters: Vec<f64>,
    /// The initial state's components.
    pub state: Vec<f64>,
}

/// How far to go, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Job {
    /// The scheme's retraction.
    pub retraction: Retraction,
    /// The scheme's order.
    pub order: Order,
    /// The step, s.
    pub step: f64,
    /// How many of them.
    pub steps: u64,
}

/// What a run shows at every step, the initial state included.
#[derive(Clone, Copy, Debug)]
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
}

/// Sees every sample; may fail, which ends the run.
pub type Watch<'a> = dyn FnMut(&Sample<'_>) -> Result<(), Error> + 'a;

/// What a run found.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Steps and Newton iterations.
    pub run: RunReport,
    /// The energy at the start.
    pub energy: f64,
    /// Its largest error.
    pub energy_error: f64,
    /// The Casimirs at the start.
    pub casimirs: Vec<f64>,
    /// The largest drift of each.
    pub casimir_drifts: Vec<f64>,
}

/// The example of a system as flat lists.
pub fn example<S: Catalogued>() -> Setup {
    let (system, state) = S::example();
    Setup {
        parameters: system.to_parameters().as_ref().to_vec(),
        state: state.to_components().as_ref().to_vec(),
    }
}

/// Checks parameters; a note says what is odd about valid ones.
///
/// # Errors
/// If no stepper can be built with them.
pub fn check<S: Catalogued>(setup: &Setup) -> Result<Option<String>, ParameterError> {
    let (system, _) = realize::<S>(setup);
    system.validate()?;
    Ok(system.body_inertia().and_then(|inertia| triangle_note(&inertia)))
}

/// Makes a run.
///
/// # Errors
/// If parameters or step are not valid, a step cannot be taken, or `watch` fails.
pub fn simulate<S: Catalogued>(setup: &Setup, job: &Job, watch: &mut Watch<'_>) -> Result<Outcome, Error> {
    with_scheme!(job, run::<S>(setup, job, watch))
}

/// Measures the time that a step takes with nobody watching, ns: the best of three short runs; none without steps.
///
/// # Errors
/// If parameters or step are not valid, or a step cannot be taken.
pub fn time_per_step<S: Catalogued>(setup: &Setup, job: &Job) -> Result<Option<f64>, Error> {
    with_scheme!(job, clock::<S>(setup, job))
}

fn run<S: Catalogued + Discretized<M>, M>(
    setup: &Setup,
    job: &Job,
    watch: &mut Watch<'_>,
) -> Result<Outcome, Error> {
    let (system, mut state) = realize::<S>(setup);
    let mut stepper = system.stepper::<M>(job.step)?;
    let mut invariants = Invariants::new();
    let mut messenger = Messenger { watch, failure: None };
    let report =
        Run::new(&mut stepper, &mut state).observe(&mut invariants).observe(&mut messenger).steps(job.steps);
    if let Some(failure) = messenger.failure {
        return Err(failure);
    }
    Ok(Outcome {
        run: report?,
        energy: invariants.initial_energy().unwrap_or(f64::NAN),
        energy_error: invariants.energy_error(),
        casimirs: invariants.initial_casimirs().to_vec(),
        casimir_drifts: invariants.casimir_drifts().to_vec(),
    })
}

/// Shows a run's ticks to a [`Watch`], and keeps the error with which that ended the run.
struct Messenger<'a, 'w> {
    watch: &'a mut Watch<'w>,
    failure: Option<Error>,
}

impl<S: System<Scalar = f64>> Observer<S> for Messenger<'_, '_> {
    fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        let components = tick.state.to_components();
        let casimirs = tick.system.casimirs(tick.state);
        let sample = Sample {
            index: tick.index,
            time: tick.time,
            state: components.as_ref(),
            energy: tick.system.energy(tick.state),
            casimirs: casimirs.as_ref(),
        };
        match (self.watch)(&sample) {
            Ok(()) => ControlFlow::Continue(()),
            Err(failure) => {
                self.failure = Some(failure);
                ControlFlow::Break(())
            }
        }
    }
}

fn clock<S: Catalogued + Discretized<M>, M>(setup: &Setup, job: &Job) -> Result<Option<f64>, Error> {
    /// Enough to tell nanoseconds, and still short.
    const STEPS: u64 = 50_000;
    let steps = job.steps.min(STEPS);
    if steps == 0 {
        return Ok(None);
    }
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let (system, mut state) = realize::<S>(setup);
        let mut stepper = system.stepper::<M>(job.step)?;
        let start = Instant::now();
        Run::new(&mut stepper, &mut state).steps(steps)?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok(Some(best / steps as f64 * 1e9))
}

/// The system and state with these components.
fn realize<S: Catalogued>(setup: &Setup) -> (S, S::State) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_triangle_inequality_is_noticed() {
        let diagonal = |x, y, z| Matrix3::from_diagonal(&Vector3::new(x, y, z));
        assert_eq!(triangle_note(&diagonal(1.0, 2.0, 2.5)), None);
        // a flat plate lies on the border
        assert_eq!(triangle_note(&diagonal(1.0, 2.0, 3.0)), None);
        let note = triangle_note(&diagonal(1.0, 100.0, 10.0)).expect("not a body");
        assert!(note.contains("moments of inertia 1, 10, 100:"), "{note}");
    }

    #[test]
    fn retractions_have_the_names_that_the_command_line_takes() {
        use clap::ValueEnum;
        for retraction in Retraction::ALL {
            assert_eq!(Retraction::from_str(retraction.name(), false), Ok(retraction));
        }
        assert_eq!(Retraction::from_str("exp", false), Ok(Retraction::Exponential));
    }
}
