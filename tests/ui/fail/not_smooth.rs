use coadjoint::prelude::*;

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = if gamma.z { gamma.z } else { gamma.x.abs() },
)]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
}

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = stiffness * gamma.z.floor())]
pub struct Spring {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub stiffness: f64,
}

fn main() {}
