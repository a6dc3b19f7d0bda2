//! The driven and damped pendulum.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use serde::{Deserialize, Serialize};

/// A pendulum whose axis has friction and a motor that turns it to and fro.
///
/// Hamiltonian: `H = L²/2I + mg l (1 − cos θ)`, with the angle `θ` from the lowest position and the angular momentum `L`
/// about the axis.
///
/// Motion: `θ̇ = L/I`, `L̇ = −mg l sin θ − c θ̇ + T cos(ω t)`.
///
/// Nothing is conserved: friction takes energy and the motor gives it. Without the motor the energy only falls. With it the motion is
/// periodic or chaotic, as parameters have it.
#[lie_poisson_system(
    group = SO2,
    potential = weight * length * (1.0 - angle.cos_angle()),
    force = torque * (frequency * t).cos() - damping * velocity.x,
    methods(Midpoint),
    units(momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DrivenPendulum {
    /// Moment of inertia about the axis, kg m².
    #[inertia]
    #[unit("kg m²")]
    pub inertia: f64,
    /// Mass times gravitational acceleration, N.
    #[unit("N")]
    pub weight: f64,
    /// From the axis to the centre of mass, m.
    #[unit("m")]
    pub length: f64,
    /// Friction's torque for each unit of angular velocity, N m s.
    #[unit("N m s")]
    pub damping: f64,
    /// The largest torque of the motor, N m.
    #[unit("N m")]
    pub torque: f64,
    /// Angular frequency of the motor, rad/s.
    #[unit("rad/s")]
    pub frequency: f64,
}

impl DrivenPendulum {
    /// A bob on a light rod, on Earth, in the numbers without dimension in which this pendulum is studied: quality, and torque and
    /// frequency of the motor relative to those of the pendulum itself.
    pub fn scaled(mass: f64, length: f64, quality: f64, torque: f64, frequency: f64) -> Self {
        let (inertia, weight) = (mass * length * length, mass * 9.81);
        let own = (weight * length / inertia).sqrt();
        Self {
            inertia,
            weight,
            length,
            damping: inertia * own / quality,
            torque: torque * weight * length,
            frequency: frequency * own,
        }
    }
}

impl Example for DrivenPendulum {
    const ABOUT: &'static str = "a pendulum with friction, driven to and fro: chaos";
    const STEP: f64 = 0.01;
    const DURATION: f64 = 120.0;

    /// One kilogram on a rod of one metre with quality 2, driven by 1.15 times the torque of its weight at 2/3 of its own frequency:
    /// chaotic (Baker and Gollub, *Chaotic Dynamics*).
    fn example() -> (Self, DrivenPendulumState) {
        let start = DrivenPendulumState { angle: UnitComplex::new(0.2), momentum: vector![0.0] };
        (Self::scaled(1.0, 1.0, 2.0, 1.15, 2.0 / 3.0), start)
    }

    fn scene(&self, by_state: Scene) -> Scene {
        by_state.bob(0, self.length).weight(0, self.weight, vector![0.0, 0.0, -self.length])
    }
}
