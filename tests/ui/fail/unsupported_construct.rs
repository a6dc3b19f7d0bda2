use coadjoint::prelude::*;

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = {
        let mut total = 0.0;
        for i in 0..3 {
            total += gamma[i];
        }
        total
    },
)]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {}
