//! What is computed component by component of several arrays that were kept: as many components at a time as the processor has instructions
//! for, and the same, bit for bit, as one by one.

use crate::kernel::Components;
use crate::scalar::Batch;
#[cfg(all(feature = "std", target_arch = "x86_64"))]
use crate::scalar::FUSED;
use crate::simd::lanes::Processor;

/// Components that were kept.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Term<T: Batch, U> {
    pub(crate) components: U,
    rest: T::Rest,
}

impl<T: Batch, U: Components<T>> Term<T, U> {
    pub(crate) fn new(components: U) -> Self {
        Self { components, rest: T::Rest::default() }
    }

    /// Puts components where a [`Formula`] will find them, in the pieces in which they are loaded there: what is stored in others has to wait
    /// until it is in the cache.
    #[inline(always)]
    pub(crate) fn keep<P: Processor>(&mut self, components: &U) {
        #[cfg(all(feature = "std", target_arch = "x86_64"))]
        if const { T::PAIRS } {
            return crate::simd::processor::keep::<P, _, _>(self, components);
        }
        self.components = *components;
    }
}

/// A coefficient.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(crate) struct Weight<T> {
    /// For two components, so that not every step has to put it there.
    pub(crate) twice: [T; 2],
}

impl<T: Copy> Weight<T> {
    pub(crate) fn new(value: T) -> Self {
        Self { twice: [value; 2] }
    }

    #[inline(always)]
    pub(crate) fn value(&self) -> T {
        self.twice[0]
    }
}

/// A component of each of several numbers' arrays, or a few components side by side.
pub(crate) trait Piece<T: Batch>: Copy {
    /// The component `i` of a term, and those after it.
    fn of<U: Components<T>>(term: &Term<T, U>, i: usize) -> Self;
    /// `a self`
    fn times(self, a: &Weight<T>) -> Self;
    /// `self + a x`, rounded as [`Scalar::plus`](crate::scalar::Scalar::plus) does.
    fn plus(self, a: &Weight<T>, x: Self) -> Self;
    /// `self − a x`, rounded as [`Scalar::minus`](crate::scalar::Scalar::minus) does.
    fn minus(self, a: &Weight<T>, x: Self) -> Self;
    /// `self + x`
    fn and(self, x: Self) -> Self;
    /// `self − x`
    fn less(self, x: Self) -> Self;
}

impl<T: Batch> Piece<T> for T {
    #[inline(always)]
    fn of<U: Components<T>>(term: &Term<T, U>, i: usize) -> Self {
        term.components.as_ref()[i]
    }
    #[inline(always)]
    fn times(self, a: &Weight<T>) -> Self {
        a.value() * self
    }
    #[inline(always)]
    fn plus(self, a: &Weight<T>, x: Self) -> Self {
        a.value().mul_add(x, self)
    }
    #[inline(always)]
    fn minus(self, a: &Weight<T>, x: Self) -> Self {
        a.value().neg_mul_add(x, self)
    }
    #[inline(always)]
    fn and(self, x: Self) -> Self {
        self + x
    }
    #[inline(always)]
    fn less(self, x: Self) -> Self {
        self - x
    }
}

/// Three by themselves: a weight is loaded once for them, and kept in no register after that.
impl<T: Batch> Piece<T> for [T; 3] {
    #[inline(always)]
    fn of<U: Components<T>>(term: &Term<T, U>, i: usize) -> Self {
        let components = term.components.as_ref();
        [components[i], components[i + 1], components[i + 2]]
    }
    #[inline(always)]
    fn times(self, a: &Weight<T>) -> Self {
        let [x, y, z] = self;
        [Piece::times(x, a), Piece::times(y, a), Piece::times(z, a)]
    }
    #[inline(always)]
    fn plus(self, a: &Weight<T>, [u, v, w]: Self) -> Self {
        let [x, y, z] = self;
        [Piece::plus(x, a, u), Piece::plus(y, a, v), Piece::plus(z, a, w)]
    }
    #[inline(always)]
    fn minus(self, a: &Weight<T>, [u, v, w]: Self) -> Self {
        let [x, y, z] = self;
        [Piece::minus(x, a, u), Piece::minus(y, a, v), Piece::minus(z, a, w)]
    }
    #[inline(always)]
    fn and(self, [u, v, w]: Self) -> Self {
        let [x, y, z] = self;
        [x + u, y + v, z + w]
    }
    #[inline(always)]
    fn less(self, [u, v, w]: Self) -> Self {
        let [x, y, z] = self;
        [x - u, y - v, z - w]
    }
}

/// What each component is computed by. Not a closure, since these cannot say that they are always to be inlined.
pub(crate) trait Formula<T: Batch> {
    /// The component `i`, and those after it.
    fn at<X: Piece<T>>(&self, i: usize) -> X;
}

/// All components, for the processor that the caller is compiled for.
#[inline(always)]
pub(crate) fn computed<P: Processor, T: Batch, U: Components<T>>(formula: &impl Formula<T>, like: &U) -> U {
    let mut all = *like;
    let components = all.as_mut();
    let mut done = 0;
    #[cfg(all(feature = "std", target_arch = "x86_64"))]
    if const { T::PAIRS && (P::FOURS || T::IS_FUSED == FUSED) } {
        done = crate::simd::processor::compute::<P, T>(formula, components);
    }
    while done + 3 <= components.len() {
        let three: [T; 3] = formula.at(done);
        components[done..done + 3].copy_from_slice(&three);
        done += 3;
    }
    while done < components.len() {
        components[done] = formula.at(done);
        done += 1;
    }
    all
}
