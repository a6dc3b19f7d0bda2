//! Potentials of all kinds, as one naturally writes them, without a warning.

#![deny(warnings)]
// of our own lints; users have none of them
#![allow(missing_docs, unreachable_pub)]

use std::f64::consts;

use coadjoint::prelude::*;

const GRAVITY: f64 = 9.80665;

mod units {
    pub const GRAM: f64 = 1e-3;
}

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3, delta: R3),
    potential = {
        let mass: f64 = self::units::GRAM * grams;
        let arm = frame * lever + Vector3::new(0.0, 0.0, 1e-3);
        let (sine, cosine) = (consts::PI * gamma.x).sin_cos();
        let spring = 0.5 * stiffness * (gamma.cross(&delta) - vector![sine, cosine, 1.0]).norm_squared();
        mass * GRAVITY * gamma.dot(&arm) + spring / f64::from(2) + delta[1].powi(4)
    },
)]
pub struct Top {
    #[inertia]
    pub inertia: Matrix3<f64>,
    pub grams: f64,
    pub stiffness: f64,
    pub lever: Vector3<f64>,
    pub frame: Matrix3<f64>,
}

#[lie_poisson_system(
    group(magnets: [SO2; 2], frame: R2),
    advected(marks: magnets::R2),
    control(motors: [f64; 2]),
    potential = {
        let pairs = (0..1).map(|i| (magnets[i].angle() - magnets[i + 1].angle()).cos()).sum::<f64>();
        let ends: Vector2<f64> = marks.iter().zip(&lengths).map(|(mark, length)| mark * *length).sum();
        pairs + ends.dot(&frame)
    },
    force(magnets[0] = motors[0], magnets[1] = motors[1] - lengths[0] * magnets_velocity[1].x),
    retractions(Cayley),
)]
pub struct Magnets {
    #[inertia(magnets)]
    pub inertia: [f64; 2],
    #[inertia(frame)]
    pub mass: f64,
    pub lengths: [f64; 2],
}

#[lie_poisson_system(group = SO3)]
struct FreeBody {
    #[inertia]
    inertia: Vector3<f64>,
}

// a block in front of an operator, and a raw name
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = { let z = gamma.z; z * z } * r#type)]
struct Raw {
    #[inertia]
    inertia: f64,
    r#type: f64,
}

// factors, configurations, controls, velocities and the time
#[lie_poisson_system(
    group(first: SO3, spot: R(2)),
    advected(gamma: first::R3),
    potential = (first * gamma).z * spot.x + first.inverse().transform_vector(&gamma).y * t.cos(),
    control(push: R2, gain: f64),
    force(spot = gain * push - t * spot_velocity, first = gain * first_momentum.cross(&gamma)),
)]
struct Pair {
    #[inertia(first)]
    inertia: f64,
    #[inertia(spot)]
    mass: f64,
}

// parts of momenta, points, inverse matrices, and an inertia that is a parameter
#[lie_poisson_system(
    group = SE3,
    hamiltonian = angular_momentum.dot(&(inertia.try_inverse().expect("a regular matrix") * angular_momentum)) / 2.0
        + linear_momentum.norm_squared() / (2.0 * mass)
        + pose.transform_point(&Point3::from(arm)).z,
    force = (-drag * angular_velocity, -drag * linear_velocity),
)]
struct Hull {
    #[inertia]
    inertia: Matrix3<f64>,
    mass: f64,
    arm: Vector3<f64>,
    drag: f64,
    // for the picture
    #[allow(deprecated)]
    length: f64,
}

fn main() {
    let top = Top {
        inertia: Matrix3::from_diagonal(&vector![1.0, 2.0, 3.0]),
        grams: 100.0,
        stiffness: 2.0,
        lever: Vector3::z(),
        frame: Matrix3::identity(),
    };
    let (gamma, delta) = (Vector3::z(), Vector3::x());
    let state = TopState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros(), gamma, delta };
    // at rest, the energy is the potential: as derived, and as rustc compiled it
    let difference = top.energy(&state) - top.potential(&state);
    assert!(difference.abs() < 1e-14, "{difference}");
    FreeBody { inertia: vector![1.0, 2.0, 3.0] }.stepper::<Cayley>(0.1).expect("a body");
    let raw = Raw { inertia: 1.0, r#type: 2.0 };
    let state =
        RawState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros(), gamma: Vector3::z() };
    assert_eq!(raw.potential(&state), 2.0);
    let pair = PairState {
        first: UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3),
        first_momentum: Vector3::x(),
        spot: vector![0.1, 0.2],
        spot_momentum: vector![0.3, 0.4],
        gamma: Vector3::y(),
    };
    let control = PairControl { push: vector![1.0, 2.0], gain: 3.0 };
    let push = Pair { inertia: 1.0, mass: 2.0 }.force_spot(&pair, &control, 0.5);
    assert!((push - (vector![1.0, 2.0] * 3.0 - vector![0.15, 0.2] * 0.5)).norm() < 1e-15, "{push}");
    let hull = Hull {
        inertia: matrix![2.0, 0.1, 0.0; 0.1, 3.0, 0.0; 0.0, 0.0, 4.0],
        mass: 2.0,
        arm: Vector3::x(),
        drag: 0.5,
        length: 3.0,
    };
    let state = HullState {
        pose: Isometry3::new(vector![0.0, 0.0, 0.7], vector![0.0, 0.2, 0.0]),
        momentum: vector![0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
    };
    let difference = hull.energy(&state) - hull.hamiltonian(&state);
    assert!(difference.abs() < 1e-14, "{difference}");
    let (moment, push) = hull.force(&state);
    assert!(
        (push + vector![0.1, 0.125, 0.15]).norm() < 1e-15 && moment.z == -0.5 * 0.3 / 4.0,
        "{moment} {push}"
    );
    assert_eq!(hull.length, 3.0);
}
