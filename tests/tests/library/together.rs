//! Steps taken together, and steps with products and sums rounded once: what single steps of the plain scheme are to be held against.
// a test that cannot go on is to say so
#![allow(clippy::unwrap_used)]

use coadjoint::__private::{Batch, Components, FusedScalar, Kernel, Method, Scalar};
use coadjoint::ensemble::Instructions;
use coadjoint::prelude::*;
use coadjoint::system::Generated;
use coadjoint::{Discretized, Ensemble, Record, Run, RunReport, StepReport, System};

use crate::systems::{Top, TopState};

/// A particle that nothing holds: it is gone after some time.
#[lie_poisson_system(group = R1, potential = -position.x.powi(4))]
#[derive(Clone)]
struct Runaway {
    #[inertia]
    inertia: f64,
}

fn top() -> (Top, TopState) {
    let system = Top { inertia: vector![1.0, 2.0, 2.5], weight: 0.7, chi: vector![0.3, 0.2, 1.0] };
    let state = TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![0.4, -0.8, 1.5],
        gamma: vector![0.0, 0.6, 0.8],
    };
    (system, state)
}

/// A run that is looked at now and then, against single steps.
fn goes_as_one_by_one<S, M>(system: &S, start: &S::State, step: S::Scalar)
where
    S: Discretized<M> + 'static,
    S::State: PartialEq,
    M: 'static,
{
    const STEPS: u64 = 3_000;
    let mut by_one = (system.stepper::<M>(step).unwrap(), start.clone());
    let mut expected = RunReport::default();
    let mut visited = vec![start.clone()];
    for _ in 0..STEPS {
        let StepReport { iterations, residual, .. } = by_one.0.step(&mut by_one.1).unwrap();
        expected.steps += 1;
        expected.iterations += u64::from(iterations);
        expected.max_iterations = expected.max_iterations.max(iterations);
        expected.max_residual = expected.max_residual.max(residual);
        visited.push(by_one.1.clone());
    }
    assert!(visited[1] != visited[0], "nothing moves");

    let mut together = (system.stepper::<M>(step).unwrap(), start.clone());
    let mut record = Record::every(700);
    let mut seen = Vec::new();
    let report = Run::new(&mut together.0, &mut together.1)
        .observe(&mut record)
        .every(11, |tick| seen.push((tick.index, tick.state.clone(), tick.report)))
        .steps(STEPS)
        .unwrap();
    assert!(together.1 == by_one.1, "the same end");
    assert_eq!(report, expected);
    assert_eq!(together.0.snapshot(), by_one.0.snapshot());
    assert_eq!(record.states().len(), 5);
    assert!(record.states().iter().enumerate().all(|(k, state)| *state == visited[700 * k]));
    // whoever wants to see less may be shown more
    let mut wanted = seen.iter().filter(|(index, ..)| index % 11 == 0);
    for k in 0..=STEPS / 11 {
        let (index, state, report) = wanted.next().unwrap();
        assert!(*index == 11 * k && *state == visited[(11 * k) as usize]);
        assert_eq!(report.is_some(), k > 0);
    }
}

#[test]
fn a_run_that_is_watched_now_and_then_goes_as_one_by_one() {
    let (system, start) = top();
    goes_as_one_by_one::<_, Cayley>(&system, &start, 0.01);
    goes_as_one_by_one::<_, Exponential>(&system, &start, 0.02);
    // several sweeps, and Newton's iteration
    goes_as_one_by_one::<_, Cayley>(&system, &start, 0.2);
    goes_as_one_by_one::<_, Midpoint<Exponential>>(&system, &start, 0.5);
    goes_as_one_by_one::<_, Order4<Cayley>>(&system, &start, 0.05);
    goes_as_one_by_one::<_, Fused<Exponential>>(&system, &start, 0.01);
    goes_as_one_by_one::<_, Compensated<Cayley>>(&system, &start, 0.01);
}

/// One evaluation of the equation does for nearly all steps, once it is known how well extrapolation does.
#[test]
fn nearly_all_steps_take_one_sweep() {
    let system = Top { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
    let mut state = TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 1.0, 1.0],
        gamma: Vector3::z(),
    };
    let mut stepper = system.stepper::<Cayley>(0.01).unwrap();
    stepper.steps_with(&mut state, &NoControl::default(), 5_000).unwrap();
    let report = stepper.steps_with(&mut state, &NoControl::default(), 50_000).unwrap();
    assert!(report.iterations < 50_250, "{}", report.iterations);
}

/// A usual step does not ask whether an attitude is finite: it is, whatever the unknown.
#[test]
fn attitudes_stay_of_unit_length() {
    fn stay<M>(system: &Top, start: &TopState)
    where
        Top: Generated<M>,
    {
        type KernelOf<M> = <Top as Generated<M>>::Kernel<f64>;
        assert!((0..10).filter(|k| KernelOf::<M>::is_bounded(*k)).eq(0..4), "the attitude and no more");
        let kernel = KernelOf::<M>::new(&system.to_parameters(), 0.01);
        let state = start.to_components();
        let begun = kernel.begin(&state, 0.0, &[]);
        for exponent in -300..=150 {
            let size = 10_f64.powi(exponent);
            let mut unknown = <KernelOf<M> as Kernel<f64>>::Unknown::splat(0.0);
            for (k, x) in unknown.as_mut().iter_mut().enumerate() {
                *x = [size, -0.3 * size, 0.7 * size][k % 3];
            }
            let evaluation = kernel.evaluate(&state, &begun, &unknown);
            let next = kernel.finish(&state, &begun, &unknown, &evaluation);
            let norm = next[..4].iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!((norm - 1.0).abs() < 1e-14, "{size:e}: {norm}");
        }
    }
    let (system, start) = top();
    stay::<SymplecticEulerA<Cayley>>(&system, &start);
    stay::<SymplecticEulerA<Exponential>>(&system, &start);
    stay::<Midpoint<Exponential>>(&system, &start);
}

#[test]
fn what_cannot_go_on_stops_where_single_steps_stop() {
    let system = Runaway { inertia: 1.0 };
    let start = RunawayState { position: vector![0.5], momentum: vector![0.2] };
    let mut by_one = (system.stepper::<Exponential>(0.1).unwrap(), start);
    let source = loop {
        if let Err(error) = by_one.0.step(&mut by_one.1) {
            break error;
        }
    };
    assert!(by_one.0.steps_taken_so_far() > 10, "it goes on for a while");

    let mut together = (system.stepper::<Exponential>(0.1).unwrap(), start);
    let error = together.0.steps_with(&mut together.1, &NoControl::default(), 1_000_000).unwrap_err();
    assert!(together.1 == by_one.1);
    let taken = by_one.0.steps_taken_so_far();
    assert_eq!((error.step, error.time, error.cause), (taken + 1, by_one.0.time(), source));
    assert_eq!((error.report.steps, together.0.time()), (taken, by_one.0.time()));

    let mut run = (system.stepper::<Exponential>(0.1).unwrap(), start);
    let again = Run::new(&mut run.0, &mut run.1).steps(1_000_000).unwrap_err();
    assert_eq!(again, error);
    assert!(run.1 == by_one.1);
}

#[test]
fn no_memory_makes_a_stepper_panic() {
    let (system, start) = top();
    let mut stepper = system.stepper::<Cayley>(0.01).unwrap();
    let mut state = start;
    stepper.steps_with(&mut state, &NoControl::default(), 200).unwrap();
    let memory = stepper.snapshot();
    for place in 0..memory.len() {
        for absurd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 1e300, 0.5, 4_294_967_295.0] {
            let mut memory = memory.clone();
            memory[place] = absurd;
            stepper.restore(&memory).unwrap();
            let mut state = state;
            // whatever comes of it
            let _ = stepper.steps_with(&mut state, &NoControl::default(), 300);
            let _ = stepper.step(&mut state);
        }
    }
    let shorter = stepper.restore(&memory[1..]);
    assert_eq!(
        shorter,
        Err(ParameterError::Snapshot { expected: memory.len(), got: memory.len() - 1 }),
        "one number less"
    );
}

/// How many steps a stepper has taken, whatever it starts from.
trait StepsTaken {
    fn steps_taken_so_far(&self) -> u64;
}

impl<S: Discretized<M>, M> StepsTaken for Stepper<S, M> {
    fn steps_taken_so_far(&self) -> u64 {
        coadjoint::stepper::Stepping::steps_taken(self)
    }
}

/// The steps of a fused scheme without the instruction: what processors do that do not have it.
fn by_detour<M>(system: &Top, start: &TopState, step: f64, steps: u64) -> TopState
where
    Top: Discretized<M>,
{
    type Numbers = <Top as System>::StateComponents<FusedScalar<f64>>;
    let parameters = system.to_parameters().map(FusedScalar::from);
    let mut method =
        <Top as Discretized<M>>::Method::<FusedScalar<f64>>::new(&parameters, FusedScalar::of(step));
    let mut state: Numbers = start.to_components().map(FusedScalar::from);
    for k in 0..steps {
        let time = FusedScalar::of(step * k as f64);
        state = method.advance(&state, time, &[], k > 0).map_err(|failure| failure.first()).unwrap().state;
    }
    TopState::from_components(&state.map(|number| number.lane(0)))
}

#[test]
fn fused_steps_are_the_same_on_every_machine() {
    let (system, start) = top();
    fn is_the_same<M: 'static>(system: &Top, start: &TopState, step: f64)
    where
        Top: Discretized<M>,
    {
        let after = |steps: u64| {
            let mut state = *start;
            let mut stepper = system.stepper::<Fused<M>>(step).unwrap();
            stepper.steps_with(&mut state, &NoControl::default(), steps).unwrap();
            state
        };
        assert!(after(1_500) == by_detour::<M>(system, start, step, 1_500));
        // not those of the plain scheme, but for roundings
        let mut plain = *start;
        let mut stepper = system.stepper::<M>(step).unwrap();
        stepper.steps_with(&mut plain, &NoControl::default(), 300).unwrap();
        let fused = after(300);
        let distance =
            (plain.momentum - fused.momentum).norm() + (plain.attitude.coords - fused.attitude.coords).norm();
        assert!(distance > 0.0 && distance < 1e-11, "{distance:e}");
    }
    is_the_same::<Cayley>(&system, &start, 0.01);
    is_the_same::<Exponential>(&system, &start, 0.01);
    is_the_same::<Cayley>(&system, &start, 0.1);
    is_the_same::<Order4<Exponential>>(&system, &start, 0.02);
}

#[test]
fn fused_members_move_as_they_would_alone() {
    let (system, start) = top();
    let systems: Vec<Top> = (0..11).map(|k| Top { weight: 0.1 * f64::from(k), ..system.clone() }).collect();
    for instructions in Instructions::available() {
        let mut ensemble = Ensemble::<Top, Fused<Cayley>>::with_instructions(
            &systems,
            vec![start; systems.len()],
            0.02,
            instructions,
        )
        .unwrap();
        ensemble.run(500);
        assert!(ensemble.failed().is_empty());
        for (together, system) in ensemble.states().zip(&systems) {
            let mut alone = start;
            let mut stepper = system.stepper::<Fused<Cayley>>(0.02).unwrap();
            stepper.steps_with(&mut alone, &NoControl::default(), 500).unwrap();
            assert!(together == alone, "{instructions:?}");
        }
    }
}

/// As the documentation of [`Stepper`] says.
#[test]
fn steppers_are_of_the_documented_size() {
    let sizes = [
        size_of::<Stepper<Top, Cayley>>(),
        size_of::<Stepper<Top, Exponential>>(),
        size_of::<Stepper<Top, Midpoint>>(),
    ];
    assert!(sizes.iter().all(|size| (750..=1_024).contains(size)), "{sizes:?}");
    let sizes = [
        size_of::<Stepper<Top, StormerVerlet<Cayley>>>(),
        size_of::<Stepper<Top, StormerVerlet<Exponential>>>(),
    ];
    assert!(sizes.iter().all(|size| (1_400..=1_900).contains(size)), "{sizes:?}");
}
