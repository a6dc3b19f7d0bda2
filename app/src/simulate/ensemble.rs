//! Ensembles of any system of the catalogue, with parameters and states as flat lists of numbers.
//!
//! Members are run in [blocks](EnsembleSpec::block) of their numbers, one after the other. Of each, [`Tally`] keeps
//! what is known of its members: tallies are merged in any order to the same bytes, whoever ran the blocks.

mod ranks;
mod tally;

use std::ops::{ControlFlow, Range};

use coadjoint::Run;
use coadjoint::ensemble::{EnsembleError, Spread, Statistics};
use coadjoint::erased::{self, Ensemble};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

pub use self::ranks::{Alone, Ranks, Tag};
pub(crate) use self::ranks::{Handed, merged, shared};
pub(crate) use self::tally::Bytes;
pub use self::tally::Tally;
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
    /// How many members are run at once; 0 counts as 1. What comes out does not depend on it.
    pub block: usize,
}

/// Called now and then with the number of steps taken, those of blocks one after the other; may end the run.
pub type ProgressFn<'a> = dyn FnMut(u64) -> ControlFlow<()> + 'a;

/// A member that failed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[error("member {member} could not take step {step}: {cause}")]
pub struct Failure {
    /// Which, from 0.
    pub member: u64,
    /// The step that it could not take, counted from 1.
    pub step: u64,
    /// The cause.
    pub cause: String,
}

/// The result of an ensemble run.
#[derive(Clone, Debug, PartialEq)]
pub struct EnsembleSummary {
    /// For each quantity its distribution at each sample.
    pub spreads: Vec<Vec<Spread>>,
    /// The ranges of what was drawn.
    pub drawn: Vec<SampledRange>,
    /// How far quantiles may be off at worst, relative to the values next to them; 0 where they are exact.
    pub quantile_error: f64,
    /// How many members failed.
    pub failures: u64,
    /// The first of them.
    pub failed: Vec<Failure>,
    /// How many members were run.
    pub members: u64,
    /// Steps of all members together.
    pub member_steps: u64,
    /// The number of members that are stepped side by side.
    pub width: usize,
    /// The time that the steps took, with the choice of controls, s.
    pub seconds: f64,
}

/// How a block of members ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BlockEnd {
    /// The ranges of what was drawn.
    pub(crate) drawn: Vec<SampledRange>,
    /// What was drawn of each member, as many numbers as there are ranges.
    pub(crate) drawn_values: Vec<f64>,
    /// The members that failed.
    pub(crate) failed: Vec<Failure>,
    pub(crate) member_steps: u64,
    pub(crate) width: usize,
    pub(crate) seconds: f64,
    /// Whether all steps were taken.
    pub(crate) is_whole: bool,
}

/// A block of members that took all steps, with their values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    /// Which members.
    pub(crate) range: Range<usize>,
    /// For each look and each quantity the members' values: not-a-number of one that failed.
    pub(crate) values: Vec<Vec<f64>>,
    pub(crate) end: BlockEnd,
}

impl EnsembleSpec {
    /// How many members are run at once unless another number is asked for.
    pub const BLOCK: usize = 2048;

    /// Counts the blocks.
    pub fn blocks(&self) -> u64 {
        self.members.div_ceil(self.block.max(1)) as u64
    }

    /// Lists the members of a block.
    pub(crate) fn range(&self, block: u64) -> Range<usize> {
        let start = usize::try_from(block).unwrap_or(usize::MAX).saturating_mul(self.block.max(1));
        start.min(self.members)..start.saturating_add(self.block.max(1)).min(self.members)
    }

    /// Lists the steps after which members are looked at.
    pub(crate) fn looks(&self) -> impl Iterator<Item = u64> + '_ {
        let (every, steps) = (self.every.max(1), self.job.steps);
        let rest = (!steps.is_multiple_of(every)).then_some(steps);
        (0..=steps / every).map(move |look| look * every).chain(rest)
    }

    /// Checks that there is memory for the members of a block, and for what is seen of all.
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
        let members = self.members.min(self.block.max(1));
        Vec::<(Setup, Setup)>::new().try_reserve_exact(members).map_err(|_| {
            SetupError::new(format!("there is no memory for {} members at once", grouped(members as u64)))
        })
    }

    /// Checks that there is memory for the statistics of so many quantities at all looks, and for the values of a
    /// block.
    ///
    /// # Errors
    /// If there is not.
    pub(crate) fn check_statistics(&self, quantities: usize) -> Result<(), SetupError> {
        /// Bytes.
        const MOST: u64 = 1 << 32;
        /// Two sums, and the most that the buckets of a sketch take.
        const EACH: u64 = 2400 + 16 * 4096;

        let each = EACH + 8 * self.members.min(self.block.max(1)) as u64;
        let looks = MOST / (each * quantities.max(1) as u64);
        let asked = self.job.steps / self.every.max(1);
        if asked <= looks {
            return Ok(());
        }
        let every = self.job.steps.div_ceil(looks.max(1));
        Err(SetupError::new(format!(
            "what is known of {} quantities at {} looks, of more members than one block, would take more than {} GB: \
             look less often, as with `--every {every}`, or at fewer quantities",
            quantities,
            grouped(asked),
            MOST >> 30
        )))
    }
}

/// Runs an ensemble with the controls of the setup. The callback may end the run: where there is one block, after some
/// steps, else after some blocks.
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
    if spec.blocks() > 1 {
        spec.check_statistics(observables.len())?;
        let mut tally = Tally::new(spec, entry, setup, observables.len());
        let (mut width, mut seconds) = (0, 0.0);
        for index in 0..spec.blocks() {
            let mut progress = |taken: u64| progress((index * spec.job.steps).saturating_add(taken));
            let Some(block) = block(entry, setup, spec, index, observables, &mut progress)? else { break };
            tally.add(&block);
            (width, seconds) = (block.end.width, seconds + block.end.seconds);
        }
        return Ok(tally.summary(spec, entry, setup, (width, seconds)));
    }
    // all at once: nothing has to be kept of a look but its distribution
    let mut spreads = vec![Vec::new(); observables.len()];
    let mut quantile_error: f64 = 0.0;
    let mut look = |time: f64, values: Vec<Vec<f64>>| {
        let found: Vec<Statistics> = values.into_par_iter().map(Statistics::of).collect();
        for (spreads, statistics) in spreads.iter_mut().zip(found) {
            spreads.push(statistics.spread(time));
            quantile_error = quantile_error.max(statistics.relative_error());
        }
    };
    let end = run_members(entry, setup, spec, 0..spec.members, observables, &mut look, progress)?;
    let BlockEnd { drawn, mut failed, member_steps, width, seconds, .. } = end;
    let (failures, members) = (failed.len() as u64, spec.members as u64);
    failed.truncate(Tally::FIRST);
    Ok(EnsembleSummary {
        spreads,
        drawn,
        quantile_error,
        failures,
        failed,
        members,
        member_steps,
        width,
        seconds,
    })
}

/// Runs a block of members, and keeps their values; none if the callback ended it.
///
/// # Errors
/// As of [`run`].
pub(crate) fn block(
    entry: &Entry,
    setup: &Setup,
    spec: &EnsembleSpec,
    index: u64,
    observables: &[Observable],
    progress: &mut ProgressFn<'_>,
) -> Result<Option<Block>, RunError> {
    let (range, mut all) = (spec.range(index), Vec::new());
    let mut look = |_: f64, mut values: Vec<Vec<f64>>| all.append(&mut values);
    let end = run_members(entry, setup, spec, range.clone(), observables, &mut look, progress)?;
    Ok(end.is_whole.then_some(Block { range, values: all, end }))
}

/// Is shown the members at a time: for each quantity their values, not-a-number of one that failed.
type LookFn<'a> = dyn FnMut(f64, Vec<Vec<f64>>) + 'a;

/// Runs some members, and shows them after every so many steps.
fn run_members(
    entry: &Entry,
    setup: &Setup,
    spec: &EnsembleSpec,
    range: Range<usize>,
    observables: &[Observable],
    look: &mut LookFn<'_>,
    progress: &mut ProgressFn<'_>,
) -> Result<BlockEnd, RunError> {
    let mut ranges = spec.variation.ranges(entry, setup);
    let mut laws: Vec<ControlLaw> = Vec::new();
    let mut drawn_values = Vec::new();
    let first = range.start;
    let count = range.len() as u64;
    let members = range.map(|member| {
        let own = ranges.member(spec.seed, member, &mut drawn_values);
        laws.extend(entry.law(&own));
        (own.parameters, own.state)
    });
    let system = entry.system(&setup.parameters);
    let mut moving = if spec.job.is_side_by_side() {
        let Job { method, retraction, order, step, .. } = spec.job;
        let ensemble = Ensemble::new(&*system, &scheme(method, retraction, order)?, members, step);
        EnsembleBackend::SideBySide(ensemble.map_err(|error| counted_from(first, error))?)
    } else {
        let member = |(index, (parameters, state)): (usize, (Vec<f64>, Vec<f64>))| {
            let stepper = stepper(entry, entry.system(&parameters), setup.input.clone(), &spec.job)
                .map_err(|source| RunError::Member { member: first + index, source: Box::new(source) })?;
            Ok(Member { index, stepper, state, failure: None })
        };
        EnsembleBackend::OneByOne(members.enumerate().map(member).collect::<Result<_, RunError>>()?)
    };
    let every = spec.every.max(1);
    let Job { step, steps, .. } = spec.job;
    let (mut taken, mut member_steps, mut seconds) = (0, 0, 0.0);
    // between two looks it is asked whether to go on, after about a million steps of all members
    let at_once = ((1 << 20) / count.max(1)).max(1);
    loop {
        if taken == steps || taken.is_multiple_of(every) {
            look(taken as f64 * step, moving.values(observables, taken as f64 * step, (entry, &laws)));
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
    let (failed, width) = moving.end(first as u64);
    let is_whole = taken == steps;
    Ok(BlockEnd { drawn: ranges.finish(), drawn_values, failed, member_steps, width, seconds, is_whole })
}

/// Counts the member of an error from the first one of all.
fn counted_from(first: usize, mut error: EnsembleError) -> EnsembleError {
    if let EnsembleError::Parameters { member, .. } | EnsembleError::State { member, .. } = &mut error {
        *member += first;
    }
    error
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

/// A member that has not failed: its number in the block, its system, its state.
type AliveMember<'a> = (usize, &'a dyn erased::System, Vec<f64>);

struct Member {
    index: usize,
    stepper: erased::Stepper,
    state: Vec<f64>,
    /// The step that it could not take, and why.
    failure: Option<(u64, String)>,
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
                self.failure = Some((error.step, error.cause.to_string()));
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

    /// Evaluates quantities of all members now: for each the members' values, not-a-number of one that failed.
    fn values(
        &self,
        observables: &[Observable],
        time: f64,
        (entry, laws): (&Entry, &[ControlLaw]),
    ) -> Vec<Vec<f64>> {
        let (count, alive): (usize, Vec<AliveMember<'_>>) = match self {
            Self::SideBySide(ensemble) => (ensemble.len(), ensemble.members().collect()),
            Self::OneByOne(members) => {
                let alive = members.iter().filter(|member| member.failure.is_none());
                let alive = alive
                    .map(|member| (member.index, &**member.stepper.system(), member.state.clone()))
                    .collect();
                (members.len(), alive)
            }
        };
        let chosen: Vec<Vec<f64>> = match laws.is_empty() {
            true => Vec::new(),
            false => {
                let chosen =
                    alive.par_iter().map(|(index, _, state)| entry.chosen(&laws[*index], (state, time)));
                chosen.collect()
            }
        };
        let of = |observable: &Observable| {
            let mut values = vec![f64::NAN; count];
            let each = alive.par_iter().enumerate().with_min_len(64).map(|(k, (_, system, state))| {
                observable.value(*system, state, time, chosen.get(k).map_or(&[][..], |chosen| chosen))
            });
            let found: Vec<f64> = each.collect();
            alive.iter().zip(found).for_each(|((index, ..), value)| values[*index] = value);
            values
        };
        observables.iter().map(of).collect()
    }

    /// Lists the members that failed, whose numbers begin here, and counts those that are stepped side by side.
    fn end(self, first: u64) -> (Vec<Failure>, usize) {
        match self {
            Self::SideBySide(ensemble) => {
                let failed = ensemble.failed().iter().map(|f| Failure {
                    member: first + f.member as u64,
                    step: f.step,
                    cause: f.source.to_string(),
                });
                (failed.collect(), ensemble.width())
            }
            Self::OneByOne(members) => {
                let failed = members.into_iter().filter_map(|Member { index, failure, .. }| {
                    failure.map(|(step, cause)| Failure { member: first + index as u64, step, cause })
                });
                (failed.collect(), 1)
            }
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
            let spec = EnsembleSpec { members, variation, seed: 1, job, every: 100, block: members };
            let ran = run(top, &top.example, &spec, &[], &mut |_| ControlFlow::Continue(()));
            ran.map(|summary| summary.member_steps).map_err(|error| error.to_string())
        };
        assert_eq!(refused(10, Order::Two), Ok(1000));
        let (method, retraction, order) = (Method::Standard, Retraction::Cayley, Order::Two);
        let job = Job { method, retraction, order, step: 0.01, steps: 1_000_000, rest: 0.0 };
        let variation = Variation::parse(top, &top.example, &[]).expect("nothing varies");
        let spec =
            |every| EnsembleSpec { members: 2, variation: variation.clone(), seed: 1, job, every, block: 2 };
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
