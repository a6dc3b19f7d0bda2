//! Loads that do not wait for stores of another width.

#![allow(unsafe_code, reason = "only a volatile load is left as narrow as it is written")]

use crate::scalar::{Batch, Components, Real};

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

/// A function that puts each number in a register of its own, with these options of an instruction that is none.
macro_rules! apart {
    ($(#[$doc:meta])* $name:ident: $($option:ident),*) => {
        $(#[$doc])*
        #[inline(always)]
        pub(crate) fn $name<T: Batch, C: Components<T>>(numbers: &C) -> C {
            let mut apart = *numbers;
            #[cfg(target_arch = "x86_64")]
            if const { T::PAIRS } {
                let mut k = 0;
                while k < C::LENGTH {
                    let mut x = apart.as_ref()[k].lane(0).to_f64();
                    // SAFETY: no instruction
                    unsafe { core::arch::asm!("/* {0} */", inout(xmm_reg) x, options($($option),*)) };
                    apart.as_mut()[k] = T::of(x);
                    k += 1;
                }
            }
            apart
        }
    };
}
apart! {
    /// The same numbers, each in a register of its own: the compiler does not put them together to compute two at a time, which costs more to
    /// take apart again than it saves (a quarter of a step).
    apart: pure, nomem, nostack, preserves_flags
}
apart! {
    /// The same, and computed here: the processor does not see far ahead, and what the next step waits for is to come first.
    apart_here: nomem, nostack, preserves_flags
}
