//! Steps that cannot be taken say why, leave the state as it was, and say the same whatever the stepper remembers.

// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use coadjoint::Discretized;
use coadjoint::prelude::*;

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
fn ends_alike<M, S: Discretized<M>>(system: &S, start: &S::State, step: S::Scalar, most: usize) -> (usize, StepError) {
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
    let found = error::<Midpoint, _>(&system, &falling(0.0, -4.0), 1.0);
    let StepError::NoSolution { residual } = found else { panic!("{found:?}") };
    assert!(residual > 1e-3 && residual < 1.0, "{residual}");
    // what falls gets there by itself
    let (taken, found) = ends_alike::<Midpoint, _>(&system, &falling(0.0, -1.0), 0.1, 100);
    assert!(taken > 10 && matches!(found, StepError::NoSolution { .. }), "{taken}: {found:?}");
}

#[test]
fn scan() {
    let mut random = coadjoint_support::random::Random::new(3);
    let mut seen: Vec<String> = Vec::new();
    for k in 0..200_000 {
        let (q, p, h, s) = (
            random.between(-3.0, 3.0),
            random.between(-3.0, 3.0) * 10_f64.powf(random.between(-2.0, 1.0)),
            10_f64.powf(random.between(-2.0, 1.0)),
            10_f64.powf(random.between(-2.0, 2.0)),
        );
        let mut note = |what: &str, error: StepError| {
            let name = format!("{what} {}", format!("{error:?}").split([' ', '{']).next().unwrap());
            if seen.iter().filter(|other| **other == name).count() < 3 {
                println!("{k}: {name} at q {q:?} p {p:?} h {h:?} s {s:?}: {error:?}");
                seen.push(name);
            }
        };
        let mut state = falling(q, p);
        let mut stepper = Falling { mass: 1.0, strength: s }.stepper::<Midpoint>(h).unwrap();
        if let Err(error) = stepper.step(&mut state) {
            note("falling", error);
        }
        let mut state = corrugated(q, p);
        let mut stepper = Corrugated { mass: 1.0, strength: s }.stepper::<Midpoint>(h).unwrap();
        if let Err(error) = stepper.step(&mut state) {
            note("corrugated", error);
        }
        let mut state = PlanetState { position: vector![q, s], position_momentum: vector![p, 0.0] };
        let mut stepper = Planet { mass: 1.0, strength: 1.0 }.stepper::<Midpoint>(h).unwrap();
        if let Err(error) = stepper.step(&mut state) {
            note("planet", error);
        }
        let body = Body { inertia: vector![1.0, 1.0 + 1e-3 * s, 1.0 + 1e-2 * s] };
        let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![p, q, h] };
        if let Err(error) = body.stepper::<Midpoint>(h).unwrap().step(&mut state) {
            note("body exp", error);
        }
        let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![p, q, h] };
        if let Err(error) = body.stepper::<Exponential>(h).unwrap().step(&mut state) {
            note("body standard exp", error);
        }
    }
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
    println!("{:?} {:?}", error::<Midpoint, _>(&planet, &sun, 0.1), error::<StormerVerlet, _>(&planet, &sun, 0.1));
}
