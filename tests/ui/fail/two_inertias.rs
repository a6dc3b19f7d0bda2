use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3)]
pub struct Body {
    #[inertia]
    pub principal: Vector3<f64>,
    #[inertia]
    pub full: Matrix3<f64>,
}

fn main() {}
