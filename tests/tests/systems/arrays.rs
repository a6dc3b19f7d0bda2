//! Arrays of factors, parameters, controls and advected parameters: the same system as with a name for each, to the last digit.

use coadjoint::SchemeType;
use coadjoint::certify::certify;
use coadjoint::derivative::{WrtState, block};
use coadjoint::erased;
use coadjoint::nalgebra::Matrix2;
use coadjoint::prelude::*;
use coadjoint::{Discretized, ParameterError, State, System};
use coadjoint_support::random::Random;

/// Two bodies, each with a mark and a wheel, which turn each other; the second carries a needle.
#[lie_poisson_system(
    group(bodies: [SO3; 2], wheels: [SO2; 2]),
    advected(marks: bodies::R3, needle: bodies[1]::R3),
    control(torques: [R3; 2], motors: [f64; 2]),
    potential = {
        let neighbours = (0..2).map(|i| marks[i].dot(&marks[(i + 1) % 2])).sum::<f64>();
        let springs = stiffness.iter().zip(marks.iter()).map(|(k, mark)| k * mark.x).sum::<f64>();
        let turns = wheels.iter().enumerate().map(|(i, wheel)| (i as f64 + 1.0) * wheel.cos_angle()).sum::<f64>();
        neighbours + springs + needle.dot(&marks[1]) * needle.z + turns
    },
    force(
        bodies = [torques[0], torques[1] - drag * bodies_velocity[1]],
        wheels[0] = motors[0] - drag * wheels_velocity[0].x,
        wheels[1] = motors[1] + (wind * t).sin(),
    ),
    retractions(Cayley),
    derivatives(state),
)]
#[derive(Clone, Debug, PartialEq)]
struct Bodies {
    #[inertia(bodies)]
    inertia: [Vector3<f64>; 2],
    #[inertia(wheels)]
    moments: [f64; 2],
    stiffness: [f64; 2],
    drag: f64,
    wind: f64,
}

/// The same with a name for each.
#[lie_poisson_system(
    group(first: SO3, second: SO3, left: SO2, right: SO2),
    advected(a: first::R3, b: second::R3, needle: second::R3),
    control(first_torque: R3, second_torque: R3, left_motor: f64, right_motor: f64),
    potential = {
        let springs = first_stiffness * a.x + second_stiffness * b.x;
        a.dot(&b) + b.dot(&a) + springs + needle.dot(&b) * needle.z + left.cos_angle() + 2.0 * right.cos_angle()
    },
    force(
        first = first_torque,
        second = second_torque - drag * second_velocity,
        left = left_motor - drag * left_velocity.x,
        right = right_motor + (wind * t).sin(),
    ),
    retractions(Cayley),
    derivatives(state),
)]
#[derive(Clone, Debug, PartialEq)]
struct Named {
    #[inertia(first)]
    first_inertia: Vector3<f64>,
    #[inertia(second)]
    second_inertia: Vector3<f64>,
    #[inertia(left)]
    left_inertia: f64,
    #[inertia(right)]
    right_inertia: f64,
    first_stiffness: f64,
    second_stiffness: f64,
    drag: f64,
    wind: f64,
}

fn bodies() -> (Bodies, BodiesState, BodiesControl) {
    let random = &mut Random::new(5);
    let mut vector = || random.vector();
    let control = BodiesControl { torques: [vector(), vector()], motors: [0.3, -0.4] };
    let system = Bodies {
        inertia: [vector![1.0, 2.0, 2.5], vector![2.0, 3.0, 3.5]],
        moments: [0.5, 0.7],
        stiffness: [1.0, 0.8],
        drag: 0.1,
        wind: 2.0,
    };
    let state = BodiesState {
        bodies: [0.1, 0.2].map(|angle| UnitQuaternion::new(vector![angle, 1.0, -angle])),
        bodies_momentum: [vector(), vector()],
        wheels: [0.3, -0.8].map(UnitComplex::new),
        wheels_momentum: [vector![0.4], vector![-0.1]],
        marks: [vector(), vector()],
        needle: vector(),
    };
    (system, state, control)
}

/// The system with a name for each, from the same numbers.
fn named() -> (Named, NamedState, NamedControl) {
    let (system, state, control) = bodies();
    let parameters = Named::from_parameters(&system.to_parameters());
    let state = NamedState::from_components(&state.to_components());
    (parameters, state, coadjoint::Control::from_components(&coadjoint::Control::to_components(&control)))
}

#[track_caller]
fn assert_same(found: &[f64], expected: &[f64]) {
    let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(found), bits(expected), "{found:?} {expected:?}");
}

#[test]
fn elements_are_where_their_names_are() {
    let (array, state, control) = bodies();
    let (other, at, held) = named();
    assert_eq!((other.second_inertia, other.right_inertia), (array.inertia[1], array.moments[1]));
    assert_eq!((other.first_stiffness, other.second_stiffness), (array.stiffness[0], array.stiffness[1]));
    assert_eq!((at.second, at.second_momentum), (state.bodies[1], state.bodies_momentum[1]));
    assert_eq!((at.right, at.right_momentum), (state.wheels[1], state.wheels_momentum[1]));
    assert_eq!((at.a, at.b, at.needle), (state.marks[0], state.marks[1], state.needle));
    assert_eq!((held.second_torque, held.left_motor), (control.torques[1], control.motors[0]));
    assert_eq!(Bodies::from_parameters(&array.to_parameters()), array);
    assert_eq!(BodiesState::from_components(&state.to_components()), state);
    let names =
        |quantities: &[coadjoint::Quantity]| quantities.iter().map(|q| q.name).collect::<Vec<_>>().join(" ");
    assert_eq!(
        names(BodiesState::QUANTITIES),
        "bodies_0 bodies_momentum_0 bodies_1 bodies_momentum_1 wheels_0 wheels_momentum_0 wheels_1 wheels_momentum_1 \
         marks_0 marks_1 needle"
    );
    assert_eq!(
        names(Bodies::PARAMETERS),
        "inertia_0 inertia_1 moments_0 moments_1 stiffness_0 stiffness_1 drag wind"
    );
    assert_eq!(
        names(<BodiesControl as coadjoint::Control>::QUANTITIES),
        "torques_0 torques_1 motors_0 motors_1"
    );
    assert_eq!(BodiesState::QUANTITIES[1].components, ["x", "y", "z"]);
    assert_eq!(Bodies::CASIMIRS, ["|marks_0|²", "|marks_1|²", "|needle|²", "marks_1·needle"]);
}

#[test]
fn an_array_moves_as_factors_with_names() {
    let ((array, mut a, control), (other, mut b, held)) = (bodies(), named());
    let mut of_array = array.stepper::<Cayley>(0.05).expect("a stepper");
    let mut of_names = other.stepper::<Cayley>(0.05).expect("a stepper");
    for _ in 0..40 {
        of_array.step_with(&mut a, &control).expect("a step");
        of_names.step_with(&mut b, &held).expect("a step");
        assert_same(&a.to_components(), &b.to_components());
    }
    assert_ne!(a, bodies().1);
    assert_same(
        &[array.energy_at(&a, 0.7, &Default::default())],
        &[other.energy_at(&b, 0.7, &Default::default())],
    );
    assert_same(&array.casimirs(&a), &other.casimirs(&b));
    assert_same(array.velocity(&a).as_slice(), other.velocity(&b).as_slice());
    assert_same(array.spatial_momentum(&a).as_slice(), other.spatial_momentum(&b).as_slice());
    let (system, field): (&dyn coadjoint::erased::System, &dyn coadjoint::erased::System) = (&array, &other);
    assert_same(
        &system.vector_field(&a.to_components(), 0.3, coadjoint::Control::to_components(&control).as_ref()),
        &field.vector_field(&b.to_components(), 0.3, coadjoint::Control::to_components(&held).as_ref()),
    );
    // what is written is what rustc makes of it, in another order of the same terms
    assert!((array.potential(&a) - other.potential(&b)).abs() < 1e-16);
    let [_, second] = array.force_bodies(&a, &control);
    assert_same(second.as_slice(), other.force_second(&b, &held).as_slice());
    assert_same(&[array.force_wheels_1(&a, &control, 0.2)], &[other.force_right(&b, &held, 0.2)]);
}

#[test]
fn derivatives_are_the_same() {
    let ((array, mut a, control), (other, mut b, held)) = (bodies(), named());
    let mut of_array = array.stepper::<Cayley>(0.05).expect("a stepper");
    let mut of_names = other.stepper::<Cayley>(0.05).expect("a stepper");
    let of_array = of_array.step_with_jacobian(&mut a, &control, WrtState).expect("a step").0;
    let of_names = of_names.step_with_jacobian(&mut b, &held, WrtState).expect("a step").0;
    assert_same(of_array.as_slice(), of_names.as_slice());
    let of_second = block(&of_array, BodiesIndices::BODIES_MOMENTUM_1, BodiesIndices::BODIES_1);
    let expected = block(&of_names, NamedIndices::SECOND_MOMENTUM, NamedIndices::SECOND);
    assert_same(of_second.as_slice(), expected.as_slice());
    assert!(block(&of_array, BodiesIndices::BODIES_1, BodiesIndices::BODIES_MOMENTUM_1).norm() > 1e-3);
}

#[test]
fn what_is_wrong_with_an_element_is_told_by_its_name() {
    let (mut system, mut state, control) = bodies();
    system.inertia[1].z = -1.0;
    let expected = ParameterError::NotPositiveDefinite { name: "inertia_1", index: 2, pivot: -1.0 };
    assert_eq!(system.validate(), Err(expected));
    system.inertia[1].z = f64::NAN;
    assert!(matches!(system.validate(), Err(ParameterError::NotFinite { name: "inertia_1", .. })));
    state.bodies[1] = UnitQuaternion::new_unchecked(coadjoint::nalgebra::Quaternion::new(1.1, 0.0, 0.0, 0.0));
    assert!((state.deviation() - 0.1).abs() < 1e-12);
    let error = bodies().0.stepper::<Cayley>(0.05).expect("a stepper").step_with(&mut state, &control);
    assert!(error.is_err());
}

#[test]
fn states_are_written_as_arrays() {
    let (_, state, control) = bodies();
    let text = serde_json::to_value(state).expect("a state");
    assert_eq!(text["bodies_momentum"].as_array().map(Vec::len), Some(2));
    assert_eq!(text["wheels"][1][0], state.wheels[1].re);
    assert_eq!(serde_json::from_value::<BodiesState>(text).expect("a state"), state);
    let text = serde_json::to_value(control).expect("controls");
    assert_eq!(text["motors"], serde_json::json!([0.3, -0.4]));
    assert_eq!(serde_json::from_value::<BodiesControl>(text).expect("controls"), control);
    assert_eq!(BodiesControl::default().torques, [Vector3::zeros(); 2]);
}

lie_group! {
    /// Maps of the plane that keep areas.
    Areas = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] }
}

/// Two drops that shear each other by what they carry.
#[lie_poisson_system(
    group(drops: [Areas!; 2]),
    advected(marks: drops::R2),
    potential = marks.iter().map(|mark| mark.norm_squared()).sum::<f64>() + marks[0].dot(&marks[1]),
    retractions(Cayley),
)]
struct Drops {
    #[inertia]
    inertia: Vector3<f64>,
}

/// Two boats that a spring holds together in still water.
#[lie_poisson_system(
    group(hulls: [SE2; 2]),
    hamiltonian = {
        let turning = hulls_angular_momentum.iter().map(|m| m * m / 2.0).sum::<f64>();
        let moving = hulls_linear_momentum.iter().zip(&masses).map(|(p, m)| p.norm_squared() / (2.0 * m)).sum::<f64>();
        let apart = hulls[1].translation.vector - hulls[0].translation.vector;
        turning + moving + stiffness * apart.norm_squared() / 2.0
    },
    force(hulls = [0, 1].map(|i| (-drag * hulls_angular_velocity[i], -drag * hulls_linear_velocity[i]))),
    retractions(Cayley),
)]
struct Hulls {
    masses: [f64; 2],
    stiffness: f64,
    drag: f64,
}

fn holds<M: SchemeType, S>(system: &S, state: S::State)
where
    S: coadjoint::__private::Geometry<Scalar = f64> + Discretized<M> + erased::System,
{
    let report = certify::<M, S>(system, &[state]).expect("measurable");
    assert!(report.passed(), "{report}");
}

#[test]
fn certificates_hold() {
    let marks = [vector![0.3, 0.5], vector![-0.2, 0.4]];
    let momenta = [vector![0.3, 0.5, -0.4], vector![0.1, 0.3, -0.2]];
    let drops = DropsState { drops: [Matrix2::identity(); 2], drops_momentum: momenta, marks };
    assert_eq!(Drops::CASIMIRS.len(), drops.marks.len());
    holds::<Cayley, _>(&Drops { inertia: vector![1.0, 2.0, 3.5] }, drops);
}

/// Momenta have named parts, velocities too, one for each element.
#[test]
fn parts_of_momenta_are_arrays() {
    let hulls = Hulls { masses: [1.0, 2.0], stiffness: 0.5, drag: 0.1 };
    let mut state = HullsState {
        hulls: [Isometry2::identity(), Isometry2::new(vector![0.4, 0.1], 0.2)],
        hulls_momentum: [vector![0.3, -0.2, 0.5], vector![0.1, 0.2, -0.4]],
    };
    let turning = (0.3 * 0.3 + 0.1 * 0.1) / 2.0;
    let moving = (0.2 * 0.2 + 0.5 * 0.5) / 2.0 + (0.2 * 0.2 + 0.4 * 0.4) / 4.0;
    let energy = turning + moving + 0.25 * (0.4 * 0.4 + 0.1 * 0.1);
    assert!((hulls.energy(&state) - energy).abs() < 1e-15);
    assert!((hulls.hamiltonian(&state) - energy).abs() < 1e-15);
    let [(first, _), (turn, push)] = hulls.force_hulls(&state);
    assert!((first + 0.03).abs() < 1e-15 && (turn + 0.01).abs() < 1e-15);
    assert!((push + vector![0.1, -0.2] * 0.1).norm() < 1e-15);
    let mut stepper = hulls.stepper::<Cayley>(0.1).expect("a stepper");
    for _ in 0..2_000 {
        stepper.step(&mut state).expect("a step");
    }
    assert!(hulls.energy(&state) < 0.1 * energy, "{}", hulls.energy(&state));
}
