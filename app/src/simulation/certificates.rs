//! What a scheme claims, measured on a system's example.

use std::ops::ControlFlow;

use coadjoint::__private::Map;
use coadjoint::certify::{Report, certify_erased};
use coadjoint::erased;
use coadjoint::system::Role;

use super::{Job, Method, Order, Retraction, Setup, SimulationError, scheme, tangent_places};
use crate::entry::Entry;
use crate::linear;
use crate::random::Random;

impl Entry {
    /// Measures the claims of a scheme at [`states_in_motion`](Self::states_in_motion), with the controls of the setup there.
    ///
    /// # Errors
    /// If parameters are not valid, or a step cannot be taken.
    pub fn certify(
        &self,
        setup: &Setup,
        method: Method,
        retraction: Retraction,
    ) -> Result<Report, SimulationError> {
        let method = if method == Method::Standard { self.standard(retraction) } else { method };
        let scheme = scheme(method, retraction, Order::Two)?;
        let (states, _) = self.states_in_motion(setup)?;
        let law = self.law(setup);
        let chosen = |state: &Vec<f64>| law.as_ref().map(|law| self.chosen(law, (state, 0.0)));
        let controls: Vec<Vec<f64>> = states.iter().filter_map(chosen).collect();
        let system = self.system(&setup.parameters);
        Ok(certify_erased(&*system, &scheme, &states, &controls, self.certified_step)?)
    }

    /// Three states at which the motion shows what it can: the example's, and where 40 and 80 steps lead from there; if it rests, three near it,
    /// chosen at random, with momenta that turn it by up to a radian, or move it by up to a metre, in a tenth of its usual duration. The answer is also
    /// whether it rests.
    ///
    /// # Errors
    /// If parameters are not valid, or a step cannot be taken.
    pub fn states_in_motion(&self, setup: &Setup) -> Result<(Vec<Vec<f64>>, bool), SimulationError> {
        let job = Job {
            method: Method::Standard,
            retraction: Retraction::of(self).first().copied().unwrap_or(Retraction::Exponential),
            order: Order::Two,
            step: self.step,
            steps: 80,
        };
        let mut states = Vec::new();
        self.simulate(setup, &job, None, &|index| index + 40, &mut |sample| {
            states.push(sample.state.to_vec());
            ControlFlow::Continue(())
        })?;
        let moves = |(x, y): (&f64, &f64)| (x - y).abs() > 1e-9 * (1.0 + y.abs());
        let rests = !states.iter().any(|state| state.iter().zip(&setup.state).any(moves));
        if rests {
            let system = self.system(&setup.parameters);
            let mut random = Random::new(1, 0);
            let control =
                self.law(setup).map(|law| self.chosen(&law, (&setup.state, 0.0))).unwrap_or_default();
            states = (0..3)
                .map(|_| in_motion(&*system, &control, &setup.state, 10.0 / self.duration, &mut random))
                .collect();
        }
        Ok((states, rests))
    }
}

/// A state near this one, displaced by up to a half along each direction, that moves at up to this rate along each under these controls.
fn in_motion(
    system: &dyn erased::System,
    control: &[f64],
    state: &[f64],
    rate: f64,
    random: &mut Random,
) -> Vec<f64> {
    let places: Vec<_> = tangent_places(system.description().state).collect();
    let of = |role| places.iter().filter(move |place| place.0 == role).flat_map(|place| place.1.clone());
    let (turns, momenta) =
        (of(Role::Configuration).collect::<Vec<usize>>(), of(Role::Momentum).collect::<Vec<usize>>());
    let length = places.last().map_or(0, |place| place.1.end);
    let mut by = vec![0.0; length];
    turns.iter().for_each(|&turn| by[turn] = 0.5 * random.even());
    let displaced = system.displace(state, Map::Exponential, &by);
    // the momentum of a velocity: where the energy is quadratic in it, `∂h/∂μ` is a linear map
    let velocity = |by: &[f64]| -> Vec<f64> {
        let there = system.displace(&displaced, Map::Exponential, by);
        let differential = system.differential(&there, 0.0, control);
        momenta.iter().map(|&place| differential[place]).collect()
    };
    let at_rest = velocity(&vec![0.0; length]);
    let columns: Vec<Vec<f64>> = momenta
        .iter()
        .map(|&place| {
            let mut unit = vec![0.0; length];
            unit[place] = 1.0;
            velocity(&unit).iter().zip(&at_rest).map(|(moving, resting)| moving - resting).collect()
        })
        .collect();
    let wanted: Vec<f64> = at_rest.iter().map(|resting| rate * random.even() - resting).collect();
    let mut by = vec![0.0; length];
    if let Some(momentum) = linear::solve(&columns, &wanted) {
        momenta.iter().zip(momentum).for_each(|(&place, momentum)| by[place] = momentum);
    }
    system.displace(&displaced, Map::Exponential, &by)
}
