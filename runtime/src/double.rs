//! Numbers of twice as many digits, as sums of two: compensated arithmetic.
//!
//! Sums and products of floating-point numbers differ from the exact ones by numbers that can be computed (Knuth, Dekker, Veltkamp): these
//! errors are carried along. T. J. Dekker, Numer. Math. 18 (1971) 224–242.

use crate::scalar::{Batch, FUSED, Mask, Real, Scalar, Work, functions, operators, stumpff};

/// `high + low`, where `low` is at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Double<T> {
    high: T,
    low: T,
}

impl<T: Batch> Double<T> {
    /// The number itself.
    #[inline(always)]
    pub(crate) fn exactly(high: T) -> Self {
        Self { high, low: T::of(0.0) }
    }

    /// Both parts: the nearest number, and what is left.
    #[inline(always)]
    pub(crate) fn parts(self) -> [T; 2] {
        [self.high, self.low]
    }

    /// From its parts.
    #[inline(always)]
    pub(crate) const fn from_parts([high, low]: [T; 2]) -> Self {
        Self { high, low }
    }

    /// `a + b`.
    #[inline(always)]
    fn sum(a: T, b: T) -> Self {
        let high = a + b;
        let part = high - a;
        Self { high, low: (a - (high - part)) + (b - part) }
    }

    /// `a + b` where `a` is the larger.
    #[inline(always)]
    fn ordered_sum(a: T, b: T) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }

    /// `a b`.
    #[inline(always)]
    fn product(a: T, b: T) -> Self {
        let high = a * b;
        if FUSED {
            return Self { high, low: Scalar::mul_add(a, b, -high) };
        }
        let ([a, c], [b, d]) = (Self::halves(a), Self::halves(b));
        Self { high, low: (((a * b - high) + a * d) + c * b) + c * d }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        let (high, low) = (Self::sum(self.high, other.high), Self::sum(self.low, other.low));
        let sum = Self::ordered_sum(high.high, high.low + low.high);
        Self::ordered_sum(sum.high, sum.low + low.low)
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        let Self { high, low } = Self::product(self.high, other.high);
        Self::ordered_sum(high, low + (self.high * other.low + self.low * other.high))
    }

    /// A number as the sum of two with half as many digits, so that their products are exact.
    #[inline(always)]
    fn halves(x: T) -> [T; 2] {
        let digits = if T::Number::IS_DOUBLE { 27 } else { 12 };
        let scaled = x * T::of(((1_u32 << digits) + 1).into());
        let high = scaled - (scaled - x);
        [high, x - high]
    }
}

/// Operations, each in a function of its own: in line they would make a step so long that it takes minutes to compile.
macro_rules! operations {
    ($($(#[$doc:meta])* $name:ident($($x:ident),*) -> $value:expr;)*) => {
        $($(#[$doc])*
        struct $name<'a, T>($(operations!(@number $x &'a Double<T>)),*);

        impl<T: Batch> Work for $name<'_, T> {
            type CallSite = ();
            type Result = Double<T>;

            #[inline(always)]
            fn done(self) -> Double<T> {
                let Self($(&$x),*) = self;
                $value
            }
        }

        impl<T: Batch> $name<'_, T> {
            #[inline(always)]
            fn of($($x: Double<T>),*) -> Double<T> {
                // no copies of many lanes: without optimisation each of them has its place on the stack
                if const { T::LANES > 1 } { T::dispatch($name($(&$x),*)) } else { Self::of_one($($x),*) }
            }

            /// Of one number: its arguments are in registers, where a work is in memory.
            #[inline(never)]
            fn of_one($($x: Double<T>),*) -> Double<T> {
                $name($(&$x),*).done()
            }
        })*
    };
    (@number $x:ident $t:ty) => { $t };
}
operations! {
    Sum(a, b) -> a.plus(b);
    Product(a, b) -> a.times(b);
    /// `a b + c`.
    MulAdd(a, b, c) -> c.plus(a.times(b));
    /// `−a b + c`.
    NegMulAdd(a, b, c) -> c.plus(-a.times(b));
    /// By long division: three digits.
    Quotient(a, b) -> {
        let first = a.high / b.high;
        let rest = a - b * Double::exactly(first);
        let second = rest.high / b.high;
        let rest = rest - b * Double::exactly(second);
        Double::ordered_sum(first, second) + Double::exactly(rest.high / b.high)
    };
}

operators! {
    Double<T: Batch>;
    -x = Self { high: -x.high, low: -x.low };
    Add add(a, b) = Sum::of(a, b);
    Sub sub(a, b) = Sum::of(a, -b);
    Mul mul(a, b) = Product::of(a, b);
    Div div(a, b) = Quotient::of(a, b);
}

/// Elementary functions have the digits of one number.
impl<T: Batch> Scalar for Double<T> {
    #[inline(always)]
    fn of(value: f64) -> Self {
        // in single precision there is something left
        let high = T::of(value);
        Self { high, low: T::of(value - high.lane(0).to_f64()) }
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        MulAdd::of(self, a, b)
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        NegMulAdd::of(self, a, b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.high.sqrt();
        let rest = self - Self::product(root, root);
        let better = Self::ordered_sum(root, rest.high / (root + root));
        // the root of zero is zero
        Self::select(T::of(0.0).lt(root), better, Self::exactly(root))
    }
    functions! {
        Self::exactly, high;
        exp() ln() sin() cos() tan() asin() acos() atan() sinh() cosh() tanh() powf(exponent) atan2(x)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.le(other), self, other)
    }
    #[inline(always)]
    fn if_negative(self, negative: Self, otherwise: Self) -> Self {
        Self::select(self.lt(Self::of(0.0)), negative, otherwise)
    }
    /// The constants of the series, and these beyond [`stumpff::LONG`], have the digits of one number. Where one formula takes over from
    /// another there is a gap of as many digits, in which an equation may have no solution to more: there is none at smaller angles.
    #[inline(always)]
    fn stumpff<const N: usize>(self) -> [Self; N] {
        if Batch::abs(self.high).lt(T::of(stumpff::LONG)).all() {
            return stumpff::long(self);
        }
        self.high.stumpff::<N>().map(Self::exactly)
    }
    #[inline(always)]
    fn recip_or_zero(self) -> Self {
        let zero = T::of(0.0);
        // zero for the same numbers: both are functions of the first half alone
        let is_zero = self.high.recip_or_zero().le(zero) & zero.le(self.high.recip_or_zero());
        Self::select(is_zero, Self::exactly(zero), Self::exactly(T::of(1.0)) / self)
    }
    #[inline(always)]
    fn angle_over_sine<const N: u32>(self) -> Self {
        Self::exactly(self.high.angle_over_sine::<N>())
    }
}

impl<T: Batch> crate::scalar::sealed::Sealed for Double<T> {}

impl<T: Batch> Batch for Double<T> {
    type Number = T::Number;
    type Mask = T::Mask;
    type Each<X: Copy + Send + Sync> = T::Each<X>;

    const LANES: usize = T::LANES;
    /// Half of the digits that are added: beyond, equations are solved for nothing.
    const EPSILON: f64 = if T::Number::IS_DOUBLE { 3.3e-24 } else { 4.1e-11 };
    const MIN_POSITIVE: f64 = T::MIN_POSITIVE / T::EPSILON;

    #[inline(always)]
    fn each<X: Copy + Send + Sync>(value: impl FnMut(usize) -> X) -> T::Each<X> {
        T::each(value)
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> T::Number {
        self.high.lane(lane)
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, number: T::Number) {
        self.high.set_lane(lane, number);
        self.low.set_lane(lane, T::Number::of(0.0));
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self::select(self.high.lt(T::of(0.0)), -self, self)
    }
    #[inline(always)]
    fn is_finite(self) -> T::Mask {
        self.high.is_finite() & self.low.is_finite()
    }
    #[inline(always)]
    fn is_same(self, other: Self) -> T::Mask {
        self.high.is_same(other.high) & self.low.is_same(other.low)
    }
    #[inline(always)]
    fn le(self, limit: Self) -> T::Mask {
        self.high.lt(limit.high) | (self.high.le(limit.high) & self.low.le(limit.low))
    }
    #[inline(always)]
    fn lt(self, limit: Self) -> T::Mask {
        self.high.lt(limit.high) | (self.high.le(limit.high) & self.low.lt(limit.low))
    }
    #[inline(always)]
    fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Self { high: T::select(mask, yes.high, no.high), low: T::select(mask, yes.low, no.low) }
    }
    /// The sum and the product have all digits that there are.
    #[inline(always)]
    fn fma(self, a: Self, b: Self) -> Self {
        self.mul_add(a, b)
    }
    #[inline(always)]
    fn dispatch<W: Work>(work: W) -> W::Result {
        T::dispatch(work)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type D = Double<f64>;

    /// Numbers whose digits are all of use, of several sizes.
    fn numbers() -> impl Iterator<Item = f64> {
        (1..40)
            .map(|k| f64::from(k).sqrt() * 2_f64.powi(7 * (k % 9) - 28) * if k % 3 == 0 { -1.0 } else { 1.0 })
    }

    fn pairs() -> impl Iterator<Item = (D, D)> {
        let wide = |x: f64, y: f64| D::exactly(x) + D::exactly(y * 2_f64.powi(-60));
        numbers().flat_map(move |x| numbers().map(move |y| (wide(x, y), wide(y, x))))
    }

    /// The size of `x` in units of `of`.
    fn relative(x: D, of: D) -> f64 {
        (x.high / of.high).abs()
    }

    #[test]
    fn sums_and_products_of_numbers_are_exact() {
        for (x, y) in numbers().flat_map(|x| numbers().map(move |y| (x, y))) {
            // exact in integers: 53 bits each, and what one number cannot hold
            let (a, b) = ((x * 2_f64.powi(40)) as i64 >> 11, (y * 2_f64.powi(40)) as i64 >> 11);
            let product = D::product(a as f64, b as f64);
            assert_eq!(product.high as i128 + product.low as i128, i128::from(a) * i128::from(b));
            let sum = D::sum(x, y);
            assert_eq!(sum.high, x + y);
            // exact where one is not much larger than the other
            let exact = ((x * 2_f64.powi(80)) as i128) + ((y * 2_f64.powi(80)) as i128);
            let found = (sum.high * 2_f64.powi(80)) as i128 + (sum.low * 2_f64.powi(80)) as i128;
            assert_eq!(found, exact, "{x} + {y}");
        }
    }

    #[test]
    fn operations_undo_one_another() {
        let error = 2_f64.powi(-100);
        for (x, y) in pairs() {
            let larger = if relative(x, y) > 1.0 { x } else { y };
            assert!(relative((x + y) - y - x, larger) < error);
            assert!(relative(x / y * y - x, x) < error);
            assert!(relative(x * y / y - x, x) < error);
            let root = Batch::abs(x).sqrt();
            assert!(relative(root * root - Batch::abs(x), x) < error);
            assert_eq!((x - x, -x + x), (D::exactly(0.0), D::exactly(0.0)));
        }
        assert_eq!(D::exactly(0.0).sqrt(), D::exactly(0.0));
    }

    #[test]
    fn it_is_the_order_of_both_parts() {
        for (x, y) in pairs() {
            assert_eq!(x.lt(y), (x - y).high < 0.0);
            assert_eq!(x.le(y), (x - y).high <= 0.0);
            let above = x + D::exactly(x.high.abs() * 2_f64.powi(-100));
            assert!(x.lt(above) && !above.le(x) && x.le(x) && !x.lt(x));
            assert_eq!(Scalar::min(x, above), x);
        }
    }

    #[test]
    fn stumpff_functions_are_those_of_the_angle() {
        for k in 1..30 {
            let x = D::of(f64::from(k)) / D::of(100.0);
            let [c0, c1] = (x * x).stumpff();
            // but for the digits of the constants, and where the series are cut off
            let one = c0 * c0 + x * x * c1 * c1;
            assert!(relative(one - D::of(1.0), one) < 1e-17, "{k}: {one:?}");
            assert!((c1.high - x.high.sin() / x.high).abs() < 2e-16, "{k}");
        }
    }

    #[test]
    fn single_precision_doubles_too() {
        type S = Double<f32>;
        let third = S::of(1.0) / S::of(3.0);
        let value = f64::from(third.high) + f64::from(third.low);
        assert!((value * 3.0 - 1.0).abs() < 1e-14, "{value}");
        assert_eq!(
            f64::from(S::of(0.1).high) + f64::from(S::of(0.1).low),
            f64::from(0.1_f32) + f64::from((0.1 - f64::from(0.1_f32)) as f32)
        );
    }
}
