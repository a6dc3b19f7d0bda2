//! A stepper written the ordinary way: traits, matrices, and Newton's iteration on a Jacobian of difference quotients.
//!
//! [`GenericStepper`] takes the same discrete steps as generated steppers, for any matrix Lie group with any energy and any
//! forces, but knows nothing in closed form. Everything follows from the group's [`hat`](MatrixGroup::hat) map by definition:
//! the bracket is the commutator, `Ad` a conjugation, the exponential its power series, a gradient a difference quotient. That
//! makes it slow, and an independent check of what the generator derives. Use it to check a description, to try a group or an
//! energy out before describing it, or as the yardstick of a measurement.
//!
//! # Conventions
//!
//! - Left trivialization: `g' = g hat(ξ)` with `ξ` in the Lie algebra, in coordinates `R^D`; the momentum `μ` in its
//!   dual, paired with `ξ` by the dot product of coordinates. [`Side::Right`] has both in space: `g' = hat(ξ) g`.
//! - `Ad_g x = vee(g hat(x) g⁻¹)` and `Ad*_g` is its transpose; on SO(3), `Ad*_R Π = R⁻¹Π`.
//! - A retraction `τ` has the right logarithmic derivative `dR τ_x y = Dτ(x)[y] τ(x)⁻¹`, and the left one
//!   `dL τ_x y = τ(x)⁻¹ Dτ(x)[y]`. Nothing else is assumed of it: neither `τ(−x) = τ(x)⁻¹`, nor that it commutes with conjugations.
//! - The equations of motion of `h` with the force `F` are `μ' = ad*_ξ μ − T_e*L_g ∂h/∂g + F`, `g' = g hat(ξ)`, with `ξ = ∂h/∂μ`.
//!
//! # The step
//!
//! With the step `t` and a point `s ∈ [0, 1]` between start and end, the discretization map `D(g_s, η) = (g_s τ(−sη), g_s τ((1−s)η))` has a
//! cotangent lift, (5.6) of V. Vivek, D. Martín de Diego and R. N. Banavar, *A Geometric Approach to Structure-Preserving Integrators for
//! Mechanical Systems* (2026). With it their (5.8) reads: solve for `η = tξ`
//!
//! ```text
//! g_s = g_k τ(−sη)⁻¹
//! m⁻  = Ad*_{τ(−sη)⁻¹} μ_k
//! m⁺  = m⁻ − t T_e*L_g ∂h/∂g(g_s, μ_s) + t F(g_s, μ_s, u, t_k + st)
//! μ_s = (1−s) (dR τ_{(1−s)η})* m⁺ + s (dR τ_{−sη})* m⁻
//! η   = t ∂h/∂μ(g_s, μ_s)
//! ```
//!
//! with the control `u`, and take `μ_{k+1} = Ad*_{τ((1−s)η)} m⁺`, `g_{k+1} = g_s τ((1−s)η)`. On the right side `g` is multiplied from the left, `Ad*` has the inverse
//! element, and `dL` is in the place of `dR`.
//!
//! With `s = 0` this is their (6.5), which for a quadratic `h` reads `I ξ = (dL τ_{tξ})* μ_{k+1} = (dR τ_{tξ})* μ_k`. For a
//! [left-invariant energy](Hamiltonian) and the exponential or the Cayley map the step is, for every `s`, a Poisson map, keeps the Casimirs, has
//! order 2, and is undone by the step `−t`.
//!
//! # Examples
//!
//! A heavy top, on SE(3) = SO(3) ⋉ R³: the vertical `Γ` seen from the body is the momentum dual to the translations.
//!
//! ```
//! use coadjoint_classical::generic::{GenericStepper, Hamiltonian, SO3Semidirect};
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
//! for _ in 0..300 {
//!     stepper.step(&mut g, &mut mu)?;
//! }
//!
//! let gamma = mu.fixed_rows::<3>(3);
//! assert!((gamma.norm() - 1.0).abs() < 1e-13);
//! assert!((stepper.system().energy(&mu) - before).abs() < 1e-5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The same top without the advected vertical: its potential is then one on SO(3), whose gradient is a difference quotient of the energy.
//!
//! ```
//! use coadjoint_classical::generic::{GenericStepper, Mechanics, Phase, SO3};
//! use coadjoint::Cayley;
//! use coadjoint::nalgebra::{Matrix3, Vector3};
//! use coadjoint::vector;
//!
//! struct HeavyTop {
//!     inertia: Vector3<f64>,
//!     weight_chi: Vector3<f64>,
//! }
//!
//! impl Mechanics<SO3, 3, 3> for HeavyTop {
//!     type Control = ();
//!
//!     fn energy(&self, at: &Phase<3, 3>) -> f64 {
//!         at.mu.dot(&at.mu.component_div(&self.inertia)) / 2.0 + (at.g * self.weight_chi).z
//!     }
//! }
//!
//! let top = HeavyTop { inertia: vector![1.0, 2.0, 3.0], weight_chi: Vector3::z() };
//! let (mut g, mut mu) = (Matrix3::identity(), vector![1.0, 1.0, 1.0]);
//! let mut stepper = GenericStepper::new(SO3, Cayley, top, 0.01)?.at(0.5)?;
//! for _ in 0..50 {
//!     stepper.step(&mut g, &mut mu)?;
//! }
//! // the angular momentum about the vertical is constant
//! assert!(((g * mu).z - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod groups;
mod second_kind;

pub use groups::{MatrixGroup, Product, SE2, SO2, SO3, SO3Semidirect, SU2, Translations};

use core::marker::PhantomData;

use groups::inverse;
use nalgebra::{SMatrix, SVector};

use coadjoint::{Cayley, Exponential, ParameterError, StepError};

/// More Newton corrections than any solvable step takes.
const MAX_ITERATIONS: u32 = 40;

/// Below this, relative to the equation's terms, a residual is rounding; it usually stagnates well below.
const ROUNDOFF: f64 = 256.0 * f64::EPSILON;

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

/// On which side of the configuration velocities stand: the trivialization of the cotangent bundle and of the discretization map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// In the body: `g' = g hat(ξ)`.
    #[default]
    Left,
    /// In space: `g' = hat(ξ) g`.
    Right,
}

impl Side {
    /// `g h`, on the right side `h g`.
    fn compose<const N: usize>(self, g: &SMatrix<f64, N, N>, h: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
        match self {
            Self::Left => g * h,
            Self::Right => h * g,
        }
    }

    /// `Ad*_h μ`, on the right side `Ad*_{h⁻¹} μ`: what the momentum is once the configuration has moved freely by `h`.
    fn carry<G: MatrixGroup<N, D>, const N: usize, const D: usize>(
        self,
        mu: &SVector<f64, D>,
        h: &SMatrix<f64, N, N>,
    ) -> Option<SVector<f64, D>> {
        match self {
            Self::Left => G::coadjoint(h, mu),
            Self::Right => G::coadjoint(&G::inverse(h)?, mu),
        }
    }
}

/// Where a system is at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase<const N: usize, const D: usize> {
    /// The configuration, an element of the group.
    pub g: SMatrix<f64, N, N>,
    /// The momentum: in the body, or in space if the system is taken on the [right side](Side::Right).
    pub mu: SVector<f64, D>,
    /// The time.
    pub time: f64,
}

/// A mechanical system on the group `G`: its energy, and the forces that act on it.
///
/// The energy alone is enough. What is differentiated is so by central differences of order 8 unless the system says how; they are exact to
/// about 1e-14 where nothing changes much over a tenth of a unit.
pub trait Mechanics<G, const N: usize, const D: usize>
where
    G: MatrixGroup<N, D>,
{
    /// What is held over a step; `()` if there is nothing.
    type Control: Default;

    /// `h(g, μ, t)`.
    fn energy(&self, at: &Phase<N, D>) -> f64;

    /// The velocity `∂h/∂μ`, in the Lie algebra.
    fn velocity(&self, at: &Phase<N, D>) -> SVector<f64, D> {
        differences(|by| self.energy(&Phase { mu: at.mu + by, ..*at }))
    }

    /// `T_e*L_g ∂h/∂g`, whose components are the derivatives of `h(g exp(ε E_i))` with respect to `ε`; on the right side of `h(exp(ε E_i) g)`.
    fn slope(&self, at: &Phase<N, D>, side: Side) -> SVector<f64, D> {
        differences(|by| self.energy(&Phase { g: side.compose(&at.g, &G::exp(by)), ..*at }))
    }

    /// The force, in the dual of the Lie algebra: what changes the momentum beside the energy.
    fn force(&self, _at: &Phase<N, D>, _control: &Self::Control) -> SVector<f64, D> {
        SVector::zeros()
    }
}

/// A left-invariant Hamiltonian: a function `h(μ)` on the dual of a Lie algebra with coordinates `R^D`.
pub trait Hamiltonian<const D: usize> {
    /// `h(μ)`.
    fn energy(&self, mu: &SVector<f64, D>) -> f64;

    /// `∂h/∂μ(μ)`, the velocity in the Lie algebra; by central differences of order 8 unless the Hamiltonian says how.
    fn gradient(&self, mu: &SVector<f64, D>) -> SVector<f64, D> {
        differences(|by| self.energy(&(mu + by)))
    }
}

impl<G, H, const N: usize, const D: usize> Mechanics<G, N, D> for H
where
    G: MatrixGroup<N, D>,
    H: Hamiltonian<D>,
{
    type Control = ();

    fn energy(&self, at: &Phase<N, D>) -> f64 {
        Hamiltonian::energy(self, &at.mu)
    }

    fn velocity(&self, at: &Phase<N, D>) -> SVector<f64, D> {
        self.gradient(&at.mu)
    }

    fn slope(&self, _at: &Phase<N, D>, _side: Side) -> SVector<f64, D> {
        SVector::zeros()
    }
}

/// The gradient of `f` at 0, by central differences of order 8.
fn differences<const D: usize>(f: impl Fn(&SVector<f64, D>) -> f64) -> SVector<f64, D> {
    // rounding and what is cut off are about equally small, for functions of the size of 1
    const SPREAD: f64 = 0.02;
    const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    SVector::from_fn(|i, _| {
        let along = |by: f64| f(&SVector::from_fn(|row, _| if row == i { by } else { 0.0 }));
        let pairs = WEIGHTS.iter().zip(1_u8..).map(|(weight, k)| {
            let by = SPREAD * f64::from(k);
            weight * (along(by) - along(-by))
        });
        pairs.sum::<f64>() / SPREAD
    })
}

/// Takes steps of one size on the group `G`, with the retraction `R` and the system `H`: see the
/// [module](self) for the equations.
///
/// The unknown is all of `η`, though often much of it is known from the structure; Newton's Jacobian comes from forward
/// differences. The iteration goes on until rounding stops it, so that what remains of a comparison with another way of
/// solving the same equations is rounding.
#[derive(Clone, Debug)]
pub struct GenericStepper<G, R, H, const N: usize, const D: usize> {
    system: H,
    step: f64,
    s: f64,
    side: Side,
    memory: Option<Memory<D>>,
    group: PhantomData<(G, R)>,
}

/// The last solution and the momentum it led to.
#[derive(Clone, Copy, Debug)]
struct Memory<const D: usize> {
    mu: SVector<f64, D>,
    eta: SVector<f64, D>,
}

/// Where a step starts, and what is held over it.
struct Start<'c, C, const N: usize, const D: usize> {
    at: Phase<N, D>,
    control: &'c C,
}

/// The point where the equation is set up: `g_s`, `μ_s` and its time, and the momentum behind the kick.
struct Intermediate<const N: usize, const D: usize> {
    at: Phase<N, D>,
    /// `m⁺`
    kicked: SVector<f64, D>,
}

/// A solution of the step's equation.
struct Solution<const D: usize> {
    eta: SVector<f64, D>,
    solved: Solved,
}

/// How the equation of a step was solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Newton corrections made.
    pub iterations: u32,
    /// The residual left, relative to the right side of the equation.
    pub residual: f64,
}

impl<G, R, H, const N: usize, const D: usize> GenericStepper<G, R, H, N, D>
where
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D>,
    H: Mechanics<G, N, D>,
{
    /// A stepper for `system` with the given step (negative steps go back in time), `s = 0` and velocities in the body.
    ///
    /// `group` and `retraction` only name their types.
    ///
    /// # Errors
    /// If the step is zero or not finite.
    pub fn new(_group: G, _retraction: R, system: H, step: f64) -> Result<Self, ParameterError> {
        if !step.is_finite() || step == 0.0 {
            return Err(ParameterError::Step { step });
        }
        Ok(Self { system, step, s: 0.0, side: Side::Left, memory: None, group: PhantomData })
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

    /// The same stepper with momentum, velocity and the discretization map on this side.
    #[must_use]
    pub fn on(self, side: Side) -> Self {
        Self { side, memory: None, ..self }
    }

    /// The step size.
    pub fn step_size(&self) -> f64 {
        self.step
    }

    /// The system.
    pub fn system(&self) -> &H {
        &self.system
    }

    /// Takes one step from the group element `g` and the momentum `mu` at the time 0, with the control's default.
    ///
    /// The matrix `g` is multiplied up, never projected back to the group: rounding moves it away from there, by the
    /// order of `1e-16 √n` after `n` steps. The momentum of a left-invariant system does not depend on it.
    ///
    /// # Errors
    /// If the state is not finite, the step's equation cannot be solved, or its solution lies outside the retraction's
    /// domain. `g` and `mu` are then as before the call.
    pub fn step(
        &mut self,
        g: &mut SMatrix<f64, N, N>,
        mu: &mut SVector<f64, D>,
    ) -> Result<Solved, StepError> {
        self.step_with(g, mu, &H::Control::default(), 0.0)
    }

    /// Takes [one step](Self::step) that starts at `time`, with `control` held until it ends.
    ///
    /// # Errors
    /// As of [`step`](Self::step).
    pub fn step_with(
        &mut self,
        g: &mut SMatrix<f64, N, N>,
        mu: &mut SVector<f64, D>,
        control: &H::Control,
        time: f64,
    ) -> Result<Solved, StepError> {
        if !is_finite(g) || !is_finite(mu) || !time.is_finite() {
            return Err(StepError::NotFinite);
        }
        let start = Start { at: Phase { g: *g, mu: *mu, time }, control };
        let guess = match &self.memory {
            Some(memory) if memory.mu == *mu => memory.eta,
            _ => self.system.velocity(&start.at) * self.step,
        };
        let Solution { eta, solved } = self.solve(&start, guess)?;

        let (early, late) = (eta * -self.s, eta * (1.0 - self.s));
        if !R::is_regular(&early) || !R::is_regular(&late) {
            return Err(StepError::OutsideDomain);
        }
        let there = self.intermediate(&start, &eta)?;
        let onward = R::retract(&late).ok_or(StepError::OutsideDomain)?;
        let next_g = self.side.compose(&there.at.g, &onward);
        let next_mu = self.side.carry::<G, N, D>(&there.kicked, &onward).ok_or(StepError::OutsideDomain)?;
        if !is_finite(&next_g) || !is_finite(&next_mu) {
            return Err(StepError::NotFinite);
        }

        (*g, *mu) = (next_g, next_mu);
        self.memory = Some(Memory { mu: next_mu, eta });
        Ok(solved)
    }

    /// Where the equation is set up if the solution is `eta`.
    fn intermediate(
        &self,
        start: &Start<'_, H::Control, N, D>,
        eta: &SVector<f64, D>,
    ) -> Result<Intermediate<N, D>, StepError> {
        let (g, m) = self.moved_early(start, eta).ok_or(StepError::OutsideDomain)?;
        let (early, late) = (eta * -self.s, eta * (1.0 - self.s));
        let before = match self.s {
            0.0 => SVector::zeros(),
            s => self.derivative(&early).ok_or(StepError::OutsideDomain)?.tr_mul(&m) * s,
        };
        let after = match 1.0 - self.s {
            0.0 => SMatrix::zeros(),
            share => self.derivative(&late).ok_or(StepError::OutsideDomain)? * share,
        };

        // a kick that depends on μ_s makes the equation for it implicit, and the step contracts it
        let mut there = Phase { g, mu: after.tr_mul(&m) + before, time: start.at.time + self.s * self.step };
        let (mut nearer, mut iterations) = (f64::INFINITY, 0);
        loop {
            let kicked = m + self.kick(&there, start.control);
            let mean = after.tr_mul(&kicked) + before;
            let moved = (mean - there.mu).amax();
            there.mu = mean;
            iterations += 1;
            if moved == 0.0 || (moved >= nearer && moved <= ROUNDOFF * mean.amax()) {
                return Ok(Intermediate { at: there, kicked });
            }
            if !(moved < nearer) {
                return Err(StepError::NoConvergence { iterations, residual: moved / mean.amax() });
            }
            nearer = moved;
        }
    }

    /// `ḡ` and `m⁻`
    fn moved_early(
        &self,
        start: &Start<'_, H::Control, N, D>,
        eta: &SVector<f64, D>,
    ) -> Option<(SMatrix<f64, N, N>, SVector<f64, D>)> {
        let Phase { g, mu, .. } = &start.at;
        if self.s == 0.0 {
            return Some((*g, *mu));
        }
        let by = G::inverse(&R::retract(&(eta * -self.s))?)?;
        Some((self.side.compose(g, &by), self.side.carry::<G, N, D>(mu, &by)?))
    }

    /// The matrix of `dR τ_x`, on the right side of `dL τ_x = Ad_{τ(x)⁻¹} dR τ_x`.
    fn derivative(&self, x: &SVector<f64, D>) -> Option<SMatrix<f64, D, D>> {
        let right = R::right_derivative(x)?;
        match self.side {
            Side::Left => Some(right),
            Side::Right => Some(G::adjoint(&G::inverse(&R::retract(x)?)?)? * right),
        }
    }

    /// `t (F − T_e*L_g ∂h/∂g)`
    fn kick(&self, at: &Phase<N, D>, control: &H::Control) -> SVector<f64, D> {
        (self.system.force(at, control) - self.system.slope(at, self.side)) * self.step
    }

    /// `η − t ∂h/∂μ(g_s, μ_s)`.
    fn residual(
        &self,
        start: &Start<'_, H::Control, N, D>,
        eta: &SVector<f64, D>,
    ) -> Result<SVector<f64, D>, StepError> {
        let there = self.intermediate(start, eta)?;
        let residual = eta - self.system.velocity(&there.at) * self.step;
        if is_finite(&residual) { Ok(residual) } else { Err(StepError::NotFinite) }
    }

    /// The Jacobian of the residual, by forward differences.
    fn jacobian(
        &self,
        start: &Start<'_, H::Control, N, D>,
        eta: &SVector<f64, D>,
        residual: &SVector<f64, D>,
    ) -> Result<SMatrix<f64, D, D>, StepError> {
        let mut jacobian = SMatrix::<f64, D, D>::zeros();
        for j in 0..D {
            // √ε balances rounding against curvature; the unknown's natural scale is the radian
            let mut shifted = *eta;
            shifted[j] += 1.5e-8 * eta[j].abs().max(1.0);
            let difference = self.residual(start, &shifted)? - residual;
            jacobian.set_column(j, &(difference / (shifted[j] - eta[j])));
        }
        Ok(jacobian)
    }

    /// Newton's iteration from `eta` on, until rounding keeps the residual from getting smaller.
    ///
    /// A Jacobian costs `D` residuals. It serves again as long as corrections bring the residual down tenfold, and for
    /// the last ones, which only chase roundoff.
    fn solve(
        &self,
        start: &Start<'_, H::Control, N, D>,
        mut eta: SVector<f64, D>,
    ) -> Result<Solution<D>, StepError> {
        let mut residual = self.residual(start, &eta)?;
        let mut kept = None;
        let mut iterations = 0;
        while residual.amax() > 0.0 && iterations < MAX_ITERATIONS {
            let is_new = kept.is_none();
            let inverse_jacobian = match kept.take() {
                Some(inverse_jacobian) => inverse_jacobian,
                None => match inverse(&self.jacobian(start, &eta, &residual)?) {
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
                let candidate_residual = self.residual(start, &candidate).ok()?;
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
            Ok(Solution { eta, solved: Solved { iterations, residual } })
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
