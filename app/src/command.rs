//! The commands of the program, one file each.

pub(crate) mod certify;
pub(crate) mod ensemble;
pub(crate) mod init;
pub(crate) mod list;
#[cfg(feature = "manual")]
pub(crate) mod manual;
pub(crate) mod motion;
pub(crate) mod play;
pub(crate) mod run;
mod scan;
#[cfg(feature = "show")]
pub(crate) mod show;
