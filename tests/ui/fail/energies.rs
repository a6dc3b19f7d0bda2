use coadjoint::prelude::*;

#[lie_poisson_system(
    group = SO3,
    control(thrust: f32, weight: f64),
    potential = weight * momentum.x + thrust + attitude.x,
    hamiltonian = velocity.norm(),
)]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub weight: f64,
}

fn main() {}
