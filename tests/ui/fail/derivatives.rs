//! Derivatives are asked for by a word alone, or by what they are by.

use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3, derivatives = true)]
struct Valued {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = SO3, derivatives(WrtState, state, state, momentum))]
struct Named {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = SO3, derivative)]
struct Misspelt {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(derivatives group = SO3, derivatives)]
struct Twice {
    #[inertia]
    inertia: f64,
}

fn main() {}
