//! What derivatives need where something is zero: a reciprocal that is zero there, and `θ / sin θ`.

use nalgebra::{ComplexField, RealField, convert};

/// The root of the least normal `f64`.
pub(crate) const NEGLIGIBLE: f64 = f64::from_bits((1023 - 511) << 52);
/// The root of the least normal `f32`.
pub(crate) const NEGLIGIBLE_SINGLE: f64 = f64::from_bits((1023 - 63) << 52);

/// `1/x`, and 0 where `x` is negligible.
#[inline(always)]
pub(crate) fn recip_or_zero<T: RealField + Copy>(x: T) -> T {
    let mut negligible: T = convert(NEGLIGIBLE);
    if negligible == T::zero() {
        negligible = convert(NEGLIGIBLE_SINGLE);
    }
    if ComplexField::abs(x) <= negligible { T::zero() } else { T::one() / x }
}

/// Angles whose cosine is above have series: there `θ / sin θ = acos c / √(1 − c²)` and its derivatives are quotients
/// of what vanishes.
const NEAR: f64 = 0.5;
/// The terms of the series that matter at [`NEAR`], and at angles below half a radian. One or two more for each
/// derivative.
const TERMS: [u32; 2] = [28, 12];

/// The derivative, `order` times, of `a = θ / sin θ` with respect to `c = cos θ`.
///
/// With `z = (1 − c)/2`, `a = ₂F₁(1, 1; 3/2; z)`, and `dⁿa/dcⁿ = Πⱼ −j²/(2j + 1) · ₂F₁(n + 1, n + 1; n + 3/2; z)` with
/// j from 1 to n. Farther away from 1, `(1 − c²) a' = c a − 1`, and differentiated n times more,
/// `(1 − c²) a⁽ⁿ⁺¹⁾ = (2n + 1) c a⁽ⁿ⁾ + n² a⁽ⁿ⁻¹⁾`.
pub(crate) fn angle_over_sine<T: RealField + Copy>(c: T, order: u32) -> T {
    let number = |x: f64| convert::<f64, T>(x);
    let n = f64::from(order);
    if c > number(NEAR) {
        let z = (T::one() - c) / number(2.0);
        let terms = TERMS[usize::from(z < number(1.0 / 64.0))] + 2 * order;
        let series = (0..terms).rev().map(f64::from).fold(T::one(), |sum, j| {
            let ratio = (n + 1.0 + j) * (n + 1.0 + j) / ((n + 1.5 + j) * (j + 1.0));
            T::one() + number(ratio) * z * sum
        });
        let first = (1..=order).map(f64::from).fold(1.0, |first, j| -first * j * j / (2.0 * j + 1.0));
        return number(first) * series;
    }
    let below = (T::one() - c) * (T::one() + c);
    let (mut last, mut now) = (T::zero(), ComplexField::acos(c) / ComplexField::sqrt(below));
    for k in (0..order).map(f64::from) {
        let inhomogeneity = if k == 0.0 { -T::one() } else { number(k * k) * last };
        (last, now) = (now, (number(2.0 * k + 1.0) * c * now + inhomogeneity) / below);
    }
    now
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reciprocal_is_zero_at_zero_alone_and_where_its_square_is_infinite() {
        for x in [1.0, -3.0, 1e-153, -1e-100, 1e300, f64::INFINITY] {
            assert_eq!(recip_or_zero(x), 1.0 / x);
        }
        for x in [0.0, -0.0, 1e-300, -1e-310, NEGLIGIBLE] {
            assert_eq!(recip_or_zero(x), 0.0);
        }
        assert!(recip_or_zero(f64::NAN).is_nan());
        assert_eq!((recip_or_zero(1e-18_f32), recip_or_zero(1e-20_f32)), (1.0 / 1e-18_f32, 0.0));
    }

    #[test]
    fn it_is_an_angle_over_its_sine() {
        for k in 1..314 {
            let theta = f64::from(k) / 100.0;
            let error = angle_over_sine(theta.cos(), 0) * theta.sin() / theta - 1.0;
            // the cosine is rounded, and the quotient grows towards π
            let condition = angle_over_sine(theta.cos(), 1).abs() * theta.sin() / theta;
            assert!(error.abs() < 1e-15 * (1.0 + condition), "{theta}: {error:e}");
        }
        assert_eq!([0, 1, 2].map(|order| angle_over_sine(1.0, order)), [1.0, -1.0 / 3.0, 4.0 / 15.0]);
        assert!(angle_over_sine(-1.0_f64, 0).is_infinite());
    }

    #[test]
    fn its_derivatives_are_those_of_the_one_before() {
        let h = 1e-3;
        for order in 0..4 {
            for c in [-0.6, -0.2, 0.3, 0.499, 0.501, 0.7, 0.95, 0.99, 0.9999, 1.0] {
                let at = |k: f64| angle_over_sine(c + k * h, order);
                let difference = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
                let derivative = angle_over_sine(c, order + 1);
                let error = (difference / derivative - 1.0).abs();
                assert!(error < 1e-7, "{order}, {c}: {derivative} for {difference}");
            }
        }
    }
}
