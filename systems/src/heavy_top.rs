//! The heavy top.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use serde::{Deserialize, Serialize};

/// A rigid body that turns about a fixed point under gravity.
///
/// Hamiltonian: `H = ½ Π·𝓘⁻¹Π + mg Γ·χ`, with the body angular momentum `Π` and the vertical `Γ = Rᵀe₃` as the body
/// sees it; gravity makes `Γ` a variable of its own.
///
/// Motion: `Π̇ = Π × 𝓘⁻¹Π + mg Γ × χ`, `Γ̇ = Γ × 𝓘⁻¹Π`, `Ṙ = R (𝓘⁻¹Π)^`.
///
/// Invariants: the energy `H`, the Casimirs `|Γ|²` and `Π·Γ` (the angular momentum about the vertical). Two tops have one more, and
/// can be solved: [Lagrange's](Self::lagrange_top) and [Kovalevskaya's](Self::kovalevskaya_top).
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
    methods(Midpoint, HamiltonJacobi(6)),
    retractions(Exponential, Cayley, SecondKind),
    taylor,
    units(momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeavyTop {
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

impl HeavyTop {
    /// The state of this attitude and body momentum.
    pub fn start(attitude: UnitQuaternion<f64>, momentum: Vector3<f64>) -> HeavyTopState {
        HeavyTopState { attitude, momentum, gamma: attitude.inverse() * Vector3::z() }
    }

    /// Lagrange's top: round, with its centre of mass on its axis. The momentum `Π₃` about that axis is constant.
    ///
    /// A toy gyroscope: a disc of 200 g and 8 cm across on a stem that ends 5 cm below, spun 24 times a second and let go leaning
    /// by 30°. It goes about and nods.
    pub fn lagrange_top() -> (Self, HeavyTopState) {
        let (mass, radius, length) = (0.2, 0.04, 0.05);
        let about: f64 = mass * radius * radius / 2.0;
        let across = about / 2.0 + mass * length * length;
        let top = Self {
            inertia: vector![across, across, about],
            weight: mass * 9.81,
            chi: vector![0.0, 0.0, length],
        };
        let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 30_f64.to_radians());
        (top, Self::start(attitude, vector![0.0, 0.0, about * 150.0]))
    }

    /// Kovalevskaya's top: `I₁ = I₂ = 2 I₃`, with its centre of mass in the plane of the first two axes.
    /// [Her integral](Self::kovalevskaya) is constant.
    pub fn kovalevskaya_top() -> (Self, HeavyTopState) {
        let top = Self { inertia: vector![2.0, 2.0, 1.0], weight: 1.0, chi: Vector3::x() };
        (top, Self::start(UnitQuaternion::identity(), vector![1.0, 0.5, 1.5]))
    }

    /// Kovalevskaya's integral `|(ω₁ + iω₂)² − (mg χ₁/I₃)(Γ₁ + iΓ₂)|²`, with the angular velocity `ω`, s⁻⁴.
    pub fn kovalevskaya(&self, state: &HeavyTopState) -> f64 {
        let velocity = self.velocity(state);
        let ratio = self.weight * self.chi.x / self.inertia.z;
        let real = velocity.x.powi(2) - velocity.y.powi(2) - ratio * state.gamma.x;
        let imaginary = 2.0 * velocity.x * velocity.y - ratio * state.gamma.y;
        real * real + imaginary * imaginary
    }
}

impl Example for HeavyTop {
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

    fn scene(&self, by_state: Scene) -> Scene {
        by_state.top(0, &Matrix3::from_diagonal(&self.inertia), self.weight, self.chi)
    }
}
