//! Events of descriptions: none of their zeros is missed, and none is told twice.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;
use std::sync::Arc;

use coadjoint::prelude::*;
use coadjoint::stepper::Stepping;
use coadjoint::{Crossing, Event, Run, StepError, System, erased};

/// What moves evenly, and functions of where it is.
#[lie_poisson_system(
    group = R1,
    control(bias: f64),
    event(
        product = scale
            * (position.x - zeros[0]) * (position.x - zeros[1]) * (position.x - zeros[2]) * (position.x - zeros[3])
            * (position.x - zeros[4]) * (position.x - zeros[5]) * (position.x - zeros[6]) * (position.x - zeros[7])
            * (position.x - zeros[8]) * (position.x - zeros[9]) * (position.x - zeros[10]) * (position.x - zeros[11]),
        waves = (0..3).map(|k| weights[k] * (rates[k] * position.x + phases[k]).sin()).sum::<f64>(),
        touch = 1.0 - (3.0 * position.x).cos(),
        two = 1.0 - 1e-9 - (3.0 * position.x).cos(),
        above = 1.0 + 1e-9 - (3.0 * position.x).cos(),
        biased = position.x - 1.0 + bias, rising,
        kinked = (position.x - 0.5).abs() - 0.25, falling,
    ),
    taylor,
    retractions(Exponential)
)]
struct Even {
    #[inertia]
    mass: f64,
    scale: f64,
    zeros: [f64; 12],
    weights: Vector3<f64>,
    rates: Vector3<f64>,
    phases: Vector3<f64>,
}

/// A damped pendulum that is driven.
#[lie_poisson_system(
    group = SO2,
    potential = -weight * angle.cos_angle(),
    force = vector![amplitude * (rate * t).cos() - damping * velocity.x],
    event(down = angle.angle(), turn = velocity.x, both, rise = angle.sin_angle(), rising),
    taylor,
    methods(HamiltonJacobi(6)),
    retractions(Exponential)
)]
struct Pendulum {
    #[inertia]
    inertia: f64,
    weight: f64,
    damping: f64,
    amplitude: f64,
    rate: f64,
}

/// A heavy top.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
    event(level = gamma.z, swing = momentum.dot(&gamma.cross(&chi)), falling),
    taylor,
    retractions(Exponential)
)]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

/// A ball above a table.
#[lie_poisson_system(
    group = R1,
    potential = mass * gravity * position.x,
    event(bounce = position.x, falling),
    taylor,
    retractions(Exponential)
)]
struct Ball {
    #[inertia]
    mass: f64,
    gravity: f64,
}

/// A cart that is pushed along a fence.
#[lie_poisson_system(
    group = R1,
    control(push: f64),
    force = vector![push],
    event(post = (40.0 * position.x).sin()),
    taylor,
    retractions(Exponential)
)]
struct Cart {
    #[inertia]
    mass: f64,
}

fn even() -> (Even, EvenState) {
    let three = Vector3::zeros();
    let even = Even { mass: 1.0, scale: 1.0, zeros: [5.0; 12], weights: three, rates: three, phases: three };
    (even, EvenState { position: vector![0.0], momentum: vector![1.0] })
}

fn pendulum() -> (Pendulum, PendulumState) {
    let pendulum = Pendulum { inertia: 1.0, weight: 1.0, damping: 0.2, amplitude: 0.4, rate: 0.7 };
    (pendulum, PendulumState { angle: UnitComplex::new(0.8), momentum: vector![0.5] })
}

/// Numbers from 0 to 1, always the same.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.next()
    }
}

/// The events of this name until a time.
fn told(system: &Even, name: &str, tolerance: f64, end: f64) -> Vec<(f64, Crossing)> {
    let (mut trajectory, mut state, mut found) = (system.adaptive(tolerance).unwrap(), even().1, Vec::new());
    let run = Run::new(&mut trajectory, &mut state);
    run.on(name, |event| found.push((event.time(), event.crossing()))).to(end).unwrap();
    assert!(trajectory.steps_taken() == 1, "an even motion is one step");
    found
}

/// Where a function changes its sign from 0 to 1; none if it nearly touches zero.
fn crossings(function: impl Fn(f64) -> f64) -> Option<Vec<f64>> {
    const POINTS: usize = 1_000;
    let at = |k: usize| k as f64 / POINTS as f64;
    let values: Vec<f64> = (0..=POINTS).map(|k| function(at(k))).collect();
    let is_dip = |w: &[f64]| {
        w[1].abs() < w[0].abs().min(w[2].abs())
            && w[1].abs() < 0.2 * (w[0] + w[2] - 2.0 * w[1]).abs()
            && (w[0] > 0.0) == (w[2] > 0.0)
    };
    if values.windows(3).any(is_dip) {
        return None;
    }
    let changes = (0..POINTS).filter(|&k| (values[k] > 0.0) != (values[k + 1] > 0.0));
    let bisected = |k: usize| {
        let (mut from, mut to, first) = (at(k), at(k + 1), values[k] > 0.0);
        for _ in 0..60 {
            let middle = 0.5 * (from + to);
            if (function(middle) > 0.0) == first { from = middle } else { to = middle }
        }
        to
    };
    Some(changes.map(bisected).collect())
}

fn assert_told(system: &Even, name: &str, expected: &[f64], starts_positive: bool) {
    let all = told(system, name, 1e-12, 1.0);
    assert_eq!(all.len(), expected.len(), "{name}: {all:?} instead of {expected:?}");
    for (k, ((time, crossing), exact)) in all.iter().zip(expected).enumerate() {
        assert!((time - exact).abs() < 1e-12, "{name}: {time} instead of {exact}");
        let rises = starts_positive == (k % 2 == 1);
        assert_eq!(*crossing, if rises { Crossing::Rising } else { Crossing::Falling });
    }
}

#[test]
fn no_zero_of_a_polynomial_is_missed_in_one_step() {
    let (mut random, mut most) = (Random(1), 0);
    for _ in 0..2_000 {
        let mut system = even().0;
        let mut inside: Vec<f64> = Vec::new();
        for _ in 0..(random.next() * 13.0) as usize {
            let zero = random.between(0.01, 0.99);
            if inside.iter().all(|other| (other - zero).abs() > 1e-3) {
                inside.push(zero);
            }
        }
        for (k, zero) in system.zeros.iter_mut().enumerate() {
            let outside =
                if random.next() < 0.5 { random.between(-2.0, -0.1) } else { random.between(1.1, 3.0) };
            *zero = inside.get(k).copied().unwrap_or(outside);
        }
        inside.sort_by(f64::total_cmp);
        most = most.max(inside.len());
        let is_positive = system.event_product(&even().1, &EvenControl::default()) > 0.0;
        assert_told(&system, "product", &inside, is_positive);
    }
    assert!(most >= 11, "{most}");
}

/// Far from the start of the step, where the terms of its series are 10¹³ times as large as it is.
#[test]
fn zeros_that_lie_close_together_are_told_apart() {
    let mut system = even().0;
    system.zeros =
        [0.4896, 0.6765, 0.7264, 0.7878, 0.8372, 0.8421, 0.8802, 0.8867, 0.8966, 0.9187, 0.9288, 0.9588];
    let zeros = system.zeros;
    assert_told(&system, "product", &zeros, true);
}

#[test]
fn no_zero_of_a_sum_of_waves_is_missed_in_one_step() {
    let (mut random, mut most, mut tried) = (Random(2), 0, 0);
    while tried < 1_000 {
        let mut system = even().0;
        system.weights = vector![1.0, random.between(-0.4, 0.4), random.between(-0.3, 0.3)];
        for k in 0..3 {
            (system.rates[k], system.phases[k]) = (random.between(1.0, 38.0), random.between(0.0, 6.0));
        }
        let value = |x: f64| {
            let state = EvenState { position: vector![x], ..even().1 };
            system.event_waves(&state, &EvenControl::default())
        };
        let Some(expected) = crossings(value) else { continue };
        (tried, most) = (tried + 1, most.max(expected.len()));
        assert_told(&system, "waves", &expected, value(0.0) > 0.0);
    }
    assert!(most >= 11, "{most}");
}

#[test]
fn double_roots_are_told_and_what_stays_away_is_not() {
    let system = even().0;
    let each = [1.0, 2.0, 3.0].map(|k| 2.0 * PI / 3.0 * k);
    for tolerance in [1e-6, 1e-9, 1e-12, 1e-15] {
        let touches = told(&system, "touch", tolerance, 7.0);
        assert_eq!(touches.len(), 3, "{touches:?}");
        for ((time, crossing), exact) in touches.iter().zip(each) {
            assert_eq!(*crossing, Crossing::Touch);
            let allowed = 1e-12_f64.max(10.0 * tolerance);
            assert!((time - exact).abs() < allowed, "to {tolerance:e}: {time} instead of {exact}");
        }
        let pairs = told(&system, "two", tolerance, 7.0);
        // the first has its second half only
        assert_eq!(pairs.len(), 7, "{pairs:?}");
        let apart = 2e-9_f64.sqrt() / 3.0;
        assert!((pairs[0].0 - apart).abs() < 1e-9 && (pairs[2].0 - pairs[1].0 - 2.0 * apart).abs() < 1e-9);
        assert_eq!(told(&system, "above", tolerance, 7.0), []);
    }
    // there where the series says nothing, for there is none across a kink, states are looked at
    assert_eq!(told(&system, "kinked", 1e-12, 1.0), [(0.25, Crossing::Falling)]);
}

#[test]
fn passes_of_a_driven_pendulum_are_the_same_with_every_method() {
    let (system, start) = pendulum();
    let end = 40.0;
    let mut reference = Vec::new();
    let (mut state, mut stepper) = (start, system.stepper::<Order8<Exponential>>(0.02).unwrap());
    Run::new(&mut stepper, &mut state)
        .event(Event::any(), |state, _| state.angle.angle(), |event| reference.push(event.time()))
        .to(end)
        .unwrap();
    assert_eq!(reference.len(), 9);
    let compare = |what: &str, passes: &[f64], rises: usize| {
        assert_eq!((passes.len(), rises), (9, 4), "{what}");
        let off = passes.iter().zip(&reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12, "{what}: {off:e}");
    };
    let (mut passes, mut rises) = (Vec::new(), 0);
    let (mut state, mut trajectory) = (start, system.adaptive(1e-14).unwrap());
    Run::new(&mut trajectory, &mut state)
        .on("down", |event| passes.push(event.time()))
        .on("rise", |_| rises += 1)
        .to(end)
        .unwrap();
    compare("Taylor", &passes, rises);
    let (mut passes, mut rises) = (Vec::new(), 0);
    let (mut state, mut stepper) = (start, system.stepper::<HamiltonJacobi<Exponential, 6>>(0.01).unwrap());
    Run::new(&mut stepper, &mut state)
        .on("down", |event| {
            passes.push(event.time());
            assert!(event.state().angle.angle().abs() < 1e-14);
        })
        .on("rise", |_| rises += 1)
        .to(end)
        .unwrap();
    compare("order 6", &passes, rises);

    // and where types are erased
    let system: Arc<dyn erased::System> = Arc::new(system);
    let numbers = vec![start.angle.re, start.angle.im, start.momentum.x];
    let (mut passes, mut rises) = (Vec::new(), 0);
    let (mut state, mut trajectory) = (numbers, erased::Adaptive::new(system, 1e-14).unwrap());
    Run::new(&mut trajectory, &mut state)
        .on("down", |event| passes.push(event.time()))
        .on("rise", |_| rises += 1)
        .to(end)
        .unwrap();
    compare("erased", &passes, rises);
}

/// The cart is at `1.5 t − ½ sin t`, and passes many posts in each step.
#[test]
fn no_event_of_a_driven_run_is_missed() {
    let (cart, end) = (Cart { mass: 1.0 }, 4.0_f64);
    let place = |t: f64| 1.5 * t - 0.5 * t.sin();
    let posts = (40.0 * place(end) / PI).floor() as usize;
    let compare = |what: &str, found: &[f64], steps: u64| {
        assert!(posts == 81 && steps < 12, "{what}: {steps} steps");
        assert_eq!(found.len(), posts, "{what}");
        let off = found.iter().zip(1..).map(|(t, k)| (40.0 * place(*t) - PI * f64::from(k)).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off < 1e-7, "{what}: {off:e}");
    };
    let (mut found, mut state) = (Vec::new(), CartState { position: vector![0.0], momentum: vector![1.0] });
    let mut trajectory = cart.adaptive(1e-12).unwrap();
    Run::new(&mut trajectory, &mut state)
        .driven_by(|t| CartControl { push: 0.5 * t.sin() })
        .on("post", |event| found.push(event.time()))
        .to(end)
        .unwrap();
    compare("Taylor", &found, trajectory.steps_taken());

    let cart: Arc<dyn erased::System> = Arc::new(cart);
    let (mut found, mut state) = (Vec::new(), vec![0.0, 1.0]);
    let mut trajectory = erased::Adaptive::new(cart.clone(), 1e-12).unwrap();
    Run::new(&mut trajectory, &mut state)
        .driven_by(|t| vec![0.5 * t.sin()])
        .on("post", |event| found.push(event.time()))
        .to(end)
        .unwrap();
    compare("erased", &found, Stepping::steps_taken(&trajectory));

    // steps of one length, whose events are looked for in the series
    let (mut found, mut state) = (Vec::new(), vec![0.0, 1.0]);
    let scheme = "Order10<Exponential>".parse().unwrap();
    let stepper = erased::Stepper::new(cart.clone(), &scheme, 0.5).unwrap();
    let mut stepper = stepper.with_series(erased::Adaptive::new(cart, 1e-12).unwrap());
    Run::new(&mut stepper, &mut state)
        .driven_by(|t| vec![0.5 * t.sin()])
        .on("post", |event| found.push(event.time()))
        .to(end)
        .unwrap();
    compare("steps of one length", &found, stepper.steps_taken());
}

#[test]
fn events_of_a_top_are_those_of_closures() {
    let top = Top { inertia: vector![1.0, 2.0, 2.5], weight: 0.7, chi: vector![0.3, 0.2, 1.0] };
    let start = TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![0.4, -0.8, 1.5],
        gamma: vector![0.0, 0.6, 0.8],
    };
    let (mut named, mut by_closure) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    let (mut state, mut trajectory) = (start, top.adaptive(1e-13).unwrap());
    let [level, swing] = &mut named;
    Run::new(&mut trajectory, &mut state)
        .on("level", |event| level.push(event.time()))
        .on("swing", |event| swing.push(event.time()))
        .to(60.0)
        .unwrap();
    // steps are as they would be
    let (mut other, mut again) = (start, top.adaptive(1e-13).unwrap());
    let report = again.to(&mut other, 60.0).unwrap();
    assert_eq!((state, trajectory.steps_taken()), (other, report.steps));
    let (mut state, mut stepper) = (start, top.stepper::<Order8<Exponential>>(0.02).unwrap());
    let [level, swing] = &mut by_closure;
    Run::new(&mut stepper, &mut state)
        .event(Event::any(), |state, _| state.gamma.z, |event| level.push(event.time()))
        .event(
            Event::falling(),
            |state, _| state.momentum.dot(&state.gamma.cross(&top.chi)),
            |event| swing.push(event.time()),
        )
        .to(60.0)
        .unwrap();
    assert!(named[0].len() > 10 && named[1].len() > 5, "{named:?}");
    for (named, by_closure) in named.iter().zip(&by_closure) {
        assert_eq!(named.len(), by_closure.len());
        assert!(named.iter().zip(by_closure).all(|(a, b)| (a - b).abs() < 1e-11), "{named:?} {by_closure:?}");
    }
}

/// After a run was saved and goes on, its first steps know no values of the quantity before: their zeros are the same to the last bit.
#[test]
fn zeros_are_the_same_after_a_run_was_saved() {
    let top = Top { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: vector![0.3, 0.2, 1.0] };
    let start = TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 1.0, 1.0],
        gamma: Vector3::z(),
    };
    let zeros = |state: &mut TopState, stepper: &mut coadjoint::Stepper<Top, Exponential>, steps: u64| {
        let mut found = Vec::new();
        let run = Run::new(stepper, state);
        let run = run.event(Event::any(), |state, _| state.gamma.x, |event| found.push(event.time()));
        run.steps(steps).unwrap();
        found
    };
    let (mut state, mut stepper) = (start, top.stepper::<Exponential>(0.02).unwrap());
    let whole = zeros(&mut state, &mut stepper, 100_000);
    assert!(whole.len() > 50, "{}", whole.len());
    let (mut state, mut stepper) = (start, top.stepper::<Exponential>(0.02).unwrap());
    let mut compared = 0;
    for zero in &whole {
        // the step with the zero is the first one after the run was saved
        let before = (zero / 0.02).floor() as u64;
        let steps = before - stepper.steps_taken();
        Run::new(&mut stepper, &mut state).steps(steps).unwrap();
        let (mut state, mut resumed) = (state, top.stepper::<Exponential>(0.02).unwrap());
        resumed.restore(&stepper.snapshot()).unwrap();
        assert_eq!(zeros(&mut state, &mut resumed, 1), [*zero]);
        compared += 1;
    }
    assert_eq!(compared, whole.len());
}

#[test]
fn what_an_event_changes_acts_from_there_on() {
    let ball = Ball { mass: 0.1, gravity: 10.0 };
    let mut state = BallState { position: vector![1.25], momentum: vector![0.0] };
    let (mut trajectory, mut bounces, mut ends) = (ball.adaptive(1e-12).unwrap(), Vec::new(), Vec::new());
    let report = Run::new(&mut trajectory, &mut state)
        .on("bounce", |event| {
            bounces.push(event.time());
            event.state_mut().momentum *= -0.8;
            if bounces.len() == 6 {
                event.stop();
            }
        })
        .each(|tick| ends.push(tick.time))
        .to(4.0)
        .unwrap();
    assert_eq!((report.stopped, report.event), (true, Some(0)));
    // it falls for half a second, and is then in the air for 0.8, 0.64, … s
    let mut expected = 0.5;
    for (k, bounce) in bounces.iter().enumerate() {
        assert!((bounce - expected).abs() < 1e-13, "{bounce} for {expected}");
        // a step ends there
        assert!(ends.contains(bounce));
        expected += 0.8_f64.powi(k as i32 + 1);
    }
    assert_eq!((trajectory.time(), bounces.len()), (bounces[5], 6));
    assert!(state.position.x.abs() < 1e-14 && state.momentum.x > 0.0, "{state:?}");
}

#[test]
fn an_event_sees_controls_and_names_are_checked() {
    let (system, mut state) = even();
    let (trajectory, mut found) = (system.adaptive(1e-9).unwrap(), Vec::new());
    let mut trajectory = trajectory.with_step(0.25).unwrap();
    Run::new(&mut trajectory, &mut state)
        .controlled_by(|_, time| EvenControl { bias: if time < 0.7 { 0.0 } else { 0.6 } })
        .on("biased", |event| found.push((event.time(), event.control().bias)))
        .to(2.0)
        .unwrap();
    // with the control of the step that begins at 0.75 it has jumped to the other side
    assert_eq!(found, [(0.75, 0.6)]);
    let mut state = even().1;
    let before = state;
    let error = Run::new(&mut trajectory, &mut state).on("bias", |_| {}).to(2.0).unwrap_err();
    let StepError::NoEvent { known } = error.cause else { panic!("{error}") };
    assert_eq!((known.len(), known[5], state), (7, ("biased", Event::rising()), before));
    assert!(
        error.to_string().contains("`product`, `waves`, `touch`, `two`, `above`, `biased`, `kinked`"),
        "{error}"
    );
    assert_eq!(Even::EVENTS, known);
    assert!(Pendulum::EVENTS[1] == ("turn", Event::any()) && Top::EVENTS[1] == ("swing", Event::falling()));
}
