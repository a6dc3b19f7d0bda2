use coadjoint::prelude::*;

use coadjoint::nalgebra::Vector2;

#[lie_poisson_system(group = SO3)]
pub struct Body {
    #[inertia]
    pub inertia: Vector2<f64>,
}

fn main() {}
