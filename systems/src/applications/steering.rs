//! Steering: from rest to rest in another attitude with a few pulses of torque, and the least effort `½ Σ |τ|²`.
//!
//! Direct shooting: the end of the motion, `e(u) = (log(g*⁻¹ g_N), Π_N)`, is a function of all pulses `u`, and its derivative `E` is
//! propagated with the steps, `S' = A S + B`, by the derivatives of a step with respect to state and control. Of all pulses that make `e + E (u' − u)` zero the next ones are those of least norm,
//! `u' = Eᵀ (E Eᵀ)⁻¹ (E u − e)`. Where this comes to rest `u = Eᵀλ`: to first order, no change that keeps the end makes the effort less.

use coadjoint::derivative::{WrtControl, WrtState};
use coadjoint::prelude::*;
use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector6};

use super::{Failure, Spacecraft, SpacecraftControl, SpacecraftState};

/// The step, s.
pub const STEP: f64 = 0.05;
/// Pulses.
pub const PULSES: usize = 8;
/// Steps of a pulse.
pub const LENGTH: usize = 50;

/// Pulses, and where they lead to.
#[derive(Clone, Debug, PartialEq)]
pub struct Manoeuvre {
    /// The torque of each pulse, body frame, N m.
    pub pulses: Vec<Vector3<f64>>,
    /// The terminal error: the rotation vector to the attitude that is wanted, rad, and the momentum, N m s.
    pub terminal_error: Vector6<f64>,
    /// The derivative of `terminal_error` with respect to all pulses.
    pub wrt_pulses: DMatrix<f64>,
}

impl Manoeuvre {
    /// The effort `½ Σ |τ|²`, N² m².
    pub fn effort(&self) -> f64 {
        0.5 * self.pulses.iter().map(Vector3::norm_squared).sum::<f64>()
    }

    /// All pulses one after the other.
    pub fn stacked(&self) -> DVector<f64> {
        DVector::from_iterator(3 * PULSES, self.pulses.iter().flat_map(|pulse| pulse.iter().copied()))
    }
}

/// The manoeuvres, one for each iteration, from none at all to the one of least effort.
///
/// # Errors
/// If a step cannot be taken, or the pulses cannot reach everything.
pub fn steer(craft: &Spacecraft, target: &UnitQuaternion<f64>) -> Result<Vec<Manoeuvre>, Failure> {
    const ITERATIONS: usize = 50;
    let mut manoeuvres = vec![shoot(craft, target, &[Vector3::zeros(); PULSES])?];
    for _ in 0..ITERATIONS {
        let Some(last) = manoeuvres.last() else { break };
        let (u, e) = (last.stacked(), &last.wrt_pulses);
        let inverse = (e * e.transpose()).cholesky().ok_or(Failure::Singular)?;
        // backtracking: far from the solution the linearization does not hold, so the step is halved
        let mut share = 1.0;
        let next = loop {
            let aim = e * &u - share * DVector::from_column_slice(last.terminal_error.as_slice());
            let pulses = e.transpose() * inverse.solve(&aim);
            let pulses: Vec<_> = pulses.as_slice().chunks_exact(3).map(Vector3::from_column_slice).collect();
            let next = shoot(craft, target, &pulses)?;
            if next.terminal_error.norm() <= (1.0 - 0.1 * share) * last.terminal_error.norm()
                || last.terminal_error.norm() < 1e-6
            {
                break next;
            }
            share *= 0.5;
            if share < 1e-3 {
                return Err(Failure::Singular);
            }
        };
        let change = (next.stacked() - &u).norm();
        manoeuvres.push(next);
        if change <= 1e-10 * u.norm() {
            break;
        }
    }
    Ok(manoeuvres)
}

/// Where pulses lead to, from rest.
fn shoot(
    craft: &Spacecraft,
    target: &UnitQuaternion<f64>,
    pulses: &[Vector3<f64>],
) -> Result<Manoeuvre, Failure> {
    let mut stepper = craft.stepper::<Cayley>(STEP)?;
    let mut state = SpacecraftState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros() };
    let mut wrt_pulses = SMatrix::<f64, 6, { 3 * PULSES }>::zeros();
    for (j, &torque) in pulses.iter().enumerate() {
        for _ in 0..LENGTH {
            let control = SpacecraftControl { torque };
            let (wrt_state, wrt_torque) =
                stepper.step_with_jacobian(&mut state, &control, (WrtState, WrtControl))?.0;
            wrt_pulses = wrt_state * wrt_pulses;
            let mut own = wrt_pulses.fixed_columns_mut::<3>(3 * j);
            own += wrt_torque;
        }
    }
    let left = (target.inverse() * state.attitude).scaled_axis();
    let mut wrt_end = SMatrix::<f64, 6, 6>::identity();
    wrt_end.fixed_view_mut::<3, 3>(0, 0).copy_from(&log_jacobian(&left));
    let terminal_error = SVector::from_iterator(left.iter().chain(state.momentum.iter()).copied());
    let wrt_pulses = DMatrix::from_column_slice(6, 3 * PULSES, (wrt_end * wrt_pulses).as_slice());
    Ok(Manoeuvre { pulses: pulses.to_vec(), terminal_error, wrt_pulses })
}

/// The derivative of `log g` where `g` becomes `g exp(δ)`, at `φ = log g`: `1 + ½ φ^ + (1/φ² − (1 + cos φ)/(2 φ sin φ)) φ^²`.
fn log_jacobian(rotation: &Vector3<f64>) -> Matrix3<f64> {
    let angle = rotation.norm();
    let factor = match angle < 1e-3 {
        true => 1.0 / 12.0,
        false => 1.0 / angle.powi(2) - (1.0 + angle.cos()) / (2.0 * angle * angle.sin()),
    };
    let hat = rotation.cross_matrix();
    Matrix3::identity() + 0.5 * hat + factor * hat * hat
}

/// The trajectory of the attitude, with times: the rotation vector to the attitude that is wanted.
///
/// # Errors
/// If a step cannot be taken.
pub fn trajectory(
    craft: &Spacecraft,
    target: &UnitQuaternion<f64>,
    pulses: &[Vector3<f64>],
) -> Result<Vec<(f64, Vector3<f64>)>, Failure> {
    let mut stepper = craft.stepper::<Cayley>(STEP)?;
    let mut state = SpacecraftState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros() };
    let left = |state: &SpacecraftState| (target.inverse() * state.attitude).scaled_axis();
    let mut trajectory = vec![(0.0, left(&state))];
    for &torque in pulses {
        for _ in 0..LENGTH {
            stepper.step_with(&mut state, &SpacecraftControl { torque })?;
            trajectory.push((stepper.time(), left(&state)));
        }
    }
    Ok(trajectory)
}
