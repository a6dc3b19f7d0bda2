//! The commands that this program has beside those of every other.

pub(crate) mod bench;
pub(crate) mod figures;
pub(crate) mod paper;
