//! Stumpff functions `c_k(z) = Σ_j (−z)^j / (k + 2j)!`.

use nalgebra::RealField;

/// `c_0(z), …, c_{N−1}(z)`.
#[inline(always)]
pub fn family<T: RealField + Copy, const N: usize>(z: T) -> [T; N] {
    // provisional: plain series
    core::array::from_fn(|k| {
        let mut term = T::one();
        for i in 1..=k {
            term /= nalgebra::convert::<f64, T>(i as f64);
        }
        let mut sum = term;
        for j in 1..40 {
            let m = (k + 2 * j) as f64;
            term = -term * z / nalgebra::convert::<f64, T>(m * (m - 1.0));
            sum += term;
        }
        sum
    })
}
