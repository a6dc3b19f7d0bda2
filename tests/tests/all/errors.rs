//! Everything that can go wrong goes wrong as a typed error, and leaves the state as it was.

use std::f64::consts::TAU;

use coadjoint::Discretized;
use coadjoint::prelude::*;
use coadjoint_support::for_each_system_and_retraction;
use coadjoint_support::measure::order;
use coadjoint_support::random::Random;
use coadjoint_support::systems::{
    FreeRigidBody, FreeRigidBodyState, HeavyTop, HeavyTopState, Sample, TiltedBody, TiltedBodyState,
};

fn top() -> HeavyTop {
    HeavyTop { inertia: vector![1.0, 2.0, 3.0], weight: 1.0, chi: vector![0.3, 0.2, 1.0] }
}

fn start() -> HeavyTopState {
    HeavyTopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![0.9, -0.4, 1.2],
        gamma: vector![0.36, 0.48, 0.8],
    }
}

/// The error of building a stepper, the same with both retractions and from `validate`.
fn invalid<S: Sample>(system: &S) -> ParameterError {
    let error = system.validate().expect_err("the parameters are not valid");
    // as text, because not-a-number is not itself
    let same = |other: ParameterError| assert_eq!(format!("{error:?}"), format!("{other:?}"));
    same(system.stepper::<Exponential>(0.01).expect_err("no stepper"));
    same(system.stepper::<Cayley>(0.01).expect_err("no stepper"));
    error
}

#[test]
fn moments_of_inertia_must_be_positive() {
    for (bad, at) in [(0.0, 0), (-0.0, 1), (-1.0, 2), (-f64::MIN_POSITIVE, 1)] {
        let mut body = FreeRigidBody { inertia: vector![1.0, 2.0, 3.0] };
        body.inertia[at] = bad;
        let expected = ParameterError::NotPositiveDefinite { name: "inertia", index: at, pivot: bad };
        assert_eq!(invalid(&body), expected);
    }
}

#[test]
fn inertia_matrices_must_be_positive_definite() {
    // positive entries, but less than nothing about the axis (1, −1, 0)
    let body = TiltedBody { inertia: matrix![1.0, 2.0, 0.0; 2.0, 1.0, 0.0; 0.0, 0.0, 1.0] };
    let expected = ParameterError::NotPositiveDefinite { name: "inertia", index: 1, pivot: -3.0 };
    assert_eq!(invalid(&body), expected);

    // a rod has no inertia about itself
    let rod = TiltedBody { inertia: matrix![1.0, 0.0, 0.0; 0.0, 1.0, 0.0; 0.0, 0.0, 0.0] };
    let expected = ParameterError::NotPositiveDefinite { name: "inertia", index: 2, pivot: 0.0 };
    assert_eq!(invalid(&rod), expected);

    let nothing = TiltedBody { inertia: Matrix3::zeros() };
    let error = invalid(&nothing);
    assert!(
        matches!(error, ParameterError::NotPositiveDefinite { name: "inertia", index: 0, .. }),
        "{error}"
    );
}

#[test]
fn inertia_matrices_must_be_symmetric() {
    let body = TiltedBody { inertia: matrix![2.0, 0.5, 0.0; 0.25, 2.0, 0.0; 0.0, 0.0, 2.0] };
    assert_eq!(invalid(&body), ParameterError::NotSymmetric { name: "inertia", difference: 0.25 });

    // what rotating a diagonal matrix leaves is roundoff, and taken
    let mut random = Random::new(1);
    for _ in 0..200 {
        let axes = random.rotation().to_rotation_matrix().into_inner();
        let inertia = axes * Matrix3::from_diagonal(&random.moments()) * axes.transpose();
        assert_eq!(TiltedBody { inertia }.validate(), Ok(()), "{inertia}");
    }
}

/// Data of a tool that computes in single precision: what the tool meant is the symmetric part.
#[test]
fn inertias_of_single_precision_are_made_symmetric() {
    let mut random = Random::new(2);
    let mut crooked = 0;
    for _ in 0..200 {
        let axes = random.rotation().to_rotation_matrix().into_inner().map(|x| x as f32);
        let moments = Matrix3::from_diagonal(&random.moments()).map(|x| x as f32);
        let given = (axes * moments * axes.transpose()).map(f64::from);
        let symmetric = (given + given.transpose()) / 2.0;
        crooked += usize::from(given != symmetric);
        let start = TiltedBodyState { attitude: random.rotation(), momentum: random.vector() };
        let [of_given, of_symmetric] = [given, symmetric].map(|inertia| {
            let (body, mut state) = (TiltedBody { inertia }, start);
            let mut stepper = body.stepper::<Cayley>(0.1).expect("nearly symmetric");
            stepper.step(&mut state).expect("a step");
            (state, body.energy(&state), body.velocity(&state))
        });
        assert_eq!(of_given, of_symmetric);
    }
    assert!(crooked > 100, "{crooked}");
    let inertia = matrix![2.0, 0.5, 0.0; 0.500_003, 2.0, 0.0; 0.0, 0.0, 2.0];
    let message = invalid(&TiltedBody { inertia }).to_string();
    assert!(message.contains("more than 1e-6 of the largest"), "{message}");
    assert!(message.contains("`(inertia + inertia.transpose()) / 2.0`"), "{message}");
}

#[test]
fn parameters_must_be_finite() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let cases = [
            (HeavyTop { inertia: vector![1.0, bad, 3.0], ..top() }, "inertia"),
            (HeavyTop { weight: bad, ..top() }, "weight"),
            (HeavyTop { chi: vector![0.0, 0.0, bad], ..top() }, "chi"),
        ];
        for (system, name) in cases {
            assert_eq!(invalid(&system), ParameterError::NotFinite { name });
        }
        let body = TiltedBody { inertia: Matrix3::from_diagonal_element(bad) };
        assert_eq!(invalid(&body), ParameterError::NotFinite { name: "inertia" });
    }
}

#[test]
fn the_step_must_be_finite_and_not_zero() {
    for step in [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY] {
        let error = top().stepper::<Cayley>(step).expect_err("no stepper");
        assert_eq!(error, ParameterError::Step { step });
    }
    let error = top().stepper::<Exponential>(f64::NAN).expect_err("no stepper");
    assert!(matches!(error, ParameterError::Step { step } if step.is_nan()));
}

/// The bits of a state: what "unchanged" means.
fn bits<S: Sample>(state: &S::State) -> Vec<u64> {
    state.to_components().as_ref().iter().map(|x| x.to_bits()).collect()
}

#[test]
fn a_state_that_is_not_finite_is_refused() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(2);
        let (system, good) = S::sample(&mut random);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for k in 0..good.to_components().as_ref().len() {
                let mut components = good.to_components();
                components.as_mut()[k] = bad;
                let mut state = S::State::from_components(&components);
                let before = bits::<S>(&state);

                let mut stepper = system.stepper::<M>(0.01).expect("a stepper");
                let error = stepper.step(&mut state).expect_err("no step");
                assert_eq!(error, StepError::NotFinite, "{what}, component {k}");
                assert_eq!(bits::<S>(&state), before, "{what}, component {k}");
                works::<S, M>(&system, &mut stepper, &good, what);
            }
        }
    }
    for_each_system_and_retraction!(check);
}

/// nalgebra's `new_unchecked` and its deserializer take any four numbers for a unit quaternion.
#[test]
fn an_attitude_off_the_group_is_refused() {
    fn check<M>()
    where
        HeavyTop: Discretized<M>,
    {
        for length in [0.0, 0.9, 1.1, 3.0] {
            let mut stepper = top().stepper::<M>(0.01).expect("valid parameters");
            let mut state = start();
            stepper.step(&mut state).expect("a good state");
            state.attitude = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.0, length, 0.0));
            let before = state;
            match stepper.step(&mut state) {
                Err(StepError::NotOnGroup { deviation }) => {
                    assert!((deviation - (length - 1.0f64).abs()).abs() < 1e-15, "{deviation}");
                }
                other => panic!("length {length}: {other:?}"),
            }
            assert_eq!(state, before);
            stepper.step(&mut start()).expect("a good state again");
        }
        // what a file of six digits leaves is put right by the first steps
        let mut state = start();
        state.attitude = UnitQuaternion::new_unchecked(Quaternion::new(1.000_001, 0.0, 0.0, 0.0));
        let mut stepper = top().stepper::<M>(0.01).expect("valid parameters");
        for _ in 0..2 {
            stepper.step(&mut state).expect("close enough");
        }
        assert!(state.deviation() < 1e-15);
    }
    check::<Exponential>();
    check::<Cayley>();
}

/// The stepper takes the same step as a new one.
fn works<S: Sample + Discretized<M>, M>(
    system: &S,
    stepper: &mut Stepper<S, M>,
    good: &S::State,
    what: &str,
) {
    let (mut state, mut expected) = (good.clone(), good.clone());
    stepper.step(&mut state).unwrap_or_else(|error| panic!("{what}: afterwards, {error}"));
    let mut fresh = system.stepper::<M>(stepper.step_size()).expect("a stepper");
    fresh.step(&mut expected).expect("a step");
    assert_eq!(bits::<S>(&state), bits::<S>(&expected), "{what}: an error has left traces");
}

#[test]
fn a_step_that_is_far_too_large_is_refused() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(3);
        let mut refused = 0;
        for _ in 0..50 {
            let (system, good) = S::sample(&mut random);
            for step in [1e3, -1e3, 1e6, 1e100, 1e300, f64::MAX] {
                let mut state = good.clone();
                let before = bits::<S>(&state);
                match system.stepper::<M>(step).expect("a stepper").step(&mut state) {
                    Err(StepError::NoConvergence { iterations, residual }) => {
                        let begun = iterations >= 1 || !residual.is_finite();
                        assert!(begun && !(residual < 5e-14), "{what}: {iterations}, {residual:e}");
                    }
                    Err(StepError::NoSolution { residual }) => {
                        assert!(!(residual < 5e-14), "{what}: {residual:e}");
                    }
                    Err(
                        StepError::OutsideDomain | StepError::SeveralSolutions | StepError::SingularJacobian,
                    ) => {}
                    Err(error) => assert!(step.abs() > 1e99, "{what}, step {step:e}: {error}"),
                    // a solution far away is a solution, too
                    Ok(_) => continue,
                }
                refused += 1;
                assert_eq!(bits::<S>(&state), before, "{what}, step {step:e}");
            }
        }
        println!("{what}: {refused} of 300 refused");
        assert!(refused > 100, "{what}: only {refused} of 300 steps were refused");
    }
    for_each_system_and_retraction!(check);
}

/// More than a full turn in one step is outside of the exponential's domain, but not of the Cayley map's.
#[test]
fn a_full_turn_in_one_step_leaves_the_domain_of_the_exponential() {
    // about a principal axis the velocity is constant, here 1: the step is the angle
    let body = FreeRigidBody { inertia: vector![1.0, 2.0, 3.0] };
    let good = FreeRigidBodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.0, 0.0, 3.0] };
    let mut state = good;
    let mut stepper = body.stepper::<Exponential>(1.001 * TAU).expect("a stepper");
    assert_eq!(stepper.step(&mut state), Err(StepError::OutsideDomain));
    assert_eq!(state, good);

    // the same stepper with a slower state
    let mut slower = FreeRigidBodyState { momentum: vector![0.0, 0.0, 1.0], ..good };
    stepper.step(&mut slower).expect("a third of a turn is inside");

    let mut stepper = body.stepper::<Exponential>(0.999 * TAU).expect("a stepper");
    stepper.step(&mut state).expect("a little less than a turn is inside");
    let mut state = good;
    body.stepper::<Cayley>(1.001 * TAU).expect("a stepper").step(&mut state).expect("Cayley has no edge");
}

#[test]
fn a_step_in_the_middle_of_a_run_may_fail() {
    fn check<M>(what: &str)
    where
        HeavyTop: Discretized<M>,
    {
        let mut stepper = top().stepper::<M>(0.01).expect("a stepper");
        let mut state = start();
        for _ in 0..10 {
            stepper.step(&mut state).expect("a step");
        }
        let (kept, mut other) = (state, stepper.clone());

        // too fast for this step
        let mut fast = HeavyTopState { momentum: vector![1e200, 2e200, -1e200], ..state };
        let before = fast;
        stepper.step(&mut fast).expect_err("no step");
        assert_eq!(fast, before, "{what}");

        // the run goes on as if nothing had happened
        stepper.step(&mut state).expect("a step");
        let mut expected = kept;
        other.step(&mut expected).expect("a step");
        assert_eq!(state, expected, "{what}");
    }
    check::<Exponential>("exponential");
    check::<Cayley>("Cayley");
}

/// Numbers that break careless code.
const NASTY: [f64; 20] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    5e-324,
    -1e-310,
    f64::MIN_POSITIVE,
    1e-300,
    1e-160,
    -1e-160,
    1e-16,
    1e16,
    1e150,
    -1e160,
    1e300,
    f64::MAX,
    f64::MIN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// Whatever comes in: no panic, no state that is half changed or not finite, no success without a solution.
#[test]
fn nasty_numbers_do_no_harm() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(4);
        let [mut invalid, mut refused, mut taken] = [0; 3];
        for round in 0..3_000 {
            let (system, state) = S::sample(&mut random);
            let (mut parameters, mut components) = (system.to_parameters(), state.to_components());
            let mut step = random.between(-0.5, 0.5);
            // from one bad number to nothing but bad numbers, and to parameters only every other time
            let share = random.one_of(&[0.03, 0.1, 0.3, 1.0]);
            let spoil = |x: &mut f64, random: &mut Random| {
                if random.between(0.0, 1.0) < share {
                    *x = random.one_of(&NASTY);
                }
            };
            if round % 2 == 0 {
                parameters.as_mut().iter_mut().for_each(|x| spoil(x, &mut random));
            }
            components.as_mut().iter_mut().for_each(|x| spoil(x, &mut random));
            spoil(&mut step, &mut random);

            let system = S::from_parameters(&parameters);
            let Ok(mut stepper) = system.stepper::<M>(step) else {
                invalid += 1;
                continue;
            };
            let mut state = S::State::from_components(&components);
            for _ in 0..3 {
                let before = bits::<S>(&state);
                match stepper.step(&mut state) {
                    Ok(report) => {
                        taken += 1;
                        let finite = state.to_components().as_ref().iter().all(|x| x.is_finite());
                        assert!(finite, "{what}: {system:?}, {components:?}, {step:e} led to {state:?}");
                        assert!(report.residual < 1e-12, "{what}: not a solution: {report:?}");
                    }
                    Err(_) => {
                        refused += 1;
                        assert_eq!(bits::<S>(&state), before, "{what}: {system:?}, {components:?}, {step:e}");
                    }
                }
            }
        }
        println!("{what}: {invalid} invalid, {refused} refused, {taken} taken");
        assert!(invalid > 300 && refused > 300 && taken > 300, "{what}: {invalid}, {refused}, {taken}");
    }
    for_each_system_and_retraction!(check);
}

/// Errors say what to do, in one line.
#[test]
fn errors_read_well() {
    let text = |error: &dyn std::error::Error| error.to_string();
    let error = HeavyTop { weight: f64::NAN, ..top() }.validate().expect_err("not finite");
    assert_eq!(text(&error), "parameter `weight` is not finite");
    let error = HeavyTop { inertia: vector![1.0, -2.0, 3.0], ..top() }.validate().expect_err("negative");
    assert_eq!(
        text(&error),
        "inertia `inertia` is not positive definite: its moment 1, or of a matrix pivot 1 of its LDLᵀ factorization, counted from 0, is -2"
    );
    let error = top().stepper::<Cayley>(0.0).expect_err("no step");
    assert_eq!(text(&error), "the step must be finite and not zero, got 0");
    assert_eq!(
        text(&StepError::OutsideDomain),
        "the step leaves the retraction's domain; try a smaller step or the Cayley map"
    );
}

/// A top in single precision.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi) + 0.25 * gamma.x.powi(2) + (gamma.y * std::f32::consts::PI).cos(),
)]
#[derive(Clone, Debug, PartialEq)]
struct SmallTop {
    /// Principal moments of inertia.
    #[inertia]
    inertia: Vector3<f32>,
    /// Mass times gravity.
    weight: f32,
    /// To the centre of mass.
    chi: Vector3<f32>,
}

/// The same in double precision.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi) + 0.25 * gamma.x.powi(2) + (gamma.y * std::f64::consts::PI).cos(),
)]
#[derive(Clone, Debug, PartialEq)]
struct LargeTop {
    /// Principal moments of inertia.
    #[inertia]
    inertia: Vector3<f64>,
    /// Mass times gravity.
    weight: f64,
    /// To the centre of mass.
    chi: Vector3<f64>,
}

fn small_and_large() -> ((SmallTop, SmallTopState), (LargeTop, LargeTopState)) {
    let large = LargeTop { inertia: vector![1.0, 2.0, 3.0], weight: 0.75, chi: vector![0.25, 0.5, 1.0] };
    let large_state = LargeTopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![0.5, -0.25, 1.0],
        gamma: vector![0.0, 0.6, 0.8],
    };
    let small =
        SmallTop { inertia: large.inertia.cast(), weight: large.weight as f32, chi: large.chi.cast() };
    let small_state = SmallTopState {
        attitude: large_state.attitude.cast(),
        momentum: large_state.momentum.cast(),
        gamma: large_state.gamma.cast(),
    };
    ((small, small_state), (large, large_state))
}

/// Single precision follows double precision as far as it can.
#[test]
fn single_precision_works() {
    fn check<M>(what: &str)
    where
        SmallTop: Discretized<M>,
        LargeTop: Discretized<M>,
    {
        let ((small, mut small_state), (large, mut large_state)) = small_and_large();
        let mut single = small.stepper::<M>(0.0625).expect("a stepper");
        let mut double = large.stepper::<M>(0.0625).expect("a stepper");
        let casimirs = small.casimirs(&small_state);
        for n in 0..64 {
            let report = single.step(&mut small_state).expect("a step");
            assert!(report.residual < 1e-5, "{what}, step {n}: {report:?}");
            double.step(&mut large_state).expect("a step");
        }
        let momentum = (small_state.momentum.cast::<f64>() - large_state.momentum).amax();
        let gamma = (small_state.gamma.cast::<f64>() - large_state.gamma).amax();
        let attitude = small_state.attitude.cast::<f64>().angle_to(&large_state.attitude);
        println!(
            "{what}: after 64 steps momentum {momentum:.1e}, vertical {gamma:.1e}, attitude {attitude:.1e}"
        );
        assert!(momentum < 2e-5 && gamma < 2e-5 && attitude < 2e-5, "{what}");
        for (now, start) in small.casimirs(&small_state).iter().zip(casimirs) {
            assert!((now - start).abs() < 1e-5, "{what}: {now} was {start}");
        }
    }
    check::<Exponential>("exponential");
    check::<Cayley>("Cayley");
}

#[test]
fn single_precision_fails_as_double_does() {
    let ((small, good), _) = small_and_large();
    let error = SmallTop { weight: f32::NAN, ..small.clone() }.validate().expect_err("not finite");
    assert_eq!(error, ParameterError::NotFinite { name: "weight" });
    let error = small.stepper::<Cayley>(0.0).expect_err("no step");
    assert_eq!(error, ParameterError::Step { step: 0.0 });
    let mut bad = SmallTopState { momentum: vector![0.0, f32::INFINITY, 0.0], ..good };
    let mut stepper = small.stepper::<Exponential>(0.01).expect("a stepper");
    assert_eq!(stepper.step(&mut bad), Err(StepError::NotFinite));
    let mut fast = SmallTopState { momentum: vector![1e7, 2e7, -1e7], ..good };
    let before = fast;
    stepper.step(&mut fast).expect_err("too fast");
    assert_eq!(fast, before);
}

/// The order shows in single precision too, before roundoff sets in.
#[test]
fn single_precision_has_the_order() {
    fn check<M>(what: &str)
    where
        SmallTop: Discretized<M>,
        LargeTop: Discretized<M>,
    {
        let ((small, start), (large, exact)) = small_and_large();
        let mut exact = exact;
        let mut stepper = large.stepper::<M>(1.0 / 4096.0).expect("a stepper");
        for _ in 0..4096 {
            stepper.step(&mut exact).expect("a step");
        }
        let errors: Vec<_> = [8_u16, 16, 32]
            .map(|n| {
                let (mut state, h) = (start, 1.0 / f32::from(n));
                let mut stepper = small.stepper::<M>(h).expect("a stepper");
                for _ in 0..n {
                    stepper.step(&mut state).expect("a step");
                }
                (f64::from(h), (state.momentum.cast::<f64>() - exact.momentum).amax())
            })
            .to_vec();
        let order = order(&errors);
        println!("{what}: order {order:.3}, {errors:?}");
        assert!((order - 2.0).abs() < 0.1, "{what}: order {order}, {errors:?}");
    }
    check::<Exponential>("exponential");
    check::<Cayley>("Cayley");
}
