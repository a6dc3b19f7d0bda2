use coadjoint::prelude::*;

#[lie_poisson_system]
pub struct Body {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {}
