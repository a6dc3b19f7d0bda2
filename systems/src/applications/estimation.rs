//! Estimation: where a spacecraft points and how it turns, from the directions of two stars, by an error-state Kalman filter.
//!
//! The error is in the coordinates of the steps' derivatives: the truth is `(ĝ exp(δ), Π̂ + δΠ)`, and `P` the covariance of `(δ, δΠ)`. Between
//! looks at the stars, thrusters that are not quite off push the spacecraft at random: with the derivatives of a step by state and
//! torque, `P' = A P Aᵀ + σ² B Bᵀ`. A star in the direction `s` is seen in the direction `b = gᵀs`, which changes by `b × δ`.

use coadjoint::derivative::{ByControl, ByState};
use coadjoint::prelude::*;
use nalgebra::{Matrix6, SMatrix, Vector6};

use super::{Failure, Noise, Spacecraft, SpacecraftControl, SpacecraftState};

/// The step, s.
pub const STEP: f64 = 0.1;
/// Steps from one look at the stars to the next.
pub const EVERY: u64 = 10;
/// Steps.
pub const STEPS: u64 = 1200;
/// The random torque along each axis, held over a step, N m.
pub const PUSH: f64 = 2e-3;
/// The noise of each component of a star's direction.
pub const BLUR: f64 = 5e-3;
/// How uncertain the attitude is at the start, about each axis, rad.
pub const DOUBT: f64 = 0.3;
/// How uncertain the momentum is, N m s.
pub const MOMENTUM_DOUBT: f64 = 0.2;

/// One moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The time, s.
    pub time: f64,
    /// The true error `(δ, δΠ)`, rad and N m s.
    pub error: Vector6<f64>,
    /// The covariance that the filter ascribes to it.
    pub covariance: Matrix6<f64>,
}

impl Moment {
    /// `eᵀ P⁻¹ e`: 6 on average if the filter knows how good it is.
    pub fn normalized_square(&self) -> Option<f64> {
        Some(self.error.dot(&self.covariance.cholesky()?.solve(&self.error)))
    }
}

/// The filter's estimate.
struct Filter {
    state: SpacecraftState,
    covariance: Matrix6<f64>,
}

impl Filter {
    /// Looks at stars: where they are, and where they are seen.
    fn look(&mut self, stars: &[(Vector3<f64>, Vector3<f64>); 2]) -> Option<()> {
        let (mut by_error, mut surprise) = (Matrix6::zeros(), Vector6::zeros());
        for (k, (star, seen)) in stars.iter().enumerate() {
            let expected = self.state.attitude.inverse() * star;
            by_error.fixed_view_mut::<3, 3>(3 * k, 0).copy_from(&expected.cross_matrix());
            surprise.fixed_rows_mut::<3>(3 * k).copy_from(&(seen - expected));
        }
        let noise = Matrix6::from_diagonal_element(BLUR.powi(2));
        let spread = by_error * self.covariance * by_error.transpose() + noise;
        let gain = spread.cholesky()?.solve(&(by_error * self.covariance)).transpose();
        let change = gain * surprise;
        self.state.attitude *= UnitQuaternion::new(change.fixed_rows::<3>(0).into_owned());
        self.state.momentum += change.fixed_rows::<3>(3);
        // Joseph's form, which stays positive definite
        let kept = Matrix6::identity() - gain * by_error;
        self.covariance = kept * self.covariance * kept.transpose() + gain * noise * gain.transpose();
        Some(())
    }
}

/// A flight, and what the filter makes of it: the moments after each look at the stars.
///
/// # Errors
/// If a step cannot be taken.
pub fn fly(craft: &Spacecraft, seed: u64) -> Result<Vec<Moment>, Failure> {
    let mut noise = Noise::new(seed);
    let stars = [Vector3::x(), Vector3::new(0.0, 0.6, 0.8)];
    let mut truth = SpacecraftState {
        attitude: UnitQuaternion::new(vector![0.4, -0.2, 0.7]),
        momentum: vector![0.2, -0.3, 0.15],
    };
    let mut filter = Filter {
        state: SpacecraftState {
            attitude: truth.attitude * UnitQuaternion::new(noise.vector(DOUBT)),
            momentum: truth.momentum + noise.vector(MOMENTUM_DOUBT),
        },
        covariance: Matrix6::from_diagonal(&Vector6::from_fn(|i, _| {
            if i < 3 { DOUBT.powi(2) } else { MOMENTUM_DOUBT.powi(2) }
        })),
    };
    let mut true_stepper = craft.stepper::<Cayley>(STEP)?;
    let mut stepper = craft.stepper::<Cayley>(STEP)?;
    let mut moments = Vec::new();
    for step in 0..=STEPS {
        if step % EVERY == 0 {
            let seen = stars.map(|star| (star, truth.attitude.inverse() * star + noise.vector(BLUR)));
            filter.look(&seen).ok_or(Failure::Singular)?;
            let mut error = Vector6::zeros();
            let turn = (filter.state.attitude.inverse() * truth.attitude).scaled_axis();
            error.fixed_rows_mut::<3>(0).copy_from(&turn);
            error.fixed_rows_mut::<3>(3).copy_from(&(truth.momentum - filter.state.momentum));
            moments.push(Moment { time: stepper.time(), error, covariance: filter.covariance });
        }
        true_stepper.step_with(&mut truth, &SpacecraftControl { torque: noise.vector(PUSH) })?;
        let (a, b): (Matrix6<f64>, SMatrix<f64, 6, 3>) = stepper
            .step_with_jacobian(&mut filter.state, &SpacecraftControl::default(), (ByState, ByControl))?
            .jacobian;
        filter.covariance = a * filter.covariance * a.transpose() + PUSH.powi(2) * b * b.transpose();
    }
    Ok(moments)
}
