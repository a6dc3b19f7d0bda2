//! A chain of spins.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::{Arrow, Body, Scene};
use serde::{Deserialize, Serialize};

/// Four spins in a row, each of which its neighbours turn parallel to themselves: a ferromagnet (W. Heisenberg), without quantum mechanics.
///
/// Hamiltonian: `H = −J (S₁·S₂ + S₂·S₃ + S₃·S₄) − b·(S₁ + S₂ + S₃ + S₄)`, in rad/s, with spins `Sᵢ` in space, the exchange `J` and the Larmor
/// frequency `b` of a field. It depends on the spins in space alone: a right-invariant system.
///
/// Motion: `Ṡᵢ = Sᵢ × (J (Sᵢ₋₁ + Sᵢ₊₁) + b)`, of L. D. Landau and E. M. Lifshitz, *On the theory of the dispersion of magnetic permeability in ferromagnetic
/// bodies* (1935), without damping; `Ṙᵢ = ∂H/∂Sᵢ^ Rᵢ`.
///
/// Invariants: the energy `H`, the Casimirs `|Sᵢ|²`, and the total spin along the field. Where all spins are nearly along it, what they deviate by is a sum
/// of [four waves](Self::wave).
#[lie_poisson_system(
    group(spins: [SO3; 4]),
    invariance = right,
    hamiltonian = {
        let neighbours = spins_momentum.windows(2).map(|pair| pair[0].dot(&pair[1])).sum::<f64>();
        let total = spins_momentum.iter().sum::<Vector3<f64>>();
        -exchange * neighbours - field.dot(&total)
    },
    retractions(Cayley),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpinChain {
    /// How strongly neighbours turn each other, rad/s.
    #[unit("rad/s")]
    pub exchange: f64,
    /// The frequency with which a field alone turns a spin, about its own direction, rad/s.
    #[unit("rad/s")]
    pub field: Vector3<f64>,
}

impl SpinChain {
    /// The chain with these spins.
    pub fn with_spins(spins: [Vector3<f64>; 4]) -> SpinChainState {
        SpinChainState { spins: [UnitQuaternion::identity(); 4], spins_momentum: spins }
    }

    /// The wave of a number from 0 to 3 in spins of length 1: the angular frequency `|b| + 2J (1 − cos ¼kπ)`, rad/s, and how far each spin leans.
    pub fn wave(&self, k: u8) -> (f64, [f64; 4]) {
        let phase = f64::from(k) * std::f64::consts::FRAC_PI_4;
        let frequency = self.field.norm() + 2.0 * self.exchange * (1.0 - phase.cos());
        (frequency, [0.5, 1.5, 2.5, 3.5].map(|place| (phase * place).cos()))
    }
}

impl Example for SpinChain {
    const ABOUT: &'static str = "four spins in a row that turn each other: a ferromagnet";
    const STEP: f64 = 0.02;
    const DURATION: f64 = 30.0;
    const ENERGY_UNIT: &'static str = "rad/s";

    /// The first spin is across the others, which are along the field: it passes on what it leans by, and the last one passes it back.
    fn example() -> (Self, SpinChainState) {
        let chain = SpinChain { exchange: 2.0, field: vector![0.0, 0.0, 0.5] };
        (chain, Self::with_spins([Vector3::x(), Vector3::z(), Vector3::z(), Vector3::z()]))
    }

    /// The spins, one beside the other.
    fn scene(&self, _: Scene) -> Scene {
        const BETWEEN: f64 = 0.5;
        let mut scene = Scene::default();
        let places =
            [(1, "second", 0.0), (0, "first", -BETWEEN), (2, "third", BETWEEN), (3, "fourth", 2.0 * BETWEEN)];
        for (k, (spin, name, place)) in places.into_iter().enumerate() {
            let arrow = Arrow::quantity(&format!("spins_momentum_{spin}"));
            let arrow = arrow.named(&format!("{name} spin")).symbol("S");
            scene = scene.body(Body::fixed(name)).arrow(arrow.on(k, Vector3::zeros()));
            if k > 0 {
                scene = scene.hang(k, 0, vector![place, 0.0, 0.0]);
            }
        }
        scene
    }
}
