//! Schemes: what a step makes of a retraction, as types to choose with: `system.stepper::<Midpoint<Cayley>>(h)`.
//!
//! A bare retraction is a scheme too, the [standard](crate::system::System::Standard) one of order 2; it is the one to take
//! unless another is wanted for itself. [Compositions](crate::composition) make higher orders of these.
//!
//! ```
//! use coadjoint::prelude::*;
//!
//! #[lie_poisson_system(group = SO3, methods(Midpoint))]
//! struct Body {
//!     #[inertia]
//!     inertia: Vector3<f64>,
//! }
//!
//! let body = Body { inertia: vector![1.0, 2.0, 2.5] };
//! let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
//! let momentum = body.spatial_momentum(&state);
//! let mut stepper = body.stepper::<Midpoint>(0.05)?;
//! for _ in 0..1_000 {
//!     stepper.step(&mut state)?;
//! }
//! assert!((body.spatial_momentum(&state) - momentum).norm() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The family is that of V. Vivek, D. Martín de Diego and R. N. Banavar, *A Geometric Approach to Structure-Preserving
//! Integrators for Mechanical Systems* (2026).

use core::marker::PhantomData;

use crate::retraction::{Exponential, Retraction, RetractionKind};

/// The member `s = N/D`, in lowest terms and from 0 to 1, of the family of one-step schemes with the retraction `R`.
///
/// The step's equation is set up at the point `s` of the way from its start to its end: with the step `h`, solve for `η`
///
/// ```text
/// g_s = g_k τ(−sη)⁻¹
/// m   = Ad*_{τ(−sη)⁻¹} μ_k
/// μ_s = (1−s) (dR τ_{(1−s)η})* m + s (dR τ_{−sη})* m
/// η   = h ∂h/∂μ(μ_s)
/// ```
///
/// and take `μ_{k+1} = Ad*_{τ((1−s)η)} m`, `g_{k+1} = g_s τ((1−s)η)`. A potential on the group, forces and explicit time act there
/// too: at `g_s` and the time `t_k + s h`, with the share `1 − s` before and `s` after.
///
/// - For left-invariant systems without forces, every member is a Poisson map and keeps the Casimirs, with any retraction. With
///   [`Exponential`] and [`Cayley`](crate::retraction::Cayley) it is symmetric and of order 2.
/// - With a potential on the group, every member is symplectic on `T*G`. Its adjoint, the inverse of the step `−h`, is the member
///   `1 − s`: only `s = ½` is symmetric and of order 2, the others are of order 1. So it is with
///   [`SecondKind`](crate::retraction::SecondKind) for left-invariant systems too.
/// - With forces no member is symplectic, nor is the motion; orders and adjoints are as with a potential.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Family<R = Exponential, const N: u32 = 0, const D: u32 = 1>(PhantomData<R>);

/// The member `s = 0` of the [family](Family): for left-invariant systems the reduced step (6.5) of the paper.
pub type SymplecticEulerA<R = Exponential> = Family<R, 0, 1>;
/// The member `s = ½` of the [family](Family), symmetric and of order 2 for every system.
pub type Midpoint<R = Exponential> = Family<R, 1, 2>;
/// The member `s = 1` of the [family](Family), the adjoint of [`SymplecticEulerA`].
pub type SymplecticEulerB<R = Exponential> = Family<R, 1, 1>;

/// The tangent lift (5.7) of the discretization map with `s = N/D`, in lowest terms and from 0 to 1: a step of the Lagrangian side. With the
/// velocity `ξ`, its change `ξ'` along the motion, and the velocity `η` at the intermediate point `ḡ = g_k τ(shη)`, solve for `η`
///
/// ```text
/// ξ_k = η − s h dL τ_{−shη} ξ'(ḡ, η)
/// ```
///
/// and take `ξ_{k+1} = η + (1−s) h dL τ_{(1−s)hη} ξ'(ḡ, η)`, `g_{k+1} = ḡ τ((1−s)hη)`. Velocities belong to momenta by the inertia, or by the
/// Legendre transform of the Lagrangian or Hamiltonian.
///
/// The member `s = 0` is explicit. The configuration stays on its group and advected parameters on their orbits. Of order 1, `s = ½` of order 2
/// and symmetric; not symplectic, and no Poisson map: energy and momentum drift. To compare with, not to compute with. Asked for with
/// `methods(TangentLift)`, `methods(TangentLift(1, 4))` or `methods(TangentMidpoint)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TangentLift<R = Exponential, const N: u32 = 0, const D: u32 = 1>(PhantomData<R>);

/// The [tangent lift](TangentLift) with `s = ½`, symmetric and of order 2.
pub type TangentMidpoint<R = Exponential> = TangentLift<R, 1, 2>;

/// A step of the even order `P`, from 4 to 10, from one equation: symplectic, for left-invariant systems a Poisson map that keeps the Casimirs,
/// and symmetric, as [`Midpoint`] is. Asked for with `methods(HamiltonJacobi(6))`.
///
/// Where the midpoint step solves `∂l/∂ξ(ḡ, η/h) = m̄` with the Lagrangian `l`, the action over a step in the lowest order, this solves the same
/// with the action up to order `P`, a power series in the step that the macro derives: with the unknown `η`, `ḡ = g_k τ(η/2)`,
///
/// ```text
/// m⁻ = Ad*_{τ(−η/2)⁻¹} μ_k,   m⁺ = m⁻ + ∂R/∂g
/// ∂R/∂η = ½ (dR τ_{η/2})* m⁺ + ½ (dL τ_{−η/2})* μ_k
/// μ_{k+1} = Ad*_{τ(η/2)} m⁺,   g_{k+1} = ḡ τ(η/2)
/// ```
///
/// where `R(ḡ, η, h)` is the action of the motion from `ḡ τ(−η/2)` to `ḡ τ(η/2)` in the time `h`: Hamilton's principal function, which solves the
/// Hamilton–Jacobi equation. There has to be a momentum for each velocity in closed form, as there is for every inertia, Lagrangian, and
/// Hamiltonian that is quadratic in the momentum. With forces the step is not symplectic, nor is the motion; order and symmetry stay. Controls
/// are held over a step; what changes within it belongs into the description, as a function of `t`.
///
/// Ge and Marsden, Phys. Lett. A 133 (1988) 134.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HamiltonJacobi<R = Exponential, const P: u32 = 6>(PhantomData<R>);

/// The scheme `M` carrying the momentum in space coordinates, (6.6) and (6.9) of the paper, for systems on which nothing
/// [acts](crate::system::Isolated): the spatial momentum is constant bit for bit, and the body momentum is what belongs to it. Where
/// `invariance = right` it is the other way round: the momentum in the body is constant and carried, that in space belongs to it.
///
/// The map is that of `M` up to roundoff, a Poisson map as it is. The stepper carries the momentum for as long as the states it is
/// given are those that it led to; another state starts anew from its body momentum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RightLift<M = SymplecticEulerA>(PhantomData<M>);

/// Half a step with [`SymplecticEulerA`], then half a step with its adjoint [`SymplecticEulerB`]: symmetric, of order 2, and
/// symplectic as they are. A potential on the group acts at both ends of the step, outside of the equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StormerVerlet<R = Exponential>(PhantomData<R>);

/// A generated step as a value, but for its retraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rule {
    /// The member `s = numerator/denominator` of the [family](Family), in lowest terms.
    Member(u32, u32),
    /// The [`TangentLift`] with `s = numerator/denominator`, in lowest terms.
    TangentLift(u32, u32),
    /// The [`HamiltonJacobi`] step of this order.
    HamiltonJacobi(u32),
}

/// The type that stands for a generated step.
#[doc(hidden)]
pub trait Base: 'static {
    /// Its retraction.
    const MAP: RetractionKind;
    /// The rest of it.
    const RULE: Rule;
}

impl<R: Retraction + 'static, const N: u32, const D: u32> Base for Family<R, N, D> {
    const MAP: RetractionKind = R::MAP;
    const RULE: Rule = Rule::Member(N, D);
}

impl<R: Retraction + 'static, const N: u32, const D: u32> Base for TangentLift<R, N, D> {
    const MAP: RetractionKind = R::MAP;
    const RULE: Rule = Rule::TangentLift(N, D);
}

impl<R: Retraction + 'static, const P: u32> Base for HamiltonJacobi<R, P> {
    const MAP: RetractionKind = R::MAP;
    const RULE: Rule = Rule::HamiltonJacobi(P);
}
