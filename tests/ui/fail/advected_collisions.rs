use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3, advected(chi: R3, momentum: R3, gamma: R4))]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub chi: Vector3<f64>,
}

fn main() {}
