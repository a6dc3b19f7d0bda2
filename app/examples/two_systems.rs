//! A program for two systems: a heavy top, and a pendulum that a motor drives.

use coadjoint::prelude::*;
use coadjoint_app::Example;

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi), methods(Midpoint))]
struct HeavyTop {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

impl Example for HeavyTop {
    const ABOUT: &'static str = "a rigid body that turns about a fixed point under gravity";

    fn example() -> (Self, HeavyTopState) {
        let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
        let attitude = UnitQuaternion::identity();
        (top, HeavyTopState { attitude, momentum: vector![1.0, 1.0, 1.0], gamma: Vector3::z() })
    }
}

#[lie_poisson_system(group = SO2, control(motor: R1), potential = -weight * angle.cos_angle(), force = motor)]
struct DrivenPendulum {
    #[inertia]
    inertia: f64,
    weight: f64,
}

impl Example for DrivenPendulum {
    fn example() -> (Self, DrivenPendulumState) {
        let start = DrivenPendulumState { angle: UnitComplex::new(1.0), momentum: vector![0.1] };
        (DrivenPendulum { inertia: 0.1, weight: 3.0 }, start)
    }
}

fn main() -> std::process::ExitCode {
    coadjoint_app::main([HeavyTop::entry(), DrivenPendulum::entry()])
}
