//! Claims of a scheme, measured on a system's example.

use std::ops::ControlFlow;

use coadjoint::certify::{Report, certify_erased};
use coadjoint::erased::{self, RetractionKind};
use coadjoint::system::{Quantity, Role};
use nalgebra::{DMatrix, DVector};

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
) -> Result<Report, RunError> {
    let method = if method == Method::Standard { standard(entry, retraction) } else { method };
    let scheme = scheme(method, retraction, Order::Two)?;
    let (states, _) = states_in_motion(entry, setup)?;
    let law = entry.law(setup);
    let chosen = |state: &Vec<f64>| law.as_ref().map(|law| entry.chosen(law, (state, 0.0)));
    let controls: Vec<Vec<f64>> = states.iter().filter_map(chosen).collect();
    let system = entry.system(&setup.parameters);
    Ok(certify_erased(&*system, &scheme, &states, &controls, entry.certified_step)?)
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
    let of = |role| -> Vec<usize> {
        quantities.iter().filter(|quantity| quantity.role == role).flat_map(Quantity::tangent).collect()
    };
    let (turns, momenta) = (of(Role::Configuration), of(Role::Momentum));
    let length = tangent_length(quantities);
    let mut by = vec![0.0; length];
    turns.iter().for_each(|&turn| by[turn] = 0.5 * random.even());
    let displaced = system.displace(state, RetractionKind::Exponential, &by);
    // the momentum of a velocity: where the energy is quadratic in it, `∂h/∂μ` is a linear map
    let velocity = |by: &[f64]| -> Vec<f64> {
        let there = system.displace(&displaced, RetractionKind::Exponential, by);
        let differential = system.differential(&there, 0.0, control);
        momenta.iter().map(|&place| differential[place]).collect()
    };
    let at_rest = velocity(&vec![0.0; length]);
    let columns: Vec<DVector<f64>> = momenta
        .iter()
        .map(|&place| {
            let mut unit = vec![0.0; length];
            unit[place] = 1.0;
            DVector::from_vec(velocity(&unit)) - DVector::from_column_slice(&at_rest)
        })
        .collect();
    let requested =
        DVector::from_iterator(at_rest.len(), at_rest.iter().map(|resting| rate * random.even() - resting));
    let mut by = vec![0.0; length];
    let momentum = (!columns.is_empty()).then(|| DMatrix::from_columns(&columns).lu().solve(&requested));
    if let Some(momentum) = momentum.flatten() {
        momenta.iter().zip(&momentum).for_each(|(&place, momentum)| by[place] = *momentum);
    }
    system.displace(&displaced, RetractionKind::Exponential, &by)
}
