//! Says what helps where steps turn farther than their retraction reaches, or than it follows well; and where a jump of the force stops them.

use std::f64::consts::PI;

use coadjoint::StepError;
use coadjoint::erased;

use crate::catalogue::quantities::rotation;
use crate::catalogue::{Entry, Setup};
use crate::error::RunError;
use crate::setup::{Job, Method, Order, Retraction};

/// Why a step could not be taken, where the reason is known: it turns too far, or a force jumps.
pub(super) fn explained(
    source: coadjoint::RunError,
    system: &dyn erased::System,
    state: &[f64],
    job: &Job,
) -> RunError {
    let is_unsolved = matches!(source.cause, StepError::NoConvergence { .. } | StepError::NoSolution { .. });
    if is_unsolved && system.description().piecewise && !matches!(job.method, Method::Taylor(_)) {
        return RunError::Piecewise { source };
    }
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
    let (name, rate) = fastest(entry, setup, (time, end), |coordinates| coordinates == 2)?;
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

/// Says that a Hamilton–Jacobi step turns farther than where its series gives the order that it has. It is looked at where
/// a run starts and ends.
pub(crate) fn beyond_series(entry: &Entry, setup: &Setup, job: &Job, end: (f64, &[f64])) -> Option<String> {
    if job.method != Method::HamiltonJacobi {
        return None;
    }
    let most = if job.retraction == Retraction::Exponential { 2.0 } else { 0.6 };
    let (name, rate) = fastest(entry, setup, end, |_| true)?;
    let turn = rate * job.step.abs();
    (turn > most).then(|| {
        format!(
            "`{name}` turns by {turn:.2} rad in a step, farther than the series of Hamilton–Jacobi steps follows: take a step below \
             {:.1e} s, where it is {most} rad",
            most / rate
        )
    })
}

/// The rotation that turns fastest where a run starts or ends, of those with so many coordinates, and its rate.
fn fastest<'e>(
    entry: &'e Entry,
    setup: &Setup,
    (time, end): (f64, &[f64]),
    is_wanted: impl Fn(usize) -> bool,
) -> Option<(&'e str, f64)> {
    let (system, law) = (entry.system(&setup.parameters), entry.law(setup));
    let rates = [(0.0, &setup.state[..]), (time, end)].map(|(time, state)| {
        let control = law.as_ref().map(|law| entry.chosen(law, (state, time))).unwrap_or_default();
        system.motion(state, time, &control)
    });
    let turns = entry.description.state.iter().filter_map(|quantity| {
        let (coordinates, _) = rotation(quantity).filter(|(coordinates, _)| is_wanted(*coordinates))?;
        let tangent = quantity.tangent();
        let axes = tangent.start..tangent.start + if coordinates == 4 { 3 } else { 1 };
        let size = |rates: &Vec<f64>| rates[axes.clone()].iter().map(|rate| rate * rate).sum::<f64>().sqrt();
        Some((quantity.name, rates.iter().map(size).fold(0.0, f64::max)))
    });
    turns.max_by(|a, b| a.1.total_cmp(&b.1))
}
