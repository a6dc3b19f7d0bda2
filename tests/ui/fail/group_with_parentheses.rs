use coadjoint::prelude::*;

#[lie_poisson_system(group = SO(n))]
pub struct Body {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {}
