use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3)]
pub struct Body<T> {
    #[inertia]
    pub inertia: Vector3<T>,
}

fn main() {}
