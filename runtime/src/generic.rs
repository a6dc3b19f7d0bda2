//! A stepper written the ordinary way: traits, matrices, and Newton's iteration on a Jacobian of difference quotients.
//!
//! [`GenericStepper`] takes the same discrete steps as generated steppers, for any matrix Lie group with any
//! left-invariant Hamiltonian, but knows nothing in closed form. Everything follows from the group's
//! [`hat`](MatrixGroup::hat) map by definition: the bracket is the commutator, `Ad` a conjugation, the exponential its
//! power series. That makes it slow, and an independent check of what the generator derives. Use it to check a
//! description, to try a group or a Hamiltonian out before describing it, or as the yardstick of a measurement.
//!
//! # Conventions
//!
//! - Left trivialization: `g' = g hat(ξ)` with `ξ` in the Lie algebra, in coordinates `R^D`; the momentum `μ` in its
//!   dual, paired with `ξ` by the dot product of coordinates.
//! - `Ad_g x = vee(g hat(x) g⁻¹)` and `Ad*_g` is its transpose; on SO(3), `Ad*_R Π = R⁻¹Π`.
//! - A retraction `τ` has the right logarithmic derivative `dR τ_x y = Dτ(x)[y] τ(x)⁻¹`.
//! - The Lie–Poisson equations of `h` are `μ' = ad*_ξ μ`, `g' = g hat(ξ)`, with `ξ = ∂h/∂μ`.
//!
//! # The step
//!
//! With the step `t` and a point `s ∈ [0, 1]` between start and end, where the equation is set up, solve for `η = tξ`
//!
//! ```text
//! m = Ad*_{τ(−sη)⁻¹} μ_k                                      momentum at the intermediate point ḡ = g_k τ(sη)
//! μ̄ = (1−s) (dR τ_{(1−s)η})* m + s (dR τ_{−sη})* m
//! η = t ∂h/∂μ(μ̄)
//! ```
//!
//! and take `μ_{k+1} = Ad*_{τ((1−s)η)} m`, `g_{k+1} = ḡ τ((1−s)η)`. With `s = 0` this is equation (6.5) of V. Vivek,
//! D. Martín de Diego and R. N. Banavar, *A Geometric Approach to Structure-Preserving Integrators for Mechanical
//! Systems* (2026), which for a quadratic `h` reads `I ξ = (dL τ_{tξ})* μ_{k+1} = (dR τ_{tξ})* μ_k`. For every `s` the
//! step is a Poisson map, keeps the Casimirs, has order 2, and is undone by the step `−t`.
//!
//! # Example
//!
//! A heavy top, on SE(3) = SO(3) ⋉ R³: the vertical `Γ` seen from the body is the momentum dual to the translations.
//!
//! ```
//! use coadjoint::generic::{GenericStepper, Hamiltonian, SO3Semidirect};
//! use coadjoint::Exponential;
//! use coadjoint::nalgebra::{Matrix4, Vector3, Vector6};
//! use coadjoint::vector;
//!
//! struct HeavyTop {
//!     inertia: Vector3<f64>,
//!     /// Weight times the vector from the fixed point to the centre of mass.
//!     weight_chi: Vector3<f64>,
//! }
//!
//! impl Hamiltonian<6> for HeavyTop {
//!     fn energy(&self, mu: &Vector6<f64>) -> f64 {
//!         let (momentum, gamma) = (mu.fixed_rows::<3>(0), mu.fixed_rows::<3>(3));
//!         momentum.dot(&momentum.component_div(&self.inertia)) / 2.0 + gamma.dot(&self.weight_chi)
//!     }
//!
//!     fn gradient(&self, mu: &Vector6<f64>) -> Vector6<f64> {
//!         let velocity = mu.fixed_rows::<3>(0).component_div(&self.inertia);
//!         let chi = &self.weight_chi;
//!         vector![velocity.x, velocity.y, velocity.z, chi.x, chi.y, chi.z]
//!     }
//! }
//!
//! let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight_chi: Vector3::z() };
//! let mut g = Matrix4::identity();
//! let mut mu = vector![1.0, 1.0, 1.0, 0.0, 0.0, 1.0];
//! let before = top.energy(&mu);
//!
//! let mut stepper = GenericStepper::new(SO3Semidirect::<1>, Exponential, top, 0.01)?;
//! for _ in 0..1_000 {
//!     stepper.step(&mut g, &mut mu)?;
//! }
//!
//! let gamma = mu.fixed_rows::<3>(3);
//! assert!((gamma.norm() - 1.0).abs() < 1e-13);
//! assert!((stepper.hamiltonian().energy(&mu) - before).abs() < 1e-5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod second_kind;

use core::marker::PhantomData;

use nalgebra::linalg::try_invert_to;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use crate::error::{ParameterError, StepError};
use crate::retraction::{Cayley, Exponential};
use crate::stepper::StepReport;

/// More Newton corrections than any solvable step takes.
const MAX_ITERATIONS: u32 = 40;

/// Below this, relative to the equation's terms, a residual is rounding; it usually stagnates well below.
const ROUNDOFF: f64 = 256.0 * f64::EPSILON;

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
fn inverse<const M: usize>(matrix: &SMatrix<f64, M, M>) -> Option<SMatrix<f64, M, M>> {
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
/// not part of the motion: only `R` has a mechanical meaning. With `K = 1` the group is SE(3).
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

/// A retraction `τ` of the matrix group `G`, with its right logarithmic derivative.
pub trait MatrixRetraction<G, const N: usize, const D: usize>
where
    G: MatrixGroup<N, D>,
{
    /// `τ(x)`; `None` if `x` is outside the domain.
    fn retract(x: &SVector<f64, D>) -> Option<SMatrix<f64, N, N>>;

    /// The matrix of `dR τ_x: y ↦ vee(Dτ(x)[y] τ(x)⁻¹)`; `None` if `x` is outside the domain.
    fn right_derivative(x: &SVector<f64, D>) -> Option<SMatrix<f64, D, D>>;

    /// Whether `τ` is a local diffeomorphism on the whole way from 0 to `x`.
    fn is_regular(x: &SVector<f64, D>) -> bool;
}

impl<G, const N: usize, const D: usize> MatrixRetraction<G, N, D> for Exponential
where
    G: MatrixGroup<N, D>,
{
    fn retract(x: &SVector<f64, D>) -> Option<SMatrix<f64, N, N>> {
        Some(G::exp(x))
    }

    fn right_derivative(x: &SVector<f64, D>) -> Option<SMatrix<f64, D, D>> {
        Some(G::exp_derivative(x))
    }

    fn is_regular(x: &SVector<f64, D>) -> bool {
        G::exp_is_regular(x)
    }
}

impl<G, const N: usize, const D: usize> MatrixRetraction<G, N, D> for Cayley
where
    G: MatrixGroup<N, D>,
{
    fn retract(x: &SVector<f64, D>) -> Option<SMatrix<f64, N, N>> {
        G::cayley(x)
    }

    fn right_derivative(x: &SVector<f64, D>) -> Option<SMatrix<f64, D, D>> {
        G::cayley_derivative(x)
    }

    fn is_regular(x: &SVector<f64, D>) -> bool {
        // rational: where it is defined, it is regular
        G::cayley(x).is_some()
    }
}

/// A left-invariant Hamiltonian: a function `h(μ)` on the dual of a Lie algebra with coordinates `R^D`.
pub trait Hamiltonian<const D: usize> {
    /// `h(μ)`.
    fn energy(&self, mu: &SVector<f64, D>) -> f64;

    /// `∂h/∂μ(μ)`, the velocity in the Lie algebra.
    fn gradient(&self, mu: &SVector<f64, D>) -> SVector<f64, D>;
}

/// Takes steps of one size on the group `G`, with the retraction `R` and the Hamiltonian `H`: see the
/// [module](self) for the equations.
///
/// The unknown is all of `η`, though often much of it is known from the structure; Newton's Jacobian comes from forward
/// differences. The iteration goes on until rounding stops it, so that what remains of a comparison with another way of
/// solving the same equations is rounding.
#[derive(Clone, Debug)]
pub struct GenericStepper<G, R, H, const N: usize, const D: usize> {
    hamiltonian: H,
    step: f64,
    s: f64,
    memory: Option<Memory<D>>,
    group: PhantomData<(G, R)>,
}

/// The last solution and the momentum it led to.
#[derive(Clone, Copy, Debug)]
struct Memory<const D: usize> {
    mu: SVector<f64, D>,
    eta: SVector<f64, D>,
}

/// A solution of the step's equation.
struct Solution<const D: usize> {
    eta: SVector<f64, D>,
    iterations: u32,
    residual: f64,
}

impl<G, R, H, const N: usize, const D: usize> GenericStepper<G, R, H, N, D>
where
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D>,
    H: Hamiltonian<D>,
{
    /// A stepper for `hamiltonian` with the given step (negative steps go back in time) and `s = 0`.
    ///
    /// `group` and `retraction` only name their types.
    ///
    /// # Errors
    /// If the step is zero or not finite.
    pub fn new(_group: G, _retraction: R, hamiltonian: H, step: f64) -> Result<Self, ParameterError> {
        if !step.is_finite() || step == 0.0 {
            return Err(ParameterError::Step { step });
        }
        Ok(Self { hamiltonian, step, s: 0.0, memory: None, group: PhantomData })
    }

    /// The same stepper with the equation set up at `s ∈ [0, 1]`: 0 is the start of the step, ½ its middle, 1 its end.
    ///
    /// The step keeps its properties outside of `[0, 1]`, but gains nothing there.
    ///
    /// # Errors
    /// If `s` is not finite.
    pub fn at(self, s: f64) -> Result<Self, ParameterError> {
        if !s.is_finite() {
            return Err(ParameterError::NotFinite { name: "s" });
        }
        // a solution for another s is no longer a good start
        Ok(Self { s, memory: None, ..self })
    }

    /// The step size.
    pub fn step_size(&self) -> f64 {
        self.step
    }

    /// The Hamiltonian.
    pub fn hamiltonian(&self) -> &H {
        &self.hamiltonian
    }

    /// Takes one step from the group element `g` and the momentum `mu`.
    ///
    /// The matrix `g` is multiplied up, never projected back to the group: rounding moves it away from there, by the
    /// order of `1e-16 √n` after `n` steps. The momentum does not depend on it.
    ///
    /// # Errors
    /// If the state is not finite, the step's equation cannot be solved, or its solution lies outside the retraction's
    /// domain. `g` and `mu` are then as before the call.
    pub fn step(
        &mut self,
        g: &mut SMatrix<f64, N, N>,
        mu: &mut SVector<f64, D>,
    ) -> Result<StepReport, StepError> {
        if !is_finite(g) || !is_finite(mu) {
            return Err(StepError::NotFinite);
        }
        let start = match &self.memory {
            Some(memory) if memory.mu == *mu => memory.eta,
            _ => self.hamiltonian.gradient(mu) * self.step,
        };
        let Solution { eta, iterations, residual } = self.solve(mu, start)?;

        let (before, after) = (eta * self.s, eta * (1.0 - self.s));
        if !R::is_regular(&before) || !R::is_regular(&after) {
            return Err(StepError::OutsideDomain);
        }
        let onward = R::retract(&after).ok_or(StepError::OutsideDomain)?;
        let g_mid = *g * R::retract(&before).ok_or(StepError::OutsideDomain)?;
        let m = self.intermediate_momentum(mu, &eta).ok_or(StepError::OutsideDomain)?;
        let next_g = g_mid * onward;
        let next_mu = G::coadjoint(&onward, &m).ok_or(StepError::OutsideDomain)?;
        if !is_finite(&next_g) || !is_finite(&next_mu) {
            return Err(StepError::NotFinite);
        }

        (*g, *mu) = (next_g, next_mu);
        self.memory = Some(Memory { mu: next_mu, eta });
        Ok(StepReport { iterations, residual })
    }

    /// `m = Ad*_{τ(−sη)⁻¹} μ`.
    fn intermediate_momentum(&self, mu: &SVector<f64, D>, eta: &SVector<f64, D>) -> Option<SVector<f64, D>> {
        if self.s == 0.0 {
            return Some(*mu);
        }
        let back = R::retract(&(eta * -self.s))?;
        G::coadjoint(&G::inverse(&back)?, mu)
    }

    /// `μ̄ = (1−s) (dR τ_{(1−s)η})* m + s (dR τ_{−sη})* m`.
    fn mean_momentum(&self, mu: &SVector<f64, D>, eta: &SVector<f64, D>) -> Option<SVector<f64, D>> {
        let m = self.intermediate_momentum(mu, eta)?;
        let mut mean = SVector::zeros();
        for (weight, x) in [(1.0 - self.s, eta * (1.0 - self.s)), (self.s, eta * -self.s)] {
            if weight != 0.0 {
                mean += R::right_derivative(&x)?.tr_mul(&m) * weight;
            }
        }
        Some(mean)
    }

    /// `η − t ∂h/∂μ(μ̄)`.
    fn residual(&self, mu: &SVector<f64, D>, eta: &SVector<f64, D>) -> Result<SVector<f64, D>, StepError> {
        let mean = self.mean_momentum(mu, eta).ok_or(StepError::OutsideDomain)?;
        let residual = eta - self.hamiltonian.gradient(&mean) * self.step;
        if is_finite(&residual) { Ok(residual) } else { Err(StepError::NotFinite) }
    }

    /// The Jacobian of the residual, by forward differences.
    fn jacobian(
        &self,
        mu: &SVector<f64, D>,
        eta: &SVector<f64, D>,
        residual: &SVector<f64, D>,
    ) -> Result<SMatrix<f64, D, D>, StepError> {
        let mut jacobian = SMatrix::<f64, D, D>::zeros();
        for j in 0..D {
            // √ε balances rounding against curvature; the unknown's natural scale is the radian
            let mut shifted = *eta;
            shifted[j] += 1.5e-8 * eta[j].abs().max(1.0);
            let difference = self.residual(mu, &shifted)? - residual;
            jacobian.set_column(j, &(difference / (shifted[j] - eta[j])));
        }
        Ok(jacobian)
    }

    /// Newton's iteration from `eta` on, until rounding keeps the residual from getting smaller.
    ///
    /// A Jacobian costs `D` residuals. It serves again as long as corrections bring the residual down tenfold, and for
    /// the last ones, which only chase roundoff.
    fn solve(&self, mu: &SVector<f64, D>, mut eta: SVector<f64, D>) -> Result<Solution<D>, StepError> {
        let mut residual = self.residual(mu, &eta)?;
        let mut kept = None;
        let mut iterations = 0;
        while residual.amax() > 0.0 && iterations < MAX_ITERATIONS {
            let is_new = kept.is_none();
            let inverse_jacobian = match kept.take() {
                Some(inverse_jacobian) => inverse_jacobian,
                None => match inverse(&self.jacobian(mu, &eta, &residual)?) {
                    Some(inverse_jacobian) => inverse_jacobian,
                    None => break,
                },
            };
            let correction = inverse_jacobian * residual;
            iterations += 1;

            // far from the solution, a correction that overshoots is halved
            let near = relative(&residual, &eta) <= ROUNDOFF;
            let mut scales = [1.0, 0.5, 0.25, 0.125, 0.0625].into_iter().take(if near { 1 } else { 5 });
            let better = scales.find_map(|scale| {
                let candidate = eta - correction * scale;
                let candidate_residual = self.residual(mu, &candidate).ok()?;
                (candidate_residual.amax() < residual.amax()).then_some((candidate, candidate_residual))
            });
            match better {
                Some((candidate, candidate_residual)) => {
                    if near || candidate_residual.amax() < 0.1 * residual.amax() {
                        kept = Some(inverse_jacobian);
                    }
                    (eta, residual) = (candidate, candidate_residual);
                }
                None if near || is_new => break,
                None => {} // again, with a new Jacobian
            }
        }
        let residual = relative(&residual, &eta);
        if residual <= ROUNDOFF {
            Ok(Solution { eta, iterations, residual })
        } else {
            Err(StepError::NoConvergence { iterations, residual })
        }
    }
}

/// The residual of `η = t ∂h/∂μ`, relative to the right side.
fn relative<const D: usize>(residual: &SVector<f64, D>, eta: &SVector<f64, D>) -> f64 {
    // a system at rest: 0 = 0
    if residual.amax() == 0.0 { 0.0 } else { residual.amax() / (eta - residual).amax() }
}

fn is_finite<const R: usize, const C: usize>(matrix: &SMatrix<f64, R, C>) -> bool {
    matrix.iter().all(|x| x.is_finite())
}
