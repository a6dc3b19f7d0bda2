//! What is erased does the same as what is typed, to the last bit.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use coadjoint::__private::{Geometry, RetractionKind};
use coadjoint::certify::{Certification, CertifyError, Report, certify_erased};
use coadjoint::composition::{Coefficients, Composed, KahanLi6, Suzuki4};
use coadjoint::derivative::{HasDerivative, Linearizable, WrtControl, WrtParameters, WrtState};
use coadjoint::ensemble::{EnsembleError, Instructions};
use coadjoint::erased::{self, StepperError};
use coadjoint::prelude::*;
use coadjoint::scheme::Rule;
use coadjoint::{Discretized, Run, Scheme, TangentLift};

/// Invariant: its standard step is one equation.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.x, methods(Midpoint, TangentLift))]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
}

/// With one retraction, and a force.
#[lie_poisson_system(group = SO3, control(moment: R3), force = moment, retractions(Cayley))]
struct Satellite {
    #[inertia]
    inertia: Vector3<f64>,
}

/// Pushed, on two factors, and with a time of its own: its standard step has two halves.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(thrust: f64),
    potential = mass * 9.81 * position.z + (2.0 * t).sin() * position.x,
    force(position = attitude * (thrust * Vector3::z())),
    methods(Midpoint),
)]
struct Craft {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
}

/// Steered, with the derivatives of its steps.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(thrust: f64),
    potential = mass * 9.81 * position.z,
    force(position = attitude * (thrust * Vector3::z())),
    methods(Midpoint),
    derivatives,
)]
struct Drone {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
}

/// On a line, where all retractions are one.
#[lie_poisson_system(group = R1, potential = stiffness * position.x.powi(4))]
struct Line {
    #[inertia]
    mass: f64,
    stiffness: f64,
}

fn cayley() -> Scheme {
    Scheme::Standard(RetractionKind::Cayley)
}

/// A system with its type erased.
fn erased<S: erased::System>(system: &S) -> &dyn erased::System {
    system
}

/// The same, shared.
fn shared<S: erased::System>(system: &S) -> Arc<dyn erased::System> {
    system.with_parameters(&[])
}

fn top() -> (Top, TopState) {
    let attitude = UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1);
    let state =
        TopState { attitude, momentum: vector![0.4, -0.8, 1.5], gamma: attitude.inverse() * Vector3::z() };
    (Top { inertia: vector![1.0, 2.0, 2.5], weight: 0.7 }, state)
}

fn craft() -> (Craft, CraftState) {
    let state = CraftState {
        attitude: UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1),
        attitude_momentum: vector![0.01, -0.03, 0.02],
        position: vector![0.1, 0.2, 0.3],
        position_momentum: vector![-1.0, 0.5, 0.2],
    };
    (Craft { inertia: vector![0.03, 0.05, 0.04], mass: 1.3 }, state)
}

/// The same steps one by one and in batches, from a time on, and the same memory, with which a run goes on.
fn agree<M, S>((system, start): (S, S::State), scheme: &Scheme, control: &S::Control)
where
    S: Discretized<M> + Geometry<Scalar = f64> + erased::System,
{
    const STEP: f64 = 0.02;
    let mut typed = system.stepper::<M>(STEP).unwrap();
    let mut other = erased::Stepper::new(shared(&system), scheme, STEP).unwrap();
    typed.set_time(0.7);
    other.set_time(0.7);
    let mut state = start;
    let mut numbers = state.to_components().as_ref().to_vec();
    let held = control.to_components().as_ref().to_vec();
    for _ in 0..40 {
        let report = typed.step_with(&mut state, control).unwrap();
        assert_eq!(other.step(&mut numbers, &held), Ok(report));
        assert_eq!(state.to_components().as_ref(), numbers, "{scheme}");
    }
    let report = typed.steps_with(&mut state, control, 2_000).unwrap();
    assert_eq!(other.steps(&mut numbers, &held, 2_000).unwrap().steps, report.steps);
    assert_eq!(state.to_components().as_ref(), numbers, "{scheme}");
    assert_eq!((other.time(), other.steps_taken()), (typed.time(), typed.steps_taken()));

    let memory = typed.snapshot();
    assert_eq!(other.snapshot(), memory, "{scheme}");
    let mut resumed = erased::Stepper::new(shared(&system), scheme, STEP).unwrap();
    resumed.restore(&memory).unwrap();
    resumed.steps(&mut numbers, &held, 100).unwrap();
    typed.steps_with(&mut state, control, 100).unwrap();
    assert_eq!(state.to_components().as_ref(), numbers, "{scheme}");
    assert!(resumed.restore(&memory[1..]).is_err());
}

#[test]
fn steps_are_those_of_the_typed_stepper() {
    let none = NoControl::default();
    agree::<Cayley, _>(top(), &Scheme::Standard(RetractionKind::Cayley), &none);
    agree::<Exponential, _>(top(), &Scheme::Standard(RetractionKind::Exponential), &none);
    agree::<Midpoint<Cayley>, _>(top(), &Scheme::member(RetractionKind::Cayley, 1, 2), &none);
    agree::<SymplecticEulerB, _>(top(), &Scheme::member(RetractionKind::Exponential, 1, 1), &none);
    agree::<StormerVerlet<Cayley>, _>(top(), &Scheme::StormerVerlet(RetractionKind::Cayley), &none);
    let order4 = Scheme::composed::<Suzuki4>(Scheme::Standard(RetractionKind::Cayley));
    agree::<Order4<Cayley>, _>(top(), &order4, &none);

    let thrust = CraftControl { thrust: 12.0 };
    agree::<Cayley, _>(craft(), &Scheme::Standard(RetractionKind::Cayley), &thrust);
    agree::<Exponential, _>(craft(), &Scheme::Standard(RetractionKind::Exponential), &thrust);
    agree::<Midpoint<Exponential>, _>(craft(), &Scheme::member(RetractionKind::Exponential, 1, 2), &thrust);
    let order6 = Scheme::composed::<KahanLi6>(Scheme::Standard(RetractionKind::Exponential));
    agree::<Order6<Exponential>, _>(craft(), &order6, &thrust);
}

/// The same derivatives as of typed steppers, but for rounding, and the same steps.
#[test]
fn derivatives_are_those_of_the_typed_stepper() {
    fn agree<M>(text: &str)
    where
        Drone: Discretized<M>,
        <Drone as Discretized<M>>::Method<f64>: HasDerivative<Drone> + Linearizable<Drone>,
    {
        let drone = Drone { inertia: vector![0.03, 0.05, 0.04], mass: 1.3 };
        let mut state = DroneState {
            attitude: UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1),
            attitude_momentum: vector![0.01, -0.03, 0.02],
            position: vector![0.1, 0.2, 0.3],
            position_momentum: vector![-1.0, 0.5, 0.2],
        };
        let mut typed = drone.stepper::<M>(0.02).unwrap();
        let mut other = erased::Stepper::new(shared(&drone), &text.parse().unwrap(), 0.02).unwrap();
        let (mut numbers, control) = (state.to_components().to_vec(), DroneControl { thrust: 12.0 });
        for _ in 0..3 {
            let blocks = (WrtState, WrtControl, WrtParameters);
            let step = typed.step_with_jacobian(&mut state, &control, blocks).unwrap();
            let (jacobian, report) = other.step_with_jacobian(&mut numbers, &[12.0]).unwrap();
            assert_eq!((report, &numbers[..]), (step.1, &state.to_components()[..]), "{text}");
            let (a, b, p) = step.0;
            for (is, should_be) in [
                (jacobian.state.as_slice(), a.as_slice()),
                (jacobian.control.as_slice(), b.as_slice()),
                (jacobian.parameters.as_slice(), p.as_slice()),
            ] {
                assert_eq!(is.len(), should_be.len(), "{text}");
                let off = is.iter().zip(should_be).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
                assert!(off < 1e-12 && should_be.iter().any(|x| *x != 0.0), "{text}: {off:e}");
            }
        }
        assert_eq!(other.steps_taken(), 3);
    }
    agree::<Cayley>("Cayley");
    agree::<Midpoint<Exponential>>("Midpoint");
    agree::<Order4<Exponential>>("Order4<Exponential>");

    // of a system whose description does not ask for them
    let (system, state) = top();
    let mut stepper =
        erased::Stepper::new(shared(&system), &Scheme::Standard(RetractionKind::Cayley), 0.1).unwrap();
    let (mut numbers, before) = (state.to_components().to_vec(), state.to_components().to_vec());
    let error = stepper.step_with_jacobian(&mut numbers, &[]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "no derivatives of the scheme `Cayley` were generated for `Top`; `derivatives` in its description asks for them"
    );
    assert_eq!((numbers, stepper.steps_taken()), (before, 0));
}

#[test]
fn members_move_as_they_would_alone() {
    fn alone<S: Discretized<Cayley> + Geometry<Scalar = f64> + erased::EnsembleSystem>(
        (system, start): (S, S::State),
        control: &S::Control,
        // and the most members that go side by side
        schemes: &[(&str, usize)],
    ) {
        let numbers = start.to_components().as_ref().to_vec();
        let parameters = erased(&system).parameters();
        let scaled = |k: usize| parameters.iter().map(|x| x * (1.0 + 0.01 * k as f64)).collect::<Vec<_>>();
        let held = control.to_components().as_ref().to_vec();
        for &(scheme, most) in schemes {
            let scheme: Scheme = scheme.parse().unwrap();
            let expected = |system: &dyn erased::System| {
                let mut expected = numbers.clone();
                let mut stepper = erased::Stepper::new(system.with_parameters(&[]), &scheme, 0.02).unwrap();
                stepper.steps(&mut expected, &held, 301).unwrap();
                expected
            };
            for instructions in Instructions::available() {
                let members = (0..11).map(|k| (scaled(k), numbers.clone()));
                let ensemble =
                    erased::Ensemble::with_instructions(&system, &scheme, members, 0.02, instructions);
                let mut ensemble = ensemble.unwrap();
                let width = match instructions {
                    #[cfg(target_arch = "x86_64")]
                    Instructions::Portable => 1,
                    #[cfg(target_arch = "x86_64")]
                    Instructions::Avx512 => most,
                    _ => 4,
                };
                assert_eq!(ensemble.width(), width, "{scheme}, {instructions:?}");
                ensemble.control(|_, _, control| control.copy_from_slice(&held));
                assert_eq!(ensemble.run(300) + ensemble.run(1), 11 * 301);
                for (member, system, state) in ensemble.members() {
                    assert_eq!(state, expected(system), "{scheme}, {instructions:?}, member {member}");
                }
                assert_eq!((ensemble.time(), ensemble.failed()), (301.0 * 0.02, &[][..]));
            }
        }
    }
    alone(
        top(),
        &NoControl::default(),
        &[("Cayley", 8), ("Order4<Cayley>", 8), ("Exponential", 4), ("Order4<Exponential>", 4)],
    );
    let held = CraftControl { thrust: 12.0 };
    alone(
        craft(),
        &held,
        &[("Cayley", 8), ("Order6<Cayley>", 8), ("Exponential", 4), ("Order6<Exponential>", 4)],
    );
    // where all retractions are one
    let start = LineState { position: vector![0.7], momentum: vector![-0.2] };
    alone(
        (Line { mass: 2.0, stiffness: 3.0 }, start),
        &NoControl::default(),
        &[("Exponential", 8), ("Order4<Cayley>", 8)],
    );
}

/// From turns of hundredths to some of radians a step, beside each other: each lane has a series of its own for the exponential, of four, and some
/// cannot go on. What happens in one is nothing to the others.
#[test]
fn members_that_turn_fast_are_nothing_to_others() {
    let (system, start) = top();
    let faster = |k: usize| {
        let momentum = start.momentum * 1.4_f64.powi(k as i32);
        TopState { momentum, ..start }.to_components().to_vec()
    };
    const MEMBERS: usize = 19;
    for scheme in ["Exponential", "Cayley"] {
        let scheme: Scheme = scheme.parse().unwrap();
        let alone = (0..MEMBERS).map(|k| {
            let (mut state, mut stepper) =
                (faster(k), erased::Stepper::new(shared(&system), &scheme, 0.05).unwrap());
            let failed = stepper.steps(&mut state, &[], 200).err().map(|error| (error.step, error.cause));
            (state, failed)
        });
        let alone: Vec<_> = alone.collect();
        let failed = alone.iter().filter(|(_, failed)| failed.is_some()).count();
        assert_eq!(failed > 0, scheme == Scheme::Standard(RetractionKind::Exponential), "{scheme}: {failed}");
        assert!(failed < 10, "{failed}");
        for instructions in Instructions::available() {
            let members = (0..MEMBERS).map(|k| (erased(&system).parameters(), faster(k)));
            let ensemble = erased::Ensemble::with_instructions(&system, &scheme, members, 0.05, instructions);
            let mut ensemble = ensemble.unwrap();
            ensemble.run(200);
            let found = ensemble.failed().iter().map(|failed| (failed.member, (failed.step, failed.source)));
            let expected =
                alone.iter().enumerate().filter_map(|(k, (_, failed))| failed.map(|failed| (k, failed)));
            assert_eq!(found.collect::<Vec<_>>(), expected.collect::<Vec<_>>(), "{scheme}, {instructions:?}");
            for (member, _, state) in ensemble.members() {
                assert_eq!(state, alone[member].0, "{scheme}, {instructions:?}, member {member}");
            }
        }
    }
}

#[test]
fn a_scheme_that_members_have_not_side_by_side_is_refused() {
    let (system, state) = top();
    let refused = |scheme: &str| {
        let members = [(erased(&system).parameters(), state.to_components().to_vec())];
        erased::Ensemble::new(&system, &scheme.parse().unwrap(), members, 0.01).unwrap_err().to_string()
    };
    for scheme in ["Order4<Midpoint<Cayley>>", "SecondKind"] {
        assert_eq!(
            refused(scheme),
            format!(
                "the scheme `{scheme}` is not made of standard steps, with which alone ensembles of systems chosen at run time move; \
                 take `Exponential`, `Cayley`, or a composition of one"
            )
        );
    }
}

#[test]
fn members_that_cannot_be_are_refused() {
    let (system, state) = top();
    let (parameters, state) = (erased(&system).parameters(), state.to_components().to_vec());
    let refused = |member: usize, parameters: &[f64], state: &[f64], step: f64| {
        let right = (erased(&system).parameters(), top().1.to_components().to_vec());
        let mut members = vec![right; 5];
        members[member] = (parameters.to_vec(), state.to_vec());
        erased::Ensemble::new(&system, &cayley(), members, step).err()
    };
    let parameter = |member, source| Some(EnsembleError::Parameters { member, source });
    let wrong = |member, source| Some(EnsembleError::State { member, source });
    assert_eq!(refused(3, &parameters, &state, 0.01), None);
    assert_eq!(refused(3, &parameters, &state, 0.0), parameter(0, ParameterError::Step { step: 0.0 }));
    for got in [0, 3, 5] {
        let mut others = parameters.clone();
        others.resize(got, 1.0);
        let error = refused(3, &others, &state, 0.01);
        assert_eq!(error, parameter(3, ParameterError::Length { expected: 4, got }));
    }
    let infinite = [1.0, 2.0, 2.5, f64::INFINITY];
    let error = refused(4, &infinite, &state, 0.01);
    assert_eq!(error, parameter(4, ParameterError::NotFinite { name: "weight" }));
    // as are those of another system
    for length in [0, 9, 11, 13] {
        let mut others = state.clone();
        others.resize(length, 1.0);
        let error = refused(2, &parameters, &others, 0.01);
        assert_eq!(error, wrong(2, StepError::Length { expected: 10 }));
    }
    let mut lost = state.clone();
    lost[5] = f64::NAN;
    assert_eq!(refused(1, &parameters, &lost, 0.01), wrong(1, StepError::NotFinite));
    let mut long = state.clone();
    long[..4].copy_from_slice(&[0.0, 0.0, 1.5, 0.0]);
    let error = refused(0, &parameters, &long, 0.01);
    assert_eq!(error, wrong(0, StepError::NotOnGroup { deviation: 0.5 }));
}

#[test]
fn nobody_is_an_ensemble_too() {
    let (system, _) = top();
    let mut ensemble = erased::Ensemble::new(&system, &cayley(), [], 0.5).unwrap();
    ensemble.control(|_, _, control| control.fill(1.0));
    assert_eq!((ensemble.run(10), ensemble.time()), (0, 5.0));
    assert_eq!((ensemble.members().count(), ensemble.failed()), (0, &[][..]));
    // and has time for more steps than can be counted
    assert_eq!((ensemble.run(u64::MAX), ensemble.run(u64::MAX)), (0, 0));
}

/// Those that are held, and those of a law, which a member's own run has too. What is not written is zero, for this member and for no other.
#[test]
fn controls_of_members_are_their_own() {
    let (system, state) = craft();
    let numbers = state.to_components().to_vec();
    let members = || (0..11).map(|_| (erased(&system).parameters(), numbers.clone()));
    let held = |member: usize, control: &mut [f64]| match member {
        1 => {}
        _ => control[0] = 10.0 + member as f64,
    };
    let law = |member: usize, state: &[f64], time: f64, control: &mut [f64]| {
        held(member, control);
        control.iter_mut().for_each(|control| *control *= (3.0 * time).sin() - state[6]);
    };
    let mut ensemble = erased::Ensemble::new(&system, &cayley(), members(), 0.02).unwrap();
    let mut steered = erased::Ensemble::new(&system, &cayley(), members(), 0.02).unwrap();
    for _ in 0..3 {
        ensemble.control(|member, _, control| held(member, control));
        assert_eq!(ensemble.run(50), 550);
        assert_eq!(steered.run_controlled(50, &law), 550);
    }
    let scheme = cayley();
    let stepper = || erased::Stepper::new(shared(&system), &scheme, 0.02).unwrap();
    for ((member, _, state), (_, _, other)) in ensemble.members().zip(steered.members()) {
        let (mut expected, mut control) = (numbers.clone(), [0.0]);
        held(member, &mut control);
        stepper().steps(&mut expected, &control, 150).unwrap();
        assert_eq!(state, expected, "member {member}");

        let own = |state: &Vec<f64>, time: f64| {
            let mut control = vec![0.0];
            law(member, state, time, &mut control);
            control
        };
        let mut expected = numbers.clone();
        Run::new(&mut stepper(), &mut expected).controlled_by(own).every(40, |_| {}).steps(150).unwrap();
        assert_eq!(other, expected, "member {member}");
    }
    assert_eq!((ensemble.members().count(), steered.members().count()), (11, 11));
}

/// A law is asked once for each step, at the state and the time that the step starts from.
#[test]
fn laws_see_what_single_steps_start_from() {
    let (system, start) = craft();
    let scheme = Scheme::Standard(RetractionKind::Exponential);
    let choose = |state: &[f64], time: f64| 12.0 + state[9] - (5.0 * time).cos();
    let mut alone = erased::Stepper::new(shared(&system), &scheme, 0.02).unwrap();
    let mut expected = start.to_components().to_vec();
    for _ in 0..100 {
        let control = choose(&expected, alone.time());
        alone.step(&mut expected, &[control]).unwrap();
    }
    let law = |state: &Vec<f64>, time: f64| vec![choose(state, time)];
    let mut stepper = erased::Stepper::new(shared(&system), &scheme, 0.02).unwrap();
    let mut state = start.to_components().to_vec();
    let report = Run::new(&mut stepper, &mut state).controlled_by(law).every(30, |_| {}).steps(100);
    assert_eq!(report.unwrap().steps, 100);
    assert_eq!((state, stepper.time()), (expected, alone.time()));
    assert_eq!(stepper.snapshot(), alone.snapshot());
    let error = Run::new(&mut stepper, &mut vec![1.0]).controlled_by(|_, _| vec![0.0]).steps(100);
    assert_eq!(error.unwrap_err().cause, StepError::Length { expected: 13 });
}

/// With the erased trait in scope too, what is called on a system is what its own trait has.
#[test]
fn calls_of_a_system_are_its_own() {
    use erased::System as _;
    let (system, state) = top();
    let numbers = state.to_components().to_vec();
    let (energy, other) = (system.energy(&state), erased(&system).energy(&numbers, 0.0, &[]));
    assert_eq!(energy, other);
    assert_eq!(system.casimirs(&state).to_vec(), erased(&system).casimirs(&numbers));
    assert!(system.validate().is_ok());
    let wrong = system.with_parameters(&[1.0, -1.0]);
    assert_eq!((wrong.parameters(), wrong.validate().is_err()), (vec![1.0, -1.0, 2.5, 0.7], true));
}

/// A stepper goes to another thread and on from there.
#[test]
fn steppers_can_be_sent() {
    let (system, start) = top();
    let scheme = cayley();
    let walk = |stepper: &mut erased::Stepper, state: &mut [f64]| {
        stepper.steps(state, &[], 100).unwrap();
    };
    let mut expected = start.to_components().to_vec();
    let mut alone = erased::Stepper::new(shared(&system), &scheme, 0.02).unwrap();
    walk(&mut alone, &mut expected);
    walk(&mut alone, &mut expected);
    let mut state = start.to_components().to_vec();
    let mut stepper = erased::Stepper::new(shared(&system), &scheme, 0.02).unwrap();
    walk(&mut stepper, &mut state);
    let state = std::thread::scope(|scope| {
        let other = scope.spawn(move || {
            walk(&mut stepper, &mut state);
            state
        });
        other.join().unwrap()
    });
    assert_eq!(state, expected);
}

#[test]
fn certificates_are_the_same() {
    let (system, state) = top();
    let numbers = state.to_components().to_vec();
    let certification = Certification::new(&system).states(&[state]).step(0.05);
    let same = |typed: Result<Report, CertifyError>, scheme: &Scheme, name: &str| {
        let typed = typed.unwrap();
        let other =
            certify_erased(&system, scheme, std::slice::from_ref(&numbers), &[], 0.0, Some(0.05)).unwrap();
        assert_eq!((other.to_string(), other.properties), (typed.to_string(), typed.properties));
        assert_eq!((other.scheme.as_deref(), &*scheme.to_string()), (Some(name), name));
        assert!(other.passed(), "{other}");
    };
    let cayley = Scheme::Standard(RetractionKind::Cayley);
    let exponential = Scheme::Standard(RetractionKind::Exponential);
    same(certification.run::<Cayley>(), &cayley, "Cayley");
    same(
        certification.run::<Midpoint<Cayley>>(),
        &Scheme::member(RetractionKind::Cayley, 1, 2),
        "Midpoint<Cayley>",
    );
    let euler = Scheme::member(RetractionKind::Exponential, 1, 1);
    same(certification.run::<SymplecticEulerB>(), &euler, "SymplecticEulerB<Exponential>");
    let verlet = Scheme::StormerVerlet(RetractionKind::Exponential);
    same(certification.run::<StormerVerlet>(), &verlet, "StormerVerlet<Exponential>");
    let lift = Scheme::Step(RetractionKind::Exponential, Rule::TangentLift(0, 1));
    same(certification.run::<TangentLift>(), &lift, "TangentLift<Exponential>");
    let order4 = Scheme::composed::<Suzuki4>(exponential);
    same(certification.run::<Order4<Exponential>>(), &order4, "Order4<Exponential>");
    let order6 = Scheme::composed::<KahanLi6>(Scheme::StormerVerlet(RetractionKind::Cayley));
    same(certification.run::<Order6<StormerVerlet<Cayley>>>(), &order6, "Order6<StormerVerlet<Cayley>>");
    let own = Scheme::composed::<TwoHalfSteps>(cayley);
    same(certification.run::<Composed<TwoHalfSteps, Cayley>>(), &own, "Composed<TwoHalfSteps, Cayley>");

    let (system, state) = craft();
    let (numbers, control) = (state.to_components().to_vec(), CraftControl { thrust: 9.0 });
    let certification = Certification::new(&system).states(&[state]).controls(&[control]).step(0.05);
    let typed = certification.run::<Midpoint<Cayley>>().unwrap();
    let scheme = Scheme::member(RetractionKind::Cayley, 1, 2);
    let other = certify_erased(&system, &scheme, &[numbers], &[vec![9.0]], 0.0, Some(0.05)).unwrap();
    assert_eq!(other.to_string(), typed.to_string());
    let jumps = typed.certificate("control jumps").unwrap();
    assert!(jumps.figure > 0.0 && typed.passed(), "{typed}");
}

/// Coefficients of one's own.
struct TwoHalfSteps;

impl Coefficients for TwoHalfSteps {
    type Steps<X: Clone + Send + Sync> = [X; 2];
    const ORDER: u32 = 2;
    const GAMMA: &'static [f64] = &[0.5, 0.5];

    fn steps<X: Clone + Send + Sync>(make: impl FnMut(usize) -> X) -> [X; 2] {
        std::array::from_fn(make)
    }
}

#[test]
fn certificates_fail_for_the_same_reasons() {
    let (system, state) = top();
    let numbers = state.to_components().to_vec();
    let scheme = Scheme::member(RetractionKind::Cayley, 1, 2);
    let refused = |system: &dyn erased::System, numbers: &[f64], step: f64| {
        certify_erased(system, &scheme, &[numbers.to_vec()], &[], 0.0, Some(step)).unwrap_err()
    };
    let typed = |system: &Top, state: TopState, step: f64| {
        Certification::new(system).states(&[state]).step(step).run::<Midpoint<Cayley>>().unwrap_err()
    };
    let error = refused(&system, &numbers, 0.0);
    assert_eq!(error, CertifyError::Parameter(ParameterError::Step { step: 0.0 }));
    assert_eq!(typed(&system, state, 0.0), error);

    let heavy = Top { inertia: vector![1.0, 2.0, 2.5], weight: f64::INFINITY };
    let error = refused(&heavy, &numbers, 0.05);
    assert_eq!(error, CertifyError::Parameter(ParameterError::NotFinite { name: "weight" }));
    assert_eq!(typed(&heavy, state, 0.05), error);

    let long = UnitQuaternion::new_unchecked(Quaternion::new(1.5, 0.0, 0.0, 0.0));
    let off = TopState { attitude: long, ..state };
    let error = refused(&system, off.to_components().as_ref(), 0.05);
    let source = StepError::NotOnGroup { deviation: 0.5 };
    assert_eq!(error, CertifyError::Step { certificate: "sample".to_owned(), state: 0, source });
    assert_eq!(typed(&system, off, 0.05), error);

    for length in [0, 3, 9, 11, 20] {
        let mut wrong = numbers.clone();
        wrong.resize(length, 0.5);
        let source = StepError::Length { expected: 10 };
        let error = CertifyError::Step { certificate: "sample".to_owned(), state: 0, source };
        assert_eq!(refused(&system, &wrong, 0.05), error);
    }
}

#[test]
fn what_was_not_generated_is_said() {
    let (system, state) = top();
    let scheme = Scheme::member(RetractionKind::Cayley, 1, 4);
    let error = erased::Stepper::new(shared(&system), &scheme, 0.1).unwrap_err();
    let StepperError::NotGenerated(missing) = error else { panic!("{error}") };
    assert_eq!(
        (missing.scheme.as_str(), missing.system, missing.key),
        ("Family<Cayley, 1, 4>", "Top", "methods")
    );
    let numbers = state.to_components().to_vec();
    let error = certify_erased(&system, &scheme, &[numbers], &[], 0.0, None).unwrap_err();
    assert_eq!(error, CertifyError::NotGenerated(missing));
    // by the key of the description that asks for it
    let satellite = Satellite { inertia: vector![1.0, 2.0, 2.5] };
    let advice = |scheme: &Scheme| {
        let error = erased::Stepper::new(shared(&satellite), scheme, 0.1).unwrap_err().to_string();
        error.split_once("; ").unwrap().1.to_owned()
    };
    let [methods, retractions] =
        ["methods", "retractions"].map(|key| format!("`{key}(…)` in its description asks for it"));
    assert_eq!(advice(&Scheme::member(RetractionKind::Cayley, 1, 2)), methods);
    assert_eq!(advice(&Scheme::Standard(RetractionKind::Exponential)), retractions);
    assert_eq!(advice(&Scheme::StormerVerlet(RetractionKind::Exponential)), retractions);
    assert_eq!(advice(&Scheme::member(RetractionKind::Exponential, 1, 2)), retractions);
    assert_eq!(
        advice(&Scheme::composed::<Suzuki4>(Scheme::Standard(RetractionKind::Exponential))),
        retractions
    );
    assert!(erased::Stepper::new(shared(&satellite), &Scheme::Standard(RetractionKind::Cayley), 0.1).is_ok());
    // a member that is none claims what it would
    let none = Scheme::member(RetractionKind::Cayley, u32::MAX, 2);
    assert_eq!(none.properties(&erased(&craft().0).description()).order, 1);
    let wrong = erased(&system).with_parameters(&[1.0, -1.0, 1.0, 0.0]);
    assert!(matches!(
        erased::Stepper::new(wrong, &Scheme::Standard(RetractionKind::Cayley), 0.1),
        Err(StepperError::Parameter(_))
    ));
}

#[test]
fn states_of_other_systems_are_refused() {
    let (system, state) = top();
    let mut stepper =
        erased::Stepper::new(shared(&system), &Scheme::Standard(RetractionKind::Cayley), 0.1).unwrap();
    let numbers = state.to_components().to_vec();
    let error = StepError::Length { expected: numbers.len() };
    for length in [0, 1, numbers.len() - 1, numbers.len() + 1] {
        let mut wrong = numbers.clone();
        wrong.resize(length, 0.0);
        assert_eq!(stepper.step(&mut wrong, &[]), Err(error));
        assert_eq!(stepper.steps(&mut wrong, &[], 10).unwrap_err().cause, error);
    }
    assert_eq!(error.to_string(), "the state must have 10 numbers: it is of another system");
    assert_eq!(stepper.steps_taken(), 0);
    // functions of a state fill it up, or cut it off
    for length in [0, 3, numbers.len() + 2] {
        let mut wrong = numbers.clone();
        wrong.resize(length, 0.0);
        assert_eq!(erased(&system).vector_field(&wrong, 0.0, &[]).len(), numbers.len());
    }
    // a control is filled up with zeros, or cut off
    let mut right = numbers.clone();
    assert!(stepper.step(&mut right, &[0.3]).is_ok());
}

/// A run shows what has to be seen and no more, and comes to the same whatever that is.
#[test]
fn a_run_is_looked_at_when_it_is_asked() {
    let (system, start) = top();
    let walk = |interval: u64| {
        let mut stepper =
            erased::Stepper::new(shared(&system), &Scheme::Standard(RetractionKind::Cayley), 0.02).unwrap();
        let mut state = start.to_components().to_vec();
        let mut seen = Vec::new();
        let run = Run::new(&mut stepper, &mut state);
        let run = run.every(interval, |tick| seen.push((tick.index, tick.state.clone())));
        assert_eq!(run.steps(1_000).unwrap().steps, 1_000);
        seen
    };
    let every = walk(1);
    let some = walk(300);
    assert_eq!(every.len(), 1_001);
    assert_eq!(some.iter().map(|(index, _)| *index).collect::<Vec<_>>(), [0, 300, 600, 900]);
    assert!(some.iter().all(|(index, state)| every[*index as usize].1 == *state));
}
