//! Matrix groups: each says what its algebra looks like, and all else follows by definition.

use core::marker::PhantomData;

use nalgebra::linalg::try_invert_to;
use nalgebra::{Matrix2, Matrix3, Matrix4, SMatrix, SVector, Vector1, Vector3};

use coadjoint::matrix;

/// A Lie group of `N × N` matrices, with coordinates `R^D` on its Lie algebra.
///
/// An implementation chooses the coordinates; all else follows by definition. What needs the inverse of a matrix is
/// `None` if that matrix has none.
pub trait MatrixGroup<const N: usize, const D: usize> {
    /// The matrix in the Lie algebra with coordinates `x`.
    fn hat(x: &SVector<f64, D>) -> SMatrix<f64, N, N>;

    /// The coordinates of a matrix in the Lie algebra: `vee(hat(x)) = x`.
    ///
    /// What rounding has moved off the algebra comes back by a linear projection.
    fn vee(matrix: &SMatrix<f64, N, N>) -> SVector<f64, D>;

    /// Whether [`exp`](Self::exp) is a local diffeomorphism on the whole way from 0 to `x`: no eigenvalue of `ad_x` is
    /// a multiple of `2πi` there, except 0.
    fn exp_is_regular(x: &SVector<f64, D>) -> bool;

    /// The bracket `[x, y]`, by the commutator of matrices.
    fn bracket(x: &SVector<f64, D>, y: &SVector<f64, D>) -> SVector<f64, D> {
        let (x, y) = (Self::hat(x), Self::hat(y));
        Self::vee(&(x * y - y * x))
    }

    /// The matrix of `ad_x: y ↦ [x, y]`.
    fn ad(x: &SVector<f64, D>) -> SMatrix<f64, D, D> {
        columns(|y| Self::bracket(x, y))
    }

    /// `g⁻¹`.
    fn inverse(g: &SMatrix<f64, N, N>) -> Option<SMatrix<f64, N, N>> {
        inverse(g)
    }

    /// The matrix of `Ad_g: x ↦ vee(g hat(x) g⁻¹)`.
    fn adjoint(g: &SMatrix<f64, N, N>) -> Option<SMatrix<f64, D, D>> {
        let inverse = Self::inverse(g)?;
        Some(columns(|x| Self::vee(&(g * Self::hat(x) * inverse))))
    }

    /// `Ad*_g μ`, the transpose of `Ad_g`: `⟨Ad*_g μ, x⟩ = ⟨μ, Ad_g x⟩`.
    fn coadjoint(g: &SMatrix<f64, N, N>, mu: &SVector<f64, D>) -> Option<SVector<f64, D>> {
        Some(Self::adjoint(g)?.tr_mul(mu))
    }

    /// The exponential `exp(x) = Σ X^k / k!` with `X = hat(x)`.
    fn exp(x: &SVector<f64, D>) -> SMatrix<f64, N, N> {
        let x = Self::hat(x);
        SMatrix::identity() + x * phi1(&x)
    }

    /// The matrix of the exponential's right logarithmic derivative, `dR exp_x = Σ ad_x^k / (k+1)!`.
    fn exp_derivative(x: &SVector<f64, D>) -> SMatrix<f64, D, D> {
        phi1(&Self::ad(x))
    }

    /// The Cayley map `(I − X/2)⁻¹ (I + X/2)` with `X = hat(x)`.
    ///
    /// It leads into the group only for groups given by a quadratic relation `gᵀ J g = J`, and their semidirect
    /// products with representations.
    fn cayley(x: &SVector<f64, D>) -> Option<SMatrix<f64, N, N>> {
        let half = Self::hat(x) * 0.5;
        Some(Self::inverse(&(SMatrix::identity() - half))? * (SMatrix::identity() + half))
    }

    /// The matrix of the Cayley map's right logarithmic derivative,
    /// `dR cay_x y = vee((I − X/2)⁻¹ hat(y) (I + X/2)⁻¹)` with `X = hat(x)`.
    fn cayley_derivative(x: &SVector<f64, D>) -> Option<SMatrix<f64, D, D>> {
        let half = Self::hat(x) * 0.5;
        let left = Self::inverse(&(SMatrix::identity() - half))?;
        let right = Self::inverse(&(SMatrix::identity() + half))?;
        Some(columns(|y| Self::vee(&(left * Self::hat(y) * right))))
    }
}

/// The inverse, by LU factorization at every order.
///
/// Up to order 4, [`SMatrix::try_inverse`] divides cofactors by the determinant. That moves the constant last rows of
/// semidirect products by a rounding which does not average out: the Casimirs then drift linearly.
pub(super) fn inverse<const M: usize>(matrix: &SMatrix<f64, M, M>) -> Option<SMatrix<f64, M, M>> {
    let mut inverse = SMatrix::zeros();
    try_invert_to(*matrix, &mut inverse).then_some(inverse)
}

/// The matrix of a linear map.
fn columns<const D: usize>(map: impl Fn(&SVector<f64, D>) -> SVector<f64, D>) -> SMatrix<f64, D, D> {
    let mut matrix = SMatrix::<f64, D, D>::zeros();
    for j in 0..D {
        let mut basis = SVector::<f64, D>::zeros();
        basis[j] = 1.0;
        matrix.set_column(j, &map(&basis));
    }
    matrix
}

/// `φ₁(A) = Σ A^k / (k+1)!`, so that `exp A = I + A φ₁(A)`.
///
/// The series itself loses digits to cancellation once `‖A‖` is a few units. So it is summed for `A / 2ⁿ`, and the
/// argument doubled `n` times: `exp 2B = (exp B)²` says `φ₁(2B) = φ₁(B) + ½ B φ₁(B)²`.
fn phi1<const M: usize>(a: &SMatrix<f64, M, M>) -> SMatrix<f64, M, M> {
    let norm = a.norm();
    if !norm.is_finite() {
        return SMatrix::repeat(f64::NAN);
    }
    let mut doublings = 0;
    let mut scale = 1.0;
    while norm * scale > 0.5 {
        scale *= 0.5;
        doublings += 1;
    }
    let mut b = a * scale;

    let mut sum = SMatrix::<f64, M, M>::identity();
    let mut term = sum;
    let mut divisor = 2.0;
    while term.amax() > 0.1 * f64::EPSILON {
        term = term * b / divisor;
        sum += term;
        divisor += 1.0;
    }
    for _ in 0..doublings {
        sum += b * sum * sum * 0.5;
        b *= 2.0;
    }
    sum
}

/// The rotations of space, `R⁻¹ = Rᵀ`, with `hat(x) y = x × y`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SO3;

impl MatrixGroup<3, 3> for SO3 {
    fn hat(x: &Vector3<f64>) -> Matrix3<f64> {
        x.cross_matrix()
    }

    fn vee(matrix: &Matrix3<f64>) -> Vector3<f64> {
        let skew = matrix - matrix.transpose();
        Vector3::new(skew.m32, skew.m13, skew.m21) * 0.5
    }

    fn exp_is_regular(x: &Vector3<f64>) -> bool {
        x.norm() < core::f64::consts::TAU
    }
}

/// SO(3) ⋉ (R³)^K, whose dual carries the body momentum and `K` advected vectors; `K` is 1, 2 or 3.
///
/// As matrices of order `3 + K`, with coordinates `(ξ, w₁, …, w_K)` on the algebra:
///
/// ```text
/// g = [ R  p₁ … p_K ]        hat(ξ, w) = [ hat(ξ)  w₁ … w_K ]
///     [ 0      I    ]                    [   0         0    ]
/// ```
///
/// The dual coordinates are `(Π, a₁, …, a_K)`, with `Ad*_g (Π, a) = (Rᵀ(Π + Σ aᵢ × pᵢ), Rᵀa₁, …, Rᵀa_K)`; the
/// Lie–Poisson equations read `Π' = Π × Ω + Σ aᵢ × ∂h/∂aᵢ`, `aᵢ' = aᵢ × Ω`, with `Ω = ∂h/∂Π`. The translations `pᵢ` are
/// not part of the motion: only `R` has a mechanical meaning. With `K = 1` the group is SE(3), and a system that moves there has its position in
/// `p₁` and its linear momentum, in the body, in `a₁`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SO3Semidirect<const K: usize>;

macro_rules! so3_semidirect {
    // stable Rust cannot compute 3 + K and 3 + 3 K itself
    ($(($k:literal, $n:literal, $d:literal)),*) => {
        $(impl MatrixGroup<$n, $d> for SO3Semidirect<$k> {
            fn hat(x: &SVector<f64, $d>) -> SMatrix<f64, $n, $n> {
                let mut matrix = SMatrix::<f64, $n, $n>::zeros();
                matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&SO3::hat(&x.fixed_rows::<3>(0).into_owned()));
                for i in 0..$k {
                    matrix.fixed_view_mut::<3, 1>(0, 3 + i).copy_from(&x.fixed_rows::<3>(3 + 3 * i));
                }
                matrix
            }

            fn vee(matrix: &SMatrix<f64, $n, $n>) -> SVector<f64, $d> {
                let mut x = SVector::<f64, $d>::zeros();
                x.fixed_rows_mut::<3>(0).copy_from(&SO3::vee(&matrix.fixed_view::<3, 3>(0, 0).into_owned()));
                for i in 0..$k {
                    x.fixed_rows_mut::<3>(3 + 3 * i).copy_from(&matrix.fixed_view::<3, 1>(0, 3 + i));
                }
                x
            }

            // ad_(ξ, w) is block triangular with ad_ξ on its diagonal
            fn exp_is_regular(x: &SVector<f64, $d>) -> bool {
                SO3::exp_is_regular(&x.fixed_rows::<3>(0).into_owned())
            }
        })*
    };
}
so3_semidirect!((1, 4, 6), (2, 5, 9), (3, 6, 12));

/// The space `R^K` with its addition, as matrices of order `K + 1`; `K` is 1 to 6.
///
/// ```text
/// g = [ 1  x ]        hat(v) = [ 0  v ]
///     [ 0  1 ]                 [ 0  0 ]
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Translations<const K: usize>;

macro_rules! translations {
    ($(($k:literal, $n:literal)),*) => {
        $(impl MatrixGroup<$n, $k> for Translations<$k> {
            fn hat(x: &SVector<f64, $k>) -> SMatrix<f64, $n, $n> {
                let mut matrix = SMatrix::<f64, $n, $n>::zeros();
                matrix.fixed_view_mut::<$k, 1>(0, $k).copy_from(x);
                matrix
            }

            fn vee(matrix: &SMatrix<f64, $n, $n>) -> SVector<f64, $k> {
                matrix.fixed_view::<$k, 1>(0, $k).into_owned()
            }

            fn exp_is_regular(_: &SVector<f64, $k>) -> bool {
                true
            }
        })*
    };
}
translations!((1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 7));

/// The rotations of the plane, from the x towards the y axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SO2;

impl MatrixGroup<2, 1> for SO2 {
    fn hat(x: &Vector1<f64>) -> Matrix2<f64> {
        matrix![0.0, -x.x; x.x, 0.0]
    }

    fn vee(matrix: &Matrix2<f64>) -> Vector1<f64> {
        Vector1::new((matrix.m21 - matrix.m12) * 0.5)
    }

    fn exp_is_regular(_: &Vector1<f64>) -> bool {
        true
    }
}

/// The rigid motions of the plane, with coordinates `(ω, v)` on the algebra: angular, then linear velocity.
///
/// ```text
/// g = [ R  p ]        hat(ω, v) = [ ωJ  v ]        J = [ 0 −1 ]
///     [ 0  1 ]                    [ 0   0 ]            [ 1  0 ]
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SE2;

impl MatrixGroup<3, 3> for SE2 {
    fn hat(x: &Vector3<f64>) -> Matrix3<f64> {
        matrix![0.0, -x[0], x[1]; x[0], 0.0, x[2]; 0.0, 0.0, 0.0]
    }

    fn vee(matrix: &Matrix3<f64>) -> Vector3<f64> {
        Vector3::new((matrix.m21 - matrix.m12) * 0.5, matrix.m13, matrix.m23)
    }

    fn exp_is_regular(x: &Vector3<f64>) -> bool {
        x[0].abs() < core::f64::consts::TAU
    }
}

/// The unit quaternions, as the real matrices by which they multiply quaternions `(w, x, y, z)` from the left; `x` in the algebra stands for the
/// pure quaternion `x/2`, so that `[x, y] = x × y`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SU2;

impl MatrixGroup<4, 3> for SU2 {
    fn hat(x: &Vector3<f64>) -> Matrix4<f64> {
        let [a, b, c] = [x.x / 2.0, x.y / 2.0, x.z / 2.0];
        matrix![
            0.0, -a, -b, -c;
            a, 0.0, -c, b;
            b, c, 0.0, -a;
            c, -b, a, 0.0
        ]
    }

    fn vee(matrix: &Matrix4<f64>) -> Vector3<f64> {
        let skew = matrix - matrix.transpose();
        Vector3::new(skew.m21 + skew.m43, skew.m31 + skew.m24, skew.m41 + skew.m32) * 0.5
    }

    fn exp_is_regular(x: &Vector3<f64>) -> bool {
        x.norm() < core::f64::consts::TAU
    }
}

/// The product of two groups, as matrices with those of the first and of the second along their diagonal; coordinates of the first come first.
///
/// The orders `NA`, `NB` of the matrices and the dimensions `DA`, `DB` follow from the groups: write [`Product::of`]`(SO3, Translations::<3>)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Product<A, B, const NA: usize, const DA: usize, const NB: usize, const DB: usize>(
    PhantomData<(A, B)>,
);

impl<A, B, const NA: usize, const DA: usize, const NB: usize, const DB: usize> Product<A, B, NA, DA, NB, DB>
where
    A: MatrixGroup<NA, DA>,
    B: MatrixGroup<NB, DB>,
{
    /// The product of these groups. They only name their types.
    pub fn of(_first: A, _second: B) -> Self {
        Self(PhantomData)
    }
}

impl<A, B, const NA: usize, const DA: usize, const NB: usize, const DB: usize, const N: usize, const D: usize>
    MatrixGroup<N, D> for Product<A, B, NA, DA, NB, DB>
where
    A: MatrixGroup<NA, DA>,
    B: MatrixGroup<NB, DB>,
{
    fn hat(x: &SVector<f64, D>) -> SMatrix<f64, N, N> {
        const { assert!(N == NA + NB && D == DA + DB, "orders and dimensions add up") }
        let mut matrix = SMatrix::<f64, N, N>::zeros();
        matrix.fixed_view_mut::<NA, NA>(0, 0).copy_from(&A::hat(&x.fixed_rows::<DA>(0).into_owned()));
        matrix.fixed_view_mut::<NB, NB>(NA, NA).copy_from(&B::hat(&x.fixed_rows::<DB>(DA).into_owned()));
        matrix
    }

    fn vee(matrix: &SMatrix<f64, N, N>) -> SVector<f64, D> {
        const { assert!(N == NA + NB && D == DA + DB, "orders and dimensions add up") }
        let mut x = SVector::<f64, D>::zeros();
        x.fixed_rows_mut::<DA>(0).copy_from(&A::vee(&matrix.fixed_view::<NA, NA>(0, 0).into_owned()));
        x.fixed_rows_mut::<DB>(DA).copy_from(&B::vee(&matrix.fixed_view::<NB, NB>(NA, NA).into_owned()));
        x
    }

    fn exp_is_regular(x: &SVector<f64, D>) -> bool {
        A::exp_is_regular(&x.fixed_rows::<DA>(0).into_owned())
            && B::exp_is_regular(&x.fixed_rows::<DB>(DA).into_owned())
    }
}
