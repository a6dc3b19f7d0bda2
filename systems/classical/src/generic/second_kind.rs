//! Canonical coordinates of the second kind, for any matrix group.

use nalgebra::{SMatrix, SVector};

use super::{MatrixGroup, MatrixRetraction};
use coadjoint::SecondKind;

/// `exp(t E_i)`
fn along<G: MatrixGroup<N, D>, const N: usize, const D: usize>(axis: usize, t: f64) -> SMatrix<f64, N, N> {
    G::exp(&SVector::from_fn(|i, _| if i == axis { t } else { 0.0 }))
}

/// Exponentials along the axes of the algebra, one after the other.
impl<G, const N: usize, const D: usize> MatrixRetraction<G, N, D> for SecondKind
where
    G: MatrixGroup<N, D>,
{
    fn retract(x: &SVector<f64, D>) -> Option<SMatrix<f64, N, N>> {
        Some((0..D).fold(SMatrix::identity(), |product, axis| product * along::<G, N, D>(axis, x[axis])))
    }

    /// Column by column `Ad_g E_i` with the product `g` of the exponentials before.
    fn right_derivative(x: &SVector<f64, D>) -> Option<SMatrix<f64, D, D>> {
        let mut derivative = SMatrix::<f64, D, D>::zeros();
        let (mut g, mut inverse) = (SMatrix::<f64, N, N>::identity(), SMatrix::<f64, N, N>::identity());
        for axis in 0..D {
            let unit = SVector::from_fn(|i, _| f64::from(u8::from(i == axis)));
            derivative.set_column(axis, &G::vee(&(g * G::hat(&unit) * inverse)));
            g *= along::<G, N, D>(axis, x[axis]);
            inverse = along::<G, N, D>(axis, -x[axis]) * inverse;
        }
        Some(derivative)
    }

    /// Seen at points that are less than a tenth of a radian apart.
    fn is_regular(x: &SVector<f64, D>) -> bool {
        let points = ((10.0 * x.amax()) as u32).min(1000) + 1;
        let keeps_orientation = |k: u32| {
            let there = x * (f64::from(k) / f64::from(points));
            let derivative = <Self as MatrixRetraction<G, N, D>>::right_derivative(&there);
            derivative.is_some_and(|derivative| determinant(derivative) > 0.0)
        };
        (1..=points).all(keeps_orientation)
    }
}

/// The determinant, by elimination: nalgebra has none for a dimension that is a parameter.
fn determinant<const D: usize>(mut a: SMatrix<f64, D, D>) -> f64 {
    let mut determinant = 1.0;
    for k in 0..D {
        let pivot = (k..D).fold(k, |best, i| if a[(i, k)].abs() > a[(best, k)].abs() { i } else { best });
        if a[(pivot, k)] == 0.0 {
            return 0.0;
        }
        if pivot != k {
            a.swap_rows(pivot, k);
            determinant = -determinant;
        }
        determinant *= a[(k, k)];
        for i in k + 1..D {
            let factor = a[(i, k)] / a[(k, k)];
            for j in k..D {
                a[(i, j)] -= factor * a[(k, j)];
            }
        }
    }
    determinant
}
