use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3, advected(gamma: R3, gamma: R3))]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {}
