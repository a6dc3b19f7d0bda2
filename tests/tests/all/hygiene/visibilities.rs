//! Systems are as visible as their authors say, and can be anywhere items can.

use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3)]
pub struct Public {
    #[inertia]
    pub inertia: f64,
}

#[lie_poisson_system(group = SO3)]
pub(crate) struct Crate {
    #[inertia]
    pub(crate) inertia: f64,
}

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.x, derivatives)]
struct Private {
    #[inertia]
    inertia: f64,
}

mod inner {
    use coadjoint::prelude::*;

    #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.x, derivatives)]
    pub(super) struct Super {
        #[inertia]
        pub(super) inertia: f64,
    }

    #[lie_poisson_system(group = SO3)]
    pub(in crate::hygiene::visibilities) struct Within {
        #[inertia]
        pub(in crate::hygiene::visibilities) inertia: f64,
    }
}

#[test]
fn systems_of_every_visibility_work() {
    let (attitude, momentum, gamma) = (super::rotation(), vector![1.0, 2.0, 3.0], Vector3::z());
    super::drive(&Public { inertia: 1.0 }, &PublicState { attitude, momentum });
    super::drive(&Crate { inertia: 1.0 }, &CrateState { attitude, momentum });
    super::drive(&Private { inertia: 1.0 }, &PrivateState { attitude, momentum, gamma });
    super::drive(&inner::Super { inertia: 1.0 }, &inner::SuperState { attitude, momentum, gamma });
    super::drive(&inner::Within { inertia: 1.0 }, &inner::WithinState { attitude, momentum });
}

#[test]
#[deny(warnings)]
fn systems_live_in_functions() {
    const LOCAL: f64 = 0.5;

    #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = LOCAL * gamma.x, derivatives)]
    #[derive(Debug)]
    struct Inside {
        #[inertia]
        inertia: Vector3<f64>,
    }

    let system = Inside { inertia: vector![1.0, 2.0, 3.0] };
    let state = InsideState {
        attitude: super::rotation(),
        momentum: Vector3::zeros(),
        gamma: vector![2.0, 0.0, 0.0],
    };
    assert_eq!(system.energy(&state), 1.0);
    super::drive(&system, &InsideState { momentum: vector![1.0, 2.0, 3.0], ..state });
    assert_eq!(format!("{system:?}"), "Inside { inertia: [[1.0, 2.0, 3.0]] }");
}
