use coadjoint::prelude::*;

#[lie_poisson_system(
    group(spins: [SO3; 0], wheels: [SO2; 2], hulls: [SE3; 40], base: [SO3]),
    force(wheels[2] = friction, wheels = friction),
)]
struct Lengths {
    #[inertia]
    inertia: f64,
    friction: f64,
}

#[lie_poisson_system(
    group(spins: [SO3; 3]),
    advected(gamma: R3),
    hamiltonian = (0..3).map(|i| spins_momentum[i].dot(&spins_momentum[i + 1])).sum::<f64>()
        + (0..0).map(|_| strength).sum::<f64>()
        + spins_momentum.iter().map(|s, t| s.dot(t)).sum::<f64>()
        + spins_momentum.sum::<f64>()
        + lengths[3],
)]
struct Elements {
    strength: f64,
    lengths: [f64; 3],
}

#[lie_poisson_system(group(spins: [SO3; 3]), force(spins = [torque, torque]))]
struct Inertias {
    #[inertia]
    inertia: [Vector3<f64>; 2],
    torque: Vector3<f64>,
    spins_1: f64,
}

fn main() {}
