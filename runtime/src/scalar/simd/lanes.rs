//! Several numbers side by side, computed together.
//!
//! Every operation works on each lane by itself, in the same way as it would on the lane's number alone: what comes out is the same, bit for
//! bit. On a processor with wide registers the compiler makes one instruction of all of them.

use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

#[cfg(not(all(feature = "std", target_arch = "x86_64")))]
use crate::scalar::OutOfLine;
use crate::scalar::{Batch, Mask, Real, Scalar, Work, stumpff, zero};

/// `N` numbers side by side, for code that is compiled for `P`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes<X, const N: usize, P: Processor>([X; N], P::Alignment);

/// A kind of processor, with instructions on registers of doubles.
pub trait Processor: Copy + PartialEq + core::fmt::Debug + Send + Sync + 'static {
    /// Something without size that is aligned as the processor's registers are wide.
    type Alignment: Copy + PartialEq + core::fmt::Debug + Send + Sync + 'static;
    /// The one there is.
    const ALIGNMENT: Self::Alignment;
    /// How many doubles there are in a register; 0 if there are no instructions to be named.
    const DOUBLES: usize;
    /// Whether there are instructions for four doubles, too, and for [`fma`](Self::fma).
    const FOURS: bool = false;

    /// Does the work in a function of its own, compiled for this kind.
    fn dispatch<W: Work>(work: W) -> W::Result;
    /// `a + b`
    fn add<X: Real, const N: usize>(a: &[X; N], b: &[X; N]) -> [X; N];
    /// `a − b`
    fn sub<X: Real, const N: usize>(a: &[X; N], b: &[X; N]) -> [X; N];
    /// `a b`
    fn mul<X: Real, const N: usize>(a: &[X; N], b: &[X; N]) -> [X; N];
    /// `a b + c`, as [`Scalar::mul_add`].
    fn mul_add<X: Real, const N: usize>(a: &[X; N], b: &[X; N], c: &[X; N]) -> [X; N];
    /// `−a b + c`, as [`Scalar::neg_mul_add`].
    fn neg_mul_add<X: Real, const N: usize>(a: &[X; N], b: &[X; N], c: &[X; N]) -> [X; N];
    /// Whether there is an instruction for [`fma`](Self::fma).
    const FUSES: bool;
    /// `a b + c`, rounded once, if there [is](Self::FUSES) an instruction for it.
    fn fma<X: Real, const N: usize>(a: &[X; N], b: &[X; N], c: &[X; N]) -> [X; N];
    /// `a / b`
    fn div<X: Real, const N: usize>(a: &[X; N], b: &[X; N]) -> [X; N];
    /// `−a`
    fn neg<X: Real, const N: usize>(a: &[X; N]) -> [X; N];
    /// `|a|`
    fn abs<X: Real, const N: usize>(a: &[X; N]) -> [X; N];
    /// `√a`
    fn sqrt<X: Real, const N: usize>(a: &[X; N]) -> [X; N];
    /// `a ≤ b`
    fn le<X: Real, const N: usize>(a: &[X; N], b: &[X; N]) -> [u64; N];
    /// `a < b`
    fn lt<X: Real, const N: usize>(a: &[X; N], b: &[X; N]) -> [u64; N];
    /// `yes` where the mask is true, `no` elsewhere.
    fn select<X: Real, const N: usize>(mask: &[u64; N], yes: &[X; N], no: &[X; N]) -> [X; N];
}

/// Any processor that the program was built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Portable;

/// Without instructions to be named: the compiler finds some by itself.
#[cfg(not(all(feature = "std", target_arch = "x86_64")))]
impl Processor for Portable {
    type Alignment = ();
    const ALIGNMENT: () = ();
    const DOUBLES: usize = 0;

    #[inline(always)]
    fn dispatch<W: Work>(work: W) -> W::Result {
        W::CallSite::portable(work)
    }
    const FUSES: bool = false;
    fn add<X: Real, const N: usize>(a: &[X; N], _: &[X; N]) -> [X; N] {
        *a
    }
    fn sub<X: Real, const N: usize>(a: &[X; N], _: &[X; N]) -> [X; N] {
        *a
    }
    fn mul<X: Real, const N: usize>(a: &[X; N], _: &[X; N]) -> [X; N] {
        *a
    }
    fn mul_add<X: Real, const N: usize>(a: &[X; N], _: &[X; N], _: &[X; N]) -> [X; N] {
        *a
    }
    fn neg_mul_add<X: Real, const N: usize>(a: &[X; N], _: &[X; N], _: &[X; N]) -> [X; N] {
        *a
    }
    fn fma<X: Real, const N: usize>(a: &[X; N], _: &[X; N], _: &[X; N]) -> [X; N] {
        *a
    }
    fn div<X: Real, const N: usize>(a: &[X; N], _: &[X; N]) -> [X; N] {
        *a
    }
    fn neg<X: Real, const N: usize>(a: &[X; N]) -> [X; N] {
        *a
    }
    fn abs<X: Real, const N: usize>(a: &[X; N]) -> [X; N] {
        *a
    }
    fn sqrt<X: Real, const N: usize>(a: &[X; N]) -> [X; N] {
        *a
    }
    fn le<X: Real, const N: usize>(_: &[X; N], _: &[X; N]) -> [u64; N] {
        [0; N]
    }
    fn lt<X: Real, const N: usize>(_: &[X; N], _: &[X; N]) -> [u64; N] {
        [0; N]
    }
    fn select<X: Real, const N: usize>(_: &[u64; N], yes: &[X; N], _: &[X; N]) -> [X; N] {
        *yes
    }
}

impl<X, const N: usize, P: Processor> From<[X; N]> for Lanes<X, N, P> {
    #[inline(always)]
    fn from(numbers: [X; N]) -> Self {
        Self(numbers, P::ALIGNMENT)
    }
}

impl<X: Real, const N: usize, P: Processor> Lanes<X, N, P> {
    /// The number in each lane.
    #[cfg(feature = "dynamic")]
    #[inline(always)]
    pub(super) fn numbers(self) -> [X; N] {
        self.0
    }

    /// Whether the processor has instructions for these: known when the code is compiled, which then has only the one way.
    const NATIVE: bool = X::IS_DOUBLE && P::DOUBLES > 0 && N.is_multiple_of(P::DOUBLES);

    #[inline(always)]
    fn map(self, f: impl Fn(X) -> X) -> Self {
        let mut numbers = self.0;
        for x in &mut numbers {
            *x = f(*x);
        }
        Self(numbers, P::ALIGNMENT)
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(X, X) -> X) -> Self {
        let (mut numbers, mut k) = (self.0, 0);
        while k < N {
            numbers[k] = f(self.0[k], other.0[k]);
            k += 1;
        }
        Self(numbers, P::ALIGNMENT)
    }

    /// Where not all lanes are near zero. Out of the way, so that nothing is put aside for it before it is known to be needed.
    #[cold]
    #[inline(never)]
    fn stumpff_of_each<const K: usize>(self) -> [Self; K] {
        let mut family = [Self::of(0.0); K];
        for lane in 0..N {
            for (member, value) in family.iter_mut().zip(self.0[lane].stumpff::<K>()) {
                member.0[lane] = value;
            }
        }
        family
    }

    #[inline(always)]
    fn test(self, other: Self, f: impl Fn(X, X) -> bool) -> LaneMask<N> {
        let mut truths = [0; N];
        for (truth, (x, y)) in truths.iter_mut().zip(self.0.iter().zip(&other.0)) {
            *truth = if f(*x, *y) { u64::MAX } else { 0 };
        }
        LaneMask(truths)
    }
}

macro_rules! operators {
    ($($trait:ident $name:ident $operator:tt,)*) => {
        $(impl<X: Real, const N: usize, P: Processor> $trait for Lanes<X, N, P> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                if const { Self::NATIVE } {
                    Self(P::$name(&self.0, &other.0), P::ALIGNMENT)
                } else {
                    self.zip(other, |x, y| x $operator y)
                }
            }
        })*
    };
}
operators! { Add add +, Sub sub -, Mul mul *, Div div /, }

impl<X: Real, const N: usize, P: Processor> Neg for Lanes<X, N, P> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        if const { Self::NATIVE } { Self(P::neg(&self.0), P::ALIGNMENT) } else { self.map(|x| -x) }
    }
}

macro_rules! each {
    ($($name:ident)*) => {
        $(#[inline(always)]
        fn $name(self) -> Self {
            self.map(|x| Scalar::$name(x))
        })*
    };
}

/// Comparisons, by the processor's instruction if it has one.
macro_rules! comparisons {
    ($($name:ident $operator:tt),*) => {
        $(#[inline(always)]
        fn $name(self, limit: Self) -> LaneMask<N> {
            if const { Self::NATIVE } {
                LaneMask(P::$name(&self.0, &limit.0))
            } else {
                self.test(limit, |x, y| x $operator y)
            }
        })*
    };
}

/// Operations of three operands, likewise.
macro_rules! three_operands {
    ($($name:ident if $native:expr),*) => {
        $(#[inline(always)]
        fn $name(self, a: Self, b: Self) -> Self {
            if const { $native } {
                return Self(P::$name(&self.0, &a.0, &b.0), P::ALIGNMENT);
            }
            let mut numbers = self.0;
            for (k, x) in numbers.iter_mut().enumerate() {
                *x = (*x).$name(a.0[k], b.0[k]);
            }
            Self::from(numbers)
        })*
    };
}

impl<X: Real, const N: usize, P: Processor> Scalar for Lanes<X, N, P> {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self([X::of(value); N], P::ALIGNMENT)
    }
    three_operands! { mul_add if Self::NATIVE, neg_mul_add if Self::NATIVE }
    #[inline(always)]
    fn sqrt(self) -> Self {
        if const { Self::NATIVE } { Self(P::sqrt(&self.0), P::ALIGNMENT) } else { self.map(|x| x.sqrt()) }
    }
    each! { exp ln sin cos tan asin acos atan sinh cosh tanh }
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        self.zip(exponent, |x, y| x.powf(y))
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        self.zip(x, |y, x| y.atan2(x))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |x, y| Scalar::min(x, y))
    }
    #[inline(always)]
    fn if_negative(self, negative: Self, otherwise: Self) -> Self {
        Self::select(self.lt(Self::of(0.0)), negative, otherwise)
    }
    #[inline(always)]
    fn stumpff<const K: usize>(self) -> [Self; K] {
        match stumpff::near(self) {
            Some(family) => family,
            None => self.stumpff_of_each(),
        }
    }
    #[inline(always)]
    fn recip_or_zero(self) -> Self {
        let negligible = if X::IS_DOUBLE { zero::NEGLIGIBLE } else { zero::NEGLIGIBLE_SINGLE };
        let is_negligible = Batch::abs(self).le(Self::of(negligible));
        Self::select(is_negligible, Self::of(0.0), Self::of(1.0) / self)
    }
    #[inline(always)]
    fn angle_over_sine<const K: u32>(self) -> Self {
        self.map(|x| x.angle_over_sine::<K>())
    }
}

impl<X: Real, const N: usize, P: Processor> crate::scalar::sealed::Sealed for Lanes<X, N, P> {}

impl<X: Real, const N: usize, P: Processor> Batch for Lanes<X, N, P> {
    type Number = X;
    type Mask = LaneMask<N>;
    type Each<Y: Copy + Send + Sync> = [Y; N];

    const LANES: usize = N;
    const EPSILON: f64 = X::EPSILON;
    const MIN_POSITIVE: f64 = X::MIN_POSITIVE;

    #[inline(always)]
    fn each<Y: Copy + Send + Sync>(mut value: impl FnMut(usize) -> Y) -> [Y; N] {
        // a loop: `array::from_fn` is four functions more to compile for each closure
        let mut each = [value(0); N];
        for (lane, of_lane) in each.iter_mut().enumerate().skip(1) {
            *of_lane = value(lane);
        }
        each
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> X {
        self.0[lane]
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, number: X) {
        self.0[lane] = number;
    }
    #[inline(always)]
    fn abs(self) -> Self {
        if const { Self::NATIVE } { Self(P::abs(&self.0), P::ALIGNMENT) } else { self.map(|x| Batch::abs(x)) }
    }
    #[inline(always)]
    fn is_finite(self) -> LaneMask<N> {
        if const { Self::NATIVE } {
            // not so of what is no number
            return Batch::abs(self).le(Self::of(f64::MAX));
        }
        self.test(self, |x, _| Batch::is_finite(x))
    }
    #[inline(always)]
    fn is_same(self, other: Self) -> LaneMask<N> {
        self.test(other, |x, y| x.is_same(y))
    }
    comparisons! { le <=, lt < }
    #[inline(always)]
    fn select(mask: LaneMask<N>, yes: Self, no: Self) -> Self {
        if const { Self::NATIVE } {
            return Self(P::select(&mask.0, &yes.0, &no.0), P::ALIGNMENT);
        }
        let mut numbers = no.0;
        for (k, x) in numbers.iter_mut().enumerate() {
            *x = if mask.0[k] != 0 { yes.0[k] } else { *x };
        }
        Self(numbers, P::ALIGNMENT)
    }
    const HAS_FMA: bool = P::FUSES;
    three_operands! { fma if Self::NATIVE && P::FUSES }
    #[inline(always)]
    fn dispatch<W: Work>(work: W) -> W::Result {
        P::dispatch(work)
    }
    #[cfg(all(feature = "std", target_arch = "x86_64"))]
    #[inline(always)]
    fn dispatch_fused<W: Work>(work: W) -> W::Result {
        if const { P::FUSES } {
            P::dispatch(work)
        } else {
            crate::scalar::simd::processor::dispatch_fused(work)
        }
    }
}

/// Adds `Σ columns[k] · by[k]`, two entries at a time.
#[inline(always)]
pub(crate) fn add_product<const N: usize, const K: usize>(
    sum: &mut [f64; N],
    columns: &[[f64; N]; K],
    by: &[f64; K],
) {
    type Two = Lanes<f64, 2, Portable>;
    let mut start = 0;
    while start + 2 <= N {
        let of = |column: &[f64; N]| Two::from([column[start], column[start + 1]]);
        let mut total = of(sum);
        for (column, by) in columns.iter().zip(by) {
            total = of(column).mul_add(Two::from([*by; 2]), total);
        }
        sum[start..start + 2].copy_from_slice(&total.0);
        start += 2;
    }
    while start < N {
        for (column, by) in columns.iter().zip(by) {
            // not that of `f64` itself, which rounds once and is a call where the processor has no such operation
            sum[start] = Scalar::mul_add(column[start], *by, sum[start]);
        }
        start += 1;
    }
}

/// A truth for each of `N` lanes: all bits or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LaneMask<const N: usize>([u64; N]);

impl<const N: usize> Mask for LaneMask<N> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([if value { u64::MAX } else { 0 }; N])
    }
    #[inline(always)]
    fn all(self) -> bool {
        // for this there is an instruction
        let (mut lacks, mut k) = (0, 0);
        while k < N {
            (lacks, k) = (lacks | !self.0[k], k + 1);
        }
        lacks == 0
    }
    #[inline(always)]
    fn any(self) -> bool {
        let (mut any, mut k) = (0, 0);
        while k < N {
            (any, k) = (any | self.0[k], k + 1);
        }
        any != 0
    }
    #[inline(always)]
    fn lane(self, lane: usize) -> bool {
        self.0[lane] != 0
    }
}

/// No closures, and no iterators: of each operation there are thousands.
macro_rules! of_truths {
    ($($trait:ident $name:ident $operator:tt),*) => {
        $(impl<const N: usize> $trait for LaneMask<N> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                let (mut truths, mut k) = (self.0, 0);
                while k < N {
                    truths[k] = self.0[k] $operator other.0[k];
                    k += 1;
                }
                Self(truths)
            }
        })*
    };
}
of_truths! { BitAnd bitand &, BitOr bitor | }

impl<const N: usize> Not for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        let (mut truths, mut k) = (self.0, 0);
        while k < N {
            truths[k] = !self.0[k];
            k += 1;
        }
        Self(truths)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[cfg(target_arch = "x86_64")]
    use crate::scalar::simd::processor::{Avx2, Avx512};

    /// Every operation does in each lane what it does to the number alone, not-a-number, infinities and zeros included.
    fn do_in_each_lane_as_alone<const N: usize, P: Processor>() {
        let numbers = [0.0, -0.0, 1.0, -2.5, 3e-310, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
        let lanes = |shift: usize| {
            Lanes::<f64, N, P>::from(core::array::from_fn(|lane| numbers[(lane + shift) % numbers.len()]))
        };
        for (i, j) in (0..numbers.len()).flat_map(|i| (0..numbers.len()).map(move |j| (i, j))) {
            let (x, y, z) = (lanes(i), lanes(j), lanes(i + 2 * j));
            let together = [
                x + y,
                x - y,
                x * y,
                x / y,
                -x,
                x.sqrt(),
                Batch::abs(x),
                Scalar::mul_add(y, z, x),
                y.neg_mul_add(z, x),
                y.fma(z, x),
            ];
            let (at_most, below, larger) = (x.le(y), x.lt(y), Lanes::select(x.lt(y), y, x));
            for lane in 0..N {
                let (x, y, z) = (x.lane(lane), y.lane(lane), z.lane(lane));
                let alone = [
                    x + y,
                    x - y,
                    x * y,
                    x / y,
                    -x,
                    x.sqrt(),
                    x.abs(),
                    Scalar::mul_add(y, z, x),
                    y.neg_mul_add(z, x),
                    y.fma(z, x),
                ];
                for (together, alone) in together.iter().zip(alone) {
                    let together = together.lane(lane);
                    assert!(together.is_same(alone) || together.is_nan() && alone.is_nan(), "{x} {y} {z}");
                }
                assert_eq!((at_most.lane(lane), below.lane(lane)), (x <= y, x < y), "{x} {y}");
                assert!(larger.lane(lane).is_same(if x < y { y } else { x }), "{x} {y}");
            }
        }
    }

    #[test]
    fn lanes_do_as_numbers_alone() {
        do_in_each_lane_as_alone::<4, Portable>();
        do_in_each_lane_as_alone::<3, Portable>();
        #[cfg(target_arch = "x86_64")]
        if Avx2::is_here() {
            do_in_each_lane_as_alone::<4, Avx2>();
        }
        #[cfg(target_arch = "x86_64")]
        if Avx512::is_here() {
            do_in_each_lane_as_alone::<8, Avx512>();
        }
    }

    #[test]
    fn masks_tell_of_all_and_of_any() {
        let x = Lanes::<f64, 4, Portable>::from([1.0, 2.0, 3.0, 4.0]);
        let at_most = |limit: f64| x.le(Lanes::of(limit));
        assert_eq!([0.0, 2.0, 4.0].map(|limit| at_most(limit).all()), [false, false, true]);
        assert_eq!([0.0, 2.0, 4.0].map(|limit| at_most(limit).any()), [false, true, true]);
        assert_eq!((at_most(2.0) & !at_most(1.0)).0, [0, u64::MAX, 0, 0]);
        assert_eq!((!at_most(3.0) | at_most(1.0)).0, [u64::MAX, 0, 0, u64::MAX]);
    }
}
