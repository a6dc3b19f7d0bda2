//! Ensembles of any system of the catalogue, with parameters and states as flat lists of numbers.

use std::ops::ControlFlow;

use coadjoint::Run;
use coadjoint::StepError;
use coadjoint::ensemble::Spread;
use coadjoint::erased::{self, Ensemble};
use rayon::prelude::*;

use crate::entry::{ControlLaw, Entry};
use crate::error::Error;
use crate::report::{bytes_in_words, grouped};
pub use crate::setting::{Drawn, Variation};
use crate::simulation::{Job, Method, Order, Retraction, Setup, SimulationError};

/// The specification of an ensemble of one system.
#[derive(Clone, Debug, PartialEq)]
pub struct EnsembleSpec {
    /// How many members.
    pub members: usize,
    /// How they differ from the setup; controls do not vary.
    pub variation: Variation,
    /// The seed of the random members.
    pub seed: u64,
    /// The scheme, the step and how many of them.
    pub job: Job,
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

/// A member that failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("member {member} could not take step {step}: {cause}")]
pub struct Failure {
    /// Which, from 0.
    pub member: usize,
    /// The step that it could not take, counted from 1.
    pub step: u64,
    /// What went wrong.
    pub cause: StepError,
}

/// The result of an ensemble run.
#[derive(Clone, Debug, PartialEq)]
pub struct EnsembleSummary {
    /// For each quantity its distribution at each sample.
    pub spreads: Vec<Vec<Spread>>,
    /// The ranges of what was drawn.
    pub drawn: Vec<Drawn>,
    /// The members that failed.
    pub failed: Vec<Failure>,
    /// Steps of all members together.
    pub member_steps: u64,
    /// How many members are stepped side by side.
    pub width: usize,
    /// The time that the steps took, with the choice of controls, s.
    pub seconds: f64,
}

impl EnsembleSpec {
    /// Whether members are stepped side by side in the processor's registers: with the standard step of order 2 on the Cayley map.
    pub fn is_side_by_side(&self) -> bool {
        let Job { method, retraction, order, .. } = self.job;
        (method, retraction, order) == (Method::Standard, Retraction::Cayley, Order::Two)
    }

    /// Whether there is memory for all members.
    ///
    /// # Errors
    /// If not; the message says how much it would take.
    pub fn check_memory(&self, entry: &Entry, observables: usize) -> Result<(), Error> {
        let members = self.bytes_of_member(entry) * self.members as f64;
        let looks = self.job.steps as f64 / self.every.max(1) as f64 + 1.0;
        let needed = members + looks * (observables * size_of::<Spread>()) as f64;
        let available = available_memory();
        if needed <= 0.9 * available {
            return Ok(());
        }
        Err(Error::Input(format!(
            "{} members and {} looks at them take about {} of memory; there are {}",
            grouped(self.members as u64),
            grouped(looks as u64),
            bytes_in_words(needed),
            bytes_in_words(available)
        )))
    }
}

impl EnsembleSpec {
    /// About what a member takes, as it was measured: a few copies of its parameters, the states of some earlier steps, and what holds them
    /// together.
    fn bytes_of_member(&self, entry: &Entry) -> f64 {
        let Setup { parameters, state, controls } = &entry.example;
        let numbers = 8.0 * (4 * parameters.len() + 12 * state.len()) as f64;
        if self.is_side_by_side() {
            return 600.0 + numbers + if controls.is_empty() { 0.0 } else { 400.0 };
        }
        let composed = match self.job.order {
            Order::Two => 1.0,
            Order::Four => 5.0,
            Order::Six => 9.0,
            Order::Eight => 17.0,
            Order::Ten => 35.0,
        };
        let is_verlet =
            self.job.method == Method::Standard && entry.standard(self.job.retraction) == Method::Verlet;
        let halves = if is_verlet || self.job.method == Method::Verlet { 2.0 } else { 1.0 };
        500.0 + composed * halves * (1200.0 + 0.5 * numbers)
    }
}

/// The memory that can be had, in bytes; where the system does not tell, as much as a small computer has.
fn available_memory() -> f64 {
    let told = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let available = told.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let kilobytes = available.and_then(|rest| rest.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map_or(8e9, |kilobytes| 1024.0 * kilobytes)
}

/// Runs an ensemble with the controls of the setup. The callback may end the run.
///
/// # Errors
/// If the parameters or the state of a member are not valid, or the step, or there is no such scheme.
pub fn run(
    entry: &Entry,
    setup: &Setup,
    spec: &EnsembleSpec,
    observables: &[Observable],
    progress: &mut ProgressFn<'_>,
) -> Result<EnsembleSummary, SimulationError> {
    let mut ranges = spec.variation.ranges(entry, setup);
    let mut laws: Vec<ControlLaw> = Vec::new();
    let members = (0..spec.members).map(|member| {
        let own = ranges.member(spec.seed, member);
        laws.extend(entry.law(&own));
        (own.parameters, own.state)
    });
    let system = entry.system(&setup.parameters);
    let mut moving = if spec.is_side_by_side() {
        Moving::SideBySide(Ensemble::new(&*system, members, spec.job.step)?)
    } else {
        Moving::OneByOne(one_by_one(entry, &spec.job, members)?)
    };
    let mut spreads = vec![Vec::new(); observables.len()];
    let every = spec.every.max(1);
    let Job { step, steps, .. } = spec.job;
    let (mut taken, mut member_steps, mut seconds) = (0, 0, 0.0);
    loop {
        if taken == steps || taken.is_multiple_of(every) {
            for (spreads, &observable) in spreads.iter_mut().zip(observables) {
                spreads.push(moving.spread(observable, taken as f64 * step, (entry, &laws)));
            }
            if progress(taken).is_break() {
                break;
            }
        }
        if taken == steps {
            break;
        }
        // up to the next sample
        let count = (every - taken % every).min(steps - taken);
        let start = std::time::Instant::now();
        member_steps += moving.advance(count, &laws, entry);
        seconds += start.elapsed().as_secs_f64();
        taken += count;
    }
    let (failed, width) = (moving.failed(), moving.width());
    drop(moving);
    Ok(EnsembleSummary { spreads, drawn: ranges.finish(), failed, member_steps, width, seconds })
}

/// Members on their way.
enum Moving {
    /// In registers.
    SideBySide(Ensemble),
    /// Each with a stepper of its own, on all processors.
    OneByOne(Vec<Member>),
}

struct Member {
    stepper: erased::Stepper,
    state: Vec<f64>,
    failure: Option<(u64, StepError)>,
}

fn one_by_one(
    entry: &Entry,
    job: &Job,
    members: impl IntoIterator<Item = (Vec<f64>, Vec<f64>)>,
) -> Result<Vec<Member>, SimulationError> {
    let member = |(member, (parameters, state)): (usize, (Vec<f64>, Vec<f64>))| {
        let stepper = entry
            .stepper(entry.system(&parameters), job)
            .map_err(|source| SimulationError::Member { member, source: Box::new(source) })?;
        Ok(Member { stepper, state, failure: None })
    };
    members.into_iter().enumerate().map(member).collect()
}

impl Member {
    /// Takes so many steps, unless it failed before; returns how many were taken.
    fn advance(&mut self, steps: u64, law: Option<&ControlLaw>, entry: &Entry) -> u64 {
        if self.failure.is_some() {
            return 0;
        }
        let run = Run::new(&mut self.stepper, &mut self.state);
        let ran = match law {
            Some(law) => run.controlled_by(|state, time| entry.chosen(law, (state, time))).steps(steps),
            None => run.steps(steps),
        };
        match ran {
            Ok(report) => report.steps,
            Err(error) => {
                self.failure = Some((error.step, error.cause));
                error.report.steps
            }
        }
    }
}

impl Moving {
    /// All members that have not failed take so many steps; returns how many they are together.
    fn advance(&mut self, steps: u64, laws: &[ControlLaw], entry: &Entry) -> u64 {
        match self {
            Self::SideBySide(ensemble) if laws.is_empty() => ensemble.run(steps),
            Self::SideBySide(ensemble) => ensemble
                .run_controlled(steps, &|member, state, time, control| laws[member](state, time, control)),
            Self::OneByOne(members) => {
                let advance =
                    |(index, member): (usize, &mut Member)| member.advance(steps, laws.get(index), entry);
                members.par_iter_mut().enumerate().map(advance).sum()
            }
        }
    }

    /// How a quantity is distributed over the members now.
    fn spread(&self, observable: Observable, time: f64, (entry, laws): (&Entry, &[ControlLaw])) -> Spread {
        let value = |index: usize, system: &dyn erased::System, state: &[f64]| match observable {
            Observable::Energy => entry.energy(system, laws.get(index), (state, time)),
            Observable::State(place) => state.get(place).copied().unwrap_or(f64::NAN),
        };
        let mut values: Vec<f64> = match self {
            Self::SideBySide(ensemble) => {
                ensemble.members().map(|(index, system, state)| value(index, system, &state)).collect()
            }
            Self::OneByOne(members) => {
                let alive = members.iter().enumerate().filter(|(_, member)| member.failure.is_none());
                alive.map(|(index, member)| value(index, &**member.stepper.system(), &member.state)).collect()
            }
        };
        values.retain(|value| !value.is_nan());
        Spread::of(time, &mut values)
    }

    fn failed(&self) -> Vec<Failure> {
        match self {
            Self::SideBySide(ensemble) => {
                let failure = |failed: &coadjoint::ensemble::Failed| Failure {
                    member: failed.member,
                    step: failed.step,
                    cause: failed.source,
                };
                ensemble.failed().iter().map(failure).collect()
            }
            Self::OneByOne(members) => {
                let failure = |(index, member): (usize, &Member)| {
                    member.failure.map(|(step, cause)| Failure { member: index, step, cause })
                };
                members.iter().enumerate().filter_map(failure).collect()
            }
        }
    }

    fn width(&self) -> usize {
        match self {
            Self::SideBySide(ensemble) => ensemble.width(),
            Self::OneByOne(_) => 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::catalogue;

    fn spec(members: usize, order: Order) -> EnsembleSpec {
        let top = catalogue().find("heavy_top").expect("it is there");
        let variation = Variation::parse(top, &top.example, &[]).expect("nothing varies");
        let (method, retraction) = (Method::Standard, Retraction::Cayley);
        let job = Job { method, retraction, order, step: 0.01, steps: 100 };
        EnsembleSpec { members, variation, seed: 1, job, every: 1 }
    }

    #[test]
    fn ensembles_that_memory_cannot_hold_are_refused() {
        let top = catalogue().find("heavy_top").expect("it is there");
        let refused =
            |members, order| spec(members, order).check_memory(top, 3).map_err(|error| error.to_string());
        assert_eq!(refused(1000, Order::Two), Ok(()));
        for members in [100_000_000_000, usize::MAX] {
            let message = refused(members, Order::Two).expect_err("more than any computer has");
            assert!(message.contains("of memory; there are"), "{message}");
        }
        // looks take memory too
        let looking =
            EnsembleSpec { job: Job { steps: u64::MAX, ..spec(1, Order::Two).job }, ..spec(1, Order::Two) };
        assert!(looking.check_memory(top, 3).is_err());
        assert!(refused(1, Order::Ten).is_ok());
    }
}
