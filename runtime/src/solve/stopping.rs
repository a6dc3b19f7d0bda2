//! When an iteration may stop: sizes that do not depend on units.
//!
//! Unknowns come in blocks of one unit each, angles and lengths, say. What changes is compared block by block with the block's size as it is
//! now, and the ratios are added: another unit of a block changes nothing, and a block that dies out is solved to as many digits as ever.

use crate::scalar::{Batch, Components, Mask};

/// The least change of an unknown that is more than roundoff, in units of epsilon.
pub(super) const ROUNDOFF: f64 = 2.0;

/// `Σ_b |of|_b / |to|_b` over the blocks, of these lengths, with the sums of magnitudes as norms; not-a-number if any component is.
#[inline(always)]
pub(super) fn relative<T: Batch, U: Components<T>>(blocks: &[usize], of: &U, to: &U) -> T {
    // what is smaller than this has not its full precision: such blocks, and those at rest, count next to it
    let floor = T::of(T::MIN_POSITIVE / T::EPSILON);
    let (of, to) = (of.as_ref(), to.as_ref());
    let (mut ratios, mut from) = (T::of(0.0), 0_usize);
    // loops over places: chains of iterators take longer to compile than all else here
    for length in blocks {
        let end = from.saturating_add(*length).min(U::LENGTH);
        let (mut change, mut size) = (T::of(0.0), floor);
        while from < end {
            change = change + of[from].abs();
            size = size + to[from].abs();
            from += 1;
        }
        ratios = ratios + change / size;
    }
    ratios
}

/// What the components of changes of an unknown are to be multiplied by: one over the size of their block.
#[inline(always)]
pub(super) fn weights<T: Batch, U: Components<T>>(blocks: &[usize], to: &U) -> U {
    let floor = T::of(T::MIN_POSITIVE / T::EPSILON);
    let (mut weights, mut from) = (*to, 0_usize);
    for length in blocks {
        let end = from.saturating_add(*length).min(U::LENGTH);
        let (mut size, mut k) = (floor, from);
        while k < end {
            size = size + to.as_ref()[k].abs();
            k += 1;
        }
        let weight = T::of(1.0) / size;
        while from < end {
            weights.as_mut()[from] = weight;
            from += 1;
        }
    }
    weights
}

/// How large a change is, with such weights.
#[inline(always)]
pub(super) fn weighted<T: Batch, U: Components<T>>(weights: &U, of: &U) -> T {
    let (mut size, mut k) = (T::of(0.0), 0);
    while k < U::LENGTH {
        size = size + weights.as_ref()[k] * of.as_ref()[k].abs();
        k += 1;
    }
    size
}

/// The change from one unknown to another, relative to this one.
#[inline(always)]
pub(super) fn change<T: Batch, U: Components<T>>(blocks: &[usize], from: &U, to: &U) -> T {
    let mut difference = *to;
    let mut i = 0;
    while i < U::LENGTH {
        difference.as_mut()[i] = to.as_ref()[i] - from.as_ref()[i];
        i += 1;
    }
    relative(blocks, &difference, to)
}

/// Whether no block changes by more than `tolerance` times its size: without a division, which takes long.
#[inline(always)]
pub(super) fn is_within<T: Batch, U: Components<T>>(
    blocks: &[usize],
    from: &U,
    to: &U,
    tolerance: T,
) -> T::Mask {
    let floor = T::of(T::MIN_POSITIVE / T::EPSILON);
    let (from, to) = (from.as_ref(), to.as_ref());
    let (mut is_within, mut k) = (T::Mask::splat(true), 0_usize);
    for length in blocks {
        let end = k.saturating_add(*length).min(U::LENGTH);
        let (mut change, mut size) = (T::of(0.0), floor);
        while k < end {
            change = change + (to[k] - from[k]).abs();
            size = size + to[k].abs();
            k += 1;
        }
        is_within = is_within & change.le(tolerance * size);
    }
    is_within
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
