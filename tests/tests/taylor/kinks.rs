//! Where the motion is not that of its series: zeros of norms, branches and jumps, each against its closed form.

use coadjoint::error::StepError;
use coadjoint::prelude::*;
use coadjoint::taylor::PowerSeries;
use coadjoint::{State, System, erased, taylor};
use std::sync::Arc;

/// A ball with quadratic drag.
#[lie_poisson_system(
    group = R3,
    potential = mass * gravity * position.z,
    force = -drag * velocity.norm() * velocity,
    taylor
)]
#[derive(Clone)]
struct Ball {
    #[inertia]
    mass: f64,
    gravity: f64,
    drag: f64,
}

/// A burn from one time to another.
#[lie_poisson_system(group = R1, force = vector![if t < start { 0.0 } else if t < stop { 1.0 } else { 0.0 }], taylor)]
struct Burn {
    #[inertia]
    mass: f64,
    start: f64,
    stop: f64,
}

/// A control of the speed that saturates.
#[lie_poisson_system(group = R1, force = vector![gain * (goal - velocity.x).clamp(-1.0, 1.0)], taylor)]
struct Saturated {
    #[inertia]
    mass: f64,
    gain: f64,
    goal: f64,
}

/// A fall on a spring.
#[lie_poisson_system(
    group = R1,
    potential = mass * gravity * position.x + 0.5 * stiffness * (-position.x).max(0.0).powi(2),
    taylor
)]
struct Bounce {
    #[inertia]
    mass: f64,
    gravity: f64,
    stiffness: f64,
}

/// A potential whose force is zero at the middle as a norm is.
#[lie_poisson_system(group = R2, potential = stiffness * position.norm().powi(3), taylor)]
struct Cubic {
    #[inertia]
    mass: f64,
    stiffness: f64,
}

/// The same on a line, without a norm.
#[lie_poisson_system(group = R1, potential = stiffness * position.x.powi(3), taylor)]
struct HalfCubic {
    #[inertia]
    mass: f64,
    stiffness: f64,
}

/// A slide that dry friction holds.
#[lie_poisson_system(group = R1, force = vector![if velocity.x > 0.0 { -friction } else { friction }], taylor)]
struct Slide {
    #[inertia]
    mass: f64,
    friction: f64,
}

/// A push that is smooth, and comes from afar.
#[lie_poisson_system(group = R1, force = vector![1.0 / ((t - middle) * sharpness).cosh().powi(2)], taylor)]
struct Push {
    #[inertia]
    mass: f64,
    middle: f64,
    sharpness: f64,
}

/// A push that a clock of many digits turns.
#[lie_poisson_system(group = R1, force = vector![t.cos()], taylor)]
struct Clock {
    #[inertia]
    mass: f64,
}

/// A spring that dry friction holds.
#[lie_poisson_system(
    group = R1,
    potential = 0.5 * stiffness * position.x.powi(2),
    force = vector![-friction * velocity.x.signum()],
    taylor
)]
struct Stuck {
    #[inertia]
    mass: f64,
    stiffness: f64,
    friction: f64,
}

/// A force that sets in smoothly, and is first what rounding leaves.
#[lie_poisson_system(group = R1, force = vector![((t - middle) * sharpness).tanh() + 1.0], taylor)]
#[derive(Clone)]
struct Ramp {
    #[inertia]
    mass: f64,
    middle: f64,
    sharpness: f64,
}

/// A mass that is pushed.
#[lie_poisson_system(group = R1, control(force: R1), force = force, taylor)]
struct Pushed {
    #[inertia]
    mass: f64,
}

fn reached<S: PowerSeries + System<Scalar = f64>>(
    system: &S,
    start: &S::State,
    time: f64,
) -> (S::State, u64) {
    let mut state = start.clone();
    let report = system.adaptive(1e-12).expect("a tolerance").to(&mut state, time).expect("a motion");
    (state, report.steps)
}

fn line<S: System<Scalar = f64>>(position: f64, momentum: f64) -> S::State
where
    S::State: State<Scalar = f64, Components = [f64; 2]>,
{
    S::State::from_components(&[position, momentum])
}

#[track_caller]
fn close(got: f64, right: f64, tolerance: f64) {
    assert!((got - right).abs() <= tolerance * right.abs().max(1.0), "{got} in place of {right}");
}

fn ball() -> Ball {
    Ball { mass: 1.0, gravity: 9.81, drag: 0.2 }
}

/// Where the fall of a ball thrown upward ends: height and speed.
fn thrown(ball: &Ball, up: f64, time: f64) -> (f64, f64) {
    let (limit, rate) = ((ball.gravity / ball.drag).sqrt(), (ball.gravity * ball.drag).sqrt());
    let angle = (up.max(0.0) / limit).atan();
    let rest = (time - angle / rate) * rate + (-up).max(0.0) / limit;
    let above = -angle.cos().ln() / ball.drag;
    (above - rest.cosh().ln() / ball.drag, -limit * rest.tanh())
}

#[test]
fn drag_is_felt_from_rest_and_through_it() {
    let ball = ball();
    for up in [0.0, -1e-12, -1e-6, 5.0] {
        for aside in [0.0, 1e-6] {
            let start = BallState { position: Vector3::zeros(), momentum: vector![aside, 0.0, up] };
            let (end, steps) = reached(&ball, &start, 2.0);
            let (height, speed) = thrown(&ball, up, 2.0);
            close(end.momentum.z, speed, 1e-9);
            close(end.position.z, height, 1e-9);
            assert!(steps < 1000, "{steps} steps");
        }
    }
}

#[test]
fn jumps_in_time_are_closed_in_on() {
    for (start, stop, time) in [(0.0, 1.0, 10.0), (1.0, 2.0, 10.0), (3.0, 3.5, 7.0)] {
        let burn = Burn { mass: 1.0, start, stop };
        let (end, steps) = reached(&burn, &line::<Burn>(0.0, 0.0), time);
        close(end.momentum.x, stop - start, 1e-10);
        close(end.position.x, (stop - start) * (time - 0.5 * (stop + start)), 1e-10);
        assert!(steps < 20, "{steps} steps");
    }
}

#[test]
fn branches_of_the_state_are_closed_in_on() {
    let saturated = Saturated { mass: 1.0, gain: 1.0, goal: 10.0 };
    let (end, _) = reached(&saturated, &line::<Saturated>(0.0, 0.0), 12.0);
    close(end.momentum.x, 10.0 - (-3.0_f64).exp(), 1e-10);

    let bounce = Bounce { mass: 1.0, gravity: 9.81, stiffness: 1e4 };
    let start = line::<Bounce>(1.0, 0.0);
    // a half-turn of an oscillation about where the spring carries the weight, between two flights
    let (speed, turn, sag) = ((2.0 * 9.81_f64).sqrt(), 100.0, 9.81 / 1e4);
    let flight = speed / 9.81;
    let contact = 2.0 * (std::f64::consts::PI - (speed / turn / sag).atan()) / turn;
    let (end, _) = reached(&bounce, &start, 2.0 * flight + contact);
    close(end.position.x, 1.0, 1e-9);
    close(end.momentum.x, 0.0, 1e-8);
}

#[test]
fn a_norm_that_starts_at_zero_acts() {
    let cubic = Cubic { mass: 1.0, stiffness: 1.0 };
    let start = CubicState { position: Vector2::zeros(), momentum: vector![1.0, 0.0] };
    let (half, _) = reached(&HalfCubic { mass: 1.0, stiffness: 1.0 }, &line::<HalfCubic>(0.0, 1.0), 0.7);
    let (end, _) = reached(&cubic, &start, 0.7);
    close(end.position.x, half.position.x, 1e-10);
    close(end.momentum.x, half.momentum.x, 1e-10);
    let (end, _) = reached(&cubic, &start, 2.0);
    close(cubic.energy(&end), 0.5, 1e-10);
}

#[test]
fn a_push_from_afar_is_not_passed_by() {
    let push = Push { mass: 1.0, middle: 5.0, sharpness: 20.0 };
    let (end, _) = reached(&push, &line::<Push>(0.0, 0.0), 10.0);
    close(end.momentum.x, 0.1, 1e-9);
}

#[test]
fn rounding_of_a_late_time_does_not_shorten_steps() {
    let clock = Clock { mass: 1.0 };
    let mut steps = clock.adaptive(1e-12).expect("a tolerance");
    steps.set_time(1e9);
    let mut state = line::<Clock>(0.0, 0.0);
    let report = steps.to(&mut state, 1e9 + 30.0).expect("a motion");
    assert!(report.steps < 45, "{}", report.steps);
    close(state.momentum.x, (1e9_f64 + 30.0).sin() - 1e9_f64.sin(), 1e-6);
}

#[test]
fn what_holds_the_motion_at_a_jump_is_an_error() {
    let slide = Slide { mass: 1.0, friction: 1.0 };
    let mut state = line::<Slide>(0.0, 1.0);
    let error = slide.adaptive(1e-9).expect("a tolerance").to(&mut state, 3.0).expect_err("it is held");
    assert!(matches!(error.cause, StepError::Jumps { .. }), "{error}");
    close(error.time, 1.0, 1e-6);
    close(state.position.x, 0.5, 1e-8);
    let mut steps = slide.adaptive(1e-9).and_then(|steps| steps.with_step(0.01)).expect("a step");
    steps.to(&mut line::<Slide>(0.0, 1.0), 3.0).expect("steps that are not looked at");
}

#[test]
fn members_side_by_side_and_erased_systems_take_the_same_shorter_steps() {
    let ball = ball();
    let state =
        |k: u32| BallState { position: Vector3::zeros(), momentum: vector![0.0, 0.0, f64::from(k) - 2.0] };
    let mut members: Vec<_> =
        (0..9).map(|k| (ball.adaptive(1e-12).expect("a tolerance"), state(k))).collect();
    let reports = taylor::all_to(&mut members, 2.0);
    for (k, ((_, together), report)) in (0..).zip(members.iter().zip(reports)) {
        let (alone, steps) = reached(&ball, &state(k), 2.0);
        assert_eq!(together.to_components(), alone.to_components());
        assert_eq!(report.expect("a motion").steps, steps);
        let mut erased = state(k).to_components().to_vec();
        let mut trajectory = erased::Adaptive::new(Arc::new(ball.clone()), 1e-12).expect("series");
        coadjoint::Run::new(&mut trajectory, &mut erased).to(2.0).expect("a motion");
        assert_eq!(erased[..], alone.to_components()[..]);
    }
}

#[test]
fn jumps_at_late_times_and_at_the_end_are_crossed() {
    for (start, stop, from, to) in [
        (1e5, 1e9, 1e5 - 5.0, 1e5 + 3.0),
        (1e9, 2e9, 1e9 - 5.0, 1e9 + 3.0),
        (3.0, 9.0, 0.0, 3.0),
        (0.5, 9.0, 0.0, 0.5),
    ] {
        for momentum in [0.0, 1.0] {
            let mut steps = Burn { mass: 1.0, start, stop }.adaptive(1e-12).expect("a tolerance");
            steps.set_time(from);
            let mut state = line::<Burn>(0.0, momentum);
            steps.to(&mut state, to).expect("a motion");
            close(state.momentum.x, momentum + (to - start), 1e-6_f64.max(4.0 * f64::EPSILON * to));
        }
    }
}

#[test]
fn friction_that_holds_in_the_midst_of_a_swing_is_an_error() {
    for position in [0.1, 0.7, 2.5, 3.1] {
        let stuck = Stuck { mass: 1.0, stiffness: 1.0, friction: 0.3 };
        let mut state = line::<Stuck>(position, 0.0);
        let error = stuck.adaptive(1e-12).expect("a tolerance").to(&mut state, 20.0).expect_err("it is held");
        assert!(matches!(error.cause, StepError::Jumps { .. }), "{error}");
        assert!(state.position.x.abs() <= 0.3, "{state:?}");
    }
}

#[test]
fn what_rounding_alone_moves_comes_to_an_end() {
    let ramp = Ramp { mass: 1.0, middle: 5.0, sharpness: 5.0 };
    for (momentum, tolerance) in [(1.0, 1e-12), (0.0, 1e-4)] {
        let (mut state, mut steps) =
            (line::<Ramp>(0.0, momentum), ramp.adaptive(tolerance).expect("a tolerance"));
        steps.to(&mut state, 10.0).expect("a motion");
        close(state.momentum.x, momentum + 10.0, 10.0 * tolerance);
    }
    let mut state = line::<Ramp>(0.0, 0.0);
    let ended = Ramp { sharpness: 3.0, ..ramp }.adaptive(1e-12).expect("a tolerance").to(&mut state, 10.0);
    let said = ended.expect_err("millions of steps");
    assert!(matches!(said.cause, StepError::Jumps { .. }), "{said}");
}

#[test]
fn runs_end_steps_at_breakpoints() {
    let pushed = Pushed { mass: 1.0 };
    let (times, values) = ([0.0, 1.0, 2.0], [0.0, 1.0, 0.0]);
    let law = |_: &PushedState, time: f64| {
        let place = times.partition_point(|known| *known <= time).saturating_sub(1);
        PushedControl { force: vector![values[place]] }
    };
    let mut state = PushedState { position: vector![0.0], momentum: vector![0.0] };
    let mut steps = pushed.adaptive(1e-12).expect("a tolerance");
    let report =
        coadjoint::Run::new(&mut steps, &mut state).with_breakpoints(&times).controlled_by(law).to(5.0);
    assert_eq!(report.expect("a motion").steps, 3);
    close(state.position.x, 3.5, 1e-14);
    // and back
    let back = |_: &PushedState, time: f64| {
        let place = times.partition_point(|known| *known < time).saturating_sub(1);
        PushedControl { force: vector![values[place]] }
    };
    let run = coadjoint::Run::new(&mut steps, &mut state).with_breakpoints(&times).controlled_by(back);
    run.to(0.0).expect("a motion");
    close(state.position.x, 0.0, 1e-14);
    close(state.momentum.x, 0.0, 1e-14);
}
