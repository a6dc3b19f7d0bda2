//! Motions whose ends others have reported: benchmarks of multibody codes and the tests of packages for spacecraft, to the digits that they tell.

use coadjoint::Run;
use coadjoint::prelude::*;

use crate::runs::Runs;

/// A top with principal moments along its axes.
#[lie_poisson_system(group = SO3, advected(up: R3), potential = weight * up.dot(&arm))]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    arm: Vector3<f64>,
}

/// The fast top that multibody codes are compared with: 15 kg, 150 rad/s, after two seconds. Its reference is good to 5e-4.
#[test]
fn a_fast_top() {
    let mut runs = Runs::default();
    let top = Top {
        inertia: vector![15.234_375, 0.468_75, 15.234_375],
        weight: 15.0 * 9.81,
        arm: vector![0.0, 1.0, 0.0],
    };
    let momentum = vector![0.0, 150.0, -4.61538].component_mul(&top.inertia);
    let mut state = TopState { attitude: UnitQuaternion::identity(), momentum, up: Vector3::z() };
    let mut stepper = top.stepper::<Order6<Exponential>>(1e-3).expect("a stepper");
    let mut end = |time: f64| {
        Run::new(&mut stepper, &mut state).to(time).expect("it turns");
        let q = state.attitude;
        [q.w, q.i, q.j, q.k]
    };
    runs.all_close("at 0.2 s", &end(0.2), &[-0.70828, 0.43878, 0.54573, 0.08940], 5e-6);
    let reported = [0.122_947_3, -0.491_079_4, 0.350_430_8, -0.787_986_9];
    runs.all_close("at 2 s", &end(2.0), &reported, 1e-6);
    runs.assert();
}

/// A tumbling brick, a check case of NASA's: its rates after half a minute, in degrees per second, by two of their simulations.
#[test]
fn a_tumbling_brick() {
    let mut runs = Runs::default();
    // from slug ft²
    let inertia = vector![0.001_894_220, 0.006_211_019, 0.007_194_665] * 1.355_817_948_331_400_4;
    let brick = Top { inertia, weight: 0.0, arm: Vector3::zeros() };
    let degree = 1_f64.to_radians();
    let momentum = vector![10.0, 20.0, 30.0].component_mul(&inertia) * degree;
    let mut state = TopState { attitude: UnitQuaternion::identity(), momentum, up: Vector3::z() };
    let mut stepper = brick.stepper::<Order6<Exponential>>(0.1).expect("a stepper");
    Run::new(&mut stepper, &mut state).to(30.0).expect("it tumbles");
    let rates = state.momentum.component_div(&inertia) / degree;
    runs.all_close("rates", rates.as_slice(), &[12.618_390_776, -17.397_474_762, 31.119_588_887], 2e-9);
    runs.assert();
}

/// A hub with three wheels along its axes, with a torque on each for half a second.
#[lie_poisson_system(
    group(attitude: SO3, wheels: [SO2; 3]),
    control(torque: R3),
    hamiltonian = {
        let spin = vector![wheels_momentum[0].x, wheels_momentum[1].x, wheels_momentum[2].x];
        let hub = attitude_momentum - spin;
        hub.dot(&hub.component_div(&inertia)) / 2.0 + spin.norm_squared() / (2.0 * wheel)
    },
    force(wheels = [vector![torque.x], vector![torque.y], vector![torque.z]]),
)]
struct Craft {
    inertia: Vector3<f64>,
    wheel: f64,
}

/// Modified Rodrigues parameters after a second, as Basilisk's test has them.
#[test]
fn balanced_wheels() {
    let mut runs = Runs::default();
    let turn = std::f64::consts::TAU / 60.0;
    let wheel = 100.0 / (6000.0 * turn);
    // theirs holds the wheels' too
    let inertia = vector![900.0, 800.0, 600.0] - Vector3::repeat(wheel);
    let rate = vector![0.08, 0.01, 0.0];
    let spin = wheel * (rate + vector![500.0, 200.0, -150.0] * turn);
    let mut state = CraftState {
        attitude: UnitQuaternion::identity(),
        attitude_momentum: inertia.component_mul(&rate) + spin,
        wheels: [UnitComplex::identity(); 3],
        wheels_momentum: [vector![spin.x], vector![spin.y], vector![spin.z]],
    };
    let mut stepper = Craft { inertia, wheel }.stepper::<Order4<Exponential>>(0.1).expect("a stepper");
    for (torque, until) in [(vector![0.2, 0.1, -0.2], 0.5), (Vector3::zeros(), 1.0)] {
        let law = |_: &CraftState, _| CraftControl { torque };
        Run::new(&mut stepper, &mut state).controlled_by(law).to(until).expect("it turns");
    }
    let parameters = state.attitude.imag() / (1.0 + state.attitude.w);
    for (k, reported) in [1.998_539_94e-2, 2.456_477_16e-3, 8.453_562_79e-6].into_iter().enumerate() {
        runs.close(format!("parameter {k}"), parameters[k] / reported, 1.0, 3e-9);
    }
    runs.assert();
}

/// Two vortices whose plane is curved, in coordinates that are canonical.
#[lie_poisson_system(
    group = R2,
    hamiltonian = {
        let (y, other) = (momentum.x / strength, momentum.y / strength);
        let first = 0.5 + 0.5 * (1.0 + 4.0 * (position.x.powi(2) + y.powi(2))).sqrt();
        let second = 0.5 + 0.5 * (1.0 + 4.0 * (position.y.powi(2) + other.powi(2))).sqrt();
        let across = position.x / first.sqrt() - position.y / second.sqrt();
        let along = y / first.sqrt() - other / second.sqrt();
        strength * strength * first * second * (across.powi(2) + along.powi(2)).ln() / (2.0 * std::f64::consts::PI)
    },
)]
struct Vortices {
    strength: f64,
}

/// Where GeometricProblems.jl has them, mirrored: its own error is that of a method of order 2.
#[test]
fn vortices_in_a_curved_plane() {
    let mut runs = Runs::default();
    let root = 1.26_f64.sqrt();
    let mut state = VorticesState {
        position: vector![0.5 * root, 0.5 * root],
        momentum: vector![0.05 * root, -0.05 * root],
    };
    let vortices = Vortices { strength: 0.5 };
    let mut stepper = vortices.stepper::<Order6<Exponential>>(0.01).expect("a stepper");
    Run::new(&mut stepper, &mut state).to(10.0).expect("they go round");
    let at = |x: f64, momentum: f64| {
        let y = momentum / vortices.strength;
        let root = (0.5 + 0.5 * (1.0 + 4.0 * (x * x + y * y)).sqrt()).sqrt();
        [x / root, y / root]
    };
    let found = [at(state.position.x, state.momentum.x), at(state.position.y, state.momentum.y)].concat();
    let reported = [0.381_253_329, -0.425_802_060, 0.187_225_293, -0.389_674_325];
    runs.all_close("places", &found, &reported, 1e-7);
    runs.assert();
}
