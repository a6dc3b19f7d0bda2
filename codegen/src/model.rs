//! A described system as plain symbolic data: what methods work from.

use crate::expr::{Expr, Matrix, Vector};
use crate::group::Semidirect;

/// A mechanical system on the dual of a semidirect algebra, `h = ½ μ·𝕀⁻¹μ + V(a)`.
///
/// All symbols live in one arena. Symbols of parameters have stage *parameters*, those of the state stage *step*.
pub struct System<'a> {
    /// The group and the spaces of the advected parameters.
    pub algebra: Semidirect,
    /// The inertia `𝕀`, symmetric; `velocity = 𝕀⁻¹ momentum`.
    pub inertia: Matrix<'a>,
    /// The configuration's stored coordinates.
    pub configuration: Vector<'a>,
    /// The body momentum `μ`.
    pub momentum: Vector<'a>,
    /// The advected parameters `a`, in body coordinates, with their names.
    pub advected: Vec<(String, Vector<'a>)>,
    /// The potential energy `V(a)`, in parameters and advected parameters.
    pub potential: Expr<'a>,
}

impl<'a> System<'a> {
    /// `𝕀⁻¹ m` by the factorization `𝕀 = L D Lᵀ`
    pub fn velocity(&self, m: &Vector<'a>) -> Vector<'a> {
        let n = m.len();
        let (l, d) = self.inertia.ldl();
        let mut x = m.0.clone();
        for i in 0..n {
            for k in 0..i {
                x[i] = x[i] - l.at(i, k) * x[k];
            }
        }
        for i in (0..n).rev() {
            x[i] = x[i] / d.0[i];
            for k in i + 1..n {
                x[i] = x[i] - l.at(k, i) * x[k];
            }
        }
        Vector(x)
    }

    /// The Hamiltonian. With `𝕀 = L D Lᵀ` the kinetic energy is `½ Σ yᵢ²/dᵢ`, `y = L⁻¹ μ`: a sum of squares, without
    /// cancellation.
    pub fn energy(&self) -> Expr<'a> {
        let (l, d) = self.inertia.ldl();
        let mut y = self.momentum.0.clone();
        let mut kinetic = self.potential.arena().zero();
        for i in 0..y.len() {
            for k in 0..i {
                y[i] = y[i] - l.at(i, k) * y[k];
            }
            kinetic = kinetic + y[i] * y[i] / d.0[i];
        }
        kinetic / 2 + self.potential
    }

    /// The advected parameters without their names.
    pub fn advected_values(&self) -> Vec<Vector<'a>> {
        self.advected.iter().map(|(_, value)| value.clone()).collect()
    }
}
