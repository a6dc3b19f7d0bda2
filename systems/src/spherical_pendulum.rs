//! The spherical pendulum.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use serde::{Deserialize, Serialize};

/// A rod that hangs from a joint and swings in all directions.
///
/// The sphere of its directions is no group, and a point of mass would have no moment of inertia about the rod's own axis. So it is what
/// it is in any workshop: a slender rod that turns about one of its ends, on the group of all rotations. Not turning about its own axis
/// at the start, it never does, and its end moves as a point on a sphere.
///
/// Hamiltonian: `H = ½ Π·𝓘⁻¹Π + mg l Γ₃`, with the body angular momentum `Π` and the vertical `Γ = Rᵀe₃` as the rod sees it; its own
/// third axis points from the joint along the rod.
///
/// Motion: `Π̇ = Π × 𝓘⁻¹Π + mg l Γ × e₃`, `Γ̇ = Γ × 𝓘⁻¹Π`, `Ṙ = R (𝓘⁻¹Π)^`.
///
/// Invariants: the energy `H`, the Casimirs `|Γ|²` and `Π·Γ` (the angular momentum about the vertical), and `Π₃`, as the rod is round.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * length * gamma.z,
    units(momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SphericalPendulum {
    /// Principal moments of inertia about the joint, the last one about the rod's own axis, kg m².
    #[inertia]
    #[unit("kg m²")]
    pub inertia: Vector3<f64>,
    /// Mass times gravitational acceleration, N.
    #[unit("N")]
    pub weight: f64,
    /// From the joint to the centre of mass, m.
    #[unit("m")]
    pub length: f64,
}

impl SphericalPendulum {
    /// A round rod hanging from one of its ends, on Earth.
    pub fn rod(mass: f64, length: f64, radius: f64) -> Self {
        let across = mass * (length * length / 3.0 + radius * radius / 4.0);
        Self {
            inertia: vector![across, across, mass * radius * radius / 2.0],
            weight: mass * 9.81,
            length: length / 2.0,
        }
    }

    /// At an angle from the lowest position, rad, on its way sideways: turning about the vertical and not about its own axis.
    pub fn sideways(&self, angle: f64, momentum: f64) -> SphericalPendulumState {
        // down is a half turn from where the rod's axis is that of space
        let attitude = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::PI - angle);
        SphericalPendulumState {
            attitude,
            momentum: vector![momentum, 0.0, 0.0],
            gamma: attitude.inverse() * Vector3::z(),
        }
    }
}

impl Example for SphericalPendulum {
    const ABOUT: &'static str = "a slender rod that swings from a joint in all directions";
    const STEP: f64 = 0.01;
    /// About its own axis the rod is quick.
    const CERTIFIED_STEP: Option<f64> = Some(2e-3);
    const DURATION: f64 = 60.0;

    /// A steel rod of one metre and one kilogram, pushed sideways at 60° from its lowest position.
    fn example() -> (Self, SphericalPendulumState) {
        let pendulum = Self::rod(1.0, 1.0, 0.006);
        let start = pendulum.sideways(60_f64.to_radians(), 0.4);
        (pendulum, start)
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(Matrix3::from_diagonal(&self.inertia))
    }

    fn scene(&self, by_state: Scene) -> Scene {
        by_state.top(0, &Matrix3::from_diagonal(&self.inertia), self.weight, vector![0.0, 0.0, self.length])
    }
}
