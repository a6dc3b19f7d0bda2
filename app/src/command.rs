//! The commands of the program, one file each.

pub(crate) mod certify;
pub(crate) mod ensemble;
pub(crate) mod init;
pub(crate) mod list;
pub(crate) mod play;
pub(crate) mod run;
#[cfg(feature = "show")]
pub(crate) mod show;
