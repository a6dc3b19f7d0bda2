//! Inputs that are functions of time, as power series within a step.
//!
//! An input is asked at Chebyshev's points of the step that is tried, none of which is an end of it, and the polynomial through its values takes
//! its place. The last coefficients in Chebyshev's polynomials, and four more points, two of them at its very ends, tell how close that is,
//! relative to the largest that the input has been; a step over which it is not as close as the tolerance is made shorter. So a jump is closed in on,
//! and crossed by a step so short that it changes no more than the tolerance allows.
//!
//! Late in a run the roundoff of the time moves an input by more than a tight tolerance, `sin(ω t)` by `ω t` units: no step is so short that it would
//! not, and that is no reason for one.

use super::length::{Length, SHORTEST};
use super::pace::{Pace, Wanted};
use super::series::MOST_COEFFICIENTS;
use crate::scalar::Scalar;

/// Coefficients, at most: more need more digits than doubles have.
const MOST: usize = 13;

/// An input as a power series in time: the numbers of all controls, order by order.
pub(crate) struct Polynomial<C> {
    pub(crate) coefficients: [C; MOST],
    pub(crate) count: usize,
}

/// How well a polynomial stands for an input.
enum Fit {
    /// As close as the tolerance.
    Close,
    /// It is for steps that are so much shorter.
    Shorter(f64),
}

/// How many coefficients go with series of this order: few enough for what rounding leaves of them to be lost in the series.
fn count(order: usize) -> usize {
    (order.min(MOST_COEFFICIENTS) * 5 / 8 + 1).max(order.min(9)).clamp(3, MOST)
}

impl<C> Polynomial<C> {
    /// The coefficients of one order.
    pub(crate) fn order(&self, order: usize) -> Option<&C> {
        self.coefficients.get(..self.count)?.get(order)
    }
}

/// Where coefficients of an order are put of controls, and of the rates at which they change, if these have a place: the place, the order of the
/// input's coefficients, and by what these are multiplied.
#[inline(always)]
pub(crate) fn driven(order: usize, places: [Option<usize>; 2]) -> impl Iterator<Item = (usize, usize, f64)> {
    let next = order + 1;
    let factors = [(order, 1.0), (next, next as f64)];
    places.into_iter().zip(factors).filter_map(|(place, (order, factor))| Some((place?, order, factor)))
}

impl<C: AsRef<[f64]> + AsMut<[f64]> + Clone> Polynomial<C> {
    /// The polynomial through the values of an input on a step from `start` on, and how well it stands for it. `sizes` are the largest values that there
    /// have been.
    fn through(
        sizes: &mut C,
        count: usize,
        (start, length): (f64, f64),
        tolerance: f64,
        input: &mut dyn FnMut(f64) -> C,
    ) -> (Self, Fit) {
        let count = count.clamp(3, MOST);
        let mut values: [C; MOST] = core::array::from_fn(|_| sizes.clone());
        let half = core::f64::consts::FRAC_PI_2 / count as f64;
        let angle = |k: usize| (2 * k + 1) as f64 * half;
        for (k, value) in values.iter_mut().enumerate().take(count) {
            *value = input(start + length * 0.5 * (1.0 - Scalar::cos(angle(k))));
        }
        let mut all = Self { coefficients: values.clone(), count };
        let mut worst = 0.0_f64;
        let mut between: [C; 4] = core::array::from_fn(|_| sizes.clone());
        // a jump nearer to an end changes no more than the tolerance allows
        let edge = tolerance.max(8.0 * f64::EPSILON * (start / length).abs()).min(0.005);
        let places = [edge, 0.317, 0.774, 1.0 - edge];
        for (value, place) in between.iter_mut().zip(places) {
            *value = input(start + length * place);
        }
        for component in 0..sizes.as_ref().len() {
            let of = |value: &C| value.as_ref()[component];
            let mut chebyshev = [0.0; MOST];
            for (n, x) in chebyshev.iter_mut().enumerate().take(count) {
                let sum: f64 = values
                    .iter()
                    .take(count)
                    .enumerate()
                    .map(|(k, value)| {
                        // the points run from the start on
                        of(value) * Scalar::cos(n as f64 * (core::f64::consts::PI - angle(k)))
                    })
                    .sum();
                *x = sum * if n == 0 { 1.0 } else { 2.0 } / count as f64;
            }
            // some units of roundoff are in all values, and in the times that they are of
            let of_values = values.iter().take(count).map(of);
            let (least, most) = of_values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| {
                (if x < least { x } else { least }, if x > most { x } else { most })
            });
            let size = of(sizes).max(least.abs()).max(most.abs());
            sizes.as_mut()[component] = size;
            let by_time = (start.abs() + length.abs()) * ((most - least) / length).abs();
            let roundoff = f64::EPSILON * (8.0 * size + 4.0 * by_time);
            let mut rest = chebyshev[count - 1].abs().max(chebyshev[count - 2].abs());
            // What the tolerance does not tell from nothing is nothing: what the input holds in balance would be moved by that alone, and no step
            // be short enough for a share of it to be right.
            for x in chebyshev.iter_mut().take(count).skip(1).rev() {
                if x.abs() > 0.5 * tolerance * size + roundoff {
                    break;
                }
                *x = 0.0;
            }
            let powers = in_powers(&chebyshev, count);
            for (value, place) in between.iter().zip(places) {
                let at = powers.iter().take(count).rev().fold(0.0, |sum, x| sum * place + x);
                rest = rest.max((of(value) - at).abs());
            }
            let rest = (rest - roundoff).max(0.0);
            if rest > 0.0 {
                worst = worst.max(rest / size);
            }
            let mut power = 1.0;
            for (coefficient, x) in all.coefficients.iter_mut().zip(powers).take(count) {
                coefficient.as_mut()[component] = x * power;
                power /= length;
            }
            if !size.is_finite() {
                return (all, Fit::Close);
            }
        }
        let fit = match worst > tolerance {
            false => Fit::Close,
            true => Fit::Shorter(0.9 * Scalar::powf(tolerance / worst, 1.0 / (count as f64 - 1.0))),
        };
        (all, fit)
    }
}

/// Finds a step over which a polynomial is as close to an input as the tolerance. `first` is a step to try where there was none before.
pub(crate) fn fitted<C: AsRef<[f64]> + AsMut<[f64]> + Clone>(
    (pace, wanted, first): (&Pace, Wanted, f64),
    (order, tolerance): (usize, f64),
    sizes: &mut C,
    input: &mut dyn FnMut(f64) -> C,
) -> (Polynomial<C>, Wanted) {
    let (now, is_fixed) = (pace.time(), matches!(wanted.length, Length::Exactly(_)));
    let (Length::Exactly(most) | Length::AtMost(most)) = wanted.length;
    let mut trial = match pace.last {
        _ if is_fixed => most,
        // it may grow again behind where it had to be short
        Some(last) => (4.0 * last.abs()).min(most.abs()).copysign(most),
        None => first,
    };
    let reference = if most.is_finite() { most } else { trial };
    let least = (tolerance * reference.abs()).max(SHORTEST * 2.0 * now.abs());
    // no input has more digits
    let attainable = tolerance.max(64.0 * f64::EPSILON);
    loop {
        let (polynomial, fit) =
            Polynomial::through(sizes, count(order), (now, trial), attainable, &mut *input);
        match fit {
            Fit::Shorter(by) if !is_fixed && trial.abs() > least => {
                trial = (trial.abs() * by.clamp(0.02, 0.7)).max(least).copysign(most);
            }
            Fit::Shorter(_) | Fit::Close => {
                let length = if is_fixed { wanted.length } else { Length::AtMost(trial) };
                return (polynomial, Wanted { length, ..wanted });
            }
        }
    }
}

/// A sum of Chebyshev's polynomials from 0 to 1 in powers.
fn in_powers(chebyshev: &[f64; MOST], count: usize) -> [f64; MOST] {
    let (mut powers, mut before, mut last) = ([0.0; MOST], [0.0; MOST], [0.0; MOST]);
    (before[0], last[0], last[1]) = (1.0, -1.0, 2.0);
    for (n, c) in chebyshev.iter().enumerate().take(count) {
        let of = if n == 0 { &before } else { &last };
        powers.iter_mut().zip(of).for_each(|(power, x)| *power += c * x);
        if n > 0 {
            // T_{n+1} = 2 (2θ − 1) T_n − T_{n−1}
            let mut next = [0.0; MOST];
            for k in 0..MOST {
                let lower = if k == 0 { 0.0 } else { last[k - 1] };
                next[k] = 4.0 * lower - 2.0 * last[k] - before[k];
            }
            (before, last) = (last, next);
        }
    }
    powers
}
