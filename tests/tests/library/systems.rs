//! Systems that several tests need: each is compiled once.

use coadjoint::prelude::*;

/// A rigid body that turns about a fixed point under gravity: the vertical is advected.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi), methods(Midpoint))]
#[derive(Clone)]
pub(crate) struct Top {
    #[inertia]
    pub(crate) inertia: Vector3<f64>,
    pub(crate) weight: f64,
    pub(crate) chi: Vector3<f64>,
}

/// In single precision.
#[lie_poisson_system(group = SO3)]
#[derive(Clone)]
pub(crate) struct Single {
    #[inertia]
    pub(crate) inertia: Vector3<f32>,
}
