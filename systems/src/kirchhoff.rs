//! A body in an ideal fluid.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use coadjoint_app::shape::{Shape, Solid};
use serde::{Deserialize, Serialize};

/// A rigid body without weight in a fluid without friction, which it sets in motion and which is at rest far away: Kirchhoff's equations.
///
/// Hamiltonian: `H = ½ Π·A Π + Π·B P + ½ P·C P`, with the angular momentum `Π` and the impulse `P` of body and fluid together, in body axes.
/// The fluid that has to move aside makes the body heavier in some directions than in others; `B` is there where the body is a screw.
///
/// Motion: with the velocities `ω = AΠ + BP` and `v = BᵀΠ + CP`, `Π̇ = Π × ω + P × v`, `Ṗ = P × ω`, `Ṙ = R ω^`.
///
/// Invariants: the energy `H` and the Casimirs `|P|²` and `Π·P`. The impulse is fixed in space, so the body sees it as the top sees
/// gravity; where the body is does not matter, and is not followed.
#[lie_poisson_system(
    group = SO3,
    advected(impulse: R3),
    hamiltonian = 0.5 * momentum.dot(&momentum.component_div(&inertia))
        + momentum.dot(&impulse.component_mul(&screw))
        + 0.5 * impulse.dot(&impulse.component_div(&mass)),
    units(momentum = "kg m²/s", impulse = "kg m/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kirchhoff {
    /// Moments of inertia of body and fluid, `A⁻¹`, kg m².
    #[unit("kg m²")]
    pub inertia: Vector3<f64>,
    /// Masses of body and fluid along each axis, `C⁻¹`, kg.
    #[unit("kg")]
    pub mass: Vector3<f64>,
    /// How the body screws along each axis, `B`, 1/(kg m).
    #[unit("1/(kg m)")]
    pub screw: Vector3<f64>,
}

impl Kirchhoff {
    /// The state of this attitude, with this body momentum and this impulse in space.
    pub fn start(
        attitude: UnitQuaternion<f64>,
        momentum: Vector3<f64>,
        impulse: Vector3<f64>,
    ) -> KirchhoffState {
        KirchhoffState { attitude, momentum, impulse: attitude.inverse() * impulse }
    }
}

impl Example for Kirchhoff {
    const ABOUT: &'static str = "a body that moves through an ideal fluid";
    const STEP: f64 = 0.02;
    const DURATION: f64 = 120.0;

    /// A slender ellipsoid with a little of a screw, moving nearly along its long axis, which is not stable: it turns broadside on.
    fn example() -> (Self, KirchhoffState) {
        let body = Kirchhoff {
            inertia: vector![0.8, 0.9, 0.1],
            mass: vector![9.0, 8.5, 5.5],
            screw: vector![0.0, 0.0, 0.05],
        };
        let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.02);
        (body, Self::start(attitude, vector![0.01, 0.0, 0.05], vector![0.0, 0.0, 5.0]))
    }

    /// Slender, as that of the example.
    fn scene(&self, by_state: Scene) -> Scene {
        let body = Shape::Ellipsoid { semi_axes: [0.3, 0.3, 1.0] };
        by_state.solid(0, Solid::new(body).of_any_size())
    }
}
