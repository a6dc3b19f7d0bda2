use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3)]
pub enum Body {
    Free,
}

fn main() {}
