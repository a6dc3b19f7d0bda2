//! Estimation: where a spacecraft points and how it turns, from the directions of two stars, by an error-state Kalman filter.
//!
//! The error is in the coordinates of the steps' derivatives: the truth is `(ĝ exp(δ), Π̂ + δΠ)`, and `P` the covariance of `(δ, δΠ)`. Between
//! measurements of the stars, a random torque acts on the spacecraft: with the derivatives of a step with respect to state and
//! torque, `P' = A P Aᵀ + σ² B Bᵀ`. A star in the direction `s` is seen in the direction `b = gᵀs`, which changes by `b × δ`.

use coadjoint::derivative::{WrtControl, WrtState};
use coadjoint::prelude::*;
use nalgebra::{Matrix6, SMatrix, Vector6};

use super::{Failure, Noise, Spacecraft, SpacecraftControl, SpacecraftState};

/// The step, s.
pub const STEP: f64 = 0.1;
/// Steps from one measurement to the next.
pub const EVERY: u64 = 10;
/// Steps.
pub const STEPS: u64 = 1200;
/// The random torque along each axis, held over a step, N m.
pub const TORQUE_NOISE: f64 = 2e-3;
/// The noise of each measured component of a star's direction.
pub const STAR_NOISE: f64 = 5e-3;
/// Standard deviation of the initial attitude about each axis, rad.
pub const ATTITUDE_DEVIATION: f64 = 0.3;
/// Standard deviation of the initial momentum, N m s.
pub const MOMENTUM_DEVIATION: f64 = 0.2;

/// The estimate after one measurement update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterUpdate {
    /// The time, s.
    pub time: f64,
    /// The true error `(δ, δΠ)`, rad and N m s.
    pub error: Vector6<f64>,
    /// The covariance that the filter ascribes to it.
    pub covariance: Matrix6<f64>,
}

impl FilterUpdate {
    /// The normalized estimation error squared `eᵀ P⁻¹ e`: 6 on average if the filter is consistent.
    pub fn nees(&self) -> Option<f64> {
        Some(self.error.dot(&self.covariance.cholesky()?.solve(&self.error)))
    }
}

/// The filter's estimate.
struct Filter {
    state: SpacecraftState,
    covariance: Matrix6<f64>,
}

impl Filter {
    /// The measurement update with stars: their directions in space, and those measured in the body.
    fn update(&mut self, stars: &[(Vector3<f64>, Vector3<f64>); 2]) -> Option<()> {
        let (mut measurement_jacobian, mut innovation) = (Matrix6::zeros(), Vector6::zeros());
        for (k, (star, seen)) in stars.iter().enumerate() {
            let expected = self.state.attitude.inverse() * star;
            measurement_jacobian.fixed_view_mut::<3, 3>(3 * k, 0).copy_from(&expected.cross_matrix());
            innovation.fixed_rows_mut::<3>(3 * k).copy_from(&(seen - expected));
        }
        let noise = Matrix6::from_diagonal_element(STAR_NOISE.powi(2));
        let innovation_covariance =
            measurement_jacobian * self.covariance * measurement_jacobian.transpose() + noise;
        let gain =
            innovation_covariance.cholesky()?.solve(&(measurement_jacobian * self.covariance)).transpose();
        let correction = gain * innovation;
        self.state.attitude *= UnitQuaternion::new(correction.fixed_rows::<3>(0).into_owned());
        self.state.momentum += correction.fixed_rows::<3>(3);
        // Joseph's form, which stays positive definite
        let factor = Matrix6::identity() - gain * measurement_jacobian;
        self.covariance = factor * self.covariance * factor.transpose() + gain * noise * gain.transpose();
        Some(())
    }
}

/// Simulates a flight and its filter: the estimate after each measurement update.
///
/// # Errors
/// If a step cannot be taken.
pub fn simulate(craft: &Spacecraft, seed: u64) -> Result<Vec<FilterUpdate>, Failure> {
    let mut noise = Noise::new(seed);
    let stars = [Vector3::x(), Vector3::new(0.0, 0.6, 0.8)];
    let mut truth = SpacecraftState {
        attitude: UnitQuaternion::new(vector![0.4, -0.2, 0.7]),
        momentum: vector![0.2, -0.3, 0.15],
    };
    let mut filter = Filter {
        state: SpacecraftState {
            attitude: truth.attitude * UnitQuaternion::new(noise.vector(ATTITUDE_DEVIATION)),
            momentum: truth.momentum + noise.vector(MOMENTUM_DEVIATION),
        },
        covariance: Matrix6::from_diagonal(&Vector6::from_fn(|i, _| {
            if i < 3 { ATTITUDE_DEVIATION.powi(2) } else { MOMENTUM_DEVIATION.powi(2) }
        })),
    };
    let mut true_stepper = craft.stepper::<Cayley>(STEP)?;
    let mut stepper = craft.stepper::<Cayley>(STEP)?;
    let mut updates = Vec::new();
    for step in 0..=STEPS {
        if step % EVERY == 0 {
            let seen = stars.map(|star| (star, truth.attitude.inverse() * star + noise.vector(STAR_NOISE)));
            filter.update(&seen).ok_or(Failure::Singular)?;
            let mut error = Vector6::zeros();
            let turn = (filter.state.attitude.inverse() * truth.attitude).scaled_axis();
            error.fixed_rows_mut::<3>(0).copy_from(&turn);
            error.fixed_rows_mut::<3>(3).copy_from(&(truth.momentum - filter.state.momentum));
            updates.push(FilterUpdate { time: stepper.time(), error, covariance: filter.covariance });
        }
        true_stepper.step_with(&mut truth, &SpacecraftControl { torque: noise.vector(TORQUE_NOISE) })?;
        let (a, b): (Matrix6<f64>, SMatrix<f64, 6, 3>) = stepper
            .step_with_jacobian(&mut filter.state, &SpacecraftControl::default(), (WrtState, WrtControl))?
            .0;
        filter.covariance = a * filter.covariance * a.transpose() + TORQUE_NOISE.powi(2) * b * b.transpose();
    }
    Ok(updates)
}
