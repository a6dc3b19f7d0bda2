//! The scalars that generated code is generic over.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};
use nalgebra::RealField;

/// What straight-line code needs of a number: `f64`, `f32`, and anything that is a Copy
/// [`RealField`] (dual numbers for one).
pub trait Scalar:
    Copy
    + PartialEq
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The scalar nearest to `value`.
    fn of(value: f64) -> Self;
    /// `√self`.
    fn sqrt(self) -> Self;
    /// `e^self`.
    fn exp(self) -> Self;
    /// The natural logarithm.
    fn ln(self) -> Self;
    /// The sine.
    fn sin(self) -> Self;
    /// The cosine.
    fn cos(self) -> Self;
    /// The tangent.
    fn tan(self) -> Self;
    /// The arc sine.
    fn asin(self) -> Self;
    /// The arc cosine.
    fn acos(self) -> Self;
    /// The arc tangent.
    fn atan(self) -> Self;
    /// The hyperbolic sine.
    fn sinh(self) -> Self;
    /// The hyperbolic cosine.
    fn cosh(self) -> Self;
    /// The hyperbolic tangent.
    fn tanh(self) -> Self;
    /// `self^exponent`.
    fn powf(self, exponent: Self) -> Self;
    /// The angle of the point `(x, self)`.
    fn atan2(self, x: Self) -> Self;
    /// The lesser of two numbers.
    fn min(self, other: Self) -> Self;
    /// The Stumpff functions `c_0(self), …, c_{N−1}(self)`: see [`stumpff`](crate::stumpff).
    fn stumpff<const N: usize>(self) -> [Self; N];
}

macro_rules! delegate {
    ($($name:ident),*) => {
        $(#[inline(always)]
        fn $name(self) -> Self {
            nalgebra::ComplexField::$name(self)
        })*
    };
}

impl<T: RealField + Copy> Scalar for T {
    #[inline(always)]
    fn of(value: f64) -> Self {
        nalgebra::convert(value)
    }
    delegate!(sqrt, exp, ln, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh);
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        nalgebra::ComplexField::powf(self, exponent)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        RealField::atan2(self, x)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        RealField::min(self, other)
    }
    #[inline(always)]
    fn stumpff<const N: usize>(self) -> [Self; N] {
        crate::stumpff::family(self)
    }
}

/// A [`Scalar`] with an order, for the decisions of Newton's iteration: `f64` or `f32`.
pub trait Real: Scalar + PartialOrd {
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// The nearest `f64`.
    fn to_f64(self) -> f64;
    /// Neither infinite nor not-a-number.
    fn is_finite(self) -> bool;
    /// The absolute value.
    fn abs(self) -> Self;
}

macro_rules! real {
    ($($t:ident),*) => {
        $(impl Real for $t {
            const EPSILON: Self = $t::EPSILON;
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $t::is_finite(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }
        })*
    };
}
real!(f64, f32);
