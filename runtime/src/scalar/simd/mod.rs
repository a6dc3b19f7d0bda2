//! Numbers side by side, the instructions for them, and loads of a given width: the only code that is not checked.
//!
//! What it relies on is sealed: [`Batch`](crate::scalar::Batch) numbers, arrays as [`Components`](crate::scalar::Components), and processors
//! that are named nowhere but where it was looked whether the program runs on one.

#[cfg(feature = "dynamic")]
pub(crate) mod frame;
#[cfg_attr(
    not(feature = "std"),
    allow(dead_code, reason = "without std there are kinds of processors, but no lanes")
)]
pub(crate) mod lanes;
pub(crate) mod loads;
#[cfg(feature = "dynamic")]
pub(crate) mod march;
#[cfg(all(feature = "std", target_arch = "x86_64"))]
pub(crate) mod processor;
