//! Systems that several tests need: each is compiled once.

use coadjoint::prelude::*;

/// A rigid body that turns about a fixed point under gravity: the vertical is advected.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi), methods(Midpoint))]
#[derive(Clone)]
pub(crate) struct Top {
    #[inertia]
    pub(crate) inertia: Vector3<f64>,
    pub(crate) weight: f64,
    pub(crate) chi: Vector3<f64>,
}

/// In single precision.
#[lie_poisson_system(group = SO3)]
#[derive(Clone)]
pub(crate) struct Single {
    #[inertia]
    pub(crate) inertia: Vector3<f32>,
}

/// Nothing acts on it.
#[lie_poisson_system(group = SO3, methods(HamiltonJacobi(8)))]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Body {
    #[inertia]
    pub(crate) inertia: Vector3<f64>,
}

/// A pendulum of two links: its mass matrix depends on the configuration, so that all iterations are Newton's.
#[lie_poisson_system(
    group(first: SO2, second: SO2),
    lagrangian = {
        let (upper, lower) = (first_velocity.x, second_velocity.x);
        let between = first.inverse() * second;
        let kinetic = upper.powi(2) + lower.powi(2) / 2.0 + upper * lower * between.cos_angle();
        kinetic + gravity * (2.0 * first.cos_angle() + second.cos_angle())
    },
    retractions(Cayley),
)]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Links {
    pub(crate) gravity: f64,
}

/// An accelerometer that feels what carries it, and gravity, which cancels that.
#[lie_poisson_system(
    group = SE2(3),
    control(gyroscope: R3, accelerometer: R3),
    hamiltonian = {
        let attitude = element.fixed_view::<3, 3>(0, 0);
        let velocity = element.fixed_view::<3, 1>(0, 3);
        momentum.fixed_rows::<3>(0).dot(&gyroscope)
            + momentum.fixed_rows::<3>(3).dot(&(accelerometer + attitude.tr_mul(&gravity)))
            + momentum.fixed_rows::<3>(6).dot(&attitude.tr_mul(&velocity))
    },
    retractions(Cayley),
)]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sensors {
    pub(crate) gravity: Vector3<f64>,
}
