//! Free bodies on groups of which nothing is known but a basis, held against an integration of `g' = g ξ`, `μ' = ad*_ξ μ` by matrices alone.

use coadjoint::SchemeType;
use coadjoint::certify::certify;
use coadjoint::erased;
use coadjoint::nalgebra::{DMatrix, DVector};
use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_support::families::of_family;

use crate::reference::reference;

/// A free body on a group: its type, its example, and the matrices of its basis.
macro_rules! body {
    ($name:ident, $state:ident, ($($group:tt)+), $retraction:ident, $rows:literal, $dimension:literal, $inertia:expr, $momentum:expr) => {
        #[lie_poisson_system(group = $($group)+, retractions($retraction))]
        struct $name {
            #[inertia]
            inertia: SVector<f64, $dimension>,
        }

        impl Example for $name {
            type Retraction = $retraction;

            fn example() -> (Self, $state) {
                let (inertia, momentum) = (SVector::from($inertia), SVector::from($momentum));
                (Self { inertia }, $state { element: SMatrix::<f64, $rows, $rows>::identity(), momentum })
            }
        }
    };
}

trait Example: System<Scalar = f64> + Sized {
    type Retraction;
    fn example() -> (Self, Self::State);
}

body!(
    Rotations4,
    Rotations4State,
    (SO(4)),
    Exponential,
    4,
    6,
    [1.0, 2.5, 1.9, 1.3, 2.8, 2.2],
    [-0.07, 0.23, 0.03, -0.17, 0.13, -0.07]
);
body!(Lorentz, LorentzState, (SO(2, 1)), Exponential, 3, 3, [1.0, 2.5, 1.9], [0.4, 0.05, -0.07]);
// near rotations: free motions of maps that stretch leave the numbers of a double
body!(
    Volume3,
    Volume3State,
    (SL(3)),
    Exponential,
    3,
    8,
    [1.3, 1.6, 1.0, 1.5, 1.0, 2.0, 1.5, 2.0],
    [0.01, -0.02, 0.3, 0.02, -0.3, 0.03, -0.02, -0.01]
);
body!(
    Symplectic,
    SymplecticState,
    (SP(4)),
    Cayley,
    4,
    10,
    [1.0, 1.4, 1.4, 1.7, 1.2, 1.5, 1.9, 1.2, 1.5, 1.9],
    [0.01, 0.02, -0.02, 0.01, 0.3, 0.01, 0.2, -0.3, -0.01, -0.2]
);
body!(
    Unitary,
    UnitaryState,
    (SU(3)),
    Exponential,
    6,
    8,
    [1.0, 1.3, 1.7, 1.2, 1.5, 1.9, 1.6, 1.1],
    [0.3, -0.2, 0.5, 0.1, 0.4, -0.3, 0.2, 0.6]
);
body!(
    Galilei,
    GalileiState,
    (SGal(3)),
    Exponential,
    5,
    10,
    [1.0, 2.5, 1.9, 1.3, 2.8, 2.2, 1.6, 1.0, 2.5, 1.9],
    [-0.07, 0.23, 0.03, -0.17, 0.13, -0.07, 0.23, 0.03, -0.17, 0.13]
);
body!(Area, AreaState, (SL(2)), Cayley, 2, 3, [1.0, 2.5, 1.9], [0.02, 0.3, -0.25]);
body!(
    Vehicle,
    VehicleState,
    (SE2(3)),
    Cayley,
    5,
    9,
    [1.0, 2.5, 1.9, 1.3, 2.8, 2.2, 1.6, 1.0, 2.5],
    [-0.07, 0.23, 0.03, -0.17, 0.13, -0.07, 0.23, 0.03, -0.17]
);
body!(Heisenberg, HeisenbergState, (Heisenberg), Cayley, 3, 3, [1.0, 2.5, 1.9], [-0.07, 0.23, 0.13]);
body!(Affine, AffineState, (Aff(1)), Exponential, 2, 2, [1.0, 2.5], [-0.07, 0.23]);
body!(Linear, LinearState, (GL(2)), Exponential, 2, 4, [1.0, 2.5, 1.9, 1.3], [-0.07, 0.23, 0.03, -0.17]);
body!(Both, BothState, (product(turn: SO3, shear: SL(2))), Exponential, 5, 6,
    [1.0, 2.5, 1.9, 1.3, 2.8, 2.2], [-0.07, 0.23, 0.03, -0.17, 0.13, -0.07]);
body!(
    Tangent,
    TangentState,
    (tangent(SO3)),
    Exponential,
    6,
    6,
    [1.0, 2.5, 1.9, 1.3, 2.8, 2.2],
    [-0.07, 0.23, 0.03, -0.17, 0.13, -0.07]
);
body!(Planes, PlanesState, (semidirect(turn: SL(2), v: R2, w: dual(R2))), Exponential, 6, 7,
    [1.0, 2.5, 1.9, 1.3, 2.8, 2.2, 1.6], [-0.07, 0.23, 0.03, -0.17, 0.13, -0.07, 0.23]);

/// Both as blocks.
fn beside(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let (m, n) = (a.nrows(), b.nrows());
    let mut whole = DMatrix::zeros(m + n, m + n);
    whole.view_mut((0, 0), (m, m)).copy_from(a);
    whole.view_mut((m, m), (n, n)).copy_from(b);
    whole
}

fn unit(n: usize, i: usize, j: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |r, c| f64::from((r, c) == (i, j)))
}

/// `X` of the rotations, `Y` of the plane: `diag(X, Y)`.
fn both() -> Vec<DMatrix<f64>> {
    let (turn, shear) = (of_family("SO3", 3), of_family("SL2", 3));
    let of_turn = turn.iter().map(|x| beside(x, &DMatrix::zeros(2, 2)));
    of_turn.chain(shear.iter().map(|y| beside(&DMatrix::zeros(3, 3), y))).collect()
}

/// `[[X, Y], [0, X]]`
fn tangent() -> Vec<DMatrix<f64>> {
    let turn = of_family("SO3", 3);
    let corner = |y: &DMatrix<f64>| {
        let mut whole = DMatrix::zeros(6, 6);
        whole.view_mut((0, 3), (3, 3)).copy_from(y);
        whole
    };
    turn.iter().map(|x| beside(x, x)).chain(turn.iter().map(corner)).collect()
}

/// `diag([[X, v], [0, 0]], [[−Xᵀ, w], [0, 0]])`
fn planes() -> Vec<DMatrix<f64>> {
    let grown = |x: &DMatrix<f64>| beside(x, &DMatrix::zeros(1, 1));
    let turn = of_family("SL2", 3);
    let of_turn = turn.iter().map(|x| beside(&grown(x), &grown(&-x.transpose())));
    of_turn.chain([(0, 2), (1, 2), (3, 5), (4, 5)].map(|(i, j)| unit(6, i, j))).collect()
}

/// Element, by rows, and momentum after some time: `g' = g X`, `μ'_j = μ · coordinates([X, E_j])`, by RK4, extrapolated.
fn integrated(basis: &[DMatrix<f64>], inertia: &[f64], state: &[f64], time: f64) -> DVector<f64> {
    let (d, n) = (basis.len(), basis[0].nrows());
    let columns = DMatrix::from_fn(n * n, d, |k, j| basis[j][(k / n, k % n)]);
    let coordinates = columns.clone().pseudo_inverse(1e-12).expect("independent");
    let field = |state: &DVector<f64>| {
        let g = DMatrix::from_row_slice(n, n, &state.as_slice()[..n * n]);
        let momentum = state.rows(n * n, d);
        let x = (0..d).fold(DMatrix::zeros(n, n), |x, i| x + &basis[i] * (momentum[i] / inertia[i]));
        let change = |j: usize| {
            let bracket = &x * &basis[j] - &basis[j] * &x;
            let entries = DVector::from_row_slice(bracket.transpose().as_slice());
            (&coordinates * entries).dot(&momentum)
        };
        let moved = (g * &x).transpose();
        DVector::from_iterator(n * n + d, moved.iter().copied().chain((0..d).map(change)))
    };
    reference(&DVector::from_row_slice(state), time, 60, field)
}

/// What certificates say of it.
fn certified<S>()
where
    S: Example + coadjoint::__private::Geometry<Scalar = f64> + Discretized<S::Retraction> + erased::System,
    S::Retraction: SchemeType,
{
    let (system, start) = S::example();
    let report = certify::<S::Retraction, S>(&system, &[start]).expect("measurable");
    assert!(report.passed(), "{report}");
}

/// The orders of steps against an integration that knows nothing but matrices.
fn holds<S>(basis: &[DMatrix<f64>], inertia: impl Fn(&S) -> Vec<f64>)
where
    S: Example + Discretized<S::Retraction> + Discretized<Order6<S::Retraction>>,
{
    let (system, start) = S::example();
    let exact = integrated(basis, &inertia(&system), start.to_components().as_ref(), 1.0);
    fn error<M, S>(system: &S, start: &S::State, exact: &DVector<f64>, steps: u32) -> f64
    where
        S: System<Scalar = f64> + Discretized<M>,
    {
        let mut state = start.clone();
        let mut stepper = system.stepper::<M>(1.0 / f64::from(steps)).expect("valid");
        for _ in 0..steps {
            stepper.step(&mut state).expect("a step");
        }
        (DVector::from_row_slice(state.to_components().as_ref()) - exact).norm()
    }
    let name = std::any::type_name::<S>();
    let errors = [16, 32, 64].map(|steps| error::<S::Retraction, S>(&system, &start, &exact, steps));
    let slope = (errors[0] / errors[2]).log2() / 2.0;
    assert!((slope - 2.0).abs() < 0.05, "{name}: order {slope}, {errors:?}");
    let errors = [2, 4, 8].map(|steps| error::<Order6<S::Retraction>, S>(&system, &start, &exact, steps));
    let slope = (errors[0] / errors[1]).log2();
    assert!((slope - 6.0).abs() < 0.15, "{name}: order {slope}, {errors:?}");
    let last = error::<Order6<S::Retraction>, S>(&system, &start, &exact, 24);
    assert!(last < 1e-12, "{name}: {last:e}");
    println!("{name}: order {slope:.2}, {last:.1e}");
}

/// The Casimirs after 2e4 steps.
fn keeps<S>(step: f64, count: usize)
where
    S: Example + Discretized<S::Retraction>,
{
    let (system, mut state) = S::example();
    let mut stepper = system.stepper::<S::Retraction>(step).expect("valid");
    let before = system.casimirs(&state);
    assert_eq!(before.as_ref().len(), count);
    for _ in 0..20_000 {
        stepper.step(&mut state).expect("a step");
    }
    let after = system.casimirs(&state);
    for (after, before) in after.as_ref().iter().zip(before.as_ref()) {
        let size = 1.0 + before.abs();
        assert!((after - before).abs() < 5e-13 * size, "{}: {after} {before}", std::any::type_name::<S>());
    }
}

#[test]
fn rotations_of_four_dimensions() {
    certified::<Rotations4>();
    holds::<Rotations4>(&of_family("SO4", 6), |body| body.inertia.as_slice().to_vec());
    keeps::<Rotations4>(0.1, 2);
}

#[test]
fn rotations_and_boosts_of_the_plane() {
    certified::<Lorentz>();
    holds::<Lorentz>(&of_family("SO21", 3), |body| body.inertia.as_slice().to_vec());
    keeps::<Lorentz>(0.01, 1);
}

#[test]
fn maps_that_keep_volume() {
    certified::<Volume3>();
    holds::<Volume3>(&of_family("SL3", 8), |body| body.inertia.as_slice().to_vec());
    keeps::<Volume3>(0.01, 2);
}

#[test]
fn symplectic_maps() {
    certified::<Symplectic>();
    holds::<Symplectic>(&of_family("SP4", 10), |body| body.inertia.as_slice().to_vec());
    keeps::<Symplectic>(0.01, 2);
}

#[test]
fn unitary_maps() {
    certified::<Unitary>();
    holds::<Unitary>(&of_family("SU3", 8), |body| body.inertia.as_slice().to_vec());
    keeps::<Unitary>(0.1, 2);
}

#[test]
fn changes_of_inertial_frame() {
    certified::<Galilei>();
    holds::<Galilei>(&of_family("SGal3", 10), |body| body.inertia.as_slice().to_vec());
    keeps::<Galilei>(1e-4, 2);
}

#[test]
fn maps_that_keep_areas() {
    certified::<Area>();
    holds::<Area>(&of_family("SL2", 3), |body| body.inertia.as_slice().to_vec());
    keeps::<Area>(0.01, 1);
}

#[test]
fn attitudes_velocities_and_positions() {
    certified::<Vehicle>();
    holds::<Vehicle>(&of_family("SE23", 9), |body| body.inertia.as_slice().to_vec());
    keeps::<Vehicle>(1e-3, 3);
}

#[test]
fn heisenbergs_group() {
    certified::<Heisenberg>();
    holds::<Heisenberg>(&of_family("Heisenberg", 3), |body| body.inertia.as_slice().to_vec());
    keeps::<Heisenberg>(0.1, 1);
}

#[test]
fn affine_maps_of_the_line() {
    certified::<Affine>();
    holds::<Affine>(&of_family("Aff1", 2), |body| body.inertia.as_slice().to_vec());
}

#[test]
fn all_regular_maps_of_the_plane() {
    certified::<Linear>();
    holds::<Linear>(&of_family("GL2", 4), |body| body.inertia.as_slice().to_vec());
    keeps::<Linear>(1e-5, 2);
}

#[test]
fn a_product_of_groups() {
    certified::<Both>();
    holds::<Both>(&both(), |body| body.inertia.as_slice().to_vec());
    keeps::<Both>(1e-5, 2);
}

#[test]
fn a_tangent_group() {
    certified::<Tangent>();
    holds::<Tangent>(&tangent(), |body| body.inertia.as_slice().to_vec());
    keeps::<Tangent>(1e-2, 2);
}

#[test]
fn a_semidirect_product() {
    certified::<Planes>();
    holds::<Planes>(&planes(), |body| body.inertia.as_slice().to_vec());
    keeps::<Planes>(1e-5, 1);
}

/// The same body on a group of the catalogue and on that of its basis: what they are called, the second one's basis, retraction and dimension.
macro_rules! same {
    ($closed:ident on $group:ident, $derived:ident on { $($basis:tt)* }, $retraction:ident, $dimension:literal) => {
        #[lie_poisson_system(group = $group, retractions($retraction))]
        struct $closed {
            #[inertia]
            inertia: SMatrix<f64, $dimension, $dimension>,
        }

        #[lie_poisson_system(group = matrices { $($basis)* }, retractions($retraction))]
        struct $derived {
            #[inertia]
            inertia: SMatrix<f64, $dimension, $dimension>,
        }
    };
}

same!(ClosedTurn on SO3, DerivedTurn on {
    x: [0, 0, 0; 0, 0, -1; 0, 1, 0], y: [0, 0, 1; 0, 0, 0; -1, 0, 0], z: [0, -1, 0; 1, 0, 0; 0, 0, 0]
}, Cayley, 3);
same!(ClosedPlane on SE2, DerivedPlane on {
    turn: [0, -1, 0; 1, 0, 0; 0, 0, 0], x: [0, 0, 1; 0, 0, 0; 0, 0, 0], y: [0, 0, 0; 0, 0, 1; 0, 0, 0]
}, Exponential, 3);
same!(ClosedSpace on SE3, DerivedSpace on {
    x: [0, 0, 0, 0; 0, 0, -1, 0; 0, 1, 0, 0; 0, 0, 0, 0],
    y: [0, 0, 1, 0; 0, 0, 0, 0; -1, 0, 0, 0; 0, 0, 0, 0],
    z: [0, -1, 0, 0; 1, 0, 0, 0; 0, 0, 0, 0; 0, 0, 0, 0],
    a: [0, 0, 0, 1; 0, 0, 0, 0; 0, 0, 0, 0; 0, 0, 0, 0],
    b: [0, 0, 0, 0; 0, 0, 0, 1; 0, 0, 0, 0; 0, 0, 0, 0],
    c: [0, 0, 0, 0; 0, 0, 0, 0; 0, 0, 0, 1; 0, 0, 0, 0]
}, Exponential, 6);
// the units i, j, k: twice the axes of the catalogue
same!(ClosedSpin on SU2, DerivedSpin on {
    i: [0, -1, 0, 0; 1, 0, 0, 0; 0, 0, 0, -1; 0, 0, 1, 0],
    j: [0, 0, -1, 0; 0, 0, 0, 1; 1, 0, 0, 0; 0, -1, 0, 0],
    k: [0, 0, 0, -1; 0, 0, -1, 0; 0, 1, 0, 0; 1, 0, 0, 0]
}, Exponential, 3);
same!(ClosedPoint on R3, DerivedPoint on {
    x: [0, 0, 0, 1; 0, 0, 0, 0; 0, 0, 0, 0; 0, 0, 0, 0],
    y: [0, 0, 0, 0; 0, 0, 0, 1; 0, 0, 0, 0; 0, 0, 0, 0],
    z: [0, 0, 0, 0; 0, 0, 0, 0; 0, 0, 0, 1; 0, 0, 0, 0]
}, Exponential, 3);

/// Both after 200 steps of a tenth of a second: the element as a matrix, and the momentum in the axes of the catalogue.
fn same<C, D, M>(
    (closed, mut of_closed): (C, C::State),
    (derived, mut of_derived): (D, D::State),
    matrix: impl Fn(&C::State) -> DMatrix<f64>,
    axes: f64,
) where
    C: Discretized<M> + System<Scalar = f64>,
    D: Discretized<M> + System<Scalar = f64>,
{
    let mut of = (closed.stepper::<M>(0.1).expect("valid"), derived.stepper::<M>(0.1).expect("valid"));
    let mut moved = 0.0_f64;
    for _ in 0..200 {
        of.0.step(&mut of_closed).expect("a step");
        of.1.step(&mut of_derived).expect("a step");
        let (components, expected) = (of_derived.to_components(), matrix(&of_closed));
        let (element, momentum) = components.as_ref().split_at(expected.len());
        let element = DMatrix::from_row_slice(expected.nrows(), expected.ncols(), element);
        let expected_momentum = of_closed.to_components();
        let expected_momentum = expected_momentum.as_ref();
        let expected_momentum = &expected_momentum[expected_momentum.len() - momentum.len()..];
        let error = (&element - &expected).amax() / expected.amax();
        assert!(error < 1e-13, "{}: {error:e}", C::NAME);
        for (found, expected) in momentum.iter().zip(expected_momentum) {
            assert!((found / axes - expected).abs() < 1e-13, "{}: {found} {expected}", C::NAME);
        }
        moved = moved.max((expected - DMatrix::identity(element.nrows(), element.ncols())).amax());
    }
    assert!(moved > 0.5, "{}: {moved}", C::NAME);
}

#[test]
fn bases_give_the_steps_of_closed_forms() {
    fn inertia<const N: usize>() -> SMatrix<f64, N, N> {
        SMatrix::from_fn(|i, j| if i == j { 1.0 + 0.3 * i as f64 } else { 0.1 / (1 + i + j) as f64 })
    }
    let momentum = SVector::from([0.5, -0.4, 0.7]);
    let identity = SMatrix::<f64, 3, 3>::identity();
    let large = SMatrix::<f64, 4, 4>::identity();
    same::<_, _, Cayley>(
        (
            ClosedTurn { inertia: inertia() },
            ClosedTurnState { attitude: UnitQuaternion::identity(), momentum },
        ),
        (DerivedTurn { inertia: inertia() }, DerivedTurnState { element: identity, momentum }),
        |state| DMatrix::from_column_slice(3, 3, state.attitude.to_rotation_matrix().matrix().as_slice()),
        1.0,
    );
    same::<_, _, Exponential>(
        (ClosedPlane { inertia: inertia() }, ClosedPlaneState { pose: Isometry2::identity(), momentum }),
        (DerivedPlane { inertia: inertia() }, DerivedPlaneState { element: identity, momentum }),
        |state| DMatrix::from_column_slice(3, 3, state.pose.to_homogeneous().as_slice()),
        1.0,
    );
    let wrench = SVector::from([0.5, -0.4, 0.7, 0.1, 0.6, -0.2]);
    same::<_, _, Exponential>(
        (
            ClosedSpace { inertia: inertia() },
            ClosedSpaceState { pose: Isometry3::identity(), momentum: wrench },
        ),
        (DerivedSpace { inertia: inertia() }, DerivedSpaceState { element: large, momentum: wrench }),
        |state| DMatrix::from_column_slice(4, 4, state.pose.to_homogeneous().as_slice()),
        1.0,
    );
    same::<_, _, Exponential>(
        (ClosedSpin { inertia: inertia() }, ClosedSpinState { spin: UnitQuaternion::identity(), momentum }),
        (
            DerivedSpin { inertia: inertia() * 4.0 },
            DerivedSpinState { element: large, momentum: momentum * 2.0 },
        ),
        |state| {
            let q = state.spin;
            DMatrix::from_row_slice(
                4,
                4,
                &[q.w, -q.i, -q.j, -q.k, q.i, q.w, -q.k, q.j, q.j, q.k, q.w, -q.i, q.k, -q.j, q.i, q.w],
            )
        },
        2.0,
    );
    same::<_, _, Exponential>(
        (ClosedPoint { inertia: inertia() }, ClosedPointState { position: Vector3::zeros(), momentum }),
        (DerivedPoint { inertia: inertia() }, DerivedPointState { element: large, momentum }),
        |state| {
            let mut element = DMatrix::identity(4, 4);
            element.view_mut((0, 3), (3, 1)).copy_from(&state.position);
            element
        },
        1.0,
    );
}
