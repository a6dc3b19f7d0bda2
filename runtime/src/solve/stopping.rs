//! When an iteration may stop: sizes that do not depend on units.
//!
//! Unknowns come in blocks of one unit each, angles and lengths, say. What changes is compared block by block with the block's size as it is
//! now, and the ratios are added: another unit of a block changes nothing, and a block that dies out is solved to as many digits as ever.

use crate::kernel::Components;
use crate::scalar::{Batch, Mask};

/// The least change of an unknown that is more than roundoff, in units of epsilon.
pub(super) const ROUNDOFF: f64 = 2.0;

/// `Σ_b |of|_b / |to|_b` over the blocks, of these lengths, with the sums of magnitudes as norms; not-a-number if any component is.
#[inline(always)]
pub(super) fn relative<T: Batch, U: Components<T>>(blocks: &[usize], of: &U, to: &U) -> T {
    // what is smaller than this has not its full precision: such blocks, and those at rest, count next to it
    let floor = T::of(T::LEAST / T::EPSILON);
    let (mut of, mut to) = (of.as_ref(), to.as_ref());
    let mut ratios = T::of(0.0);
    for &length in blocks {
        let (changes, sizes);
        ((changes, of), (sizes, to)) = (of.split_at(length.min(of.len())), to.split_at(length.min(to.len())));
        let (mut change, mut size) = (T::of(0.0), floor);
        for (of, to) in changes.iter().zip(sizes) {
            change = change + of.abs();
            size = size + to.abs();
        }
        ratios = ratios + change / size;
    }
    ratios
}

/// The change from one unknown to another, relative to this one.
#[inline(always)]
pub(super) fn change<T: Batch, U: Components<T>>(blocks: &[usize], from: &U, to: &U) -> T {
    let mut difference = *to;
    for (difference, from) in difference.as_mut().iter_mut().zip(from.as_ref()) {
        *difference = *difference - *from;
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
    let floor = T::of(T::LEAST / T::EPSILON);
    let (mut from, mut to) = (from.as_ref(), to.as_ref());
    let mut is_within = T::Mask::splat(true);
    for &length in blocks {
        let (before, after);
        ((before, from), (after, to)) =
            (from.split_at(length.min(from.len())), to.split_at(length.min(to.len())));
        let (mut change, mut size) = (T::of(0.0), floor);
        for (from, to) in before.iter().zip(after) {
            change = change + (*to - *from).abs();
            size = size + to.abs();
        }
        is_within = is_within & change.at_most(tolerance * size);
    }
    is_within
}

/// `yes` where the mask is true, `no` elsewhere.
#[inline(always)]
pub(crate) fn select<T: Batch, U: Components<T>>(mask: T::Mask, yes: &U, no: &U) -> U {
    let mut selected = *no;
    for (selected, yes) in selected.as_mut().iter_mut().zip(yes.as_ref()) {
        *selected = T::select(mask, *yes, *selected);
    }
    selected
}
