use coadjoint::prelude::*;

// Types that only rustc knows or words better are left to it: its errors point into the description.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(chi))]
pub struct Top {
    #[inertia]
    pub inertia: Vector3<f64>,
    pub weight: f64,
    pub chi: Vector3<f64>,
}

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = GRAVITY * gamma.z)]
pub struct Pendulum {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {}
