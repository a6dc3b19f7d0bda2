//! Exact fractions.

use std::iter::Sum;
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_rational::Ratio;
use num_traits::{CheckedAdd, CheckedDiv, CheckedMul, CheckedSub};

/// Numerators and denominators grow no larger.
const LARGEST: u128 = 1 << 120;

/// An exact fraction; unknown where its numbers have grown too large, and then so is all that is made of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rational(Option<Ratio<i128>>);

impl Rational {
    pub(crate) fn new(numerator: i128, denominator: i128) -> Self {
        Self::of((denominator != 0).then(|| Ratio::new(numerator, denominator)))
    }

    fn of(ratio: Option<Ratio<i128>>) -> Self {
        let is_small = |part: &i128| part.unsigned_abs() <= LARGEST;
        Self(ratio.filter(|ratio| is_small(ratio.numer()) && is_small(ratio.denom())))
    }

    pub(crate) fn zero() -> Self {
        Self::from(0)
    }

    pub(crate) fn one() -> Self {
        Self::from(1)
    }

    /// Whether it is known, and zero.
    pub(crate) fn is_zero(&self) -> bool {
        matches!(&self.0, Some(ratio) if *ratio.numer() == 0)
    }

    /// Whether it is known, and negative.
    pub(crate) fn is_negative(&self) -> bool {
        self.0.is_some_and(|ratio| *ratio.numer() < 0)
    }

    pub(crate) fn is_exact(&self) -> bool {
        self.0.is_some()
    }

    /// Numerator and denominator, if they are known.
    pub(crate) fn parts(&self) -> Option<(i128, i128)> {
        self.0.map(Ratio::into_raw)
    }

    /// The same with smaller numbers, if it is known and they are small enough.
    pub(crate) fn ratio(&self) -> Option<Ratio<i64>> {
        let (numerator, denominator) = self.parts()?;
        Some(Ratio::new(i64::try_from(numerator).ok()?, i64::try_from(denominator).ok()?))
    }

    /// The root of the square of a fraction; none of other numbers.
    pub(crate) fn square_root(&self) -> Option<Self> {
        let root = |square: i128| square.checked_isqrt().filter(|root| *root * *root == square);
        let (numerator, denominator) = self.parts()?;
        Some(Self::new(root(numerator)?, root(denominator)?))
    }

    /// The result of an operation; whole numbers, as most are, need no common divisor.
    fn with(
        self,
        other: Self,
        whole: fn(i128, i128) -> Option<i128>,
        operation: fn(&Ratio<i128>, &Ratio<i128>) -> Option<Ratio<i128>>,
    ) -> Self {
        let (Some(a), Some(b)) = (self.0, other.0) else { return Self(None) };
        if *a.denom() == 1 && *b.denom() == 1 {
            return Self::of(whole(*a.numer(), *b.numer()).map(Ratio::from_integer));
        }
        Self::of(operation(&a, &b))
    }
}

impl From<i128> for Rational {
    fn from(number: i128) -> Self {
        Self::of(Some(Ratio::from_integer(number)))
    }
}

impl From<Ratio<i64>> for Rational {
    fn from(ratio: Ratio<i64>) -> Self {
        Self(Some(Ratio::new_raw((*ratio.numer()).into(), (*ratio.denom()).into())))
    }
}

/// An operator that is checked for overflow.
macro_rules! checked {
    ($operator:ident $method:ident $checked:ident) => {
        impl $operator for Rational {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.with(other, i128::$checked, Ratio::$checked)
            }
        }
    };
}

checked!(Add add checked_add);
checked!(Sub sub checked_sub);
checked!(Mul mul checked_mul);

impl Div for Rational {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let (Some(a), Some(b)) = (self.0, other.0) else { return Self(None) };
        match *b.numer() {
            0 => Self(None),
            1 if *b.denom() == 1 => self,
            _ => Self::of(a.checked_div(&b)),
        }
    }
}

impl Neg for Rational {
    type Output = Self;
    fn neg(self) -> Self {
        Self::zero() - self
    }
}

impl Sum for Rational {
    fn sum<I: Iterator<Item = Self>>(fractions: I) -> Self {
        fractions.fold(Self::zero(), Add::add)
    }
}
