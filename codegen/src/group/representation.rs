//! Linear spaces that groups act on.

use super::calculus::{placeholders, transposed};
use super::exact::{Rational, RationalMatrix};
use super::{Group, MatrixFunction, Retraction};
use crate::expr::{Arena, Expr, Vector};

/// A linear space `V` on which a group's algebra acts by `ρ`. Advected parameters live in its dual.
pub trait Representation: Sync {
    /// Names and lengths.
    fn names(&self) -> SpaceNames;
    /// The name users write.
    fn name(&self) -> &'static str {
        self.names().name
    }
    /// Suffixes of the coordinates.
    fn coordinates(&self) -> &'static [&'static str] {
        self.names().coordinates
    }
    /// Dimension of the algebra that acts.
    fn algebra_dimension(&self) -> usize {
        self.names().algebra_dimension
    }
    /// `ρ_x v`, the infinitesimal action.
    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a>;
    /// The `V` part `P(x) w` of `f(x, w)` on the semidirect product.
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a>;
    /// `f(x)` acting on `v`.
    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a>;
    /// `g v`, `g` in stored coordinates, where there is a form of it.
    fn act<'a>(&self, _g: &Vector<'a>, _v: &Vector<'a>) -> Option<Vector<'a>> {
        None
    }
    /// Whether a retraction that the group has acts on it.
    fn has(&self, _retraction: Retraction) -> bool {
        true
    }
    /// Whether what a retraction does to it is summed as a series.
    fn is_summed(&self, _retraction: Retraction) -> bool {
        false
    }
    /// Positive where the semidirect product's retraction is a local diffeomorphism if the group's is.
    fn domain<'a>(&self, _retraction: Retraction, _x: &Vector<'a>) -> Vec<Expr<'a>> {
        Vec::new()
    }
    /// The [dual] space where that has forms of its own.
    ///
    /// [dual]: Dual
    fn dual(&self) -> Option<&'static dyn Representation> {
        None
    }
}

/// What a space and its coordinates are called, and what acts on it.
#[derive(Clone, Copy, Debug)]
pub struct SpaceNames {
    /// The name users write.
    pub name: &'static str,
    /// Suffixes of the coordinates.
    pub coordinates: &'static [&'static str],
    /// Dimension of the algebra that acts.
    pub algebra_dimension: usize,
}

/// How a retraction moves along `V` while it rotates it: `P(x) w = body_part + τ(x) rotated_part`.
///
/// For the exponential `P(x) w = φ₁(ρ_x) w`; for Cayley `P(x) w = (1 − ρ_x/2)⁻¹ w = ½ (w + τ(x) w)`: half the way
/// before the rotation, half of it after. In coordinates of the second kind all of it is after the rotation, backwards
/// all of it before.
pub struct Translation<'a> {
    /// What `τ(x)` does not act on.
    pub body_part: Vector<'a>,
    /// The rotated part; a function of `w` alone.
    pub rotated_part: Vector<'a>,
    /// Whether the semidirect product, with this retraction, is the tangent group: `V` is the algebra with its adjoint
    /// action and `τ(x, w)` is the derivative of `τ` at `x` along `w`.
    pub is_tangent_group: bool,
}

impl<'a> Translation<'a> {
    /// All of it before the rotation.
    pub(super) fn before(body_part: Vector<'a>) -> Self {
        let rotated_part = body_part.map(|component| component.arena().zero());
        Self { body_part, rotated_part, is_tangent_group: false }
    }

    /// All of it after the rotation.
    pub(super) fn behind(rotated_part: Vector<'a>) -> Self {
        let Self { body_part, rotated_part, .. } = Self::before(rotated_part);
        Self { body_part: rotated_part, rotated_part: body_part, is_tangent_group: false }
    }

    /// Half of it before the rotation, half of it after, as for Cayley's map.
    pub(super) fn halves(w: &Vector<'a>) -> Self {
        let half = w.map(|component| component / 2);
        Self { body_part: half.clone(), rotated_part: half, is_tangent_group: false }
    }
}

/// The matrices of a representation, one for each axis of the algebra; none if they are not exact.
pub(super) fn matrices_of(space: &dyn Representation) -> Option<Vec<RationalMatrix>> {
    matrices_of_action(space.algebra_dimension(), space.coordinates().len(), |x, v| {
        space.act_infinitesimally(x, v)
    })
}

/// The matrices of a map that is linear in each of its two vectors, one for each coordinate of the first; none if they
/// are not exact.
pub(super) fn matrices_of_action(
    dimension: usize,
    n: usize,
    action: impl for<'a> Fn(&Vector<'a>, &Vector<'a>) -> Vector<'a>,
) -> Option<Vec<RationalMatrix>> {
    let arena = Arena::new();
    let (x, v) = (placeholders(&arena, "x", dimension), placeholders(&arena, "v", n));
    let image = action(&x, &v);
    let entry = |axis: usize, k: usize| {
        let (x, v) = (x.0[axis].as_symbol()?, v.0[k % n].as_symbol()?);
        let (numerator, denominator) = image.0[k / n].derivative(x).derivative(v).as_number()?.fraction()?;
        Some(Rational::new(numerator, denominator))
    };
    let matrix = |axis: usize| {
        let entries: Option<Vec<Rational>> = (0..n * n).map(|k| entry(axis, k)).collect();
        Some(RationalMatrix::new(n, n, entries?))
    };
    (0..x.len()).map(matrix).collect()
}

/// The algebra itself with the adjoint action, `ρ_x v = [x, v]`: the semidirect product is the tangent group.
///
/// Cayley's map does not act on it as a function of `ρ_x`: `Ad_{cay x}` is not `cay ad_x`.
pub struct Adjoint(&'static dyn Group);

impl Adjoint {
    /// That of a group, for as long as the process lives.
    pub fn of(group: &'static dyn Group) -> &'static dyn Representation {
        Box::leak(Box::new(Self(group)))
    }
}

impl Representation for Adjoint {
    fn names(&self) -> SpaceNames {
        named_axes("adjoint", self.0)
    }

    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        self.0.bracket(x, v)
    }

    /// `dR τ_x w`
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        Translation { is_tangent_group: true, ..Translation::before(self.0.closed_d_right(f, x, w)) }
    }

    /// `Ad_{τ(x)} v`
    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        self.0.to_body(&self.0.closed_form(f, &-x), v)
    }

    fn has(&self, retraction: Retraction) -> bool {
        retraction != Retraction::Cayley
    }

    fn dual(&self) -> Option<&'static dyn Representation> {
        Some(Box::leak(Box::new(Coadjoint(self.0))))
    }
}

/// The names of an algebra as a space on which it acts itself.
fn named_axes(name: &'static str, group: &dyn Group) -> SpaceNames {
    SpaceNames { name, coordinates: group.axes(), algebra_dimension: group.dimension() }
}

/// The dual of the algebra with the coadjoint action, `ρ_x m = −ad*_x m`.
struct Coadjoint(&'static dyn Group);

impl Representation for Coadjoint {
    fn names(&self) -> SpaceNames {
        named_axes("coadjoint", self.0)
    }

    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        -&transposed(m, m.len(), |y| self.0.bracket(x, y))
    }

    /// `(dR τ_{−x})* w`
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        Translation::before(self.0.closed_d_right_dual(f, &-x, w))
    }

    /// `Ad*_{τ(x)⁻¹} m`
    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        self.0.to_space(&self.0.closed_form(f, x), m)
    }

    fn has(&self, retraction: Retraction) -> bool {
        retraction != Retraction::Cayley
    }

    fn dual(&self) -> Option<&'static dyn Representation> {
        Some(Adjoint::of(self.0))
    }
}

/// The dual space, `ρ*_x = −ρ_xᵀ`. As `τ(−x) = τ(x)⁻¹` and `P(x)` commutes with `ρ_x`, `P*(x) = P(−x)ᵀ`.
pub struct Dual {
    of: &'static dyn Representation,
    name: &'static str,
}

impl Dual {
    /// That of a space, for as long as the process lives.
    pub fn of(space: &'static dyn Representation) -> &'static dyn Representation {
        let name = || format!("dual({})", space.name()).leak();
        space.dual().unwrap_or_else(|| Box::leak(Box::new(Self { of: space, name: name() })))
    }
}

impl Representation for Dual {
    fn names(&self) -> SpaceNames {
        SpaceNames { name: self.name, ..self.of.names() }
    }

    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        -&transposed(v, v.len(), |u| self.of.act_infinitesimally(x, u))
    }

    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        let back = -x;
        let moved = |u: &Vector<'a>| {
            let Translation { body_part, rotated_part, .. } = self.of.translation(f, &back, u);
            &body_part + &self.of.transport(f, &back, &rotated_part)
        };
        Translation::before(transposed(w, w.len(), moved))
    }

    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        let back = -x;
        transposed(v, v.len(), |u| self.of.transport(f, &back, u))
    }

    fn has(&self, retraction: Retraction) -> bool {
        self.of.has(retraction)
    }

    fn is_summed(&self, retraction: Retraction) -> bool {
        self.of.is_summed(retraction)
    }

    fn domain<'a>(&self, retraction: Retraction, x: &Vector<'a>) -> Vec<Expr<'a>> {
        self.of.domain(retraction, &-x)
    }

    fn dual(&self) -> Option<&'static dyn Representation> {
        Some(self.of)
    }
}
