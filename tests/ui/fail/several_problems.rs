use coadjoint::prelude::*;

#[lie_poisson_system(
    grup = SO3,
    group = SO3,
    advected(gamma: R2, weight: R3),
    potential = {
        let lever = wieght * chi;
        lever.dott(&chi) + chi * chi
    },
)]
pub struct Top {
    pub inertia: Vector3<f64>,
    pub weight: f64,
    pub chi: Vector3<f64>,
    pub name: &'static str,
}

fn main() {}
