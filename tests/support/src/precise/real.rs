//! Numbers of 77 digits, to hold closed forms against their definitions.

use std::cell::RefCell;
use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

use astro_float::{BigFloat, Consts, Radix, RoundingMode};
use coadjoint_codegen::expr::{Function, Number, Value};

use crate::random::Random;

/// Bits of the mantissa; `2^−256 ≈ 1e-77`.
const PRECISION: usize = 256;
const ROUNDING: RoundingMode = RoundingMode::ToEven;

thread_local! {
    static CONSTANTS: RefCell<Consts> = RefCell::new(Consts::new().expect("memory for π and ln 2"));
    /// `1/n!`
    static INVERSE_FACTORIALS: Vec<Real> = (1..400)
        .scan(Real::from(1), |inverse, n| Some(std::mem::replace(inverse, &*inverse / &Real::from(n))))
        .collect();
}

/// A real number, correctly rounded to 256 bits.
#[derive(Clone)]
pub struct Real(BigFloat);

impl Real {
    /// The nearest number to `numerator / denominator`.
    pub fn ratio(numerator: i64, denominator: i64) -> Self {
        Self::from(numerator) / Self::from(denominator)
    }

    /// `10^exponent`, for tiny steps.
    pub fn ten_to(exponent: i32) -> Self {
        Self::from(10).powi(exponent)
    }

    /// A double between −1 and 1.
    pub fn random(random: &mut Random) -> Self {
        Self::from(random.between(-1.0, 1.0))
    }

    /// `|self|`
    pub fn abs(&self) -> Self {
        Self(self.0.abs())
    }

    /// The square root.
    pub fn sqrt(&self) -> Self {
        Self(self.0.sqrt(PRECISION, ROUNDING))
    }

    /// `1/n!`, for power series.
    pub fn inverse_factorial(n: usize) -> Self {
        INVERSE_FACTORIALS.with(|table| table[n].clone())
    }

    /// Whether it is zero.
    pub fn is_zero(&self) -> bool {
        self.0.is_zero()
    }

    /// Neither infinite nor not a number.
    pub fn is_finite(&self) -> bool {
        !self.0.is_nan() && !self.0.is_inf()
    }

    /// Whether adding it to something of order one changes nothing.
    pub fn is_negligible(&self) -> bool {
        self.0.is_zero() || self.0.exponent().is_some_and(|exponent| exponent < -(PRECISION as i32) - 32)
    }

    /// The nearest double, or almost: what is measured is reported so.
    pub fn to_f64(&self) -> f64 {
        self.to_string().parse().unwrap_or(f64::NAN)
    }

    fn function(&self, f: impl FnOnce(&BigFloat, usize, RoundingMode, &mut Consts) -> BigFloat) -> Self {
        CONSTANTS.with(|constants| Self(f(&self.0, PRECISION, ROUNDING, &mut constants.borrow_mut())))
    }

    fn pi() -> Self {
        CONSTANTS.with(|constants| Self(constants.borrow_mut().pi(PRECISION, ROUNDING)))
    }

    /// `c_k(self) = Σ_j (−self)^j / (k + 2j)!`, the definition.
    fn stumpff(&self, k: usize) -> Self {
        let mut power = Self::from(1);
        let mut total = Self::from(0);
        for j in 0.. {
            let term = &power * &Self::inverse_factorial(k + 2 * j);
            if term.is_negligible() {
                return total;
            }
            total = total + term;
            power = -(power * self);
        }
        total
    }
}

impl From<f64> for Real {
    /// Exactly the double.
    fn from(x: f64) -> Self {
        Self(BigFloat::from_f64(x, PRECISION))
    }
}

impl From<i64> for Real {
    fn from(n: i64) -> Self {
        Self(BigFloat::from_i64(n, PRECISION))
    }
}

impl Value for Real {
    fn number(number: Number) -> Self {
        let integer = |n| Self(BigFloat::from_i128(n, PRECISION));
        match number.fraction() {
            Some((numerator, 1)) => integer(numerator),
            Some((numerator, denominator)) => integer(numerator) / integer(denominator),
            None => Self::from(number.to_f64()),
        }
    }

    fn add(&self, other: &Self) -> Self {
        self + other
    }

    fn mul(&self, other: &Self) -> Self {
        self * other
    }

    fn powi(&self, exponent: i32) -> Self {
        let power = Self(self.0.powi(exponent.unsigned_abs() as usize, PRECISION, ROUNDING));
        if exponent < 0 { Self::from(1) / power } else { power }
    }

    fn apply(&self, function: Function) -> Self {
        match function {
            Function::Sqrt => self.sqrt(),
            Function::Exp => self.function(BigFloat::exp),
            Function::Ln => self.function(BigFloat::ln),
            Function::Sin => self.function(BigFloat::sin),
            Function::Cos => self.function(BigFloat::cos),
            Function::Tan => self.function(BigFloat::tan),
            Function::Asin => self.function(BigFloat::asin),
            Function::Acos => self.function(BigFloat::acos),
            Function::Atan => self.function(BigFloat::atan),
            Function::Sinh => self.function(BigFloat::sinh),
            Function::Cosh => self.function(BigFloat::cosh),
            Function::Tanh => self.function(BigFloat::tanh),
            Function::Stumpff(k) => self.stumpff(k as usize),
        }
    }

    /// `exp(exponent · ln self)`. The library's own power looks for more and more digits where the result is exact, as `4^½`.
    fn power(&self, exponent: &Self) -> Self {
        (exponent * self.apply(Function::Ln)).apply(Function::Exp)
    }

    /// The angle of the point `(x, self)`, in `(−π, π]`.
    fn atan2(&self, x: &Self) -> Self {
        let zero = Self::from(0);
        if x > &zero {
            (self / x).function(BigFloat::atan)
        } else if self.abs() > x.abs() {
            let right_angle = Self::pi() / Self::from(2);
            let towards = (x / self).function(BigFloat::atan);
            if self > &zero { right_angle - towards } else { -right_angle - towards }
        } else {
            let angle = (self / x).function(BigFloat::atan);
            if self < &zero { angle - Self::pi() } else { angle + Self::pi() }
        }
    }
}

/// The operator on numbers and on references to them.
macro_rules! operator {
    ($($trait:ident $method:ident: $a:ident, $b:ident => $result:expr;)*) => {$(
        impl $trait<&Real> for &Real {
            type Output = Real;
            fn $method(self, other: &Real) -> Real {
                let ($a, $b) = (&self.0, &other.0);
                Real($result)
            }
        }
        impl $trait<Real> for &Real {
            type Output = Real;
            fn $method(self, other: Real) -> Real {
                $trait::$method(self, &other)
            }
        }
        impl $trait<&Real> for Real {
            type Output = Real;
            fn $method(self, other: &Real) -> Real {
                $trait::$method(&self, other)
            }
        }
        impl $trait<Real> for Real {
            type Output = Real;
            fn $method(self, other: Real) -> Real {
                $trait::$method(&self, &other)
            }
        }
    )*};
}

operator! {
    Add add: a, b => a.add(b, PRECISION, ROUNDING);
    Sub sub: a, b => a.sub(b, PRECISION, ROUNDING);
    Mul mul: a, b => a.mul(b, PRECISION, ROUNDING);
    Div div: a, b => a.div(b, PRECISION, ROUNDING);
}

impl Neg for Real {
    type Output = Real;
    fn neg(self) -> Real {
        -&self
    }
}

impl Neg for &Real {
    type Output = Real;
    fn neg(self) -> Real {
        Real(BigFloat::neg(&self.0))
    }
}

impl PartialEq for Real {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for Real {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.0.cmp(&other.0).map(|sign| sign.cmp(&0))
    }
}

impl fmt::Display for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = CONSTANTS
            .with(|constants| self.0.format(Radix::Dec, ROUNDING, &mut constants.borrow_mut()))
            .unwrap_or_else(|_| "NaN".to_owned());
        f.write_str(&text)
    }
}

impl fmt::Debug for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.to_f64())
    }
}
