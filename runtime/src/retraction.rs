//! The retractions `τ: g → G` a step can be built on, as types to choose with:
//! `system.stepper::<Cayley>(h)`.
//!
//! All satisfy `τ(0) = e` and `τ'(0) = id`. [`Exponential`] and [`Cayley`] are functions of one matrix: `τ(−ξ) = τ(ξ)⁻¹`, and
//! `τ(Ad_g ξ) = g τ(ξ) g⁻¹`. [`SecondKind`] has neither property, nor have steps what follows from them.

/// A retraction as a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RetractionKind {
    /// [`Exponential`](Exponential)
    Exponential,
    /// [`Cayley`](Cayley)
    Cayley,
    /// [`SecondKind`](SecondKind)
    SecondKind,
}

impl RetractionKind {
    /// All of them.
    pub const ALL: [RetractionKind; 3] =
        [RetractionKind::Exponential, RetractionKind::Cayley, RetractionKind::SecondKind];

    /// Whether it is a function of one matrix: then it is odd, `τ(−ξ) = τ(ξ)⁻¹`, and `Ad`-equivariant, `τ(Ad_g ξ) = g τ(ξ) g⁻¹`. Other
    /// maps are neither, but on commutative groups.
    pub const fn is_matrix_function(self) -> bool {
        matches!(self, Self::Exponential | Self::Cayley)
    }
}

/// A retraction of the catalogue.
pub trait Retraction {
    /// It, as a value.
    const MAP: RetractionKind;
}

impl Retraction for Exponential {
    const MAP: RetractionKind = RetractionKind::Exponential;
}

impl Retraction for Cayley {
    const MAP: RetractionKind = RetractionKind::Cayley;
}

impl Retraction for SecondKind {
    const MAP: RetractionKind = RetractionKind::SecondKind;
}

/// The group's exponential map.
///
/// On SO(3) it needs angles per step below 2π. At equal step it is far more accurate than [`Cayley`]
/// (it follows steady rotations exactly), for some more arithmetic per step: the better default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exponential;

/// The Cayley map `(1 − ξ/2)⁻¹(1 + ξ/2)`: rational, no transcendental function, defined for every argument.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cayley;

/// Canonical coordinates of the second kind, `τ(ξ) = exp(ξ₁E₁) exp(ξ₂E₂) ⋯`: turns and shifts along the axes of the algebra, one after the
/// other. (B. Owren and A. Marthinsen, *Integration methods based on canonical coordinates of the second kind*, 2001.)
///
/// Neither odd nor `Ad`-equivariant. Steps with it are Poisson maps that keep the Casimirs, and the adjoint of the member `s` of the
/// [family](crate::scheme::Family) is `1 − s`, as with any retraction; but only `s = ½` is symmetric and of order 2, on left-invariant systems
/// too. The bare retraction is therefore [`StormerVerlet`](crate::scheme::StormerVerlet) for every system. On SO(3) the second turn must be
/// less than a quarter. To compare with: generated where a description asks for it by `retractions(SecondKind)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SecondKind;
