//! Loads that do not wait for stores of another width.

#![allow(unsafe_code, reason = "only a volatile load is left as narrow as it is written")]

use crate::scalar::{Batch, Components};

/// The same numbers, loaded one by one. What was stored a moment ago in two pieces and is loaded in one has to wait until it is in the cache;
/// and in which pieces numbers are stored and loaded is up to the compiler, which does not see the one where it compiles the other.
#[inline(always)]
pub(crate) fn one_by_one<T: Batch, C: Components<T>>(numbers: &C) -> C {
    let mut loaded = *numbers;
    if const { T::LANES == 1 } {
        let mut k = 0;
        while k < C::LENGTH {
            // SAFETY: it is a reference; volatile, so that it is not made part of a wider load
            loaded.as_mut()[k] = unsafe { core::ptr::read_volatile(&raw const numbers.as_ref()[k]) };
            k += 1;
        }
    }
    loaded
}
