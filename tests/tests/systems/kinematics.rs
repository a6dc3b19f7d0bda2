//! Systems without parameters: how an attitude follows an angular velocity.

use coadjoint::Run;
use coadjoint::prelude::*;

/// Angular frequency of the cone and its opening, rad/s and rad.
const RATE: f32 = 10.0;
const ANGLE: f32 = 0.2;

/// A body that cones, `R' = R ω̂` with a given `ω`.
#[lie_poisson_system(
    group = SO3,
    scalar = f32,
    hamiltonian = {
        let (sine, cosine) = (RATE * t).sin_cos();
        let rate = RATE * vector![-sine * ANGLE.sin(), cosine * ANGLE.sin(), ANGLE.cos() - 1.0];
        momentum.dot(&rate)
    },
)]
struct Coning;

/// An attitude that integrates a gyroscope.
#[lie_poisson_system(group = SO3, control(gyroscope: R3), hamiltonian = momentum.dot(&gyroscope))]
struct Strapdown {}

#[test]
fn a_body_that_cones_is_where_it_should_be() {
    let exact = |time: f32| {
        let (half, turn) = (ANGLE / 2.0, RATE * time);
        let (x, y) = (half.sin() * turn.cos(), half.sin() * turn.sin());
        UnitQuaternion::new_normalize(Quaternion::new(half.cos(), x, y, 0.0))
    };
    let mut state = ConingState { attitude: exact(0.0), momentum: Vector3::zeros() };
    let mut stepper = Coning.stepper::<Order4<Exponential>>(0.01).expect("a stepper");
    Run::new(&mut stepper, &mut state).to(2.0).expect("steps");
    let error = state.attitude.angle_to(&exact(2.0));
    assert!(error < 1e-4, "{error}");
    assert_eq!(std::mem::size_of::<Coning>(), 0);
}

#[test]
fn an_attitude_follows_a_gyroscope() {
    let gyroscope = vector![0.3, -0.2, 0.5];
    let mut state = StrapdownState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros() };
    let mut stepper = Strapdown {}.stepper::<Exponential>(0.1).expect("a stepper");
    let run = Run::new(&mut stepper, &mut state).with_control(StrapdownControl { gyroscope });
    run.to(3.0).expect("steps");
    assert!(state.attitude.angle_to(&UnitQuaternion::new(3.0 * gyroscope)) < 1e-14);
}
