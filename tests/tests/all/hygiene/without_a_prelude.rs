//! Nothing is taken from a prelude: all paths are absolute.

/// A top.
#[::coadjoint::lie_poisson_system(
    group = SO3,
    advected(gamma: R3, field: R3),
    potential = {
        let tilt = gamma.dot(&chi);
        weight * tilt + tilt.sin() * field.cross(&gamma).norm_squared() + (response * field).x
    },
    derivatives,
)]
#[derive(::core::clone::Clone)]
pub struct Bare {
    #[inertia]
    pub inertia: ::coadjoint::nalgebra::Matrix3<f64>,
    pub weight: f64,
    pub chi: ::coadjoint::nalgebra::Vector3<f64>,
    pub response: ::coadjoint::nalgebra::Matrix3<f64>,
}

/// A body.
#[::coadjoint::lie_poisson_system(group = SO3)]
pub struct BareBody {
    #[inertia]
    pub inertia: f64,
}
