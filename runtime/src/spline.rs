//! Tables in expressions.

use nalgebra::{RealField, convert};

/// Interpolates tables: a natural cubic spline through the values of an array.
///
/// In expressions it stands for a table of parameters, here of a motor's thrust:
///
/// ```
/// use coadjoint::prelude::*;
///
/// #[lie_poisson_system(
///     group = R1,
///     potential = mass * gravity * position.x,
///     force = vector![if t < 2.0 { thrust.spline(0.0, 2.0, t) } else { 0.0 }],
/// )]
/// struct Rocket {
///     #[inertia]
///     mass: f64,
///     gravity: f64,
///     /// At 0 s, 0.5 s, …, 2 s, in N.
///     thrust: [f64; 5],
/// }
///
/// let rocket = Rocket { mass: 2.0, gravity: 9.81, thrust: [0.0, 80.0, 60.0, 55.0, 0.0] };
/// let mut state = RocketState { position: vector![0.0], momentum: vector![0.0] };
/// let mut stepper = rocket.stepper::<Exponential>(0.01)?;
/// for _ in 0..300 {
///     stepper.step(&mut state)?;
/// }
/// assert!(state.position.x > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Beyond its ends the curve goes on along the straight lines there. `thrust.spline(0.0, 2.0, t.clamp(0.0, 2.0))` holds its last values instead,
/// and `if t < 2.0 { … } else { 0.0 }`, as above, is what ends.
///
/// The curve has two continuous derivatives, which is what steps and their derivatives need; schemes of an order above three are of order three or
/// four across a knot. Its coefficients are computed when the stepper is built. An evaluation chooses them by comparisons, of which there are five
/// for each value of the table: for tables as long as arrays may be, and no longer ones.
pub trait Spline<T> {
    /// The value at `x` of the curve through these values, at equal distances from `from` to `to`, which may be the lesser; on straight lines before
    /// and behind. What is no number, or infinite, if `from` is `to`: a step that needs it fails, as one whose state is not finite.
    fn spline(&self, from: T, to: T, x: T) -> T;
}

impl<T: RealField + Copy, const N: usize> Spline<T> for [T; N] {
    fn spline(&self, from: T, to: T, x: T) -> T {
        const { assert!(N > 1, "a spline goes through two values or more") };
        let (y, number, zero) = (self, convert::<f64, T>, T::zero());
        let last = N - 1;
        let u = (x - from) * number(last as f64) / (to - from);
        // second derivatives, by elimination
        let (mut r, mut m) = ([zero; N], [zero; N]);
        for k in 1..last {
            r[k] = T::one() / (number(4.0) - r[k - 1]);
            m[k] = ((y[k - 1] - y[k] * number(2.0) + y[k + 1]) * number(6.0) - m[k - 1]) * r[k];
        }
        for k in (1..last).rev() {
            m[k] -= r[k] * m[k + 1];
        }
        let slope = |k: usize| y[k + 1] - y[k] - (m[k] * number(2.0) + m[k + 1]) / number(6.0);
        if u < zero {
            return y[0] + u * slope(0);
        }
        let Some(k) = (0..last).find(|&k| u < number((k + 1) as f64)) else {
            let end = y[last] - y[last - 1] + m[last - 1] / number(6.0);
            return y[last] + (u - number(last as f64)) * end;
        };
        let w = u - number(k as f64);
        y[k] + w * (slope(k) + w * (m[k] / number(2.0) + w * (m[k + 1] - m[k]) / number(6.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine has no second derivative at the ends of half a turn, as a natural spline: the largest error is h⁴/384.
    #[test]
    fn it_is_a_spline() {
        let pi = core::f64::consts::PI;
        let h = pi / 16.0;
        let table: [f64; 17] = core::array::from_fn(|k| (h * k as f64).sin());
        let at = |x: f64| table.spline(0.0, pi, x);
        for k in 0..17 {
            assert!((at(h * f64::from(k)) - table[k as usize]).abs() < 1e-15);
        }
        let mut worst = 0.0_f64;
        for k in 1..1000 {
            let x = pi * f64::from(k) / 1000.0;
            worst = worst.max((at(x) - x.sin()).abs());
        }
        assert!((worst / (h.powi(4) / 384.0) - 1.0).abs() < 0.02, "{worst:e}");
        // beyond, the tangents at the ends
        assert!((at(-1.0) + 1.0).abs() < 2e-4 && (at(pi + 1.0) + 1.0).abs() < 2e-4);
        // first and second derivatives are the same on both sides of knots
        let e = 1e-3;
        for k in 0..17 {
            let x = h * f64::from(k);
            let [a, b, c, d, f] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|j| at(x + j * e));
            let jump = (c - 2.0 * d + f) - (a - 2.0 * b + c);
            // the third derivative jumps by no more than two
            assert!(jump.abs() < 4.0 * e.powi(3), "{k}: {jump:e}");
        }
    }

    #[test]
    fn straight_lines_and_three_points() {
        assert!(([1.0_f64, 3.0].spline(0.0, 4.0, 1.0) - 1.5).abs() < 1e-15);
        assert!(([1.0_f64, 3.0, 5.0].spline(0.0, 4.0, 7.0) - 8.0).abs() < 1e-15);
        // by hand: m₁ = 6 (0 − 2 + 0)/4 = −3
        assert!(([0.0_f64, 1.0, 0.0].spline(0.0, 2.0, 0.5) - (0.5 * 1.5 - 0.125 * 0.5)).abs() < 1e-15);
        assert!([0.0_f64, 1.0].spline(1.0, 1.0, 0.5).is_infinite());
        // backwards
        let (table, turned) = ([0.0_f64, 1.0, -0.5, 2.0], [2.0_f64, -0.5, 1.0, 0.0]);
        for x in [-1.0, 0.0, 0.3, 1.0, 1.7, 2.0, 3.5] {
            assert!((table.spline(2.0, 0.0, x) - turned.spline(0.0, 2.0, x)).abs() < 1e-14, "{x}");
        }
    }
}
