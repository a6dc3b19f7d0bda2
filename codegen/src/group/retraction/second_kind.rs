//! Canonical coordinates of the second kind: `τ(x) = exp(x₁E₁) exp(x₂E₂) ⋯ exp(x_d E_d)`, along the axes of the algebra
//! in their order. (B. Owren and A. Marthinsen, *Integration methods based on canonical coordinates of the second
//! kind*, Numerische Mathematik 87, 2001.)
//!
//! For any group, from its exponential along one axis alone. With `g_i = exp(x_iE_i)` the columns of `dR τ_x` are
//! `Ad_{g₁ ⋯ g_{i−1}} E_i`, so that one pass of `m_i = Ad*_{g_i} m_{i−1}` from `m₀ = m` has all that a step needs: the
//! components `((dR τ_x)* m)_i = (m_{i−1})_i`, and `Ad*_{τ(x)} m = m_d` at its end.
//!
//! The map is not odd: `τ̄(x) = τ(−x)⁻¹` has the factors in the opposite order. Nor is it `Ad`-equivariant.
//!
//! On a semidirect product `G ⋉ V` the space's axes come after the group's, `τ(x, w) = τ(x) exp(w)`, and backwards
//! before them. For SE(2) and SE(3), which are such products, these are the coordinates of the second kind along all of
//! their axes.

use super::Composite;
use crate::expr::{Expr, Number, Vector};
use crate::group::{Group, MatrixFunction, Representation, Translation};

/// The documentation of its type.
pub(super) const DOC: &str = "\
Canonical coordinates of the second kind, `τ(ξ) = exp(ξ₁E₁) exp(ξ₂E₂) ⋯`: turns and shifts along the axes of the algebra, one after the
other. (B. Owren and A. Marthinsen, *Integration methods based on canonical coordinates of the second kind*, 2001.)

Neither odd nor `Ad`-equivariant. Steps with it are Poisson maps that keep the Casimirs, and the adjoint of the member `s` of the
[family](coadjoint::Family) is `1 − s`, as with any retraction; but only `s = ½` is symmetric and of order 2, on left-invariant systems
too. The bare retraction is therefore [`StormerVerlet`](coadjoint::StormerVerlet) for every system. On SO(3) the second turn must be
less than a quarter. To compare with: generated where a description asks for it by `retractions(SecondKind)`.";

/// The product in one order of the axes.
pub(super) struct SecondKind {
    descending: bool,
}

/// From the first axis to the last one.
pub(super) static ASCENDING: SecondKind = SecondKind { descending: false };
/// From the last axis to the first one.
pub(super) static DESCENDING: SecondKind = SecondKind { descending: true };

impl SecondKind {
    /// The axes in the order in which their one-parameter groups are multiplied, each with `exp(x_iE_i)`.
    fn factors<'a>(&self, group: &dyn Group, x: &Vector<'a>) -> Vec<(usize, Vector<'a>)> {
        let factor = |axis| (axis, group.closed_form(MatrixFunction::Exponential, &along(x, axis)).hold());
        let mut factors: Vec<_> = (0..x.len()).map(factor).collect();
        if self.descending {
            factors.reverse();
        }
        factors
    }

    /// `(dR τ_x)* m` and `Ad*_{τ(x)} m`.
    fn pass<'a>(&self, group: &dyn Group, x: &Vector<'a>, m: &Vector<'a>) -> (Vector<'a>, Vector<'a>) {
        let (mut dual, mut carried) = (m.clone(), m.clone());
        for (axis, factor) in self.factors(group, x) {
            dual.0[axis] = carried.0[axis];
            carried = group.to_space(&group.inverse(&factor), &carried).hold();
        }
        (dual, carried)
    }
}

impl Composite for SecondKind {
    fn retract<'a>(&self, group: &dyn Group, x: &Vector<'a>) -> Vector<'a> {
        let factors = self.factors(group, x).into_iter().map(|(_, factor)| factor);
        let product = factors.reduce(|product, factor| group.compose(&product, &factor).hold());
        // an algebra has an axis
        product.unwrap_or_else(|| x.clone())
    }

    fn d_right_dual<'a>(&self, group: &dyn Group, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        self.pass(group, x, m).0
    }

    fn coadjoint<'a>(&self, group: &dyn Group, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        self.pass(group, x, m).1
    }

    fn transport<'a>(
        &self,
        group: &dyn Group,
        space: &dyn Representation,
        x: &Vector<'a>,
        v: &Vector<'a>,
    ) -> Vector<'a> {
        let turned = |v: Vector<'a>, (axis, factor): (usize, Vector<'a>)| {
            let by_series = || space.transport(MatrixFunction::Exponential, &along(x, axis), &v);
            space.act(&factor, &v).unwrap_or_else(by_series).hold()
        };
        self.factors(group, x).into_iter().rev().fold(v.clone(), turned)
    }

    fn translation<'a>(&self, w: &Vector<'a>) -> Translation<'a> {
        if self.descending { Translation::before(w.clone()) } else { Translation::behind(w.clone()) }
    }

    fn is_for(&self, group: &dyn Group) -> bool {
        group.matrix_rows().is_none()
    }

    /// Turns of space about one axis after the other: where the second one is a quarter turn, the third axis lies along
    /// the first.
    fn domain<'a>(&self, group: &dyn Group, x: &Vector<'a>) -> Vec<Expr<'a>> {
        let turns_in_space = group.names().unit_coordinates == 4;
        if !turns_in_space {
            return Vec::new();
        }
        let quarter = Number::FOUR_PI_SQUARED * Number::ratio(1, 16);
        vec![x.0[0].arena().number(quarter) - x.0[1] * x.0[1]]
    }
}

/// `x` along one axis alone.
fn along<'a>(x: &Vector<'a>, axis: usize) -> Vector<'a> {
    let mut part = x.map(|component| component.arena().zero());
    part.0[axis] = x.0[axis];
    part
}
