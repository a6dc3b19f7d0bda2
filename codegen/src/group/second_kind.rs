//! Canonical coordinates of the second kind: `τ(x) = exp(x₁E₁) exp(x₂E₂) ⋯ exp(x_d E_d)`, along the axes of the algebra in their order.
//! (B. Owren and A. Marthinsen, *Integration methods based on canonical coordinates of the second kind*, Numerische Mathematik 87, 2001.)
//!
//! For any group, from its exponential along one axis alone. With `g_i = exp(x_iE_i)` the columns of `dR τ_x` are
//! `Ad_{g₁ ⋯ g_{i−1}} E_i`, so that one pass of `m_i = Ad*_{g_i} m_{i−1}` from `m₀ = m` has all that a step needs: the components
//! `((dR τ_x)* m)_i = (m_{i−1})_i`, and `Ad*_{τ(x)} m = m_d` at its end.
//!
//! The map is not odd: `τ̄(x) = τ(−x)⁻¹` has the factors in the opposite [`Order`]. Nor is it `Ad`-equivariant.
//!
//! On a semidirect product `G ⋉ V` the space's axes come after the group's, `τ(x, w) = τ(x) exp(w)`, and backwards before them. For SE(2) and
//! SE(3), which are such products, these are the coordinates of the second kind along all of their axes.

use super::{Group, MatrixFunction, Order, Representation};
use crate::expr::Vector;

/// The axes in the order in which their one-parameter groups are multiplied, each with `exp(x_iE_i)`.
fn factors<'a, G: Group + ?Sized>(group: &G, order: Order, x: &Vector<'a>) -> Vec<(usize, Vector<'a>)> {
    let factor = |axis| (axis, group.closed_form(MatrixFunction::Exponential, &along(x, axis)).hold());
    let mut factors: Vec<_> = (0..x.len()).map(factor).collect();
    if order == Order::Descending {
        factors.reverse();
    }
    factors
}

/// `τ(x)`
pub(super) fn retract<'a, G: Group + ?Sized>(group: &G, order: Order, x: &Vector<'a>) -> Vector<'a> {
    let factors = factors(group, order, x).into_iter().map(|(_, factor)| factor);
    let product = factors.reduce(|product, factor| group.compose(&product, &factor).hold());
    // an algebra has an axis
    product.unwrap_or_else(|| x.clone())
}

/// `(dR τ_x)* m` and `Ad*_{τ(x)} m`.
fn pass<'a, G: Group + ?Sized>(
    group: &G,
    order: Order,
    x: &Vector<'a>,
    m: &Vector<'a>,
) -> (Vector<'a>, Vector<'a>) {
    let (mut dual, mut carried) = (m.clone(), m.clone());
    for (axis, factor) in factors(group, order, x) {
        dual.0[axis] = carried.0[axis];
        carried = group.to_space(&group.inverse(&factor), &carried).hold();
    }
    (dual, carried)
}

/// `(dR τ_x)* m`
pub(super) fn d_right_dual<'a, G: Group + ?Sized>(
    group: &G,
    order: Order,
    x: &Vector<'a>,
    m: &Vector<'a>,
) -> Vector<'a> {
    pass(group, order, x, m).0
}

/// `Ad*_{τ(x)} m`
pub(super) fn coadjoint<'a, G: Group + ?Sized>(
    group: &G,
    order: Order,
    x: &Vector<'a>,
    m: &Vector<'a>,
) -> Vector<'a> {
    pass(group, order, x, m).1
}

/// `τ(x)` acting on a vector `v` of one of the group's spaces.
pub(super) fn transport<'a>(
    group: &dyn Group,
    order: Order,
    space: &dyn Representation,
    x: &Vector<'a>,
    v: &Vector<'a>,
) -> Vector<'a> {
    let turned = |v: Vector<'a>, (axis, factor): (usize, Vector<'a>)| {
        let by_series = || space.transport(MatrixFunction::Exponential, &along(x, axis), &v);
        space.act(&factor, &v).unwrap_or_else(by_series).hold()
    };
    factors(group, order, x).into_iter().rev().fold(v.clone(), turned)
}

/// `x` along one axis alone.
fn along<'a>(x: &Vector<'a>, axis: usize) -> Vector<'a> {
    let mut part = x.map(|component| component.arena().zero());
    part.0[axis] = x.0[axis];
    part
}
