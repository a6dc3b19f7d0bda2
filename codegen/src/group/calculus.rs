//! Derivatives of a group's closed forms.

use super::{Group, Retraction, Side};
use crate::expr::{Arena, Stage, Symbol, Vector, gradient};

/// The symbols of `δ`, and the stored coordinates of `g τ(δ)`, or of `τ(δ) g` as `side` says, for differentiation at
/// `δ = 0`, where every `τ` has the same derivative.
fn neighbourhood<'a>(group: &dyn Group, side: Side, g: &Vector<'a>) -> (Vec<Symbol>, Vector<'a>) {
    let delta = placeholders(g.0[0].arena(), "d", group.dimension());
    let element = group.near(side, g, &delta);
    (delta.symbols(), element)
}

/// The derivative `d/dδ|₀ f(g τ(δ))` of a function with gradient `df` by the stored coordinates of `g`, or with
/// `τ(δ) g` as `side` says: an element of the dual of the algebra, the same for every `τ`.
pub(crate) fn trivialized_gradient<'a>(
    group: &dyn Group,
    side: Side,
    g: &Vector<'a>,
    df: &Vector<'a>,
) -> Vector<'a> {
    let (delta, element) = neighbourhood(group, side, g);
    gradient(df.dot(&element), &delta).at_zero(&delta)
}

/// The perturbation of the stored coordinates where `g` becomes `g τ(δ)`.
pub(crate) fn stored_perturbation<'a>(group: &dyn Group, g: &Vector<'a>, delta: &Vector<'a>) -> Vector<'a> {
    let (symbols, element) = neighbourhood(group, Side::Left, g);
    element.derivative_along(&symbols, delta).at_zero(&symbols)
}

/// `dR τ_x y`, from its dual.
pub(crate) fn d_right<'a>(
    group: &dyn Group,
    retraction: Retraction,
    x: &Vector<'a>,
    y: &Vector<'a>,
) -> Vector<'a> {
    transposed(y, y.len(), |m| group.d_right_dual(retraction, x, m))
}

/// `dL τ_x y = dR τ̄_{−x} y`
pub(crate) fn d_left<'a>(
    group: &dyn Group,
    retraction: Retraction,
    x: &Vector<'a>,
    y: &Vector<'a>,
) -> Vector<'a> {
    d_right(group, retraction.reversed(), &-x, y)
}

/// `Ad_{τ(x)⁻¹} y`, which is `y − dL τ_x [x, y]` where `τ` is equivariant.
pub(crate) fn carried_back<'a>(
    group: &dyn Group,
    retraction: Retraction,
    x: &Vector<'a>,
    y: &Vector<'a>,
) -> Vector<'a> {
    if retraction.is_equivariant() {
        y - &d_left(group, retraction, x, &group.bracket(x, y))
    } else {
        to_body(group, &group.retract(retraction, x), y)
    }
}

/// `Ad_{g⁻¹} x`, from its dual.
pub(crate) fn to_body<'a>(group: &dyn Group, g: &Vector<'a>, x: &Vector<'a>) -> Vector<'a> {
    transposed(x, x.len(), |m| group.to_space(g, m))
}

/// `Aᵀ a` for a linear map `A` of vectors of this dimension.
pub(crate) fn transposed<'a>(
    a: &Vector<'a>,
    dimension: usize,
    map: impl FnOnce(&Vector<'a>) -> Vector<'a>,
) -> Vector<'a> {
    let u = placeholders(a.0[0].arena(), "u", dimension);
    gradient(a.dot(&map(&u)), &u.symbols())
}

/// Symbols to differentiate by, when a formula's argument is not itself a symbol.
pub(crate) fn placeholders<'a>(arena: &'a Arena, name: &str, dimension: usize) -> Vector<'a> {
    Vector((0..dimension).map(|i| arena.symbol(format!("{name}{i}"), Stage::Iteration)).collect())
}
