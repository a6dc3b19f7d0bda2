//! Numbers: the scalars that generated code is generic over, several of them side by side, and arrays of them.

use core::fmt::Debug;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use nalgebra::RealField;

pub(crate) mod blocks;
pub(crate) mod bounded;
mod components;
#[cfg(feature = "std")]
pub(crate) mod instructions;
pub(crate) mod rows;
pub(crate) mod simd;
pub(crate) mod stumpff;
pub(crate) mod zero;

pub use components::Components;
pub(crate) use components::mapped;
use simd::lanes::{Portable, Processor};

/// Whether the program is built for processors that multiply and add in one instruction, with one rounding, as by
/// `-C target-cpu=native` on most. Not looked for at run time: what a program computes does not depend on the machine that it runs on.
///
/// Never without `std`, where nalgebra does it in software.
pub(crate) const FUSED: bool =
    cfg!(all(feature = "std", any(target_feature = "fma", target_arch = "aarch64")));

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
    + Send
    + Sync
    + 'static
{
    /// The scalar nearest to `value`.
    fn of(value: f64) -> Self;
    /// `self · a + b`, rounded once if the program is built for processors with an instruction for it, else twice.
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        b + self * a
    }
    /// `−self · a + b`, rounded likewise.
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        b - self * a
    }
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
    /// `negative` where `self` is below zero, `otherwise` elsewhere. What is not taken has no part in the result.
    fn if_negative(self, negative: Self, otherwise: Self) -> Self;
    /// The Stumpff functions `c_0(self), …, c_{N−1}(self)`.
    fn stumpff<const N: usize>(self) -> [Self; N];
    /// `1/self`; 0 where `self` is 0, or below the root of the least normal number.
    fn recip_or_zero(self) -> Self;
    /// The `N`th derivative of `θ / sin θ` with respect to `cos θ`, at `cos θ = self`.
    fn angle_over_sine<const N: u32>(self) -> Self;
}

/// The operators of a kind of numbers.
macro_rules! operators {
    ($number:ident<$t:ident: $bound:ident>; -$x:ident = $negative:expr; $($trait:ident $name:ident($a:ident, $b:ident) = $value:expr;)*) => {
        impl<$t: $bound> core::ops::Neg for $number<$t> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                let $x = self;
                $negative
            }
        }

        $(impl<$t: $bound> core::ops::$trait for $number<$t> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, $b: Self) -> Self {
                let $a = self;
                $value
            }
        })*
    };
}
pub(crate) use operators;

/// Functions of numbers that are made of others, by those of one part.
#[cfg(feature = "std")]
macro_rules! functions {
    ($make:expr, $part:tt; $($name:ident($($operand:ident),*))*) => {
        $(#[inline(always)]
        fn $name(self $(, $operand: Self)*) -> Self {
            $make(Scalar::$name(self.$part $(, $operand.$part)*))
        })*
    };
}
#[cfg(feature = "std")]
pub(crate) use functions;

macro_rules! delegate {
    ($($field:ident: $($name:ident($($operand:ident),*))*;)*) => {
        $($(#[inline(always)]
        fn $name(self $(, $operand: Self)*) -> Self {
            nalgebra::$field::$name(self $(, $operand)*)
        })*)*
    };
}

impl<T: RealField + Copy> Scalar for T {
    #[inline(always)]
    fn of(value: f64) -> Self {
        nalgebra::convert(value)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        if FUSED { nalgebra::ComplexField::mul_add(self, a, b) } else { b + self * a }
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        if FUSED { nalgebra::ComplexField::mul_add(self, -a, b) } else { b - self * a }
    }
    delegate! {
        ComplexField: sqrt() exp() ln() sin() cos() tan() asin() acos() atan() sinh() cosh() tanh() powf(exponent);
        RealField: atan2(x) min(other);
    }
    #[inline(always)]
    fn if_negative(self, negative: Self, otherwise: Self) -> Self {
        if self < T::zero() { negative } else { otherwise }
    }
    #[inline(always)]
    fn stumpff<const N: usize>(self) -> [Self; N] {
        stumpff::family(self)
    }
    #[inline(always)]
    fn recip_or_zero(self) -> Self {
        zero::recip_or_zero(self)
    }
    #[inline]
    fn angle_over_sine<const N: u32>(self) -> Self {
        zero::angle_over_sine(self, N)
    }
}

/// Numbers that steps are taken with: one, or several side by side, each of which goes its own way.
///
/// What holds for some of them and not for others is a mask, and both ways are then computed and one [selected](Self::select): no
/// lane's result depends on what is in another.
///
/// Sealed: code that is not checked relies on what these numbers say of themselves.
pub trait Batch: Scalar + sealed::Sealed {
    /// The number in one lane: `f64` or `f32`.
    type Number: Real;
    /// A truth for each lane.
    type Mask: Mask;
    /// Anything for each lane.
    type Each<X: Copy + Send + Sync>: Copy + AsRef<[X]> + AsMut<[X]> + Send + Sync;

    /// How many lanes there are.
    const LANES: usize;
    /// The distance from 1 to the next larger number.
    const EPSILON: f64;
    /// The least number of full precision that is larger than zero.
    const MIN_POSITIVE: f64;

    /// The same for each lane.
    #[inline(always)]
    fn all<X: Copy + Send + Sync>(value: X) -> Self::Each<X> {
        Self::each(|_| value)
    }
    /// What `value` gives for each lane.
    fn each<X: Copy + Send + Sync>(value: impl FnMut(usize) -> X) -> Self::Each<X>;
    /// The number in a lane.
    fn lane(&self, lane: usize) -> Self::Number;
    /// Puts a number into a lane.
    fn set_lane(&mut self, lane: usize, number: Self::Number);
    /// Puts numbers into a lane of as many.
    fn put<X: Real>(all: &mut [Self], lane: usize, one: &[X]) {
        for (numbers, number) in all.iter_mut().zip(one) {
            numbers.set_lane(lane, Self::Number::of(number.to_f64()));
        }
    }
    /// The absolute values.
    fn abs(self) -> Self;
    /// Neither infinite nor not-a-number.
    fn is_finite(self) -> Self::Mask;
    /// Whether the numbers are the same, bit for bit.
    fn is_same(self, other: Self) -> Self::Mask;
    /// `self ≤ limit`; not so if one of them is not a number.
    fn le(self, limit: Self) -> Self::Mask;
    /// `self < limit`; not so if one of them is not a number.
    fn lt(self, limit: Self) -> Self::Mask;
    /// `yes` where the mask is true, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Whether it is one double, of which any processor adds and multiplies two at a time.
    const PAIRS: bool = false;
    /// Whether [`mul_add`](Scalar::mul_add) is [`fma`](Self::fma).
    const IS_FUSED: bool = FUSED;
    /// Whether what computes with these numbers is compiled for a processor with an instruction for [`fma`](Self::fma) already.
    const HAS_FMA: bool = false;
    /// `self · a + b`, rounded once.
    fn fma(self, a: Self, b: Self) -> Self;
    /// Does the work in a function of its own, compiled for what these numbers need of the processor: for what comes rarely, and for what
    /// is compiled once for several callers.
    fn dispatch<W: Work>(work: W) -> W::Result;
    /// The same, compiled for what [`fma`](Self::fma) needs too, as far as the processor has it.
    #[inline(always)]
    fn dispatch_fused<W: Work>(work: W) -> W::Result {
        Self::dispatch(work)
    }
    /// The same for work that is done for long, compiled for the best processor that there is.
    #[inline(always)]
    fn dispatch_wide<W: LongWork>(work: W) -> W::Result {
        Self::dispatch(On::<Portable, W>::new(work))
    }
}

/// Something to do, with all that it needs. Not a closure, since these cannot say that they are always to be inlined.
pub trait Work {
    /// The type with which it is compiled when it is out of line: a kernel, or `()` for what belongs to none.
    type CallSite: 'static;
    /// What comes of it.
    type Result;
    /// Does it. To be `#[inline(always)]`: the code is compiled for the processor that its caller is compiled for.
    fn done(self) -> Self::Result;
}

/// Functions that are not inlined, provided for all types. The compiler puts a provided method where its `Self` is: work of a kernel is compiled
/// beside that, and what belongs to other systems is not compiled anew when it changes.
pub(crate) trait OutOfLine: Sized + 'static {
    /// Does the work, compiled for what the program is built for.
    #[inline(never)]
    fn portable<W: Work<CallSite = Self>>(work: W) -> W::Result {
        work.done()
    }
}

impl<CallSite: 'static> OutOfLine for CallSite {}

/// Something to do that knows the processor that it is compiled for.
pub trait LongWork {
    /// As [`Work::CallSite`].
    type CallSite: 'static;
    /// What comes of it.
    type Result;
    /// Does it, as [`Work::done`].
    fn done<P: Processor>(self) -> Self::Result;
}

/// [`LongWork`] on one processor.
pub(crate) struct On<P, W>(W, core::marker::PhantomData<P>);

impl<P, W> On<P, W> {
    #[inline(always)]
    pub(crate) fn new(work: W) -> Self {
        Self(work, core::marker::PhantomData)
    }
}

impl<P: Processor, W: LongWork> Work for On<P, W> {
    type CallSite = W::CallSite;
    type Result = W::Result;

    #[inline(always)]
    fn done(self) -> W::Result {
        self.0.done::<P>()
    }
}

/// A truth for each lane of a [`Batch`].
pub trait Mask:
    Copy + Debug + Send + Sync + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// The same for all lanes.
    fn splat(value: bool) -> Self;
    /// Whether it is true of all lanes.
    fn all(self) -> bool;
    /// Whether it is true of any lane.
    fn any(self) -> bool;
    /// Whether it is true of one lane.
    fn lane(self, lane: usize) -> bool;
}

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn lane(self, _: usize) -> bool {
        self
    }
}

/// One real number: `f64` or `f32`, and no other type.
pub trait Real: Batch<Number = Self, Mask = bool> + PartialOrd {
    /// Whether it is `f64`.
    const IS_DOUBLE: bool;
    /// The nearest `f64`.
    fn to_f64(self) -> f64;
}

macro_rules! real {
    ($($t:ident),*) => {
        $(impl sealed::Sealed for $t {}

        impl Real for $t {
            const IS_DOUBLE: bool = size_of::<$t>() == size_of::<f64>();

            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }
        }

        impl Batch for $t {
            type Number = Self;
            type Mask = bool;
            type Each<X: Copy + Send + Sync> = [X; 1];

            const LANES: usize = 1;
            const EPSILON: f64 = $t::EPSILON as f64;
            const MIN_POSITIVE: f64 = $t::MIN_POSITIVE as f64;
            const PAIRS: bool = Self::IS_DOUBLE;

            #[inline(always)]
            fn each<X: Copy + Send + Sync>(mut value: impl FnMut(usize) -> X) -> [X; 1] {
                [value(0)]
            }
            #[inline(always)]
            fn lane(&self, _: usize) -> Self {
                *self
            }
            #[inline(always)]
            fn set_lane(&mut self, _: usize, number: Self) {
                *self = number;
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $t::is_finite(self)
            }
            #[inline(always)]
            fn is_same(self, other: Self) -> bool {
                self.to_bits() == other.to_bits()
            }
            #[inline(always)]
            fn le(self, limit: Self) -> bool {
                self <= limit
            }
            #[inline(always)]
            fn lt(self, limit: Self) -> bool {
                self < limit
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
            #[inline(always)]
            fn fma(self, a: Self, b: Self) -> Self {
                nalgebra::ComplexField::mul_add(self, a, b)
            }
            #[inline(always)]
            fn dispatch<W: Work>(work: W) -> W::Result {
                W::CallSite::portable(work)
            }
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            #[inline(always)]
            fn dispatch_fused<W: Work>(work: W) -> W::Result {
                simd::processor::dispatch_fused(work)
            }
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            #[inline(always)]
            fn dispatch_wide<W: LongWork>(work: W) -> W::Result {
                simd::processor::dispatch_wide(work)
            }
        })*
    };
}
real!(f64, f32);

pub(crate) mod sealed {
    /// Numbers of this crate.
    pub trait Sealed {}
}
