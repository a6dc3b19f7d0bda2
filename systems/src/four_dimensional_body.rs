//! The rigid body of four dimensions.

use coadjoint::nalgebra::Matrix4;
use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use serde::{Deserialize, Serialize};

/// A rigid body of four dimensions that turns about its centre of mass, and nothing acts on it.
///
/// A body turns in planes: of the axes `i` and `j` by the angular velocity `Ω_ij`. In three dimensions there are three of them, and each has an axis
/// across; in four there are six, and none has.
///
/// Hamiltonian: `H = ½ Σ L_ij²/(λᵢ + λⱼ)`, over all pairs `i < j`, with the angular momentum `L_ij = (λᵢ + λⱼ) Ω_ij` in the axes of the body and the second
/// moments `λᵢ = ∫ xᵢ² dm` of its mass.
///
/// Motion: `L̇ = [L, Ω]`, `Ṙ = R Ω`, with antisymmetric matrices `L = ΛΩ + ΩΛ` and `Ω` and the diagonal matrix `Λ` of the second moments.
///
/// Invariants: the energy `H`, the Casimirs `Σ L_ij²` and `L₁₂L₃₄ − L₁₃L₂₄ + L₁₄L₂₃`, the angular momentum in space, `R L Rᵀ`, and
/// [one more](Self::manakov), which makes the body integrable: F. Frahm, *Ueber gewisse Differentialgleichungen* (Mathematische Annalen 8, 1874), and for
/// any number of dimensions S. V. Manakov, *Note on the integration of Euler's equations of the dynamics of an n-dimensional rigid body* (Functional Analysis
/// and Its Applications 10, 1976).
#[lie_poisson_system(
    group = SO(4),
    hamiltonian = {
        let moments = Vector6::new(
            second_moments.x + second_moments.y,
            second_moments.x + second_moments.z,
            second_moments.x + second_moments.w,
            second_moments.y + second_moments.z,
            second_moments.y + second_moments.w,
            second_moments.z + second_moments.w,
        );
        momentum.dot(&momentum.component_div(&moments)) / 2.0
    },
    retractions(Cayley),
    units(momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FourDimensionalBody {
    /// Second moments of the mass along the principal axes, kg m².
    #[inertia]
    #[unit("kg m²")]
    pub second_moments: Vector4<f64>,
}

impl FourDimensionalBody {
    /// The body that is not turned, with this angular velocity in the planes 12, 13, 14, 23, 24 and 34, rad/s.
    pub fn turning(&self, velocity: Vector6<f64>) -> FourDimensionalBodyState {
        let [a, b, c, d]: [f64; 4] = self.second_moments.into();
        let moments = Vector6::new(a + b, a + c, a + d, b + c, b + d, c + d);
        FourDimensionalBodyState { element: Matrix4::identity(), momentum: moments.component_mul(&velocity) }
    }

    /// Manakov's integral `Σ (λᵢ² + λⱼ²) L_ij²`, over all pairs `i < j`, kg⁴ m⁸/s².
    ///
    /// It is a coefficient of `tr (L + zΛ²)³`: with any number `z`, `L + zΛ²` keeps its eigenvalues.
    pub fn manakov(&self, state: &FourDimensionalBodyState) -> f64 {
        let [a, b, c, d] = <[f64; 4]>::from(self.second_moments).map(|moment| moment * moment);
        let squares = Vector6::new(a + b, a + c, a + d, b + c, b + d, c + d);
        state.momentum.component_mul(&state.momentum).dot(&squares)
    }
}

impl Example for FourDimensionalBody {
    const ABOUT: &'static str = "a free rigid body of four dimensions, seen as its shadow in three";
    const STEP: f64 = 0.02;
    const DURATION: f64 = 60.0;
    const CASIMIR_UNITS: &'static [&'static str] = &["kg² m⁴/s²", "kg² m⁴/s²"];

    /// A body that turns nearly in the planes 13 and 24 alone: it does not stay there, and turns over again and again.
    fn example() -> (Self, FourDimensionalBodyState) {
        let body = FourDimensionalBody { second_moments: Vector4::new(1.0, 2.0, 3.0, 4.0) };
        let start = body.turning(Vector6::new(0.01, 1.0, 0.02, 0.01, 0.4, 0.02));
        (body, start)
    }

    /// The shadow that a box of 1 kg with these second moments casts on the first three dimensions: its corners are seen there, and its edges.
    fn scene(&self, by_state: Scene) -> Scene {
        let half = self.second_moments.map(|moment| (3.0 * moment).sqrt());
        let side = |corner: usize, k: usize| if corner >> k & 1 == 0 { -half[k] } else { half[k] };
        let corners: Vec<Vec<f64>> =
            (0..16).map(|corner| (0..4).map(|k| side(corner, k)).collect()).collect();
        let edges = (0..16).flat_map(|corner| (0..4).map(move |k| (corner, corner | 1 << k)));
        let edges: Vec<(usize, usize)> = edges.filter(|(from, to)| from != to).collect();
        by_state.frame("element", &corners, &edges)
    }
}
