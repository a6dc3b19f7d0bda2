//! What happens within steps: dense output, events, states at times of one's own.
// a test that cannot go on is to say so
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use coadjoint::prelude::*;
use coadjoint::stepper::Stepping;
use coadjoint::{
    Crossing, Discretized, Event, Interval, Record, RightLift, Run, SchemeType, StepError, System, erased,
};

/// A heavy top.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
    methods(HamiltonJacobi(6), Midpoint)
)]
#[derive(Clone)]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

/// A free rigid body.
#[lie_poisson_system(group = SO3, retractions(Exponential))]
#[derive(Clone)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

/// A damped pendulum that is driven, and pushed.
#[lie_poisson_system(
    group = SO2,
    control(torque: f64),
    potential = -weight * angle.cos_angle(),
    force = vector![amplitude * (rate * t).cos() + torque - damping * velocity.x],
    methods(HamiltonJacobi(6)),
    retractions(Exponential)
)]
#[derive(Clone)]
struct Pendulum {
    #[inertia]
    inertia: f64,
    weight: f64,
    damping: f64,
    amplitude: f64,
    rate: f64,
}

/// A mass on a line.
#[lie_poisson_system(group = R1, control(push: f64), force = push, retractions(Exponential))]
#[derive(Clone)]
struct Mass {
    #[inertia]
    mass: f64,
}

fn top() -> (Top, TopState) {
    let top = Top { inertia: vector![1.0, 2.0, 2.5], weight: 0.7, chi: vector![0.3, 0.2, 1.0] };
    let state = TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![0.4, -0.8, 1.5],
        gamma: vector![0.0, 0.6, 0.8],
    };
    (top, state)
}

fn pendulum() -> (Pendulum, PendulumState) {
    let pendulum = Pendulum { inertia: 1.0, weight: 1.0, damping: 0.2, amplitude: 0.4, rate: 0.7 };
    (pendulum, PendulumState { angle: UnitComplex::new(0.8), momentum: vector![0.5] })
}

/// A mass that moves freely.
fn moving(position: f64, velocity: f64, step: f64) -> (Stepper<Mass, Exponential>, MassState) {
    let state = MassState { position: vector![position], momentum: vector![velocity] };
    (Mass { mass: 1.0 }.stepper(step).unwrap(), state)
}

fn far(a: &TopState, b: &TopState) -> f64 {
    let turned = (a.attitude.coords - b.attitude.coords).amax();
    turned.max((a.momentum - b.momentum).amax()).max((a.gamma - b.gamma).amax())
}

// dense output

const END: f64 = 2.0;
/// Shares of a step that are looked at.
const SHARES: usize = 10;
/// Steps of the reference.
const FINE: usize = 3_840;

/// The largest error at ten points of each of so many steps, and the largest change of a Casimir.
fn dense_error<M>(steps: usize, reference: &[TopState]) -> (f64, f64)
where
    Top: Discretized<M>,
{
    let (top, mut state) = top();
    let casimirs = |state: &TopState| top.casimirs(state);
    let initially = casimirs(&state);
    let mut stepper = top.stepper::<M>(END / steps as f64).unwrap();
    let (mut error, mut drift) = (0.0_f64, 0.0_f64);
    for k in 0..steps {
        let interval = Interval::step(&mut stepper, &mut state, NoControl::default()).unwrap();
        for j in 0..=SHARES {
            let within = interval.at(j as f64 / SHARES as f64).unwrap();
            let exact = &reference[(k * SHARES + j) * FINE / (steps * SHARES)];
            error = error.max(far(&within, exact));
            let now = casimirs(&within);
            let differences = now.iter().zip(&initially).map(|(now, initially)| (now - initially).abs());
            drift = differences.fold(drift, f64::max);
        }
    }
    (error, drift)
}

fn has_order<M>(order: f64, steps: usize, reference: &[TopState])
where
    Top: Discretized<M>,
{
    let all = [1, 2, 4].map(|times| dense_error::<M>(steps * times, reference));
    for pair in all.windows(2) {
        let slope = (pair[0].0 / pair[1].0).log2();
        println!("{}: {slope:.2} {:.1e}", std::any::type_name::<M>(), pair[1].0);
        assert!((slope - order).abs() < 0.25, "order {slope} instead of {order}: {all:?}");
    }
    assert!(all.iter().all(|(_, drift)| *drift < 1e-14), "{all:?}");
}

#[test]
fn dense_output_has_the_order_of_the_scheme_and_keeps_casimirs() {
    let (top, mut state) = top();
    let mut stepper = top.stepper::<Order8<Exponential>>(END / FINE as f64).unwrap();
    let mut record = Record::every(1);
    Run::new(&mut stepper, &mut state).observe(&mut record).steps(FINE as u64).unwrap();
    let reference = record.states();
    has_order::<Exponential>(2.0, 32, reference);
    has_order::<Cayley>(2.0, 32, reference);
    has_order::<Midpoint>(2.0, 32, reference);
    has_order::<Order4<Exponential>>(4.0, 12, reference);
    has_order::<Order4<Cayley>>(4.0, 12, reference);
    has_order::<HamiltonJacobi<Exponential, 6>>(6.0, 6, reference);
    has_order::<Fused<Cayley>>(2.0, 32, reference);
    has_order::<Compensated<Order4<Cayley>>>(4.0, 12, reference);
}

/// Ends, continuity, and a stepper that is as it was.
fn is_continuous<T: Stepping<System = Top> + ?Sized>(stepper: &mut T, far_is: f64) {
    let (_, mut state) = top();
    for _ in 0..3 {
        let memory = stepper.snapshot();
        let (before, start) = (state, stepper.time());
        let interval = Interval::step(stepper, &mut state, NoControl::default()).unwrap();
        assert_eq!((interval.at(0.0).unwrap(), interval.at(1.0).unwrap()), (before, *interval.after()));
        assert_eq!((*interval.before(), interval.start()), (before, start));
        let time = |share: f64| interval.start() + share * (interval.end() - interval.start());
        for (a, b) in [(0.0, 1e-12), (0.3, 0.3 + 1e-12), (1.0 - 1e-12, 1.0)] {
            let step = far(&interval.at(a).unwrap(), &interval.at(b).unwrap());
            assert!(step < far_is, "{step:e} at {a}");
        }
        let middle = interval.at_time(time(0.25)).unwrap();
        assert!(far(&middle, &interval.at(0.25).unwrap()) < far_is);
        for outside in [-1e-9, 1.0 + 1e-9, f64::NAN, f64::INFINITY] {
            let error = interval.at(outside).unwrap_err();
            assert!(matches!(error, StepError::OutOfReach { .. }), "{error}");
            assert!(matches!(interval.at_time(time(outside)), Err(StepError::OutOfReach { .. })));
        }
        // the step is as it would be
        let after = state;
        stepper.restore(&memory).unwrap();
        state = before;
        stepper.step_with(&mut state, &NoControl::default()).unwrap();
        assert_eq!(state, after);
    }
}

#[test]
fn the_motion_within_a_step_is_continuous() {
    fn of<M>(far_is: f64)
    where
        Top: Discretized<M>,
    {
        let mut stepper: Stepper<_, M> = top().0.stepper(0.2).unwrap();
        is_continuous(&mut stepper, far_is);
        is_continuous::<dyn Stepping<System = Top>>(&mut stepper, far_is);
    }
    of::<Exponential>(1e-11);
    of::<Cayley>(1e-11);
    of::<Fused<Cayley>>(1e-11);
    of::<Compensated<Cayley>>(1e-11);
    of::<Order4<Cayley>>(1e-11);
    of::<HamiltonJacobi<Exponential, 6>>(1e-11);
}

#[test]
fn steppers_whose_types_are_erased_have_the_same_states_within() {
    fn compare<M: SchemeType>()
    where
        Top: Discretized<M>,
    {
        let (top, mut state) = top();
        let mut stepper = top.stepper::<M>(0.2).unwrap();
        let mut erased = erased::Stepper::new(Arc::new(top), &M::scheme(), 0.2).unwrap();
        let mut numbers = coadjoint::State::to_components(&state).to_vec();
        for _ in 0..3 {
            let typed = Interval::step(&mut stepper, &mut state, NoControl::default()).unwrap();
            let other = Interval::step(&mut erased, &mut numbers, Vec::new()).unwrap();
            for k in 0..=5 {
                let share = f64::from(k) / 5.0;
                let typed = coadjoint::State::to_components(&typed.at(share).unwrap()).to_vec();
                assert_eq!(typed, other.at(share).unwrap());
            }
        }
    }
    compare::<Cayley>();
    compare::<Order4<Exponential>>();
    compare::<HamiltonJacobi<Exponential, 6>>();
    // and steps of one's own
    let (top, state) = top();
    let euler = |system: &dyn erased::System, at: &erased::At<'_>, next: &mut [f64]| {
        let rates = system.vector_field(at.state, at.time, at.control);
        next.iter_mut().zip(at.state).zip(rates).for_each(|((next, x), rate)| *next = x + at.step * rate);
        Ok(0)
    };
    let mut stepper = erased::Stepper::from_fn(Arc::new(top), 0.1, euler).unwrap();
    let mut numbers = coadjoint::State::to_components(&state).to_vec();
    for _ in 0..20 {
        // of which rotations are soon off their group
        let interval = Interval::step(&mut stepper, &mut numbers, Vec::new()).unwrap();
        let middle = interval.at(0.5).unwrap();
        let both = interval.before().iter().zip(interval.after());
        assert!(middle.iter().zip(both).all(|(m, (a, b))| (m - 0.5 * (a + b)).abs() < 1e-15));
    }
}

#[test]
fn states_at_any_times_change_no_steps() {
    let (top, start) = top();
    let times: Vec<f64> = (0..49).map(|k| 0.0437 * f64::from(k)).collect();
    let mut state = start;
    let mut stepper = top.stepper::<HamiltonJacobi>(0.1).unwrap();
    let (mut record, mut ends) = (Record::every(1), Record::every(3));
    let also = [-1.0, f64::NAN, 0.0, 0.3, 0.30000000000000004, 2.0, 7.0];
    let mut others = Record::every(1);
    Run::new(&mut stepper, &mut state)
        .save_at(times.iter().copied(), &mut record)
        .observe(&mut ends)
        .save_at(also, &mut others)
        .to(2.14)
        .unwrap();
    assert_eq!(record.times(), &times[..]);
    assert_eq!(others.times(), [0.0, 0.3, 0.30000000000000004, 2.0]);
    let mut undisturbed = start;
    let mut stepper = top.stepper::<HamiltonJacobi>(0.1).unwrap();
    let mut expected = Record::every(3);
    Run::new(&mut stepper, &mut undisturbed).observe(&mut expected).to(2.14).unwrap();
    assert_eq!((state, ends.times()), (undisturbed, expected.times()));
    // together with the steps, as they are taken without anyone looking, to rounding
    for (time, state) in record.iter() {
        let mut other = start;
        let mut stepper = top.stepper::<HamiltonJacobi>(0.1).unwrap();
        Run::new(&mut stepper, &mut other).to(time).unwrap();
        assert!(far(state, &other) < 1e-14, "{time}");
    }
}

// events

/// When the pendulum hangs down, by a reference of its own: short steps of order 10, and bisection of the step.
fn passes() -> Vec<(f64, bool)> {
    let (pendulum, mut state) = pendulum();
    let step = 1.0 / 256.0;
    let mut stepper = pendulum.stepper::<Order10<Exponential>>(step).unwrap();
    let mut passes = Vec::new();
    for k in 0..(20 * 256) {
        let (before, time) = (state, f64::from(k) * step);
        stepper.step(&mut state).unwrap();
        let [from, to] = [before, state].map(|state| state.angle.angle());
        if (from > 0.0) == (to > 0.0) || from.abs() > 1.0 {
            continue;
        }
        let (mut least, mut most) = (0.0, step);
        for _ in 0..60 {
            let middle = 0.5 * (least + most);
            let mut there = before;
            let mut part = pendulum.stepper::<Order10<Exponential>>(middle).unwrap();
            part.set_time(time);
            part.step(&mut there).unwrap();
            if (there.angle.angle() > 0.0) == (from > 0.0) { least = middle } else { most = middle }
        }
        passes.push((time + most, from < 0.0));
    }
    passes
}

#[test]
fn the_passes_of_a_driven_and_damped_pendulum_are_located() {
    let expected = passes();
    assert!(expected.len() >= 4, "{expected:?}");
    let check = |found: &[(f64, Crossing)]| {
        assert_eq!(found.len(), expected.len(), "{found:?} instead of {expected:?}");
        let mut worst = 0.0_f64;
        for ((time, crossing), (exact, is_rising)) in found.iter().zip(&expected) {
            worst = worst.max((time - exact).abs());
            assert_eq!(*crossing == Crossing::Rising, *is_rising);
        }
        println!("{} passes, the worst off by {worst:.1e}", found.len());
        assert!(worst < 1e-12, "{found:?} instead of {expected:?}");
    };
    let angle = |state: &PendulumState, _: f64| state.angle.angle();

    // in the description, by steps of order 6 from one equation, and composed
    fn described<M>(step: f64, angle: impl Fn(&PendulumState, f64) -> f64) -> Vec<(f64, Crossing)>
    where
        Pendulum: Discretized<M>,
    {
        let ((pendulum, mut state), mut found) = (pendulum(), Vec::new());
        let mut stepper = pendulum.stepper::<M>(step).unwrap();
        let run = Run::new(&mut stepper, &mut state);
        run.event(Event::any(), angle, |event| {
            assert!(event.state().angle.angle().abs() < 1e-13);
            found.push((event.time(), event.crossing()));
        })
        .to(20.0)
        .unwrap();
        found
    }
    check(&described::<HamiltonJacobi<Exponential, 6>>(0.02, angle));
    check(&described::<Order6<Exponential>>(0.01, angle));
    // driven from outside
    let ((pendulum, mut state), mut found) = (pendulum(), Vec::new());
    let free = Pendulum { amplitude: 0.0, ..pendulum.clone() };
    let mut stepper = free.stepper::<Order6<Exponential>>(0.01).unwrap();
    Run::new(&mut stepper, &mut state)
        .driven_by(|time| PendulumControl { torque: pendulum.amplitude * (pendulum.rate * time).cos() })
        .event(Event::any(), angle, |event| {
            assert!(event.control_mut().is_none());
            let torque = pendulum.amplitude * (pendulum.rate * event.time()).cos();
            assert_eq!(event.control().torque, torque);
            found.push((event.time(), event.crossing()));
        })
        .to(20.0)
        .unwrap();
    check(&found);
    // with types erased
    let (pendulum, state) = self::pendulum();
    let mut numbers = coadjoint::State::to_components(&state).to_vec();
    let scheme = HamiltonJacobi::<Exponential, 6>::scheme();
    let mut stepper = erased::Stepper::new(Arc::new(pendulum), &scheme, 0.02).unwrap();
    let mut found = Vec::new();
    Run::new(&mut stepper, &mut numbers)
        .event(
            Event::any(),
            |state, _| state[1].atan2(state[0]),
            |event| found.push((event.time(), event.crossing())),
        )
        .to(20.0)
        .unwrap();
    check(&found);
}

#[test]
fn no_event_comes_twice() {
    // also far from time 0, where times have fewer digits than shares of steps
    for start in [0.0, 1e3, 1e6, 1e9] {
        let (pendulum, begin) = (pendulum().0, pendulum().1);
        let (mut state, mut stepper) = (begin, pendulum.stepper::<Order4<Exponential>>(0.05).unwrap());
        stepper.set_time(start);
        let mut all = Vec::new();
        let angle = |state: &PendulumState, _: f64| state.angle.angle();
        Run::new(&mut stepper, &mut state)
            .event(Event::any(), angle, |event| all.push(event.time()))
            .to(start + 20.0)
            .unwrap();
        let (mut state, mut stepper) = (begin, pendulum.stepper::<Order4<Exponential>>(0.05).unwrap());
        stepper.set_time(start);
        let mut ends = Vec::new();
        loop {
            let run = Run::new(&mut stepper, &mut state).event(Event::any().terminal(), angle, |_| {});
            if !run.to(start + 20.0).unwrap().stopped {
                break;
            }
            ends.push(stepper.time());
        }
        assert_eq!(all.len(), ends.len(), "{all:?} {ends:?}");
        // the steps are others behind an event
        assert!(all.iter().zip(&ends).all(|(a, b)| (a - b).abs() < 1e-5), "{all:?} {ends:?}");
    }
}

#[test]
fn events_of_one_moment_come_in_their_order() {
    for step in [0.3, 0.25, 2.0] {
        let (mut stepper, mut state) = moving(-1.0, 1.0, step);
        let order = std::cell::RefCell::new(Vec::new());
        let called = |name: &'static str| order.borrow_mut().push(name);
        let run = Run::new(&mut stepper, &mut state);
        let report = run
            .event(Event::any(), |state, _| state.position.x - 0.5, |_| called("half past"))
            .event(Event::any(), |state, _| state.position.x, |_| called("first"))
            .event(Event::any().terminal(), |state, _| state.position.x - 1.0, |_| called("end"))
            .event(Event::any(), |state, _| 3.0 * state.position.x, |_| called("second"))
            .event(Event::any(), |state, _| state.position.x.powi(3), |_| called("third"))
            .event(Event::any(), |state, _| state.position.x - 1.25, |_| called("too late"))
            .event(Event::falling(), |state, _| state.position.x, |_| called("never"))
            .to(10.0)
            .unwrap();
        assert_eq!(*order.borrow(), ["first", "second", "third", "half past", "end"]);
        assert_eq!((report.event, report.stopped, stepper.time()), (Some(2), true, 2.0));
        assert!((state.position.x - 1.0).abs() < 1e-15);
        // and none of them again
        let run = Run::new(&mut stepper, &mut state);
        let report = run
            .event(Event::any().terminal(), |state, _| state.position.x - 1.0, |_| called("again"))
            .event(Event::any(), |state, _| state.position.x, |_| called("again"))
            .to(4.0)
            .unwrap();
        assert_eq!((report.event, order.borrow().len()), (None, 5));
    }
}

#[test]
fn an_exact_zero_at_the_end_of_a_step_is_one_event() {
    for event in [Event::any(), Event::falling()] {
        let (mut stepper, mut state) = moving(1.0, -1.0, 0.25);
        let mut found = Vec::new();
        Run::new(&mut stepper, &mut state)
            .event(event, |state, _| state.position.x, |event| found.push((event.time(), event.crossing())))
            .to(2.0)
            .unwrap();
        assert_eq!(found, [(1.0, Crossing::Falling)]);
        // at the end of the run, too; and the next one does not find it again
        let (mut stepper, mut state) = moving(1.0, -1.0, 0.25);
        let report = Run::new(&mut stepper, &mut state)
            .event(event.terminal(), |state, _| state.position.x, |_| {})
            .to(1.0)
            .unwrap();
        assert_eq!((report.event, report.steps, stepper.time()), (Some(0), 4, 1.0));
        let report = Run::new(&mut stepper, &mut state)
            .event(event.terminal(), |state, _| state.position.x, |_| {})
            .to(2.0)
            .unwrap();
        assert_eq!(report.event, None);
    }
    // there and away again
    let (mut stepper, mut state) = moving(1.0, -1.0, 0.25);
    let mut found = Vec::new();
    Run::new(&mut stepper, &mut state)
        .event(Event::any(), |state, _| state.position.x.powi(2), |event| found.push(event.time()))
        .to(2.0)
        .unwrap();
    assert_eq!(found, [1.0]);
}

#[test]
fn a_state_that_was_changed_by_hand_is_no_event() {
    let (mut stepper, mut state) = moving(1.0, 0.0, 0.1);
    let mut found = 0;
    for position in [1.0, -1.0, 2.0, -3.0] {
        state.position.x = position;
        Run::new(&mut stepper, &mut state)
            .event(Event::any(), |state, _| state.position.x, |_| found += 1)
            .steps(5)
            .unwrap();
    }
    // nor is one that another event has changed
    let mut jumps = 0;
    Run::new(&mut stepper, &mut state)
        .event(
            Event::any(),
            |_, time| time - 2.25,
            |event| {
                jumps += 1;
                event.state_mut().position.x = 7.0;
            },
        )
        .event(Event::any(), |state, _| state.position.x, |_| found += 1)
        .steps(5)
        .unwrap();
    assert_eq!((found, jumps, state.position.x), (0, 1, 7.0));
}

#[test]
fn touches_and_pairs_within_a_step_are_found() {
    let times = |step: f64, event: Event, condition: &dyn Fn(f64) -> f64| {
        let (mut stepper, mut state) = moving(0.0, 1.0, step);
        let mut found = Vec::new();
        Run::new(&mut stepper, &mut state)
            .event(
                event,
                |state, _| condition(state.position.x),
                |event| found.push((event.time(), event.crossing())),
            )
            .to(3.0)
            .unwrap();
        found
    };
    use Crossing::{Falling, Rising, Touch};
    for step in [3.0, 1.0, 0.37, 0.1, 0.05] {
        for place in [1.3142, 1.0, 0.0613, 2.3, 1.0000003] {
            let touch = |x: f64| (x - place).powi(2);
            let found = times(step, Event::any(), &touch);
            assert!(
                found.len() == 1 && found[0].1 == Touch && (found[0].0 - place).abs() < 1e-6,
                "{step} {place}: {found:?}"
            );
            assert_eq!(times(step, Event::rising(), &touch), []);
            assert_eq!(times(step, Event::falling(), &touch), []);
            assert_eq!(times(step, Event::any(), &|x| touch(x) + 1e-6), [], "{step} {place}");
            for depth in [1e-3, 1e-6, 1e-10] {
                let found = times(step, Event::any(), &|x| touch(x) - depth);
                let crossings: Vec<_> = found.iter().map(|(_, crossing)| *crossing).collect();
                assert_eq!(crossings, [Falling, Rising], "{step} {place} {depth}: {found:?}");
                let half = f64::sqrt(depth);
                assert!(
                    (found[0].0 - (place - half)).abs() < 1e-9 && (found[1].0 - (place + half)).abs() < 1e-9
                );
                assert_eq!(times(step, Event::rising(), &|x| touch(x) - depth), found[1..]);
            }
            // with the rounding of a larger number
            let found = times(step, Event::any(), &|x| 1.0 - (x - place).cos());
            assert!(found.len() == 1 && found[0].1 == Touch, "{step} {place}: {found:?}");
        }
        // many in one step, for who asks for it
        let wave = |x: f64| (15.0 * (x + 0.02)).cos();
        let found = times(step, Event::any().points(64), &wave);
        assert_eq!(found.len(), 14, "{step}: {found:?}");
        let exact = |k: usize| (k as f64 + 0.5) * std::f64::consts::PI / 15.0 - 0.02;
        assert!(found.iter().enumerate().all(|(k, (time, _))| (time - exact(k)).abs() < 1e-14), "{found:?}");
        if step < 0.2 {
            let usual = times(step, Event::any(), &wave);
            assert!(usual.len() == 14 && usual.iter().zip(&found).all(|(a, b)| (a.0 - b.0).abs() < 2e-15));
        }
    }
}

/// Sums of three waves, of up to ten periods in a hundred steps: which zeros are found with what is usual, and with more points.
#[test]
fn zeros_of_random_waves_are_found_once() {
    let mut seed = 1_u64;
    let mut random = |least: f64, most: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        least + (most - least) * (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut all, mut missed, mut looks) = (0, [0, 0], [0, 0]);
    for _ in 0..300 {
        let waves: [[f64; 3]; 3] = [(); 3].map(|()| [random(0.3, 1.0), random(0.5, 6.3), random(0.0, 6.3)]);
        let wave = |t: f64| waves.iter().map(|[by, rate, phase]| by * (rate * t + phase).sin()).sum::<f64>();
        // as far as ten thousand values tell
        let place = |k: usize| 10.0 * k as f64 / 10_000.0;
        let changes = (0..10_000).filter(|&k| (wave(place(k)) > 0.0) != (wave(place(k + 1)) > 0.0));
        let expected: Vec<f64> = changes
            .map(|k| {
                let (mut least, mut most) = (place(k), place(k + 1));
                for _ in 0..60 {
                    let middle = 0.5 * (least + most);
                    if (wave(middle) > 0.0) == (wave(place(k)) > 0.0) {
                        least = middle
                    } else {
                        most = middle
                    }
                }
                most
            })
            .collect();
        all += expected.len();
        for (k, event) in [Event::any(), Event::any().points(8)].into_iter().enumerate() {
            let (mut stepper, mut state) = moving(0.0, 1.0, 0.1);
            let mut found = Vec::new();
            Run::new(&mut stepper, &mut state)
                .event(
                    event,
                    |_, time| {
                        looks[k] += 1;
                        wave(time)
                    },
                    |event| found.push(event.time()),
                )
                .to(10.0)
                .unwrap();
            assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "{found:?}");
            // each is one, and none is found that is none
            for time in &found {
                let near = expected.iter().filter(|exact| (*exact - time).abs() < 1e-10).count();
                assert_eq!(near, 1, "{time} of {expected:?}");
            }
            missed[k] += expected.len() - found.len();
        }
    }
    let steps = 300 * 101;
    println!(
        "{all} zeros, {missed:?} missed, {:.1} states for each",
        f64::from(looks[0] - steps) / all as f64
    );
    assert_eq!(missed, [0, 0]);
    assert!(f64::from(looks[0] - steps) < 10.0 * all as f64 && looks[1] > 9 * 300 * 100);
}

#[test]
fn what_is_changed_acts_from_the_event_on() {
    // the control, from time 0.55 on; time, position and velocity after it
    let at = |event: f64, time: f64, push: f64| {
        let since = time - event;
        (time + 0.5 * push * since * since, 1.0 + push * since)
    };
    for interval in [1, 4] {
        let (mut stepper, mut state) = moving(0.0, 1.0, 0.1);
        let mut record = Record::every(1);
        let mut pushes = Vec::new();
        Run::new(&mut stepper, &mut state)
            .controlled_every(interval, |_, time| MassControl { push: if time < 0.55 { 0.0 } else { 3.0 } })
            .observe(&mut record)
            .each(|tick| pushes.push(tick.control.map(|control| control.push)))
            .event(
                Event::any(),
                |_, time| time - 0.55,
                |event| {
                    event.control_mut().unwrap().push = 3.0;
                },
            )
            .steps(8)
            .unwrap();
        let (position, momentum) = at(0.55, 0.8, 3.0);
        assert!((state.position.x - position).abs() < 1e-14 && (state.momentum.x - momentum).abs() < 1e-14);
        assert_eq!(
            record.times(),
            [0.0, 0.1, 0.2, 0.30000000000000004, 0.4, 0.5, 0.6000000000000001, 0.7000000000000001, 0.8]
        );
        assert_eq!((pushes[5], pushes[6]), (Some(0.0), Some(3.0)));
    }
    let (mut stepper, mut state) = moving(0.0, 1.0, 0.1);
    Run::new(&mut stepper, &mut state)
        .with_control(MassControl { push: 0.0 })
        .event(Event::any(), |_, time| time - 0.55, |event| event.control_mut().unwrap().push = 3.0)
        .to(1.0)
        .unwrap();
    let (position, momentum) = at(0.55, 1.0, 3.0);
    assert!((state.position.x - position).abs() < 1e-14 && (state.momentum.x - momentum).abs() < 1e-14);
    // parameters: twice the mass has half the velocity
    let (mut stepper, mut state) = moving(0.0, 1.0, 0.1);
    Run::new(&mut stepper, &mut state)
        .event(
            Event::any(),
            |_, time| time - 0.55,
            |event| {
                assert!(event.set_parameters(&Mass { mass: -1.0 }).is_err());
                assert_eq!(event.system().mass, 1.0);
                event.set_parameters(&Mass { mass: 2.0 }).unwrap();
            },
        )
        .to(1.0)
        .unwrap();
    assert!((state.position.x - (0.55 + 0.225)).abs() < 1e-15);
    assert_eq!(stepper.system().mass, 2.0);
    // with types erased
    let mut stepper =
        erased::Stepper::new(Arc::new(Mass { mass: 1.0 }), &Exponential::scheme(), 0.1).unwrap();
    let mut state = vec![0.0, 1.0];
    Run::new(&mut stepper, &mut state)
        .event(
            Event::any(),
            |_, time| time - 0.55,
            |event| {
                assert!(event.set_parameters(&[1.0, 2.0]).is_err());
                event.set_parameters(&[2.0]).unwrap();
                event.control_mut().unwrap()[0] = 4.0;
            },
        )
        .to(1.0)
        .unwrap();
    assert!((state[0] - (0.55 + 0.225 + 0.45_f64.powi(2))).abs() < 1e-15, "{state:?}");
}

#[test]
fn runs_go_back_in_time_and_are_stopped_by_callbacks() {
    let (mut stepper, mut state) = moving(1.0, 1.0, -0.3);
    let mut saved = Record::every(1);
    let mut found = Vec::new();
    let report = Run::new(&mut stepper, &mut state)
        .save_at([0.5, -0.1, -0.2, -0.15, -0.95, -1.1], &mut saved)
        .event(
            Event::falling(),
            |state, _| state.position.x,
            |event| {
                found.push(event.time());
                event.stop();
            },
        )
        .to(-9.0)
        .unwrap();
    assert_eq!((found, report.event), (vec![stepper.time()], Some(0)));
    assert!((stepper.time() + 1.0).abs() < 1e-15);
    assert_eq!(saved.times(), [-0.1, -0.2, -0.95]);
    assert_eq!(report.steps, 4);
}

#[test]
fn no_condition_ends_in_a_panic_or_runs_forever() {
    let conditions: [fn(f64) -> f64; 9] = [
        |_| 0.0,
        |_| f64::NAN,
        |_| f64::INFINITY,
        |t| if t < 0.55 { f64::NAN } else { 1.0 },
        |t| if t < 0.55 { -1.0 } else { f64::INFINITY },
        |t| if t < 0.55 { -1.0 } else { 0.0 },
        |t| 1.0 / (t - 0.55),
        |t| if (t * 1e9).fract() < 0.5 { 1e-300 } else { -1e300 },
        |t| (t - 0.55) * f64::MIN_POSITIVE * 1e-10,
    ];
    let counts = conditions.map(|condition| {
        let (mut stepper, mut state) = moving(0.0, 1.0, 0.1);
        let mut found = 0;
        Run::new(&mut stepper, &mut state)
            .event(Event::any(), |_, time| condition(time), |_| found += 1)
            .to(1.0)
            .unwrap();
        found
    });
    println!("{counts:?}");
    assert_eq!((counts[0], counts[1], counts[2], counts[3], counts[4], counts[5]), (0, 0, 0, 0, 1, 1));
    assert_eq!((counts[6], counts[8]), (1, 1));

    // events that never stop coming
    let (mut stepper, mut state) = moving(-1e-5, 1.0, 0.1);
    let mut found = 0;
    let error = Run::new(&mut stepper, &mut state)
        .event(
            Event::any(),
            |state, _| state.position.x,
            |event| {
                found += 1;
                event.state_mut().position.x = -1e-5;
            },
        )
        .steps(3)
        .unwrap_err();
    let StepError::TooManyEvents { most, time } = error.cause else { panic!("{error}") };
    assert_eq!((most, error.step, found), (1_000, 1, 1_000));
    assert!((time - 0.01).abs() < 1e-4 && error.time <= time && stepper.time() == error.time, "{error}");
    // a step that cannot be taken behind an event
    let (mut stepper, mut state) = moving(-0.25, 1.0, 0.1);
    let error = Run::new(&mut stepper, &mut state)
        .event(
            Event::any(),
            |state, _| state.position.x,
            |event| {
                event.control_mut().unwrap().push = f64::NAN;
            },
        )
        .steps(30)
        .unwrap_err();
    assert_eq!((error.cause, error.step, error.time), (StepError::NotFinite, 3, stepper.time()));
    assert!((error.time - 0.25).abs() < 1e-15 && state.position.x.abs() < 1e-15);
}

#[test]
fn a_body_that_carries_its_momentum_has_events_too() {
    let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    let start = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
    let times = |found: &mut Vec<f64>, mut state: BodyState, stepper: &mut dyn Stepping<System = Body>| {
        Run::new(stepper, &mut state)
            .event(Event::any(), |state, _| state.momentum.y, |event| found.push(event.time()))
            .to(60.0)
            .unwrap();
    };
    let (mut plain, mut carried) = (Vec::new(), Vec::new());
    times(&mut plain, start, &mut body.stepper::<Exponential>(0.05).unwrap());
    times(&mut carried, start, &mut body.stepper::<RightLift<Exponential>>(0.05).unwrap());
    assert!(plain.len() > 2 && plain.len() == carried.len(), "{plain:?} {carried:?}");
    assert!(plain.iter().zip(&carried).all(|(a, b)| (a - b).abs() < 1e-11), "{plain:?} {carried:?}");
}

#[test]
fn single_precision_has_events_as_far_as_it_has_digits() {
    #[lie_poisson_system(group = SO3, retractions(Exponential))]
    struct Single {
        #[inertia]
        inertia: Vector3<f32>,
    }
    let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
    let mut exact = Vec::new();
    let mut stepper = Body { inertia: vector![1.0, 2.0, 2.5] }.stepper::<Exponential>(0.05).unwrap();
    Run::new(&mut stepper, &mut state)
        .event(Event::any(), |state, _| state.momentum.y, |event| exact.push(event.time()))
        .to(30.0)
        .unwrap();
    let mut state = SingleState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
    let mut found = Vec::new();
    let mut stepper = Single { inertia: vector![1.0, 2.0, 2.5] }.stepper::<Exponential>(0.05).unwrap();
    Run::new(&mut stepper, &mut state)
        .event(Event::any(), |state, _| state.momentum.y.into(), |event| found.push(event.time()))
        .to(30.0)
        .unwrap();
    assert!(exact.len() > 1 && exact.len() == found.len(), "{exact:?} {found:?}");
    assert!(exact.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-3), "{exact:?} {found:?}");
}
