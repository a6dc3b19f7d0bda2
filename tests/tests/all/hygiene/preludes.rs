//! The prelude goes together with those of other crates: names that are theirs are not ours.

use coadjoint::prelude::*;

use theirs::*;

/// What bevy, log, rand, serde and others call things.
mod theirs {
    #[derive(Debug, PartialEq)]
    pub struct State(pub u8);
    pub struct Control;
    pub struct Distribution;
    pub struct Every;
    pub struct Family;
    pub struct Record;
    pub struct Run;
    pub struct Tick;
    pub struct Unit;
    pub trait Deserialize {}
    pub trait Observer {}
    pub trait Serialize {}
    pub trait System {
        fn name(&self) -> &'static str;
    }
}

#[lie_poisson_system(group = SO3)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

impl Deserialize for (Control, Distribution, Every, Family) {}
impl Serialize for (Record, Run, Tick, Unit) {}
impl Observer for Body {}

impl System for Body {
    fn name(&self) -> &'static str {
        "theirs"
    }
}

#[test]
fn common_names_are_left_to_others() {
    let body = Body { inertia: vector![1.0, 2.0, 4.0] };
    let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 0.0, 2.0] };
    assert_eq!((body.name(), State(1)), ("theirs", State(1)));
    // of ours there are the methods
    assert_eq!(body.energy(&state), 1.0);
    assert_eq!(state.to_components()[4..], [1.0, 0.0, 2.0]);
    let mut stepper = body.stepper::<Cayley>(0.1).expect("a stepper");
    stepper.step_with(&mut state, &NoControl::default()).expect("a step");
}
