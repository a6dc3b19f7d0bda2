//! Steps that cannot be taken say why, leave the state as it was, and say the same whatever the stepper remembers.

// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use coadjoint::prelude::*;
use coadjoint::{Discretized, State, StepError, erased};

/// A mass in a potential that falls without end on one side: what falls there is lost in finite time.
#[lie_poisson_system(group(position: R1), potential = strength * position.x.powi(3) / 3.0, methods(Midpoint))]
#[derive(Clone)]
struct Falling {
    #[inertia]
    mass: f64,
    strength: f64,
}

/// A mass on a corrugated plane.
#[lie_poisson_system(group(position: R1), potential = -strength * position.x.cos(), methods(Midpoint))]
#[derive(Clone)]
struct Corrugated {
    #[inertia]
    mass: f64,
    strength: f64,
}

/// A free body.
#[lie_poisson_system(group = SO3, methods(Midpoint))]
#[derive(Clone)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

/// A planet that falls into its sun.
#[lie_poisson_system(group(position: R2), potential = -strength / position.norm(), methods(Midpoint))]
#[derive(Clone)]
struct Planet {
    #[inertia]
    mass: f64,
    strength: f64,
}

fn falling(position: f64, momentum: f64) -> FallingState {
    FallingState { position: vector![position], position_momentum: vector![momentum] }
}

fn corrugated(position: f64, momentum: f64) -> CorrugatedState {
    CorrugatedState { position: vector![position], position_momentum: vector![momentum] }
}

/// The error of a first step, which leaves the state as it was.
fn error<M, S: Discretized<M>>(system: &S, start: &S::State, step: S::Scalar) -> StepError
where
    S::Control: Default,
{
    let mut stepper = system.stepper::<M>(step).unwrap();
    let mut state = start.clone();
    let error = stepper.step_with(&mut state, &S::Control::default()).unwrap_err();
    assert_eq!(&state, start, "{error}");
    // nor is anything remembered of it
    assert_eq!(stepper.step_with(&mut state, &S::Control::default()), Err(error));
    assert_eq!(&state, start, "{error}");
    error
}

/// Takes steps until one fails: its error is that of a new stepper from the same state, which stays as it was.
fn ends_alike<M, S: Discretized<M>>(
    system: &S,
    start: &S::State,
    step: S::Scalar,
    most: usize,
) -> (usize, StepError) {
    let control = S::Control::default();
    let mut warm = system.stepper::<M>(step).unwrap();
    let mut state = start.clone();
    for taken in 0..most {
        let before = state.clone();
        if let Err(error) = warm.step_with(&mut state, &control) {
            assert_eq!(state, before, "after {taken} steps");
            let mut new = system.stepper::<M>(step).unwrap();
            assert_eq!(new.step_with(&mut state, &control), Err(error), "after {taken} steps, at {before:?}");
            return (taken, error);
        }
    }
    panic!("no error in {most} steps");
}

/// `Δ = h p − ½h²k (q + ½Δ)²` has no real solution where `1 + h²k q + ½h³k p < 0`.
#[test]
fn an_equation_without_a_solution() {
    let system = Falling { mass: 1.0, strength: 1.0 };
    let found = error::<Midpoint, _>(&system, &falling(0.1, -4.5), 1.0);
    let StepError::NoSolution { residual } = found else { panic!("{found:?}") };
    assert!(residual > 1e-3 && residual < 1.0, "{residual}");
    // what falls gets there by itself
    let (taken, found) = ends_alike::<Midpoint, _>(&system, &falling(0.0, -1.0), 0.1, 100);
    assert!(taken > 10 && matches!(found, StepError::NoSolution { .. }), "{taken}: {found:?}");
}

/// Its correction overshoots to and fro for as long as there may be corrections.
#[test]
fn corrections_that_do_not_end() {
    let system = Falling { mass: 1.0, strength: 0.23485983101912006 };
    let found =
        error::<Midpoint, _>(&system, &falling(-1.1240817721159173, -0.14568360691685314), 7.495662694865789);
    let StepError::NoConvergence { iterations: 40, residual } = found else { panic!("{found:?}") };
    // next to the right side, which is smaller than the terms it is made of
    assert!(residual > 2.5 && residual < 2.7, "{residual}");
}

/// A step across several hills: corrections lead to another solution than the way from the first approximation does.
#[test]
fn an_equation_with_several_solutions() {
    let system = Corrugated { mass: 1.0, strength: 3.7087572982866632 };
    let start = corrugated(1.2286027709088607, 0.5848260803007996);
    assert_eq!(error::<Midpoint, _>(&system, &start, 1.920976180090911), StepError::SeveralSolutions);
    // a smaller step has one
    let mut state = start;
    system.stepper::<Midpoint>(0.1).unwrap().step(&mut state).unwrap();
}

/// Where `q + ½Δ = −1` the derivative `1 + ½h²k (q + ½Δ)` vanishes: at the first approximation.
#[test]
fn a_singular_jacobian() {
    let system = Falling { mass: 1.0, strength: 2.0 };
    assert_eq!(error::<Midpoint, _>(&system, &falling(-1.0, 0.0), 1.0), StepError::SingularJacobian);
}

#[test]
fn a_turn_that_is_too_long() {
    let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    let start = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.0, 0.0, 25.0] };
    assert_eq!(error::<Exponential, _>(&body, &start, 0.7), StepError::OutsideDomain);
}

#[test]
fn numbers_that_are_none() {
    let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    for bad in [f64::NAN, f64::INFINITY] {
        let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.0, bad, 1.0] };
        let before = state.momentum.map(f64::to_bits);
        let error = body.stepper::<Midpoint>(0.1).unwrap().step(&mut state).unwrap_err();
        assert_eq!((error, state.momentum.map(f64::to_bits)), (StepError::NotFinite, before));
    }
    // where the sun is there is no force
    let sun = PlanetState { position: vector![0.0, 0.0], position_momentum: vector![0.0, 0.0] };
    let planet = Planet { mass: 1.0, strength: 1.0 };
    assert_eq!(error::<StormerVerlet, _>(&planet, &sun, 0.1), StepError::NotFinite);
}

/// A matrix of which a step reads some entries alone.
#[lie_poisson_system(group = SU(3))]
struct Levels {
    #[inertia]
    inertia: SVector<f64, 8>,
}

#[test]
fn a_matrix_that_is_not_finite_is_refused_wherever_it_is_not() {
    let system = Levels { inertia: SVector::from_fn(|k, _| 1.0 + 0.3 * k as f64) };
    let start =
        LevelsState { element: SMatrix::identity(), momentum: SVector::from_fn(|k, _| 0.2 - 0.1 * k as f64) };
    for place in 0..36 {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            let mut state = start;
            state.element[place] = bad;
            let before = state.to_components();
            let mut stepper = system.stepper::<Exponential>(0.1).unwrap();
            let error = stepper.step(&mut state).unwrap_err();
            let is_named = matches!(error, StepError::NotFinite | StepError::NotOnGroup { .. });
            assert!(is_named, "entry {place}, {bad}: {error:?}");
            let after = state.to_components();
            assert!(before.iter().zip(after).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }
    assert!(system.stepper::<Exponential>(0.1).unwrap().step(&mut start.clone()).is_ok());
}

#[test]
fn a_state_that_a_snapshot_makes_up_is_refused() {
    let system = Levels { inertia: SVector::from_fn(|k, _| 1.0 + 0.3 * k as f64) };
    let mut state =
        LevelsState { element: SMatrix::identity(), momentum: SVector::from_fn(|k, _| 0.2 - 0.1 * k as f64) };
    let mut stepper = system.stepper::<Exponential>(0.1).unwrap();
    stepper.step(&mut state).unwrap();
    let mut memory = stepper.snapshot();
    // after start, counts and whether there is one: the first number of the state
    let first = 4;
    assert_eq!(memory[first], state.to_components()[0]);
    memory[first] = 3.0;
    stepper.restore(&memory).unwrap();
    let mut components = state.to_components();
    components[0] = 3.0;
    let mut forged = LevelsState::from_components(&components);
    assert!(matches!(stepper.step(&mut forged), Err(StepError::NotOnGroup { .. })));
    let system: Arc<dyn erased::System> = Arc::new(system);
    let mut stepper = erased::Stepper::new(system, &"Exponential".parse().unwrap(), 0.1).unwrap();
    stepper.restore(&memory).unwrap();
    let mut forged = components.to_vec();
    assert!(matches!(stepper.step(&mut forged, &[]), Err(StepError::NotOnGroup { .. })));
}
