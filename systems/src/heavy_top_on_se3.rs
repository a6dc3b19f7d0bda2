//! The heavy top on SE(3).

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::{Arrow, Body, Scene};
use serde::{Deserialize, Serialize};

/// The [heavy top](crate::heavy_top::HeavyTop) as the paper integrates it: on all of SE(3), with an auxiliary vector `x` beside the attitude, (6.15)
/// to (6.18).
///
/// Hamiltonian: `H = ½ Π·𝓘⁻¹Π + mg Γ·χ` with the body angular momentum `Π` as the angular and the vertical `Γ`, seen from the body, as the linear
/// part of the momentum.
///
/// Motion: with the velocities `Ω = 𝓘⁻¹Π` and `v = mgχ`, `Π̇ = Π × Ω + mg Γ × χ`, `Γ̇ = Γ × Ω`, `Ṙ = R Ω^`, `ẋ = mg Rχ`.
///
/// `x`, in N m s, has the position's place in the pose, and means no place: it sums up where the weight has pulled. Gravity's torque in space,
/// `RΓ × mg Rχ`, has changed the angular momentum there by `RΓ × x`.
///
/// Invariants: the energy `H`, the Casimirs `|Γ|²` and `Π·Γ`, and in space `RΓ`, which is the vertical, and `RΠ + x × RΓ`.
#[lie_poisson_system(
    group = SE3,
    hamiltonian = 0.5 * angular_momentum.dot(&angular_momentum.component_div(&inertia))
        + weight * linear_momentum.dot(&chi),
    methods(Midpoint),
    units(pose = "1, 1, 1, 1, N m s, N m s, N m s", momentum = "kg m²/s, kg m²/s, kg m²/s, 1, 1, 1"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeavyTopOnSE3 {
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
}

impl HeavyTopOnSE3 {
    /// The state of this attitude and body momentum, with `x = 0`.
    pub fn start(attitude: UnitQuaternion<f64>, momentum: Vector3<f64>) -> HeavyTopOnSE3State {
        let gamma = attitude.inverse() * Vector3::z();
        let pose = Isometry3::from_parts(Vector3::zeros().into(), attitude);
        let momentum = vector![momentum.x, momentum.y, momentum.z, gamma.x, gamma.y, gamma.z];
        HeavyTopOnSE3State { pose, momentum }
    }
}

impl Example for HeavyTopOnSE3 {
    const ABOUT: &'static str =
        "the heavy top on SE(3), with the auxiliary x of the paper's (6.15) to (6.18)";
    const STEP: f64 = 0.01;
    const DURATION: f64 = 60.0;

    /// The top of the paper's figure 6.2.
    fn example() -> (Self, HeavyTopOnSE3State) {
        let top = HeavyTopOnSE3 { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
        (top, Self::start(UnitQuaternion::identity(), vector![1.0, 1.0, 1.0]))
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(Matrix3::from_diagonal(&self.inertia))
    }

    /// The attitude alone: `x` is no place.
    fn scene(&self, _by_state: Scene) -> Scene {
        let angular = Arrow::quantity("momentum").named("angular momentum").symbol("Π").in_body();
        let vertical =
            Arrow::quantity("momentum").from_component(3).named("vertical").symbol("Γ").colour("c4");
        let scene = Scene::default()
            .body(Body::turning("pose").named("body"))
            .arrow(angular)
            .arrow(vertical.in_body());
        scene.top(0, &Matrix3::from_diagonal(&self.inertia), self.weight, self.chi)
    }
}
