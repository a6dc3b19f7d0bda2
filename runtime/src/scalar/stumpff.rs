//! Stumpff functions, the only special functions that exponential retractions need:
//! `c_k(z) = Σ_j (−z)^j / (k + 2j)!`.
//!
//! With `θ = √z` they are `c_0 = cos θ`, `c_1 = sin θ / θ`, `c_2 = (1 − cos θ) / θ²`,
//! `c_3 = (θ − sin θ) / θ³`, …; for `z < 0` the hyperbolic counterparts. Unlike these quotients they are
//! entire: nothing is special at zero. They satisfy
//!
//! - `c_k(z) = 1/k! − z c_{k+2}(z)`,
//! - `c_k′(z) = (k c_{k+2}(z) − c_{k+1}(z)) / 2`, so that they are closed under differentiation.
//!
//! ```
//! use coadjoint::__private::family;
//!
//! let angle: f64 = 0.3;
//! let z = angle * angle;
//! let [c0, c1] = family(z);
//! assert!((c1 - angle.sin() / angle).abs() < 1e-15);
//! assert!((c0 * c0 + z * c1 * c1 - 1.0).abs() < 1e-15);
//! assert_eq!(family(0.0), [1.0, 1.0, 0.5, 1.0 / 6.0]);
//! ```
//!
//! # Evaluation and accuracy
//!
//! | | method | relative error |
//! |---|---|---|
//! | `-1/8 < z < 1/8` | two highest members: polynomials of degree 7; others: the first formula | 1.7 ε |
//! | `-3 < z < 3` | the same with degree 11 | 1.9 ε |
//! | `z ≥ 3` | `c_0`, `c_1`, `c_2`: sine and cosine; others: the first formula, without cancellation | 2.4 ε |
//! | `z ≤ -3` | the same with an exponential | 4.2 ε |
//!
//! No larger errors were found for `f64` and `f32`, in families of up to 12 members, at `-4·10⁵ < z < 10⁶`; `ε`
//! is the distance from 1 to the next number. Only near the zeros of `c_0` is an error no longer relative: from
//! `z = 1` on these bounds are absolute for it. Beyond `z ≈ 10¹⁶` (`f32`: 10⁸) the sine's argument is
//! rounded. Where `c_0` overflows, the other members are infinite too.
//!
//! A step's arguments are squares of small angles, so the first row is the one that counts: it has neither
//! division nor call, even members need nothing of odd ones, and what the caller drops is not computed. Nor are
//! the four highest powers where the argument is so small, below 0.001 for `c_0` and `c_1`, that every digit is
//! the same without them.

use core::any::TypeId;

use nalgebra::{RealField, convert};

use crate::scalar::{Batch, Mask, Scalar};

/// The most members that a family can have. Two more, and [`INVERSE_FACTORIAL`] would outgrow `u128`.
const MAX: usize = 12;

/// Below, two [`quartet`]s give a series to within rounding, its first two derivatives included.
pub(crate) const SHORT: f64 = 0.125;

/// Below, three of them do.
pub(crate) const LONG: f64 = 3.0;

/// The terms of a series that matter wherever [`distant`] uses it, its first derivative included.
const TERMS: usize = 26;

/// `1/m!`, correctly rounded as long as an `f64` holds `m!` exactly: to `m = 22`. The later ones only scale
/// the tails of polynomials.
const INVERSE_FACTORIAL: [f64; MAX + 22] = {
    let mut table = [1.0; MAX + 22];
    let mut factorial: u128 = 1;
    let mut m = 1;
    while m < table.len() {
        factorial *= m as u128;
        table[m] = 1.0 / factorial as f64;
        m += 1;
    }
    table
};

/// `c_0(z), …, c_{N−1}(z)`, `N` being at most 12.
///
/// Scalars beyond `f64` and `f32` get the constants to the precision of `f64`. Differentiation through this
/// function (dual numbers) is accurate too.
#[inline(always)]
pub fn family<T: RealField + Copy, const N: usize>(z: T) -> [T; N] {
    const { assert!(N <= MAX, "a family has at most 12 members") };
    if is_plain::<T>() && within(z, const { brief_below::<N>() }) {
        brief(z)
    } else if within(z, SHORT) {
        short(z)
    } else if within(z, LONG) {
        long(z)
    } else {
        distant(z)
    }
}

/// Whether these are numbers without derivatives, and not of more digits than an `f64`.
fn is_plain<T: 'static>() -> bool {
    [TypeId::of::<f64>(), TypeId::of::<f32>()].contains(&TypeId::of::<T>())
}

/// A family near zero, if all lanes are.
#[inline(always)]
pub(crate) fn near<T: Batch, const N: usize>(z: T) -> Option<[T; N]> {
    let size = Batch::abs(z);
    if size.lt(T::of(const { brief_below::<N>() })).all() {
        Some(brief(z))
    } else if size.lt(T::of(SHORT)).all() {
        Some(short(z))
    } else {
        None
    }
}

/// A family where `|z|` is below [`brief_below`] in every lane.
#[inline(always)]
fn brief<T: Scalar, const N: usize>(z: T) -> [T; N] {
    let z2 = z * z;
    let [k, l] = highest::<N>();
    downward(z, [quartet(k, z, z2), quartet(l, z, z2)])
}

/// A family where `|z|` is below [`SHORT`] in every lane.
#[inline(always)]
pub(crate) fn short<T: Scalar, const N: usize>(z: T) -> [T; N] {
    let z2 = z * z;
    let z4 = z2 * z2;
    let [k, l] = highest::<N>();
    // no closure, since it could not say that it is to be inlined
    let even = z4.mul_add(quartet(k + 8, z, z2), quartet(k, z, z2));
    let odd = z4.mul_add(quartet(l + 8, z, z2), quartet(l, z, z2));
    downward(z, [even, odd])
}

/// A family where `|z|` is below [`LONG`] in every lane.
#[inline(always)]
pub(crate) fn long<T: Scalar, const N: usize>(z: T) -> [T; N] {
    let z2 = z * z;
    let z4 = z2 * z2;
    let [k, l] = highest::<N>();
    let even = z4.mul_add(quartet(k + 16, z, z2), quartet(k + 8, z, z2));
    let odd = z4.mul_add(quartet(l + 16, z, z2), quartet(l + 8, z, z2));
    downward(z, [z4.mul_add(even, quartet(k, z, z2)), z4.mul_add(odd, quartet(l, z, z2))])
}

/// `|z| < limit`.
#[inline(always)]
fn within<T: RealField + Copy>(z: T, limit: f64) -> bool {
    z < convert(limit) && z > convert(-limit)
}

/// `1/m!`.
#[inline(always)]
fn inverse_factorial<T: Scalar>(m: usize) -> T {
    T::of(INVERSE_FACTORIAL[m])
}

/// Four consecutive terms of a series, the first being `1/k!`. Grouped by Estrin's scheme: the step cannot go
/// on without the result, and Horner's would keep it waiting longer.
#[inline(always)]
fn quartet<T: Scalar>(k: usize, z: T, z2: T) -> T {
    let low = z.neg_mul_add(inverse_factorial(k + 2), inverse_factorial(k));
    let high = z.neg_mul_add(inverse_factorial(k + 6), inverse_factorial(k + 4));
    z2.mul_add(high, low)
}

/// Below this `|z|` one [`quartet`] has the very digits of two: the second, times `z⁴`, is less than a quarter of an epsilon of the first, to
/// which it is to the power `(k + 8)! / k!` in denominators. Not so its derivatives.
const fn brief_below<const N: usize>() -> f64 {
    let [k, _] = highest::<N>();
    let fourth = f64::EPSILON / 8.0 * INVERSE_FACTORIAL[k] / INVERSE_FACTORIAL[k + 8];
    // from above, by Newton's iteration
    let mut root = 1.0;
    let mut times = 0;
    while times < 64 {
        root -= (root * root * root * root - fourth) / (4.0 * root * root * root);
        times += 1;
    }
    root
}

/// Which members a family is computed [`downward`] from; of a family of one, twice the one.
const fn highest<const N: usize>() -> [usize; 2] {
    [N.saturating_sub(2), N - 1]
}

/// A family from its two highest members.
#[inline(always)]
fn downward<T: Scalar, const N: usize>(z: T, [even, odd]: [T; 2]) -> [T; N] {
    let mut c = [even; N];
    c[N - 1] = odd;
    for k in (0..N.saturating_sub(2)).rev() {
        c[k] = z.neg_mul_add(c[k + 2], inverse_factorial(k));
    }
    c
}

/// A family away from zero.
#[cold]
#[inline]
fn distant<T: RealField + Copy, const N: usize>(z: T) -> [T; N] {
    // With half the angle nothing cancels in c_2.
    let quarter = z.abs() * convert(0.25);
    let half = quarter.sqrt();
    // What rounding took from the root: large angles would magnify it.
    let (high, low) = split(half);
    let lost = ((quarter - high * high) - (high + high) * low - low * low) / (half + half);
    let (c0, sine, cosine) = if z > T::zero() {
        // Linear, the correction is good only while small; where it is not, z itself places the angle no better.
        let lost = if lost.abs() < T::default_epsilon().sqrt() { lost } else { T::zero() };
        let (sin, cos) = half.sin_cos();
        let (sin, cos) = (sin + lost * cos, cos - lost * sin);
        ((cos - sin) * (cos + sin), sin, cos)
    } else {
        let exp = half.exp() * (T::one() + lost);
        let inverse = exp.recip();
        let (sinh, cosh) = ((exp - inverse) * convert(0.5), (exp + inverse) * convert(0.5));
        (cosh * cosh + sinh * sinh, sinh, cosh)
    };
    let c1 = sine * cosine / half;
    let c2 = sine * sine / (quarter + quarter);

    let [k, l] = highest::<N>();
    let mut c: [T; N] = downward(z, [series(k, z), series(l, z)]);
    for (member, value) in c.iter_mut().zip(&[c0, c1, c2]) {
        *member = *value;
    }
    // Upward, `rest` cancels near zero; downward, the difference does far from it. Change over where neither
    // does: where `below` has fallen to half of its value at zero or, for negative z, has outgrown that value.
    for k in 3..N {
        let below = c[k - 2];
        let rest = inverse_factorial::<T>(k - 2) - below;
        c[k] = if rest.abs() < below * convert(0.9375) { c[k] } else { rest / z };
    }
    c
}

/// `x` as a sum of two numbers with half as many digits, so that their products are exact (Veltkamp).
fn split<T: RealField + Copy>(x: T) -> (T, T) {
    let scaled = x * convert(2.0) / T::default_epsilon().sqrt();
    let high = scaled - (scaled - x);
    (high, x - high)
}

/// `c_k(z)` from its series, with the quotients of consecutive terms off the critical path.
#[inline(always)]
fn series<T: RealField + Copy>(k: usize, z: T) -> T {
    let mut sum = T::one();
    for j in (0..TERMS).rev() {
        let m = (k + 2 * j) as f64;
        sum = T::one() - sum * (z / convert((m + 1.0) * (m + 2.0)));
    }
    sum * inverse_factorial(k)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fused::FusedScalar;

    /// How many of many arguments up to so many times [`brief_below`] get other digits from one quartet than from two.
    fn differences<T: Scalar + PartialEq, const N: usize>(times: f64) -> usize {
        let differ = |z: f64| brief::<T, N>(T::of(z)) != short::<T, N>(T::of(z));
        let limit = times * const { brief_below::<N>() };
        (0..=4000).filter(|k| differ(limit * (f64::from(*k) / 2000.0 - 1.0))).count()
    }

    #[test]
    fn small_arguments_need_one_quartet() {
        macro_rules! sizes {
            ($($n:literal),*) => { $(
                assert_eq!(differences::<f64, $n>(1.0), 0, "{}", $n);
                assert_eq!(differences::<FusedScalar<f64>, $n>(1.0), 0, "{}", $n);
                assert_eq!(differences::<f32, $n>(1.0), 0, "{}", $n);
                // and not much larger ones
                assert!(differences::<f64, $n>(2.0) > 100, "{}", $n);
            )* };
        }
        sizes!(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12);
    }
}
