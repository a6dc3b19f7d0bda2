//! An ideal fluid in an ellipsoid.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::{Body, Scene};
use coadjoint_app::shape::{Shape, Solid};
use serde::{Deserialize, Serialize};

/// A fluid without friction that fills a vessel at rest, an ellipsoid, and turns in it with the same vorticity everywhere.
///
/// In coordinates in which the vessel is the unit ball, `x = A u` with the semi-axes `A = diag(a₁, a₂, a₃)`, the fluid turns as a whole: what
/// was at `u₀` is at `R u₀`. With `Ṙ = ω^ R` the flow is `v = A ω^ A⁻¹ x`. Which particle is called what does not matter, so that the energy
/// depends on `ω` in space alone: a right-invariant system, as is every ideal fluid (V. I. Arnold).
///
/// Hamiltonian: `H = ½ m·𝓘⁻¹m` with the momentum `m = 𝓘ω` in space; `𝓘₁ = ⅕M (a₂² + a₃²)` and so on are the moments of inertia that the ellipsoid
/// would have if it were rigid, with the fluid's mass `M`. The vorticity is `curl v = 5 A m / (M a₁a₂a₃)`.
///
/// Motion: `ṁ = 𝓘⁻¹m × m`, `Ṙ = (𝓘⁻¹m)^ R`: those of a rigid body backwards. They are Helmholtz's equation, by which vorticity goes with the fluid.
///
/// Invariants: the energy `H`, the Casimir `|m|²`, and `Rᵀm`: the vorticity is always the same where the same particles are (Kelvin's
/// circulations, Cauchy's invariants).
#[lie_poisson_system(
    group = SO3,
    invariance = right,
    hamiltonian = {
        let squares = semi_axes.component_mul(&semi_axes);
        let moments = mass / 5.0 * (Vector3::repeat(squares.sum()) - squares);
        momentum.dot(&momentum.component_div(&moments)) / 2.0
    },
    methods(Midpoint),
    units(momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EllipsoidalFluid {
    /// Mass of the fluid, kg.
    #[unit("kg")]
    pub mass: f64,
    /// Semi-axes of the vessel, m.
    #[unit("m")]
    pub semi_axes: Vector3<f64>,
}

impl EllipsoidalFluid {
    /// `𝓘`, kg m².
    pub fn moments(&self) -> Vector3<f64> {
        let squares = self.semi_axes.component_mul(&self.semi_axes);
        (Vector3::repeat(squares.sum()) - squares) * (self.mass / 5.0)
    }

    /// The vorticity of the flow, 1/s.
    pub fn vorticity(&self, state: &EllipsoidalFluidState) -> Vector3<f64> {
        self.semi_axes.component_mul(&state.momentum) * (5.0 / (self.mass * self.semi_axes.product()))
    }

    /// `Rᵀm`, kg m²/s: what of the vorticity goes with the particles.
    pub fn circulation(state: &EllipsoidalFluidState) -> Vector3<f64> {
        state.attitude.inverse() * state.momentum
    }
}

impl Example for EllipsoidalFluid {
    const ABOUT: &'static str = "an ideal fluid that turns in a vessel at rest, an ellipsoid";
    const STEP: f64 = 0.02;
    const DURATION: f64 = 120.0;
    const CASIMIR_UNITS: &'static [&'static str] = &["kg² m⁴/s²"];

    /// A tonne of water that turns nearly about the middle axis of its vessel: it does not stay there.
    fn example() -> (Self, EllipsoidalFluidState) {
        let fluid = EllipsoidalFluid { mass: 1000.0, semi_axes: vector![0.5, 0.6, 0.8] };
        let momentum = fluid.moments().component_mul(&vector![0.01, 1.0, 0.02]);
        (fluid, EllipsoidalFluidState { attitude: UnitQuaternion::identity(), momentum })
    }

    /// The vessel stands still; what turns in it are the axes of the fluid, in the coordinates in which the vessel is a ball.
    fn scene(&self, by_state: Scene) -> Scene {
        let vessel = Solid::new(Shape::Ellipsoid { semi_axes: self.semi_axes.into() });
        by_state.named(0, "fluid").solid(0, None).body(Body::fixed("vessel").with(vessel))
    }
}
