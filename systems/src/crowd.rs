//! Ensembles of any system of the catalogue, with parameters and states as flat lists of numbers.

use std::ops::ControlFlow;

use coadjoint::ensemble::{Failed, Moment, Spread, Watcher};
use coadjoint::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::catalogued::Catalogued;
use crate::simulation::{Setup, SimulationError, realize};

/// An ensemble of one system.
#[derive(Clone, Debug, PartialEq)]
pub struct Crowd {
    /// How many members.
    pub members: usize,
    /// How far each number may be from the setup's, to either side.
    pub widths: Setup,
    /// Another seed draws other members.
    pub seed: u64,
    /// The step, s.
    pub step: f64,
    /// How many of them.
    pub steps: u64,
    /// Steps between two looks at the members.
    pub every: u64,
}

/// What is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The energy.
    Energy,
    /// A component of the state, by its place.
    State(usize),
}

/// Sees how many steps were taken; may end the run.
pub type Glance<'a> = dyn FnMut(u64) -> ControlFlow<()> + 'a;

/// How an ensemble has moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// For each quantity its distribution at each look.
    pub spreads: Vec<Vec<Spread>>,
    /// The members that failed.
    pub failed: Vec<Failed>,
    /// Steps of all members together.
    pub member_steps: u64,
    /// How many members are stepped side by side.
    pub width: usize,
    /// The time that the steps took, s.
    pub seconds: f64,
}

/// Runs an ensemble with the system's standard step on the Cayley map, and its own control law. The watch may end the run.
///
/// # Errors
/// If the parameters or the state of a member are not valid, or the step.
pub fn run<S: Catalogued + 'static>(
    setup: &Setup,
    crowd: &Crowd,
    shown: &[Shown],
    watch: &mut Glance<'_>,
) -> Result<Course, SimulationError> {
    let (systems, states): (Vec<S>, Vec<S::State>) =
        (0..crowd.members).map(|member| realize::<S>(&drawn(setup, crowd, member))).unzip();
    let mut ensemble = Ensemble::<S, Cayley>::new(&systems, states, crowd.step)?;
    let mut distributions: Vec<_> =
        shown.iter().map(|&shown| Distribution::of(quantity::<S>(shown))).collect();
    let mut looking = 0.0;
    let mut watcher = |moment: &Moment<'_, S>| {
        let start = std::time::Instant::now();
        for distribution in &mut distributions {
            distribution.watch(moment)?;
        }
        looking += start.elapsed().as_secs_f64();
        ControlFlow::Continue(())
    };
    let start = std::time::Instant::now();
    let mut member_steps = 0;
    if S::Control::QUANTITIES.is_empty() {
        let mut both = (|moment: &Moment<'_, S>| watch(moment.index), watcher);
        member_steps += ensemble.run_watched(crowd.steps, crowd.every, &mut both).member_steps;
    } else {
        let mut nobody = |_: &Moment<'_, S>| ControlFlow::Continue(());
        for index in 0..crowd.steps {
            let time = ensemble.time();
            ensemble.control(|member, state| systems[member].control(state, time));
            let report = if index.is_multiple_of(crowd.every) {
                if watch(index).is_break() {
                    break;
                }
                // shown before the step, and the last time after it
                let mut first = |moment: &Moment<'_, S>| match moment.index {
                    0 => watcher(moment),
                    _ => ControlFlow::Continue(()),
                };
                ensemble.run_watched(1, 1, &mut first)
            } else {
                ensemble.run_watched(1, 1, &mut nobody)
            };
            member_steps += report.member_steps;
        }
        ensemble.run_watched(0, 1, &mut watcher);
    }
    let seconds = start.elapsed().as_secs_f64() - looking;
    Ok(Course {
        spreads: distributions.iter().map(|distribution| distribution.moments().to_vec()).collect(),
        failed: ensemble.failed().to_vec(),
        member_steps,
        width: ensemble.width(),
        seconds,
    })
}

fn quantity<S: Catalogued>(shown: Shown) -> impl FnMut(&S, &S::State) -> f64 {
    move |system, state| match shown {
        Shown::Energy => system.energy(state),
        Shown::State(place) => state.to_components().as_ref().get(place).copied().unwrap_or(f64::NAN),
    }
}

/// The setup of one member: the same numbers for the same seed and member, however many there are.
fn drawn(setup: &Setup, crowd: &Crowd, member: usize) -> Setup {
    let mut random = ChaCha8Rng::seed_from_u64(crowd.seed);
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
        parameters: draw(&setup.parameters, &crowd.widths.parameters),
        state: draw(&setup.state, &crowd.widths.state),
    }
}
