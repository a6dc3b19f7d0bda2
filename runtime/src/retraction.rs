//! The retractions `τ: g → G` a step can be built on, as types to choose with:
//! `system.stepper::<Cayley>(h)`.
//!
//! Both satisfy `τ(0) = e`, `τ'(0) = id` and `τ(−ξ) = τ(ξ)⁻¹`.

use crate::geometry::Map;

/// A retraction of the catalogue.
pub trait Retraction {
    /// It, as a value.
    const MAP: Map;
}

impl Retraction for Exponential {
    const MAP: Map = Map::Exponential;
}

impl Retraction for Cayley {
    const MAP: Map = Map::Cayley;
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
