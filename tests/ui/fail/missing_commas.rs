use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3 advected(gamma: R3 delta: R3) potential = gamma.dot(&delta))]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {}
