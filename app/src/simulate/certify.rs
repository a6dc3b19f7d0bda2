//! Claims of a scheme, measured on a system's example.

use std::ops::ControlFlow;

use coadjoint::certify::{Report, certify_erased, certify_taylor};
use coadjoint::erased::{self, RetractionKind};
use coadjoint::system::{Quantity, Role};

use super::{scheme, simulate};
use crate::catalogue::quantities::tangent_length;
use crate::catalogue::{Entry, Setup};
use crate::error::RunError;
use crate::setup::random::Random;
use crate::setup::{Job, Method, Order, Retraction, standard};

/// Measures the claims of a scheme at [`states_in_motion`], with the controls of the setup there.
///
/// # Errors
/// If parameters are not valid, or a step cannot be taken.
pub fn certify(
    entry: &Entry,
    setup: &Setup,
    method: Method,
    retraction: Retraction,
    order: Order,
) -> Result<Report, RunError> {
    let (states, _) = states_in_motion(entry, setup)?;
    let law = entry.law(setup);
    let chosen = |state: &Vec<f64>| law.as_ref().map(|law| entry.chosen(law, (state, 0.0)));
    let controls: Vec<Vec<f64>> = states.iter().filter_map(chosen).collect();
    let system = entry.system(&setup.parameters);
    if let Method::Taylor(_) = method {
        return Ok(certify_taylor(system, &states, &controls)?);
    }
    // the one that it is; what is composed is made of the symmetric ones alone
    let is_one = method == Method::Standard && order == Order::Two;
    let method = if is_one { standard(entry, retraction) } else { method };
    let scheme = scheme(method, retraction, order)?;
    // where a table or a ramp of time begins there is a kink, and mostly that is zero
    let time = if entry.description.autonomous { 0.0 } else { 25.25 * entry.step };
    Ok(certify_erased(&*system, &scheme, &states, &controls, time, entry.certified_step)?)
}

/// Three states at which the motion shows what it can: the example's, and where 40 and 80 steps lead from there; if it
/// rests, three near it, chosen at random, with momenta that turn it by up to a radian, or move it by up to a metre, in
/// a tenth of its usual duration. The answer is also whether it rests.
///
/// # Errors
/// If parameters are not valid, or a step cannot be taken.
pub fn states_in_motion(entry: &Entry, setup: &Setup) -> Result<(Vec<Vec<f64>>, bool), RunError> {
    let job = Job {
        method: Method::Standard,
        retraction: Retraction::of(entry).first().copied().unwrap_or(Retraction::Exponential),
        order: Order::Two,
        step: entry.step,
        steps: 80,
        rest: 0.0,
    };
    let mut states = Vec::new();
    simulate(entry, setup, &job, None, &|index| index + 40, &mut |sample| {
        states.push(sample.state.to_vec());
        ControlFlow::Continue(())
    })?;
    let moves = |(x, y): (&f64, &f64)| (x - y).abs() > 1e-9 * (1.0 + y.abs());
    let rests = !states.iter().any(|state| state.iter().zip(&setup.state).any(moves));
    if rests {
        let system = entry.system(&setup.parameters);
        let mut random = Random::new(1, 0);
        let control = entry.law(setup).map(|law| entry.chosen(&law, (&setup.state, 0.0))).unwrap_or_default();
        states = (0..3)
            .map(|_| in_motion(&*system, &control, &setup.state, 10.0 / entry.duration, &mut random))
            .collect();
    }
    Ok((states, rests))
}

/// A state near this one, displaced by up to a half along each direction, that moves at up to this rate along each
/// under these controls.
fn in_motion(
    system: &dyn erased::System,
    control: &[f64],
    state: &[f64],
    rate: f64,
    random: &mut Random,
) -> Vec<f64> {
    let quantities = system.description().state;
    let mut by = vec![0.0; tangent_length(quantities)];
    for quantity in quantities.iter().filter(|quantity| quantity.role == Role::Configuration) {
        by[quantity.tangent()].fill_with(|| 0.5 * random.even());
    }
    let mut moving = system.displace(state, RetractionKind::Exponential, &by);
    for (quantity, slots) in Quantity::with_ranges(quantities) {
        if quantity.role == Role::Momentum {
            moving[slots].fill_with(|| rate * random.even());
        }
    }
    system.with_velocity(&moving, 0.0, control).unwrap_or(moving)
}
