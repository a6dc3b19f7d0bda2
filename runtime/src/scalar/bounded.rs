//! Numbers that carry a bound of what rounding has left in them: running error analysis.
//!
//! Each operation adds half a unit in the last place of its result, and hands on what its operands carry, by its derivatives. N. J. Higham,
//! *Accuracy and Stability of Numerical Algorithms*, 2nd ed., section 3.3. However terms cancel, the bound is that of the terms.

use crate::scalar::{Real, Scalar, operators};

/// A number, and a bound of its error in units of epsilon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounded<T> {
    pub(crate) value: T,
    pub(crate) error: T,
}

/// What an elementary function of the operating system or of nalgebra is off by, in units of epsilon of its result.
const FUNCTION: f64 = 1.0;
/// What a Stumpff function is off by: the table in [`stumpff`](super::stumpff).
const STUMPFF: f64 = 4.2;

impl<T: Real> Bounded<T> {
    /// The number itself.
    #[inline]
    pub(crate) fn exactly(value: T) -> Self {
        Self { value, error: T::of(0.0) }
    }

    /// The number, as the nearest to one that is sought.
    #[inline]
    pub(crate) fn nearest(value: T) -> Self {
        Self { value, error: T::of(0.5) * value.abs() }
    }

    /// The result of an operation, with the error that its operands bring.
    #[inline]
    fn rounded(value: T, brought: T) -> Self {
        Self { value, error: brought + T::of(0.5) * value.abs() }
    }

    /// What is certain of the magnitude: to divide by it. Where that is nothing, a bound to first order would say nothing.
    #[inline]
    fn certain(self) -> T {
        let certain = self.value.abs() - T::of(T::EPSILON) * self.error;
        if certain > T::of(0.0) { certain } else { T::of(0.0) }
    }

    /// The value of a function with this derivative here.
    #[inline]
    fn function(self, value: T, derivative: T) -> Self {
        let brought = if self.error > T::of(0.0) { derivative.abs() * self.error } else { T::of(0.0) };
        Self { value, error: brought + T::of(FUNCTION) * value.abs() }
    }
}

operators! {
    Bounded<T: Real>;
    -x = Self { value: -x.value, ..x };
    Add add(a, b) = Self::rounded(a.value + b.value, a.error + b.error);
    Sub sub(a, b) = Self::rounded(a.value - b.value, a.error + b.error);
    Mul mul(a, b) = Self::rounded(a.value * b.value, a.value.abs() * b.error + b.value.abs() * a.error);
    Div div(a, b) = {
        let value = a.value / b.value;
        let brought = a.error + value.abs() * b.error;
        Self::rounded(value, if brought > T::of(0.0) { brought / b.certain() } else { brought })
    };
}

/// Functions of one number, by their derivatives.
macro_rules! functions {
    ($($name:ident: |$x:pat_param, $value:pat_param| $derivative:expr;)*) => {
        $(#[inline]
        fn $name(self) -> Self {
            let value = self.value.$name();
            let ($x, $value) = (self, value);
            self.function(value, $derivative)
        })*
    };
}

impl<T: Real> Scalar for Bounded<T> {
    /// Constants are those that the step has, and no approximations.
    #[inline]
    fn of(value: f64) -> Self {
        Self::exactly(T::of(value))
    }
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        // correctly rounded; near zero the derivative says nothing
        let brought = if self.error > T::of(0.0) {
            let slope = self.error / (root + root);
            let most = self.error.sqrt() / T::of(T::EPSILON).sqrt();
            if slope < most { slope } else { most }
        } else {
            T::of(0.0)
        };
        Self::rounded(root, brought)
    }
    functions! {
        exp: |_, value| value;
        ln: |x, _| T::of(1.0) / x.certain();
        sin: |x, _| x.value.cos();
        cos: |x, _| x.value.sin();
        tan: |_, value| T::of(1.0) + value * value;
        asin: |x, _| T::of(1.0) / (T::of(1.0) - x.value * x.value).sqrt();
        acos: |x, _| T::of(1.0) / (T::of(1.0) - x.value * x.value).sqrt();
        atan: |x, _| T::of(1.0) / (T::of(1.0) + x.value * x.value);
        sinh: |x, _| x.value.cosh();
        cosh: |x, _| x.value.sinh();
        tanh: |_, value| T::of(1.0) - value * value;
    }
    #[inline]
    fn powf(self, exponent: Self) -> Self {
        let value = self.value.powf(exponent.value);
        let of_base = self.function(value, exponent.value * value / self.value);
        let of_exponent = exponent.function(value, value * self.value.ln());
        Self { value, error: of_base.error + of_exponent.error }
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let value = self.value.atan2(x.value);
        let square = x.value * x.value + self.value * self.value;
        let brought = (self.value.abs() * x.error + x.value.abs() * self.error) / square;
        Self { value, error: brought + T::of(FUNCTION) * value.abs() }
    }
    #[inline]
    fn min(self, other: Self) -> Self {
        if self.value <= other.value { self } else { other }
    }
    /// Where rounding may have decided, the other value was as likely.
    #[inline]
    fn if_negative(self, negative: Self, otherwise: Self) -> Self {
        let taken = self.value.if_negative(negative.value, otherwise.value);
        if self.error == T::of(0.0) || self.certain() > T::of(0.0) {
            return Self { value: taken, error: self.value.if_negative(negative.error, otherwise.error) };
        }
        let apart = (negative.value - otherwise.value).abs() / T::of(T::EPSILON);
        let most = if negative.error < otherwise.error { otherwise.error } else { negative.error };
        Self { value: taken, error: apart + most }
    }
    #[inline]
    fn recip_or_zero(self) -> Self {
        let value = self.value.recip_or_zero();
        Self::rounded(value, value * value * self.error)
    }
    /// By its derivative; in the distance from its edge at −1 by recurrence, which loses what it divides by.
    #[inline]
    fn angle_over_sine<const N: u32>(self) -> Self {
        let value = self.value.angle_over_sine::<N>();
        let distance = T::of(1.0) + self.value;
        let slope = T::of(f64::from(N + 1)) * value / distance;
        let brought = if self.error > T::of(0.0) { slope.abs() * self.error } else { T::of(0.0) };
        Self { value, error: brought + T::of(STUMPFF) * value.abs() / distance.abs() }
    }
    /// `|c_k′| ≤ ½ max(|c_k|, 1/k!)`; near its zeros `c_0` is off by units of one.
    #[inline]
    fn stumpff<const N: usize>(self) -> [Self; N] {
        let mut factorial = 1.0;
        let mut k = 0.0;
        self.value.stumpff::<N>().map(|value| {
            let most = Scalar::min(-value.abs(), T::of(-1.0 / factorial)).abs();
            k += 1.0;
            factorial *= k;
            Self { value, error: T::of(0.5) * most * self.error + T::of(STUMPFF) * most }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type B = Bounded<f64>;

    #[test]
    fn what_cancels_keeps_the_error_of_its_terms() {
        let (a, b) = (B::exactly(1.0) / B::exactly(3.0), B::exactly(1.0 / 3.0));
        let difference = (a * B::exactly(3e10) - B::exactly(1e10)) + b;
        // half a unit of the quotient, times what it is multiplied by, and of the product: that both differences add is small
        let expected = 2.0 * 0.5 * 1e10;
        assert!((difference.error / expected - 1.0).abs() < 1e-6, "{difference:?}");
    }

    #[test]
    fn a_choice_that_rounding_may_have_made_counts_with_the_other_value() {
        let third = B::exactly(1.0) / B::exactly(3.0);
        let (one, other) = (B::exactly(2.0), B::exactly(5.0));
        assert_eq!((-third).if_negative(one, other), one);
        assert_eq!(B::exactly(0.0).if_negative(one, other), other);
        assert_eq!(third.if_negative(B::exactly(f64::NAN), other), other);
        // what is left of a third may be on either side of zero
        let rest = third - B::exactly(1.0 / 3.0);
        assert_eq!(rest.if_negative(one, other), B { value: 5.0, error: 3.0 / f64::EPSILON });
    }

    #[test]
    fn operations_in_twice_the_digits_stay_within() {
        use crate::double::Double;
        let wide = |x: f64| Double::exactly(x);
        let mut worst = 0.0_f64;
        for i in 1..200 {
            let (x, y) = (f64::from(i).sqrt() * 0.013, f64::from(i * 7 % 201).cbrt() - 2.5);
            // terms that cancel, quotients and roots of what has cancelled
            let of =
                |x: B, y: B| (x * y - x / (y * y + B::of(1.0))).sqrt() * (x - y) + (x * x + y * y).sqrt() - y;
            let exact = {
                let (x, y) = (wide(x), wide(y));
                (x * y - x / (y * y + Double::of(1.0))).sqrt() * (x - y) + (x * x + y * y).sqrt() - y
            };
            let found = of(B::exactly(x), B::exactly(y));
            let off = (wide(found.value) - exact).parts()[0].abs();
            if off.is_nan() {
                continue;
            }
            let ratio = off / (f64::EPSILON * found.error);
            assert!(ratio <= 1.0, "{x} {y}: {off:e} of {:e}", f64::EPSILON * found.error);
            worst = worst.max(ratio);
        }
        assert!(worst > 0.1, "nor is it much too wide: {worst}");
    }
}
