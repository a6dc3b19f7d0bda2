//! The magnetic top.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::{Arrow, Scene};
use serde::{Deserialize, Serialize};

/// A magnet that turns about a fixed point in two fields at once: that of gravity, and a magnetic one.
///
/// Hamiltonian: `H = ½ Π·𝓘⁻¹Π + mg Γ·χ − B·d`, with the body angular momentum `Π`, and the vertical `Γ` and the magnetic field `B`
/// as the body sees them.
///
/// Motion: `Π̇ = Π × 𝓘⁻¹Π + mg Γ × χ − B × d`, `Γ̇ = Γ × 𝓘⁻¹Π`, `Ḃ = B × 𝓘⁻¹Π`, `Ṙ = R (𝓘⁻¹Π)^`.
///
/// Invariants: the energy `H` and the Casimirs `|Γ|²`, `|B|²`, `Γ·B`. There is no direction about which both fields look the same, so
/// no component of the angular momentum is kept.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3, field: R3),
    potential = weight * gamma.dot(&chi) - field.dot(&dipole),
    units(momentum = "kg m²/s", field = "T"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MagneticTop {
    /// Principal moments of inertia about the fixed point, kg m².
    #[inertia]
    #[unit("kg m²")]
    pub inertia: Vector3<f64>,
    /// Mass times gravitational acceleration, N.
    #[unit("N")]
    pub weight: f64,
    /// From the fixed point to the centre of mass, in body axes, m.
    #[unit("m")]
    pub chi: Vector3<f64>,
    /// Magnetic moment, in body axes, A m².
    #[unit("A m²")]
    pub dipole: Vector3<f64>,
}

impl MagneticTop {
    /// The state of this attitude and body momentum in a magnetic field, in space, T.
    pub fn start(
        attitude: UnitQuaternion<f64>,
        momentum: Vector3<f64>,
        field: Vector3<f64>,
    ) -> MagneticTopState {
        let body = attitude.inverse();
        MagneticTopState { attitude, momentum, gamma: body * Vector3::z(), field: body * field }
    }
}

impl Example for MagneticTop {
    const ABOUT: &'static str = "a magnet that turns about a fixed point under gravity, in a magnetic field";
    const STEP: f64 = 0.001;
    const DURATION: f64 = 10.0;

    /// A spinning magnet of 40 g, somewhat upright, in a field of 10 mT across.
    fn example() -> (Self, MagneticTopState) {
        let top = MagneticTop {
            inertia: vector![6e-5, 6.5e-5, 2e-5],
            weight: 0.04 * 9.81,
            chi: vector![0.0, 0.0, 0.03],
            dipole: vector![0.2, 0.0, 0.8],
        };
        let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.5);
        let start = Self::start(attitude, vector![0.0, 0.0, 2e-5 * 100.0], vector![0.01, 0.0, 0.0]);
        (top, start)
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(Matrix3::from_diagonal(&self.inertia))
    }

    fn scene(&self, by_state: Scene) -> Scene {
        let dipole = Arrow::constant("dipole", self.dipole, "A m²").symbol("d").colour("c5").in_body();
        by_state.top(0, &Matrix3::from_diagonal(&self.inertia), self.weight, self.chi).arrow(dipole)
    }
}
