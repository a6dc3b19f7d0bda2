//! Which instructions of the processor arithmetic is compiled for.

#[cfg(target_arch = "x86_64")]
use super::simd::processor::{Avx2, Avx512};

/// What an ensemble's arithmetic is compiled for. It makes no difference to what comes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Instructions {
    /// What the program was built for: on x86-64 two doubles in a register, and single-precision numbers one by one. Elsewhere the compiler finds
    /// some registers by itself.
    Portable,
    /// Four doubles in a register.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// Eight doubles in a register.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Instructions {
    /// Those that the processor has, the widest last.
    pub fn available() -> impl DoubleEndedIterator<Item = Self> {
        [
            Some(Self::Portable),
            #[cfg(target_arch = "x86_64")]
            Avx2::is_here().then_some(Self::Avx2),
            #[cfg(target_arch = "x86_64")]
            Avx512::is_here().then_some(Self::Avx512),
        ]
        .into_iter()
        .flatten()
    }

    /// The widest, but what the program was built for where it was built for debugging: there every operation on many lanes has a place of its own
    /// on the stack, and a step in twice the digits needs more than a thread has.
    pub(crate) fn widest() -> Self {
        let widest = Self::available().next_back().filter(|_| !cfg!(debug_assertions));
        widest.unwrap_or(Self::Portable)
    }
}
