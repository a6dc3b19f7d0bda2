//! Hamilton–Jacobi steps as users take them.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use coadjoint::certify::{Certification, Claimed, Verdict, certify, certify_erased};
use coadjoint::composition::{Coefficients, KahanLi8};
use coadjoint::derivative::WrtState;
use coadjoint::prelude::*;
use coadjoint::{Discretized, Ensemble, Scheme, SchemeType, StepError, System, erased};

/// A free rigid body.
#[lie_poisson_system(
    group = SO3,
    methods(HamiltonJacobi(4), HamiltonJacobi(6), HamiltonJacobi(8), HamiltonJacobi(10)),
    retractions(Exponential)
)]
#[derive(Clone)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

/// A heavy top.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
    methods(HamiltonJacobi(6)),
    derivatives(state)
)]
#[derive(Clone)]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

/// A damped pendulum whose pivot shakes, with a torque that is held.
#[lie_poisson_system(
    group = SO2,
    control(torque: f64),
    potential = -weight * (1.0 + (3.0 * t).sin() / 4.0) * angle.cos_angle(),
    force = vector![torque - damping * velocity.x],
    methods(HamiltonJacobi(6)),
    retractions(Exponential)
)]
#[derive(Clone)]
struct Pendulum {
    #[inertia]
    inertia: f64,
    weight: f64,
    damping: f64,
}

fn body() -> (Body, BodyState) {
    let state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0] };
    (Body { inertia: vector![1.0, 10.0, 100.0] }, state)
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
    let state = PendulumState { angle: UnitComplex::new(0.8), momentum: vector![0.5] };
    (Pendulum { inertia: 1.2, weight: 2.0, damping: 0.3 }, state)
}

/// The state after a time.
fn after<S, M>(system: &S, start: &S::State, control: &S::Control, time: f64, steps: u32) -> Vec<f64>
where
    S: Discretized<M> + System<Scalar = f64>,
{
    let mut stepper = system.stepper::<M>(time / f64::from(steps)).unwrap();
    let mut state = start.clone();
    for _ in 0..steps {
        stepper.step_with(&mut state, control).unwrap();
    }
    state.to_components().as_ref().to_vec()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest, (a, b)| (a - b).abs().max(largest))
}

/// The slopes of the error as the step is halved, from so many steps on.
fn has_order<S, M>(system: &S, start: &S::State, control: &S::Control, exact: &[f64], order: f64, first: u32)
where
    S: Discretized<M> + System<Scalar = f64>,
{
    let error = |steps| distance(&after::<S, M>(system, start, control, 4.0, steps), exact);
    let slope = (error(first) / error(2 * first)).log2();
    println!("order {order}: {slope:.2}, errors {:.1e} {:.1e}", error(first), error(2 * first));
    assert!((slope - order).abs() < 0.1, "order {order}: {slope}");
}

#[test]
fn orders_are_as_named() {
    let (system, start) = body();
    let exact = after::<_, Order10<Exponential>>(&system, &start, &NoControl::default(), 4.0, 400);
    let none = NoControl::default();
    has_order::<_, HamiltonJacobi<Exponential, 4>>(&system, &start, &none, &exact, 4.0, 40);
    has_order::<_, HamiltonJacobi<Exponential, 6>>(&system, &start, &none, &exact, 6.0, 12);
    has_order::<_, HamiltonJacobi<Exponential, 8>>(&system, &start, &none, &exact, 8.0, 8);
    has_order::<_, HamiltonJacobi<Exponential, 10>>(&system, &start, &none, &exact, 10.0, 7);

    let (system, start) = top();
    let exact = after::<_, Order10<Exponential>>(&system, &start, &none, 4.0, 400);
    has_order::<_, HamiltonJacobi>(&system, &start, &none, &exact, 6.0, 30);
    has_order::<_, HamiltonJacobi<Cayley>>(&system, &start, &none, &exact, 6.0, 60);

    let (system, start) = pendulum();
    let control = PendulumControl { torque: 0.4 };
    let exact = after::<_, Order10<Exponential>>(&system, &start, &control, 4.0, 400);
    has_order::<_, HamiltonJacobi>(&system, &start, &control, &exact, 6.0, 32);
}

/// Casimirs to rounding, and an energy that does not drift.
#[test]
fn long_runs_keep_what_is_to_be_kept() {
    let (system, start) = body();
    let mut stepper = system.stepper::<HamiltonJacobi>(0.1).unwrap();
    let (casimir, energy) = (start.momentum.norm_squared(), system.energy(&start));
    let space = system.spatial_momentum(&start);
    let (mut state, mut off): (_, [f64; 2]) = (start, [0.0; 2]);
    let mut energies = [0.0_f64; 10];
    for tenth in &mut energies {
        for _ in 0..18_000 {
            stepper.step(&mut state).unwrap();
            off[0] = off[0].max((state.momentum.norm_squared() / casimir - 1.0).abs());
            off[1] = off[1].max((system.spatial_momentum(&state) - space).norm());
            *tenth = tenth.max((system.energy(&state) / energy - 1.0).abs());
        }
    }
    println!("Casimir {:.1e}, momentum {:.1e}, energy {energies:?}", off[0], off[1]);
    assert!(off[0] < 1e-13 * 3.0 && off[1] < 1e-12, "{off:?}");
    assert!(energies[9] < 1.1 * energies[0] && energies[0] < 1e-8, "{energies:?}");
}

/// The step is a map: what a stepper has seen before makes no difference, up to rounding.
#[test]
fn warm_and_cold_steps_are_the_same() {
    fn check<S: Discretized<M> + System<Scalar = f64>, M>(
        system: &S,
        start: &S::State,
        control: &S::Control,
        step: f64,
    ) {
        let mut stepper = system.stepper::<M>(step).unwrap();
        let (mut state, mut worst) = (start.clone(), 0.0_f64);
        for _ in 0..300 {
            let mut fresh = system.stepper::<M>(step).unwrap();
            fresh.set_time(stepper.time());
            let mut cold = state.clone();
            fresh.step_with(&mut cold, control).unwrap();
            stepper.step_with(&mut state, control).unwrap();
            worst = worst.max(distance(state.to_components().as_ref(), cold.to_components().as_ref()));
        }
        println!("step {step}: {worst:.1e}");
        assert!(worst < 4e-15, "step {step}: {worst:e}");
    }
    let none = NoControl::default();
    let (system, start) = body();
    for step in [0.01, 0.1, 0.5, 1.2] {
        check::<_, HamiltonJacobi<Exponential, 8>>(&system, &start, &none, step);
    }
    let (system, start) = top();
    for step in [0.01, 0.1, 0.4] {
        check::<_, HamiltonJacobi>(&system, &start, &none, step);
        check::<_, HamiltonJacobi<Cayley>>(&system, &start, &none, step);
    }
    let (system, start) = pendulum();
    check::<_, HamiltonJacobi>(&system, &start, &PendulumControl { torque: 0.4 }, 0.1);
}

/// What schemes have, this one has: products rounded once, compensated sums, ensembles, types that are erased.
#[test]
fn it_is_a_scheme_like_others() {
    type Scheme = HamiltonJacobi<Exponential, 6>;
    let (system, start) = top();
    let none = NoControl::default();
    let plain = after::<_, Scheme>(&system, &start, &none, 10.0, 100);
    assert!(distance(&plain, &after::<_, Fused<Scheme>>(&system, &start, &none, 10.0, 100)) < 1e-13);
    assert!(distance(&plain, &after::<_, Compensated<Scheme>>(&system, &start, &none, 10.0, 100)) < 1e-13);

    let mut ensemble = Ensemble::<Top, Scheme>::new([&system; 11], [start; 11], 0.1).unwrap();
    ensemble.run(100);
    for k in 0..11 {
        let state = ensemble.state(k).unwrap().to_components();
        assert!(distance(&plain, &state) < 1e-13, "member {k}");
    }

    let shared: Arc<dyn erased::System> = Arc::new(system.clone());
    let mut stepper = erased::Stepper::new(shared, &Scheme::scheme(), 0.1).unwrap();
    let mut state = start.to_components().to_vec();
    for _ in 0..100 {
        stepper.step(&mut state, &[]).unwrap();
    }
    assert_eq!(state, plain, "to the last bit");
}

#[test]
fn its_derivative_is_that_of_the_step() {
    let (system, start) = top();
    let step = 0.2;
    let mut stepper = system.stepper::<HamiltonJacobi>(step).unwrap();
    let mut state = start;
    let (jacobian, _) = stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtState).unwrap();
    // of momentum and vertical by the momentum, whose coordinates are plain
    for column in 0..3 {
        let moved = |by: f64| {
            let mut from = start;
            from.momentum[column] += by;
            after::<_, HamiltonJacobi>(&system, &from, &NoControl::default(), step, 1)
        };
        let d = 1e-3;
        let difference = |d: f64| -> Vec<f64> {
            moved(d).iter().zip(moved(-d)).map(|(a, b)| (a - b) / (2.0 * d)).collect()
        };
        let (coarse, fine) = (difference(d), difference(d / 2.0));
        for row in 3..9 {
            let expected = (4.0 * fine[row + 1] - coarse[row + 1]) / 3.0;
            assert!((jacobian[(row, 3 + column)] - expected).abs() < 1e-10, "{row} by {column}");
        }
    }
}

#[test]
fn it_is_certified() {
    let (system, start) = top();
    let report = certify::<HamiltonJacobi, _>(&system, &[start]).unwrap();
    assert!(report.passed(), "{report}");
    let (system, start) = pendulum();
    let report = certify::<HamiltonJacobi, _>(&system, &[start]).unwrap();
    assert!(report.passed(), "{report}");
}

/// Steps of high order are measured as such, and what is of a lower one is found out.
#[test]
fn claims_of_a_higher_order_fail() {
    type Of<const P: u32> = HamiltonJacobi<Exponential, P>;
    fn failing<C: SchemeType, M: 'static>() -> Vec<String>
    where
        Body: Discretized<M>,
    {
        let (system, start) = body();
        let certification = Certification::new(&system).states(&[start]);
        let (properties, definition) =
            (C::scheme().properties(&erased::Description::of::<Body>()), Some(C::scheme()));
        let report = certification.run_as(&Claimed {
            name: "boast".into(),
            properties,
            definition,
            method: &certification.method::<M>(),
            kernels: &|_, _| None,
        });
        let report = report.unwrap();
        println!("{report}");
        report.failures().map(|certificate| certificate.name.clone()).collect()
    }
    assert!(failing::<Of<8>, Of<8>>().is_empty() && failing::<Of<10>, Of<10>>().is_empty());
    assert!(failing::<Of<8>, Of<6>>().contains(&"order".into()));
    assert!(failing::<Of<10>, Of<8>>().contains(&"order".into()));
}

/// Of the coefficients of order 8, with one off by 10⁻⁶ and another by as much the other way.
struct Off;

impl Coefficients for Off {
    type Steps<X: Clone + Send + Sync> = [X; 17];
    const ORDER: u32 = 8;
    const GAMMA: &'static [f64] = &{
        let mut gamma = [0.0; 17];
        let mut k = 0;
        while k < 17 {
            gamma[k] = KahanLi8::GAMMA[k];
            k += 1;
        }
        gamma[0] += 1e-6;
        gamma[16] += 1e-6;
        gamma[1] -= 1e-6;
        gamma[15] -= 1e-6;
        gamma
    };

    fn steps<X: Clone + Send + Sync>(make: impl FnMut(usize) -> X) -> [X; 17] {
        std::array::from_fn(make)
    }
}

#[test]
fn a_coefficient_that_is_off_by_little_is_found() {
    let (system, start) = body();
    let states = [start.to_components().to_vec()];
    let base = Exponential::scheme();
    let verdict = |scheme: &Scheme| {
        let report = certify_erased(&system, scheme, &states, &[], 0.0, None).unwrap();
        println!("{report}");
        report.certificate("order").unwrap().verdict
    };
    assert_eq!(verdict(&Scheme::composed::<KahanLi8>(base.clone())), Verdict::Passed);
    assert_eq!(verdict(&Scheme::composed::<Off>(base)), Verdict::Failed);
}

/// How much of its reach a series uses is measured, and that a step beyond it is not.
#[test]
fn a_step_beyond_its_series_is_not_certified() {
    let (system, start) = body();
    let share = |step: f64| {
        let certification = Certification::new(&system).states(&[start]).step(step);
        certification.run::<HamiltonJacobi>().unwrap().certificate("series").unwrap().clone()
    };
    let [short, twice, long] = [0.25, 0.5, 2.0].map(share);
    assert!((twice.figure / short.figure - 2.0).abs() < 0.1, "{} {}", short.figure, twice.figure);
    assert_eq!([short.verdict, long.verdict], [Verdict::Passed, Verdict::Failed], "{}", long.figure);
    assert!(certify::<Exponential, _>(&system, &[start]).unwrap().certificate("series").is_none());
}

/// Beyond where the series makes sense there may be no solution, and the state is as it was.
#[test]
fn what_has_no_solution_is_an_error() {
    let (system, start) = body();
    let mut stepper = system.stepper::<HamiltonJacobi<Exponential, 8>>(40.0).unwrap();
    let mut state = start;
    match stepper.step(&mut state) {
        Ok(_) => assert!((state.momentum.norm() / start.momentum.norm() - 1.0).abs() < 1e-12),
        Err(error) => {
            assert!(matches!(
                error,
                StepError::NoSolution { .. }
                    | StepError::NoConvergence { .. }
                    | StepError::SeveralSolutions
                    | StepError::OutsideDomain
            ));
            assert_eq!(state, start);
        }
    }
}
