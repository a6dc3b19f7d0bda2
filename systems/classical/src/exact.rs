//! Exact numbers: what coefficients of methods are.

use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_rational::Ratio;
use num_traits::Zero;

/// The exact number `a + b √D`, with fractions `a` and `b` and a `D` that is no square; [rational numbers](Rational) have none of it.
///
/// Numerators and denominators have 127 bits: coefficients of any method in use are far from filling them in the conditions of order 6.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exact<const D: u32> {
    rational: Ratio<i128>,
    radical: Ratio<i128>,
}

/// A fraction.
pub type Rational = Exact<1>;

impl<const D: u32> Exact<D> {
    /// Nothing.
    pub fn zero() -> Self {
        Self { rational: Ratio::zero(), radical: Ratio::zero() }
    }

    /// `numerator/denominator`.
    ///
    /// # Panics
    /// If the denominator is zero.
    pub fn fraction(numerator: i64, denominator: i64) -> Self {
        Self { rational: Ratio::new(numerator.into(), denominator.into()), radical: Ratio::zero() }
    }

    /// `numerator/denominator √D`. Does not compile where `D` is a square: such a number would be a fraction.
    ///
    /// # Panics
    /// If the denominator is zero.
    pub fn root(numerator: i64, denominator: i64) -> Self {
        const { assert!(!is_square(D), "the square root is a whole number") };
        Self { rational: Ratio::zero(), radical: Ratio::new(numerator.into(), denominator.into()) }
    }

    /// Whether it is zero.
    pub fn is_zero(&self) -> bool {
        self.rational.is_zero() && self.radical.is_zero()
    }

    /// To the power `n`.
    pub fn power(self, n: u32) -> Self {
        (0..n).fold(Self::fraction(1, 1), |product, _| product * self)
    }

    /// Numerator and denominator, where there is no root.
    pub fn as_fraction(&self) -> Option<(i128, i128)> {
        self.radical.is_zero().then(|| (*self.rational.numer(), *self.rational.denom()))
    }

    /// The nearest `f64`, or a neighbour of it where there is a root.
    pub fn to_f64(self) -> f64 {
        let number = |ratio: Ratio<i128>| *ratio.numer() as f64 / *ratio.denom() as f64;
        if self.radical.is_zero() {
            number(self.rational)
        } else {
            number(self.rational) + number(self.radical) * f64::from(D).sqrt()
        }
    }
}

const fn is_square(number: u32) -> bool {
    let mut root = 0_u64;
    while root * root < number as u64 {
        root += 1;
    }
    root * root == number as u64
}

impl<const D: u32> Add for Exact<D> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { rational: self.rational + other.rational, radical: self.radical + other.radical }
    }
}

impl<const D: u32> Sub for Exact<D> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<const D: u32> Neg for Exact<D> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { rational: -self.rational, radical: -self.radical }
    }
}

impl<const D: u32> Mul for Exact<D> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let under = Ratio::from_integer(D.into());
        Self {
            rational: self.rational * other.rational + self.radical * other.radical * under,
            radical: self.rational * other.radical + self.radical * other.rational,
        }
    }
}

impl<const D: u32> Div<i64> for Exact<D> {
    type Output = Self;
    fn div(self, by: i64) -> Self {
        let by = i128::from(by);
        Self { rational: self.rational / by, radical: self.radical / by }
    }
}

impl<const D: u32> std::iter::Sum for Exact<D> {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::zero(), Add::add)
    }
}

impl<const D: u32> fmt::Display for Exact<D> {
    /// `1/4 - 1/6 √3`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rational, radical } = self;
        match (rational.is_zero(), radical.is_zero()) {
            (_, true) => write!(f, "{rational}"),
            (true, false) => write!(f, "{radical} √{D}"),
            (false, false) if *radical < Ratio::zero() => write!(f, "{rational} - {} √{D}", -radical),
            (false, false) => write!(f, "{rational} + {radical} √{D}"),
        }
    }
}
