//! The free rigid body in axes of any direction.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use serde::{Deserialize, Serialize};

/// A rigid body on which nothing acts, described in axes that are not its principal ones: those of its drawing, or of its instruments.
///
/// Hamiltonian: `H = ½ Π·𝓘⁻¹Π`, with the body angular momentum `Π` and the tensor of inertia `𝓘`.
///
/// Motion: Euler's equations `Π̇ = Π × 𝓘⁻¹Π`, and `Ṙ = R (𝓘⁻¹Π)^`.
///
/// Invariants: the energy `H`, the Casimir `|Π|²`, and the angular momentum in space, `RΠ`.
#[lie_poisson_system(group = SO3, units(momentum = "kg m²/s"))]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FullRigidBody {
    /// Tensor of inertia about the centre of mass, kg m².
    #[inertia]
    #[unit("kg m²")]
    pub inertia: Matrix3<f64>,
}

impl Example for FullRigidBody {
    const ABOUT: &'static str = "a rigid body on which nothing acts, in axes of any direction";
    const STEP: f64 = 0.05;
    const DURATION: f64 = 300.0;
    const CASIMIR_UNITS: &'static [&'static str] = &["kg² m⁴/s²"];

    /// A small satellite with its panels out, tumbling at about two turns a minute.
    fn example() -> (Self, FullRigidBodyState) {
        let inertia = matrix![
            24.0, 3.0, -2.0;
            3.0, 41.0, 1.5;
            -2.0, 1.5, 55.0;
        ];
        let velocity = vector![0.02, 0.2, 0.05];
        let start = FullRigidBodyState { attitude: UnitQuaternion::identity(), momentum: inertia * velocity };
        (FullRigidBody { inertia }, start)
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(self.inertia)
    }
}
