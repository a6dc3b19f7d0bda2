//! The systems of the catalogue described once more, with derivatives: nothing that runs them needs these, and so the catalogue has none.

use std::f64::consts::PI;

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
    methods(Midpoint), retractions(Exponential), derivatives,
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
    methods(Midpoint), retractions(Cayley), derivatives,
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

#[lie_poisson_system(group = SO3, methods(Midpoint), retractions(Exponential), derivatives)]
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
    methods(Midpoint), retractions(Cayley), derivatives,
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
    methods(Midpoint), retractions(Cayley), derivatives,
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
    methods(Midpoint), retractions(Exponential), derivatives,
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
    methods(Midpoint), retractions(Cayley), derivatives,
)]
pub(super) struct Kirchhoff {
    pub(super) inertia: Vector3<f64>,
    pub(super) mass: Vector3<f64>,
    pub(super) screw: Vector3<f64>,
}

#[lie_poisson_system(
    group = GL(2),
    lagrangian = {
        let rate = element * matrix![velocity[0], velocity[1]; velocity[2], velocity[3]];
        let moment = mass * radius.powi(2) / 4.0;
        let dilation = element.determinant().ln();
        let shape = shear_modulus / 2.0 * (element.norm_squared() - 2.0 - 2.0 * dilation);
        let strain = shape + lame_modulus / 2.0 * dilation.powi(2);
        moment / 2.0 * rate.norm_squared() - PI * radius.powi(2) * strain
    },
    retractions(Cayley), derivatives(state, controls, parameters),
)]
pub(super) struct AffineBody {
    pub(super) mass: f64,
    pub(super) radius: f64,
    pub(super) shear_modulus: f64,
    pub(super) lame_modulus: f64,
}

#[lie_poisson_system(
    group = SO(4),
    hamiltonian = {
        let moments = Vector6::new(
            second_moments.x + second_moments.y,
            second_moments.x + second_moments.z,
            second_moments.x + second_moments.w,
            second_moments.y + second_moments.z,
            second_moments.y + second_moments.w,
            second_moments.z + second_moments.w,
        );
        momentum.dot(&momentum.component_div(&moments)) / 2.0
    },
    retractions(Cayley), derivatives(state, controls, parameters),
)]
pub(super) struct FourDimensionalBody {
    #[inertia]
    pub(super) second_moments: Vector4<f64>,
}

#[lie_poisson_system(
    group = SE2(3),
    control(gyroscope: R3, accelerometer: R3),
    hamiltonian = {
        let attitude = element.fixed_view::<3, 3>(0, 0);
        let velocity = element.fixed_view::<3, 1>(0, 3);
        let of_attitude = momentum.fixed_rows::<3>(0);
        let of_velocity = momentum.fixed_rows::<3>(3);
        let of_position = momentum.fixed_rows::<3>(6);
        let dead_reckoning = of_attitude.dot(&gyroscope)
            + of_velocity.dot(&(accelerometer + attitude.tr_mul(&gravity)))
            + of_position.dot(&attitude.tr_mul(&velocity));
        dead_reckoning + gyroscope_noise / 2.0 * of_attitude.norm_squared()
            + accelerometer_noise / 2.0 * of_velocity.norm_squared()
    },
    retractions(Cayley), derivatives(state, controls, parameters),
)]
pub(super) struct Navigation {
    pub(super) gravity: Vector3<f64>,
    pub(super) gyroscope_noise: f64,
    pub(super) accelerometer_noise: f64,
}

#[lie_poisson_system(
    group(attitude: SO3, wheel_x: SO2, wheel_y: SO2, wheel_z: SO2),
    control(torque: R3),
    hamiltonian = {
        let wheels = vector![wheel_x_momentum.x, wheel_y_momentum.x, wheel_z_momentum.x];
        let of_satellite = attitude_momentum - wheels;
        of_satellite.dot(&of_satellite.component_div(&inertia)) / 2.0 + wheels.norm_squared() / (2.0 * wheel_inertia)
    },
    force(wheel_x = torque.x, wheel_y = torque.y, wheel_z = torque.z),
    methods(Midpoint), retractions(Exponential), derivatives,
)]
pub(super) struct SatelliteWithWheels {
    #[inertia]
    pub(super) inertia: Vector3<f64>,
    #[inertia]
    pub(super) wheel_inertia: f64,
}

#[lie_poisson_system(
    group(spins: [SO3; 4]),
    invariance = right,
    hamiltonian = {
        let neighbours = spins_momentum.windows(2).map(|pair| pair[0].dot(&pair[1])).sum::<f64>();
        let total = spins_momentum.iter().sum::<Vector3<f64>>();
        -exchange * neighbours - field.dot(&total)
    },
    methods(Midpoint), retractions(Cayley), derivatives,
)]
pub(super) struct SpinChain {
    pub(super) exchange: f64,
    pub(super) field: Vector3<f64>,
}

#[lie_poisson_system(
    group = SU(3),
    invariance = right,
    hamiltonian = {
        let since = (t - middle) / width;
        let apart = delay / (2.0 * width);
        let pump = pump * (-(since - apart).powi(2)).exp();
        let stokes = stokes * (-(since + apart).powi(2)).exp();
        // of −iH without its trace, in the axes of the algebra
        -(pump * momentum[0] + stokes * momentum[4]) / 2.0
            + detuning * (momentum[6] - momentum[7]) / 3.0
            + two_photon_detuning * (momentum[6] + 2.0 * momentum[7]) / 3.0
    },
    retractions(Exponential), derivatives(state, controls, parameters),
)]
pub(super) struct ThreeLevelAtom {
    pub(super) pump: f64,
    pub(super) stokes: f64,
    pub(super) delay: f64,
    pub(super) width: f64,
    pub(super) middle: f64,
    pub(super) detuning: f64,
    pub(super) two_photon_detuning: f64,
}
