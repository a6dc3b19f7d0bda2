//! Zero is a state like others: steps and their derivatives where a norm or a root is zero.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use coadjoint::derivative::{CheckpointedTape, Parts, WrtControl, WrtState};
use coadjoint::ensemble::Instructions;
use coadjoint::nalgebra::SVector;
use coadjoint::prelude::*;
use coadjoint::{Ensemble, Run, StepError};

#[lie_poisson_system(
    group = R1,
    control(push: f64),
    force = vector![push - drag * (velocity.x * velocity.x).sqrt() * velocity.x],
    derivatives,
)]
#[derive(Clone, Debug)]
struct Surge {
    #[inertia]
    mass: f64,
    drag: f64,
}

fn surge() -> Surge {
    Surge { mass: 2.0, drag: 3.0 }
}

#[test]
fn a_step_with_quadratic_drag_has_its_derivatives_at_rest() {
    for momentum in [0.0, 1e-300, -1e-200, 1e-160, 1e-155] {
        let mut state = SurgeState { position: vector![0.0], momentum: vector![momentum] };
        let mut stepper = surge().stepper::<Exponential>(0.01).unwrap();
        let control = SurgeControl { push: 0.0 };
        let step = stepper.step_with_jacobian(&mut state, &control, (WrtState, WrtControl)).unwrap();
        let (a, b) = step.0;
        // at rest the drag is of second order
        assert_eq!(a.as_slice(), [1.0, 0.0, 0.005, 1.0], "{momentum:e}");
        assert_eq!(b.as_slice(), [2.5e-5, 0.01], "{momentum:e}");
    }
}

#[lie_poisson_system(
    group = SE2,
    force = (0.0 * angular_velocity, vector![
        -surge * (linear_velocity.x * linear_velocity.x).sqrt() * linear_velocity.x,
        -sway * (linear_velocity.y * linear_velocity.y).sqrt() * linear_velocity.y,
    ]),
)]
#[derive(Clone, Debug)]
struct Boat {
    #[inertia]
    inertia: Vector3<f64>,
    surge: f64,
    sway: f64,
}

fn boat() -> Boat {
    Boat { inertia: vector![2.76, 25.8, 33.8], surge: 141.0, sway: 217.0 }
}

/// `u' = −141/25.8 |u| u` from `u = 1`.
#[test]
fn a_boat_that_goes_straight_ahead_slows_down_as_it_should() {
    for (step, bound) in [(0.1, 2e-3), (0.01, 2e-5), (0.001, 2e-7)] {
        let start = BoatState { pose: Isometry2::identity(), momentum: vector![0.0, 25.8, 0.0] };
        let mut state = start;
        let mut stepper = boat().stepper::<Exponential>(step).unwrap();
        Run::new(&mut stepper, &mut state).to(1.0).unwrap();
        let exact: f64 = 1.0 / (1.0 + 141.0 / 25.8);
        assert!((exact - 0.154676).abs() < 5e-7);
        let u = state.momentum.y / 25.8;
        assert!((u - exact).abs() < bound, "{step}: {u} for {exact}");
        assert_eq!((state.momentum.x, state.momentum.z), (0.0, 0.0));
    }
}

/// Side by side and rounded once, members at rest and not.
#[test]
fn zero_is_zero_in_every_lane() {
    let velocities = [[0.0, 1.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [0.3, 1.0, 0.1], [0.0, 0.0, 1e-160]];
    let states: Vec<BoatState> = velocities
        .iter()
        .map(|v| BoatState {
            pose: Isometry2::identity(),
            momentum: Vector3::from(*v).component_mul(&boat().inertia),
        })
        .collect();
    for instructions in Instructions::available() {
        let systems = vec![boat(); states.len()];
        let mut ensemble =
            Ensemble::<_, Exponential>::with_instructions(&systems, states.clone(), 0.1, instructions)
                .unwrap();
        ensemble.run(10);
        assert!(ensemble.failed().is_empty());
        for (start, together) in states.iter().zip(ensemble.states()) {
            let (mut alone, mut fused) = (*start, *start);
            boat()
                .stepper::<Exponential>(0.1)
                .unwrap()
                .steps_with(&mut alone, &NoControl::default(), 10)
                .unwrap();
            assert_eq!(together, alone, "{instructions:?}");
            let mut stepper = boat().stepper::<Fused<Exponential>>(0.1).unwrap();
            stepper.steps_with(&mut fused, &NoControl::default(), 10).unwrap();
            assert!((fused.momentum - alone.momentum).norm() < 1e-12);
        }
    }
}

#[lie_poisson_system(group = R3, potential = stiffness * position.norm().powi(3) / 3.0)]
#[derive(Clone, Debug)]
struct Cubic {
    #[inertia]
    mass: f64,
    stiffness: f64,
}

/// `x'' = −4 |x| x` from the origin with velocity 1, against the classical method of Runge and Kutta with small steps.
#[test]
fn a_cubic_spring_goes_through_its_origin() {
    let mut state = CubicState { position: Vector3::zeros(), momentum: vector![1.0, 0.0, 0.0] };
    let mut stepper = Cubic { mass: 1.0, stiffness: 4.0 }.stepper::<Order4<Exponential>>(0.01).unwrap();
    Run::new(&mut stepper, &mut state).to(2.0).unwrap();
    let (mut x, mut v, h) = (0.0_f64, 1.0_f64, 1e-4);
    let force = |x: f64| -4.0 * x.abs() * x;
    for _ in 0..20_000 {
        let (a, b) = (v, force(x));
        let (c, d) = (v + h / 2.0 * b, force(x + h / 2.0 * a));
        let (e, f) = (v + h / 2.0 * d, force(x + h / 2.0 * c));
        let (i, j) = (v + h * f, force(x + h * e));
        (x, v) = (x + h / 6.0 * (a + 2.0 * c + 2.0 * e + i), v + h / 6.0 * (b + 2.0 * d + 2.0 * f + j));
    }
    assert!((state.position - vector![x, 0.0, 0.0]).norm() < 1e-6, "{} for {x}", state.position);
    assert!((state.momentum - vector![v, 0.0, 0.0]).norm() < 1e-6, "{} for {v}", state.momentum);
    // and stays there, if it is there
    let mut state = CubicState { position: Vector3::zeros(), momentum: Vector3::zeros() };
    stepper.step(&mut state).unwrap();
    assert_eq!(state.position, Vector3::zeros());
}

#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z
        + 0.5 * spring * (2.0 * vector![attitude.i, attitude.j, attitude.k].norm().atan2(attitude.w)).powi(2)
        + 0.1 * spring * attitude.w.acos().powi(2),
    force(
        attitude = moment - spin_drag * attitude_velocity.norm() * attitude_velocity,
        position = thrust * (attitude * Vector3::z()) - drag * position_velocity.norm() * position_velocity,
    ),
    derivatives,
)]
#[derive(Clone, Debug)]
struct Quadrotor {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
    drag: f64,
    spin_drag: f64,
    spring: f64,
}

fn quadrotor() -> Quadrotor {
    let inertia = vector![0.02, 0.02, 0.04];
    Quadrotor { inertia, mass: 1.3, gravity: 9.81, drag: 0.05, spin_drag: 0.001, spring: 0.2 }
}

/// A state changed by a perturbation.
fn displaced(state: &QuadrotorState, by: &SVector<f64, 12>) -> QuadrotorState {
    QuadrotorState {
        attitude: state.attitude * UnitQuaternion::from_scaled_axis(by.fixed_rows::<3>(0).into_owned()),
        attitude_momentum: state.attitude_momentum + by.fixed_rows::<3>(3),
        position: state.position + by.fixed_rows::<3>(6),
        position_momentum: state.position_momentum + by.fixed_rows::<3>(9),
    }
}

fn difference(to: &QuadrotorState, from: &QuadrotorState) -> SVector<f64, 12> {
    let mut difference = SVector::<f64, 12>::zeros();
    difference.fixed_rows_mut::<3>(0).copy_from(&(from.attitude.inverse() * to.attitude).scaled_axis());
    difference.fixed_rows_mut::<3>(3).copy_from(&(to.attitude_momentum - from.attitude_momentum));
    difference.fixed_rows_mut::<3>(6).copy_from(&(to.position - from.position));
    difference.fixed_rows_mut::<3>(9).copy_from(&(to.position_momentum - from.position_momentum));
    difference
}

#[test]
fn a_hovering_quadrotor_has_a_jacobian() {
    let zero = Vector3::zeros();
    let hover = QuadrotorState {
        attitude: UnitQuaternion::identity(),
        attitude_momentum: zero,
        position: zero,
        position_momentum: zero,
    };
    let control = QuadrotorControl { moment: zero, thrust: 1.3 * 9.81 };
    let climbing = QuadrotorState { position_momentum: vector![0.0, 0.0, 1.0], ..hover };
    let tilted =
        QuadrotorState { attitude: UnitQuaternion::from_scaled_axis(vector![1e-3, 0.0, 0.0]), ..hover };
    for start in [hover, climbing, tilted] {
        let step = |state: QuadrotorState| {
            let mut state = state;
            quadrotor().stepper::<Exponential>(0.02).unwrap().step_with(&mut state, &control).unwrap();
            state
        };
        let mut stepper = quadrotor().stepper::<Exponential>(0.02).unwrap();
        let mut state = start;
        let jacobian = stepper.step_with_jacobian(&mut state, &control, WrtState).unwrap().0;
        // drag that grows with the square of the velocity is not linear by as much as the difference is wide
        let h = 1e-7;
        for k in 0..12 {
            let by = SVector::from_fn(|i, _| if i == k { h } else { 0.0 });
            let column =
                difference(&step(displaced(&start, &by)), &step(displaced(&start, &-by))) / (2.0 * h);
            let error = (column - jacobian.column(k)).amax();
            assert!(error < 2e-8, "{k}: {column} for {}", jacobian.column(k));
        }
    }
}

/// A constant part of the drag has no derivative at rest, and a potential as a cone none at its tip.
#[lie_poisson_system(
    group = R3,
    control(push: f64),
    force = vector![push - drag * velocity.norm(), 0.0, 0.0],
    derivatives,
)]
#[derive(Clone, Debug)]
struct Rough {
    #[inertia]
    mass: f64,
    drag: f64,
}

#[lie_poisson_system(group = R3, potential = steepness * position.norm(), derivatives)]
#[derive(Clone, Debug)]
struct Cone {
    #[inertia]
    mass: f64,
    steepness: f64,
}

#[test]
fn what_has_no_derivative_says_so() {
    let start = RoughState { position: Vector3::zeros(), momentum: Vector3::zeros() };
    let rough = Rough { mass: 2.0, drag: 3.0 };
    let mut stepper = rough.stepper::<Exponential>(0.01).unwrap();
    let (mut state, control) = (start, RoughControl { push: 0.0 });
    let refused = Err(StepError::NoDerivative);
    let jacobian = stepper.step_with_jacobian(&mut state, &control, (WrtState, WrtControl));
    assert_eq!(jacobian.map(|step| step.1), refused);
    assert_eq!(stepper.step_with_derivative(&mut state, &control).map(|(_, report)| report), refused);
    assert_eq!((state, stepper.time(), stepper.steps_taken()), (start, 0.0, 0));
    let text = StepError::NoDerivative.to_string();
    assert!(text.starts_with("the step has no finite derivative here"), "{text}");
    // the step itself is one like others, and so is what comes after the refusal
    stepper.step_with(&mut state, &control).unwrap();
    assert_eq!(stepper.steps_taken(), 1);
    let run = CheckpointedTape::new(&mut stepper, &mut state, 3, |_| control).unwrap();
    assert_eq!(run.gradient(&SVector::from([1.0; 6])).err(), Some(StepError::NoDerivative));
    assert_eq!(run.tangent(&Parts::default()).err(), Some(StepError::NoDerivative));
    // of what is moved there is one
    let mut moving = RoughState { momentum: vector![0.1, 0.0, 0.0], ..start };
    let jacobian = stepper.step_with_jacobian(&mut moving, &control, WrtState);
    assert!(jacobian.is_ok(), "{jacobian:?}");

    let mut tip = ConeState { position: Vector3::zeros(), momentum: Vector3::zeros() };
    let mut stepper = Cone { mass: 1.0, steepness: 1.0 }.stepper::<Exponential>(0.01).unwrap();
    assert!(stepper.step(&mut tip).is_err());
    let mut side = ConeState { position: vector![0.1, 0.0, 0.0], momentum: Vector3::zeros() };
    assert!(stepper.step_with_jacobian(&mut side, &NoControl::default(), WrtState).is_ok());
}

/// By a Lagrangian Newton's iteration is always needed.
#[lie_poisson_system(
    group(body: SO3, slider: R1),
    lagrangian = {
        let velocity = body_velocity.cross(&(slider.x * Vector3::x())) + slider_velocity.x * Vector3::x();
        body_velocity.dot(&body_velocity.component_mul(&inertia)) / 2.0 + mass * velocity.norm_squared() / 2.0
            - stiffness * slider.x.powi(2) / 2.0
    },
    force(
        slider = vector![-drag * slider_velocity.norm() * slider_velocity.x],
        body = -drag * body_velocity.norm() * body_velocity,
    ),
)]
#[derive(Clone, Debug)]
struct Slide {
    inertia: Vector3<f64>,
    mass: f64,
    stiffness: f64,
    drag: f64,
}

#[test]
fn drag_on_a_part_that_rests_does_not_stop_the_others() {
    let slide = Slide { inertia: vector![1.0, 2.0, 2.5], mass: 0.3, stiffness: 4.0, drag: 0.1 };
    for step in [0.001, 0.02, 0.1] {
        let mut state = SlideState {
            body: UnitQuaternion::identity(),
            body_momentum: vector![0.1, 0.0, 0.0],
            slider: vector![0.0],
            slider_momentum: vector![0.0],
        };
        let mut stepper = slide.stepper::<Exponential>(step).unwrap();
        stepper.steps_with(&mut state, &NoControl::default(), 100).unwrap();
        // L' = −drag L² with a moment of 1
        let exact = 0.1 / (1.0 + 0.1 * 0.1 * 100.0 * step);
        assert!((state.body_momentum.x - exact).abs() < 1e-5, "{} for {exact}", state.body_momentum.x);
    }
}

/// Rubber that holds an attitude.
#[lie_poisson_system(
    group = SO3,
    potential = stiffness * attitude.angle().powi(2) / 2.0 + 0.5 * twist * attitude.scaled_axis().z.powi(2),
    derivatives(state),
)]
struct Bushing {
    #[inertia]
    inertia: Vector3<f64>,
    stiffness: f64,
    twist: f64,
}

fn bushing() -> Bushing {
    Bushing { inertia: vector![1.0, 2.0, 2.5], stiffness: 4.0, twist: 3.0 }
}

/// About rest each axis is an oscillator, `I δ'' = −k δ`, at both quaternions of no rotation.
#[test]
fn a_rotational_spring_has_its_derivatives_where_it_is_relaxed() {
    let time = 1e-3;
    for sign in [1.0, -1.0] {
        let attitude = UnitQuaternion::new_unchecked(Quaternion::new(sign, 0.0, 0.0, 0.0));
        let mut state = BushingState { attitude, momentum: Vector3::zeros() };
        let mut stepper = bushing().stepper::<Exponential>(time).unwrap();
        let jacobian = stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtState).unwrap().0;
        assert_eq!(state, BushingState { attitude, momentum: Vector3::zeros() });
        let mut expected = Matrix6::zeros();
        for (k, stiffness) in [4.0, 4.0, 7.0_f64].into_iter().enumerate() {
            let inertia = bushing().inertia[k];
            let frequency = (stiffness / inertia).sqrt();
            let (sine, cosine) = (frequency * time).sin_cos();
            expected[(k, k)] = cosine;
            expected[(k, k + 3)] = sine / (frequency * inertia);
            expected[(k + 3, k)] = -frequency * inertia * sine;
            expected[(k + 3, k + 3)] = cosine;
        }
        assert!((jacobian - expected).amax() < 1e-8, "{jacobian}{expected}");
    }
}

#[test]
fn half_a_turn_has_no_torque() {
    let attitude = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.6, 0.0, 0.8));
    let start = BushingState { attitude, momentum: Vector3::zeros() };
    let mut state = start;
    let mut stepper = bushing().stepper::<Exponential>(0.01).unwrap();
    assert_eq!(stepper.step(&mut state), Err(StepError::NotFinite));
    assert_eq!(state, start);
    // squares are the same on both sides
    let pi = std::f64::consts::PI;
    let energy = 2.0 * pi.powi(2) + 1.5 * (0.8 * pi).powi(2);
    assert!((bushing().energy(&start) - energy).abs() < 1e-13);
}
