//! Identification: the inertia tensor of a spacecraft from noisy samples of its gyroscopes, by Gauss and Newton's method.
//!
//! Known torques turn the spacecraft; gyroscopes measure its velocity `ω = 𝓘⁻¹Π`. Sought are the six entries of `𝓘` and the initial momentum:
//! those `z` for which the sum of the squared residuals `r_k = ω_k − 𝓘⁻¹Π_k(z)` is least. With the derivatives `A`, `P` of a step with respect to state
//! and parameters, the sensitivity `S = ∂Π/∂z` goes along with the motion, `S' = A S + P`; and `z` improves by the solution `δ` of
//! `(Σ JᵀJ) δ = Σ Jᵀr` with `J = ∂(𝓘⁻¹Π)/∂z`.

use coadjoint::derivative::{WrtParameters, WrtState, block};
use coadjoint::prelude::*;
use nalgebra::{SMatrix, SVector};

use super::{Failure, Noise, Spacecraft, SpacecraftControl, SpacecraftIndices, SpacecraftState};

/// The step, s.
const STEP: f64 = 0.05;
/// Steps from one sample to the next.
const EVERY: u64 = 4;
/// Steps of the experiment.
const STEPS: u64 = 1200;
/// The noise of each component of a sample, rad/s.
pub const NOISE: f64 = 2e-3;

/// The entries of a symmetric matrix that there are to know, in the order of estimates.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// An estimate, and how good it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The tensor of inertia, kg m².
    pub inertia: Matrix3<f64>,
    /// The momentum at the start, body frame, N m s.
    pub momentum: Vector3<f64>,
    /// The root of the residuals' mean square, rad/s.
    pub residual: f64,
    /// The covariance of the estimate, in the order of inertia's `xx, yy, zz, xy, xz, yz` and the momentum.
    pub covariance: SMatrix<f64, 9, 9>,
}

/// Known torques: a signal that excites all axes, N m.
pub fn torque(step: u64) -> Vector3<f64> {
    let time = STEP * step as f64;
    0.2 * vector![(0.9 * time).sin(), (1.3 * time).cos(), (0.7 * time + 1.0).sin()]
}

/// A simulated experiment with a spacecraft whose inertia is known: the samples with their times.
///
/// # Errors
/// If a step cannot be taken.
pub fn experiment(
    craft: &Spacecraft,
    momentum: Vector3<f64>,
    seed: u64,
) -> Result<Vec<(f64, Vector3<f64>)>, Failure> {
    let mut noise = Noise::new(seed);
    let mut stepper = craft.stepper::<Cayley>(STEP)?;
    let mut state = SpacecraftState { attitude: UnitQuaternion::identity(), momentum };
    let mut samples = Vec::new();
    for step in 0..STEPS {
        if step % EVERY == 0 {
            samples.push((stepper.time(), craft.velocity(&state) + noise.vector(NOISE)));
        }
        stepper.step_with(&mut state, &SpacecraftControl { torque: torque(step) })?;
    }
    Ok(samples)
}

/// What gyroscopes without noise would measure, at the times of the samples.
///
/// # Errors
/// If a step cannot be taken.
pub fn predicted(inertia: Matrix3<f64>, momentum: Vector3<f64>) -> Result<Vec<Vector3<f64>>, Failure> {
    let mut velocities = Vec::new();
    let craft = Spacecraft { inertia };
    let mut stepper = craft.stepper::<Cayley>(STEP)?;
    let mut state = SpacecraftState { attitude: UnitQuaternion::identity(), momentum };
    for step in 0..STEPS {
        if step % EVERY == 0 {
            velocities.push(craft.velocity(&state));
        }
        stepper.step_with(&mut state, &SpacecraftControl { torque: torque(step) })?;
    }
    Ok(velocities)
}

/// The estimates, one for each iteration: the guess first, with the momentum that the first sample then means, until nothing changes.
///
/// # Errors
/// If a step cannot be taken, or the samples do not determine what is sought.
pub fn identify(samples: &[(f64, Vector3<f64>)], guess: Matrix3<f64>) -> Result<Vec<Estimate>, Failure> {
    const ITERATIONS: usize = 50;
    let (_, first) = samples.first().ok_or(Failure::Singular)?;
    let (mut inertia, mut momentum) = (guess, guess * first);
    let mut estimates = Vec::new();
    for _ in 0..ITERATIONS {
        let (normal, gradient, squares) = normal_equations(samples, inertia, momentum)?;
        let normal = normal.cholesky().ok_or(Failure::Singular)?;
        estimates.push(Estimate {
            inertia,
            momentum,
            residual: (squares / (3.0 * samples.len() as f64)).sqrt(),
            covariance: normal.inverse() * NOISE.powi(2),
        });
        let change = normal.solve(&gradient);
        // a backtracking line search: the inertia must stay valid and the residuals must not grow
        let moved = |share: f64| {
            let change = share * change;
            (inertia + symmetric(&change), momentum + change.fixed_rows::<3>(6))
        };
        let mut share = 1.0;
        while share > 1e-6
            && sum_of_squares(samples, moved(share)).is_none_or(|now| now > (1.0 + 1e-9) * squares)
        {
            share *= 0.5;
        }
        (inertia, momentum) = moved(share);
        if change.norm() < 1e-11 * inertia.norm() {
            break;
        }
    }
    Ok(estimates)
}

/// `Σ r²`; none if the parameters are invalid.
fn sum_of_squares(
    samples: &[(f64, Vector3<f64>)],
    (inertia, momentum): (Matrix3<f64>, Vector3<f64>),
) -> Option<f64> {
    let predicted = predicted(inertia, momentum).ok()?;
    Some(
        samples.iter().zip(predicted).map(|((_, sample), velocity)| (sample - velocity).norm_squared()).sum(),
    )
}

/// `Σ JᵀJ`, `Σ Jᵀr` and `Σ r²`.
fn normal_equations(
    samples: &[(f64, Vector3<f64>)],
    inertia: Matrix3<f64>,
    momentum: Vector3<f64>,
) -> Result<(SMatrix<f64, 9, 9>, SVector<f64, 9>, f64), Failure> {
    type Indices = SpacecraftIndices;
    let craft = Spacecraft { inertia };
    let inverse = inertia.try_inverse().ok_or(Failure::Singular)?;
    let mut stepper = craft.stepper::<Cayley>(STEP)?;
    let mut state = SpacecraftState { attitude: UnitQuaternion::identity(), momentum };
    // the motion of the momentum does not depend on the attitude
    let mut sensitivity = SMatrix::<f64, 3, 9>::zeros();
    sensitivity.fixed_columns_mut::<3>(6).fill_with_identity();
    let (mut normal, mut gradient, mut squares) = (SMatrix::zeros(), SVector::zeros(), 0.0);
    let mut samples = samples.iter();
    for step in 0..STEPS {
        if step % EVERY == 0
            && let Some((_, sample)) = samples.next()
        {
            let velocity = craft.velocity(&state);
            let mut jacobian = sensitivity;
            for (column, change) in units().enumerate() {
                jacobian.set_column(column, &(sensitivity.column(column) - change * velocity));
            }
            let jacobian = inverse * jacobian;
            let residual = sample - velocity;
            normal += jacobian.transpose() * jacobian;
            gradient += jacobian.transpose() * residual;
            squares += residual.norm_squared();
        }
        let control = SpacecraftControl { torque: torque(step) };
        let (wrt_state, wrt_inertia) =
            stepper.step_with_jacobian(&mut state, &control, (WrtState, WrtParameters))?.0;
        sensitivity = block(&wrt_state, Indices::MOMENTUM, Indices::MOMENTUM) * sensitivity;
        let wrt_entries = block(&wrt_inertia, Indices::MOMENTUM, Indices::INERTIA);
        for (column, (i, j)) in ENTRIES.into_iter().enumerate() {
            let mut total = sensitivity.column(column) + wrt_entries.column(3 * i + j);
            if i != j {
                total += wrt_entries.column(3 * j + i);
            }
            sensitivity.set_column(column, &total);
        }
    }
    Ok((normal, gradient, squares))
}

/// The symmetric matrices that have one entry, or one and the same beyond the diagonal.
fn units() -> impl Iterator<Item = Matrix3<f64>> {
    ENTRIES.into_iter().map(|(i, j)| {
        let mut unit = Matrix3::zeros();
        (unit[(i, j)], unit[(j, i)]) = (1.0, 1.0);
        unit
    })
}

fn symmetric(change: &SVector<f64, 9>) -> Matrix3<f64> {
    units().zip(change.iter()).map(|(unit, entry)| *entry * unit).sum()
}
