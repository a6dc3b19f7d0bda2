//! The two-body problem.

use std::f64::consts::PI;

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use coadjoint_app::shape::{Shape, Solid};
use serde::{Deserialize, Serialize};

/// Two masses that attract each other, both of them moving, as the stars of a double star do: (1.12) to (1.18) of the paper.
///
/// Hamiltonian: `H = |p₁|²/2m₁ + |p₂|²/2m₂ − G m₁m₂/|r₂ − r₁|`, with the positions `r₁` and `r₂` and the momenta in space: the energy (1.16).
///
/// Motion: `ṙᵢ = pᵢ/mᵢ`, `ṗ₁ = −ṗ₂ = G m₁m₂ (r₂ − r₁)/|r₂ − r₁|³`. Divided by the masses these are (1.12), where `m₁m₁` is misprinted for
/// `m₁m₂`, and (1.13). The centre of mass moves uniformly (1.14). What is left, `r = r₂ − r₁`, moves as a [satellite](crate::kepler::Kepler) of
/// `m₁ + m₂` (1.15).
///
/// Invariants: the energy `H`, the momentum `p₁ + p₂`, and the angular momentum `r₁ × p₁ + r₂ × p₂` (1.17).
#[lie_poisson_system(
    group(first: R3, second: R3),
    potential = -gravitation * first_mass * second_mass / (second - first).norm(),
    methods(Midpoint),
    units(first = "m", first_momentum = "kg m/s", second = "m", second_momentum = "kg m/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TwoBodies {
    /// Mass of the first body, kg.
    #[inertia(first)]
    #[unit("kg")]
    pub first_mass: f64,
    /// Mass of the second body, kg.
    #[inertia(second)]
    #[unit("kg")]
    pub second_mass: f64,
    /// Constant of gravitation, m³/(kg s²).
    #[unit("m³/(kg s²)")]
    pub gravitation: f64,
}

impl TwoBodies {
    /// The constant of gravitation in SI units, m³/(kg s²).
    pub const GRAVITATION: f64 = 6.674_3e-11;

    /// Where they come closest on ellipses in the plane `z = 0`, with their centre of mass at rest in the origin; `semi_major_axis` is that of
    /// their distance.
    pub fn at_pericentre(&self, semi_major_axis: f64, eccentricity: f64) -> TwoBodiesState {
        let total = self.first_mass + self.second_mass;
        let distance = Vector3::x() * (semi_major_axis * (1.0 - eccentricity));
        let reduced = self.first_mass * self.second_mass / total;
        let attraction = self.gravitation * total;
        let speed = (attraction / semi_major_axis * (1.0 + eccentricity) / (1.0 - eccentricity)).sqrt();
        let momentum = Vector3::y() * (reduced * speed);
        TwoBodiesState {
            first: distance * (-self.second_mass / total),
            first_momentum: -momentum,
            second: distance * (self.first_mass / total),
            second_momentum: momentum,
        }
    }

    /// The time of one revolution, s.
    pub fn period(&self, semi_major_axis: f64) -> f64 {
        let attraction = self.gravitation * (self.first_mass + self.second_mass);
        std::f64::consts::TAU * (semi_major_axis.powi(3) / attraction).sqrt()
    }

    /// The centre of mass, m.
    pub fn centre(&self, state: &TwoBodiesState) -> Vector3<f64> {
        (state.first * self.first_mass + state.second * self.second_mass)
            / (self.first_mass + self.second_mass)
    }

    /// `r₁ × p₁ + r₂ × p₂`, kg m²/s.
    pub fn angular_momentum(state: &TwoBodiesState) -> Vector3<f64> {
        state.first.cross(&state.first_momentum) + state.second.cross(&state.second_momentum)
    }
}

impl Example for TwoBodies {
    const ABOUT: &'static str = "two balls of lead that fall about each other";
    const STEP: f64 = 100.0;
    const DURATION: f64 = 200_000.0;

    /// A tonne of lead and 300 kg of it, far from everything else, from 0.8 m to 3.2 m apart: once about each other in 16.8 hours.
    fn example() -> (Self, TwoBodiesState) {
        let balls = TwoBodies { first_mass: 1000.0, second_mass: 300.0, gravitation: Self::GRAVITATION };
        let start = balls.at_pericentre(2.0, 0.6);
        (balls, start)
    }

    /// Balls of lead, kg/m³.
    fn scene(&self, by_state: Scene) -> Scene {
        const LEAD: f64 = 11_340.0;
        let ball = |mass: f64| Solid::new(Shape::Sphere { radius: (0.75 / PI * mass / LEAD).cbrt() });
        by_state.solid(0, ball(self.first_mass)).solid(1, ball(self.second_mass))
    }
}
