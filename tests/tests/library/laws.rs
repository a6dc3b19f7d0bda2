//! The laws of groups hold on the code that was generated, and what breaks one is found.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use coadjoint::__private::{Geometry, RetractionKind, Scalar};
use coadjoint::certify::{CertifyError, Verdict, group_laws};
use coadjoint::derivative::LinearizedSchemes;
use coadjoint::prelude::*;
use coadjoint::scheme::Rule;
use coadjoint::system::{Generated, Schemes, Visitor};
use coadjoint::{SecondKind, assert_group_laws};

use crate::faulty::{Fault, Faulty, FaultyKernel};

lie_group! {
    /// Maps of the plane that keep areas.
    Areas = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] };
    /// The motions of a vehicle with a rotor.
    Carrier = product(vehicle: SE2, rotor: SO2);
}

#[test]
fn groups_of_ones_own_obey_their_laws() {
    assert_group_laws!(Areas!);
    assert_group_laws!(Areas!, invariance = right);
    assert_group_laws!(Areas!, advected(v: R2, w: dual(R2), x: adjoint, m: coadjoint));
    assert_group_laws!(Carrier!);
    assert_group_laws!(tangent(SO3));
}

#[test]
fn families_and_the_catalogue_obey_their_laws() {
    assert_group_laws!(SO(4));
    assert_group_laws!(SL(3));
    assert_group_laws!(Heisenberg);
    assert_group_laws!(SO3, advected(gamma: R3));
    assert_group_laws!(SE3);
    assert_group_laws!(SE3, retractions(SecondKind));
    assert_group_laws!(SO3, advected(gamma: R3), retractions(SecondKind), invariance = right);
    assert_group_laws!(SU2, advected(m: coadjoint), retractions(SecondKind));
    assert_group_laws!(SU2);
    assert_group_laws!(R2);
}

/// A drop that shears freely, with a mark on it.
#[lie_poisson_system(group = Areas!, advected(mark: R2), potential = stiffness * mark.norm_squared())]
struct Drop {
    #[inertia]
    inertia: Vector3<f64>,
    stiffness: f64,
}

fn drop() -> (Drop, DropState) {
    let drop = Drop { inertia: vector![1.0, 2.0, 2.0], stiffness: 1.0 };
    let element = matrix![1.0, 0.5; 0.4, 1.2];
    (drop, DropState { element, momentum: vector![0.1, 0.5, -0.5], mark: vector![1.0, 0.3] })
}

impl<F: Fault> Generated<SymplecticEulerA<Exponential>> for Faulty<Drop, F> {
    type Kernel<T: Scalar> = FaultyKernel<<Drop as Generated<SymplecticEulerA<Exponential>>>::Kernel<T>, F>;
}

impl<F: Fault> Generated<SymplecticEulerA<Cayley>> for Faulty<Drop, F> {
    type Kernel<T: Scalar> = FaultyKernel<<Drop as Generated<SymplecticEulerA<Cayley>>>::Kernel<T>, F>;
}

impl<F: Fault> LinearizedSchemes for Faulty<Drop, F> {}

impl<F: Fault> Schemes for Faulty<Drop, F> {
    fn visit<V: Visitor<Self>>(map: RetractionKind, rule: Rule, visitor: V) -> Option<V::Output> {
        match (map, rule) {
            (RetractionKind::Exponential, Rule::Family(0, 1)) => {
                Some(visitor.visit::<SymplecticEulerA<Exponential>>())
            }
            (RetractionKind::Cayley, Rule::Family(0, 1)) => Some(visitor.visit::<SymplecticEulerA<Cayley>>()),
            _ => None,
        }
    }
}

/// The laws that do not hold for a drop that is bent.
fn broken<F: Fault>(bend: impl FnOnce(Faulty<Drop, F>) -> Faulty<Drop, F>) -> Vec<String> {
    let (drop, state) = drop();
    broken_of(&bend(Faulty::new(drop)), &state)
}

fn broken_of<S: Geometry<Scalar = f64> + Schemes>(system: &S, state: &S::State) -> Vec<String> {
    let laws = group_laws(system, state).unwrap();
    println!("{laws}\n");
    assert_eq!(laws.passed(), laws.failures().next().is_none());
    laws.failures().map(|law| law.name.clone()).collect()
}

#[test]
fn the_laws_hold_for_a_system_of_ones_own() {
    let (drop, state) = drop();
    let laws = group_laws(&drop, &state).unwrap();
    assert!(laws.passed(), "{laws}");
    assert!(
        laws.certificates.iter().all(|law| law.figure < 1e-12 || law.verdict == Verdict::NotMeasured),
        "{laws}"
    );
    let unmeasured = |law: &&coadjoint::certify::Certificate| law.verdict == Verdict::NotMeasured;
    let names: Vec<_> = laws.certificates.iter().filter(unmeasured).map(|law| &*law.name).collect();
    // that is one of the exponential alone
    assert_eq!(names, ["Cayley: series"]);
    assert!(broken::<()>(|drop| drop).is_empty());
}

/// Where elements are displaced to is a little farther than it should be: still on the group, and still odd.
#[test]
fn a_wrong_closed_form_is_found() {
    let too_far = broken::<()>(|drop| {
        drop.with_displacement(|drop, state, map, by| {
            let size = by[..3].iter().map(|x| x * x).sum::<f64>();
            let mut by = *by;
            by[..3].iter_mut().for_each(|x| *x *= 1.0 + 1e-6 * size);
            drop.displace(state, map, &by)
        })
    });
    for law in ["definition", "derivative", "adjoint action", "coadjoint action"] {
        assert!(too_far.contains(&format!("exponential: {law}")), "{law}: {too_far:?}");
    }
    for law in ["definition", "derivative"] {
        assert!(too_far.contains(&format!("Cayley: {law}")), "{law}: {too_far:?}");
    }
    let swapped = broken::<()>(|drop| {
        drop.with_displacement(|drop, state, _, by| drop.displace(state, RetractionKind::Exponential, by))
    });
    assert_eq!(
        swapped,
        ["Cayley: definition", "Cayley: derivative", "Cayley: coadjoint action", "Cayley: spaces"]
    );
}

/// A body that turns about its axes one after the other.
#[lie_poisson_system(group = SO3, advected(gamma: R3), retractions(SecondKind))]
struct Turning {
    #[inertia]
    inertia: Vector3<f64>,
}

impl<F: Fault> Generated<SymplecticEulerA<SecondKind>> for Faulty<Turning, F> {
    type Kernel<T: Scalar> = FaultyKernel<<Turning as Generated<SymplecticEulerA<SecondKind>>>::Kernel<T>, F>;
}

impl<F: Fault> LinearizedSchemes for Faulty<Turning, F> {}

impl<F: Fault> Schemes for Faulty<Turning, F> {
    fn visit<V: Visitor<Self>>(map: RetractionKind, rule: Rule, visitor: V) -> Option<V::Output> {
        let is_there = (map, rule) == (RetractionKind::SecondKind, Rule::Family(0, 1));
        is_there.then(|| visitor.visit::<SymplecticEulerA<SecondKind>>())
    }
}

#[test]
fn wrong_coordinates_of_the_second_kind_are_found() {
    fn bent<F: Fault>(bend: impl FnOnce(Faulty<Turning, F>) -> Faulty<Turning, F>) -> Vec<String> {
        let turning = Turning { inertia: vector![1.0, 2.0, 2.5] };
        let attitude = UnitQuaternion::from_scaled_axis(vector![0.3, -0.2, 0.5]);
        let state =
            TurningState { attitude, momentum: vector![0.1, 0.5, -0.5], gamma: vector![0.3, 0.1, 0.9] };
        broken_of(&bend(Faulty::new(turning)), &state)
    }
    assert!(bent::<()>(|turning| turning).is_empty());
    let swapped = bent::<()>(|turning| {
        turning.with_displacement(|turning, state, _, by| {
            turning.displace(state, RetractionKind::Exponential, by)
        })
    });
    let laws = ["definition", "derivative", "coadjoint action", "spaces"];
    assert_eq!(swapped, laws.map(|law| format!("second kind: {law}")));
    assert_eq!(bent::<Right>(|turning| turning), ["second kind: derivative"]);
    assert_eq!(
        bent::<Momentum>(|turning| turning),
        ["second kind: coadjoint action", "second kind: Casimirs"]
    );
}

#[test]
fn what_leaves_the_group_is_found() {
    let off = broken::<()>(|drop| {
        drop.with_displacement(|drop, state, map, by| {
            let mut next = drop.displace(state, map, by);
            next.element *= 1.0 + 1e-9 * by[0].abs();
            next
        })
    });
    for map in ["exponential", "Cayley"] {
        for law in ["on the group", "inverse"] {
            assert!(off.contains(&format!("{map}: {law}")), "{off:?}");
        }
    }
}

#[test]
fn a_wrong_bracket_is_found() {
    // of the algebra, which is no Lie algebra then
    let algebra = broken::<()>(|drop| {
        drop.with_vector(|drop, state, covector| {
            let mut vector = drop.hamiltonian_vector(state, covector);
            vector[3] += 1e-6 * covector[4] * state.momentum.z;
            vector
        })
    });
    for law in ["antisymmetry", "Jacobi identity", "commutators", "exponential: series"] {
        assert!(algebra.iter().any(|broken| broken == law), "{law}: {algebra:?}");
    }
    // of the space, which is no representation then
    let space = broken::<()>(|drop| {
        drop.with_vector(|drop, state, covector| {
            let mut vector = drop.hamiltonian_vector(state, covector);
            vector[6..].iter_mut().for_each(|x| *x *= 1.0 + 1e-6);
            vector
        })
    });
    for law in ["Jacobi identity", "exponential: spaces", "Cayley: spaces"] {
        assert!(space.iter().any(|broken| broken == law), "{law}: {space:?}");
    }
}

#[test]
fn a_wrong_casimir_is_found() {
    let wrong = broken::<()>(|drop| {
        drop.with_casimirs(|drop, state| {
            drop.casimirs(state).map(|casimir| casimir + 1e-6 * state.momentum.x)
        })
    });
    assert_eq!(wrong, ["exponential: Casimirs", "Cayley: Casimirs"]);
}

/// A right side that is a little wrong.
#[derive(Clone, Copy)]
struct Right;

impl Fault for Right {
    fn right<T: Scalar>(right: &mut [T]) {
        right[1] = right[1] * T::of(1.0 + 1e-6);
    }
}

/// A momentum after the step that is a little wrong.
#[derive(Clone, Copy)]
struct Momentum;

impl Fault for Momentum {
    fn next<T: Scalar>(next: &mut [T]) {
        next[5] = next[5] * T::of(1.0 + 1e-6);
    }
}

/// An advected parameter after the step that is a little wrong.
#[derive(Clone, Copy)]
struct Mark;

impl Fault for Mark {
    fn next<T: Scalar>(next: &mut [T]) {
        next[7] = next[7] * T::of(1.0 + 1e-6);
    }
}

#[test]
fn a_wrong_kernel_is_found() {
    let of_both = |laws: &[&str]| -> Vec<String> {
        let named = |map: &'static str| laws.iter().map(move |law| format!("{map}: {law}"));
        named("exponential").chain(named("Cayley")).collect()
    };
    assert_eq!(broken::<Right>(|drop| drop), of_both(&["derivative"]));
    assert_eq!(broken::<Momentum>(|drop| drop), of_both(&["coadjoint action", "Casimirs"]));
    assert_eq!(broken::<Mark>(|drop| drop), of_both(&["spaces", "Casimirs"]));
}

#[test]
fn laws_are_not_measured_off_the_group() {
    let (drop, state) = drop();
    let off = DropState { element: Matrix2::identity() * 2.0, ..state };
    let error = group_laws(&drop, &off).unwrap_err();
    assert!(matches!(error, CertifyError::Step { source: StepError::NotOnGroup { .. }, .. }), "{error}");
    let heavy = Drop { inertia: vector![1.0, -2.0, 2.0], stiffness: 1.0 };
    assert!(matches!(group_laws(&heavy, &state), Err(CertifyError::Parameter(_))));
}
