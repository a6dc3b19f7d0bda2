//! Two rigid bodies on a spring of torsion.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use coadjoint_app::shape::Solid;
use serde::{Deserialize, Serialize};

/// Two rigid bodies that share their centre of mass, and a spring that turns each towards the other's attitude.
///
/// Hamiltonian: `H = ½ Π₁·𝓘₁⁻¹Π₁ + ½ Π₂·𝓘₂⁻¹Π₂ + k (1 − cos θ)`, with the angular momenta `Π₁` and `Π₂` in the axes of their bodies and
/// the angle `θ` of the rotation `Q = R₁ᵀR₂` that leads from one attitude to the other; of its quaternion the scalar part is `cos ½θ`.
///
/// Motion: `Ṙᵢ = Rᵢ (𝓘ᵢ⁻¹Πᵢ)^`, `Π̇₁ = Π₁ × 𝓘₁⁻¹Π₁ + k sin θ n` and `Π̇₂ = Π₂ × 𝓘₂⁻¹Π₂ − k sin θ n`, with the axis `n` of `Q`, which is
/// the same in both bodies.
///
/// Invariants: the energy `H`, and the angular momentum of both together in space, `R₁Π₁ + R₂Π₂`.
#[lie_poisson_system(
    group(first: SO3, second: SO3),
    potential = {
        let between = first.inverse() * second;
        2.0 * stiffness * (1.0 - between.w.powi(2))
    },
    methods(Midpoint),
    units(first_momentum = "kg m²/s", second_momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoupledBodies {
    /// Principal moments of inertia of the first body, kg m².
    #[inertia(first)]
    #[unit("kg m²")]
    pub first_inertia: Vector3<f64>,
    /// Principal moments of inertia of the second body, kg m².
    #[inertia(second)]
    #[unit("kg m²")]
    pub second_inertia: Vector3<f64>,
    /// Stiffness of the spring, N m.
    #[unit("N m")]
    pub stiffness: f64,
}

impl CoupledBodies {
    /// The angular momentum of both together, in space, kg m²/s.
    pub fn total_momentum(state: &CoupledBodiesState) -> Vector3<f64> {
        state.first * state.first_momentum + state.second * state.second_momentum
    }
}

impl Example for CoupledBodies {
    const ABOUT: &'static str = "two rigid bodies on a spring of torsion";
    const STEP: f64 = 0.01;
    const DURATION: f64 = 60.0;

    /// A body and one half as large, turned against each other by a radian.
    fn example() -> (Self, CoupledBodiesState) {
        let bodies = CoupledBodies {
            first_inertia: vector![2.0, 3.0, 4.0],
            second_inertia: vector![1.5, 1.0, 0.8],
            stiffness: 2.0,
        };
        let start = CoupledBodiesState {
            first: UnitQuaternion::identity(),
            first_momentum: vector![0.5, 2.0, 1.0],
            second: UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1.0),
            second_momentum: vector![-0.3, 0.2, 0.6],
        };
        (bodies, start)
    }

    fn scene(&self, by_state: Scene) -> Scene {
        let solid = |inertia: &Vector3<f64>| Solid::of_inertia(&Matrix3::from_diagonal(inertia));
        by_state.solid(0, solid(&self.first_inertia)).solid(1, solid(&self.second_inertia))
    }
}
