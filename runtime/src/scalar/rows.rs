//! What is computed component by component of several arrays that are kept: as many components at a time as the processor has instructions
//! for, and the same, bit for bit, as one by one.

#[cfg(all(feature = "std", target_arch = "x86_64"))]
use crate::scalar::FUSED;
use crate::scalar::simd::lanes::Processor;
use crate::scalar::{Batch, Components};

/// Components that are kept, and so many numbers after them: with one, three doubles fill a register of four.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Row<T, U, const SPARE: usize> {
    pub(crate) components: U,
    spare: [T; SPARE],
}

impl<T: Batch, U: Components<T>, const SPARE: usize> Row<T, U, SPARE> {
    #[inline(always)]
    pub(crate) fn new(components: U) -> Self {
        Self { components, spare: [T::of(0.0); SPARE] }
    }
}

/// A component of each of several numbers' arrays, or a few components side by side.
pub(crate) trait Piece<T: Batch>: Copy {
    /// The component `i` of a row, and those after it.
    fn of<U: Components<T>, const SPARE: usize>(row: &Row<T, U, SPARE>, i: usize) -> Self;
    /// The same of components that were just computed: what is stored one by one and loaded together has to wait until it is in the cache.
    fn gathered(components: &[T], i: usize) -> Self;
    /// Puts it where [`of`](Self::of) will find it.
    fn put<U: Components<T>, const SPARE: usize>(self, row: &mut Row<T, U, SPARE>, i: usize);
    /// `self + x`
    fn and(self, x: Self) -> Self;
    /// `self − x`
    fn less(self, x: Self) -> Self;
    /// `a self`
    fn times(self, a: T) -> Self;
    /// `self + a x`, rounded as [`Scalar::mul_add`](crate::scalar::Scalar::mul_add) does.
    fn plus(self, a: T, x: Self) -> Self;
}

impl<T: Batch> Piece<T> for T {
    #[inline(always)]
    fn of<U: Components<T>, const SPARE: usize>(row: &Row<T, U, SPARE>, i: usize) -> Self {
        row.components.as_ref()[i]
    }
    #[inline(always)]
    fn gathered(components: &[T], i: usize) -> Self {
        components[i]
    }
    #[inline(always)]
    fn put<U: Components<T>, const SPARE: usize>(self, row: &mut Row<T, U, SPARE>, i: usize) {
        row.components.as_mut()[i] = self;
    }
    #[inline(always)]
    fn and(self, x: Self) -> Self {
        self + x
    }
    #[inline(always)]
    fn less(self, x: Self) -> Self {
        self - x
    }
    #[inline(always)]
    fn times(self, a: T) -> Self {
        a * self
    }
    #[inline(always)]
    fn plus(self, a: T, x: Self) -> Self {
        a.mul_add(x, self)
    }
}

/// What computes each component of an array. Not a closure, since these cannot say that they are always to be inlined.
pub(crate) trait Formula<T: Batch> {
    /// How many numbers its rows have after the last component.
    #[cfg_attr(
        not(all(feature = "std", target_arch = "x86_64")),
        expect(dead_code, reason = "asked for where several are computed at a time")
    )]
    const SPARE: usize;
    /// The component `i`, and those after it.
    fn at<X: Piece<T>>(&mut self, i: usize) -> X;
}

/// All components, for the processor that the caller is compiled for.
#[inline(always)]
pub(crate) fn computed<P: Processor, T: Batch, U: Components<T>, F: Formula<T>>(
    formula: &mut F,
    like: &U,
) -> U {
    let mut all = *like;
    let components = all.as_mut();
    let mut done = 0;
    #[cfg(all(feature = "std", target_arch = "x86_64"))]
    if const { T::PAIRS && (P::FOURS || T::IS_FUSED == FUSED) } {
        done = crate::scalar::simd::processor::compute::<P, T, F>(formula, components);
    }
    while done < components.len() {
        components[done] = formula.at(done);
        done += 1;
    }
    all
}
