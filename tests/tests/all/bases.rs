//! Systems on groups of which nothing is known but a basis.

use coadjoint::certify::{Claims, certify};
use coadjoint::nalgebra::{DVector, Matrix2, SMatrix, SVector};
use coadjoint::prelude::*;
use coadjoint::{Discretized, System};

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

fn holds<M: Claims<S> + 'static, S>((system, state): (S, S::State))
where
    S: coadjoint::__private::Geometry<Scalar = f64> + Discretized<M> + 'static,
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

/// The state after some time, by RK4 in the stored numbers with the generated vector field, in small steps.
fn integrated<S>((system, state): &(S, S::State), time: f64, steps: u32) -> DVector<f64>
where
    S: System<Scalar = f64> + coadjoint::erased::System,
{
    let system: &dyn coadjoint::erased::System = system;
    let field = |x: &DVector<f64>| DVector::from_vec(system.vector_field(x.as_slice(), 0.0, &[]));
    let h = time / f64::from(steps);
    let start = DVector::from_row_slice(state.to_components().as_ref());
    (0..steps).fold(start, |x, _| {
        let k1 = field(&x);
        let k2 = field(&(&x + &k1 * (h / 2.0)));
        let k3 = field(&(&x + &k2 * (h / 2.0)));
        let k4 = field(&(&x + &k3 * h));
        x + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0)
    })
}

#[test]
fn order_six_is_that_of_an_independent_integration() {
    fn agrees<M, S>(example: (S, S::State))
    where
        S: System<Scalar = f64> + coadjoint::erased::System + Discretized<Order6<M>>,
    {
        // Richardson's extrapolation of RK4: the error left is below 1e-13
        let [coarse, fine] = [400, 800].map(|steps| integrated(&example, 1.0, steps));
        let exact = &fine + (&fine - coarse) / 15.0;
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
}

#[test]
fn casimirs_and_the_group_are_kept_over_long_runs() {
    let (system, mut state) = body();
    let mut stepper = system.stepper::<Cayley>(0.1).expect("valid");
    let before = system.casimirs(&state);
    assert_eq!(before.as_ref().len(), 2);
    for _ in 0..100_000 {
        stepper.step(&mut state).expect("a step");
    }
    let after = system.casimirs(&state);
    for (after, before) in after.as_ref().iter().zip(before.as_ref()) {
        assert!((after - before).abs() < 1e-12, "{after} {before}");
    }
    let off = (state.element * state.element.transpose() - SMatrix::<f64, 4, 4>::identity()).norm();
    assert!(off < 1e-14, "{off}");
}
