//! Sizes of unknowns that do not depend on units.
//!
//! Unknowns come in blocks of one unit each, angles and lengths, say. A norm is the sum of magnitudes in a block, relative to another one there:
//! another unit of a block changes nothing, and a block that dies out counts as it is now.

use crate::scalar::{Batch, Components, Mask};

/// The norms of the blocks of these lengths, one after the other, as each `term` of a component says.
macro_rules! blocks {
    ($blocks:expr, $length:expr, $i:ident, [$($sum:ident = $from:expr => $term:expr),+], $then:block) => {{
        // loops over places: chains of iterators take longer to compile than all else here
        let mut $i = 0_usize;
        for length in $blocks {
            let end = $i.saturating_add(*length).min($length);
            $(let mut $sum = $from;)+
            while $i < end {
                $($sum = $sum + $term;)+
                $i += 1;
            }
            $then
        }
    }};
}

/// What is smaller has not its full precision: blocks at rest count next to it.
#[inline(always)]
fn floor<T: Batch>() -> T {
    T::of(T::MIN_POSITIVE / T::EPSILON)
}

/// `Σ_b |of|_b / |to|_b`; not-a-number if any component is.
#[inline(always)]
pub(crate) fn relative<T: Batch, U: Components<T>>(blocks: &[usize], of: &U, to: &U) -> T {
    let (of, to, mut ratios) = (of.as_ref(), to.as_ref(), T::of(0.0));
    blocks!(blocks, U::LENGTH, i, [change = T::of(0.0) => of[i].abs(), size = floor() => to[i].abs()], {
        ratios = ratios + change / size;
    });
    ratios
}

/// The change from one unknown to another, relative to this one.
#[inline(always)]
pub(crate) fn change<T: Batch, U: Components<T>>(blocks: &[usize], from: &U, to: &U) -> T {
    relative(blocks, &less(to, from), to)
}

/// One over the size of its block for each component.
#[inline(always)]
pub(crate) fn weights<T: Batch, U: Components<T>>(blocks: &[usize], to: &U) -> U {
    let (mut weights, mut from) = (*to, 0_usize);
    blocks!(blocks, U::LENGTH, i, [size = floor() => to.as_ref()[i].abs()], {
        let weight = T::of(1.0) / size;
        // the bound that the compiler sees, too
        while from < i.min(U::LENGTH) {
            weights.as_mut()[from] = weight;
            from += 1;
        }
    });
    weights
}

/// The change from one unknown to another with such weights.
#[inline(always)]
pub(crate) fn weighted<T: Batch, U: Components<T>>(weights: &U, from: &U, to: &U) -> T {
    let (mut size, mut k) = (T::of(0.0), 0);
    while k < U::LENGTH {
        size = size + weights.as_ref()[k] * (to.as_ref()[k] - from.as_ref()[k]).abs();
        k += 1;
    }
    size
}

/// Whether no block changes by more than `tolerance` times its size: without a division, which takes long.
#[inline(always)]
pub(crate) fn is_within<T: Batch, U: Components<T>>(
    blocks: &[usize],
    from: &U,
    to: &U,
    tolerance: T,
) -> T::Mask {
    let (from, to, mut is_within) = (from.as_ref(), to.as_ref(), T::Mask::splat(true));
    blocks!(
        blocks,
        U::LENGTH,
        i,
        [change = T::of(-0.0) => (to[i] - from[i]).abs(), size = T::of(-0.0) => to[i].abs()],
        { is_within = is_within & change.le(tolerance * size) }
    );
    is_within
}

/// Whether each block of one is no larger than that of the other, which is finite.
#[inline(always)]
pub(crate) fn is_below<T: Batch, U: Components<T>>(blocks: &[usize], of: &U, bound: &U) -> T::Mask {
    let (of, bound, mut is_below) = (of.as_ref(), bound.as_ref(), T::Mask::splat(true));
    blocks!(blocks, U::LENGTH, i, [size = T::of(0.0) => of[i].abs(), most = floor() => bound[i].abs()], {
        is_below = is_below & size.le(most) & most.is_finite();
    });
    is_below
}

/// The blocks that are not [below](is_below) a bound; the others are zero.
#[inline(always)]
pub(crate) fn beyond<T: Batch, U: Components<T>>(blocks: &[usize], of: &U, bound: &U) -> U {
    let (mut beyond, mut from) = (*of, 0_usize);
    blocks!(blocks, U::LENGTH, i, [size = T::of(0.0) => of.as_ref()[i].abs(), most = floor() => bound.as_ref()[i].abs()], {
        let is_below = size.le(most) & most.is_finite();
        for x in beyond.as_mut().iter_mut().take(i).skip(from) {
            *x = T::select(is_below, T::of(0.0), *x);
        }
        from = i;
    });
    beyond
}

/// `yes` where the mask is true, `no` elsewhere.
#[inline(always)]
pub(crate) fn select<T: Batch, U: Components<T>>(mask: T::Mask, yes: &U, no: &U) -> U {
    let mut selected = *no;
    let mut i = 0;
    while i < U::LENGTH {
        selected.as_mut()[i] = T::select(mask, yes.as_ref()[i], no.as_ref()[i]);
        i += 1;
    }
    selected
}

/// The difference of two unknowns.
#[inline(always)]
pub(crate) fn less<T: Batch, U: Components<T>>(a: &U, b: &U) -> U {
    plus(a, T::of(-1.0), b)
}

/// `a + factor b`
#[inline(always)]
pub(crate) fn plus<T: Batch, U: Components<T>>(a: &U, factor: T, b: &U) -> U {
    let mut sum = *a;
    let mut i = 0;
    while i < U::LENGTH {
        sum.as_mut()[i] = a.as_ref()[i] + factor * b.as_ref()[i];
        i += 1;
    }
    sum
}
