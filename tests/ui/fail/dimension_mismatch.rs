use coadjoint::prelude::*;

use coadjoint::nalgebra::Vector2;

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = gamma.dot(&offset) + (gamma + weight).norm() + gamma * gamma,
)]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub weight: f64,
    pub offset: Vector2<f64>,
}

fn main() {}
