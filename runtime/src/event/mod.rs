//! Events.

pub(crate) mod roots;
pub(crate) mod search;

/// How a quantity meets zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// From below to above.
    Rising,
    /// From above to below.
    Falling,
    /// It touches zero, and does not change its sign.
    Touch,
}
