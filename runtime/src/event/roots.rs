//! All real roots of a polynomial between 0 and 1: where an event is whose power series within a step is known.
//!
//! Where the polynomial is steepest or flat is found first: the changes of sign of its derivative, isolated by Descartes' rule of signs for
//! Bernstein coefficients with bisection (A. Eigenwillig, *Real Root Isolation for Exact and Approximate Polynomials Using Descartes' Rule of
//! Signs*, 2008). Between two of them the polynomial rises or falls: it has one root there, or none. A double root is one of them at which the
//! polynomial is zero but for rounding. Nothing is allocated, and the work is bounded.

use core::cell::Cell;

use super::Crossing;
use super::search::{Point, crossing};

/// Coefficients, at most.
const LENGTH: usize = 33;

/// A root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Root {
    /// Where it is; of a crossing the first number after it, if it is none itself.
    pub(crate) at: f64,
    pub(crate) crossing: Crossing,
}

/// What is known of the roots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// They are those that were found.
    All,
    /// All numbers are: the polynomial is zero.
    Zero,
    /// Nothing was sought: a coefficient is not finite, or the degree too high.
    Unknown,
    /// More work than is bearable would find some more, or fewer.
    Unresolved,
}

/// Intervals that are looked at, at most.
const MOST_INTERVALS: u32 = 4_000;
/// How often an interval is halved, at most: two changes of sign of the derivative that are closer change nothing that could be seen.
const MOST_HALVINGS: u32 = 30;
/// Where the first interval is cut: at none of the simple fractions at which polynomials like to be zero.
const CUT: f64 = 0.483_7;
/// An extremum that is smaller is near zero, relative to all terms.
const NEAR: f64 = 1e-4;
/// Farther apart two roots are two, and a complex root is none.
const DOUBLE: f64 = 1e-5;

/// Whether coefficients that are rounded tell all roots of what they are those of: an extremum, or a slope where it is zero, may be no more than what
/// rounding leaves of its terms, as where many roots lie close together and far from 0. A part of it, expanded anew, tells more.
pub(crate) fn are_clear(coefficients: &[f64]) -> bool {
    let is_clear = Cell::new(true);
    let terms = |at: f64| {
        let [mut value, mut slope, mut size] = [0.0; 3];
        for x in coefficients.iter().rev() {
            (slope, value, size) = (slope * at + value, value * at + x, size * at + x.abs());
        }
        [f64::abs(value), f64::abs(slope), size]
    };
    let see = |at: f64| {
        let [value, slope, size] = terms(at);
        // at a crossing the slope tells, at an extremum the value
        if value < CLEAR * size && slope < CLEAR_SLOPE * size {
            is_clear.set(false);
        }
    };
    // a zero at the start is known as such
    let answer = roots(
        coefficients,
        &mut |root| {
            if root.at > 0.0 {
                see(root.at)
            }
        },
        &mut |at| see(at),
    );
    matches!(answer, Answer::Zero) || is_clear.get()
}

/// Values and slopes that are smaller, relative to the terms, may be rounding.
const CLEAR: f64 = 1e-12;
const CLEAR_SLOPE: f64 = 1e-8;

/// Tells the real roots from 0 to 1 of the polynomial with these coefficients, the constant one first: each once, in their order.
///
/// A double root is told as a [`Crossing::Touch`], also where the rounding of the coefficients has made two of it, or none. Roots of higher
/// multiplicity are crossings or touches as their multiplicity is odd or even.
///
/// Extrema that come near zero, and are no roots, are told as well, in the same order: of coefficients that are not exact they may be some.
pub(crate) fn roots(
    coefficients: &[f64],
    found: &mut impl FnMut(Root),
    near: &mut impl FnMut(f64),
) -> Answer {
    let length = coefficients.iter().rposition(|x| *x != 0.0).map_or(0, |last| last + 1);
    let coefficients = coefficients.get(..length).unwrap_or_default();
    let largest =
        coefficients.iter().fold(0.0_f64, |largest, x| if x.is_nan() { *x } else { largest.max(x.abs()) });
    if length == 0 {
        return Answer::Zero;
    }
    if length > LENGTH || !largest.is_finite() || coefficients.iter().any(|x| x.is_nan()) {
        return Answer::Unknown;
    }
    // so that neither products nor their errors leave the range of numbers
    let scale = power_of_two_below(largest);
    let mut own = Polynomial { coefficients: [Wide::ZERO; LENGTH], length: 0, size: 0.0 };
    let zeros = coefficients.iter().position(|x| *x != 0.0).unwrap_or(0);
    for x in coefficients.iter().skip(zeros) {
        own.push(Wide::exactly(x / scale));
    }
    let first = own.at_zero();
    if zeros > 0 {
        // a factor θⁿ, which is positive behind 0
        let crossing = match (zeros % 2, first > 0.0) {
            (0, _) => Crossing::Touch,
            (_, true) => Crossing::Rising,
            (_, false) => Crossing::Falling,
        };
        found(Root { at: 0.0, crossing });
    }
    let mut is_sure = true;
    match own.variations() {
        Some(0) => {}
        Some(1) => {
            let far = Point { at: 1.0, value: own.value(1.0) };
            found(own.crossing(Point { at: 0.0, value: first }, far));
        }
        _ => is_sure = own.rising_and_falling(found, near),
    }
    if is_sure { Answer::All } else { Answer::Unresolved }
}

/// A power of two that is no larger than a number, nor much smaller; of the smallest numbers the smallest that divides.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0x7ff0_0000_0000_0000).max(f64::MIN_POSITIVE)
}

/// A polynomial whose constant coefficient is not zero.
struct Polynomial {
    coefficients: [Wide; LENGTH],
    length: usize,
    /// The sum of the coefficients without their signs.
    size: f64,
}

/// What rounding leaves of numbers with twice the digits, relative to the terms of the largest polynomial.
const ROUNDING: f64 = 1e-28;

impl Polynomial {
    fn push(&mut self, x: Wide) {
        if let Some(slot) = self.coefficients.get_mut(self.length) {
            *slot = x;
            self.length += 1;
            self.size += x.high.abs();
        }
    }

    fn terms(&self) -> &[Wide] {
        self.coefficients.get(..self.length).unwrap_or_default()
    }

    fn at_zero(&self) -> f64 {
        self.terms().first().map_or(0.0, |first| first.high)
    }

    /// How often its Bernstein coefficients change their sign, where that is certain and tells all: 0 and 1 are numbers of roots.
    fn variations(&self) -> Option<u32> {
        let mut bernstein = [0.0; LENGTH];
        bernstein.iter_mut().zip(self.terms()).for_each(|(b, x)| *b = x.high);
        let bernstein = bernstein.get_mut(..self.length).unwrap_or_default();
        to_bernstein(bernstein, |a, b| a + b, |x, by| x / by);
        let rounding = 8.0 * f64::EPSILON * self.length as f64 * self.size;
        variations(bernstein.iter().copied(), rounding)
    }

    /// The value, with the right sign, or 0 if it is no more than the rounding of numbers with twice the digits.
    fn value(&self, at: f64) -> f64 {
        let value = self.terms().iter().rev().fold(0.0, |sum, x| sum * at + x.high);
        if value.abs() > 4.0 * f64::EPSILON * self.length as f64 * self.size {
            return value;
        }
        let sum = self.terms().iter().rev().fold(Wide::ZERO, |sum, x| sum.times(at).plus(*x));
        if sum.high.abs() <= ROUNDING * self.size { 0.0 } else { sum.high }
    }

    fn crossing(&self, near: Point, far: Point) -> Root {
        let crossing = if near.value < 0.0 { Crossing::Rising } else { Crossing::Falling };
        Root { at: self.change(near, far), crossing }
    }

    /// The first number after a change of sign between two points.
    fn change(&self, near: Point, far: Point) -> f64 {
        if far.value == 0.0 {
            return far.at;
        }
        let mut value = |at: f64| Ok::<f64, core::convert::Infallible>(self.value(at));
        match crossing(&mut value, near, far, 2.0 * f64::EPSILON) {
            Ok((_, far)) => far.at,
            Err(never) => match never {},
        }
    }

    /// The derivative, and how often the factor θ stands before it.
    fn derivative(&self) -> Self {
        let mut derivative = Self { coefficients: [Wide::ZERO; LENGTH], length: 0, size: 0.0 };
        for (power, x) in self.terms().iter().enumerate().skip(1) {
            // behind 0 a power of θ changes no sign
            if derivative.length > 0 || x.high != 0.0 {
                derivative.push(x.times(power as f64));
            }
        }
        derivative
    }

    /// Tells the roots, one between two extrema at most. Whether all were found.
    fn rising_and_falling(&self, found: &mut impl FnMut(Root), near: &mut impl FnMut(f64)) -> bool {
        let derivative = self.derivative();
        let mut before = Point { at: 0.0, value: self.at_zero() };
        let mut touch = None;
        let mut meet = |point: Point, found: &mut dyn FnMut(Root)| {
            if point.value == 0.0 {
                touch = touch.or(Some(point.at));
                return;
            }
            if (point.value > 0.0) != (before.value > 0.0) {
                found(self.crossing(before, point));
            } else if let Some(at) = touch {
                found(Root { at, crossing: Crossing::Touch });
            }
            (before, touch) = (point, None);
        };
        let is_sure = derivative.changes(&mut |at| {
            if at < 1.0 {
                let value = self.value(at);
                let size = self.size_at(at);
                let value = if self.is_double(at, value, size) { 0.0 } else { value };
                meet(Point { at, value }, found);
                if value != 0.0 && value.abs() < NEAR * self.size {
                    near(at);
                }
            }
        });
        let end = Point { at: 1.0, value: self.value(1.0) };
        if end.value != 0.0 {
            meet(end, found);
            return is_sure;
        }
        let is_flat = derivative.value(1.0).abs() <= 4.0 * f64::EPSILON * derivative.size;
        let crossing = match (is_flat, before.value > 0.0) {
            (true, _) => Crossing::Touch,
            (false, true) => Crossing::Falling,
            (false, false) => Crossing::Rising,
        };
        found(Root { at: 1.0, crossing });
        is_sure
    }

    /// Whether an extremum with this value is a double root, but for what the coefficients were rounded by.
    fn is_double(&self, at: f64, value: f64, size: f64) -> bool {
        let mut second = 0.0;
        for (power, x) in self.terms().iter().enumerate().rev() {
            if power >= 2 {
                second = second * at + x.high * (power * (power - 1)) as f64;
            }
        }
        // half the distance of the two roots, real or not
        value.abs() <= 8.0 * f64::EPSILON * size && value.abs() <= 0.5 * DOUBLE * DOUBLE * second.abs()
    }

    /// The value without the signs of the coefficients.
    fn size_at(&self, at: f64) -> f64 {
        self.terms().iter().rev().fold(0.0, |sum, x| sum * at + x.high.abs())
    }

    /// Tells where the sign changes between 0 and 1, in order. Whether that is certain.
    fn changes(&self, found: &mut dyn FnMut(f64)) -> bool {
        let mut before = Point { at: 0.0, value: self.at_zero() };
        if self.length < 2 {
            return true;
        }
        let mut intervals = 0;
        for (from, to) in [(0.0, CUT), (CUT, 1.0)] {
            let (mut place, mut halvings) = (0_u64, 0);
            // all intervals of this many halvings, or the halves of what they are halves of
            loop {
                intervals += 1;
                if intervals > MOST_INTERVALS {
                    return false;
                }
                let of = |place: u64| from + (to - from) * (place as f64 / (1_u64 << halvings) as f64);
                let (left, right) = (of(place), if place + 1 == 1 << halvings { to } else { of(place + 1) });
                let known = self.variations_between(left, right).filter(|count| *count < 2);
                if known.is_none() && halvings < MOST_HALVINGS {
                    (place, halvings) = (2 * place, halvings + 1);
                    continue;
                }
                if let Some(count) = known {
                    let ends = [left, right].map(|at| Point { at, value: self.value(at) });
                    if (before.value > 0.0) != (ends[0].value > 0.0) {
                        found(self.change(before, ends[0]));
                    }
                    if count == 1 {
                        found(self.change(ends[0], ends[1]));
                    }
                    before = ends[1];
                }
                place += 1;
                while place % 2 == 0 && halvings > 0 {
                    (place, halvings) = (place / 2, halvings - 1);
                }
                if halvings == 0 {
                    break;
                }
            }
        }
        let end = self.value(1.0);
        if before.at < 1.0 && end != 0.0 && (before.value > 0.0) != (end > 0.0) {
            found(self.change(before, Point { at: 1.0, value: end }));
        }
        true
    }

    /// How often the Bernstein coefficients of a part change their sign, where that is certain.
    fn variations_between(&self, left: f64, right: f64) -> Option<u32> {
        let mut moved = self.coefficients;
        let moved = moved.get_mut(..self.length).unwrap_or_default();
        // to `left`, as Horner's rule leads to the value there; then to the width 1
        for done in 0..moved.len() {
            let mut sum = Wide::ZERO;
            for x in moved.iter_mut().skip(done).rev() {
                sum = sum.times(left).plus(*x);
                *x = sum;
            }
        }
        let (width, mut power) = (right - left, Wide::exactly(1.0));
        for x in moved.iter_mut() {
            *x = x.times_wide(power);
            power = power.times(width);
        }
        to_bernstein(moved, Wide::plus, Wide::over);
        let rounding = ROUNDING * self.size;
        variations(moved.iter().map(|x| x.high), rounding)
    }
}

/// Takes the coefficients of powers of θ to Bernstein coefficients: those of the power k are divided by `n` over `k`, then summed.
fn to_bernstein<T: Copy>(coefficients: &mut [T], plus: impl Fn(T, T) -> T, over: impl Fn(T, f64) -> T) {
    let degree = coefficients.len().saturating_sub(1);
    // up to 32 over 16 = 601 080 390 without rounding
    let mut binomial = 1.0;
    for (power, x) in coefficients.iter_mut().enumerate() {
        if power > 0 {
            binomial = binomial * (degree + 1 - power) as f64 / power as f64;
            *x = over(*x, binomial);
        }
    }
    for done in 1..=degree {
        for power in (done..=degree).rev() {
            if let (Some(&before), Some(x)) = (coefficients.get(power - 1), coefficients.get(power)) {
                let sum = plus(*x, before);
                if let Some(x) = coefficients.get_mut(power) {
                    *x = sum;
                }
            }
        }
    }
}

/// How often numbers change their sign; none if one of them is too small for its sign to be known.
fn variations(numbers: impl Iterator<Item = f64>, rounding: f64) -> Option<u32> {
    let (mut count, mut before) = (0, None);
    for number in numbers {
        if !(number.abs() > rounding) {
            return None;
        }
        let is_positive = number > 0.0;
        count += u32::from(before.is_some_and(|before| before != is_positive));
        before = Some(is_positive);
    }
    Some(count)
}

/// A number of twice as many digits, of moderate size: `high + low`.
#[derive(Clone, Copy)]
struct Wide {
    high: f64,
    low: f64,
}

impl Wide {
    const ZERO: Self = Self::exactly(0.0);

    const fn exactly(high: f64) -> Self {
        Self { high, low: 0.0 }
    }

    /// `a + b` where `a` is the larger.
    fn ordered(a: f64, b: f64) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }

    fn plus(self, other: Self) -> Self {
        let high = self.high + other.high;
        let part = high - self.high;
        let low = (self.high - (high - part)) + (other.high - part);
        Self::ordered(high, low + (self.low + other.low))
    }

    fn product(a: f64, b: f64) -> Self {
        let halves = |x: f64| {
            let scaled = x * 134_217_729.0;
            let high = scaled - (scaled - x);
            (high, x - high)
        };
        let high = a * b;
        let ((a, c), (b, d)) = (halves(a), halves(b));
        Self { high, low: (((a * b - high) + a * d) + c * b) + c * d }
    }

    fn times(self, by: f64) -> Self {
        let Self { high, low } = Self::product(self.high, by);
        Self::ordered(high, low + self.low * by)
    }

    fn times_wide(self, by: Self) -> Self {
        let Self { high, low } = Self::product(self.high, by.high);
        Self::ordered(high, low + (self.high * by.low + self.low * by.high))
    }

    /// The quotient by a number.
    fn over(self, by: f64) -> Self {
        let first = self.high / by;
        let rest = self.plus(Self::product(-first, by));
        Self::ordered(first, rest.high / by)
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::double::Double;
    use crate::scalar::Scalar;
    use std::vec::Vec;

    type Number = Double<f64>;

    /// Numbers from 0 to 1, always the same.
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn between(&mut self, least: f64, most: f64) -> f64 {
            least + (most - least) * self.next()
        }
    }

    fn found(coefficients: &[f64]) -> (Vec<Root>, Answer) {
        let mut all = Vec::new();
        let answer = roots(coefficients, &mut |root| all.push(root), &mut |_| {});
        (all, answer)
    }

    fn at(coefficients: &[f64], x: Number) -> Number {
        coefficients.iter().rev().fold(Number::of(0.0), |sum, c| sum * x + Number::of(*c))
    }

    /// Nearest numbers to the coefficients of a product of factors.
    fn product(factors: &[[f64; 3]]) -> Vec<f64> {
        let mut product = std::vec![Number::of(1.0)];
        for factor in factors {
            let mut next = std::vec![Number::of(0.0); product.len() + 2];
            for (i, x) in product.iter().enumerate() {
                for (j, c) in factor.iter().enumerate() {
                    next[i + j] = next[i + j] + *x * Number::of(*c);
                }
            }
            product = next;
        }
        product.into_iter().map(|x| x.parts()[0]).collect()
    }

    /// `(θ − r) c`, or `(θ − r)² + s`.
    fn linear(root: f64, by: f64) -> [f64; 3] {
        [-root * by, by, 0.0]
    }

    fn square(root: f64, by: f64) -> [f64; 3] {
        [(Number::of(root) * Number::of(root) + Number::of(by)).parts()[0], -2.0 * root, 1.0]
    }

    /// Between two numbers with values of different signs, with twice the digits.
    fn bisected(coefficients: &[f64], mut from: f64, mut to: f64) -> f64 {
        let is_positive = |x: f64| at(coefficients, Number::of(x)).parts()[0] > 0.0;
        let first = is_positive(from);
        for _ in 0..80 {
            let middle = 0.5 * (from + to);
            if is_positive(middle) == first { from = middle } else { to = middle }
        }
        to
    }

    fn assert_crossings(coefficients: &[f64], expected: &[f64]) {
        let (all, answer) = found(coefficients);
        assert_eq!(answer, Answer::All, "{coefficients:?}");
        assert_eq!(all.len(), expected.len(), "{all:?} instead of {expected:?} of {coefficients:?}");
        for (root, expected) in all.iter().zip(expected) {
            assert!((root.at - expected).abs() < 1e-12, "{root:?} instead of {expected}");
            let after = at(coefficients, Number::of(root.at + 1e-6)).parts()[0] > 0.0;
            let crossing = if after { Crossing::Rising } else { Crossing::Falling };
            assert_eq!(root.crossing, crossing);
        }
    }

    #[test]
    fn roots_that_are_known_are_found() {
        let mut random = Random(1);
        for _ in 0..10_000 {
            let mut roots: Vec<f64> = Vec::new();
            for _ in 0..(random.next() * 8.0) as usize {
                let root = random.next();
                if roots.iter().all(|other| (other - root).abs() > 0.03) {
                    roots.push(root);
                }
            }
            roots.sort_by(f64::total_cmp);
            let mut factors: Vec<_> =
                roots.iter().map(|root| linear(*root, random.between(-2.0, 2.0).signum() * 1.5)).collect();
            for _ in 0..(random.next() * 3.0) as usize {
                factors.push(square(random.between(-0.5, 1.5), random.between(0.01, 1.0)));
                let outside = random.between(0.05, 2.0);
                factors.push(linear(if random.next() < 0.5 { -outside } else { 1.0 + outside }, 1.0));
            }
            let coefficients = product(&factors);
            // those of the rounded coefficients
            let end = |k: usize| roots.get(k).copied().unwrap_or(1.0);
            let expected: Vec<f64> = (0..roots.len())
                .map(|k| {
                    let from = if k == 0 { 0.0 } else { 0.5 * (end(k - 1) + end(k)) };
                    bisected(&coefficients, from, 0.5 * (end(k) + end(k + 1)))
                })
                .collect();
            assert!(roots.iter().zip(&expected).all(|(root, exact)| (root - exact).abs() < 1e-5));
            assert_crossings(&coefficients, &expected);
        }
    }

    #[test]
    fn waves_cross_up_to_twelve_times() {
        let mut random = Random(2);
        let (mut most, mut tried) = (0, 0);
        while tried < 500 {
            let mut coefficients = std::vec![0.0; LENGTH];
            for wave in 0..3 {
                let (rate, phase) = (random.between(1.0, 38.0), random.between(0.0, 6.0));
                let mut term = if wave == 0 { 1.0 } else { random.between(-0.3, 0.3) };
                for (power, x) in coefficients.iter_mut().enumerate() {
                    // the derivatives of a sine
                    let angle = phase + power as f64 * core::f64::consts::FRAC_PI_2;
                    *x += term * angle.sin();
                    term *= rate / (power + 1) as f64;
                }
            }
            let values: Vec<f64> =
                (0..=2000).map(|k| at(&coefficients, Number::of(f64::from(k) / 2000.0)).parts()[0]).collect();
            // what nearly touches zero is another test's
            let is_dip = |w: &[f64]| {
                w[1].abs() < w[0].abs().min(w[2].abs())
                    && w[1].abs() < 0.1 * (w[0] + w[2] - 2.0 * w[1]).abs()
                    && (w[0] > 0.0) == (w[2] > 0.0)
            };
            if values.windows(3).any(is_dip) {
                continue;
            }
            let place = |k: usize| k as f64 / 2000.0;
            let changes = (0..2000).filter(|&k| (values[k] > 0.0) != (values[k + 1] > 0.0));
            let expected: Vec<f64> =
                changes.map(|k| bisected(&coefficients, place(k), place(k + 1))).collect();
            most = most.max(expected.len());
            tried += 1;
            assert_crossings(&coefficients, &expected);
        }
        assert!(most >= 6, "{most}");
    }

    /// Sums of cosines of multiples of an angle, in powers of `(1 − cos)/2`: Chebyshev's polynomials.
    #[test]
    fn sums_of_cosines_cross_up_to_twelve_times() {
        let mut random = Random(5);
        let mut chebyshev = std::vec![std::vec![1.0], std::vec![-1.0, 2.0]];
        for degree in 2..=12 {
            let [.., before, last] = &chebyshev[..] else { unreachable!() };
            let mut next = std::vec![0.0; degree + 1];
            for (k, x) in last.iter().enumerate() {
                next[k] -= 2.0 * x;
                next[k + 1] += 4.0 * x;
            }
            next.iter_mut().zip(before).for_each(|(x, y)| *x -= y);
            chebyshev.push(next);
        }
        let zero = |k: usize| 0.5 - 0.5 * ((2 * k + 1) as f64 * core::f64::consts::PI / 24.0).cos();
        assert_crossings(&chebyshev[12], &(0..12).map(zero).collect::<Vec<_>>());
        for _ in 0..500 {
            let mut coefficients = chebyshev[12].clone();
            for other in &chebyshev[..12] {
                let by = random.between(-0.08, 0.08);
                coefficients.iter_mut().zip(other).for_each(|(x, y)| *x += by * y);
            }
            // between its extrema, where the others together are less
            let extremum = |k: usize| 0.5 - 0.5 * (k as f64 * core::f64::consts::PI / 12.0).cos();
            let expected: Vec<f64> =
                (0..12).map(|k| bisected(&coefficients, extremum(k), extremum(k + 1))).collect();
            assert_crossings(&coefficients, &expected);
        }
    }

    #[test]
    fn double_roots_are_touches() {
        let mut random = Random(3);
        let mut lost = 0;
        for _ in 0..2_000 {
            let (touch, root) = (random.between(0.01, 0.99), random.next());
            if (touch - root).abs() < 0.05 {
                continue;
            }
            let complex = square(random.between(-0.5, 1.5), random.between(0.1, 1.0));
            let coefficients = product(&[square(touch, 0.0), linear(root, 1.0), complex]);
            let (all, answer) = found(&coefficients);
            assert_eq!(answer, Answer::All);
            let is_touch = |root: &&Root| root.crossing == Crossing::Touch;
            lost += usize::from(!all.iter().any(|root| is_touch(&root)));
            assert!(all.iter().filter(is_touch).all(|root| (root.at - touch).abs() < 1e-6), "{all:?}");
            let crossings: Vec<f64> = all.iter().filter(|root| !is_touch(root)).map(|root| root.at).collect();
            assert_eq!(crossings.len(), 1, "{all:?} of {touch} {root}");
            assert!((crossings[0] - root).abs() < 1e-11, "{all:?} of {root}");
            assert!(all.windows(2).all(|pair| pair[0].at < pair[1].at));
        }
        assert_eq!(lost, 0);
        // as far from zero as can be told, they are two roots or none
        let coefficients = product(&[square(0.3, -1e-8)]);
        assert_eq!(found(&coefficients).0.len(), 2);
        assert_eq!(found(&product(&[square(0.3, 1e-8)])).0.len(), 0);
    }

    #[test]
    fn ends_multiple_roots_and_degenerate_polynomials() {
        let of = |coefficients: &[f64]| {
            let (all, answer) = found(coefficients);
            (all.iter().map(|root| (root.at, root.crossing)).collect::<Vec<_>>(), answer)
        };
        use Crossing::{Falling, Rising, Touch};
        assert_eq!(of(&[]), (std::vec![], Answer::Zero));
        assert_eq!(of(&[0.0, -0.0, 0.0]), (std::vec![], Answer::Zero));
        assert_eq!(of(&[1.0]), (std::vec![], Answer::All));
        assert_eq!(of(&[f64::NAN, 1.0]).1, Answer::Unknown);
        assert_eq!(of(&[1.0, f64::INFINITY]).1, Answer::Unknown);
        assert_eq!(of(&[1.0; 34]).1, Answer::Unknown);
        assert_eq!(of(&[0.0, 1.0]), (std::vec![(0.0, Rising)], Answer::All));
        assert_eq!(of(&[0.0, 0.0, -1.0]), (std::vec![(0.0, Touch)], Answer::All));
        assert_eq!(of(&[0.0, 0.0, 0.0, -1.0, 2.0]), (std::vec![(0.0, Falling), (0.5, Rising)], Answer::All));
        assert_eq!(of(&[-1.0, 1.0]), (std::vec![(1.0, Rising)], Answer::All));
        assert_eq!(of(&[1.0, -2.0, 1.0]), (std::vec![(1.0, Touch)], Answer::All));
        assert_eq!(of(&[0.25, -1.0, 1.0]), (std::vec![(0.5, Touch)], Answer::All));
        assert_eq!(of(&[0.5, -1.0]), (std::vec![(0.5, Falling)], Answer::All));
        // three in one, and four
        let triple = product(&[square(0.375, 0.0), linear(0.375, 1.0)]);
        let (all, _) = found(&triple);
        assert!(all.len() == 1 && all[0].crossing == Rising && (all[0].at - 0.375).abs() < 1e-5, "{all:?}");
        let four = product(&[square(0.375, 0.0), square(0.375, 0.0)]);
        let (all, _) = found(&four);
        assert!(all.len() == 1 && all[0].crossing == Touch && (all[0].at - 0.375).abs() < 1e-3, "{all:?}");
        // flat, tiny, huge, and all powers
        for scale in [1e-300, 1.0, 1e300] {
            let (all, answer) = found(&[-0.25 * scale, 0.0, scale]);
            assert_eq!((all.len(), all[0].at, answer), (1, 0.5, Answer::All));
            let mut flat = std::vec![0.0; LENGTH];
            (flat[0], flat[32]) = (-1e-6 * scale, scale);
            let (all, answer) = found(&flat);
            assert!(
                (all[0].at - 1e-6_f64.powf(1.0 / 32.0)).abs() < 1e-14 && answer == Answer::All,
                "{all:?}"
            );
        }
        let noise: Vec<f64> = (0..LENGTH).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert_eq!(of(&noise), (std::vec![], Answer::All));
        // hopeless ones end
        let mut random = Random(4);
        for _ in 0..200 {
            let coefficients: Vec<f64> = (0..LENGTH)
                .map(|_| (random.between(-300.0, 300.0)).exp2() * random.between(-1.0, 1.0))
                .collect();
            let (all, _) = found(&coefficients);
            assert!(all.windows(2).all(|pair| pair[0].at < pair[1].at), "{all:?}");
        }
    }
}
