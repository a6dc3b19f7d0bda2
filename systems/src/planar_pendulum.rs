//! The planar pendulum.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use serde::{Deserialize, Serialize};

/// A body that swings about a horizontal axis under gravity.
///
/// Hamiltonian: `H = L²/2I + mg l (1 − cos θ)`, with the angle `θ` from the lowest position and the angular momentum `L`
/// about the axis.
///
/// Motion: `θ̇ = L/I`, `L̇ = −mg l sin θ`: small swings have the period `2π √(I/mgl)`, larger ones a longer one.
///
/// Invariant: the energy `H`. Above `2 mg l` it turns over and over.
#[lie_poisson_system(
    group = SO2,
    potential = weight * length * (1.0 - angle.cos_angle()),
    methods(Midpoint),
    units(momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanarPendulum {
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
}

impl PlanarPendulum {
    /// A small heavy bob on a light rod, on Earth.
    pub fn simple(mass: f64, length: f64) -> Self {
        Self { inertia: mass * length * length, weight: mass * 9.81, length }
    }

    /// At rest at an angle from the lowest position, rad.
    pub fn at_rest(angle: f64) -> PlanarPendulumState {
        PlanarPendulumState { angle: UnitComplex::new(angle), momentum: vector![0.0] }
    }

    /// The period of small swings, s.
    pub fn small_period(&self) -> f64 {
        std::f64::consts::TAU * (self.inertia / (self.weight * self.length)).sqrt()
    }
}

impl Example for PlanarPendulum {
    const ABOUT: &'static str = "a pendulum that swings about a horizontal axis";
    const STEP: f64 = 0.01;
    const DURATION: f64 = 60.0;

    /// One kilogram on a rod of one metre, let go high above its axis: 150° from its lowest position.
    fn example() -> (Self, PlanarPendulumState) {
        (Self::simple(1.0, 1.0), Self::at_rest(150_f64.to_radians()))
    }

    fn scene(&self, by_state: Scene) -> Scene {
        by_state.bob(0, self.length).weight(0, self.weight, vector![0.0, 0.0, -self.length])
    }
}
