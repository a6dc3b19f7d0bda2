//! Kinds of processors that code is compiled for besides the one that the program is built for. Which of them it runs on is found out when it
//! runs.
#![allow(unsafe_code, reason = "functions compiled for a processor must not be called on another")]

use crate::lanes::Processor;
use crate::scalar::Work;

macro_rules! processors {
    ($($(#[$doc:meta])* $name:ident, $function:ident, aligned $alignment:ident $bytes:literal, $first:tt $(, $feature:tt)*;)*) => {
        $(
            $(#[$doc])*
            ///
            /// Only to be named where [`is_here`](Self::is_here), which is why this is not public.
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub(crate) struct $name;

            impl $name {
                /// Whether the program runs on such a processor.
                pub(crate) fn is_here() -> bool {
                    std::is_x86_feature_detected!($first) $(&& std::is_x86_feature_detected!($feature))*
                }
            }

            #[target_feature(enable = $first $(, enable = $feature)*)]
            #[inline(never)]
            fn $function<W: Work>(work: W) -> W::Result {
                work.done()
            }

            /// As wide as a register.
            #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
            #[repr(align($bytes))]
            pub(crate) struct $alignment;

            impl Processor for $name {
                type Alignment = $alignment;

                #[inline(always)]
                fn outline<W: Work>(work: W) -> W::Result {
                    debug_assert!(Self::is_here());
                    // SAFETY: the type is named nowhere but where it was looked whether the processor is of the kind
                    unsafe { $function(work) }
                }
            }
        )*
    };
}
processors! {
    /// x86-64 with four doubles in a register.
    Avx2, avx2, aligned Bytes32 32, "avx2";
    /// x86-64 with eight doubles in a register.
    Avx512, avx512, aligned Bytes64 64, "avx512f", "avx512dq", "avx512vl";
}
