//! Systems on groups of which nothing is known but a basis.

use coadjoint::SchemeType;
use coadjoint::certify::certify;
use coadjoint::erased;
use coadjoint::nalgebra::{DVector, Matrix2, SMatrix, SVector};
use coadjoint::prelude::*;
use coadjoint::{Discretized, System};

use crate::reference::reference;

/// A point of the plane that is carried along by a free body on SL(2), of a basis of the user's own.
#[lie_poisson_system(
    group = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] },
    advected(v: R2),
    potential = stiffness * v.dot(&v),
    methods(Midpoint)
)]
struct Shear {
    #[inertia]
    inertia: Vector3<f64>,
    stiffness: f64,
}

/// The body of four dimensions.
#[lie_poisson_system(group = SO(4), retractions(Cayley))]
struct Body4 {
    #[inertia]
    inertia: SVector<f64, 6>,
}

/// A vehicle that a spring holds at its place.
#[lie_poisson_system(
    group = SE2(3),
    potential = stiffness * (element[(0, 4)].powi(2) + element[(1, 4)].powi(2) + element[(2, 4)].powi(2))
)]
struct Vehicle {
    #[inertia]
    inertia: SVector<f64, 9>,
    stiffness: f64,
}

lie_group! {
    /// Maps of the plane that keep areas.
    Areas = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] }
}

/// Carries along what a group acts on: a column, a row, elements of the algebra and of its dual, and a quadratic form.
#[lie_poisson_system(
    group = Areas!,
    advected(
        v: R2,
        w: dual(R2),
        x: adjoint,
        m: coadjoint,
        q: matrices { h: [2, 0, 0; 0, 0, 0; 0, 0, -2], e: [0, 1, 0; 0, 0, 2; 0, 0, 0], f: [0, 0, 0; 2, 0, 0; 0, 1, 0] }
    ),
    potential = (v.x * w.y + x.x * m.y + x.dot(&q) + q.norm_squared() + m.norm_squared() + (v.x * v.y).cos()) / 8.0
)]
struct Carrier {
    #[inertia]
    inertia: Vector3<f64>,
}

/// The Hamiltonian of Killing's form, in coordinates by their names.
#[lie_poisson_system(
    group = Areas!,
    hamiltonian = (vector![momentum.h].norm_squared() + 4.0 * momentum.e * momentum.f) / (2.0 * inertia),
    force = -friction * velocity.h * momentum,
)]
struct Killing {
    inertia: f64,
    friction: f64,
}

#[test]
fn coordinates_have_names() {
    let system = Killing { inertia: 2.0, friction: 0.5 };
    let state = KillingState { element: Matrix2::identity(), momentum: vector![0.3, -0.5, 0.7] };
    assert!((system.energy(&state) - (0.09 - 1.4) / 4.0).abs() < 1e-15);
    assert!((system.velocity(&state) - vector![0.15, 0.7, -0.5]).norm() < 1e-15);
    assert!((system.force(&state) + 0.075 * state.momentum).norm() < 1e-15);
}

/// A rigid motion that carries a screw and a wrench along.
#[lie_poisson_system(
    group = SE3,
    advected(gamma: R3, screw: adjoint, wrench: coadjoint),
    potential = (screw.norm_squared() + wrench.norm_squared() + gamma.z * wrench[4]) / 8.0
)]
struct Screw {
    #[inertia]
    inertia: Vector6<f64>,
}

fn carrier() -> (Carrier, CarrierState) {
    let start = CarrierState {
        element: Matrix2::identity(),
        momentum: vector![0.05, 0.5, -0.4],
        v: vector![0.3, 0.5],
        w: vector![-0.2, 0.4],
        x: vector![0.1, -0.3, 0.2],
        m: vector![0.3, 0.1, -0.2],
        q: vector![0.2, 0.1, 0.3],
    };
    (Carrier { inertia: vector![1.0, 2.0, 3.5] }, start)
}

fn screw() -> (Screw, ScrewState) {
    let start = ScrewState {
        pose: Isometry3::identity(),
        momentum: Vector6::from([0.3, -0.2, 0.5, 0.1, 0.4, -0.3]),
        gamma: vector![0.1, 0.2, 0.9],
        screw: Vector6::from([0.2, 0.3, -0.1, 0.4, 0.1, 0.2]),
        wrench: Vector6::from([-0.3, 0.1, 0.2, 0.1, -0.2, 0.3]),
    };
    (Screw { inertia: Vector6::from([1.0, 1.5, 2.0, 3.0, 3.2, 3.5]) }, start)
}

fn shear() -> (Shear, ShearState) {
    let start =
        ShearState { element: Matrix2::identity(), momentum: vector![0.3, 0.5, -0.4], v: vector![0.3, 0.5] };
    (Shear { inertia: vector![1.0, 2.0, 3.5], stiffness: 1.0 }, start)
}

fn body() -> (Body4, Body4State) {
    let momentum = SVector::from([0.3, -0.2, 0.5, 0.1, 0.4, -0.3]);
    let inertia = SVector::from([1.0, 1.5, 2.0, 2.2, 2.7, 3.1]);
    (Body4 { inertia }, Body4State { element: SMatrix::identity(), momentum })
}

fn vehicle() -> (Vehicle, VehicleState) {
    let inertia = SVector::from([1.0, 2.0, 2.5, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0]);
    let momentum = SVector::from([0.3, 0.2, 0.1, 0.5, 0.1, 0.2, 0.3, 0.1, 0.4]);
    (Vehicle { inertia, stiffness: 0.3 }, VehicleState { element: SMatrix::identity(), momentum })
}

fn holds<M: SchemeType, S>((system, state): (S, S::State))
where
    S: coadjoint::__private::Geometry<Scalar = f64> + Discretized<M> + erased::System,
{
    let report = certify::<M, S>(&system, &[state]).expect("measurable");
    assert!(report.passed(), "{report}");
}

#[test]
fn certificates_hold() {
    holds::<Exponential, _>(shear());
    holds::<Cayley, _>(shear());
    holds::<Midpoint<Exponential>, _>(shear());
    holds::<Cayley, _>(body());
    holds::<Exponential, _>(vehicle());
    holds::<Cayley, _>(vehicle());
}

/// On every space that a group acts on.
#[test]
fn certificates_hold_for_all_spaces() {
    holds::<Exponential, _>(carrier());
    holds::<Exponential, _>(screw());
}

/// The state after some time, in the stored numbers with the generated vector field.
fn integrated<S>((system, state): &(S, S::State), time: f64) -> DVector<f64>
where
    S: System<Scalar = f64> + coadjoint::erased::System,
{
    let system: &dyn coadjoint::erased::System = system;
    let field = |x: &DVector<f64>| DVector::from_vec(system.vector_field(x.as_slice(), 0.0, &[]));
    reference(&DVector::from_row_slice(state.to_components().as_ref()), time, 80, field)
}

#[test]
fn order_six_is_that_of_an_independent_integration() {
    fn agrees<M, S>(example: (S, S::State))
    where
        S: System<Scalar = f64> + coadjoint::erased::System + Discretized<Order6<M>>,
    {
        let exact = integrated(&example, 1.0);
        let error = |steps: u32| {
            let (system, mut state) = (&example.0, example.1.clone());
            let mut stepper = system.stepper::<Order6<M>>(1.0 / f64::from(steps)).expect("valid");
            for _ in 0..steps {
                stepper.step(&mut state).expect("a step");
            }
            (DVector::from_row_slice(state.to_components().as_ref()) - &exact).norm()
        };
        let errors = [2, 4, 8].map(error);
        let slope = (errors[0] / errors[2]).log2() / 2.0;
        assert!((slope - 6.0).abs() < 0.7, "{slope}: {errors:?}");
        assert!(error(32) < 1e-12, "{}", error(32));
    }
    agrees::<Exponential, _>(shear());
    agrees::<Cayley, _>(body());
    agrees::<Cayley, _>(vehicle());
    agrees::<Exponential, _>(carrier());
    agrees::<Exponential, _>(screw());
}

#[test]
fn casimirs_and_the_group_are_kept_over_long_runs() {
    let (system, mut state) = body();
    let mut stepper = system.stepper::<Cayley>(0.1).expect("valid");
    let before = system.casimirs(&state);
    assert_eq!(before.as_ref().len(), 2);
    for _ in 0..20_000 {
        stepper.step(&mut state).expect("a step");
    }
    let after = system.casimirs(&state);
    for (after, before) in after.as_ref().iter().zip(before.as_ref()) {
        assert!((after - before).abs() < 5e-13, "{after} {before}");
    }
    let off = (state.element * state.element.transpose() - SMatrix::<f64, 4, 4>::identity()).norm();
    assert!(off < 1e-14, "{off}");
}

/// A state that is not on the group is refused, and left as it is.
#[test]
fn matrices_off_their_groups_are_told() {
    fn refused<S>((system, start): (S, S::State), off: impl Fn(&mut S::State))
    where
        S: Discretized<Exponential> + System<Scalar = f64>,
    {
        assert!(start.deviation() < 1e-15);
        let mut state = start;
        off(&mut state);
        assert!(state.deviation() > 0.01, "{}", state.deviation());
        let before = state.clone();
        let error = system.stepper::<Exponential>(0.1).expect("valid").step(&mut state).expect_err("off");
        assert!(matches!(error, StepError::NotOnGroup { .. }), "{error}");
        assert_eq!(state, before);
    }
    // of determinant 1, and with the columns and the last row of a motion
    refused(shear(), |state| state.element[(0, 0)] = 1.1);
    refused(vehicle(), |state| state.element[(0, 1)] = 0.1);
    refused(vehicle(), |state| state.element[(4, 4)] = 1.1);
}
