use coadjoint::prelude::*;

fn height(gamma: &Vector3<f64>) -> f64 {
    gamma.z
}

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * height(&gamma))]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub weight: f64,
}

fn main() {}
