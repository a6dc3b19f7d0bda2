//! Inputs that are functions of time, within Taylor steps: as accurate as the tolerance.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use coadjoint::prelude::*;
use coadjoint::{Run, State, erased};

/// A damped pendulum with a torque.
#[lie_poisson_system(
    group = SO2,
    control(torque: f64, shake: f64),
    potential = -weight * (1.0 + shake) * angle.cos_angle(),
    force = vector![torque - damping * velocity.x],
    event(down = angle.angle()),
    taylor,
    retractions(Exponential)
)]
struct Pendulum {
    #[inertia]
    inertia: f64,
    weight: f64,
    damping: f64,
}

/// The same, with the inputs in its description.
#[lie_poisson_system(
    group = SO2,
    potential = -weight * (1.0 + shaken * (3.0 * t).sin()) * angle.cos_angle(),
    force = vector![0.4 * (0.7 * t).cos() + 0.2 * (-t).exp() - damping * velocity.x],
    event(down = angle.angle()),
    taylor,
    retractions(Exponential)
)]
struct Described {
    #[inertia]
    inertia: f64,
    weight: f64,
    damping: f64,
    shaken: f64,
}

/// A mass that is pushed.
#[lie_poisson_system(group = R1, control(push: f64), force = push, taylor, retractions(Exponential))]
struct Mass {
    #[inertia]
    mass: f64,
}

fn input(time: f64) -> PendulumControl {
    PendulumControl {
        torque: 0.4 * (0.7 * time).cos() + 0.2 * (-time).exp(),
        shake: 0.25 * (3.0 * time).sin(),
    }
}

fn pendulum() -> (Pendulum, PendulumState) {
    let start = PendulumState { angle: UnitComplex::new(0.8), momentum: vector![0.5] };
    (Pendulum { inertia: 1.2, weight: 2.0, damping: 0.1 }, start)
}

fn distance<S: State<Scalar = f64>>(a: &S, b: &S) -> f64 {
    let (a, b) = (a.to_components(), b.to_components());
    a.as_ref().iter().zip(b.as_ref()).fold(0.0, |largest: f64, (a, b)| largest.max((a - b).abs()))
}

#[test]
fn the_error_follows_the_tolerance() {
    let (system, start) = pendulum();
    let described = Described { inertia: 1.2, weight: 2.0, damping: 0.1, shaken: 0.25 };
    let mut exact = DescribedState { angle: start.angle, momentum: start.momentum };
    let (mut events, mut trajectory) = (Vec::new(), described.adaptive(1e-15).unwrap());
    Run::new(&mut trajectory, &mut exact).on("down", |event| events.push(event.time())).to(30.0).unwrap();
    let exact = PendulumState { angle: exact.angle, momentum: exact.momentum };
    let mut all = Vec::new();
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14] {
        let (mut state, mut trajectory) = (start, system.adaptive(tolerance).unwrap());
        let (mut asked, mut found) = (0, Vec::new());
        let report = Run::new(&mut trajectory, &mut state)
            .driven_by(|time| {
                asked += 1;
                input(time)
            })
            .on("down", |event| found.push(event.time()))
            .to(30.0)
            .unwrap();
        let error = distance(&state, &exact);
        assert!(error < 100.0 * tolerance && asked < 20_000, "{tolerance:e}: {error:e}, asked {asked} times");
        assert_eq!(found.len(), events.len());
        let off = found.iter().zip(&events).fold(0.0, |off: f64, (a, b)| off.max((a - b).abs()));
        assert!(off < 100.0 * tolerance, "{tolerance:e}: {off:e}");
        all.push(report.steps);

        // backward it comes back
        let mut back = state;
        Run::new(&mut trajectory, &mut back).driven_by(input).to(0.0).unwrap();
        assert!(distance(&back, &start) < 1e3 * tolerance, "{tolerance:e}: {:e}", distance(&back, &start));
    }
    assert!(all[5] < 3 * all[0], "{all:?}");

    // where types are erased, to the last bit
    let mut typed = start;
    Run::new(&mut system.adaptive(1e-10).unwrap(), &mut typed).driven_by(input).to(7.0).unwrap();
    let mut state = start.to_components().to_vec();
    let mut trajectory = erased::Adaptive::new(Arc::new(system), 1e-10).unwrap();
    let numbers = |time: f64| {
        let PendulumControl { torque, shake } = input(time);
        vec![torque, shake]
    };
    Run::new(&mut trajectory, &mut state).driven_by(numbers).to(7.0).unwrap();
    assert_eq!(state, typed.to_components());
}

#[test]
fn jumps_and_kinks_are_closed_in_on() {
    let system = Mass { mass: 2.0 };
    // a step at 1/3 and back at 2, and a kink at 1
    let push = |time: f64| if (1.0 / 3.0..2.0).contains(&time) { 1.0 } else { 0.0 } + (time - 1.0).abs();
    // the integrals from 0 to 3, once and twice
    let momentum = 5.0 / 3.0 + 2.5;
    let position = |from: f64| 0.5 * (3.0 - from) * (3.0 - from);
    // |t − 1| is 1 − t, whose second integral from 0 to 3 is 0, and 2 (t − 1) from 1 on
    let place = (position(1.0 / 3.0) - position(2.0) + 2.0 * 8.0 / 6.0) / 2.0;
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let mut state = MassState { position: vector![0.0], momentum: vector![0.0] };
        let (mut trajectory, mut asked) = (system.adaptive(tolerance).unwrap(), 0);
        let run = Run::new(&mut trajectory, &mut state);
        let counted = |time: f64| {
            asked += 1;
            MassControl { push: push(time) }
        };
        let report = run.driven_by(counted).to(3.0).unwrap();
        let off = (state.momentum.x - momentum).abs().max((state.position.x - place).abs());
        assert!(off < 10.0 * tolerance, "{tolerance:e}: {off:e}");
        assert!(report.steps < 300 && asked < 10_000, "{} {asked}", report.steps);
    }
}

/// A bob whose pivot is moved, and whose mass swells: its momentum depends on both controls, and not linearly on its velocity.
#[lie_poisson_system(
    group = SO2,
    control(shift: f64, swell: f64),
    lagrangian = {
        let (v, m) = (velocity.x, mass * (1.0 + swell * swell));
        0.5 * m * v.powi(2) + 0.05 * v.powi(4) + m * shift * v * angle.cos_angle() + m * angle.cos_angle()
    },
    force = -damping * velocity,
    event(down = angle.angle(), turns = velocity.x),
    taylor,
    retractions(Exponential)
)]
struct Moved {
    mass: f64,
    damping: f64,
}

/// The same, with what moves it in its description.
#[lie_poisson_system(
    group = SO2,
    lagrangian = {
        let (shift, swell) = (2.0 * (3.0 * t).sin(), 0.5 * (2.0 * t).cos());
        let (v, m) = (velocity.x, mass * (1.0 + swell * swell));
        0.5 * m * v.powi(2) + 0.05 * v.powi(4) + m * shift * v * angle.cos_angle() + m * angle.cos_angle()
    },
    force = -damping * velocity,
    event(down = angle.angle(), turns = velocity.x),
    taylor,
    retractions(Exponential)
)]
struct MovedByTime {
    mass: f64,
    damping: f64,
}

#[test]
fn a_momentum_that_depends_on_the_input_moves_with_it() {
    let (driven, described) = (Moved { mass: 1.3, damping: 0.1 }, MovedByTime { mass: 1.3, damping: 0.1 });
    let start = MovedState { angle: UnitComplex::new(0.8), momentum: vector![0.5] };
    let input = |time: f64| MovedControl { shift: 2.0 * (3.0 * time).sin(), swell: 0.5 * (2.0 * time).cos() };
    let (mut events, mut trajectory) = (Vec::new(), described.adaptive(1e-15).unwrap());
    let mut exact = MovedByTimeState { angle: start.angle, momentum: start.momentum };
    Run::new(&mut trajectory, &mut exact).on("turns", |event| events.push(event.time())).to(5.0).unwrap();
    let exact = MovedState { angle: exact.angle, momentum: exact.momentum };
    assert!(events.len() > 2, "{events:?}");
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let (mut state, mut trajectory) = (start, driven.adaptive(tolerance).unwrap());
        let mut found = Vec::new();
        let run = Run::new(&mut trajectory, &mut state);
        run.driven_by(input).on("turns", |event| found.push(event.time())).to(5.0).unwrap();
        assert!(
            distance(&state, &exact) < 100.0 * tolerance,
            "{tolerance:e}: {:e}",
            distance(&state, &exact)
        );
        assert_eq!(found.len(), events.len());
        let off = found.iter().zip(&events).fold(0.0, |off: f64, (a, b)| off.max((a - b).abs()));
        assert!(off < 100.0 * tolerance, "{tolerance:e}: {off:e}");
    }
    // steps of one length know nothing of series
    let (mut state, mut stepper) = (start, driven.stepper::<Order6<Exponential>>(0.005).unwrap());
    Run::new(&mut stepper, &mut state).driven_by(input).to(5.0).unwrap();
    assert!(distance(&state, &exact) < 1e-10, "{:e}", distance(&state, &exact));
}

/// A mass on a spring that is pushed.
#[lie_poisson_system(
    group = R1,
    control(push: f64),
    potential = 0.5 * stiffness * position.x.powi(2),
    force = push,
    taylor,
    retractions(Exponential)
)]
struct Sprung {
    #[inertia]
    mass: f64,
    stiffness: f64,
}

/// Late in a run the roundoff of the time is more than the tolerance allows an input: no step is short enough for that.
#[test]
fn what_the_time_leaves_of_an_input_shortens_no_step() {
    let (system, rate) = (Sprung { mass: 1.0, stiffness: 4.0 }, 2.0 * std::f64::consts::PI);
    let amplitude = 1.0 / (4.0 - rate * rate);
    for (start, tolerance, enough) in
        [(0.0, 1e-12, 1e-10), (3e3, 1e-12, 1e-9), (1e5, 1e-14, 1e-8), (1e9, 1e-8, 1e-4)]
    {
        let mut state = SprungState { position: vector![1.0], momentum: vector![0.0] };
        let (mut trajectory, mut asked) = (system.adaptive(tolerance).unwrap(), 0);
        trajectory.set_time(start);
        let input = |time: f64| {
            asked += 1;
            SprungControl { push: (rate * time).sin() }
        };
        let report = Run::new(&mut trajectory, &mut state).driven_by(input).to(start + 10.0).unwrap();
        let forced = |time: f64| amplitude * (rate * time).sin();
        let (c, s) = (1.0 - forced(start), -0.5 * amplitude * rate * (rate * start).cos());
        let exact = forced(start + 10.0) + c * 20.0_f64.cos() + s * 20.0_f64.sin();
        let off = (state.position.x - exact).abs();
        assert!(off < enough, "{start:e}: {off:e}");
        assert!(
            report.steps < 500 && asked < 20_000,
            "{start:e}: {} steps, asked {asked} times",
            report.steps
        );
    }
}

/// What is in balance has momenta of nothing but what rounding, or the tolerance, leaves of an input: of that no share is to be right.
#[test]
fn what_an_input_holds_in_balance_takes_long_steps() {
    for (stiffness, tolerance) in [1.0, 2.0, 9.81]
        .into_iter()
        .flat_map(|stiffness| [1e-6, 1e-9, 1e-12].map(|tolerance| (stiffness, tolerance)))
    {
        let system = Sprung { mass: 1.0, stiffness };
        let run = |push: &dyn Fn(f64) -> f64| {
            let mut state = SprungState { position: vector![1.0], momentum: vector![0.0] };
            let mut trajectory = system.adaptive(tolerance).unwrap();
            let (mut asked, end) = (0, 4.0);
            let input = |time: f64| {
                asked += 1;
                // a run that does not end is no report
                assert!(asked < 100_000, "{stiffness} {tolerance:e}: asked at {time}");
                SprungControl { push: push(time) }
            };
            let report = Run::new(&mut trajectory, &mut state).driven_by(input).to(end).unwrap();
            (state.position.x, report.steps)
        };
        let (position, steps) = run(&|_| stiffness);
        assert!((position - 1.0).abs() < 1e-13 && steps < 40, "{position} {steps}");
        // of no pattern, far below the tolerance
        let noise = |time: f64| (1e5 * time).sin() * 1e-4 * tolerance;
        let (position, steps) = run(&|time| stiffness * (1.0 + noise(time)));
        assert!((position - 1.0).abs() < tolerance && steps < 200, "{tolerance:e}: {position} {steps}");
        let (position, steps) = run(&|time| if time < 1.0 { stiffness } else { -stiffness });
        let exact = 2.0 * (3.0 * stiffness.sqrt()).cos() - 1.0;
        assert!((position - exact).abs() < 10.0 * tolerance && steps < 400, "{position} {exact} {steps}");
    }
}

/// Where terms cancel but for little, that little is known to a few digits, and no step is short enough for more.
#[test]
fn what_is_nearly_in_balance_takes_long_steps() {
    for tolerance in [1e-6, 1e-9, 1e-12] {
        for off in [1e-15, 1e-14, 1e-12, 1e-9, 1e-6] {
            let system = Sprung { mass: 1.0, stiffness: 1.0 };
            let mut state = SprungState { position: vector![1.0], momentum: vector![0.0] };
            let mut trajectory = system.adaptive(tolerance).unwrap();
            let run = Run::new(&mut trajectory, &mut state).with_control(SprungControl { push: 1.0 + off });
            let steps = run.to(4.0).unwrap().steps;
            let (moved, exact) = (state.position.x - 1.0, ((1.0 + off) - 1.0) * (1.0 - 4.0_f64.cos()));
            assert!(
                (moved - exact).abs() < 1e-15 + 10.0 * tolerance * off,
                "{off:e}: {moved:e} for {exact:e}"
            );
            assert!(steps < 20, "{off:e} {tolerance:e}: {steps} steps");

            // upright beside its pivot, held by a torque
            let (weight, angle) = (2.0, 2.3_f64);
            let system = Pendulum { inertia: 1.2, weight, damping: 0.1 };
            let mut state = PendulumState { angle: UnitComplex::new(angle), momentum: vector![0.0] };
            let mut trajectory = system.adaptive(tolerance).unwrap();
            let control = PendulumControl { torque: weight * angle.sin() * (1.0 + off), shake: 0.0 };
            let run = Run::new(&mut trajectory, &mut state).with_control(control);
            let steps = run.to(4.0).unwrap().steps;
            assert!(steps < 40, "{off:e} {tolerance:e}: {steps} steps");
        }
    }
}
