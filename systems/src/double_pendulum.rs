//! The double pendulum.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use serde::{Deserialize, Serialize};

/// A pendulum that hangs from another one: two point masses on light rods in a vertical plane.
///
/// Lagrangian, with the angles `θ₁`, `θ₂` of the rods from the vertical and their velocities `ω₁`, `ω₂`:
///
/// ```text
/// l = ½ (m₁+m₂) l₁² ω₁² + ½ m₂ l₂² ω₂² + m₂ l₁ l₂ ω₁ ω₂ cos(θ₁−θ₂)
///   + (m₁+m₂) g l₁ cos θ₁ + m₂ g l₂ cos θ₂
/// ```
///
/// The mass matrix depends on the angles; the momenta `p = ∂l/∂ω` mix both velocities.
///
/// Invariant: the energy. Small swings are the sum of two modes; large ones are chaotic.
#[lie_poisson_system(
    group(first: SO2, second: SO2),
    lagrangian = {
        let (upper, lower) = (first_velocity.x, second_velocity.x);
        let between = first.inverse() * second;
        let kinetic = (upper_mass + lower_mass) * upper_length.powi(2) * upper.powi(2) / 2.0
            + lower_mass * lower_length.powi(2) * lower.powi(2) / 2.0
            + lower_mass * upper_length * lower_length * upper * lower * between.cos_angle();
        let potential = -(upper_mass + lower_mass) * gravity * upper_length * first.cos_angle()
            - lower_mass * gravity * lower_length * second.cos_angle();
        kinetic - potential
    },
    methods(Midpoint),
    taylor,
    units(first_momentum = "kg m²/s", second_momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DoublePendulum {
    /// The mass at the end of the upper rod, kg.
    #[unit("kg")]
    pub upper_mass: f64,
    /// The mass at the end of the lower rod, kg.
    #[unit("kg")]
    pub lower_mass: f64,
    /// The length of the upper rod, m.
    #[unit("m")]
    pub upper_length: f64,
    /// The length of the lower rod, m.
    #[unit("m")]
    pub lower_length: f64,
    /// Gravitational acceleration, m/s².
    #[unit("m/s²")]
    pub gravity: f64,
}

impl DoublePendulum {
    /// Two masses of a kilogram on rods of a metre, on Earth.
    pub fn equal() -> Self {
        Self { upper_mass: 1.0, lower_mass: 1.0, upper_length: 1.0, lower_length: 1.0, gravity: 9.81 }
    }

    /// At rest at two angles from the vertical, rad.
    pub fn at_rest(first: f64, second: f64) -> DoublePendulumState {
        DoublePendulumState {
            first: UnitComplex::new(first),
            first_momentum: vector![0.0],
            second: UnitComplex::new(second),
            second_momentum: vector![0.0],
        }
    }
}

impl Example for DoublePendulum {
    const ABOUT: &'static str = "a pendulum that hangs from another one, described by its Lagrangian";
    const STEP: f64 = 0.005;
    const DURATION: f64 = 30.0;

    /// Let go with the upper rod 100° and the lower one 150° from hanging: both turn over, again and again.
    fn example() -> (Self, DoublePendulumState) {
        (Self::equal(), Self::at_rest(100_f64.to_radians(), 150_f64.to_radians()))
    }

    fn scene(&self, by_state: Scene) -> Scene {
        let joint = vector![0.0, 0.0, -self.upper_length];
        by_state.hang(1, 0, joint).bob(0, self.upper_length).bob(1, self.lower_length)
    }
}
