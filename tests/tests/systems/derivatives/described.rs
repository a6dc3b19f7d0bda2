//! The systems of the catalogue described once more, with derivatives: nothing that runs them needs these, and so the catalogue has none.

use coadjoint::prelude::*;

#[lie_poisson_system(
    group = R1,
    potential = 0.5 * stiffness * position.norm_squared(),
    methods(Midpoint), derivatives,
)]
pub(super) struct HarmonicOscillator {
    #[inertia]
    pub(super) mass: f64,
    pub(super) stiffness: f64,
}

#[lie_poisson_system(
    group = R3,
    potential = -attraction * mass / position.norm(),
    methods(Midpoint), derivatives,
)]
pub(super) struct Kepler {
    #[inertia]
    pub(super) mass: f64,
    pub(super) attraction: f64,
}

#[lie_poisson_system(
    group = SO2,
    potential = weight * length * (1.0 - angle.cos_angle()),
    methods(Midpoint), derivatives,
)]
pub(super) struct PlanarPendulum {
    #[inertia]
    pub(super) inertia: f64,
    pub(super) weight: f64,
    pub(super) length: f64,
}

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * length * gamma.z,
    methods(Midpoint), derivatives,
)]
pub(super) struct SphericalPendulum {
    #[inertia]
    pub(super) inertia: Vector3<f64>,
    pub(super) weight: f64,
    pub(super) length: f64,
}

#[lie_poisson_system(group = SO3, methods(Midpoint), derivatives)]
pub(super) struct FreeRigidBody {
    #[inertia]
    pub(super) inertia: Vector3<f64>,
}

#[lie_poisson_system(group = SO3, methods(Midpoint), derivatives)]
pub(super) struct FullRigidBody {
    #[inertia]
    pub(super) inertia: Matrix3<f64>,
}

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
    methods(Midpoint), derivatives,
)]
pub(super) struct HeavyTop {
    #[inertia]
    pub(super) inertia: Vector3<f64>,
    pub(super) weight: f64,
    pub(super) chi: Vector3<f64>,
}

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3, field: R3),
    potential = weight * gamma.dot(&chi) - field.dot(&dipole),
    methods(Midpoint), derivatives,
)]
pub(super) struct MagneticTop {
    #[inertia]
    pub(super) inertia: Vector3<f64>,
    pub(super) weight: f64,
    pub(super) chi: Vector3<f64>,
    pub(super) dipole: Vector3<f64>,
}

#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(attitude = moment, position = attitude * (thrust * Vector3::z())),
    methods(Midpoint), derivatives,
)]
pub(super) struct Quadrotor {
    #[inertia(attitude)]
    pub(super) inertia: Vector3<f64>,
    #[inertia(position)]
    pub(super) mass: f64,
    pub(super) gravity: f64,
}

#[lie_poisson_system(group = SE3, methods(Midpoint), derivatives)]
pub(super) struct RigidBodyInSpace {
    #[inertia]
    pub(super) inertia: Matrix6<f64>,
}

#[lie_poisson_system(
    group(attitude: SO3, rotor: SO2),
    hamiltonian = {
        let of_body = attitude_momentum - rotor_momentum.x * axis;
        0.5 * of_body.dot(&of_body.component_div(&inertia)) + rotor_momentum.norm_squared() / (2.0 * rotor_inertia)
    },
    methods(Midpoint), derivatives,
)]
pub(super) struct Gyrostat {
    pub(super) inertia: Vector3<f64>,
    pub(super) rotor_inertia: f64,
    pub(super) axis: Vector3<f64>,
}

#[lie_poisson_system(
    group(first: SO3, second: SO3),
    potential = {
        let between = first.inverse() * second;
        2.0 * stiffness * (1.0 - between.w.powi(2))
    },
    methods(Midpoint), derivatives,
)]
pub(super) struct CoupledBodies {
    #[inertia(first)]
    pub(super) first_inertia: Vector3<f64>,
    #[inertia(second)]
    pub(super) second_inertia: Vector3<f64>,
    pub(super) stiffness: f64,
}

#[lie_poisson_system(
    group = SO3,
    advected(impulse: R3),
    hamiltonian = 0.5 * momentum.dot(&momentum.component_div(&inertia))
        + momentum.dot(&impulse.component_mul(&screw))
        + 0.5 * impulse.dot(&impulse.component_div(&mass)),
    methods(Midpoint), derivatives,
)]
pub(super) struct Kirchhoff {
    pub(super) inertia: Vector3<f64>,
    pub(super) mass: Vector3<f64>,
    pub(super) screw: Vector3<f64>,
}
