//! The harmonic oscillator.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use serde::{Deserialize, Serialize};

/// A mass on a spring, on a line.
///
/// Hamiltonian: `H = p²/2m + ½ k x²`, with the position `x` from the rest of the spring and the momentum `p`.
///
/// Motion: `ẋ = p/m`, `ṗ = −k x`: oscillations of the period `2π √(m/k)`, whatever their size.
///
/// Invariant: the energy `H`.
#[lie_poisson_system(
    group = R1,
    potential = 0.5 * stiffness * position.norm_squared(),
    methods(Midpoint, Family(1, 4), TangentLift),
    units(position = "m", momentum = "kg m/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HarmonicOscillator {
    /// Mass, kg.
    #[inertia]
    #[unit("kg")]
    pub mass: f64,
    /// Stiffness of the spring, N/m.
    #[unit("N/m")]
    pub stiffness: f64,
}

impl HarmonicOscillator {
    /// The time from one turn to the next but one, s.
    pub fn period(&self) -> f64 {
        std::f64::consts::TAU * (self.mass / self.stiffness).sqrt()
    }
}

impl Example for HarmonicOscillator {
    const ABOUT: &'static str = "a mass on a spring";
    const STEP: f64 = 0.02;
    const DURATION: f64 = 60.0;

    /// Half a kilogram on a spring of 20 N/m, let go 10 cm from where it rests.
    fn example() -> (Self, HarmonicOscillatorState) {
        let oscillator = HarmonicOscillator { mass: 0.5, stiffness: 20.0 };
        (oscillator, HarmonicOscillatorState { position: vector![0.1], momentum: vector![0.0] })
    }

    /// The spring is held half a metre away.
    fn scene(&self, by_state: Scene) -> Scene {
        by_state.named(0, "mass").spring(vector![-0.5, 0.0, 0.0], 0, Vector3::zeros())
    }
}
