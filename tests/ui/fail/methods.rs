use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3, invariance = both, methods(Midpiont, Family(5, 4), Cayley, StormerVerlet))]
pub struct Body {
    #[inertia]
    pub inertia: Vector3<f64>,
}

#[lie_poisson_system(group = SO3)]
pub struct Other {
    #[inertia]
    pub inertia: Vector3<f64>,
}

fn main() {
    let other = Other { inertia: vector![1.0, 2.0, 3.0] };
    let _ = other.stepper::<Midpoint<Cayley>>(0.1);
}
