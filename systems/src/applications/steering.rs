//! Steering: from rest to rest in another attitude with a few pulses of torque, and the least effort `½ Σ |τ|²`.
//!
//! Direct shooting: the end of the motion, `e(u) = (log(g*⁻¹ g_N), Π_N)`, is a function of all pulses `u`, and its derivative `E` comes along
//! with the steps, `S' = A S + B`, by state and control. Of all pulses that make `e + E (u' − u)` zero the next ones are those of least norm,
//! `u' = Eᵀ (E Eᵀ)⁻¹ (E u − e)`. Where this comes to rest `u = Eᵀλ`: to first order, no change that keeps the end makes the effort less.

use coadjoint::derivative::{ByControl, ByState};
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
    /// What is left at the end: the rotation vector to the attitude that is wanted, rad, and the momentum, N m s.
    pub miss: Vector6<f64>,
    /// The derivative of `miss` by all pulses.
    pub by_pulses: DMatrix<f64>,
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
        let (u, e) = (last.stacked(), &last.by_pulses);
        let inverse = (e * e.transpose()).cholesky().ok_or(Failure::Singular)?;
        // far from the end the motion is not as its derivative says: half as far then
        let mut share = 1.0;
        let next = loop {
            let aim = e * &u - share * DVector::from_column_slice(last.miss.as_slice());
            let pulses = e.transpose() * inverse.solve(&aim);
            let pulses: Vec<_> = pulses.as_slice().chunks_exact(3).map(Vector3::from_column_slice).collect();
            let next = shoot(craft, target, &pulses)?;
            if next.miss.norm() <= (1.0 - 0.1 * share) * last.miss.norm() || last.miss.norm() < 1e-6 {
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
    let mut by_pulses = SMatrix::<f64, 6, { 3 * PULSES }>::zeros();
    for (j, &torque) in pulses.iter().enumerate() {
        for _ in 0..LENGTH {
            let control = SpacecraftControl { torque };
            let (by_state, by_torque) =
                stepper.step_with_jacobian(&mut state, &control, (ByState, ByControl))?.jacobian;
            by_pulses = by_state * by_pulses;
            let mut own = by_pulses.fixed_columns_mut::<3>(3 * j);
            own += by_torque;
        }
    }
    let left = (target.inverse() * state.attitude).scaled_axis();
    let mut by_end = SMatrix::<f64, 6, 6>::identity();
    by_end.fixed_view_mut::<3, 3>(0, 0).copy_from(&by_rotation(&left));
    let miss = SVector::from_iterator(left.iter().chain(state.momentum.iter()).copied());
    let by_pulses = DMatrix::from_column_slice(6, 3 * PULSES, (by_end * by_pulses).as_slice());
    Ok(Manoeuvre { pulses: pulses.to_vec(), miss, by_pulses })
}

/// The derivative of `log g` where `g` becomes `g exp(δ)`, at `φ = log g`: `1 + ½ φ^ + (1/φ² − (1 + cos φ)/(2 φ sin φ)) φ^²`.
fn by_rotation(rotation: &Vector3<f64>) -> Matrix3<f64> {
    let angle = rotation.norm();
    let factor = match angle < 1e-3 {
        true => 1.0 / 12.0,
        false => 1.0 / angle.powi(2) - (1.0 + angle.cos()) / (2.0 * angle * angle.sin()),
    };
    let hat = rotation.cross_matrix();
    Matrix3::identity() + 0.5 * hat + factor * hat * hat
}

/// The attitudes on the way, with their times: the rotation vector to the attitude that is wanted.
///
/// # Errors
/// If a step cannot be taken.
pub fn course(
    craft: &Spacecraft,
    target: &UnitQuaternion<f64>,
    pulses: &[Vector3<f64>],
) -> Result<Vec<(f64, Vector3<f64>)>, Failure> {
    let mut stepper = craft.stepper::<Cayley>(STEP)?;
    let mut state = SpacecraftState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros() };
    let left = |state: &SpacecraftState| (target.inverse() * state.attitude).scaled_axis();
    let mut course = vec![(0.0, left(&state))];
    for &torque in pulses {
        for _ in 0..LENGTH {
            stepper.step_with(&mut state, &SpacecraftControl { torque })?;
            course.push((stepper.time(), left(&state)));
        }
    }
    Ok(course)
}
