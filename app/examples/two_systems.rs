//! A program for two systems of one's own, a heavy top and a pendulum that a motor drives:
//! `cargo run --example two_systems -- run heavy_top --plot`.

use coadjoint::prelude::*;
use coadjoint_app::{App, Example, Observables};

/// A rigid body that turns about a fixed point under gravity.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi), methods(Midpoint))]
struct HeavyTop {
    /// Principal moments of inertia about the point, kg m².
    #[inertia]
    inertia: Vector3<f64>,
    /// N.
    weight: f64,
    /// From the point to the centre of mass, m.
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

/// A pendulum that swings in a plane, and a motor.
#[lie_poisson_system(
    group = SO2,
    control(motor: R1),
    potential = -weight * angle.cos_angle(),
    force = motor,
    event(passes = angle.sin_angle()),
    methods(Midpoint),
    taylor,
    units(motor = "N m")
)]
struct DrivenPendulum {
    /// Moment of inertia about the pivot, kg m².
    #[inertia]
    #[unit("kg m²")]
    inertia: f64,
    /// Times the distance from the pivot to the centre of mass, N m.
    #[unit("N m")]
    weight: f64,
}

impl Example for DrivenPendulum {
    const ABOUT: &'static str = "a pendulum that swings in a plane";

    fn example() -> (Self, DrivenPendulumState) {
        let start = DrivenPendulumState { angle: UnitComplex::new(1.0), momentum: vector![0.1] };
        (DrivenPendulum { inertia: 0.1, weight: 3.0 }, start)
    }

    fn observables(own: Observables<Self>) -> Observables<Self> {
        own.with("power", "W", |pendulum, state, _, motor| motor.motor.x * pendulum.velocity(state).x)
    }
}

fn main() -> std::process::ExitCode {
    let app = App::new([HeavyTop::entry(), DrivenPendulum::entry()]);
    app.named("two_systems", "1.2.3", "A heavy top and a driven pendulum.").main()
}
