use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3, potential = weight, potential = 2.0 * weight)]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub weight: f64,
}

fn main() {}
