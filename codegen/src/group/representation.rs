//! Linear spaces that groups act on.

use super::{MatrixFunction, StorageType};
use crate::expr::Vector;

/// A linear space `V` on which a group's algebra acts by `ρ`. Advected parameters live in its dual.
pub trait Representation: Sync {
    /// The name users write.
    fn name(&self) -> &'static str;
    /// The type an element is stored as.
    fn storage(&self) -> StorageType;
    /// Suffixes of the coordinates.
    fn coordinates(&self) -> &'static [&'static str];
    /// Dimension of the algebra that acts.
    fn algebra_dimension(&self) -> usize;
    /// `ρ_x v`, the infinitesimal action.
    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a>;
    /// The `V` part `P(x) w` of `f(x, w)` on the semidirect product.
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a>;
    /// `g v`, `g` in stored coordinates.
    fn act<'a>(&self, g: &Vector<'a>, v: &Vector<'a>) -> Vector<'a>;
    /// `f(x)` acting on `v`.
    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a>;
}

/// How a retraction moves along `V` while it rotates it: `P(x) w = body_part + τ(x) rotated_part`.
///
/// For the exponential `P(x) w = φ₁(ρ_x) w`; for Cayley `P(x) w = (1 − ρ_x/2)⁻¹ w = ½ (w + τ(x) w)`: half the way before the
/// rotation, half of it after. In coordinates of the second kind all of it is after the rotation, backwards all of it before.
pub struct Translation<'a> {
    /// What `τ(x)` does not act on.
    pub body_part: Vector<'a>,
    /// What it acts on; a function of `w` alone.
    pub rotated_part: Vector<'a>,
    /// Whether the semidirect product, with this retraction, is the tangent group: `V` is the algebra with its adjoint action
    /// and `τ(x, w)` is the derivative of `τ` at `x` along `w`.
    pub is_tangent_group: bool,
}
