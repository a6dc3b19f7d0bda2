//! Tests of units, and a few systems of different kinds that all tests are made with.

use std::sync::LazyLock;

use coadjoint::prelude::*;
use coadjoint::system::Quantity;

use crate::catalogue::{component_unit, unit};
use crate::{Catalogue, Example};

/// A heavy top: an attitude and an advected vector.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
    methods(Midpoint),
    units(momentum = "kg m²/s")
)]
pub(crate) struct HeavyTop {
    /// Principal moments of inertia about the fixed point, kg m².
    #[inertia]
    #[unit("kg m²")]
    pub(crate) inertia: Vector3<f64>,
    /// Mass times gravitational acceleration, N.
    #[unit("N")]
    pub(crate) weight: f64,
    /// From the fixed point to the centre of mass, in body axes, m.
    #[unit("m")]
    pub(crate) chi: Vector3<f64>,
}

impl Example for HeavyTop {
    const ABOUT: &'static str = "a rigid body that turns about a fixed point under gravity";
    const CASIMIR_UNITS: &'static [&'static str] = &["", "kg m²/s"];

    fn example() -> (Self, HeavyTopState) {
        let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
        let start = HeavyTopState {
            attitude: UnitQuaternion::identity(),
            momentum: vector![1.0, 1.0, 1.0],
            gamma: Vector3::z(),
        };
        (top, start)
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(Matrix3::from_diagonal(&self.inertia))
    }
}

/// A pendulum: a rotation in the plane, and a motor.
#[lie_poisson_system(
    group = SO2,
    control(torque: R1),
    potential = -weight * length * angle.cos_angle(),
    force = torque,
    methods(Midpoint)
)]
pub(crate) struct PlanarPendulum {
    /// Moment of inertia about the axis, kg m².
    #[inertia]
    pub(crate) inertia: f64,
    /// Mass times gravitational acceleration, N.
    pub(crate) weight: f64,
    /// From the axis to the centre of mass, m.
    pub(crate) length: f64,
}

impl Example for PlanarPendulum {
    const ABOUT: &'static str = "a pendulum that swings in a plane";

    fn example() -> (Self, PlanarPendulumState) {
        let pendulum = PlanarPendulum { inertia: 0.1, weight: 9.81, length: 0.3 };
        (pendulum, PlanarPendulumState { angle: UnitComplex::new(1.0), momentum: vector![0.0] })
    }
}

/// A body in space: a rigid motion.
#[lie_poisson_system(
    group = SE3,
    retractions(Cayley),
    units(
        pose = "1, 1, 1, 1, m, m, m",
        momentum = "kg m²/s, kg m²/s, kg m²/s, kg m/s, kg m/s, kg m/s"
    )
)]
pub(crate) struct RigidBodyInSpace {
    /// Inertia of turning and moving together.
    #[inertia]
    pub(crate) inertia: Matrix6<f64>,
}

impl Example for RigidBodyInSpace {
    const ABOUT: &'static str = "a rigid body that turns and moves in space";

    fn example() -> (Self, RigidBodyInSpaceState) {
        let body =
            RigidBodyInSpace { inertia: Matrix6::from_diagonal(&Vector6::new(1.0, 2.0, 2.5, 3.0, 3.0, 3.0)) };
        let start = RigidBodyInSpaceState {
            pose: Isometry3::identity(),
            momentum: Vector6::new(1.0, 0.1, 0.2, 0.5, 0.0, 0.0),
        };
        (body, start)
    }
}

/// A planet: a position, and a potential that is infinite at the centre.
#[lie_poisson_system(group = R3, potential = -mass * attraction / position.norm(), methods(Midpoint))]
pub(crate) struct Kepler {
    /// Mass of the satellite, kg.
    #[inertia]
    pub(crate) mass: f64,
    /// Constant of gravitation times the mass of the heavy body, m³/s².
    pub(crate) attraction: f64,
}

impl Example for Kepler {
    const ABOUT: &'static str = "a planet about the sun";

    fn example() -> (Self, KeplerState) {
        let start = KeplerState { position: vector![1.0, 0.0, 0.0], momentum: vector![0.0, 0.8, 0.0] };
        (Kepler { mass: 1.0, attraction: 1.0 }, start)
    }
}

/// All of them.
pub(crate) fn catalogue() -> &'static Catalogue {
    static CATALOGUE: LazyLock<Catalogue> = LazyLock::new(|| {
        let entries =
            [HeavyTop::entry(), PlanarPendulum::entry(), RigidBodyInSpace::entry(), Kepler::entry()];
        Catalogue::new(entries.map(|entry| entry.with_source(include_str!("tests.rs"))))
    });
    &CATALOGUE
}

#[test]
fn units_are_those_of_the_description() {
    let top = catalogue().find("heavy_top").expect("it is there");
    let of = |quantities: &'static [Quantity]| quantities.iter().map(unit).collect::<Vec<_>>();
    assert_eq!(of(top.description.parameters), ["kg m²", "N", "m"]);
    assert_eq!(of(top.description.state), ["", "kg m²/s", ""]);
    assert_eq!(top.energy_unit, "J");
    assert_eq!(top.casimirs().map(|(_, unit)| unit).collect::<Vec<_>>(), ["", "kg m²/s"]);
    // components with units of their own
    let body = catalogue().find("rigid_body_in_space").expect("it is there");
    assert_eq!(of(body.description.state), ["", ""]);
    let [pose, momentum] = body.description.state else { panic!("a pose and a momentum") };
    let units = [(pose, 0), (pose, 4), (momentum, 2), (momentum, 3)].map(|(of, k)| component_unit(of, k));
    assert_eq!(units, ["", "m", "kg m²/s", "kg m/s"]);
}
