//! Ensembles of any system of the catalogue, with parameters and states as flat lists of numbers.

use std::ops::ControlFlow;

use coadjoint::Run;
use coadjoint::StepError;
use coadjoint::ensemble::Spread;
use coadjoint::erased::{self, Ensemble};
use rayon::prelude::*;

use super::{scheme, stepper};
use crate::catalogue::{ControlLaw, Entry, Observable, Setup};
use crate::error::{RunError, SetupError};
use crate::setup::Job;
pub use crate::setup::{SampledRange, Variation};
use crate::units::grouped;

/// The specification of an ensemble of one system.
#[derive(Clone, Debug, PartialEq)]
pub struct EnsembleSpec {
    /// The number of members.
    pub members: usize,
    /// Their differences from the setup; controls do not vary.
    pub variation: Variation,
    /// The seed of the random members.
    pub seed: u64,
    /// The scheme, the step and how many of them.
    pub job: Job,
    /// Steps between two samples of the distribution; 0 counts as 1.
    pub every: u64,
}

/// Called now and then with the number of steps taken; may end the run.
pub type ProgressFn<'a> = dyn FnMut(u64) -> ControlFlow<()> + 'a;

/// A member that failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("member {member} could not take step {step}: {cause}")]
pub struct Failure {
    /// Which, from 0.
    pub member: usize,
    /// The step that it could not take, counted from 1.
    pub step: u64,
    /// The cause.
    pub cause: StepError,
}

/// The result of an ensemble run.
#[derive(Clone, Debug, PartialEq)]
pub struct EnsembleSummary {
    /// For each quantity its distribution at each sample.
    pub spreads: Vec<Vec<Spread>>,
    /// The ranges of what was drawn.
    pub drawn: Vec<SampledRange>,
    /// The members that failed.
    pub failed: Vec<Failure>,
    /// Steps of all members together.
    pub member_steps: u64,
    /// The number of members that are stepped side by side.
    pub width: usize,
    /// The time that the steps took, with the choice of controls, s.
    pub seconds: f64,
}

impl EnsembleSpec {
    /// Checks that there is memory for the members, and for what is seen of them.
    ///
    /// # Errors
    /// If not so much can be had.
    pub fn check_room(&self) -> Result<(), SetupError> {
        /// Of each look some kilobytes are kept until its row is written.
        const LOOKS: u64 = 100_000;

        let looks = self.job.steps / self.every.max(1);
        if looks > LOOKS {
            let (looks, most) = (grouped(looks), grouped(LOOKS));
            let every = self.job.steps.div_ceil(LOOKS);
            let reason =
                format!("the members are looked at {looks} times: at most {most}, as with `--every {every}`");
            return Err(SetupError::new(reason));
        }
        Vec::<(Setup, Setup)>::new().try_reserve_exact(self.members).map_err(|_| {
            SetupError::new(format!("there is no memory for {} members", grouped(self.members as u64)))
        })
    }
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
) -> Result<EnsembleSummary, RunError> {
    spec.check_room()?;
    let mut ranges = spec.variation.ranges(entry, setup);
    let mut laws: Vec<ControlLaw> = Vec::new();
    let members = (0..spec.members).map(|member| {
        let own = ranges.member(spec.seed, member);
        laws.extend(entry.law(&own));
        (own.parameters, own.state)
    });
    let system = entry.system(&setup.parameters);
    let mut moving = if spec.job.is_side_by_side() {
        let Job { method, retraction, order, step, .. } = spec.job;
        EnsembleBackend::SideBySide(Ensemble::new(
            &*system,
            &scheme(method, retraction, order)?,
            members,
            step,
        )?)
    } else {
        let member = |(index, (parameters, state)): (usize, (Vec<f64>, Vec<f64>))| {
            let stepper = stepper(entry, entry.system(&parameters), setup.input.clone(), &spec.job)
                .map_err(|source| RunError::Member { member: index, source: Box::new(source) })?;
            Ok(Member { index, stepper, state, failure: None })
        };
        EnsembleBackend::OneByOne(members.enumerate().map(member).collect::<Result<_, RunError>>()?)
    };
    let mut spreads = vec![Vec::new(); observables.len()];
    let every = spec.every.max(1);
    let Job { step, steps, .. } = spec.job;
    let (mut taken, mut member_steps, mut seconds) = (0, 0, 0.0);
    // between two looks it is asked whether to go on, after about a million steps of all members
    let at_once = ((1 << 20) / spec.members.max(1) as u64).max(1);
    loop {
        if taken == steps || taken.is_multiple_of(every) {
            for (spreads, observable) in spreads.iter_mut().zip(observables) {
                spreads.push(moving.spread(observable, taken as f64 * step, (entry, &laws)));
            }
        }
        if progress(taken).is_break() || taken == steps {
            break;
        }
        // up to the next look
        let count = (every - taken % every).min(steps - taken).min(at_once);
        let start = std::time::Instant::now();
        member_steps += moving.advance(count, (&laws, setup.input.is_some()), entry);
        seconds += start.elapsed().as_secs_f64();
        taken += count;
    }
    let (failed, width) = moving.end();
    Ok(EnsembleSummary { spreads, drawn: ranges.finish(), failed, member_steps, width, seconds })
}

/// Members on their way.
enum EnsembleBackend {
    /// In registers.
    SideBySide(Ensemble),
    /// Each with a stepper of its own, on all processors.
    OneByOne(Vec<Member>),
}

/// The law of each member, none of systems without controls, and whether they are functions of time alone.
type Laws<'a> = (&'a [ControlLaw], bool);

struct Member {
    index: usize,
    stepper: erased::Stepper,
    state: Vec<f64>,
    failure: Option<Failure>,
}

impl Member {
    /// Takes steps, unless it failed before; returns their number.
    fn advance(&mut self, steps: u64, (laws, is_driven): Laws<'_>, entry: &Entry) -> u64 {
        if self.failure.is_some() {
            return 0;
        }
        let run = Run::new(&mut self.stepper, &mut self.state);
        let ran = match laws.get(self.index) {
            Some(law) if is_driven => run.driven_by(|time| entry.chosen(law, (&[], time))).steps(steps),
            Some(law) => run.controlled_by(|state, time| entry.chosen(law, (state, time))).steps(steps),
            None => run.steps(steps),
        };
        match ran {
            Ok(report) => report.steps,
            Err(error) => {
                self.failure = Some(Failure { member: self.index, step: error.step, cause: error.cause });
                error.report.steps
            }
        }
    }
}

impl EnsembleBackend {
    /// Steps all members that have not failed; returns the number of all their steps.
    fn advance(&mut self, steps: u64, (laws, is_driven): Laws<'_>, entry: &Entry) -> u64 {
        match self {
            Self::SideBySide(ensemble) if laws.is_empty() => ensemble.run(steps),
            Self::SideBySide(ensemble) if is_driven => {
                ensemble.run_driven(steps, &|member, time, control| laws[member](&[], time, control))
            }
            Self::SideBySide(ensemble) => ensemble
                .run_controlled(steps, &|member, state, time, control| laws[member](state, time, control)),
            Self::OneByOne(members) => {
                members.par_iter_mut().map(|member| member.advance(steps, (laws, is_driven), entry)).sum()
            }
        }
    }

    /// Measures how a quantity is distributed over the members now.
    fn spread(&self, observable: &Observable, time: f64, (entry, laws): (&Entry, &[ControlLaw])) -> Spread {
        let value = |index: usize, system: &dyn erased::System, state: &[f64]| {
            let chosen = laws.get(index).map(|law| entry.chosen(law, (state, time)));
            observable.value(system, state, time, &chosen.unwrap_or_default())
        };
        let mut values: Vec<f64> = match self {
            Self::SideBySide(ensemble) => {
                ensemble.members().map(|(index, system, state)| value(index, system, &state)).collect()
            }
            Self::OneByOne(members) => {
                let alive = members.iter().filter(|member| member.failure.is_none());
                alive.map(|member| value(member.index, &**member.stepper.system(), &member.state)).collect()
            }
        };
        values.retain(|value| !value.is_nan());
        Spread::of(time, &mut values)
    }

    /// Lists the members that failed, and counts those that are stepped side by side.
    fn end(self) -> (Vec<Failure>, usize) {
        match self {
            Self::SideBySide(ensemble) => {
                let failed = ensemble.failed().iter();
                let failed = failed.map(|f| Failure { member: f.member, step: f.step, cause: f.source });
                (failed.collect(), ensemble.width())
            }
            Self::OneByOne(members) => (members.iter().filter_map(|member| member.failure).collect(), 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::{Method, Order, Retraction};
    use crate::tests::catalogue;

    #[test]
    fn ensembles_that_memory_cannot_hold_are_refused() {
        let top = catalogue().find("heavy_top").expect("it is there");
        let refused = |members: usize, order: Order| {
            let variation = Variation::parse(top, &top.example, &[]).expect("nothing varies");
            let (method, retraction) = (Method::Standard, Retraction::Cayley);
            let job = Job { method, retraction, order, step: 0.01, steps: 100, rest: 0.0 };
            let spec = EnsembleSpec { members, variation, seed: 1, job, every: 100 };
            let ran = run(top, &top.example, &spec, &[], &mut |_| ControlFlow::Continue(()));
            ran.map(|summary| summary.member_steps).map_err(|error| error.to_string())
        };
        assert_eq!(refused(10, Order::Two), Ok(1000));
        let (method, retraction, order) = (Method::Standard, Retraction::Cayley, Order::Two);
        let job = Job { method, retraction, order, step: 0.01, steps: 1_000_000, rest: 0.0 };
        let variation = Variation::parse(top, &top.example, &[]).expect("nothing varies");
        let spec = |every| EnsembleSpec { members: 2, variation: variation.clone(), seed: 1, job, every };
        let message = spec(9).check_room().expect_err("too many looks").to_string();
        assert!(message.contains("111,111 times: at most 100,000, as with `--every 10`"), "{message}");
        assert_eq!(spec(10).check_room(), Ok(()));
        for members in [100_000_000_000_000, usize::MAX] {
            for order in [Order::Two, Order::Ten] {
                let message = refused(members, order).expect_err("more than any computer has");
                assert!(message.contains("there is no memory for"), "{message}");
            }
        }
    }
}
