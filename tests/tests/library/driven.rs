//! Inputs that are functions of time: the order of the scheme, and the same bits from every kind of stepper.
// a test that cannot go on is to say so
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use coadjoint::ensemble::Instructions;
use coadjoint::erased::RetractionKind;
use coadjoint::prelude::*;
use coadjoint::{Compensated, Discretized, Ensemble, Fused, Run, Scheme, SchemeType, System, erased};

/// A rigid body with a torque about each axis.
#[lie_poisson_system(group = SO3, control(torque: R3), force = torque, methods(Midpoint, SymplecticEulerA))]
#[derive(Clone)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

/// The same body, whose torque stands in its description.
#[lie_poisson_system(
    group = SO3,
    force = vector![(1.3 * t).sin(), 0.5 * (0.7 * t).cos(), 0.2 * t],
    retractions(Exponential),
)]
struct Described {
    #[inertia]
    inertia: Vector3<f64>,
}

const INERTIA: [f64; 3] = [1.0, 2.0, 2.5];
const END: f64 = 2.0;

fn body() -> Body {
    Body { inertia: INERTIA.into() }
}

fn start() -> BodyState {
    BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.4, -0.8, 1.5] }
}

fn torque(time: f64) -> BodyControl {
    BodyControl { torque: vector![(1.3 * time).sin(), 0.5 * (0.7 * time).cos(), 0.2 * time] }
}

/// The end of the motion, by a step of order 8 that sees the torque itself.
fn reference() -> (UnitQuaternion<f64>, Vector3<f64>) {
    let BodyState { attitude, momentum } = start();
    let mut state = DescribedState { attitude, momentum };
    let mut stepper =
        Described { inertia: INERTIA.into() }.stepper::<Order8<Exponential>>(END / 400.0).unwrap();
    stepper.steps_with(&mut state, &NoControl::default(), 400).unwrap();
    (state.attitude, state.momentum)
}

fn driven<M>(steps: u32) -> BodyState
where
    Body: Discretized<M>,
{
    let mut state = start();
    let mut stepper = body().stepper::<M>(END / f64::from(steps)).unwrap();
    Run::new(&mut stepper, &mut state).driven_by(torque).steps(steps.into()).unwrap();
    state
}

fn assert_order<M>(order: f64, steps: u32)
where
    Body: Discretized<M>,
{
    let (attitude, momentum) = reference();
    let errors = [1, 2, 4].map(|times| {
        let end = driven::<M>(times * steps);
        (end.momentum - momentum).norm().max(end.attitude.angle_to(&attitude))
    });
    for pair in errors.windows(2) {
        let measured = (pair[0] / pair[1]).log2();
        assert!((measured - order).abs() < 0.1, "order {measured} instead of {order}: {errors:?}");
    }
}

#[test]
fn a_driven_run_has_the_order_of_its_scheme() {
    assert_order::<Exponential>(2.0, 40);
    assert_order::<Cayley>(2.0, 40);
    assert_order::<Midpoint<Cayley>>(2.0, 40);
    assert_order::<StormerVerlet<Exponential>>(2.0, 40);
    assert_order::<Fused<Exponential>>(2.0, 40);
    assert_order::<Order4<Exponential>>(4.0, 40);
    assert_order::<Order4<Midpoint<Cayley>>>(4.0, 40);
    assert_order::<Order4<StormerVerlet<Cayley>>>(4.0, 40);
    assert_order::<Order6<Exponential>>(6.0, 8);
    assert_order::<Order6<Fused<Cayley>>>(6.0, 16);
    assert_order::<Compensated<Order6<Cayley>>>(6.0, 16);
}

/// By what the typed stepper does, those that are chosen at run time and those side by side.
fn is_the_same_everywhere<M>()
where
    Body: Discretized<M>,
    M: SchemeType + 'static,
{
    const STEPS: u64 = 40;
    let expected = driven::<M>(STEPS as u32);
    let step = END / STEPS as f64;

    let scheme: Scheme = M::scheme();
    let system: Arc<dyn erased::System> = Arc::new(body());
    let mut stepper = erased::Stepper::new(system, &scheme, step).unwrap();
    let mut state = start().to_components().to_vec();
    let input = |time: f64| torque(time).torque.as_slice().to_vec();
    Run::new(&mut stepper, &mut state).driven_by(input).steps(STEPS).unwrap();
    assert_eq!(state, expected.to_components(), "{scheme}");

    for instructions in Instructions::available() {
        let system = body();
        let members = std::iter::repeat_n(start(), 5);
        let mut ensemble: Ensemble<Body, M> =
            Ensemble::with_instructions(std::iter::repeat(&system), members, step, instructions).unwrap();
        // members 3 and 4 do something else
        let input = |member: usize, time: f64| torque(if member < 3 { time } else { -time });
        assert_eq!(ensemble.run_driven(STEPS / 2, input) + ensemble.run_driven(STEPS / 2, input), 5 * STEPS);
        for member in 0..5 {
            let is_same = ensemble.state(member).unwrap().to_components() == expected.to_components();
            assert_eq!(is_same, member < 3, "{scheme}, {instructions:?}, member {member}");
        }
        // what drove it is forgotten
        ensemble.control(|_, _| BodyControl::default());
        let momentum = ensemble.state(0).unwrap();
        ensemble.run(10);
        let after = ensemble.state(0).unwrap();
        let [before, after] = [momentum, after].map(|state| (state.attitude * state.momentum).norm());
        assert!((before - after).abs() < 1e-13 * before, "{before}, {after}");
    }
}

#[test]
fn erased_steppers_and_ensembles_are_driven_alike() {
    is_the_same_everywhere::<Cayley>();
    is_the_same_everywhere::<Order4<Cayley>>();
    is_the_same_everywhere::<Order6<Midpoint<Exponential>>>();
}

#[test]
fn an_erased_ensemble_is_driven_as_its_members_are() {
    const STEPS: u64 = 40;
    let expected = driven::<Cayley>(STEPS as u32).to_components();
    let system = body();
    let members = std::iter::repeat_n((INERTIA.to_vec(), start().to_components().to_vec()), 5);
    let mut ensemble = erased::Ensemble::new(
        &system,
        &Scheme::Standard(RetractionKind::Cayley),
        members,
        END / STEPS as f64,
    )
    .unwrap();
    ensemble.run_driven(STEPS, &|_, time, control| control.copy_from_slice(torque(time).torque.as_slice()));
    for (_, _, state) in ensemble.members() {
        assert_eq!(state, expected);
    }
}

#[test]
fn a_driven_run_goes_on_where_it_was_interrupted() {
    let expected = driven::<Order4<Cayley>>(40);
    let mut state = start();
    let mut stepper = body().stepper::<Order4<Cayley>>(END / 40.0).unwrap();
    Run::new(&mut stepper, &mut state).driven_by(torque).steps(17).unwrap();
    let memory = stepper.snapshot();
    let mut other = body().stepper::<Order4<Cayley>>(END / 40.0).unwrap();
    other.restore(&memory).unwrap();
    Run::new(&mut other, &mut state).driven_by(torque).steps(23).unwrap();
    assert_eq!(state.to_components(), expected.to_components());
}

#[test]
fn an_input_that_is_not_finite_is_an_error_and_leaves_the_state() {
    let mut state = start();
    let mut stepper = body().stepper::<Order4<Cayley>>(0.1).unwrap();
    let mut last = state;
    let input = |time: f64| {
        if time > 0.45 { BodyControl { torque: Vector3::repeat(f64::NAN) } } else { torque(time) }
    };
    let error = Run::new(&mut stepper, &mut state)
        .driven_by(input)
        .each(|tick| last = *tick.state)
        .steps(10)
        .unwrap_err();
    assert_eq!((error.step, error.cause), (5, coadjoint::StepError::NotFinite));
    assert_eq!((state.to_components(), stepper.time()), (last.to_components(), 0.4));
    // and the next step holds what it is given
    stepper.step_with(&mut state, &torque(0.4)).unwrap();
}

#[test]
fn observers_see_the_input_at_the_tick() {
    let mut state = start();
    let mut stepper = body().stepper::<Cayley>(0.1).unwrap();
    let mut seen = Vec::new();
    Run::new(&mut stepper, &mut state)
        .driven_by(torque)
        .each(|tick| seen.push((tick.time, tick.control.map(|control| control.torque))))
        .steps(5)
        .unwrap();
    assert_eq!(seen.len(), 6);
    assert_eq!(seen[0].1, None);
    for (time, control) in &seen[1..] {
        assert_eq!(*control, Some(torque(*time).torque));
    }
}

#[test]
fn a_control_is_held_for_as_many_steps_as_it_is_said() {
    let law =
        |state: &BodyState, time: f64| BodyControl { torque: -0.3 * state.momentum + torque(time).torque };
    let (mut asked, mut held) = (Vec::new(), Vec::new());
    let mut state = start();
    let mut stepper = body().stepper::<Cayley>(0.05).unwrap();
    // in two runs, the second of which starts between two times at which it would be asked
    for steps in [10, 14] {
        Run::new(&mut stepper, &mut state)
            .controlled_every(4, |state, time| {
                asked.push(time);
                law(state, time)
            })
            .each(|tick| {
                held.extend(tick.control.filter(|_| tick.index % 2 == 1).map(|control| control.torque))
            })
            .steps(steps)
            .unwrap();
    }
    let times = [0.0, 0.2, 0.4, 0.5, 0.6, 0.8, 1.0];
    assert!(asked.iter().zip(times).all(|(asked, time)| (asked - time).abs() < 1e-12), "{asked:?}");
    assert_eq!(asked.len(), times.len());

    // by hand
    let mut by_hand = start();
    let mut stepper = body().stepper::<Cayley>(0.05).unwrap();
    let mut expected = Vec::new();
    let mut control = BodyControl::default();
    for k in 0..24 {
        if [0, 4, 8, 10, 12, 16, 20].contains(&k) {
            control = law(&by_hand, stepper.time());
        }
        stepper.step_with(&mut by_hand, &control).unwrap();
        if k % 2 == 0 {
            expected.push(control.torque);
        }
    }
    assert_eq!(state.to_components(), by_hand.to_components());
    assert_eq!(held, expected);
}
