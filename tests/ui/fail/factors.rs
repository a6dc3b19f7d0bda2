use coadjoint::prelude::*;

#[lie_poisson_system(
    group(first: SO3, second: SO3),
    advected(gamma: R3),
    force(frist = gamma, second = inertia),
)]
pub struct Pair {
    #[inertia(first)]
    pub inertia: Vector3<f64>,
    #[inertia(first, third)]
    pub mass: f64,
}

fn main() {}
