use coadjoint::prelude::*;

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.inner(&chi) + gamma.z.sine(),
)]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub weight: f64,
    pub chi: Vector3<f64>,
}

fn main() {}
