//! A program for two systems of one's own: `cargo run --example pendulum_and_body -- run pendulum --plot`.

use coadjoint::prelude::*;
use coadjoint_app::Example;

/// A pendulum that swings in a plane, and a motor.
#[lie_poisson_system(
    group = SO2,
    control(torque: R1),
    potential = -weight * length * angle.cos_angle(),
    force = torque,
    methods(Midpoint)
)]
struct Pendulum {
    /// Moment of inertia about the pivot, kg m².
    #[inertia]
    inertia: f64,
    /// N.
    weight: f64,
    /// From the pivot to the centre of mass, m.
    length: f64,
}

impl Example for Pendulum {
    const ABOUT: &'static str = "a pendulum that swings in a plane";
    const UNITS: &'static [(&'static str, &'static str)] =
        &[("inertia", "kg m²"), ("weight", "N"), ("length", "m"), ("torque", "N m")];

    fn example() -> (Self, PendulumState) {
        let pendulum = Pendulum { inertia: 0.1, weight: 9.81, length: 0.3 };
        (pendulum, PendulumState { angle: UnitComplex::new(1.0), momentum: vector![0.0] })
    }
}

/// A rigid body on which nothing acts.
#[lie_poisson_system(group = SO3)]
struct FreeBody {
    /// Principal moments of inertia, kg m².
    #[inertia]
    inertia: Vector3<f64>,
}

impl Example for FreeBody {
    const ABOUT: &'static str = "a rigid body on which nothing acts";

    fn example() -> (Self, FreeBodyState) {
        let start =
            FreeBodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.01, 1.0, 0.01] };
        (FreeBody { inertia: vector![1.0, 2.0, 3.0] }, start)
    }
}

fn main() -> std::process::ExitCode {
    coadjoint_app::main([Pendulum::entry(), FreeBody::entry()])
}
