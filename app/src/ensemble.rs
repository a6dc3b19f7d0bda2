//! Ensembles of any system of the catalogue, with parameters and states as flat lists of numbers.

use std::ops::ControlFlow;

use coadjoint::ensemble::{Failed, Spread};
use coadjoint::erased::{self, Ensemble};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::entry::{ControlLaw, Entry};
use crate::simulation::{Setup, SimulationError};

/// The specification of an ensemble of one system.
#[derive(Clone, Debug, PartialEq)]
pub struct EnsembleSpec {
    /// How many members.
    pub members: usize,
    /// The half-width of the uniform distribution of each number about the setup; controls do not vary.
    pub widths: Setup,
    /// The seed of the random members.
    pub seed: u64,
    /// The step, s.
    pub step: f64,
    /// How many of them.
    pub steps: u64,
    /// Steps between two samples of the distribution; 0 counts as 1.
    pub every: u64,
}

/// A quantity whose distribution is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observable {
    /// The energy.
    Energy,
    /// A component of the state, by its place.
    State(usize),
}

/// Called at each sample with the number of steps taken; may end the run.
pub type ProgressFn<'a> = dyn FnMut(u64) -> ControlFlow<()> + 'a;

/// The result of an ensemble run.
#[derive(Clone, Debug, PartialEq)]
pub struct EnsembleSummary {
    /// For each quantity its distribution at each sample.
    pub spreads: Vec<Vec<Spread>>,
    /// The members that failed.
    pub failed: Vec<Failed>,
    /// Steps of all members together.
    pub member_steps: u64,
    /// How many members are stepped side by side.
    pub width: usize,
    /// The time that the steps took, with the choice of controls, s.
    pub seconds: f64,
}

/// Runs an ensemble with the system's standard step on the Cayley map, and the controls of the setup. The callback may end the run.
///
/// # Errors
/// If the parameters or the state of a member are not valid, or the step.
pub fn run(
    entry: &Entry,
    setup: &Setup,
    spec: &EnsembleSpec,
    observables: &[Observable],
    progress: &mut ProgressFn<'_>,
) -> Result<EnsembleSummary, SimulationError> {
    let members: Vec<Setup> = (0..spec.members).map(|member| random_member(setup, spec, member)).collect();
    let laws: Option<Vec<ControlLaw>> = members.iter().map(|own| entry.law(own)).collect();
    let members = members.into_iter().map(|Setup { parameters, state, .. }| (parameters, state));
    let mut ensemble = Ensemble::new(&*entry.system(&setup.parameters), members, spec.step)?;
    let mut spreads = vec![Vec::new(); observables.len()];
    let every = spec.every.max(1);
    let (mut taken, mut member_steps, mut seconds) = (0, 0, 0.0);
    loop {
        if taken == spec.steps || taken.is_multiple_of(every) {
            for (spreads, &observable) in spreads.iter_mut().zip(observables) {
                spreads.push(spread(&ensemble, observable));
            }
            if progress(taken).is_break() {
                break;
            }
        }
        if taken == spec.steps {
            break;
        }
        // up to the next sample
        let steps = (every - taken % every).min(spec.steps - taken);
        let start = std::time::Instant::now();
        member_steps += match &laws {
            Some(laws) => ensemble.run_controlled(steps, &|member, state, time, control| {
                laws[member](state, time, control);
            }),
            None => ensemble.run(steps),
        };
        seconds += start.elapsed().as_secs_f64();
        taken += steps;
    }
    Ok(EnsembleSummary {
        spreads,
        failed: ensemble.failed().to_vec(),
        member_steps,
        width: ensemble.width(),
        seconds,
    })
}

/// How a quantity is distributed over the members now.
fn spread(ensemble: &Ensemble, observable: Observable) -> Spread {
    let time = ensemble.time();
    let value = |(_, system, state): (usize, &dyn erased::System, Vec<f64>)| match observable {
        Observable::Energy => system.energy(&state, time),
        Observable::State(place) => state.get(place).copied().unwrap_or(f64::NAN),
    };
    let mut values: Vec<f64> = ensemble.members().map(value).filter(|value| !value.is_nan()).collect();
    Spread::of(time, &mut values)
}

/// The setup of one member: the same numbers for the same seed and member, however many there are.
fn random_member(setup: &Setup, spec: &EnsembleSpec, member: usize) -> Setup {
    let mut random = ChaCha8Rng::seed_from_u64(spec.seed);
    random.set_stream(member as u64);
    let mut draw = |values: &[f64], widths: &[f64]| {
        let between = |(&value, &width): (&f64, &f64)| {
            // 53 bits, from −1 to 1
            let even = (random.next_u64() >> 11) as f64 * 2_f64.powi(-52) - 1.0;
            value + width * even
        };
        values.iter().zip(widths).map(between).collect()
    };
    Setup {
        parameters: draw(&setup.parameters, &spec.widths.parameters),
        state: draw(&setup.state, &spec.widths.state),
        controls: setup.controls.clone(),
    }
}
