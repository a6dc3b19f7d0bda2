//! Velocities and momenta by each other where there is no closed form: Legendre's transform.

use thiserror::Error;

use crate::scalar::{Components, Real};

/// There is no momentum that belongs to a velocity, or no velocity that belongs to a momentum: `∂²l/∂ξ²` or `∂²h/∂μ²` is singular there, none
/// was found, or what is given is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "no momentum and velocity belong to each other here: the second derivative of the energy is singular, or something is not finite"
)]
#[non_exhaustive]
pub struct LegendreError;

/// More iterations than any regular transform takes.
const MAX_ITERATIONS: u32 = 100;
/// Corrections that were last this small have come to their end when they become no smaller, for the next one is as small as its square.
const NEAR: f64 = 1e-10;
/// What the last of all iterations may correct, relative to the largest component.
const LEFT: f64 = 1e-4;

/// The finite components.
///
/// # Errors
/// If one is not finite.
pub fn finite<T: Real, A: Components<T>>(components: A) -> Result<A, LegendreError> {
    match components.as_ref().iter().all(|component| component.is_finite()) {
        true => Ok(components),
        false => Err(LegendreError),
    }
}

/// The zero of a function from `start` on: `newton` gives the residual, and behind it Newton's correction. Not a number if there is none.
///
/// A correction that leads to where nothing is defined is halved. The iteration ends when no component's correction becomes smaller: each has
/// its own unit, and its own rounding. One that is rounding alone goes on to the last iteration, next to the others' size.
pub fn newton<T: Real, const N: usize, const M: usize>(
    start: [T; N],
    newton: impl Fn(&[T; N]) -> [T; M],
) -> [T; N] {
    let (mut x, mut at) = (start, newton(&start));
    let mut last = [f64::INFINITY; N];
    for _ in 0..MAX_ITERATIONS {
        let correction = &at[N..];
        let sizes: [[f64; 2]; N] = core::array::from_fn(|i| [correction[i], x[i]].map(|x| x.to_f64().abs()));
        let ended = sizes.iter().zip(&last).all(|(&[size, x], &last)| {
            size <= 2.0 * T::EPSILON * x || (size <= NEAR * x && size >= 0.5 * last)
        });
        if ended {
            return x;
        }
        last = sizes.map(|[size, _]| size);
        match shortened(&x, correction, &newton) {
            Some(next) => (x, at) = next,
            None => return [T::of(f64::NAN); N],
        }
    }
    let largest = |of: &[T]| of.iter().map(|x| x.to_f64().abs()).fold(0.0, f64::max);
    let near = largest(&at[N..]) <= LEFT * largest(&x);
    if near { x } else { [T::of(f64::NAN); N] }
}

/// Takes a correction, or as much of it as leads to where the function is defined.
fn shortened<T: Real, const N: usize, const M: usize>(
    x: &[T; N],
    correction: &[T],
    newton: impl Fn(&[T; N]) -> [T; M],
) -> Option<([T; N], [T; M])> {
    let mut scale = 1.0;
    while scale > T::EPSILON {
        let trial = core::array::from_fn(|i| x[i] - T::of(scale) * correction[i]);
        let there = newton(&trial);
        if there.iter().all(|component| component.is_finite()) {
            return Some((trial, there));
        }
        scale *= 0.5;
    }
    None
}

/// [`newton`] from rest, of as many components as are known at run time.
#[cfg(feature = "dynamic")]
pub(crate) fn newton_of(
    dimension: usize,
    newton: impl Fn(&[f64]) -> std::vec::Vec<f64>,
) -> std::vec::Vec<f64> {
    let mut x = std::vec![0.0; dimension];
    let mut at = newton(&x);
    let mut last = std::vec![f64::INFINITY; dimension];
    let shortened = |x: &[f64], correction: &[f64]| {
        let mut scale = 1.0;
        while scale > f64::EPSILON {
            let trial: std::vec::Vec<f64> =
                x.iter().zip(correction).map(|(x, correction)| x - scale * correction).collect();
            let there = newton(&trial);
            if there.iter().all(|component| component.is_finite()) {
                return Some((trial, there));
            }
            scale *= 0.5;
        }
        None
    };
    let none = std::vec![f64::NAN; dimension];
    for _ in 0..MAX_ITERATIONS {
        let Some(correction) = at.get(dimension..) else { return none };
        let ended = correction.iter().zip(&x).zip(&last).all(|((correction, x), last)| {
            let [size, x] = [correction, x].map(|x| x.abs());
            size <= 2.0 * f64::EPSILON * x || (size <= NEAR * x && size >= 0.5 * last)
        });
        if ended {
            return x;
        }
        last = correction.iter().map(|correction| correction.abs()).collect();
        match shortened(&x, correction) {
            Some(next) => (x, at) = next,
            None => return none,
        }
    }
    let largest = |of: &[f64]| of.iter().map(|x| x.abs()).fold(0.0, f64::max);
    let near = largest(&at[dimension..]) <= LEFT * largest(&x);
    if near { x } else { none }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `[residual, correction]` of one component.
    fn of(f: impl Fn(f64) -> (f64, f64)) -> impl Fn(&[f64; 1]) -> [f64; 2] {
        move |&[x]| {
            let (value, slope) = f(x);
            [value, value / slope]
        }
    }

    #[test]
    fn a_velocity_near_that_of_light_is_found() {
        for momentum in [0.0_f64, 1e-200, 1e-3, 0.7, 30.0, -1e4] {
            // μ = ξ/√(1 − ξ²), at once undefined where the first correction leads
            let relation = of(|x| {
                let gamma = 1.0 / (1.0 - x * x).sqrt();
                (x * gamma - momentum, gamma.powi(3))
            });
            let [velocity] = newton([0.0], relation);
            let expected = momentum / (1.0 + momentum * momentum).sqrt();
            assert!(
                (velocity - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(),
                "{momentum}: {velocity}"
            );
        }
    }

    #[test]
    fn units_do_not_end_the_iteration_early() {
        let both = |&[x, y]: &[f64; 2]| {
            let (a, b) = (3.0 * x - 1e9, (1e12 * y).sinh() - 20.0);
            [a, b, a / 3.0, b / (1e12 * (1e12 * y).cosh())]
        };
        let [x, y] = newton([0.0; 2], both);
        assert!((x - 1e9 / 3.0).abs() < 1e-6 && (y - 1e-12 * 20.0_f64.asinh()).abs() < 1e-27, "{x} {y}");
    }

    #[test]
    fn what_does_not_exist_is_not_found() {
        let singular = newton([0.0], of(|x| (x * x - 1.0, 2.0 * x)));
        let nowhere = newton([0.3], of(|x| (x * x + 1.0, 2.0 * x)));
        let oscillating = newton([1.0], of(|x| (x.cbrt(), x.cbrt() / (3.0 * x))));
        for [x] in [singular, nowhere, oscillating] {
            assert!(x.is_nan(), "{x}");
        }
        assert_eq!(finite([1.0, f64::NAN]), Err(LegendreError));
    }
}
