//! Forces and energies that are written piece by piece: against closed forms, piece by piece.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use coadjoint::certify::{Report, Verdict, certify};
use coadjoint::derivative::WrtState;
use coadjoint::prelude::*;
use coadjoint::{Discretized, Ensemble, StepError, System};

/// A spring whose force is limited.
#[lie_poisson_system(
    group = R1,
    force = vector![(-stiffness * position.x).clamp(-limit, limit)],
    methods(Midpoint),
    derivatives(state),
)]
#[derive(Clone)]
struct Servo {
    #[inertia]
    mass: f64,
    stiffness: f64,
    limit: f64,
}

/// Limits that cross: the upper one, in a step and in the method of the text.
#[test]
fn limits_that_cross() {
    let servo = Servo { mass: 2.0, stiffness: 3.0, limit: -0.5 };
    let mut state = ServoState { position: vector![0.1], momentum: vector![0.0] };
    assert_eq!(servo.force(&state), vector![-0.5]);
    let mut stepper = servo.stepper::<Exponential>(0.01).unwrap();
    (0..100).for_each(|_| _ = stepper.step(&mut state).unwrap());
    assert!((state.momentum.x + 0.5).abs() < 1e-14, "{}", state.momentum.x);
}

/// A mass that a wall pushes back.
#[lie_poisson_system(
    group = R1,
    potential = 0.5 * stiffness * position.x.max(0.0).powi(2),
    methods(Midpoint),
    derivatives(state),
)]
struct Bumper {
    #[inertia]
    mass: f64,
    stiffness: f64,
}

/// A sled on dry ground.
#[lie_poisson_system(group = R1, force = vector![-friction * velocity.x.signum()], methods(Midpoint))]
struct Sled {
    #[inertia]
    mass: f64,
    friction: f64,
}

/// The same, with friction that grows with the velocity up to a limit.
#[lie_poisson_system(
    group = R1,
    force = vector![-friction * (velocity.x / creep).clamp(-1.0, 1.0)],
    methods(Midpoint),
)]
struct Creeping {
    #[inertia]
    mass: f64,
    friction: f64,
    creep: f64,
}

/// A rocket that burns out.
#[lie_poisson_system(
    group = R1,
    potential = mass * gravity * position.x,
    force = vector![if t < burn { thrust } else { 0.0 }],
)]
struct Rocket {
    #[inertia]
    mass: f64,
    gravity: f64,
    thrust: f64,
    burn: f64,
}

/// Added mass on the way ahead alone.
#[lie_poisson_system(
    group = R1,
    lagrangian = 0.5 * mass * velocity.norm_squared() + 0.5 * added * velocity.x.max(0.0).powi(2),
)]
struct Oyster {
    mass: f64,
    added: f64,
}

/// A body with a spring that is slack within an angle and beside a plane.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = {
        let (bend, away) = ((gamma.z - edge).max(0.0), gamma.x);
        0.5 * stiffness * if away > 0.0 && bend > 0.0 { (bend * away).powi(2) } else { 0.0 }
    },
    methods(Midpoint),
)]
struct Slack {
    #[inertia]
    inertia: Vector3<f64>,
    stiffness: f64,
    edge: f64,
}

/// Drag that has a derivative at rest, a root that is real on one side alone, and what is divided by zero on the other.
#[lie_poisson_system(
    group = R1,
    force = {
        let (x, v) = (position.x, velocity.x);
        let held = if x > 0.0 { x.sqrt() / x } else { 1.0 };
        vector![-drag * v.abs() * v - if x < 0.0 { (-x).powf(1.5) } else { 0.0 } * held.min(1e3)]
    },
    derivatives(state),
    methods(Midpoint),
)]
struct Guarded {
    #[inertia]
    mass: f64,
    drag: f64,
}

/// Takes so many steps of the length from a state.
fn walk<M, S>(system: &S, mut state: S::State, step: f64, steps: usize) -> S::State
where
    S: Discretized<M> + System<Scalar = f64>,
{
    let mut stepper = system.stepper::<M>(step).unwrap();
    (0..steps).for_each(|_| _ = stepper.step(&mut state).unwrap());
    state
}

const SERVO: Servo = Servo { mass: 2.0, stiffness: 8.0, limit: 4.0 };

fn servo_at(position: f64, momentum: f64) -> ServoState {
    ServoState { position: vector![position], momentum: vector![momentum] }
}

#[test]
fn a_limited_spring() {
    // from x = 2: constant force to x = ½, then a swing
    let (omega, a) = (2.0_f64, 2.0_f64);
    let pulled = (2.0 * 1.5 / a).sqrt();
    let swing = omega * (1.4 - pulled);
    let exact = 0.5 * swing.cos() - a * pulled / omega * swing.sin();
    for steps in [100, 400, 1600] {
        let step = 1.4 / steps as f64;
        for state in [
            walk::<Midpoint, _>(&SERVO, servo_at(2.0, 0.0), step, steps),
            walk::<Exponential, _>(&SERVO, servo_at(2.0, 0.0), step, steps),
        ] {
            let error = (state.position.x - exact).abs();
            assert!(error < 0.3 * step * step, "{steps}: {error:e}");
        }
    }
}

#[test]
fn a_wall_gives_back_what_it_takes() {
    let bumper = Bumper { mass: 0.5, stiffness: 200.0 };
    // one second to the wall, half a swing in it, and back
    let contact = std::f64::consts::PI / 20.0;
    for steps in [500, 2000, 8000] {
        let start = BumperState { position: vector![-1.0], momentum: vector![0.5] };
        let step = 2.0 / steps as f64;
        let state = walk::<Exponential, _>(&bumper, start, step, steps);
        let error = (state.position.x + 1.0 - contact).abs();
        assert!(error < 60.0 * step * step, "{steps}: {error:e}");
        assert!((bumper.energy(&state) - 0.25).abs() < 60.0 * step * step);
    }
}

#[test]
fn dry_friction_slows_down_and_does_not_hold() {
    let sled = Sled { mass: 2.0, friction: 3.0 };
    for sign in [1.0, -1.0] {
        let start = SledState { position: vector![0.0], momentum: vector![sign * 4.0] };
        // for 1.3 s of 4/3 s
        let x = sign * (2.0 * 1.3 - 0.75 * 1.69);
        for state in [
            walk::<Exponential, _>(&sled, start, 0.01, 130),
            walk::<Midpoint, _>(&sled, start, 0.01, 130),
            walk::<Compensated<Midpoint>, _>(&sled, start, 0.01, 130),
        ] {
            assert!((state.momentum.x - sign * 0.1).abs() < 1e-13, "{state:?}");
            assert!((state.position.x - x).abs() < 1e-13, "{state:?}");
        }
        // the force jumps over what would hold it
        let mut state = walk::<Midpoint, _>(&sled, start, 0.01, 130);
        let mut stepper = sled.stepper::<Midpoint>(0.01).unwrap();
        let stopped = (0..10).find_map(|_| stepper.step(&mut state).err()).unwrap();
        assert!(
            matches!(stopped, StepError::NoConvergence { .. } | StepError::NoSolution { .. }),
            "{stopped}"
        );
        assert!((0.0..0.02).contains(&(sign * state.momentum.x)), "{state:?}");

        // what grows with the velocity up to the same limit does
        let creeping = Creeping { mass: 2.0, friction: 3.0, creep: 1e-3 };
        let start = CreepingState { position: vector![0.0], momentum: vector![sign * 4.0] };
        let state = walk::<Midpoint, _>(&creeping, start, 0.01, 300);
        // m v/F of creep at the end is 2/3000 s long
        assert!(
            (sign * state.position.x - 4.0 / 3.0).abs() < 1e-5 && state.momentum.x.abs() < 1e-12,
            "{state:?}"
        );
    }
}

/// A jump costs the order, unless it is between two steps.
#[test]
fn a_rocket_burns_out() {
    let rocket = Rocket { mass: 2.0, gravity: 10.0, thrust: 60.0, burn: 0.75 };
    let exact = 0.5 * 20.0 * 0.75 * 0.75 + 15.0 * 1.25 - 5.0 * 1.25 * 1.25;
    for (steps, within) in [(200, 1.0), (400, 1e-10), (1601, 1.0)] {
        let start = RocketState { position: vector![0.0], momentum: vector![0.0] };
        let step = 2.0 / f64::from(steps);
        let mut stepper = rocket.stepper::<Exponential>(step).unwrap();
        let mut state = start;
        (0..steps).for_each(|_| _ = stepper.step(&mut state).unwrap());
        // half a step of thrust, at most, for the rest of the time
        let most = 0.5 * step * 30.0 * 1.3;
        assert!((state.position.x - exact).abs() < within * most, "{steps}: {}", state.position.x - exact);
    }
}

#[test]
fn momenta_of_velocities() {
    let oyster = Oyster { mass: 2.0, added: 1.0 };
    for v in [1.5, -1.5, 0.0] {
        let rest = OysterState { position: vector![0.0], momentum: vector![0.0] };
        let state = oyster.with_velocity(&rest, &vector![v]).unwrap();
        let expected = if v > 0.0 { 3.0 * v } else { 2.0 * v };
        assert_eq!(state.momentum.x, expected);
        assert!((oyster.velocity(&state).x - v).abs() < 1e-15);
        assert!((oyster.energy(&state) - 0.5 * expected * v).abs() < 1e-15);
        let state = walk::<Exponential, _>(&oyster, state, 0.1, 10);
        assert!((state.position.x - v).abs() < 1e-14 && state.momentum.x == expected, "{state:?}");
    }
}

const SLACK: Slack = Slack { inertia: Vector3::new(1.0, 2.0, 2.5), stiffness: 40.0, edge: 0.5 };

fn slack_at(gamma: Vector3<f64>) -> SlackState {
    SlackState { attitude: UnitQuaternion::identity(), momentum: vector![0.4, -0.8, 1.5], gamma }
}

/// Against Runge and Kutta's method with short steps on equations that were written down by hand.
#[test]
fn a_slack_spring_on_a_body() {
    let rate = |(p, gamma): (Vector3<f64>, Vector3<f64>)| {
        let omega = p.component_div(&SLACK.inertia);
        let (bend, away) = ((gamma.z - SLACK.edge).max(0.0), gamma.x.max(0.0));
        let slope = SLACK.stiffness * vector![bend * bend * away, 0.0, bend * away * away];
        (p.cross(&omega) + gamma.cross(&slope), gamma.cross(&omega))
    };
    let start = slack_at(vector![0.6, 0.0, 0.8]);
    let (mut now, h) = ((start.momentum, start.gamma), 2e-4);
    let mut pulls = 0;
    for _ in 0..25_000 {
        let at = |k: (Vector3<f64>, Vector3<f64>), h: f64| (now.0 + h * k.0, now.1 + h * k.1);
        let a = rate(now);
        let b = rate(at(a, h / 2.0));
        let c = rate(at(b, h / 2.0));
        let d = rate(at(c, h));
        let before = now.1.z > SLACK.edge && now.1.x > 0.0;
        now.0 += h / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
        now.1 += h / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
        pulls += usize::from(before != (now.1.z > SLACK.edge && now.1.x > 0.0));
    }
    assert!(pulls > 2, "the spring is slack and taut in turns: {pulls}");
    for steps in [1_000, 4_000] {
        let step = 5.0 / steps as f64;
        for state in [
            walk::<Exponential, _>(&SLACK, start, step, steps),
            walk::<Midpoint<Cayley>, _>(&SLACK, start, step, steps),
        ] {
            let error = (state.momentum - now.0).amax().max((state.gamma - now.1).amax());
            assert!(error < 200.0 * step * step, "{steps}: {error:e}");
        }
    }
}

#[test]
fn derivatives_are_those_of_the_branch_taken() {
    let jacobian = |state: ServoState| {
        let mut state = state;
        let mut stepper = SERVO.stepper::<Midpoint>(0.1).unwrap();
        stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtState).unwrap().0
    };
    // nothing but the drift where the force is constant
    for x in [2.0, -2.0] {
        assert_eq!(jacobian(servo_at(x, 0.3)), matrix![1.0, 0.05; 0.0, 1.0]);
    }
    // the midpoint rule of a swing: (1 − A/2)⁻¹ (1 + A/2)
    let half = matrix![0.0, 0.025; -0.4, 0.0];
    let swing = (Matrix2::identity() - half).try_inverse().unwrap() * (Matrix2::identity() + half);
    assert!((jacobian(servo_at(0.1, 0.3)) - swing).amax() < 1e-14);

    // where one branch is no number, the other's derivatives are there
    let guarded = Guarded { mass: 2.0, drag: 3.0 };
    for (x, slope) in [(0.5, 0.0), (-0.5, -1.5 * 0.5_f64.sqrt()), (0.0, 0.0)] {
        let h = 1e-6;
        let mut state = GuardedState { position: vector![x], momentum: vector![0.0] };
        let mut stepper = guarded.stepper::<Midpoint>(h).unwrap();
        let jacobian = stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtState).unwrap().0;
        // at rest there is no drag, nor does it change
        let expected = matrix![1.0, h / 2.0; -h * slope, 1.0];
        assert!((jacobian - expected).amax() < 1e-11, "{x}: {jacobian}");
        assert!(walk::<Midpoint, _>(&guarded, state, 0.01, 100).position.x.is_finite());
    }
}

#[test]
fn members_on_different_branches_move_as_alone() {
    let starts: Vec<_> = (0..11).map(|k| servo_at(0.3 * f64::from(k) - 1.5, 0.2)).collect();
    let mut ensemble = Ensemble::<_, Midpoint>::new(&vec![SERVO; 11], starts.clone(), 0.02).unwrap();
    ensemble.run(200);
    for (together, start) in ensemble.states().zip(starts) {
        assert_eq!(together, walk::<Midpoint, _>(&SERVO, start, 0.02, 200));
    }
}

fn passes(report: &Report, energy: bool) {
    assert!(report.passed(), "{report}");
    let order = report.certificate("order").unwrap();
    assert_eq!(order.verdict, Verdict::Passed, "{report}");
    if energy {
        assert_eq!(report.certificate("energy order").unwrap().verdict, Verdict::NotClaimed);
        assert_eq!(report.certificate("Poisson map").unwrap().verdict, Verdict::Passed, "{report}");
    }
}

#[test]
fn certificates() {
    const { assert!(Servo::PIECEWISE && Rocket::PIECEWISE && Oyster::PIECEWISE) };
    let states = [0.3, 0.52, 2.0].map(|x| servo_at(x, 0.7));
    passes(&certify::<Midpoint, _>(&SERVO, &states).unwrap(), false);
    passes(&certify::<Order4<Exponential>, _>(&SERVO, &states).unwrap(), false);
    let bumper = Bumper { mass: 0.5, stiffness: 200.0 };
    let states = [0.3, -0.05, -0.3].map(|x| BumperState { position: vector![x], momentum: vector![0.7] });
    passes(&certify::<Exponential, _>(&bumper, &states).unwrap(), true);
    passes(&certify::<Order4<Exponential>, _>(&bumper, &states).unwrap(), true);
    let states = [vector![0.6, 0.0, 0.8], vector![-0.48, 0.6, 0.64], vector![-0.8, 0.6, 0.0]].map(slack_at);
    passes(&certify::<Exponential, _>(&SLACK, &states).unwrap(), true);
    passes(&certify::<Midpoint<Cayley>, _>(&SLACK, &states).unwrap(), true);
    // under dry friction every step is exact, until there is none
    let sled = Sled { mass: 2.0, friction: 3.0 };
    let states = [0.3, 3.0].map(|p| SledState { position: vector![0.1], momentum: vector![p] });
    let report = certify::<Midpoint, _>(&sled, &states).unwrap();
    assert!(report.passed(), "{report}");
}
