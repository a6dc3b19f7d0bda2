//! Steps that turn farther than their retraction reaches, or than it follows well.

use std::f64::consts::PI;

use coadjoint::StepError;
use coadjoint::erased;

use crate::catalogue::quantities::rotation;
use crate::catalogue::{Entry, Setup};
use crate::error::RunError;
use crate::setup::{Job, Order, Retraction};

/// Why a step could not be taken, where the reason is that it turns too far.
pub(super) fn explained(
    source: coadjoint::RunError,
    system: &dyn erased::System,
    state: &[f64],
    job: &Job,
) -> RunError {
    let is_equation = matches!(source.cause, StepError::NoConvergence { .. } | StepError::OutsideDomain);
    if !is_equation || job.retraction != Retraction::Exponential || !job.method.has_retraction() {
        return source.into();
    }
    let quantities = system.description().state;
    let rates = system.motion(state, source.time, &[]);
    let turns = quantities.iter().filter_map(|quantity| {
        // of the plane there is no such limit
        let (4, _) = rotation(quantity)? else { return None };
        let rates = &rates[quantity.tangent()][..3];
        Some(rates.iter().map(|rate| rate * rate).sum::<f64>().sqrt())
    });
    let rate = turns.fold(0.0, f64::max);
    let turn = rate * job.step.abs();
    // what is found by the velocity now is no more than the order of it
    if turn.is_finite() && turn > PI {
        RunError::TooFar { source, turn, step: PI / rate }
    } else {
        source.into()
    }
}

/// Says by how much a turn in the plane is slowed by the Cayley map, if by more than a hundredth: `η` in a step counts
/// as `η/(1 + η²/4)` of what its momentum is. It is looked at where a run starts and ends.
pub(crate) fn slowed(entry: &Entry, setup: &Setup, job: &Job, (time, end): (f64, &[f64])) -> Option<String> {
    /// The turn whose hundredth is lost.
    const LOST: f64 = 0.2;
    let is_cayley = job.retraction == Retraction::Cayley && job.method.has_retraction();
    if !is_cayley || job.order != Order::Two {
        return None;
    }
    let (system, law) = (entry.system(&setup.parameters), entry.law(setup));
    let rates = [(0.0, &setup.state[..]), (time, end)].map(|(time, state)| {
        let control = law.as_ref().map(|law| entry.chosen(law, (state, time))).unwrap_or_default();
        system.motion(state, time, &control)
    });
    let planar = entry.description.state.iter().filter(|quantity| matches!(rotation(quantity), Some((2, _))));
    let turns = planar.map(|quantity| {
        let rate = rates.iter().map(|rates| rates[quantity.tangent().start].abs()).fold(0.0, f64::max);
        (quantity.name, rate)
    });
    let (name, rate) = turns.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let turn = rate * job.step.abs();
    (turn > LOST).then(|| {
        let (percent, step) = (100.0 / (1.0 + 0.25 * turn * turn), LOST / rate);
        let exponential = match Retraction::of(entry).contains(&Retraction::Exponential) {
            true => "take `--retraction exponential`, or",
            false => "take",
        };
        format!(
            "`{name}` turns by {turn:.2} rad in a step, which with the Cayley map counts as {percent:.1} % of its momentum: \
             {exponential} a step below {step:.1e} s, where it is 99 %"
        )
    })
}
