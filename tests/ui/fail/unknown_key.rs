use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3, advect(gamma: R3), energy = 1.0)]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {}
