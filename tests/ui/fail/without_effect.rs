//! What has no effect is a warning at its name, which can be denied.

#![deny(deprecated)]

use coadjoint::prelude::*;

#[lie_poisson_system(group = R3, control(push: R3, pull: R3), force = push)]
struct Ball {
    #[inertia]
    mass: f64,
    gravity: f64,
    // for the picture
    #[allow(deprecated)]
    radius: f64,
}

#[lie_poisson_system(group = SO3, hamiltonian = momentum.norm_squared())]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

#[lie_poisson_system(group = SO3, control(moment: R3))]
#[allow(deprecated)]
struct Allowed {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
}

fn main() {}
