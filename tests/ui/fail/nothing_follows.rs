//! After a problem of the description there are no others about what it would have made.

use coadjoint::prelude::*;
use coadjoint::{Invariants, Run, System};

#[lie_poisson_system(group = S4, advected(gamma: R3), control(moment: R3), potential = gamma.z, derivatives)]
#[derive(Clone, Debug)]
pub struct Top {
    #[inertia]
    inertia: Vector3<f64>,
}

impl Top {
    fn height(&self, state: &TopState) -> f64 {
        state.gamma.z / self.inertia.norm()
    }
}

trait Named {
    const NAME: &'static str;
}

impl Named for Top {
    const NAME: &'static str = "top";
}

fn drive<S: System>(_: &S, _: &S::State) {}

fn fly(top: &Top) -> Result<TopState, Box<dyn std::error::Error>> {
    let mut state =
        TopState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros(), gamma: Vector3::x() };
    let mut stepper = top.stepper::<Exponential>(0.1)?;
    stepper.step(&mut state)?;
    stepper.step_with(&mut state, &TopControl { moment: Vector3::x(), ..Default::default() })?;
    Run::new(&mut stepper, &mut state).observe(&mut Invariants::new()).steps(10)?;
    drive(top, &state);
    println!("{} {} {:?}", top.energy(&state), top.height(&state), Top::CASIMIRS);
    println!("{:?} {}", TopIndices::MOMENTUM, <Top as Named>::NAME);
    Ok(state)
}

fn main() {
    let top = Top { inertia: Vector3::x() };
    fly(&top).unwrap();
}

// one mistake in an expression leaves everything else as it is
#[lie_poisson_system(group = SO3, potential = wieght * attitude.w, force = momentum.dott(&momentum))]
struct Body {
    #[inertia]
    inertia: f64,
    weight: f64,
}

fn turn(body: &Body) -> f64 {
    let state = BodyState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros() };
    body.stepper::<Cayley>(0.1).unwrap();
    body.potential(&state) + body.force(&state).norm() + body.weight
}

// nor does a mistake in another key, or in a field
#[lie_poisson_system(group = SE3, methods(Midpiont), hamiltonian = , force = angular_velocity)]
struct Hull {
    inertia: f64,
    name: String,
}

fn sail(hull: Hull, state: &mut HullState) -> f64 {
    let copy = Hull { inertia: 1.0, ..hull };
    copy.stepper::<Midpoint>(0.1).unwrap().step(state).unwrap();
    copy.hamiltonian(state) + state.momentum.norm() + copy.inertia
}
