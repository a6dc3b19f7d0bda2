use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.z.powi(2) * f64::from(1 / 2))]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {}
