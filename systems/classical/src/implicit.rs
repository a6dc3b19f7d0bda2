//! The implicit Euler method.

use nalgebra::linalg::try_invert_to;
use nalgebra::{SMatrix, SVector};

use super::{Diverged, Integrator, Method, VectorField, is_finite};

/// More corrections than any solvable step takes.
const MAX_ITERATIONS: u32 = 40;

/// A correction this small, relative to the state, is the last: central differences leave the next one below rounding.
const LAST_CORRECTION: f64 = 1e-12;

/// The cube root of the machine epsilon, which balances truncation and rounding of central differences.
const DIFFERENCE: f64 = 6.06e-6;

/// The size, relative to the whole state, that a component is taken to have at least.
const SMALL: f64 = 1e-4;

/// The implicit Euler method, `x_{k+1} = x_k + h f(t_k + h, x_{k+1})`: (1.8) for the oscillator. Order 1.
///
/// Newton's iteration from `x_k`, with a Jacobian of central differences, to roundoff in the norm of the state. A step that it does
/// not solve is an error, never an inaccurate state. Written to be right, not to be fast. HNW, II.7.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImplicitEuler;

impl Method for ImplicitEuler {
    const NAME: &'static str = "implicit Euler";
    const ORDER: u32 = 1;
}

impl<const N: usize, F: VectorField<N> + ?Sized> Integrator<F, SVector<f64, N>> for ImplicitEuler {
    fn step(
        &self,
        field: &F,
        time: f64,
        start: &SVector<f64, N>,
        h: f64,
    ) -> Result<SVector<f64, N>, Diverged> {
        let end = time + h;
        let mut x = *start;
        let mut last = f64::NAN;
        for iterations in 0..MAX_ITERATIONS {
            let change = field.at(end, &x) * h;
            let matrix = SMatrix::identity() - jacobian(field, end, &x) * h;
            let mut inverse = SMatrix::zeros();
            if !try_invert_to(matrix, &mut inverse) {
                return Err(Diverged::NoConvergence { iterations, correction: last });
            }
            let correction = inverse * (start + change - x);
            x += correction;
            if !is_finite(&x) {
                return Err(Diverged::NoConvergence { iterations: iterations + 1, correction: last });
            }
            let (size, scale) = (correction.norm(), x.norm() + start.norm());
            if size <= LAST_CORRECTION * scale {
                return Ok(x);
            }
            last = size / scale;
        }
        Err(Diverged::NoConvergence { iterations: MAX_ITERATIONS, correction: last })
    }
}

/// The matrix `∂f/∂x` by central differences.
///
/// A component is moved in proportion to its own size, unless that would be lost beside the others.
pub(super) fn jacobian<const N: usize, F: VectorField<N> + ?Sized>(
    field: &F,
    time: f64,
    x: &SVector<f64, N>,
) -> SMatrix<f64, N, N> {
    let norm = x.norm();
    let mut jacobian = SMatrix::<f64, N, N>::zeros();
    for j in 0..N {
        let own = x[j].abs().max(SMALL * norm);
        let offset = DIFFERENCE * if own > 0.0 { own } else { 1.0 };
        let (mut above, mut below) = (*x, *x);
        above[j] += offset;
        below[j] -= offset;
        // of the points as they were rounded
        let distance = above[j] - below[j];
        jacobian.set_column(j, &((field.at(time, &above) - field.at(time, &below)) / distance));
    }
    jacobian
}
