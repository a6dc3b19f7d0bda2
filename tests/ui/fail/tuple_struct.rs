use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3)]
pub struct Body(#[inertia] pub Vector3<f64>);

fn main() {}
