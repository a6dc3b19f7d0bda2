//! What expressions mean in whole systems: rustc compiles the user's text with nalgebra's types, the generator derives from it, and both must
//! have the same value.
#![allow(clippy::unwrap_used, reason = "an inverse in an expression is taken as users take it")]

use std::f64::consts::PI;

use coadjoint::__private::Geometry;
use coadjoint::prelude::*;
use coadjoint_support::random::Random;

/// A vehicle under water: parts of the momentum, inverse matrices, points that the pose moves.
#[lie_poisson_system(
    group = SE3,
    retractions(Cayley),
    hamiltonian = {
        let turning = angular_momentum.dot(&(inertia.try_inverse().unwrap() * angular_momentum));
        let added = mass + matrix![0.5, 0.1; 0.1, 0.8].try_inverse().expect("a regular matrix").fixed_view::<1, 1>(1, 0)[0].powi(2);
        let moving = momentum.fixed_rows::<3>(3).norm_squared() / added;
        let hook = pose.transform_point(&Point3::from(arm)) - Point3::new(0.3, -0.2, 0.1);
        let seen = pose.inverse_transform_point(&Point3::origin()) + arm;
        let keel = pose.transform_vector(&arm).dot(&pose.inverse_transform_vector(&arm));
        (turning + moving) / 2.0
            + stiffness * (hook.norm_squared() + seen.coords.norm_squared() + (pose * Point3::from(arm)).z * keel)
    },
    control(moment: R3, push: R3),
    force = (
        moment - drag * angular_velocity.cross(&linear_momentum),
        pose.inverse_transform_vector(&push) - drag * linear_velocity + velocity.fixed_rows::<3>(0),
    ),
)]
struct Vehicle {
    #[inertia]
    inertia: Matrix3<f64>,
    mass: f64,
    arm: Vector3<f64>,
    stiffness: f64,
    drag: f64,
}

/// A plate on a table: an angular momentum that is a number.
#[lie_poisson_system(
    group(plate: SE2, table: SO2),
    retractions(Cayley),
    hamiltonian = plate_angular_momentum.powi(2) / (2.0 * inertia)
        + plate_linear_momentum.dot(&(masses.try_inverse().unwrap() * plate_linear_momentum)) / 2.0
        + table_momentum.x.powi(2)
        + 0.5 * stiffness * table.angle().powi(2)
        + (plate.transform_point(&Point2::new(0.1, stiffness)) - table * Point2::new(1.0, 2.0)).norm_squared()
        + plate.inverse_transform_vector(&Vector2::x()).y
        + table.inverse_transform_point(&Point2::new(stiffness, 1.0)).x,
    force(plate = (-drag * plate_angular_velocity * plate_velocity.z, -drag * plate_linear_velocity)),
)]
struct Plate {
    #[inertia(plate)]
    inertia: f64,
    #[inertia(plate)]
    masses: Matrix2<f64>,
    stiffness: f64,
    drag: f64,
}

/// Vectors and points as unit quaternions turn them, of rotations and of spins.
#[lie_poisson_system(
    group(body: SO3, spin: SU2),
    retractions(Cayley),
    potential = body.transform_point(&Point3::from(arm)).x * spin.inverse_transform_vector(&arm).y
        + (spin * arm).dot(&(body.inverse_transform_point(&Point3::from(arm)) - Point3::origin()))
        + (spin * Point3::new(1.0, 2.0, 3.0)).coords.dot(&spin.transform_vector(&arm)),
)]
struct Turned {
    #[inertia(body, spin)]
    inertia: f64,
    arm: Vector3<f64>,
}

/// A full matrix of four rows, inverted.
#[lie_poisson_system(
    group = R4,
    retractions(Cayley),
    hamiltonian = momentum.dot(&(mass.try_inverse().unwrap() * momentum)) / 2.0 + position.norm_squared(),
)]
struct Chain {
    #[inertia]
    mass: Matrix4<f64>,
}

fn vehicle() -> Vehicle {
    Vehicle {
        inertia: matrix![2.0, 0.3, -0.1; 0.3, 3.0, 0.2; -0.1, 0.2, 4.0],
        mass: 1.7,
        arm: vector![0.4, -0.3, 0.9],
        stiffness: 0.8,
        drag: 0.15,
    }
}

fn plate() -> Plate {
    Plate { inertia: 0.6, masses: matrix![2.0, 0.4; 0.4, 3.0], stiffness: 1.3, drag: 0.2 }
}

fn chain() -> Chain {
    let mut mass = Matrix4::from_diagonal(&vector![3.0, 4.0, 5.0, 6.0]);
    for (i, j, x) in [(0, 1, 0.5), (0, 2, -0.3), (0, 3, 0.7), (1, 2, 0.2), (1, 3, -0.6), (2, 3, 0.4)] {
        (mass[(i, j)], mass[(j, i)]) = (x, x);
    }
    Chain { mass }
}

fn close(ours: f64, plain: f64) {
    assert!((ours - plain).abs() <= 1e-13 * (1.0 + plain.abs()), "{ours} is not {plain}");
}

#[test]
fn energies_have_the_value_that_nalgebra_gives_them() {
    let random = &mut Random::new(7);
    for _ in 0..50 {
        let pose = Isometry3::from_parts(random.vector().into(), random.rotation());
        let angular: Vector3<f64> = random.vector();
        let linear: Vector3<f64> = random.vector();
        let momentum = Vector6::from_iterator(angular.iter().chain(linear.iter()).copied());
        let state = VehicleState { pose, momentum };
        close(vehicle().energy(&state), vehicle().hamiltonian(&state));

        let flat: Vector3<f64> = random.vector();
        let state = PlateState {
            plate: Isometry2::new(vector![linear.x, linear.y], linear.z),
            plate_momentum: flat,
            table: UnitComplex::new(3.0 * angular.x),
            table_momentum: vector![angular.y],
        };
        close(plate().energy(&state), plate().hamiltonian(&state));

        let turned = Turned { inertia: 2.0, arm: linear };
        let state = TurnedState {
            body: random.rotation(),
            body_momentum: Vector3::zeros(),
            spin: random.rotation(),
            spin_momentum: Vector3::zeros(),
        };
        close(turned.energy(&state), turned.potential(&state));

        let all = [angular.x, angular.y, angular.z, linear.x];
        let state =
            ChainState { position: vector![linear.y, linear.z, flat.x, flat.y], momentum: all.into() };
        close(chain().energy(&state), chain().hamiltonian(&state));
    }
}

#[test]
fn forces_have_the_value_that_nalgebra_gives_them() {
    let random = &mut Random::new(8);
    for _ in 0..20 {
        let pose = Isometry3::from_parts(random.vector().into(), random.rotation());
        let (angular, linear): (Vector3<f64>, Vector3<f64>) = (random.vector(), random.vector());
        let momentum = Vector6::from_iterator(angular.iter().chain(linear.iter()).copied());
        let state = VehicleState { pose, momentum };
        let control = VehicleControl { moment: random.vector(), push: random.vector() };
        let (moment, push) = vehicle().force(&state, &control);
        let ours = Geometry::force(&vehicle(), &state, 0.0, &control);
        // after the pose
        for (ours, plain) in ours[6..].iter().zip(moment.iter().chain(push.iter())) {
            close(*ours, *plain);
        }
        let state = PlateState {
            plate: Isometry2::new(vector![linear.x, linear.y], linear.z),
            plate_momentum: angular,
            table: UnitComplex::new(angular.x),
            table_momentum: vector![angular.y],
        };
        let (moment, push) = plate().force_plate(&state);
        let ours = Geometry::force(&plate(), &state, 0.0, &NoControl::default());
        for (ours, plain) in ours[3..].iter().zip([moment, push.x, push.y]) {
            close(*ours, plain);
        }
    }
}

#[test]
fn an_inertia_beside_a_hamiltonian_must_be_positive_definite() {
    let indefinite = matrix![1.0, 2.0, 0.0; 2.0, 1.0, 0.0; 0.0, 0.0, 1.0];
    let error = Vehicle { inertia: indefinite, ..vehicle() }.validate().expect_err("an indefinite inertia");
    assert_eq!(error, ParameterError::NotPositiveDefinite { name: "inertia", index: 1, pivot: -3.0 });
    let crooked = matrix![1.0, 0.5, 0.0; 0.0, 1.0, 0.0; 0.0, 0.0, 1.0];
    let error = Vehicle { inertia: crooked, ..vehicle() }.validate().expect_err("not symmetric");
    assert_eq!(error, ParameterError::NotSymmetric { name: "inertia", difference: 0.5 });
    let error = Plate { inertia: -0.5, ..plate() }.validate().expect_err("a negative inertia");
    assert_eq!(error, ParameterError::NotPositiveDefinite { name: "inertia", index: 0, pivot: -0.5 });
    let error = Plate { masses: -plate().masses, ..plate() }.validate().expect_err("negative masses");
    assert_eq!(error, ParameterError::NotPositiveDefinite { name: "masses", index: 0, pivot: -2.0 });
    // what is not marked may be anything
    assert_eq!(Vehicle { mass: -1.0, stiffness: 0.0, ..vehicle() }.validate(), Ok(()));
}

/// An inverse that is not there is no panic of a step: it fails as any whose state is not finite, and leaves the state as it was.
#[test]
fn a_step_that_meets_a_singular_matrix_fails() {
    #[lie_poisson_system(
        group = R2,
        retractions(Cayley),
        hamiltonian = momentum.dot(&(coupling.try_inverse().unwrap() * momentum)) / 2.0,
    )]
    struct Coupled {
        coupling: Matrix2<f64>,
    }
    let start = CoupledState { position: Vector2::x(), momentum: Vector2::y() };
    for (coupling, works) in [(matrix![1.0, 2.0; 2.0, 4.0], false), (matrix![1.0, 2.0; 2.0, 5.0], true)] {
        let mut state = start;
        let step =
            Coupled { coupling }.stepper::<Cayley>(0.1).map(|mut stepper| stepper.step(&mut state).is_ok());
        assert_eq!(step.is_ok_and(|taken| taken), works);
        assert_eq!(state == start, !works);
    }
}

/// The orders that the guide names: in flat arrays the real part is first, in JSON last.
#[test]
fn a_quaternion_has_two_orders() {
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(0.5, 0.1, 0.7, 0.5));
    let pose = Isometry3::from_parts(vector![1.0, 2.0, 3.0].into(), rotation);
    let state = VehicleState { pose, momentum: Vector6::from_fn(|i, _| 4.0 + i as f64) };
    let flat = [0.5, 0.1, 0.7, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
    assert_eq!(state.to_components(), flat);
    let text = serde_json::to_string(&state).expect("to JSON");
    let expected = r#"{"pose":{"rotation":[0.1,0.7,0.5,0.5],"translation":[1.0,2.0,3.0]},"momentum":[4.0,5.0,6.0,7.0,8.0,9.0]}"#;
    assert_eq!(text, expected);
    assert_eq!(
        Plate { masses: matrix![1.0, 2.0; 3.0, 4.0], ..plate() }.to_parameters()[1..5],
        [1.0, 2.0, 3.0, 4.0]
    );
}

/// Two bodies alike that pull at each other: one inertia for both, and one for each.
macro_rules! twins {
    ($name:ident, $($fields:tt)*) => {
        #[lie_poisson_system(
            group(first: SO3, second: SO3),
            retractions(Cayley),
            potential = -(first * Vector3::z()).dot(&(second * Vector3::x())),
        )]
        struct $name { $($fields)* }
    };
}

twins!(Shared, #[inertia(first, second)] inertia: Vector3<f64>);
twins!(SharedMatrix, #[inertia] inertia: Matrix3<f64>);
twins!(Separate, #[inertia(first)] one: Vector3<f64>, #[inertia(second)] other: Vector3<f64>);
twins!(Joint, #[inertia] inertia: Vector6<f64>);

#[test]
fn a_shared_inertia_is_that_of_each() {
    let random = &mut Random::new(9);
    let (first, second) = (random.rotation(), random.rotation());
    let (first_momentum, second_momentum) = (random.vector(), random.vector());
    let moments = vector![1.0, 2.0, 2.5];
    macro_rules! moved {
        ($system:expr, $state:ident) => {{
            let (system, mut state) = ($system, $state { first, first_momentum, second, second_momentum });
            let mut stepper = system.stepper::<Cayley>(0.05).expect("valid parameters");
            for _ in 0..20 {
                stepper.step(&mut state).expect("a step");
            }
            (state.to_components(), system.energy(&state))
        }};
    }
    let separate = moved!(Separate { one: moments, other: moments }, SeparateState);
    let shared = moved!(Shared { inertia: moments }, SharedState);
    assert_eq!(shared.0, separate.0);
    assert!((shared.1 - separate.1).abs() < 3e-16, "{} {}", shared.1, separate.1);
    let near = |(state, energy): ([f64; 14], f64)| {
        let pairs = state.iter().zip(&separate.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(pairs < 1e-12 && (energy - separate.1).abs() < 1e-12, "{pairs:e}");
    };
    near(moved!(SharedMatrix { inertia: Matrix3::from_diagonal(&moments) }, SharedMatrixState));
    near(moved!(Joint { inertia: vector![1.0, 2.0, 2.5, 1.0, 2.0, 2.5] }, JointState));
    let error = Shared { inertia: vector![1.0, -2.0, 3.0] }.validate().expect_err("a negative moment");
    assert_eq!(error, ParameterError::NotPositiveDefinite { name: "inertia", index: 1, pivot: -2.0 });
}

/// A wheel on a torsion spring.
#[lie_poisson_system(group = SO2, potential = 0.5 * stiffness * angle.angle().powi(2))]
struct Balance {
    #[inertia]
    inertia: f64,
    stiffness: f64,
}

/// It swings as a harmonic oscillator does, as long as it stays below half a turn, where the angle jumps.
#[test]
fn a_torsion_spring_is_harmonic() {
    let balance = Balance { inertia: 1.0, stiffness: 4.0 };
    let mut state = BalanceState { angle: UnitComplex::new(2.0), momentum: vector![0.0] };
    let steps = 2_000;
    let mut stepper = balance.stepper::<Order6<Exponential>>(PI / f64::from(steps)).expect("a stepper");
    for _ in 0..steps / 2 {
        stepper.step(&mut state).expect("a step");
    }
    // half a period of π
    assert!((state.angle.angle() + 2.0).abs() < 1e-9, "{}", state.angle.angle());
    assert!(state.momentum.x.abs() < 1e-9);
    let angle = |turned: f64| {
        (2.0 * balance.potential(&BalanceState { angle: UnitComplex::new(turned), ..state }) / 4.0).sqrt()
    };
    assert!((angle(3.1) - 3.1).abs() < 1e-12 && (angle(3.2) - (2.0 * PI - 3.2)).abs() < 1e-12);
}
