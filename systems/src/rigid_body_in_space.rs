//! The rigid body that moves through space.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use coadjoint_app::shape::Solid;
use serde::{Deserialize, Serialize};

/// A rigid body on which nothing acts, tumbling and drifting, seen from a point of it that is not its centre of mass: the corner where
/// its instruments are, say.
///
/// Hamiltonian: `H = ½ μ·𝕀⁻¹μ`, with the angular momentum about the point seen from and the linear momentum, `μ = (Π, P)`, both in body
/// axes. With the mass `m`, the centre of mass at `c` and the tensor of inertia `𝓘` about it,
///
/// ```text
/// 𝕀 = ( 𝓘 + m (|c|² − c cᵀ)   m c^ )
///     (          −m c^          m  )
/// ```
///
/// Motion: with the velocities `(ω, v) = 𝕀⁻¹μ`, `Π̇ = Π × ω + P × v`, `Ṗ = P × ω`, `Ṙ = R ω^`, `ẋ = R v`.
///
/// Invariants: the energy `H`, the Casimirs `|P|²` and `Π·P`, and the momenta in space, `RP` and `RΠ + x × RP`. The centre of mass
/// `x + R c` moves uniformly.
#[lie_poisson_system(
    group = SE3,
    units(
        pose = "1, 1, 1, 1, m, m, m",
        momentum = "kg m²/s, kg m²/s, kg m²/s, kg m/s, kg m/s, kg m/s",
    ),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RigidBodyInSpace {
    /// Inertia of turning and moving together, `𝕀`: kg m², kg m, kg.
    #[inertia]
    pub inertia: Matrix6<f64>,
}

impl RigidBodyInSpace {
    /// The body of this mass, centre of mass and tensor of inertia about it.
    pub fn new(mass: f64, centre: Vector3<f64>, inertia: Matrix3<f64>) -> Self {
        let moved = Matrix3::from_diagonal_element(centre.norm_squared()) - centre * centre.transpose();
        let cross = mass * centre.cross_matrix();
        let mut all = Matrix6::from_diagonal_element(mass);
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&(inertia + mass * moved));
        all.fixed_view_mut::<3, 3>(0, 3).copy_from(&cross);
        all.fixed_view_mut::<3, 3>(3, 0).copy_from(&-cross);
        Self { inertia: all }
    }

    /// Its mass, kg.
    pub fn mass(&self) -> f64 {
        self.inertia[(3, 3)]
    }

    /// Its centre of mass, in body axes, m.
    pub fn centre(&self) -> Vector3<f64> {
        vector![self.inertia[(2, 4)], self.inertia[(0, 5)], self.inertia[(1, 3)]] / self.mass()
    }
}

impl Example for RigidBodyInSpace {
    const ABOUT: &'static str =
        "a rigid body tumbling through space, seen from a point off its centre of mass";
    const STEP: f64 = 0.01;
    const DURATION: f64 = 60.0;

    /// A hammer thrown end over end, seen from the end of its handle.
    fn example() -> (Self, RigidBodyInSpaceState) {
        let moments = vector![0.012, 0.0125, 0.0012];
        let body = Self::new(0.8, vector![0.0, 0.02, 0.25], Matrix3::from_diagonal(&moments));
        let velocity = vector![0.3, 8.0, 0.2, -1.0, 0.3, 0.5];
        let momentum = body.inertia * velocity;
        (body, RigidBodyInSpaceState { pose: Isometry3::identity(), momentum })
    }

    fn scene(&self, by_state: Scene) -> Scene {
        let (mass, centre) = (self.mass(), self.centre());
        let moved = Matrix3::from_diagonal_element(centre.norm_squared()) - centre * centre.transpose();
        let about_centre = self.inertia.fixed_view::<3, 3>(0, 0) - mass * moved;
        by_state.named(0, "body").solid(0, Solid::of_mass(&about_centre, mass).map(|solid| solid.at(centre)))
    }
}
