//! Steps and derivatives that were not generated: one message for each, in words of the description. A force makes two halves of the standard
//! step.

use coadjoint::derivative::WrtState;
use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3, control(moment: R3), force = moment, retractions(Cayley))]
struct Satellite {
    #[inertia]
    inertia: Vector3<f64>,
}

fn exponential(satellite: &Satellite, state: &mut SatelliteState) {
    let mut stepper = satellite.stepper::<Exponential>(0.1).unwrap();
    stepper.step(state).unwrap();
}

fn midpoint(satellite: &Satellite, state: &mut SatelliteState) {
    let mut stepper = satellite.stepper::<Midpoint<Cayley>>(0.1).unwrap();
    stepper.step(state).unwrap();
}

fn composed(satellite: &Satellite, state: &mut SatelliteState) {
    let mut stepper = satellite.stepper::<Order4<Midpoint<Cayley>>>(0.1).unwrap();
    stepper.step(state).unwrap();
}

fn jacobian(satellite: &Satellite, state: &mut SatelliteState) {
    let mut stepper = satellite.stepper::<Cayley>(0.1).unwrap();
    let step = stepper.step_with_jacobian(state, &SatelliteControl::default(), WrtState).unwrap();
    println!("{}", step.0);
}

fn derivative(satellite: &Satellite, state: &mut SatelliteState) {
    let mut stepper = satellite.stepper::<Cayley>(0.1).unwrap();
    let (derivative, _) = stepper.step_with_derivative(state, &SatelliteControl::default()).unwrap();
    println!("{derivative:?}");
}

fn main() {
    let satellite = Satellite { inertia: vector![1.0, 2.0, 3.0] };
    let mut state = SatelliteState { attitude: UnitQuaternion::identity(), momentum: Vector3::x() };
    exponential(&satellite, &mut state);
    midpoint(&satellite, &mut state);
    composed(&satellite, &mut state);
    jacobian(&satellite, &mut state);
    derivative(&satellite, &mut state);
}
