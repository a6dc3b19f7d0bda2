//! Steps are generated with the retractions that are named, and derivatives those that are.

use coadjoint::derivative::{WrtParameters, WrtState};
use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3, retractions(Caley, Cayley, Cayley), retractions())]
struct Misspelt {
    #[inertia]
    inertia: f64,
}

#[lie_poisson_system(group = SO3, retractions(Cayley), derivatives(state))]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

fn main() {
    let body = Body { inertia: vector![1.0, 2.0, 3.0] };
    let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: Vector3::x() };
    let mut stepper = body.stepper::<Cayley>(0.1).unwrap();
    stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtState).unwrap();
    stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtParameters).unwrap();
    let _ = body.stepper::<Exponential>(0.1);
}
