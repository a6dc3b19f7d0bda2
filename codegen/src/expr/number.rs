//! Exact constants.

use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, Mul};

use num_rational::Ratio;
use num_traits::Signed;

use super::rational::Rational;

/// A constant: exact as long as numerator and denominator fit, otherwise rounded to `f64`.
#[derive(Clone, Copy, Debug)]
pub enum Number {
    /// An exact rational number; numerator and denominator are at most 2⁵³ in size.
    Rational(Ratio<i64>),
    /// A rounded one.
    Float(f64),
}

/// What a numerator or denominator may grow to and still be worth keeping exact. Both then convert to `f64` without
/// rounding, so that their quotient is the correctly rounded value.
const EXACT: i64 = 1 << 53;

impl Number {
    /// 0
    pub const ZERO: Number = Number::Rational(Ratio::new_raw(0, 1));
    /// 1
    pub const ONE: Number = Number::Rational(Ratio::new_raw(1, 1));
    /// `4π²`, rounded: the square of a full turn.
    pub const FOUR_PI_SQUARED: Number = Number::Float(std::f64::consts::TAU * std::f64::consts::TAU);
    /// −1
    pub const MINUS_ONE: Number = Number::Rational(Ratio::new_raw(-1, 1));

    /// `numerator / denominator`; the denominator must not be zero.
    pub fn ratio(numerator: i128, denominator: i128) -> Self {
        debug_assert_ne!(denominator, 0);
        Self::from_ratio(Ratio::new(numerator, denominator))
    }

    fn from_ratio(ratio: Ratio<i128>) -> Self {
        Self::exact(ratio).unwrap_or_else(|| Self::rounded(*ratio.numer() as f64 / *ratio.denom() as f64))
    }

    /// The ratio, if it is worth keeping exact.
    fn exact(ratio: Ratio<i128>) -> Option<Self> {
        let part = |number: i128| {
            i64::try_from(number).ok().filter(|number| number.unsigned_abs() <= EXACT.unsigned_abs())
        };
        Some(Self::Rational(Ratio::new_raw(part(*ratio.numer())?, part(*ratio.denom())?)))
    }

    /// A rounded number. One that comes out whole counts as exact, so that terms which cancel and factors of one
    /// vanish.
    fn rounded(value: f64) -> Self {
        if value.fract() == 0.0 && value.abs() <= EXACT as f64 {
            Self::Rational(Ratio::from_integer(value as i64))
        } else {
            Self::Float(value)
        }
    }

    /// A decimal literal as Rust writes them (`0.1`, `1e-3`, `2.5e10`): exact if it fits.
    pub fn parse(literal: &str) -> Option<Self> {
        let literal = literal.replace('_', "");
        let (mantissa, exponent) = match literal.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
            None => (literal.as_str(), 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let rounded = || literal.parse::<f64>().ok().map(Self::rounded);
        let Ok(digits) = format!("{whole}{fraction}").parse::<i128>() else { return rounded() };
        let power = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
        let Some(scale) = 10i128.checked_pow(power.unsigned_abs()) else { return rounded() };
        let exact = if power >= 0 {
            digits.checked_mul(scale).map(Ratio::from_integer)
        } else {
            Some(Ratio::new(digits, scale))
        };
        exact.and_then(Self::exact).or_else(rounded)
    }

    /// The nearest double.
    pub fn to_f64(self) -> f64 {
        match self {
            Self::Rational(r) => *r.numer() as f64 / *r.denom() as f64,
            Self::Float(x) => x,
        }
    }

    /// Numerator and denominator of a fraction that is no double: the compiler divides them.
    pub(crate) fn wide_fraction(self) -> Option<[f64; 2]> {
        let (numerator, denominator) = self.fraction()?;
        (denominator & (denominator - 1) != 0).then_some([numerator as f64, denominator as f64])
    }

    /// The double that emitted code computes with.
    pub fn as_emitted(self) -> f64 {
        if self == Self::FOUR_PI_SQUARED {
            return std::f64::consts::TAU * std::f64::consts::TAU;
        }
        let value = self.to_f64();
        self.wide_fraction().map_or(if value.is_finite() { value } else { f64::NAN }, |[a, b]| a / b)
    }

    /// Whether it is neither infinite nor not a number.
    pub fn is_finite(self) -> bool {
        match self {
            Self::Rational(_) => true,
            Self::Float(x) => x.is_finite(),
        }
    }

    /// Numerator and denominator, if it is exact.
    pub fn fraction(self) -> Option<(i128, i128)> {
        match self {
            Self::Rational(r) => Some(((*r.numer()).into(), (*r.denom()).into())),
            Self::Float(_) => None,
        }
    }

    /// Whether it is exactly 0.
    pub fn is_zero(self) -> bool {
        self == Self::ZERO
    }

    /// Whether it is exactly 1.
    pub fn is_one(self) -> bool {
        self == Self::ONE
    }

    /// Whether it is 2, 4, 8, … or one of 1/2, 1/4, 1/8, …
    pub fn scales_exactly(self) -> bool {
        let power = |number: i128| number.count_ones() == 1 && number > 0;
        self.fraction().is_some_and(|(numerator, denominator)| power(numerator) && power(denominator))
            && !self.is_one()
    }

    /// Whether it is below 0.
    pub fn is_negative(self) -> bool {
        match self {
            Self::Rational(r) => r.is_negative(),
            Self::Float(x) => x < 0.0,
        }
    }

    /// Its magnitude.
    pub fn abs(self) -> Self {
        if self.is_negative() { -self } else { self }
    }

    /// `self / content` for the content of the sum in which `self` is a coefficient: a sign, or a magnitude that all
    /// coefficients share. It does not divide, because rounded numbers may miss one when divided by themselves.
    pub(super) fn without(self, content: Self) -> Self {
        if content.abs().is_one() {
            content * self
        } else if self.is_zero() {
            Self::ZERO
        } else if self.is_negative() == content.is_negative() {
            Self::ONE
        } else {
            Self::MINUS_ONE
        }
    }

    /// `self^exponent`; zero to a negative power is infinite.
    pub fn powi(self, exponent: i32) -> Self {
        if let Self::Rational(r) = self
            && !(self.is_zero() && exponent < 0)
        {
            let base = if exponent < 0 { r.recip() } else { r };
            let power = |part: &i64| i128::from(*part).checked_pow(exponent.unsigned_abs());
            // powers of numbers without a common divisor have none
            if let (Some(numerator), Some(denominator)) = (power(base.numer()), power(base.denom())) {
                return Self::from_ratio(Ratio::new_raw(numerator, denominator));
            }
        }
        Self::rounded(self.to_f64().powi(exponent))
    }

    /// The square root where it is rational.
    pub fn exact_sqrt(self) -> Option<Self> {
        let Self::Rational(r) = self else { return None };
        let (numerator, denominator) = Rational::from(r).square_root()?.parts()?;
        Some(Self::ratio(numerator, denominator))
    }

    fn combine(
        self,
        other: Self,
        exact: fn(Rational, Rational) -> Rational,
        rounded: fn(f64, f64) -> f64,
    ) -> Self {
        if let (Self::Rational(a), Self::Rational(b)) = (self, other)
            && let Some((numerator, denominator)) = exact(a.into(), b.into()).parts()
        {
            return Self::from_ratio(Ratio::new_raw(numerator, denominator));
        }
        Self::rounded(rounded(self.to_f64(), other.to_f64()))
    }
}

impl Add for Number {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.combine(other, Rational::add, f64::add)
    }
}

impl Mul for Number {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.combine(other, Rational::mul, f64::mul)
    }
}

impl std::ops::Neg for Number {
    type Output = Self;
    fn neg(self) -> Self {
        match self {
            Self::Rational(r) => Self::Rational(-r),
            Self::Float(x) => Self::Float(-x),
        }
    }
}

impl From<i64> for Number {
    fn from(value: i64) -> Self {
        Self::ratio(value.into(), 1)
    }
}

// Structural, so that constants can be hashed: a float never equals a rational, and not-a-number equals itself.
impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            // both are in lowest terms
            (Self::Rational(a), Self::Rational(b)) => (a.numer(), a.denom()) == (b.numer(), b.denom()),
            (Self::Float(a), Self::Float(b)) => a.to_bits() == b.to_bits(),
            _ => false,
        }
    }
}

impl Eq for Number {}

impl std::hash::Hash for Number {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        match self {
            Self::Rational(r) => (r.numer(), r.denom()).hash(state),
            Self::Float(x) => x.to_bits().hash(state),
        }
    }
}

impl PartialOrd for Number {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.to_f64().partial_cmp(&other.to_f64())
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rational(r) => write!(f, "{r}"),
            _ if *self == Self::FOUR_PI_SQUARED => f.write_str("4π²"),
            Self::Float(x) => write!(f, "{x:?}"),
        }
    }
}
