use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma)]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub weight: f64,
}

fn main() {}
