//! Velocities that are small differences of large momenta: a body that is at rest, or nearly, while its rotor or its
//! wheels spin.

use coadjoint::__private::RetractionKind;
use coadjoint::Discretized;
use coadjoint::Scheme;
use coadjoint::nalgebra::{ArrayStorage, Matrix3};
use coadjoint::prelude::*;
use coadjoint::{Run, erased};
use coadjoint_app::Example;
use coadjoint_support::random::Random;
use coadjoint_systems::satellite_with_wheels::{SatelliteWithWheels, SatelliteWithWheelsState};

use crate::campaign::Subject;
use crate::runs::{Runs, scheme, steer, walk};

/// A body with a rotor whose angular momentum stays as it is.
#[lie_poisson_system(
    group = SO3,
    hamiltonian = {
        let body = momentum - rotor;
        body.dot(&(inertia.try_inverse().expect("regular") * body)) / 2.0
    },
    methods(Midpoint),
    derivatives(state),
)]
struct Gyrostat {
    #[inertia]
    inertia: Matrix3<f64>,
    rotor: Vector3<f64>,
}

/// The same in single precision.
#[lie_poisson_system(
    group = SO3,
    hamiltonian = {
        let body = momentum - rotor;
        body.dot(&(inertia.try_inverse().expect("regular") * body)) / 2.0
    },
)]
struct Cubesat {
    #[inertia]
    inertia: Matrix3<f32>,
    rotor: Vector3<f32>,
}

/// A satellite with three wheels that are bodies of their own.
#[lie_poisson_system(
    group(attitude: SO3, wheels: [SO2; 3]),
    control(torque: R3),
    hamiltonian = {
        let spin = vector![wheels_momentum[0].x, wheels_momentum[1].x, wheels_momentum[2].x];
        let body = attitude_momentum - spin;
        body.dot(&(inertia.try_inverse().expect("regular") * body)) / 2.0 + spin.norm_squared() / (2.0 * wheel)
    },
    force(wheels = [vector![torque.x], vector![torque.y], vector![torque.z]]),
    methods(Midpoint),
    derivatives(state),
)]
struct Wheeled {
    #[inertia]
    inertia: Matrix3<f64>,
    wheel: f64,
}

/// A satellite whose wheels' angles are one vector.
#[lie_poisson_system(
    group(attitude: SO3, wheels: R3),
    control(motors: R3),
    hamiltonian = {
        let body = attitude_momentum - wheels_momentum;
        body.dot(&body.component_div(&inertia)) / 2.0 + wheels_momentum.norm_squared() / (2.0 * wheel)
    },
    force(wheels = motors),
)]
struct Pointing {
    #[inertia]
    inertia: Vector3<f64>,
    #[inertia]
    wheel: f64,
}

/// Of the rotor, or of the wheels, N m s.
const SPIN: Vector3<f64> = vector![13.1, -7.7, 21.3];

/// kg m².
const INERTIA: Matrix3<f64> =
    Matrix3::from_array_storage(ArrayStorage([[60.0, 1.0, -2.0], [1.0, 80.0, 0.5], [-2.0, 0.5, 100.0]]));

/// Between its least and its largest moment, kg m².
const MOMENTS: (f64, f64) = (59.0, 101.0);

/// How far so many steps may be off in the angular velocity, rad/s: each is off by some units in the last place of the
/// momentum, one way or the other.
fn rounding(steps: u64) -> f64 {
    8.0 * f64::EPSILON * SPIN.norm() / MOMENTS.0 * (steps as f64).sqrt()
}

/// A gyrostat that turns by 1e-3 … 1e-12 rad/s. To first order `𝓘 ω̇ = ℓ × ω`: the part of `ω` along `ℓ` stays, and the
/// rest goes round with the frequency `ν² = ℓ·𝓘ℓ/det 𝓘`. So the body turns by the first part times the time, and by
/// what the other comes to in half a period.
fn turns_slowly<M>()
where
    Gyrostat: Discretized<M>,
{
    const STEPS: u64 = 2_000;
    let gyrostat = Gyrostat { inertia: INERTIA, rotor: SPIN };
    let frequency = (SPIN.dot(&(INERTIA * SPIN)) / INERTIA.determinant()).sqrt();
    let energy = |rate: &Vector3<f64>| rate.dot(&(INERTIA * rate));
    let back = INERTIA.try_inverse().expect("it is regular");
    let mut runs = Runs::default();
    for rate in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12] {
        for step in [0.01, 0.1, 1.0] {
            let mut random = Random::new(3);
            for direction in 0..20 {
                let what = format!("{}, {rate:e} rad/s, step {step}, direction {direction}", scheme::<M>());
                let turning = rate * random.direction();
                let momentum = SPIN + INERTIA * turning;
                let start = GyrostatState { attitude: UnitQuaternion::identity(), momentum };
                let Some(end) = runs.end(&what, walk::<M, _>(&gyrostat, &start, step, STEPS)) else {
                    continue;
                };

                let kept = end.attitude * end.momentum - momentum;
                runs.close(format!("{what}, momentum"), kept.norm(), 0.0, 1e-14 * STEPS as f64);
                let now = back * (end.momentum - SPIN);
                let (speed, should) = (energy(&now).sqrt(), energy(&turning).sqrt());
                let off = rounding(STEPS) * MOMENTS.1.sqrt();
                runs.close(format!("{what}, speed"), speed, should, 0.05 * should + off);
                let time = step * STEPS as f64;
                // beyond it, rotations do not add up
                if rate * time > 0.02 {
                    continue;
                }
                let along = SPIN * (SPIN.dot(&(INERTIA * turning)) / SPIN.dot(&(INERTIA * SPIN)));
                let to_and_fro = 2.0 * should / MOMENTS.0.sqrt() / frequency;
                let bound = 1.05 * to_and_fro + 3.0 * (rate * time).powi(2) + rounding(STEPS) * time;
                let off = (end.attitude.scaled_axis() - along * time).norm();
                runs.close(format!("{what}, turned by"), off, 0.0, bound);
            }
        }
    }
    runs.assert();
}

#[test]
fn a_gyrostat_that_turns_slowly() {
    turns_slowly::<Exponential>();
}

#[test]
fn a_gyrostat_that_turns_slowly_by_the_cayley_map() {
    turns_slowly::<Cayley>();
}

#[test]
fn a_gyrostat_that_turns_slowly_by_the_midpoint_rule() {
    turns_slowly::<Midpoint>();
}

#[test]
fn a_gyrostat_that_turns_slowly_to_fourth_order() {
    turns_slowly::<Order4<Exponential>>();
}

/// The size of a hand, with the numbers of the board that steers it.
#[test]
fn a_cubesat_in_single_precision() {
    let inertia = matrix![0.03, 0.0005, -0.0002; 0.0005, 0.035, 0.0003; -0.0002, 0.0003, 0.006];
    let cubesat = Cubesat { inertia, rotor: vector![0.006, -0.004, 0.005] };
    let mut runs = Runs::default();
    for rate in [0.1, 1e-2, 1e-3, 1e-4, 1e-5] {
        for step in [0.01, 0.1, 0.5] {
            let mut random = Random::new(4);
            for direction in 0..20 {
                let what = format!("{rate:e} rad/s, step {step}, direction {direction}");
                let turning: Vector3<f32> = (rate * random.direction()).cast();
                let momentum = cubesat.rotor + inertia * turning;
                let start = CubesatState { attitude: UnitQuaternion::identity(), momentum };
                let end = walk::<Exponential, _>(&cubesat, &start, step, 2_000);
                let Some(end) = runs.end(&what, end) else { continue };
                let kept = (end.attitude * end.momentum - momentum).norm() / momentum.norm();
                runs.close(what, kept.into(), 0.0, 2_000.0 * f64::from(f32::EPSILON));
            }
        }
    }
    runs.assert();
}

/// With motors that do nothing, next to nothing, or all they can. What the wheels gain the body loses, and a body that
/// nothing turns stays.
fn stands_with_wheels<M>()
where
    Wheeled: Discretized<M>,
{
    const STEPS: u64 = 2_000;
    let satellite = Wheeled { inertia: INERTIA, wheel: 0.05 };
    let attitude = UnitQuaternion::new(vector![0.4, 0.1, 0.2]);
    let mut runs = Runs::default();
    for away in [0.0, 1e-16, 1e-13, 1e-9, 1e-4] {
        for step in [0.01, 0.1, 1.0] {
            for torque in [0.0, 1e-12, 0.01] {
                let what = format!("{}, off by {away:e}, step {step}, torque {torque:e}", scheme::<M>());
                let momentum = SPIN + away * vector![1.0, -1.0, 1.0];
                let start = WheeledState {
                    attitude,
                    attitude_momentum: momentum,
                    wheels: [UnitComplex::identity(); 3],
                    wheels_momentum: [vector![SPIN.x], vector![SPIN.y], vector![SPIN.z]],
                };
                let held = WheeledControl { torque: vector![torque, 0.0, 0.0] };
                let end = steer::<M, _>(&satellite, &start, (step, STEPS), |_, _| held);
                let Some(end) = runs.end(&what, end) else { continue };
                let kept = end.attitude * end.attitude_momentum - attitude * momentum;
                runs.close(format!("{what}, momentum"), kept.norm(), 0.0, 1e-14 * STEPS as f64);
                let time = step * STEPS as f64;
                let gained = end.wheels_momentum[0].x - SPIN.x - torque * time;
                // what is added over and over is rounded alike
                let off = 1e-14 * STEPS as f64 + 1e-13 * torque * time;
                runs.close(format!("{what}, wheel"), gained, 0.0, off);
                if torque < 0.01 {
                    // no faster than all that pushes it would make it, were the spin not there
                    let rate = (2.0 * away + torque * time) / MOMENTS.0 + rounding(STEPS);
                    runs.close(
                        format!("{what}, turned by"),
                        end.attitude.angle_to(&attitude),
                        0.0,
                        2.0 * rate * time,
                    );
                }
            }
        }
    }
    runs.assert();
}

#[test]
fn a_satellite_stands_while_its_wheels_spin() {
    stands_with_wheels::<Exponential>();
}

#[test]
fn a_satellite_stands_while_its_wheels_spin_by_the_midpoint_rule() {
    stands_with_wheels::<Midpoint>();
}

#[test]
fn a_satellite_stands_while_its_wheels_spin_to_fourth_order() {
    stands_with_wheels::<Order4<Exponential>>();
}

/// Turned to a target by its motors and held there: it stays.
#[test]
fn a_satellite_holds_its_target() {
    let satellite = Pointing { inertia: vector![12.0, 14.0, 9.0], wheel: 2e-3 };
    let target = UnitQuaternion::new(60_f64.to_radians() * vector![0.6, 0.0, 0.8]);
    let rate = |state: &PointingState| {
        (state.attitude_momentum - state.wheels_momentum).component_div(&satellite.inertia)
    };
    let mut runs = Runs::default();
    for spin in [vector![0.03, -0.05, 0.04], vector![1.0, -2.0, 4.0]] {
        for (step, time) in [(0.1, 3_000.0), (0.5, 20_000.0), (1.0, 20_000.0)] {
            let what = format!("wheels of {:?}, step {step}", spin.as_slice());
            let start = PointingState {
                attitude: UnitQuaternion::identity(),
                attitude_momentum: spin,
                wheels: Vector3::zeros(),
                wheels_momentum: spin,
            };
            let law = |state: &PointingState, _| {
                let turn = 0.02 * (target.inverse() * state.attitude).scaled_axis() + 0.2 * rate(state);
                PointingControl { motors: turn.component_mul(&satellite.inertia) }
            };
            let end = steer::<Exponential, _>(&satellite, &start, (step, (time / step) as u64), law);
            let Some(end) = runs.end(&what, end) else { continue };
            runs.close(format!("{what}, off target"), end.attitude.angle_to(&target), 0.0, 1e-12);
            let kept = end.attitude * end.attitude_momentum - spin;
            runs.close(format!("{what}, momentum"), kept.norm(), 0.0, 1e-11 * spin.norm());
        }
    }
    runs.assert();
}

/// The catalogue's, with its own law, for a million seconds: eleven and a half days. With its type erased, its steps are
/// those that are compiled with the catalogue.
#[test]
fn the_catalogues_satellite_points_for_days() {
    let (satellite, start) = SatelliteWithWheels::example();
    let (own, standard) =
        (SatelliteWithWheels::wheels(&start), Scheme::Standard(RetractionKind::Exponential));
    let midpoint = Scheme::member(RetractionKind::Exponential, 1, 2);
    let law = |state: &Vec<f64>, _: f64| {
        let components = state[..].try_into().expect("it is one of this system");
        let state = SatelliteWithWheelsState::from_components(components);
        satellite.slew(&state).torque.as_slice().to_vec()
    };
    let mut runs = Runs::default();
    for (spin, scheme, step, time) in [
        (own, &standard, 0.1, 1e6),
        (own, &standard, 0.5, 1e6),
        (own, &standard, 1.0, 1e6),
        (vector![6.0, -9.0, 4.0], &standard, 1.0, 1e5),
        (SPIN, &standard, 0.1, 1e5),
        (SPIN, &midpoint, 0.5, 1e5),
    ] {
        let what = format!("{scheme}, wheels of {:?}, step {step}", spin.as_slice());
        let mut state = SatelliteWithWheels::at_rest(start.attitude, spin).to_components().to_vec();
        let mut stepper =
            erased::Stepper::new(erased::System::with_parameters(&satellite, &[]), scheme, step)
                .expect("a stepper");
        // not-a-number until it was looked at
        let mut farthest = f64::NAN;
        let run = Run::new(&mut stepper, &mut state).controlled_by(law).every(1_000, |sample| {
            let &[_, x, y, z, ..] = &sample.state[..] else { unreachable!("an attitude") };
            let off = 2.0 * x.hypot(y).hypot(z);
            // an hour is enough to turn it
            if sample.time >= 3_600.0 && !(off <= farthest) {
                farthest = off;
            }
        });
        runs.end(&what, run.steps((time / step) as u64));
        runs.close(format!("{what}, off target"), farthest, 0.0, 1e-12);
    }
    runs.assert();
}

/// For the [campaign](crate::campaign).
pub(crate) fn subjects() -> Vec<Subject> {
    vec![
        Subject::of(
            Gyrostat { inertia: INERTIA, rotor: SPIN },
            &GyrostatState { attitude: UnitQuaternion::identity(), momentum: vector![3.0, -7.0, 20.0] },
        ),
        Subject::of(
            Pointing { inertia: vector![12.0, 14.0, 9.0], wheel: 2e-3 },
            &PointingState {
                attitude: UnitQuaternion::identity(),
                attitude_momentum: vector![0.3, -0.2, 0.5],
                wheels: Vector3::zeros(),
                wheels_momentum: vector![0.2, -0.4, 0.3],
            },
        ),
    ]
}
