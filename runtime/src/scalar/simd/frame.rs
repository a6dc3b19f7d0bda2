//! Numbers that all copies of a kernel have in common: those of a kernel that is made at run time, of which nobody knew how many there are when
//! the code was compiled.
#![allow(unsafe_code, reason = "kernels are copied, and their copies write to the same numbers")]

use core::ptr::NonNull;
use std::boxed::Box;
use std::sync::Arc;

use super::lanes::{Lanes, Portable, Processor};
#[cfg(target_arch = "x86_64")]
use super::processor::{Avx2, Avx512};
use crate::scalar::{Batch, Work};

/// How many members of an ensemble are side by side where their functions are made at run time: what leads to an operation is done once for all
/// of them. A member of twice as many takes three quarters of the time, up to here; frames of more do not fit the fastest memory.
pub const LANES: usize = 32;

/// So many numbers, for the processors that have instructions for four of them at least.
#[cfg(target_arch = "x86_64")]
pub(crate) type Wide = Lanes<f64, LANES, Avx2>;
/// So many numbers.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) type Wide = Lanes<f64, LANES, Portable>;

/// How many members machine code steps side by side, in two registers. Steps of Newton's method, which wait for one operation after the other, take a
/// third less so than in one register; others as much or a little less, with as many instructions.
pub const MACHINE_LANES: usize = 4;

/// So many numbers.
pub(crate) type MachineLanes = Lanes<f64, MACHINE_LANES, Portable>;

/// Whether the processor has the instructions for [`Wide`] numbers.
pub(crate) fn has_lanes() -> bool {
    #[cfg(target_arch = "x86_64")]
    return Avx2::is_here();
    #[cfg(not(target_arch = "x86_64"))]
    return true;
}

/// Does work on many numbers side by side, compiled for the best processor that there is.
#[inline]
pub fn side_by_side<W: Work>(work: W) -> W::Result {
    #[cfg(target_arch = "x86_64")]
    if Avx512::is_here() {
        return Avx512::dispatch(work);
    } else if Avx2::is_here() {
        return Avx2::dispatch(work);
    }
    work.done()
}

/// Numbers that are in frames as themselves, or as an array of what is in each lane.
pub(crate) trait Framed: Batch<Number = f64> {
    /// What is in a frame.
    type Row: Copy + Default + Send + Sync + 'static;
    /// The number as it is there.
    fn row(self) -> Self::Row;
    /// The number of what is there.
    fn of_row(row: Self::Row) -> Self;
}

impl Framed for f64 {
    type Row = Self;

    #[inline(always)]
    fn row(self) -> Self {
        self
    }
    #[inline(always)]
    fn of_row(row: Self) -> Self {
        row
    }
}

impl<const L: usize, P: Processor> Framed for Lanes<f64, L, P>
where
    [f64; L]: Default,
{
    type Row = [f64; L];

    #[inline(always)]
    fn row(self) -> Self::Row {
        self.numbers()
    }
    #[inline(always)]
    fn of_row(row: Self::Row) -> Self {
        row.into()
    }
}

/// What is used together with something `F` that it writes to, and `D` that it reads.
pub(crate) struct Joined<F, D, M> {
    user: M,
    handle: Handle<F, D>,
    /// What the handle points to.
    _data: Arc<D>,
}

/// How the user reaches both.
pub(crate) struct Handle<F, D> {
    frame: NonNull<F>,
    data: NonNull<D>,
}

impl<F, D> Clone for Handle<F, D> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<F, D> Copy for Handle<F, D> {}

// SAFETY: it is used through a `&mut` of the `Joined` that it belongs to, and so by one thread at a time
unsafe impl<F: Send, D: Send + Sync> Send for Handle<F, D> {}
// SAFETY: as above
unsafe impl<F: Send, D: Send + Sync> Sync for Handle<F, D> {}

impl<F, D, M> Joined<F, D, M> {
    /// What `make` makes of a handle, which must go nowhere but into that.
    pub(crate) fn new(frame: F, data: &Arc<D>, make: impl FnOnce(Handle<F, D>) -> M) -> Self {
        let handle =
            Handle { frame: NonNull::from(Box::leak(Box::new(frame))), data: NonNull::from(&**data) };
        Self { user: make(handle), handle, _data: data.clone() }
    }

    /// The user, which reaches the frame as long as it is lent.
    #[inline(always)]
    pub(crate) fn user(&mut self) -> &mut M {
        &mut self.user
    }

    /// The frame, as long as the user is not lent.
    #[inline(always)]
    pub(crate) fn frame(&mut self) -> &mut F {
        // SAFETY: it is there until this is dropped, and the user, which has the only other handles, cannot be called meanwhile
        unsafe { self.handle.frame.as_mut() }
    }
}

impl<F, D, M> Drop for Joined<F, D, M> {
    fn drop(&mut self) {
        // SAFETY: it was a box, and the user, which is `Copy` or plain data, does not look at it when it is dropped
        drop(unsafe { Box::from_raw(self.handle.frame.as_ptr()) });
    }
}

impl<F, D> Handle<F, D> {
    /// What is read.
    #[inline(always)]
    pub(crate) fn data(&self) -> &D {
        // SAFETY: it is there as long as the `Joined` that this is used through
        unsafe { self.data.as_ref() }
    }

    /// Calls a function with the frame. That must not come back here.
    #[inline(always)]
    pub(crate) fn with<R>(&self, f: impl FnOnce(&mut F) -> R) -> R {
        let mut frame = self.frame;
        // SAFETY: it is there as long as the `Joined` that this is used through, which is lent to one caller alone
        f(unsafe { frame.as_mut() })
    }
}
