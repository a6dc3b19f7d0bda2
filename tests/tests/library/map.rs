//! Every step is a map: its result depends on state, time, control and parameters alone, to rounding in each component's own units.

// a test that cannot go on is to say so
#![allow(clippy::unwrap_used)]

use coadjoint::Compensated;
use coadjoint::System;
use coadjoint::nalgebra::Isometry3;
use coadjoint::prelude::*;
use coadjoint::{Discretized, State};

/// A body in orbit, whose attitude feels where it is.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    potential = {
        let distance = position.norm();
        let below = attitude.inverse() * position;
        -strength / distance + couple * below.dot(&chi) / distance
    },
    methods(Midpoint),
)]
#[derive(Clone)]
struct Orbit {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    strength: f64,
    couple: f64,
    chi: Vector3<f64>,
}

/// Low around the Earth, with lengths in units of so many metres.
fn orbit(metres: f64) -> (Orbit, OrbitState) {
    let (per, square) = (1.0 / metres, 1.0 / (metres * metres));
    let system = Orbit {
        // energies are in units of kg (unit of length)²/s², and so is the moment of a body's attitude
        inertia: square * vector![100.0, 200.0, 250.0],
        mass: 1000.0,
        strength: 3.986e17 * per * square,
        couple: 0.05 * square,
        chi: vector![0.3, 0.2, 1.0],
    };
    let state = OrbitState {
        attitude: UnitQuaternion::identity(),
        position: per * vector![7e6, 0.0, 0.0],
        attitude_momentum: square * vector![0.1, 0.2, -0.2],
        position_momentum: per * vector![0.0, 7.5e6, 0.0],
    };
    (system, state)
}

/// The largest difference of two states in any of the parts of these lengths, in units of epsilon of its size.
fn off(parts: &[usize], a: &[f64], b: &[f64]) -> f64 {
    let (mut worst, mut from) = (0.0_f64, 0);
    for length in parts {
        let (x, y) = (&a[from..from + length], &b[from..from + length]);
        let size = y.iter().map(|y| y * y).sum::<f64>().sqrt();
        let distance = x.iter().zip(y).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt();
        if distance > 0.0 {
            worst = worst.max(distance / size / f64::EPSILON);
        }
        from += length;
    }
    worst
}

/// The largest error of warm steps against converged ones from the same states, over so many steps, in each part.
fn warm_error<S, M>(system: &S, start: &S::State, step: f64, steps: usize, parts: &[usize]) -> f64
where
    S: System<Scalar = f64> + Discretized<M> + Discretized<Compensated<M>>,
    S::State: Copy,
{
    let mut state = *start;
    let mut warm = system.stepper::<M>(step).unwrap();
    let mut worst = 0.0_f64;
    for _ in 0..steps {
        let mut converged = state;
        let mut cold = system.stepper::<Compensated<M>>(step).unwrap();
        cold.step(&mut converged).unwrap();
        warm.step(&mut state).unwrap();
        worst = worst.max(off(parts, state.to_components().as_ref(), converged.to_components().as_ref()));
    }
    worst
}

const ORBIT: [usize; 4] = [4, 3, 3, 3];

#[test]
fn an_orbit_is_solved_in_each_of_its_units() {
    for metres in [1.0, 1e-3, 1e3] {
        let (system, start) = orbit(metres);

        let midpoint = warm_error::<_, Midpoint>(&system, &start, 1.0, 300, &ORBIT);
        let verlet = warm_error::<_, StormerVerlet>(&system, &start, 1.0, 300, &ORBIT);
        assert!(midpoint < 8.0 && verlet < 8.0, "{metres}: {midpoint}, {verlet}");
    }
}

/// Steps there and back, each way with one stepper: how far the attitude and its momentum are from where they were.
fn there_and_back<M>(metres: f64, steps: u64) -> [f64; 2]
where
    Orbit: Discretized<M>,
{
    let (system, start) = orbit(metres);
    let mut state = start;
    for step in [1.0, -1.0] {
        let mut stepper = system.stepper::<M>(step).unwrap();
        stepper.steps_with(&mut state, &NoControl::default(), steps).unwrap();
    }
    let momentum = state.attitude_momentum - start.attitude_momentum;
    [state.attitude.angle_to(&start.attitude), momentum.norm() / start.attitude_momentum.norm()]
}

#[test]
fn an_orbit_goes_there_and_back() {
    for metres in [1.0, 1e-3, 1e3] {
        for [angle, momentum] in
            [there_and_back::<Midpoint>(metres, 100), there_and_back::<StormerVerlet>(metres, 100)]
        {
            assert!(angle < 1e-13 && momentum < 1e-12, "{metres}: {angle:e}, {momentum:e}");
        }
    }
}

/// The attitude of such a body alone, which is led around: of one scale.
#[lie_poisson_system(
    group = SO3,
    potential = {
        let below = vector![(rate * t).cos(), (rate * t).sin(), 0.0];
        couple * (attitude.inverse() * below).dot(&chi)
    },
    methods(Midpoint),
)]
#[derive(Clone)]
struct Led {
    #[inertia]
    inertia: Vector3<f64>,
    couple: f64,
    chi: Vector3<f64>,
    rate: f64,
}

/// How far warm steps and compensated ones are apart, in units of epsilon: in the first two parts after 3,000 steps, in all others after 20,000.
fn apart<S>(system: &S, start: &S::State, step: f64, parts: &[usize]) -> [f64; 2]
where
    S: System<Scalar = f64> + Discretized<Midpoint> + Discretized<Compensated<Midpoint>>,
    S::State: Copy,
{
    let (mut state, mut converged) = (*start, *start);
    let mut warm = system.stepper::<Midpoint>(step).unwrap();
    let mut compensated = system.stepper::<Compensated<Midpoint>>(step).unwrap();
    let first: usize = parts[..2].iter().sum();
    let all = S::Control::default();
    let mut after = |steps: u64| {
        warm.steps_with(&mut state, &all, steps).unwrap();
        compensated.steps_with(&mut converged, &all, steps).unwrap();
        let [is, should] = [&state, &converged].map(|state| state.to_components());
        let (is, should) = (is.as_ref(), should.as_ref());
        [off(&parts[..2], is, should), off(&parts[2..], &is[first..], &should[first..])]
    };
    [after(3_000)[0], after(17_000)[1]]
}

#[test]
fn an_orbit_stays_near_to_the_compensated_one() {
    // what one scale shows: the attitude alone, which after that is chaotic, and an orbit of which all numbers are of the size of 1
    let led = Led {
        inertia: vector![100.0, 200.0, 250.0],
        couple: 0.05,
        chi: vector![0.3, 0.2, 1.0],
        rate: 7.5e3 / 7e6,
    };
    let attitude = LedState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 0.2, -0.2] };
    let near = Orbit {
        inertia: vector![1.0, 2.0, 2.5],
        mass: 1.0,
        strength: 1.0,
        couple: 1e-3,
        chi: vector![0.3, 0.2, 1.0],
    };
    let position = OrbitState {
        attitude: UnitQuaternion::identity(),
        position: vector![1.0, 0.0, 0.0],
        attitude_momentum: vector![1e-3, 2e-3, -2e-3],
        position_momentum: vector![0.0, 1.0, 0.0],
    };
    let of_one_scale = [apart(&led, &attitude, 1.0, &[4, 3])[0], apart(&near, &position, 1e-3, &ORBIT)[1]];
    assert!(of_one_scale.iter().all(|x| *x < 1e4), "{of_one_scale:?}");
    for metres in [1.0, 1e-3, 1e3] {
        let (system, start) = orbit(metres);
        let apart = apart(&system, &start, 1.0, &ORBIT);
        for (apart, alone) in apart.iter().zip(of_one_scale) {
            assert!(*apart < 100.0 * alone, "{metres}: {apart} and {alone}");
        }
    }
}

/// Where so many steps lead to in these units of length, in metres.
fn walked(metres: f64, steps: u64) -> OrbitState {
    let (system, mut state) = orbit(metres);
    let mut stepper = system.stepper::<Midpoint>(1.0).unwrap();
    stepper.steps_with(&mut state, &NoControl::default(), steps).unwrap();
    state.position *= metres;
    state.position_momentum *= metres;
    state.attitude_momentum *= metres * metres;
    state
}

#[test]
fn units_by_powers_of_two_change_no_digit() {
    let here = walked(1.0, 2_000);
    for metres in [1024.0, 2_f64.powi(-20)] {
        assert!(walked(metres, 2_000) == here, "{metres}");
    }
}

#[test]
fn other_units_change_nothing_but_roundings() {
    for (steps, limit) in [(1, 8.0), (100, 100.0), (1_400, 1_000.0)] {
        let here = walked(1.0, steps);
        for metres in [1e-3, 0.3048, 1e3, 1.496e11] {
            let there = walked(metres, steps);
            let apart = off(&ORBIT, &there.to_components(), &here.to_components());
            assert!(apart < limit, "{steps} steps in units of {metres} m: {apart}");
        }
    }
}

/// A body in a fluid that takes its motion.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    force(attitude = -drag * attitude_velocity, position = -drag * position_velocity),
    methods(Midpoint)
)]
#[derive(Clone)]
struct Damped {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    drag: f64,
}

/// Steps until it rests; none may be off while there is a momentum of this size.
fn comes_to_rest<M>(drag: f64)
where
    Damped: Discretized<M> + Discretized<Compensated<M>>,
{
    let system = Damped { inertia: vector![1.0, 2.0, 2.5], mass: 1.3, drag };
    let mut state = DampedState {
        attitude: UnitQuaternion::identity(),
        position: vector![0.0, 0.0, 0.0],
        attitude_momentum: vector![0.4, -0.8, 1.5],
        position_momentum: vector![3e-3, 2e-3, -1e-3],
    };
    let mut warm = system.stepper::<M>(1.0).unwrap();
    let (mut worst, mut compared) = (0.0_f64, 0);
    for step in 0..50_000 {
        let before = state;
        warm.step(&mut state).unwrap_or_else(|error| panic!("step {step} from {before:?}: {error}"));
        let [turns, moves] = [before.attitude_momentum.amax(), before.position_momentum.amax()];
        if moves > 1e-280 && step % 7 == 0 {
            let mut converged = before;
            system.stepper::<Compensated<M>>(1.0).unwrap().step(&mut converged).unwrap();
            let first = if turns > 1e-280 { 3 } else { 0 };
            let of = |state: &DampedState| {
                [state.attitude_momentum.as_slice(), state.position_momentum.as_slice()].concat()
            };
            let (state, converged) = (of(&state), of(&converged));
            worst = worst.max(off(&[first, 3], &state[3 - first..], &converged[3 - first..]));
            compared += 1;
        }
    }
    assert!(compared > 100 && worst * f64::EPSILON < 1e-13, "{compared}: {worst} eps");
    let rest = 1e-300;
    assert!(state.attitude_momentum.amax() < rest && state.position_momentum.amax() < rest, "{state:?}");
}

#[test]
fn damped_motion_comes_to_rest() {
    for drag in [0.05, 0.1, 0.3] {
        comes_to_rest::<Midpoint>(drag);
        comes_to_rest::<Midpoint<Exponential>>(drag);
        comes_to_rest::<Cayley>(drag);
        comes_to_rest::<Exponential>(drag);
    }
}

/// A top that is pushed.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    control(moment: R3),
    potential = weight * gamma.dot(&chi),
    force = moment,
    methods(Midpoint)
)]
#[derive(Clone)]
struct Pushed {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

const PUSHED: Pushed =
    Pushed { inertia: Vector3::new(1.0, 2.0, 2.5), weight: 1.7, chi: Vector3::new(0.3, 0.2, 1.0) };

/// The largest error of warm steps against converged ones, in units of epsilon of each part.
fn pushed_error<M>(
    start: &PushedState,
    step: f64,
    steps: usize,
    moment: impl Fn(usize) -> Vector3<f64>,
) -> f64
where
    Pushed: Discretized<M> + Discretized<Compensated<M>>,
{
    pushed::<M>(start, step, steps, moment, |_| true)
}

/// The same of those that are compared.
fn pushed<M>(
    start: &PushedState,
    step: f64,
    steps: usize,
    moment: impl Fn(usize) -> Vector3<f64>,
    is_compared: impl Fn(usize) -> bool,
) -> f64
where
    Pushed: Discretized<M> + Discretized<Compensated<M>>,
{
    let mut state = *start;
    let mut warm = PUSHED.stepper::<M>(step).unwrap();
    let mut worst = 0.0_f64;
    for k in 0..steps {
        let (mut converged, control) = (state, PushedControl { moment: moment(k) });
        warm.step_with(&mut state, &control).unwrap();
        if !is_compared(k) {
            continue;
        }
        PUSHED.stepper::<Compensated<M>>(step).unwrap().step_with(&mut converged, &control).unwrap();
        let [is, should] = [&state, &converged].map(|state| state.to_components());
        worst = worst.max(off(&[4, 3, 3], is.as_ref(), should.as_ref()));
    }
    worst
}

fn upright(tilt: f64, momentum: Vector3<f64>) -> PushedState {
    let gamma = Vector3::new(tilt, 0.0, 1.0).normalize();
    PushedState { attitude: UnitQuaternion::identity(), momentum, gamma }
}

/// Between −1 and 1, at random.
fn noise(k: usize) -> Vector3<f64> {
    let number = |seed: usize| {
        let mut x = (3 * k + seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        x ^= x >> 31;
        x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
        (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    Vector3::new(number(0), number(1), number(2))
}

#[test]
fn steps_are_maps_whatever_the_controls_do() {
    let start = upright(0.1, vector![0.4, -0.8, 1.5]);
    for size in [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, 30.0] {
        let cayley = pushed_error::<Cayley>(&start, 0.01, 400, |k| size * noise(k));
        let midpoint = pushed_error::<Midpoint>(&start, 0.02, 400, |k| size * noise(k));
        // now and then
        let pulses = pushed_error::<Cayley>(&start, 0.01, 400, |k| {
            if k % 37 == 5 { size * noise(k) } else { Vector3::zeros() }
        });
        assert!(cayley.max(midpoint).max(pulses) < 10.0, "{size:e}: {cayley}, {midpoint}, {pulses}");
    }
}

/// The solver looks at how it predicts ever more rarely, in the end every 1024 steps: until then nothing tells it that something is new but the
/// step itself.
#[test]
fn steps_are_maps_after_long_monotony() {
    let start = upright(0.1, vector![0.4, -0.8, 1.5]);
    for size in [1e-9, 1e-3, 1.0, 30.0] {
        for monotony in [1_100, 1_900] {
            let from = |k: usize| if k < monotony { Vector3::zeros() } else { size * noise(k / 20) };
            let compared = |k: usize| k.is_multiple_of(50) || k + 20 > monotony;
            let cayley = pushed::<Cayley>(&start, 0.01, monotony + 60, from, compared);
            let midpoint = pushed::<Midpoint>(&start, 0.02, monotony + 60, from, compared);
            assert!(cayley.max(midpoint) < 10.0, "{size:e} after {monotony}: {cayley}, {midpoint}");
        }
    }
}

#[test]
fn steps_are_maps_where_motion_is_chaotic_sudden_or_fast() {
    let none = |_| Vector3::zeros();
    for step in [0.001, 0.01, 0.05, 0.1, 0.2, 0.4] {
        let start = upright(0.1, vector![0.4, -0.8, 1.5]);
        let cayley = pushed_error::<Cayley>(&start, step, 1_500, none);
        let midpoint = pushed_error::<Midpoint<Exponential>>(&start, step, 1_500, none);
        assert!(cayley.max(midpoint) < 10.0, "{step}: {cayley}, {midpoint}");
    }
    // it stands for long, and then falls
    let quiet = upright(1e-9, vector![0.0, 0.0, 1e-9]);
    let (cayley, midpoint) = (
        pushed_error::<Cayley>(&quiet, 0.02, 2_000, none),
        pushed_error::<Midpoint>(&quiet, 0.02, 2_000, none),
    );
    assert!(cayley.max(midpoint) < 10.0, "{cayley}, {midpoint}");
}

/// A body in a fluid: what turns it are differences of large terms.
#[lie_poisson_system(group = SE3, methods(Midpoint))]
#[derive(Clone)]
struct Fluid {
    #[inertia]
    inertia: Matrix6<f64>,
}

/// Straight on, all torques on it are roundoff.
fn goes_straight<M>(system: &Fluid, spin: f64)
where
    Fluid: Discretized<M>,
{
    let start = Vector6::new(spin, 2.0 * spin, -spin, 1.0, 0.7, -0.3);
    for step in [0.01, 0.3] {
        let mut state = FluidState { pose: Isometry3::identity(), momentum: start };
        let mut stepper = system.stepper::<M>(step).unwrap();
        for _ in 0..2_000 {
            let report = stepper.step(&mut state).unwrap();
            assert!(report.residual < 1e-13, "{step}, {spin}: {report:?}");
        }
        let momentum = state.momentum;
        assert!((momentum - start).amax() < 1e-11, "{step}, {spin}: {momentum}");
    }
}

#[test]
fn what_cancels_is_solved_to_the_rounding_of_its_terms() {
    let masses = Vector6::new(1.0, 2.0, 3.0, 4.0, 4.0, 4.0);
    let round = Fluid { inertia: Matrix6::from_diagonal(&masses) };
    for spin in [0.0, 1e-17, 1e-14] {
        goes_straight::<Cayley>(&round, spin);
        goes_straight::<Exponential>(&round, spin);
        goes_straight::<Midpoint>(&round, spin);
    }
}

/// In single precision.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi), methods(Midpoint))]
#[derive(Clone)]
struct SingleTop {
    #[inertia]
    inertia: Vector3<f32>,
    weight: f32,
    chi: Vector3<f32>,
}

/// The largest change of the energy.
fn energy_strays<M>() -> f32
where
    SingleTop: Discretized<M>,
{
    let top = SingleTop { inertia: vector![1.0, 2.0, 3.0], weight: 1.0, chi: vector![0.3, 0.2, 1.0] };
    let mut state = SingleTopState {
        attitude: UnitQuaternion::identity(),
        momentum: Vector3::repeat(1.0),
        gamma: Vector3::z(),
    };
    let (mut stepper, start, mut most) = (top.stepper::<M>(0.01).unwrap(), top.energy(&state), 0.0_f32);
    for _ in 0..100_000 {
        stepper.step(&mut state).unwrap();
        most = most.max((top.energy(&state) - start).abs());
    }
    most
}

#[test]
fn in_single_precision_what_is_left_of_steps_has_no_direction() {
    // a walk at random: a hundredth of a unit more in each step would be 4e-4 at the end
    let (exponential, midpoint) = (energy_strays::<Exponential>(), energy_strays::<Midpoint>());
    assert!(exponential.max(midpoint) < 2e-4, "{exponential:e}, {midpoint:e}");
}
