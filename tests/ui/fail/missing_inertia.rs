use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3)]
pub struct Body {
    pub moments: Vector3<f64>,
}

fn main() {}
