use coadjoint::prelude::*;

#[lie_poisson_system(group = S4)]
pub struct Body {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {}
