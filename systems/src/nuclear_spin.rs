//! Nuclear magnetic resonance.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use serde::{Deserialize, Serialize};

/// The spins of protons in a constant magnetic field, and a weak one across it that turns: nuclear magnetic resonance without relaxation.
///
/// The configuration is the operator `U` in SU(2) by which the spins' states have changed, a unit quaternion. A whole turn of the spin makes it
/// −1, and only two make it 1 again: SO(3) would not know. Momentum and velocity are in space, where the field is.
///
/// Hamiltonian: `H = −γ S·B(t)` with the angular momentum `S` of all spins together, their magnetic moment `γS`, and the field
/// `B = (b cos ωt, −b sin ωt, B₀)`.
///
/// Motion: `Ṡ = γ S × B` (Bloch's equation) and `i U̇ = −½γ (B·σ) U` (Schrödinger's), with Pauli's matrices `σ`: precession about `B₀` at the
/// rate `γB₀`. Where the field across turns with it, `ω = γB₀`, it turns the spins over, at the rate `γb` (I. I. Rabi).
///
/// Invariants: the Casimir `|S|²`. The field's turning does work, so the energy is none.
#[lie_poisson_system(
    group = SU2,
    invariance = right,
    hamiltonian = {
        let across = vector![(frequency * t).cos(), -(frequency * t).sin(), 0.0];
        let field = across_field * across + vector![0.0, 0.0, along_field];
        -gyromagnetic_ratio * momentum.dot(&field)
    },
    methods(Midpoint),
    units(momentum = "N m s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NuclearSpin {
    /// Magnetic moment for each unit of angular momentum, `γ`, rad/(s T).
    #[unit("rad/(s T)")]
    pub gyromagnetic_ratio: f64,
    /// The constant field, along the third axis, `B₀`, T.
    #[unit("T")]
    pub along_field: f64,
    /// The field across that turns, `b`, T.
    #[unit("T")]
    pub across_field: f64,
    /// The angular frequency at which it turns, clockwise seen from above, `ω`, rad/s.
    #[unit("rad/s")]
    pub frequency: f64,
}

impl NuclearSpin {
    /// `γ` of the proton, rad/(s T).
    pub const PROTON: f64 = 2.675_221_9e8;

    /// Protons in these fields, T, in resonance.
    pub fn in_resonance(along_field: f64, across_field: f64) -> Self {
        let gyromagnetic_ratio = Self::PROTON;
        Self { gyromagnetic_ratio, along_field, across_field, frequency: gyromagnetic_ratio * along_field }
    }

    /// The time in which the spins are turned over, s.
    pub fn flip(&self) -> f64 {
        std::f64::consts::PI / (self.gyromagnetic_ratio * self.across_field)
    }

    /// Along the constant field, with this angular momentum, N m s.
    pub fn aligned(momentum: f64) -> NuclearSpinState {
        NuclearSpinState { spin: UnitQuaternion::identity(), momentum: Vector3::z() * momentum }
    }
}

impl Example for NuclearSpin {
    const ABOUT: &'static str =
        "the spins of protons in a magnetic field, turned over by a weak one that turns";
    const STEP: f64 = 1e-5;
    const DURATION: f64 = 0.1;

    /// A litre of water magnetized at 1 T, in the field of the Earth; over in 23 ms, and back.
    fn example() -> (Self, NuclearSpinState) {
        (Self::in_resonance(5e-5, 5e-7), Self::aligned(1.2e-14))
    }
}
