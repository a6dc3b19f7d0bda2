//! Groups of a user's own, in modules, made of each other, and the spaces on which they act.
#![deny(warnings)]
// of our own lints; users have none of them
#![allow(missing_docs, unreachable_pub)]

use coadjoint::prelude::*;

/// Groups.
pub mod groups {
    use coadjoint::lie_group;

    lie_group! {
        /// Maps of the plane that keep areas.
        pub Areas = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] };
        pub(crate) Moved = semidirect(shape: Areas!, offset: R2, push: dual(R2));
        Unused = tangent(SO3)
    }
}

use groups::Areas;

/// With everything that a group acts on.
#[lie_poisson_system(
    group = self::groups::Areas!,
    advected(v: R2, w: dual(R2), x: adjoint, m: coadjoint, q: matrices { h: [0, 0; 0, 0], e: [0, 0; 0, 0], f: [0, 0; 0, 0] }),
    potential = v.dot(&w) + x.dot(&m) + q.norm_squared()
)]
pub struct Everything {
    /// The inertia.
    #[inertia]
    pub inertia: Vector3<f64>,
}

/// As factors.
#[lie_poisson_system(group(shape: groups::Moved!, turn: tangent(SO(3)), plain: Areas!), retractions(Exponential))]
pub struct Factors {
    /// The inertia of all.
    #[inertia]
    pub inertia: f64,
}

fn main() {
    let everything = Everything { inertia: vector![1.0, 2.0, 3.0] };
    let _ = everything.stepper::<Exponential>(0.1);
    let _ = Factors { inertia: 1.0 }.stepper::<Exponential>(0.1);
}
