//! Numbers of 71 digits, to hold closed forms against their definitions.

use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::LazyLock;

use coadjoint_codegen::expr::{Function, Number};

use crate::evaluate::Value;
use f256::f256;

use crate::random::Random;

/// `1/n!`
static INVERSE_FACTORIALS: LazyLock<Vec<Real>> = LazyLock::new(|| {
    (1..400)
        .scan(Real::from(1), |inverse, n| Some(std::mem::replace(inverse, &*inverse / Real::from(n))))
        .collect()
});

/// A real number, rounded to the 237 bits of IEEE's octuple precision; `2^−237 ≈ 5e-72`.
#[derive(Clone, PartialEq, PartialOrd)]
pub struct Real(f256);

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
        Self(self.0.sqrt())
    }

    /// `1/n!`, for power series.
    pub fn inverse_factorial(n: usize) -> Self {
        INVERSE_FACTORIALS[n].clone()
    }

    /// Whether it is zero.
    pub fn is_zero(&self) -> bool {
        self.0.eq_zero()
    }

    /// Neither infinite nor not a number.
    pub fn is_finite(&self) -> bool {
        self.0.is_finite()
    }

    /// Whether adding it to something of order one changes nothing.
    pub fn is_negligible(&self) -> bool {
        self.0.abs() < f256::EPSILON.div_pow2(32)
    }

    /// The nearest double, or almost.
    pub fn to_f64(&self) -> f64 {
        if !self.is_finite() {
            return self.to_string().parse().unwrap_or(f64::NAN);
        }
        let (sign, exponent, (high, low)) = self.0.as_sign_exp_signif();
        let size = high as f64 * 2_f64.powi(128) + low as f64;
        // in two steps, for the power alone may be too small
        let size = size * 2_f64.powi(exponent / 2) * 2_f64.powi(exponent - exponent / 2);
        if sign == 0 { size } else { -size }
    }

    /// `c_k(self) = Σ_j (−self)^j / (k + 2j)!`, the definition.
    fn stumpff(&self, k: usize) -> Self {
        let mut power = Self::from(1);
        let mut total = Self::from(0);
        for j in 0.. {
            let term = &power * Self::inverse_factorial(k + 2 * j);
            if term.is_negligible() {
                return total;
            }
            total = total + term;
            power = -(power * self);
        }
        total
    }

    /// `dᵏ/dcᵏ acos(c)/√(1 − c²)` at `c = self`. With `(1 − c²) a' = c a − 1`, the power series in `c − 1` where that
    /// converges well, and what follows from the equation differentiated elsewhere.
    fn angle_over_sine(&self, k: u32) -> Self {
        let one = Self::from(1);
        let mut total = Self::from(0);
        if *self < Self::from(0) {
            let below = &one - self * self;
            let (mut last, mut now) = (-&one, self.apply(Function::Acos) / below.sqrt());
            for n in (0..k).map(i64::from) {
                let next = (Self::from(2 * n + 1) * self * &now + Self::from((n * n).max(1)) * last) / &below;
                (last, now) = (now, next);
            }
            return now;
        }
        // Σ a_n n(n − 1) … (n − k + 1) xⁿ⁻ᵏ with −(2n + 3) a_{n+1} = (n + 1) a_n
        let (x, k) = (self - &one, i64::from(k));
        let (mut coefficient, mut power) = (one.clone(), one);
        for n in 0_i64.. {
            if n >= k {
                let falling = (0..k).fold(Self::from(1), |product, j| product * Self::from(n - j));
                let term = &coefficient * &power * falling;
                total = total + &term;
                if term.is_negligible() && n > k {
                    break;
                }
                power = power * &x;
            }
            coefficient = -(coefficient * Self::ratio(n + 1, 2 * n + 3));
        }
        total
    }

    /// `Σ x^(2j + 1) / (2j + 1)!` where exponentials cancel, else from these.
    fn sinh(&self) -> Self {
        if self.abs() < Self::from(1) {
            return self * (-(self * self)).stumpff(1);
        }
        Self((self.0.exp() - (-self.0).exp()).div2())
    }

    fn cosh(&self) -> Self {
        Self((self.0.exp() + (-self.0).exp()).div2())
    }
}

impl From<f64> for Real {
    /// Exactly the double.
    fn from(x: f64) -> Self {
        Self(f256::from(x))
    }
}

impl From<i64> for Real {
    fn from(n: i64) -> Self {
        Self(f256::from(n))
    }
}

impl Value for Real {
    fn number(number: Number) -> Self {
        let integer = |n: i128| Self(f256::from(n));
        match number.fraction() {
            Some((numerator, 1)) => integer(numerator),
            // exact, and much faster than a division
            Some((numerator, denominator)) if denominator.is_positive() && denominator.count_ones() == 1 => {
                Self(f256::from(numerator).div_pow2(denominator.trailing_zeros()))
            }
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
        let x = self.0;
        // nearly all of them, much faster than in general
        Self(match exponent {
            2 => x * x,
            3 => x * x * x,
            4 => (x * x) * (x * x),
            -1 => f256::ONE / x,
            -2 => f256::ONE / (x * x),
            _ => x.powi(exponent),
        })
    }

    fn apply(&self, function: Function) -> Self {
        let x = &self.0;
        Self(match function {
            Function::Sqrt => x.sqrt(),
            Function::Exp => x.exp(),
            Function::Ln => x.ln(),
            Function::Sin => x.sin(),
            Function::Cos => x.cos(),
            Function::Tan => x.tan(),
            Function::Asin => x.asin(),
            Function::Acos => x.acos(),
            Function::Atan => x.atan(),
            Function::Sinh => return self.sinh(),
            Function::Cosh => return self.cosh(),
            Function::Tanh => return self.sinh() / self.cosh(),
            Function::Stumpff(k) => return self.stumpff(k as usize),
            Function::RecipOrZero if self.is_zero() => f256::ZERO,
            Function::RecipOrZero => f256::ONE / x,
            Function::AngleOverSine(k) => return self.angle_over_sine(k),
        })
    }

    fn power(&self, exponent: &Self) -> Self {
        Self(self.0.powf(&exponent.0))
    }

    /// The angle of the point `(x, self)`, in `(−π, π]`.
    fn atan2(&self, x: &Self) -> Self {
        Self(self.0.atan2(&x.0))
    }

    fn choose(&self, negative: &Self, otherwise: &Self) -> Self {
        if self.0 < f256::ZERO { negative } else { otherwise }.clone()
    }
}

/// The operator on numbers and on references to them.
macro_rules! operator {
    ($($trait:ident $method:ident: $a:ident, $b:ident => $result:expr;)*) => {$(
        impl $trait<&Real> for &Real {
            type Output = Real;
            fn $method(self, other: &Real) -> Real {
                let ($a, $b) = (self.0, other.0);
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
    Add add: a, b => a + b;
    Sub sub: a, b => a - b;
    Mul mul: a, b => a * b;
    Div div: a, b => a / b;
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
        Real(-self.0)
    }
}

impl fmt::Display for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Debug for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.to_f64())
    }
}
