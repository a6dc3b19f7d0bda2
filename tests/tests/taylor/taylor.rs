//! Taylor steps: as accurate as the tolerance, on group and orbit at every tolerance.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]
#![allow(clippy::clone_on_copy, reason = "whether a state is one that is copied is of no interest here")]

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use coadjoint::ensemble::Instructions;
use coadjoint::error::{ParameterError, StepError};
use coadjoint::nalgebra::Translation3;
use coadjoint::prelude::*;
use coadjoint::stepper::Stepping;
use coadjoint::taylor::PowerSeries;
use coadjoint::{Discretized, Record, Run, RunError, RunReport, State, System, erased, taylor};
use serde_json::Value;

/// A free rigid body with axes that are not principal ones.
#[lie_poisson_system(group = SO3, taylor, retractions(Exponential))]
struct Body {
    #[inertia]
    inertia: Matrix3<f64>,
}

/// A heavy top.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
    taylor,
    retractions(Exponential)
)]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

/// A quadrotor with drag, under controls.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(
        attitude = moment - damping * attitude_velocity.norm() * attitude_velocity,
        position = attitude * (thrust * Vector3::z())
    ),
    taylor,
    retractions(Exponential)
)]
struct Quadrotor {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
    damping: f64,
}

/// A planet.
#[lie_poisson_system(
    group = R3,
    hamiltonian = momentum.norm_squared() / (2.0 * mass) - strength / position.norm(),
    taylor,
    retractions(Exponential)
)]
struct Kepler {
    mass: f64,
    strength: f64,
}

/// A double pendulum, whose mass matrix depends on the angles.
#[lie_poisson_system(
    group(first: SO2, second: SO2),
    lagrangian = {
        let (upper, lower) = (first_velocity.x, second_velocity.x);
        let between = first.inverse() * second;
        upper.powi(2) + lower.powi(2) / 2.0 + upper * lower * between.cos_angle()
            + gravity * (2.0 * first.cos_angle() + second.cos_angle())
    },
    taylor,
    retractions(Exponential)
)]
struct Double {
    gravity: f64,
}

/// A damped pendulum whose pivot shakes, with a torque that is held.
#[lie_poisson_system(
    group = SO2,
    control(torque: f64),
    potential = -weight * (1.0 + (3.0 * t).sin() / 4.0) * angle.cos_angle(),
    force = vector![torque - damping * velocity.x],
    taylor,
    retractions(Exponential)
)]
struct Pendulum {
    #[inertia]
    inertia: f64,
    weight: f64,
    damping: f64,
}

/// A rigid body in a fluid: momenta of rotation and translation mix.
#[lie_poisson_system(group = SE3, taylor, retractions(Exponential))]
struct Hull {
    #[inertia]
    inertia: SMatrix<f64, 6, 6>,
}

/// Right-invariant, with an advected parameter that the energy is not linear in.
#[lie_poisson_system(
    group = SO3,
    invariance = right,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi) + gamma.x * gamma.y,
    taylor,
    retractions(Exponential)
)]
struct Right {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

/// Right-invariant, with a potential on the group.
#[lie_poisson_system(
    group = SO3,
    invariance = right,
    potential = weight * (attitude * Vector3::x()).z,
    taylor,
    retractions(Exponential)
)]
struct Held {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
}

/// A body of a group of matrices.
#[lie_poisson_system(group = SO(4), taylor)]
struct Four {
    #[inertia]
    inertia: SVector<f64, 6>,
}

/// All functions that there are, of what changes.
#[lie_poisson_system(
    group = R1,
    hamiltonian = {
        let (x, p) = (position.x, momentum.x);
        p.powi(2) / 2.0 + x.sin().exp() + (2.0 + x.cos()).ln() + (x / 3.0).tanh() + (2.0 * x).atan()
            + (x.powi(2) + 1.0).powf(1.7) + (x / 10.0).tan() + (x / 20.0).asin() + (x / 30.0).acos()
            + (x.cosh() + p.powi(4)).sqrt() + x.atan2(2.0 + p.powi(2)) + (1.0 + x.powi(2)).powf(p / 10.0)
            + (x / 4.0).sinh() + (x - 10.0).abs() + 1.0 / (2.0 + x).powi(3)
    },
    taylor,
    retractions(Exponential)
)]
struct Functions {}

/// What slides to and fro in a kink.
#[lie_poisson_system(group = R1, potential = position.x.abs(), taylor, retractions(Exponential))]
struct Kinked {
    #[inertia]
    mass: f64,
}

fn attitude() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(0.3, -0.5, 0.2)
}

fn quadrotor() -> (Quadrotor, QuadrotorState, QuadrotorControl) {
    let quadrotor = Quadrotor { inertia: vector![1.0, 1.5, 2.0], mass: 2.0, gravity: 9.81, damping: 0.2 };
    let start = QuadrotorState {
        attitude: attitude(),
        attitude_momentum: vector![0.5, -0.4, 0.7],
        position: vector![1.0, 2.0, 3.0],
        position_momentum: vector![0.1, 0.0, -1.0],
    };
    (quadrotor, start, QuadrotorControl { moment: vector![0.1, -0.2, 0.3], thrust: 21.0 })
}

fn kepler(eccentricity: f64) -> (Kepler, KeplerState) {
    let speed = ((1.0 + eccentricity) / (1.0 - eccentricity)).sqrt();
    let start =
        KeplerState { position: vector![1.0 - eccentricity, 0.0, 0.0], momentum: vector![0.0, speed, 0.0] };
    (Kepler { mass: 1.0, strength: 1.0 }, start)
}

fn pendulum() -> (Pendulum, PendulumState, PendulumControl) {
    let start = PendulumState { angle: UnitComplex::new(0.8), momentum: vector![0.5] };
    (Pendulum { inertia: 1.2, weight: 2.0, damping: 0.3 }, start, PendulumControl { torque: 0.3 })
}

fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, |largest, x| if x.abs() <= largest { largest } else { x.abs() })
}

fn distance<S: State<Scalar = f64>>(a: &S, b: &S) -> f64 {
    let (a, b) = (a.to_components(), b.to_components());
    largest(a.as_ref().iter().zip(b.as_ref()).map(|(a, b)| a - b))
}

/// Compares with a composition of order 8, goes back to the start, and looks at what is kept at three tolerances.
fn check<S>(what: &str, system: &S, start: S::State, control: S::Control, time: f64)
where
    S: PowerSeries + System<Scalar = f64> + Discretized<Order8<Exponential>>,
{
    let after = |tolerance: f64| {
        let (mut state, mut trajectory) = (start.clone(), system.adaptive(tolerance).unwrap());
        trajectory.to_with(&mut state, &control, time).unwrap();
        (state, trajectory)
    };
    let (end, mut trajectory) = after(1e-15);
    let (mut by, steps) = (start.clone(), 1_000);
    let mut stepper = system.stepper::<Order8<Exponential>>(time / steps as f64).unwrap();
    stepper.steps_with(&mut by, &control, steps).unwrap();
    assert!(distance(&end, &by) < 5e-12, "{what}: {:e}", distance(&end, &by));
    let mut back = end.clone();
    trajectory.to_with(&mut back, &control, 0.0).unwrap();
    assert!(distance(&back, &start) < 2e-13, "{what} back: {:e}", distance(&back, &start));
    for tolerance in [1e-4, 1e-8, 1e-12] {
        let (state, _) = after(tolerance);
        let error = distance(&state, &end);
        assert!(error < 10.0 * tolerance, "{what} to {tolerance:e}: {error:e}");
        let (now, before) = (system.casimirs(&state), system.casimirs(&start));
        let change = largest(now.as_ref().iter().zip(before.as_ref()).map(|(a, b)| a - b));
        assert!(change < 2e-14, "{what} to {tolerance:e}, Casimirs: {change:e}");
        assert!(state.deviation() < 1e-15, "{what} to {tolerance:e}: {:e} off the group", state.deviation());
    }
}

#[test]
fn taylor_steps_follow_the_motion_of_each_kind_of_system() {
    let inertia = matrix![2.0, 0.1, 0.2; 0.1, 3.0, -0.3; 0.2, -0.3, 4.0];
    let start = BodyState { attitude: attitude(), momentum: vector![1.0, -2.0, 3.0] };
    check("a body", &Body { inertia }, start, NoControl::default(), 5.0);

    let (system, start, control) = quadrotor();
    check("a quadrotor", &system, start, control, 2.0);
    let (system, start) = kepler(0.2);
    check("a planet", &system, start, NoControl::default(), 4.0);
    let start = DoubleState {
        first: UnitComplex::new(0.8),
        first_momentum: vector![0.5],
        second: UnitComplex::new(-0.8),
        second_momentum: vector![0.3],
    };
    check("a double pendulum", &Double { gravity: 9.81 }, start, NoControl::default(), 2.0);
    let (system, start, control) = pendulum();
    check("a pendulum", &system, start, control, 5.0);

    let mut inertia = SMatrix::<f64, 6, 6>::from_diagonal(&vector![1.0, 2.0, 2.5, 3.0, 3.5, 4.0]);
    for (i, j, x) in [(0, 4, 0.3), (4, 0, 0.3), (1, 5, -0.2), (5, 1, -0.2)] {
        inertia[(i, j)] = x;
    }
    let pose = Isometry3::from_parts(Translation3::new(0.3, -0.2, 0.5), attitude());
    let start = HullState { pose, momentum: vector![0.5, -1.0, 0.7, 0.4, 0.2, -0.6] };
    check("a hull", &Hull { inertia }, start, NoControl::default(), 5.0);

    let (inertia, weight) = (vector![1.0, 2.0, 2.5], 1.0);
    let (attitude, momentum) = (attitude(), vector![0.5, 0.8, -0.7]);
    let start = RightState { attitude, momentum, gamma: vector![0.1, 0.7, 0.5] };
    let right = Right { inertia, weight, chi: vector![0.3, 0.2, 1.0] };
    check("a right-invariant body", &right, start, NoControl::default(), 5.0);
    let start = HeldState { attitude, momentum };
    check("one with a potential", &Held { inertia, weight }, start, NoControl::default(), 5.0);
    let start = FourState { element: SMatrix::identity(), momentum: vector![0.5, -1.0, 0.7, 0.4, 0.2, -0.6] };
    let four = Four { inertia: vector![1.0, 2.0, 2.5, 3.0, 3.5, 4.0] };
    check("a body in four dimensions", &four, start, NoControl::default(), 5.0);
    let start = FunctionsState { position: vector![0.7], momentum: vector![0.4] };
    check("all functions", &Functions {}, start, NoControl::default(), 2.0);
}

#[test]
fn claims_are_measured() {
    use coadjoint::certify::{CertifyError, Verdict, certify_taylor};
    let certified = |system: Arc<dyn erased::System>, state: &[f64], control: &[f64]| {
        let report = certify_taylor(system, &[state.to_vec()], &[control.to_vec()]).unwrap();
        assert!(report.passed(), "{report}");
        report
    };
    let top = Top { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: vector![0.3, 0.2, 1.0] };
    let report = certified(Arc::new(top), &[1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.6, 0.8], &[]);
    let names: Vec<_> = report.certificates.iter().map(|row| row.name.as_str()).collect();
    let expected = [
        "order",
        "group",
        "|gamma|²",
        "momentum·gamma",
        "error by tolerance",
        "energy by tolerance",
        "reversibility",
    ];
    assert_eq!(names, expected);
    let order = report.certificate("order").unwrap();
    assert!(order.verdict == Verdict::Passed && (order.figure - 6.0).abs() < 0.3, "{report}");
    let (system, start, control) = pendulum();
    let report = certified(Arc::new(system), &start.to_components(), &[control.torque]);
    assert!(report.certificate("energy by tolerance").is_none());
    // across a kink the order is lost
    let report = certify_taylor(Arc::new(Kinked { mass: 1.0 }), &[vec![0.01, -1.0]], &[]).unwrap();
    assert_eq!(report.certificate("order").unwrap().verdict, Verdict::Failed, "{report}");
    let error = certify_taylor(Arc::new(Functions {}), &[], &[]).unwrap_err();
    assert_eq!(error, CertifyError::NoStates);
}

/// What is known of members that have come to some times, forward and back, to the last bit.
fn reached<S: PowerSeries + System<Scalar = f64>>(
    system: &S,
    starts: &[S::State],
    all_to: impl Fn(&mut [(taylor::Adaptive<S>, S::State)], f64) -> Vec<Result<RunReport, RunError>>,
) -> Vec<(Result<RunReport, RunError>, u64, Vec<u64>)> {
    let member = |(k, start): (usize, &S::State)| {
        let mut trajectory = system.adaptive([1e-9, 1e-4, 1e-13, 1e-9][k % 4]).unwrap();
        trajectory.set_time(0.1 * (k % 5) as f64);
        if k == 6 {
            trajectory = trajectory.with_step(0.01).unwrap();
        }
        (trajectory, start.clone())
    };
    let mut members: Vec<_> = starts.iter().enumerate().map(member).collect();
    let mut all = Vec::new();
    for time in [0.2, 1.3, 0.7, 3.0, 3.0, f64::INFINITY] {
        let reports = all_to(&mut members, time);
        for ((trajectory, state), report) in members.iter().zip(reports) {
            let mut numbers = vec![trajectory.time(), trajectory.last_step()];
            for state in [Some(state.clone()), trajectory.at(0.3)].into_iter().flatten() {
                numbers.extend(state.to_components().as_ref());
            }
            let bits = numbers.iter().map(|x| x.to_bits()).collect();
            all.push((report, trajectory.steps_taken(), bits));
        }
    }
    all
}

/// Returns how many of the runs failed.
fn ends_as_if_alone<S: PowerSeries + System<Scalar = f64>>(
    what: &str,
    system: &S,
    starts: &[S::State],
) -> usize
where
    taylor::Adaptive<S>: Send,
    S::State: Send,
{
    let alone = reached(system, starts, |members, time| {
        members.iter_mut().map(|(trajectory, state)| Run::new(trajectory, state).to(time)).collect()
    });
    for instructions in Instructions::available() {
        let together =
            reached(system, starts, |members, time| taylor::all_to_with(members, time, instructions));
        for (k, (one, other)) in alone.iter().zip(&together).enumerate() {
            assert_eq!(one, other, "{what}, {instructions:?}: {} of {}", k % starts.len(), k / starts.len());
        }
    }
    alone.iter().filter(|(report, ..)| report.is_err()).count()
}

#[test]
fn members_of_an_ensemble_end_as_if_alone() {
    let top = Top { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: vector![0.3, 0.2, 1.0] };
    let start = |k: usize| TopState {
        attitude: attitude(),
        momentum: vector![1.0 + 0.1 * k as f64, 1.0, 5.0],
        gamma: vector![0.0, 0.6, 0.8],
    };
    let mut starts: Vec<_> = (0..23).map(start).collect();
    // one of the times is none, and one has steps of one length, which do not go back
    assert_eq!(ends_as_if_alone("tops", &top, &starts), 24);
    starts[4].momentum.x = f64::NAN;
    starts[9].attitude = UnitQuaternion::new_unchecked(Quaternion::new(2.0, 0.0, 0.0, 0.0));
    assert_eq!(ends_as_if_alone("tops, two of them none", &top, &starts), 24 + 2 * 5);

    // one falls into the sun
    let (system, start) = kepler(0.4);
    let mut starts = vec![start.clone(); 11];
    starts[3].momentum.y = 0.0;
    let failed = ends_as_if_alone("planets", &system, &starts);
    assert!(failed > 12 && failed < 12 + 5, "{failed}");

    let start = |k: usize| DoubleState {
        first: UnitComplex::new(0.8),
        first_momentum: vector![0.5 + 0.01 * k as f64],
        second: UnitComplex::new(-0.8),
        second_momentum: vector![0.3],
    };
    let starts: Vec<_> = (0..9).map(start).collect();
    assert_eq!(ends_as_if_alone("double pendulums", &Double { gravity: 9.81 }, &starts), 10);
    let (system, start, _) = pendulum();
    assert_eq!(ends_as_if_alone("pendulums", &system, &[start; 5]), 5);
    assert_eq!(ends_as_if_alone("none", &system, &[]), 0);

    // by themselves, the widest instructions are taken
    let (body, start) = (Body { inertia: Matrix3::identity() }, BodyState::default());
    let mut members: Vec<_> = (0..3).map(|_| (body.adaptive(1e-9).unwrap(), start)).collect();
    assert!(taylor::all_to(&mut members, 2.0).iter().all(Result::is_ok) && members[2].0.time() == 2.0);
}

/// A case: its name, the top, its start, and its states at times.
type Reference = (String, Top, TopState, Vec<(f64, TopState)>);

/// The cases of the reference file as tops, their starts, and the states at later times.
fn references() -> Vec<Reference> {
    let file: Value = serde_json::from_str(include_str!("../../data/reference.json")).unwrap();
    let vector = |value: &Value| Vector3::from_fn(|i, _| value[i].as_f64().unwrap());
    let state = |point: &Value| {
        let part = |i: usize| point["attitude_wxyz"][i].as_f64().unwrap();
        TopState {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(part(0), part(1), part(2), part(3))),
            momentum: vector(&point["momentum"]),
            gamma: vector(&point["gamma"]),
        }
    };
    let case = |case: &Value| {
        let top = Top { inertia: vector(&case["inertia"]), weight: 1.0, chi: vector(&case["weight_chi"]) };
        let states = case["states"].as_array().unwrap();
        let states = states.iter().map(|point| (point["time"].as_f64().unwrap(), state(point))).collect();
        (case["name"].as_str().unwrap().to_owned(), top, state(&case["initial"]), states)
    };
    file["cases"].as_array().unwrap().iter().map(case).collect()
}

/// The error at the smallest tolerance is at most ten times that of a start whose components are known to a unit in the last place, and the Casimirs are kept at each.
#[test]
fn the_error_is_that_of_doubles_and_casimirs_are_kept() {
    for (name, top, start, states) in references() {
        for (time, expected) in states {
            let reached = |start: &TopState, tolerance: f64| {
                let mut state = start.clone();
                top.adaptive(tolerance).unwrap().to(&mut state, time).unwrap();
                if state.attitude.dot(&expected.attitude) < 0.0 {
                    state.attitude = UnitQuaternion::new_unchecked(-state.attitude.into_inner());
                }
                state
            };
            let end = reached(&start, 1e-15);
            let disturbed = |axis: usize| {
                let mut start = start.clone();
                match axis {
                    0..3 => start.momentum[axis] += 1e-8,
                    _ => start.gamma[axis - 3] += 1e-8,
                }
                distance(&reached(&start, 1e-15), &end) / 1e-8
            };
            // of a start that is off in every component
            let condition = (0..6).map(disturbed).sum::<f64>().max(1.0);
            let size = largest(expected.to_components()).max(1.0);
            let (error, allowed) = (distance(&end, &expected), 10.0 * f64::EPSILON * condition * size);
            assert!(error < allowed, "{name} at {time} s: {error:e}, condition {condition:.1}");
            for tolerance in [1e-4, 1e-6, 1e-9, 1e-12, 1e-15] {
                let state = reached(&start, tolerance);
                let [now, before] = [&state, &start]
                    .map(|state| [state.gamma.norm_squared(), state.momentum.dot(&state.gamma)]);
                let change = largest([now[0] - before[0], now[1] - before[1]]);
                assert!(change < 3e-13, "{name} to {tolerance:e} at {time} s: {change:e}");
                assert!((state.attitude.norm() - 1.0).abs() < 1e-15, "{name} to {tolerance:e} at {time} s");
            }
        }
    }
}

#[test]
fn a_free_body_keeps_its_momentum_at_every_tolerance() {
    let body = Body { inertia: Matrix3::from_diagonal(&vector![1.0, 10.0, 100.0]) };
    let start = BodyState { attitude: attitude(), momentum: vector![1.0, 1.0, 1.0] };
    for tolerance in [1e-4, 1e-6, 1e-9, 1e-12, 1e-15] {
        let mut state = start.clone();
        body.adaptive(tolerance).unwrap().to(&mut state, 1_800.0).unwrap();
        let change = state.momentum.norm_squared() - start.momentum.norm_squared();
        assert!(change.abs() < 3e-13, "to {tolerance:e}: {change:e}");
        assert!((state.attitude.norm() - 1.0).abs() < 1e-15, "to {tolerance:e}");
    }
}

#[test]
fn a_planet_comes_back_after_a_thousand_orbits() {
    let (system, start) = kepler(0.9);
    let (mut state, mut trajectory) = (start.clone(), system.adaptive(1e-15).unwrap());
    let report = trajectory.to(&mut state, 1_000.0 * TAU).unwrap();
    // where the planet is nearest to the sun, its momentum changes by 100 per unit of time, its position by 4: that is an error of the time of
    // 2e-9 in 6,283, of 74,000 steps
    let (position, all) = ((state.position - start.position).norm(), distance(&state, &start));
    assert!(position < 1e-8 && all < 2e-7, "{position:e}, {all:e} after {} steps", report.steps);
    let energy = (system.energy(&state) - system.energy(&start)).abs();
    assert!(energy < 3e-13, "{energy:e}");
}

#[test]
fn steps_of_one_length_have_their_order() {
    let (system, start, control) = pendulum();
    let after = |order: usize, steps: u32| {
        let trajectory = system.adaptive(1e-3).unwrap().with_order(order);
        let mut trajectory = trajectory.with_step(2.0 / f64::from(steps)).unwrap();
        let mut state = start.clone();
        let report = trajectory.to_with(&mut state, &control, 2.0).unwrap();
        assert!(report.steps.abs_diff(u64::from(steps)) <= 1);
        state
    };
    let exact = after(24, 50);
    for order in [4, 6, 9] {
        let [coarse, fine] = [16, 32].map(|steps| distance(&after(order, steps), &exact));
        let slope = (coarse / fine).log2();
        assert!((slope - order as f64).abs() < 0.3, "order {order}: {slope}");
    }
}

#[test]
fn states_within_a_step_have_its_order() {
    let (system, start, control) = pendulum();
    for (order, step) in [(4, 0.1), (6, 0.2), (9, 0.4)] {
        let within = |step: f64| -> Vec<f64> {
            let (mut state, mut exact) = (start.clone(), start.clone());
            let trajectory = system.adaptive(1e-3).unwrap().with_order(order);
            let mut trajectory = trajectory.with_step(step).unwrap();
            trajectory.step_with(&mut state, &control).unwrap();
            let mut other = system.adaptive(1e-15).unwrap();
            let error = |k: u32| {
                let share = f64::from(k) / 10.0;
                other.to_with(&mut exact, &control, share * step).unwrap();
                distance(&trajectory.at(share).unwrap(), &exact)
            };
            (1..=10).map(error).collect()
        };
        let slopes = within(step).into_iter().zip(within(0.5 * step)).filter(|(_, fine)| *fine > 1e-13);
        let slopes: Vec<f64> = slopes.map(|(coarse, fine)| (coarse / fine).log2()).collect();
        assert!(
            slopes.len() >= 5 && slopes.iter().all(|slope| *slope > order as f64 + 0.3),
            "{order}: {slopes:?}"
        );
    }
}

#[test]
fn a_state_within_a_step_is_as_good_as_its_end() {
    let (_, top, start, _) = references().swap_remove(2);
    let (mut state, mut trajectory) = (start.clone(), top.adaptive(1e-12).unwrap());
    assert!(trajectory.at(0.5).is_none());
    for _ in 0..20 {
        let (from, before) = (trajectory.time(), state.clone());
        let step = trajectory.step(&mut state).unwrap();
        assert_eq!(
            (trajectory.at(1.0), trajectory.at(1.5), trajectory.at(f64::NAN)),
            (Some(state.clone()), None, None)
        );
        assert!(distance(&trajectory.at(0.0).unwrap(), &before) < 1e-15);
        for share in (1..=10).map(|k| f64::from(k) / 10.0) {
            let within = trajectory.at(share).unwrap();
            let (mut exact, mut other) = (before.clone(), top.adaptive(1e-15).unwrap());
            other.set_time(from);
            other.to(&mut exact, from + share * step).unwrap();
            assert!(distance(&within, &exact) < 1e-12, "{share}: {:e}", distance(&within, &exact));
            let casimir = within.momentum.dot(&within.gamma) - before.momentum.dot(&before.gamma);
            assert!(casimir.abs() < 1e-15 && (within.gamma.norm() - before.gamma.norm()).abs() < 1e-15);
        }
    }
}

#[test]
fn runs_and_erased_systems_take_the_same_steps() {
    let (system, start, control) = pendulum();
    let (mut state, mut trajectory) = (start.clone(), system.adaptive(1e-10).unwrap());
    trajectory.to_with(&mut state, &control, 3.0).unwrap();
    let mut again = start.clone();
    let (mut record, mut other) = (Record::every(1), system.adaptive(1e-10).unwrap());
    let run = Run::new(&mut other, &mut again).with_control(control.clone());
    let report = run.observe(&mut record).to(3.0).unwrap();
    assert_eq!((&again, other.time()), (&state, 3.0));
    assert_eq!(record.states().len() as u64, report.steps + 1);

    let erased: Arc<dyn erased::System> = Arc::new(system);
    let mut numbers = start.to_components().to_vec();
    let mut steps = erased::Adaptive::new(erased.clone(), 1e-10).unwrap();
    let torque = vec![control.torque];
    let run = Run::new(&mut steps, &mut numbers).with_control(torque.clone());
    assert_eq!(run.to(3.0).unwrap().steps, report.steps);
    assert_eq!(numbers, state.to_components());
    // a snapshot goes on as if there had been no interruption
    use coadjoint::stepper::Stepping as _;
    let mut copy = erased::Adaptive::new(erased, 1e-10).unwrap();
    copy.restore(&steps.snapshot()).unwrap();
    let mut copied = numbers.clone();
    steps.step_with(&mut numbers, &torque).unwrap();
    copy.step_with(&mut copied, &torque).unwrap();
    assert_eq!((copied, copy.time()), (numbers, steps.time()));
}

#[test]
fn what_cannot_be_done_is_said_and_changes_nothing() {
    let (system, start) = kepler(0.5);
    for tolerance in [0.0, -1.0, 1.0, f64::NAN, f64::INFINITY] {
        let error = system.adaptive(tolerance).err();
        assert!(matches!(error, Some(ParameterError::Tolerance { .. })), "{tolerance}: {error:?}");
    }
    assert!(system.adaptive(1e-9).unwrap().with_step(0.0).is_err());
    // it falls into the sun
    let mut state = KeplerState { momentum: Vector3::zeros(), ..start.clone() };
    let mut trajectory = system.adaptive(1e-12).unwrap();
    let error = trajectory.to(&mut state, 10.0).unwrap_err();
    assert!(matches!(error.cause, StepError::NoProgress { .. } | StepError::NotFinite), "{error}");
    // from the distance 1/2 in half the time of an orbit of the semiaxis 1/4
    let end = PI * 0.25_f64.powf(1.5);
    assert!((error.time - end).abs() < 1e-6, "{} of {end}", error.time);
    assert!(state.position.norm() < 1e-3 && state.position.norm() > 0.0);

    let mut lost = KeplerState { position: vector![f64::NAN, 0.0, 0.0], ..start.clone() };
    assert_eq!(trajectory.step(&mut lost), Err(StepError::NotFinite));
    // a memory of more steps than can be counted
    let mut memory = Stepping::snapshot(&trajectory);
    memory[2] = f64::INFINITY;
    assert_eq!(Stepping::restore(&mut trajectory, &memory), Ok(()));
    assert!(trajectory.step(&mut start.clone()).is_ok());
    let mut state = start.clone();
    let before = trajectory.time();
    assert!(trajectory.to(&mut state, f64::NAN).is_err());
    assert_eq!((state, trajectory.time()), (start, before));

    // a body at rest: any step is exact, and one to a time is taken
    let body = Body { inertia: Matrix3::identity() };
    let rest = BodyState { attitude: attitude(), momentum: Vector3::zeros() };
    let (mut state, mut trajectory) = (rest.clone(), body.adaptive(1e-9).unwrap());
    assert_eq!(trajectory.step(&mut state), Err(StepError::NoEnd));
    assert_eq!(trajectory.to(&mut state, 1e6).unwrap().steps, 1);
    // the quaternion is normalized
    assert!(state.momentum == rest.momentum && distance(&state, &rest) < 2e-16);
    // thrown upward: a parabola, exactly
    let (mut thrown, mut start, _) = quadrotor();
    (thrown.damping, start.attitude_momentum) = (0.0, Vector3::zeros());
    let (mut state, mut trajectory) = (start.clone(), thrown.adaptive(1e-9).unwrap());
    trajectory.to(&mut state, 2.0).unwrap();
    let height = start.position.z + start.position_momentum.z / thrown.mass * 2.0 - thrown.gravity * 2.0;
    assert!((state.position.z - height).abs() < 1e-14, "{} of {height}", state.position.z);
}
