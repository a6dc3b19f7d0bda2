use coadjoint::prelude::*;

lie_group! {
    Shears = matrices { x: [0, 1; 0, 0], y: [0, 0; 1, 0] };
    Twice = matrices { x: [0, 1; 0, 0], y: [0, 2; 0, 0] };
    Circle = product(a: Circle!, b: SO2)
}

#[lie_poisson_system(group = Circle!)]
struct Endless {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = Banana)]
struct Unknown {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = product(a: SO3, a: R3), advected(v: matrices { x: [1] }))]
struct SameName {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = SL(2), advected(q: matrices { h1: [1], e12: [0], e21: [0] }))]
struct NoRepresentation {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = semidirect(a: SO3), advected(q: R3))]
struct NoSpace {
    #[inertia]
    inertia: f64,
}

fn main() {}
