use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3)]
pub struct Body {
    #[inertia]
    pub inertia: Vec<f64>,
    pub name: String,
}

fn main() {}
