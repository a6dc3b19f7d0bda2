//! The commands of the program, one file each.

#[cfg(feature = "bench")]
pub(crate) mod bench;
pub(crate) mod certify;
pub(crate) mod ensemble;
pub(crate) mod figures;
pub(crate) mod list;
pub(crate) mod paper;
pub(crate) mod run;
pub(crate) mod show;
