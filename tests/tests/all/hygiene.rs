//! Generated code lives in users' code: under any name for the crate, without a prelude, beside any names, under any lints.

// Most of what is defined here only has to compile, or to be in the way.
#![allow(dead_code, unreachable_pub, unused_macros)]

mod attributes;
mod called;
mod determinism;
mod fields;
mod parts;
mod potentials;
mod preludes;
mod shadowed;
// as reachable as the root: some lints that users deny ask for that
pub mod strict;
mod the_crate_under_another_name;
mod visibilities;
#[no_implicit_prelude]
mod without_a_prelude;

use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_support::random::Random;

/// Takes one step with each retraction, so that generated code is compiled to the end, and checks it a little: the energy is almost
/// kept.
fn drive<S>(system: &S, start: &S::State)
where
    S: System<Scalar = f64> + Discretized<Exponential> + Discretized<Cayley>,
{
    drive_with::<S, Exponential>(system, start);
    drive_with::<S, Cayley>(system, start);
}

fn drive_with<S, M>(system: &S, start: &S::State)
where
    S: System<Scalar = f64> + Discretized<M>,
{
    let before = system.energy(start);
    let mut state = start.clone();
    system.stepper::<M>(1e-3).expect("a stepper").step(&mut state).expect("a step");
    assert!((system.energy(&state) - before).abs() < 1e-6 * (1.0 + before.abs()));
    assert_ne!(&state, start, "nothing moves");
    // parameters and state survive being flattened
    let again = S::from_parameters(&system.to_parameters());
    assert_eq!(again.to_parameters(), system.to_parameters());
    assert_eq!(&S::State::from_components(&start.to_components()), start);
}

fn rotation() -> UnitQuaternion<f64> {
    Random::new(0).rotation()
}

#[test]
fn no_prelude_is_needed() {
    let momentum = vector![1.0, 2.0, 3.0];
    let bare = without_a_prelude::Bare {
        inertia: Matrix3::from_diagonal(&vector![1.0, 2.0, 3.0]),
        weight: 1.0,
        chi: Vector3::x(),
        response: Matrix3::identity(),
    };
    drive(
        &bare,
        &without_a_prelude::BareState {
            attitude: rotation(),
            momentum,
            gamma: Vector3::z(),
            field: Vector3::y(),
        },
    );
    drive(
        &without_a_prelude::BareBody { inertia: 2.0 },
        &without_a_prelude::BareBodyState { attitude: rotation(), momentum },
    );
}
