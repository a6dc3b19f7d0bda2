//! A system on a group of matrices, with one retraction and sensors as controls: inertial navigation.

use crate::case::{Case, long, one_by_one};
use coadjoint::prelude::*;

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
    retractions(Cayley),
)]
#[derive(Clone, Debug, PartialEq)]
struct Navigation {
    gravity: Vector3<f64>,
    gyroscope_noise: f64,
    accelerometer_noise: f64,
}

pub(crate) fn cases() -> Vec<Case> {
    let navigation =
        Navigation { gravity: vector![0.0, 0.0, -9.81], gyroscope_noise: 1e-6, accelerometer_noise: 1e-4 };
    let mut element = SMatrix::<f64, 5, 5>::identity();
    element[(0, 3)] = 20.0;
    let momentum = SVector::<f64, 9>::from_fn(|k, _| 0.1 * (k as f64 + 1.0).sin());
    let state = NavigationState { element, momentum };
    let control =
        NavigationControl { gyroscope: vector![0.0, 0.0, 0.1], accelerometer: vector![0.0, 2.0, 9.81] };
    let stepper = || navigation.stepper::<Cayley>(0.01).expect("a system that can be stepped");
    // no longer: its state grows
    let mut cases = vec![long("navigation, Cayley", stepper(), &state, &control, 8_000)];
    for (jumps, size) in [("0", 0.0), ("0.1", 0.1)] {
        // from −1 to 1, and never twice in a row
        let scattered = move |step: u64, shift: f64| 2.0 * ((step as f64 * 0.618_034 + shift) % 1.0) - 1.0;
        let constant = control.clone();
        let jumping = move |step: u64| NavigationControl {
            gyroscope: constant.gyroscope
                + vector![0.0, 0.414, 0.828].map(|shift| size * scattered(step, shift)),
            accelerometer: constant.accelerometer
                + vector![0.2, 0.614, 0.028].map(|shift| size * scattered(step, shift)),
        };
        let name = format!("navigation, Cayley, jumps of {jumps}");
        cases.push(one_by_one(&name, stepper(), &state, jumping, 8_000));
    }
    cases
}
