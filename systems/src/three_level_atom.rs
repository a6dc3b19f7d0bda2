//! An atom of three levels.

use coadjoint::nalgebra::{Complex, ComplexField, SMatrix, SVector};
use coadjoint::prelude::*;
use coadjoint_app::Example;
use serde::{Deserialize, Serialize};

/// An atom of three levels in the light of two lasers, which take it from the first level to the third by way of the second: stimulated Raman adiabatic
/// passage.
///
/// The configuration is the operator `U` in SU(3) by which the states have changed, a complex number `a + ib` as `[[a, −b], [b, a]]`. The momentum is the
/// density matrix `ρ` without its trace, in units of `ħ`: `momentum_k = i tr (ρ E_k)` with the basis `E_k` of the algebra. So `s` and `a` of two levels are
/// `−2 Re ρᵢⱼ` and `2 Im ρᵢⱼ`, and `d` is the difference of their [populations](Self::populations).
///
/// Hamiltonian, in a frame that turns with the light (the rotating-wave approximation), in rad/s:
///
/// ```text
///           ⎡ 0   P   0 ⎤
/// H(t) = ½  ⎢ P   2Δ  S ⎥        h = tr (ρ H) − ⅓ tr H
///           ⎣ 0   S   2δ⎦
/// ```
///
/// with the Rabi frequencies `P = P₀ exp (−(t − t₀ − ½τ)²/w²)` of the pump and `S = S₀ exp (−(t − t₀ + ½τ)²/w²)` of the Stokes laser, and the detunings `Δ` of the
/// second level and `δ` of the third.
///
/// Motion: `i U̇ = H U` (Schrödinger's equation) up to a phase, and `i ρ̇ = [H, ρ]` (von Neumann's).
///
/// With `δ = 0`, the state `(S, 0, −P)` has energy zero. It is dark: nothing of it is in the second level, which would decay. Where the Stokes pulse comes
/// first it begins as the first level and ends as the third. An atom stays in it if the pulses change slowly, though the light on the level that is full
/// comes last.
///
/// Invariants: the Casimirs of SU(3), which are `tr ρ²` and `tr ρ³`. The light does work, so the energy is none.
///
/// U. Gaubatz, P. Rudecki, S. Schiemann, K. Bergmann, *Population transfer between molecular vibrational levels by stimulated Raman scattering with partially
/// overlapping laser fields* (Journal of Chemical Physics 92, 1990).
#[lie_poisson_system(
    group = SU(3),
    invariance = right,
    hamiltonian = {
        let since = (t - middle) / width;
        let apart = delay / (2.0 * width);
        let pump = pump * (-(since - apart).powi(2)).exp();
        let stokes = stokes * (-(since + apart).powi(2)).exp();
        // of −iH without its trace, in the axes of the algebra
        -(pump * momentum[0] + stokes * momentum[4]) / 2.0
            + detuning * (momentum[6] - momentum[7]) / 3.0
            + two_photon_detuning * (momentum[6] + 2.0 * momentum[7]) / 3.0
    },
    retractions(Exponential),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThreeLevelAtom {
    /// The largest Rabi frequency of the laser between the first and the second level, rad/s.
    #[unit("rad/s")]
    pub pump: f64,
    /// The largest Rabi frequency of the laser between the second and the third level, rad/s.
    #[unit("rad/s")]
    pub stokes: f64,
    /// How long after the Stokes pulse the pump pulse comes, s.
    #[unit("s")]
    pub delay: f64,
    /// Half of the time in which a pulse has more than 1/e of its strength, s.
    #[unit("s")]
    pub width: f64,
    /// The time between the pulses, s.
    #[unit("s")]
    pub middle: f64,
    /// How far the pump is below the second level, rad/s.
    #[unit("rad/s")]
    pub detuning: f64,
    /// How far both lasers together are below the third level, rad/s.
    #[unit("rad/s")]
    pub two_photon_detuning: f64,
}

impl ThreeLevelAtom {
    /// The atom in a pure state of these amplitudes.
    pub fn in_state(amplitudes: [Complex<f64>; 3]) -> ThreeLevelAtomState {
        let length = amplitudes.iter().map(|c| c.norm_sqr()).sum::<f64>();
        let density = Matrix3::from_fn(|i, j| amplitudes[i] * amplitudes[j].conjugate() / length);
        let (twice_re, twice_im) = (|i, j| -2.0 * density[(i, j)].re, |i, j| 2.0 * density[(i, j)].im);
        let difference = |i: usize| (density[(i + 1, i + 1)] - density[(i, i)]).re;
        let momentum = SVector::from([
            twice_re(0, 1),
            twice_im(0, 1),
            twice_re(0, 2),
            twice_im(0, 2),
            twice_re(1, 2),
            twice_im(1, 2),
            difference(0),
            difference(1),
        ]);
        ThreeLevelAtomState { element: SMatrix::identity(), momentum }
    }

    /// How likely the atom is found in each of the levels.
    pub fn populations(state: &ThreeLevelAtomState) -> [f64; 3] {
        let (first, last) = (state.momentum[6], state.momentum[7]);
        let second = (1.0 + first - last) / 3.0;
        [second - first, second, second + last]
    }
}

impl Example for ThreeLevelAtom {
    const ABOUT: &'static str =
        "an atom of three levels that two lasers take from the first to the third, by a state that is dark";
    const STEP: f64 = 2e-9;
    const DURATION: f64 = 2.5e-6;
    /// The light is weak at the beginning: what would do there is too long in the middle.
    const CERTIFIED_STEP: Option<f64> = Some(6e-9);
    const ENERGY_UNIT: &'static str = "rad/s";

    /// Pulses of half a microsecond and of 2π · 10 MHz: all but 10⁻⁵ of the atom arrives.
    fn example() -> (Self, ThreeLevelAtomState) {
        let zero = Complex::new(0.0, 0.0);
        let rabi = std::f64::consts::TAU * 1e7;
        let atom = Self {
            pump: rabi,
            stokes: rabi,
            delay: 7e-7,
            width: 5e-7,
            middle: 1e-6,
            detuning: 0.0,
            two_photon_detuning: 0.0,
        };
        (atom, Self::in_state([Complex::new(1.0, 0.0), zero, zero]))
    }
}
