//! Linear spaces that groups act on.

use super::calculus::{to_body, transposed};
use super::exact::{Rational, RationalMatrix};
use super::{Group, MatrixFunction, Retraction};
use crate::expr::{Arena, Expr, Stage, Vector};

/// A linear space `V` on which a group's algebra acts by `ρ`. Advected parameters live in its dual.
pub trait Representation: Sync {
    /// The name users write.
    fn name(&self) -> &'static str;
    /// Suffixes of the coordinates.
    fn coordinates(&self) -> &'static [&'static str];
    /// Dimension of the algebra that acts.
    fn algebra_dimension(&self) -> usize;
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
    /// The same up to a few terms of series that are not finite sums, if it has such.
    fn coarse(&self) -> Option<&'static dyn Representation> {
        None
    }
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
    let symbols = |name: &str, dimension: usize| {
        Vector((0..dimension).map(|i| arena.symbol(format!("{name}{i}"), Stage::Step)).collect())
    };
    let (x, v) = (symbols("x", dimension), symbols("v", n));
    let image = action(&x, &v);
    let entry = |axis: usize, k: usize| {
        let (x, v) = (x.0[axis].as_symbol()?, v.0[k % n].as_symbol()?);
        let (numerator, denominator) = image.0[k / n].derivative(x).derivative(v).as_number()?.fraction()?;
        Some(Rational::new(numerator, denominator))
    };
    let matrix = |axis: usize| {
        let entries: Option<Vec<Rational>> = (0..n * n).map(|k| entry(axis, k)).collect();
        Some(RationalMatrix { rows: n, columns: n, entries: entries? })
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
    fn name(&self) -> &'static str {
        "adjoint"
    }

    fn coordinates(&self) -> &'static [&'static str] {
        self.0.axes()
    }

    fn algebra_dimension(&self) -> usize {
        self.0.dimension()
    }

    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        self.0.bracket(x, v)
    }

    /// `dR τ_x w`
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        Translation {
            body_part: self.0.closed_d_right(f, x, w),
            rotated_part: Vector::zeros(x.0[0].arena(), w.len()),
            is_tangent_group: true,
        }
    }

    /// `Ad_{τ(x)} v`
    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        to_body(self.0, &self.0.closed_form(f, &-x), v)
    }

    fn has(&self, retraction: Retraction) -> bool {
        retraction != Retraction::Cayley
    }

    fn dual(&self) -> Option<&'static dyn Representation> {
        Some(Box::leak(Box::new(Coadjoint(self.0))))
    }

    fn coarse(&self) -> Option<&'static dyn Representation> {
        self.0.coarse().map(Self::of)
    }
}

/// The dual of the algebra with the coadjoint action, `ρ_x m = −ad*_x m`.
struct Coadjoint(&'static dyn Group);

impl Representation for Coadjoint {
    fn name(&self) -> &'static str {
        "coadjoint"
    }

    fn coordinates(&self) -> &'static [&'static str] {
        self.0.axes()
    }

    fn algebra_dimension(&self) -> usize {
        self.0.dimension()
    }

    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        -&transposed(m, m.len(), |y| self.0.bracket(x, y))
    }

    /// `(dR τ_{−x})* w`
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        Translation {
            body_part: self.0.closed_d_right_dual(f, &-x, w),
            rotated_part: Vector::zeros(x.0[0].arena(), w.len()),
            is_tangent_group: false,
        }
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

    fn coarse(&self) -> Option<&'static dyn Representation> {
        Adjoint(self.0.coarse()?).dual()
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
    fn name(&self) -> &'static str {
        self.name
    }

    fn coordinates(&self) -> &'static [&'static str] {
        self.of.coordinates()
    }

    fn algebra_dimension(&self) -> usize {
        self.of.algebra_dimension()
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
        Translation {
            body_part: transposed(w, w.len(), moved),
            rotated_part: Vector::zeros(x.0[0].arena(), w.len()),
            is_tangent_group: false,
        }
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

    fn coarse(&self) -> Option<&'static dyn Representation> {
        self.of.coarse().map(Self::of)
    }
}
