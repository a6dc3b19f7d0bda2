use coadjoint::prelude::*;

#[lie_poisson_system(group = , advected, potential =)]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {}
