//! Users deny lints, and what we write for them must pass. (Clippy's only speak when clippy runs.)
#![deny(
    missing_docs,
    missing_debug_implementations,
    unused,
    nonstandard_style,
    rust_2018_idioms,
    let_underscore,
    keyword_idents,
    warnings,
    elided_lifetimes_in_paths,
    explicit_outlives_requirements,
    single_use_lifetimes,
    trivial_casts,
    trivial_numeric_casts,
    unnameable_types,
    unreachable_pub,
    unsafe_code,
    unused_import_braces,
    unused_lifetimes,
    unused_qualifications,
    unused_results,
    variant_size_differences,
    clippy::all,
    clippy::pedantic,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::float_arithmetic,
    clippy::missing_docs_in_private_items
)]
#![allow(dead_code)]

use coadjoint::prelude::*;

/// A top.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3, field: R3),
    potential = {
        let tilt = gamma.dot(&chi);
        weight * tilt + (strength * field).dot(&gamma).powi(3) * LENGTH + std::f64::consts::PI
    },
)]
#[derive(Clone, Debug, PartialEq)]
pub struct Top {
    /// Tensor of inertia.
    #[inertia]
    pub inertia: Matrix3<f64>,
    /// Mass times gravity.
    pub weight: f64,
    /// To the centre of mass.
    pub chi: Vector3<f64>,
    /// Of the field.
    pub strength: f64,
    /// Not used at all.
    #[allow(deprecated)]
    pub unused: f64,
}

/// Of the string.
const LENGTH: f64 = 1.5;

/// A body.
#[lie_poisson_system(group = SO3)]
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Principal moments of inertia.
    #[inertia]
    pub inertia: Vector3<f64>,
}

/// Seen in the crate.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.x)]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Inner {
    /// Moment of inertia.
    #[inertia]
    pub(crate) inertia: f64,
}

/// Seen here.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.x, derivatives)]
#[derive(Clone, Debug, PartialEq)]
struct Private {
    /// Moment of inertia.
    #[inertia]
    inertia: f64,
}
