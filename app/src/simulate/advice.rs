//! Says what helps where steps go farther than their retraction or their series reaches; and where a jump of the force stops them.

use std::f64::consts::PI;

use coadjoint::StepError;
use coadjoint::certify::{Frame, REACH};
use coadjoint::erased;
use coadjoint::system::Quantity;

use crate::catalogue::quantities::rotation;
use crate::catalogue::{Entry, Setup};
use crate::error::RunError;
use crate::setup::{Job, Method, Order, Retraction};
use crate::units::rounded;

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
    let (name, rate) = fastest(entry, setup, (time, end))?;
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

/// Says that a Hamilton–Jacobi step goes farther than its series gives the order that it has, and which step does not. It is
/// looked at in states along a run: there, two steps of half the length are taken beside the whole one.
pub(crate) fn beyond_series(
    entry: &Entry,
    setup: &Setup,
    job: &Job,
    states: &[(f64, Vec<f64>)],
) -> Option<String> {
    if !job.method.is_of_order() {
        return None;
    }
    let (system, law) = (entry.system(&setup.parameters), entry.law(setup));
    let share = |step: f64, (time, state): &(f64, Vec<f64>)| {
        let control = law.as_ref().map(|law| entry.chosen(law, (state, *time))).unwrap_or_default();
        let frame = Frame::new(&*system, state, &control, *time)?;
        let walk = |step: f64, steps: usize| -> Option<Vec<Vec<f64>>> {
            let mut stepper = super::stepper(entry, system.clone(), None, &Job { step, ..*job }).ok()?;
            stepper.set_time(*time);
            let mut now = state.clone();
            (0..steps).map(|_| stepper.step(&mut now, &control).ok().map(|_| now.clone())).collect()
        };
        let (whole, halves) = (walk(step, 1)?, walk(0.5 * step, 2)?);
        let (share, block) = frame.share(job.order.number(), [state, &halves[0], &halves[1], &whole[0]]);
        let place = *frame.blocks().get(block)?.first()?;
        let (quantity, _) =
            Quantity::with_ranges(entry.description.state).find(|(_, slots)| slots.contains(&place))?;
        Some((share, quantity.name))
    };
    let shares = states.iter().filter_map(|at| Some((share(job.step, at)?, at)));
    let ((most, name), at) = shares.max_by(|(a, _), (b, _)| a.0.total_cmp(&b.0))?;
    if !(most > REACH) {
        return None;
    }
    // the share grows with the step, if not quite in proportion; shorter steps come to other states, where it may be more
    let allowed = 0.8 * REACH;
    let (mut step, mut now) = (job.step, most);
    for _ in 0..20 {
        step *= (allowed / now).min(0.95);
        now = share(step, at).map_or(now, |(share, _)| share);
        if now <= allowed {
            break;
        }
    }
    let percent = 100.0 * most.powf(f64::from(job.order.number()));
    Some(format!(
        "at {} s two steps of half the length change {percent:.1} % of what a step does of `{name}`, more than the series of \
         Hamilton–Jacobi steps allows: take a step below {:.1e} s",
        rounded(at.0),
        step.abs()
    ))
}

/// The rotation in the plane that turns fastest where a run starts or ends, and its rate.
fn fastest<'e>(entry: &'e Entry, setup: &Setup, (time, end): (f64, &[f64])) -> Option<(&'e str, f64)> {
    let (system, law) = (entry.system(&setup.parameters), entry.law(setup));
    let rates = [(0.0, &setup.state[..]), (time, end)].map(|(time, state)| {
        let control = law.as_ref().map(|law| entry.chosen(law, (state, time))).unwrap_or_default();
        system.motion(state, time, &control)
    });
    let turns = entry.description.state.iter().filter_map(|quantity| {
        rotation(quantity).filter(|(coordinates, _)| *coordinates == 2)?;
        let rate = |rates: &Vec<f64>| rates[quantity.tangent().start].abs();
        Some((quantity.name, rates.iter().map(rate).fold(0.0, f64::max)))
    });
    turns.max_by(|a, b| a.1.total_cmp(&b.1))
}
