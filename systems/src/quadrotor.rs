//! The quadrotor.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::{Arrow, Scene};
use coadjoint_app::shape::{Shape, Solid};
use serde::{Deserialize, Serialize};

/// A rigid body with four propellers: they pull along its third axis, and turn it by pulling unequally.
///
/// Hamiltonian: `H = ½ Π·𝓘⁻¹Π + |p|²/2m + mg z`, with the body angular momentum `Π`, the position `x` of the centre of mass, whose
/// height is `z`, and the momentum `p` in space.
///
/// Motion: `Ṙ = R (𝓘⁻¹Π)^`, `Π̇ = Π × 𝓘⁻¹Π + M`, `ẋ = p/m`, `ṗ = −mg e₃ + F R e₃`, with the controls `M`, the moment in body axes, and
/// `F`, the thrust, held over each step.
///
/// Nothing is conserved while the propellers work. In hover, at rest upright with `F = mg` and `M = 0`, it stays where it is; these
/// are also the values of the open controls that the program runs it with.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(attitude = moment, position = attitude * (thrust * Vector3::z())),
    methods(Midpoint),
    units(
        attitude_momentum = "kg m²/s",
        position = "m",
        position_momentum = "kg m/s",
        moment = "N m",
        thrust = "N",
    ),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quadrotor {
    /// Principal moments of inertia about the centre of mass, kg m².
    #[inertia(attitude)]
    #[unit("kg m²")]
    pub inertia: Vector3<f64>,
    /// Mass, kg.
    #[inertia(position)]
    #[unit("kg")]
    pub mass: f64,
    /// Gravitational acceleration, m/s².
    #[unit("m/s²")]
    pub gravity: f64,
}

impl Quadrotor {
    /// From the centre of [Lee's vehicle](Self::lee) to the axis of a propeller, m.
    pub const ARM: f64 = 0.315;

    /// What keeps it in hover: `F = mg`, `M = 0`.
    pub fn hover(&self) -> QuadrotorControl {
        QuadrotorControl { moment: Vector3::zeros(), thrust: self.mass * self.gravity }
    }

    /// At rest upright at a height above the origin, m.
    pub fn at_rest(height: f64) -> QuadrotorState {
        QuadrotorState {
            attitude: UnitQuaternion::identity(),
            attitude_momentum: Vector3::zeros(),
            position: vector![0.0, 0.0, height],
            position_momentum: Vector3::zeros(),
        }
    }

    /// The vehicle of T. Lee, M. Leok and N. H. McClamroch, *Geometric tracking control of a quadrotor UAV on SE(3)* (2010).
    pub fn lee() -> Self {
        Self { inertia: vector![0.082, 0.0845, 0.1377], mass: 4.34, gravity: 9.81 }
    }

    /// In hover, one metre above the ground.
    pub fn hovering() -> (Self, QuadrotorState) {
        (Self::lee(), Self::at_rest(1.0))
    }
}

impl Example for Quadrotor {
    const ABOUT: &'static str =
        "a body with four propellers and the thrust of hover that turns over and flies off";
    const STEP: f64 = 0.01;
    const DURATION: f64 = 10.0;

    /// With the thrust of hover, but rotating and without attitude control.
    fn example() -> (Self, QuadrotorState) {
        let start = QuadrotorState { attitude_momentum: vector![0.004, 0.002, 0.05], ..Self::at_rest(1.0) };
        (Self::lee(), start)
    }

    fn control(&self, _: &QuadrotorState, _: f64) -> QuadrotorControl {
        self.hover()
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(Matrix3::from_diagonal(&self.inertia))
    }

    fn scene(&self, by_state: Scene) -> Scene {
        let body = Solid::new(Shape::Quadrotor { arm: Self::ARM });
        let thrust = Arrow::control("thrust", Vector3::z()).symbol("F").colour("c4").in_body();
        let scene = by_state.named(0, "quadrotor").solid(0, body).without_axes(0);
        scene.arrow(thrust).weight(0, self.mass * self.gravity, Vector3::zeros())
    }
}
