//! The heavy top.

use coadjoint::prelude::*;

use crate::catalogued::Catalogued;

/// A rigid body that turns about a fixed point under gravity.
///
/// Hamiltonian: `H = ½ Π·𝓘⁻¹Π + mg Γ·χ`, with the body angular momentum `Π` and the vertical `Γ = Rᵀe₃` as the body
/// sees it; gravity makes `Γ` a variable of its own.
///
/// Motion: `Π̇ = Π × 𝓘⁻¹Π + mg Γ × χ`, `Γ̇ = Γ × 𝓘⁻¹Π`, `Ṙ = R (𝓘⁻¹Π)^`.
///
/// Invariants: the energy `H`, the Casimirs `|Γ|²` and `Π·Γ` (the angular momentum about the vertical).
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeavyTop {
    /// Principal moments of inertia about the fixed point, kg m².
    #[inertia]
    pub inertia: Vector3<f64>,
    /// Mass times gravitational acceleration, N.
    pub weight: f64,
    /// From the fixed point to the centre of mass, in body axes, m.
    pub chi: Vector3<f64>,
}

impl Catalogued for HeavyTop {
    const ABOUT: &'static str = "a rigid body that turns about a fixed point under gravity";
    const STEP: f64 = 0.01;
    const DURATION: f64 = 60.0;
    const CASIMIR_UNITS: &'static [&'static str] = &["", "kg m²/s"];

    /// The top of the paper's figure 6.2.
    fn example() -> (Self, HeavyTopState) {
        let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
        let start = HeavyTopState {
            attitude: UnitQuaternion::identity(),
            momentum: vector![1.0, 1.0, 1.0],
            gamma: Vector3::z(),
        };
        (top, start)
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(Matrix3::from_diagonal(&self.inertia))
    }
}
