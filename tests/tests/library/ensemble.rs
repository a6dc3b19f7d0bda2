//! Members of an ensemble move as they would alone.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use std::ops::ControlFlow;

use coadjoint::ensemble::{EnsembleError, Instructions, normal, uniform};
use coadjoint::prelude::*;
use coadjoint::{Discretized, Ensemble, RightLift};

use crate::systems::{
    Body, BodyState, Links, LinksState, Sensors, SensorsControl, SensorsState, Single, SingleState, Top,
    TopState,
};

/// A potential on the group, a force that depends on time, and a control.
#[lie_poisson_system(
    group = SO2,
    potential = -weight * angle.cos_angle(),
    force(angle = -friction * momentum + Vector1::new(drive * t.sin() + push)),
    control(push: f64),
)]
#[derive(Clone)]
struct Pendulum {
    #[inertia]
    inertia: f64,
    weight: f64,
    friction: f64,
    drive: f64,
}

/// A torque is all that acts on it.
#[lie_poisson_system(group = SO3, control(torque: R3), force(attitude = torque))]
#[derive(Clone)]
struct Pushed {
    #[inertia]
    inertia: Vector3<f64>,
}

/// Runs away, the faster the farther it is.
#[lie_poisson_system(group = R1, potential = -0.25 * position.x.powi(4))]
#[derive(Clone)]
struct Runaway {
    #[inertia]
    inertia: f64,
}

/// More than one block of any width, and the last one not full.
const MEMBERS: usize = 37;

fn bodies() -> (Vec<Body>, Vec<BodyState>) {
    let body = |k: usize| Body { inertia: vector![1.0 + 0.01 * k as f64, 2.0, 2.5] };
    let state = |k: usize| BodyState {
        attitude: UnitQuaternion::identity(),
        // the first does not move
        momentum: vector![0.1, 2.0, -0.3] * (k as f64 / 10.0),
    };
    ((0..MEMBERS).map(body).collect(), (0..MEMBERS).map(state).collect())
}

fn tops() -> (Vec<Top>, Vec<TopState>) {
    let top = |k: usize| Top {
        inertia: vector![1.0, 1.0 + k as f64, 100.0],
        weight: 1.0 + 0.2 * k as f64,
        chi: vector![0.3, 0.2, 1.0],
    };
    let state = |k: usize| TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 0.1 * k as f64, 1.0],
        gamma: Vector3::z(),
    };
    ((0..MEMBERS).map(top).collect(), (0..MEMBERS).map(state).collect())
}

fn pendulums() -> (Vec<Pendulum>, Vec<PendulumState>) {
    let pendulum = |k: usize| Pendulum { inertia: 1.0, weight: 0.3 * k as f64, friction: 0.01, drive: 0.5 };
    let state = |k: usize| PendulumState {
        angle: UnitComplex::new(0.1 * k as f64),
        momentum: vector![1.0 - 0.05 * k as f64],
    };
    ((0..MEMBERS).map(pendulum).collect(), (0..MEMBERS).map(state).collect())
}

/// Compares an ensemble, by whatever instructions, with its members alone. The control depends on the member.
fn moves_as_alone<S, M>(
    (systems, states): (Vec<S>, Vec<S::State>),
    step: S::Scalar,
    control: fn(usize) -> S::Control,
) where
    S: Discretized<M> + 'static,
    M: 'static,
{
    let alone: Vec<_> = systems
        .iter()
        .zip(&states)
        .enumerate()
        .map(|(member, (system, state))| {
            let mut state = state.clone();
            let mut stepper = system.stepper::<M>(step).unwrap();
            for _ in 0..400 {
                stepper.step_with(&mut state, &control(member)).unwrap();
            }
            state
        })
        .collect();
    assert!(alone.iter().zip(&states).any(|(end, start)| end != start), "nothing moves");
    for instructions in Instructions::available() {
        let mut ensemble =
            Ensemble::<S, M>::with_instructions(&systems, states.clone(), step, instructions).unwrap();
        ensemble.control(|member, _| control(member));
        // interruptions make no difference
        for steps in [150, 1, 249] {
            assert_eq!(ensemble.run(steps), steps * MEMBERS as u64);
            assert!(ensemble.failed().is_empty());
        }
        for (member, (together, alone)) in ensemble.states().zip(&alone).enumerate() {
            assert_eq!(&together, alone, "member {member}, {instructions:?}");
        }
    }
}

fn none<S>(_: usize) -> NoControl<S>
where
    NoControl<S>: Default,
{
    NoControl::default()
}

#[test]
fn members_move_as_they_would_alone() {
    moves_as_alone::<Body, Cayley>(bodies(), 0.01, none);
    moves_as_alone::<Top, Exponential>(tops(), 0.01, none);
    // where sweeps do not contract, Newton's iteration
    moves_as_alone::<Top, Exponential>(tops(), 0.3, none);
    moves_as_alone::<Body, Order4<RightLift<Cayley>>>(bodies(), 0.1, none);
    let push = |member: usize| PendulumControl { push: 0.01 * member as f64 };
    moves_as_alone::<Pendulum, Cayley>(pendulums(), 0.05, push);
}

/// What is remembered of jumps of any size is the same together and alone, and a stepper that goes on from memory remembers it too.
#[test]
fn jumping_controls_move_members_as_alone() {
    let system = Pushed { inertia: vector![1.0, 2.0, 2.5] };
    let start = PushedState { attitude: UnitQuaternion::identity(), momentum: vector![0.3, 2.0, -0.4] };
    // jumps after quiet times, and of all sizes from roundoff to what loses the last solutions
    let torque = |member: usize, step: usize| {
        let size = [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 100.0][(member + step / 60) % 8];
        let part = |i: usize| 2.0 * ((member + i * step + i) as f64 * 0.618_033_988_75).fract() - 1.0;
        PushedControl { torque: size * vector![part(1), part(2), part(3)] }
    };
    move_one_by_one_as_alone::<_, Cayley>(&system, &vec![start; MEMBERS], 0.01, 600, torque);
}

/// Steps that are taken at once alone stay what they are beside others that are not, and so does what is remembered of them.
#[test]
fn what_one_member_learns_is_nothing_to_others() {
    // slow motion, whose solutions are hardly more than rounding, beside controls that jump
    let sensors = Sensors { gravity: vector![0.0, 0.0, -9.81] };
    let mut element = SMatrix::<f64, 5, 5>::identity();
    element[(0, 3)] = 20.0;
    let carried = |k: usize| {
        let momentum = SVector::<f64, 9>::from_fn(|i, _| 0.03 * i as f64 - 0.1 + 0.01 * k as f64);
        SensorsState { element, momentum }
    };
    let felt = |member: usize, step: usize| {
        let jump =
            if member % 4 == 3 && step / 70 % 2 == 1 { 1e-4 * ((step * step) % 7) as f64 } else { 0.0 };
        let accelerometer = vector![jump, 0.1 * member as f64, 9.81];
        SensorsControl { gyroscope: vector![0.0, 0.0, 0.1], accelerometer }
    };
    let states: Vec<_> = (0..MEMBERS).map(carried).collect();
    move_one_by_one_as_alone::<_, Cayley>(&sensors, &states, 0.01, 600, felt);

    // Newton's method, beside members that move wildly
    let hanging = |k: usize| LinksState {
        first: UnitComplex::new(1.2),
        first_momentum: vector![0.1 * k as f64],
        second: UnitComplex::new(0.4),
        second_momentum: vector![if k % 4 == 2 { 10.0 } else { 0.3 }],
    };
    let states: Vec<_> = (0..MEMBERS).map(hanging).collect();
    for step in [0.01, 0.05, 0.1] {
        move_one_by_one_as_alone::<_, Cayley>(&Links { gravity: 9.81 }, &states, step, 400, |_, _| none(0));
    }
    // and simplified
    let body = Body { inertia: vector![1.0, 10.0, 100.0] };
    let spinning = |k: usize| BodyState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 1.0, 1.0 + 0.1 * k as f64] * (if k % 4 == 2 { 5.0 } else { 1.0 }),
    };
    let states: Vec<_> = (0..MEMBERS).map(spinning).collect();
    for step in [0.1, 0.3] {
        type Order8 = HamiltonJacobi<Exponential, 8>;
        move_one_by_one_as_alone::<_, Order8>(&body, &states, step, 400, |_, _| none(0));
    }
}

/// Compares an ensemble, by whatever instructions, with its members alone, whose memory is taken up anew now and then.
fn move_one_by_one_as_alone<S, M>(
    system: &S,
    states: &[S::State],
    step: S::Scalar,
    steps: usize,
    control: impl Fn(usize, usize) -> S::Control,
) where
    S: Discretized<M> + Clone + 'static,
    M: 'static,
{
    let mut alone: Vec<_> =
        states.iter().map(|state| (system.stepper::<M>(step).unwrap(), state.clone())).collect();
    let mut failed = Vec::new();
    for taken in 0..steps {
        for (member, (stepper, state)) in alone.iter_mut().enumerate() {
            if taken % 97 == 50 {
                let memory = stepper.snapshot();
                *stepper = system.stepper::<M>(step).unwrap();
                stepper.restore(&memory).unwrap();
            }
            if !failed.contains(&member) && stepper.step_with(state, &control(member, taken)).is_err() {
                failed.push(member);
            }
        }
    }
    failed.sort_unstable();
    assert!(failed.len() < states.len() / 2, "{failed:?}");
    for instructions in Instructions::available() {
        let systems = vec![system.clone(); states.len()];
        let mut ensemble =
            Ensemble::<S, M>::with_instructions(&systems, states.to_vec(), step, instructions).unwrap();
        for taken in 0..steps {
            ensemble.control(|member, _| control(member, taken));
            ensemble.run(1);
        }
        let failed_together: Vec<_> = ensemble.failed().iter().map(|failed| failed.member).collect();
        assert_eq!(failed_together, failed, "{instructions:?}");
        for (member, (together, (_, state))) in ensemble.states().zip(&alone).enumerate() {
            assert_eq!(together, *state, "member {member}, {instructions:?}");
        }
    }
}

#[test]
fn single_precision_moves_alike() {
    let systems = (0..MEMBERS).map(|k| Single { inertia: vector![1.0, 2.0, 2.0 + 0.1 * k as f32] }).collect();
    let state = |k: usize| SingleState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![0.1, 2.0, 0.01 * k as f32],
    };
    moves_as_alone::<Single, Exponential>((systems, (0..MEMBERS).map(state).collect()), 0.01, none);
}

#[test]
fn those_that_fail_do_not_stop_the_others() {
    let runaways = vec![Runaway { inertia: 1.0 }; MEMBERS];
    // some escape, at different times, and some have not yet
    let states: Vec<_> = (0..MEMBERS)
        .map(|k| RunawayState {
            position: vector![0.1 + 0.05 * ((k * 7) % MEMBERS) as f64],
            momentum: vector![0.2],
        })
        .collect();
    let mut expected = Vec::new();
    let mut ends = Vec::new();
    for (member, start) in states.iter().enumerate() {
        let mut state = *start;
        let mut stepper = runaways[member].stepper::<Exponential>(0.01).unwrap();
        for step in 1..=300 {
            if let Err(source) = stepper.step(&mut state) {
                expected.push((member, step, source));
                break;
            }
        }
        ends.push(state);
    }
    assert!(expected.len() > 10 && expected.len() < MEMBERS - 3, "{} fail", expected.len());
    for instructions in Instructions::available() {
        let mut ensemble =
            Ensemble::<_, Exponential>::with_instructions(&runaways, states.clone(), 0.01, instructions)
                .unwrap();
        let mut alive = Vec::new();
        let member_steps = ensemble.run_observed(300, 50, |ensemble| {
            alive.push(ensemble.members().count());
            assert_eq!(ensemble.members().count() + ensemble.failed().len(), ensemble.len());
            ControlFlow::Continue(())
        });
        assert_eq!(alive.len(), 7);
        assert!(alive.is_sorted_by(|a, b| a >= b));
        assert_eq!((alive[0], alive[6]), (MEMBERS, MEMBERS - expected.len()));
        assert_eq!((ensemble.failed().len(), ensemble.steps_taken()), (expected.len(), 300));
        let lost: u64 = expected.iter().map(|(_, step, _)| 300 - (step - 1)).sum();
        assert_eq!(member_steps, 300 * MEMBERS as u64 - lost);
        let failed = ensemble.failed().iter().map(|failed| (failed.member, failed.step, failed.source));
        assert!(failed.eq(expected.iter().copied()), "{instructions:?}: {:?}", ensemble.failed());
        for (member, (together, alone)) in ensemble.states().zip(&ends).enumerate() {
            assert_eq!(&together, alone, "member {member}, {instructions:?}");
        }
    }
}

#[test]
fn all_may_fail() {
    let states = vec![RunawayState { position: vector![3.0], momentum: vector![0.0] }; 3];
    let mut ensemble =
        Ensemble::<_, Exponential>::new(&vec![Runaway { inertia: 1.0 }; 3], states, 0.1).unwrap();
    let mut series = Vec::new();
    let member_steps = ensemble.run_observed(1_000, 1_000, |ensemble| {
        series.push(ensemble.spread(|_, state| state.position.x));
        ControlFlow::Continue(())
    });
    assert_eq!((ensemble.steps_taken(), ensemble.failed().len()), (1_000, 3));
    assert!(member_steps < 300);
    assert_eq!(series.iter().map(|at| at.members).collect::<Vec<_>>(), [3, 0]);
    assert!(series[1].mean.is_nan());
    assert_eq!(ensemble.run(5), 0);
}

#[test]
fn at_no_time_in_particular_nobody_moves() {
    let (systems, states) = pendulums();
    let mut ensemble = Ensemble::<Pendulum, Cayley>::new(&systems, states, 0.05).unwrap();
    ensemble.run(300);
    assert!(ensemble.failed().is_empty());
    let before: Vec<_> = ensemble.states().collect();
    ensemble.set_time(f64::INFINITY);
    assert_eq!((ensemble.run(1), ensemble.failed().len()), (0, MEMBERS));
    assert!(ensemble.failed().iter().all(|failed| failed.source == StepError::NotFinite));
    assert!(ensemble.states().eq(before));
}

#[test]
fn threads_make_no_difference() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (systems, states) = tops();
        let mut ensemble = Ensemble::<_, Cayley>::new(&systems, states, 0.01).unwrap();
        pool.install(|| ensemble.run(500));
        ensemble.states().collect::<Vec<_>>()
    };
    let one = run(1);
    for threads in [2, 3, 8] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

#[test]
fn members_that_cannot_be_are_refused() {
    let (mut systems, mut states) = bodies();
    let refused = |systems: &[Body], states: &[BodyState], step: f64| {
        Ensemble::<_, Cayley>::new(systems, states.to_vec(), step).err()
    };
    assert_eq!(refused(&systems, &states, 0.01), None);
    assert_eq!(refused(&systems[..3], &states, 0.01), Some(EnsembleError::TooFewSystems { systems: 3 }));
    let step = Some(EnsembleError::Parameters { member: 0, source: ParameterError::Step { step: 0.0 } });
    assert_eq!(refused(&systems, &states, 0.0), step);
    states[9].momentum.y = f64::NAN;
    let state = Some(EnsembleError::State { member: 9, source: StepError::NotFinite });
    assert_eq!(refused(&systems, &states, 0.01), state);
    states[5].attitude = UnitQuaternion::new_unchecked(Quaternion::new(1.5, 0.0, 0.0, 0.0));
    let state = EnsembleError::State { member: 5, source: StepError::NotOnGroup { deviation: 0.5 } };
    assert_eq!(refused(&systems, &states, 0.01), Some(state));
    systems[5].inertia.x = f64::INFINITY;
    let error = refused(&systems, &states, 0.01).unwrap();
    let source = ParameterError::NotFinite { name: "inertia" };
    assert_eq!(error, EnsembleError::Parameters { member: 5, source });
    assert_eq!(error.to_string(), "member 5");
    assert_eq!(std::error::Error::source(&error).unwrap().to_string(), "parameter `inertia` is not finite");
}

#[test]
fn nobody_is_an_ensemble_too() {
    let mut ensemble = Ensemble::<Body, Cayley>::new(&[], [], 0.01).unwrap();
    assert!(ensemble.is_empty());
    assert_eq!(ensemble.run(10), 0);
    assert_eq!(ensemble.time(), 0.1);
    assert!(ensemble.state(0).is_none() && ensemble.system(0).is_none());
}

#[test]
fn an_observer_can_end_the_run() {
    let (systems, states) = bodies();
    let mut ensemble = Ensemble::<_, Cayley>::new(&systems, states, 0.25).unwrap();
    ensemble.set_time(-1.0);
    let mut times = Vec::new();
    ensemble.run_observed(100, 4, |ensemble| {
        times.push(ensemble.time());
        match ensemble.steps_taken() {
            12 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    assert_eq!(ensemble.steps_taken(), 12);
    assert_eq!(times, [-1.0, 0.0, 1.0, 2.0]);
    assert_eq!(ensemble.system(3).unwrap().inertia.x, 1.03);
}

#[test]
fn distributions_are_of_the_members() {
    let states = (0..5).map(|k| BodyState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![[3.0, 1.0, 2.0, 9.0, 0.0][k], 0.0, 0.0],
    });
    let body = Body { inertia: vector![1.0, 1.0, 1.0] };
    let mut ensemble = Ensemble::<_, Cayley>::new(std::iter::repeat(&body), states, 0.5).unwrap();
    let mut series = Vec::new();
    ensemble.run_observed(2, 1, |ensemble| {
        series.push(ensemble.spread(|_, state| state.momentum.x));
        ControlFlow::Continue(())
    });
    let mean = 3.0;
    let deviation = f64::sqrt((0.0 + 4.0 + 1.0 + 36.0 + 9.0) / 5.0);
    let quantiles = [0.0, 0.2, 1.0, 2.0, 3.0, 7.8, 9.0];
    let [first, .., last] = &series[..] else { panic!("three series") };
    for (k, (is, should_be)) in first.quantiles.iter().zip(quantiles).enumerate() {
        assert!((is - should_be).abs() < 1e-15, "{k}: {is}");
    }
    assert_eq!((first.time, first.members, first.mean, first.deviation), (0.0, 5, mean, deviation));
    // nothing acts, and all are alike
    assert_eq!(last.time, 1.0);
    assert_eq!(
        (last.members, last.mean, last.deviation, last.quantiles),
        (first.members, first.mean, first.deviation, first.quantiles)
    );
}

/// Mean and standard deviation of numbers must be these within five deviations of what is found in so many, and numbers of neighbours in the
/// list must have nothing to do with each other.
fn check_sample(name: &str, values: &[f64], mean: f64, deviation: f64) {
    let n = values.len() as f64;
    let found = values.iter().sum::<f64>() / n;
    assert!((found - mean).abs() < 5.0 * deviation / n.sqrt(), "{name}: mean {found}");
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    // the variance of a sample's variance is at most that of a normal distribution's, 2 σ⁴/n
    let off = variance / deviation.powi(2) - 1.0;
    assert!(off.abs() < 5.0 * (2.0 / n).sqrt(), "{name}: variance off by {off}");
    let product = values.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum::<f64>() / n;
    let correlation = product / deviation.powi(2);
    assert!(correlation.abs() < 5.0 / n.sqrt(), "{name}: correlation {correlation}");
}

/// A state and the local coordinates of one about it.
fn coordinates(about: &BodyState, state: &BodyState) -> [f64; 6] {
    let turn = (about.attitude.inverse() * state.attitude).scaled_axis();
    let momentum = state.momentum - about.momentum;
    [turn.x, turn.y, turn.z, momentum.x, momentum.y, momentum.z]
}

#[test]
fn initial_states_are_distributed_as_asked() {
    let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    let about = BodyState {
        attitude: UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1),
        momentum: vector![0.1, 2.0, -0.3],
    };
    let reach = [0.02, 0.3, 0.1, 0.5, 1e-3, 0.0];
    let normal: Vec<BodyState> = (0..20_000).map(normal(&body, about, reach, 7)).collect();
    let uniform: Vec<BodyState> = (0..20_000).map(uniform(&body, about, reach, 7)).collect();
    for (shape, states, scale) in [("normal", normal, 1.0), ("uniform", uniform, f64::sqrt(1.0 / 3.0))] {
        for state in &states {
            let length = state.attitude.as_ref().norm();
            assert!((length - 1.0).abs() < 1e-15, "{length}");
            assert_eq!(state.momentum.z, about.momentum.z);
        }
        let all: Vec<[f64; 6]> = states.iter().map(|state| coordinates(&about, state)).collect();
        for component in 0..5 {
            let values: Vec<f64> = all.iter().map(|of| of[component]).collect();
            check_sample(&format!("{shape}, {component}"), &values, 0.0, scale * reach[component]);
            if shape == "uniform" {
                let farthest = values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                assert!(farthest < reach[component] * (1.0 + 1e-9) && farthest > 0.99 * reach[component]);
            }
        }
        // one after the other, the components of all states: neighbours are of one member
        let values = all.iter().flat_map(|of| (0..5).map(|k| of[k] / reach[k]));
        check_sample(shape, &values.collect::<Vec<_>>(), 0.0, scale);
    }
}

#[test]
fn initial_states_are_functions_of_seed_and_number() {
    let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    let about = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, -0.3] };
    let of = |seed| normal(&body, about, [0.1; 6], seed);
    let first: Vec<BodyState> = (0..100).map(of(7)).collect();
    assert_eq!((0..50).map(of(7)).collect::<Vec<_>>(), first[..50]);
    // in any order
    let drawn = of(7);
    for (k, state) in first.iter().enumerate().rev() {
        assert_eq!(&drawn(k), state);
    }
    // other seeds and other members are others
    let all: Vec<BodyState> =
        [0, 6, 7, 8, u64::MAX].into_iter().flat_map(|seed| (0..100).map(of(seed))).collect();
    for (k, state) in all.iter().enumerate() {
        assert!(!all[..k].contains(state), "{k}");
    }
}

#[test]
fn initial_states_of_single_precision() {
    #[lie_poisson_system(group = SE3)]
    struct Craft {
        #[inertia]
        inertia: Matrix6<f32>,
    }

    let craft = Craft { inertia: Matrix6::identity() };
    let start = CraftState { pose: Isometry3::translation(1.0, 2.0, 3.0), momentum: Vector6::zeros() };
    let widths = [0.1, 0.1, 0.1, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let states = (0..64).map(uniform(&craft, start, widths, 1));
    let mut ensemble = Ensemble::<_, Exponential>::new(std::iter::repeat(&craft), states, 0.01).unwrap();
    assert_eq!((ensemble.run(10), ensemble.failed().len()), (640, 0));
    let moved = ensemble.states().filter(|state| state.pose.translation.x != 1.0).count();
    assert_eq!(moved, 64);
    let off = UnitQuaternion::identity().angle_to(&ensemble.state(5).unwrap().pose.rotation);
    assert!(off > 0.0 && off < 0.2, "{off}");
}
