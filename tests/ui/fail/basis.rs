//! Mistakes in a basis of one's own are told at its matrices.

use coadjoint::prelude::*;

#[lie_poisson_system(group = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], both: [1, 1; 0, -1] })]
struct Dependent {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = matrices { x: [0, 1, 0; 0, 0, 0; 0, 0, 0], y: [0, 0, 0; 0, 0, 1; 0, 0, 0] })]
struct NotClosed {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = matrices { x: [0, 1, 0; 0, 0], y: [0, 0; 0, 0] })]
struct NotSquare {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = matrices { x: [1.5] })]
struct NotWhole {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = SL(4))]
struct TooLarge {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = SL(2), advected(v: R3), potential = v.norm(), retractions(SecondKind))]
struct NoSuchSpace {
    #[inertia]
    inertia: f64,
}

fn main() {}
