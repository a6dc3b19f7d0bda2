//! A body that deforms by the same everywhere.

use std::f64::consts::{PI, TAU};

use coadjoint::nalgebra::Vector4;
use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use serde::{Deserialize, Serialize};

/// A disc of rubber in its plane that is turned, stretched and sheared by the same everywhere: an affine, or pseudo-rigid, body.
///
/// What was at `X` is at `x = F X`, with a matrix `F` of positive determinant. With the body's second moments of mass `∫ XᵢXⱼ dm = J δᵢⱼ`,
/// `J = ma²/4` for a disc of mass `m` and radius `a`, and its area `A = πa²`:
///
/// Lagrangian: `l = ½ J |Ḟ|² − A w(F)`, with the strain energy of a neo-Hookean solid, `w = ½μ (|F|² − 2 − 2 ln det F) + ½λ (ln det F)²`.
///
/// Motion: `J F̈ = −A (μ (F − F⁻ᵀ) + λ ln det F F⁻ᵀ)`. With the velocity `F⁻¹Ḟ` the momentum is `FᵀP`, `P = J Ḟ`.
///
/// Invariants: the energy, the [angular momentum](Self::angular_momentum), as the material has no direction of its own the [circulation](Self::circulation)
/// too. Small strains are three oscillations: the disc [breathes](Self::breathing), and is [sheared](Self::shearing) in two ways.
///
/// H. Cohen and R. G. Muncaster, *The Theory of Pseudo-rigid Bodies* (1988); the strain energy is that of J. C. Simo and K. S. Pister, *Remarks on rate
/// constitutive equations for finite deformation problems* (1984).
#[lie_poisson_system(
    group = GL(2),
    lagrangian = {
        let rate = element * matrix![velocity[0], velocity[1]; velocity[2], velocity[3]];
        let moment = mass * radius.powi(2) / 4.0;
        let dilation = element.determinant().ln();
        let shape = shear_modulus / 2.0 * (element.norm_squared() - 2.0 - 2.0 * dilation);
        let strain = shape + lame_modulus / 2.0 * dilation.powi(2);
        moment / 2.0 * rate.norm_squared() - PI * radius.powi(2) * strain
    },
    methods(Midpoint),
    retractions(Cayley),
    units(momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AffineBody {
    /// Mass, kg.
    #[unit("kg")]
    pub mass: f64,
    /// Radius where nothing strains it, m.
    #[unit("m")]
    pub radius: f64,
    /// Shear modulus `μ` times thickness, N/m.
    #[unit("N/m")]
    pub shear_modulus: f64,
    /// Lamé's first modulus `λ` times thickness, N/m.
    #[unit("N/m")]
    pub lame_modulus: f64,
}

impl AffineBody {
    /// A disc of soft silicone: 12 cm across, 2 cm thick, 250 g.
    pub fn silicone() -> Self {
        Self { mass: 0.25, radius: 0.06, shear_modulus: 400.0, lame_modulus: 800.0 }
    }

    /// `J = ma²/4`, kg m².
    pub fn moment(&self) -> f64 {
        self.mass * self.radius.powi(2) / 4.0
    }

    /// The state of this deformation `F` and its rate `Ḟ`, 1/s.
    pub fn start(&self, deformation: Matrix2<f64>, rate: Matrix2<f64>) -> AffineBodyState {
        let momentum = deformation.tr_mul(&rate) * self.moment();
        let momentum = Vector4::new(momentum.m11, momentum.m12, momentum.m21, momentum.m22);
        AffineBodyState { element: deformation, momentum }
    }

    /// The angular momentum about the centre of mass, kg m²/s: `P Fᵀ − F Pᵀ` has it beside the diagonal.
    pub fn angular_momentum(state: &AffineBodyState) -> f64 {
        let [a, b, c, d] = state.momentum.into();
        let inverse = state.element.try_inverse().unwrap_or_default();
        let in_space = inverse.tr_mul(&(Matrix2::new(a, b, c, d) * state.element.transpose()));
        in_space.m21 - in_space.m12
    }

    /// The circulation, kg m²/s: the same of `FᵀP − PᵀF`, with which the material turns within its shape.
    pub fn circulation(state: &AffineBodyState) -> f64 {
        state.momentum[2] - state.momentum[1]
    }

    /// The angular frequency of small strains by the same in all directions, `√(2A (μ + λ)/J)`, rad/s.
    pub fn breathing(&self) -> f64 {
        (8.0 * PI * (self.shear_modulus + self.lame_modulus) / self.mass).sqrt()
    }

    /// The angular frequency of small shears, `√(2Aμ/J)`, rad/s.
    pub fn shearing(&self) -> f64 {
        (8.0 * PI * self.shear_modulus / self.mass).sqrt()
    }
}

impl Example for AffineBody {
    const ABOUT: &'static str = "a disc of rubber that spins, stretches and shears";
    const STEP: f64 = 5e-4;
    const DURATION: f64 = 1.0;
    /// The disc breathes fast.
    const CERTIFIED_STEP: Option<f64> = Some(2e-4);

    /// Pulled to an ellipse and let go, spinning 15 times a second.
    fn example() -> (Self, AffineBodyState) {
        let body = Self::silicone();
        let deformation = Matrix2::new(1.4, 0.0, 0.0, 0.8);
        let spin = Matrix2::new(0.0, -1.0, 1.0, 0.0) * (15.0 * TAU);
        let start = body.start(deformation, spin * deformation);
        (body, start)
    }

    /// The rim, and two lines of the material through the centre.
    fn scene(&self, by_state: Scene) -> Scene {
        const POINTS: usize = 32;
        let angle = |k: usize| k as f64 * TAU / POINTS as f64;
        let point = |k: usize| vec![self.radius * angle(k).cos(), self.radius * angle(k).sin()];
        let points: Vec<Vec<f64>> = (0..POINTS).map(point).collect();
        let rim = (0..POINTS).map(|k| (k, (k + 1) % POINTS));
        let across = [(0, POINTS / 2), (POINTS / 4, 3 * POINTS / 4)];
        by_state.frame("element", &points, &rim.chain(across).collect::<Vec<_>>())
    }
}
