//! On which side a group acts.

use super::{Group, Retraction};
use crate::expr::Vector;
pub use crate::quantity::Side;

impl Side {
    /// `1` or `−1`: inversion `γ = g⁻¹` turns a right-invariant system into a left-invariant one with velocity `−ξ` and
    /// momentum `−μ`, so that in all that is linear in the momentum the velocity changes its sign.
    pub fn sign(self) -> i64 {
        match self {
            Self::Left => 1,
            Self::Right => -1,
        }
    }

    /// What carries a momentum where `τ(x)` moves the configuration: by `Ad*` of this at [`sign`](Self::sign)` x`. As
    /// `γ τ(x)⁻¹` is `γ τ̄(−x)`, that is `τ` itself or `τ̄`.
    pub fn carrying(self, retraction: Retraction) -> Retraction {
        match self {
            Self::Left => retraction,
            Self::Right => retraction.reversed(),
        }
    }

    /// `g x` or `x g`
    pub fn compose<'a>(self, group: &dyn Group, g: &Vector<'a>, x: &Vector<'a>) -> Vector<'a> {
        match self {
            Self::Left => group.compose(g, x),
            Self::Right => group.compose(x, g),
        }
    }

    /// `g exp(δ)` or `exp(δ) g`, the configuration that is changed by `δ`
    pub fn displaced(self, by: &str) -> String {
        match self {
            Self::Left => format!("g exp({by})"),
            Self::Right => format!("exp({by}) g"),
        }
    }

    /// `in body coordinates` or `in space coordinates`
    pub fn coordinates(self) -> &'static str {
        match self {
            Self::Left => "in body coordinates",
            Self::Right => "in space coordinates",
        }
    }
}
