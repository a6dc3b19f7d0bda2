//! The free rigid body.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use serde::{Deserialize, Serialize};

/// A rigid body on which nothing acts: it tumbles.
///
/// Hamiltonian: `H = ½ Π·𝓘⁻¹Π`, with the body angular momentum `Π`.
///
/// Motion: Euler's equations `Π̇ = Π × 𝓘⁻¹Π`, and `Ṙ = R (𝓘⁻¹Π)^`.
///
/// Invariants: the energy `H`, the Casimir `|Π|²`, and the angular momentum in space, `RΠ`.
#[lie_poisson_system(
    group = SO3,
    methods(Midpoint, Family(1, 4), TangentLift, TangentMidpoint, HamiltonJacobi(6)),
    retractions(Exponential, Cayley, SecondKind),
    taylor,
    units(momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreeRigidBody {
    /// Principal moments of inertia about the centre of mass, kg m².
    #[inertia]
    #[unit("kg m²")]
    pub inertia: Vector3<f64>,
}

impl Example for FreeRigidBody {
    const ABOUT: &'static str = "a rigid body on which nothing acts";
    const STEP: f64 = 0.01;
    const DURATION: f64 = 60.0;
    const CASIMIR_UNITS: &'static [&'static str] = &["kg² m⁴/s²"];

    /// A brick turning close to its middle axis: it flips over, again and again.
    fn example() -> (Self, FreeRigidBodyState) {
        let body = FreeRigidBody { inertia: vector![1.0, 2.0, 2.5] };
        let start =
            FreeRigidBodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.01, 2.0, 0.01] };
        (body, start)
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(Matrix3::from_diagonal(&self.inertia))
    }
}
