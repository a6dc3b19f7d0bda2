//! Derivatives of a group's closed forms.

use super::{Group, Retraction, Side};
use crate::expr::{Arena, Stage, Symbol, Vector, gradient};

impl dyn Group + '_ {
    /// The symbols of `δ`, and the stored coordinates of `g τ(δ)`, or of `τ(δ) g` as `side` says, for differentiation
    /// at `δ = 0`, where every `τ` has the same derivative.
    fn neighbourhood<'a>(&self, side: Side, g: &Vector<'a>) -> (Vec<Symbol>, Vector<'a>) {
        let delta = placeholders(g.0[0].arena(), "d", self.dimension());
        let element = self.near(side, g, &delta);
        (delta.symbols(), element)
    }

    /// The derivative `d/dδ|₀ f(g τ(δ))` of a function with gradient `df` by the stored coordinates of `g`, or with
    /// `τ(δ) g` as `side` says: an element of the dual of the algebra, the same for every `τ`.
    pub(super) fn trivialized_gradient<'a>(&self, side: Side, g: &Vector<'a>, df: &Vector<'a>) -> Vector<'a> {
        let (delta, element) = self.neighbourhood(side, g);
        gradient(df.dot(&element), &delta).at_zero(&delta)
    }

    /// The perturbation of the stored coordinates where `g` becomes `g τ(δ)`, or `τ(δ) g` as `side` says.
    pub(super) fn stored_perturbation<'a>(
        &self,
        side: Side,
        g: &Vector<'a>,
        delta: &Vector<'a>,
    ) -> Vector<'a> {
        let (symbols, element) = self.neighbourhood(side, g);
        element.derivative_along(&symbols, delta).at_zero(&symbols)
    }

    /// `dR τ_x y`, from its dual.
    pub(super) fn d_right<'a>(&self, retraction: Retraction, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        transposed(y, y.len(), |m| self.d_right_dual(retraction, x, m))
    }

    /// `dL τ_x y = dR τ̄_{−x} y`
    pub(super) fn d_left<'a>(&self, retraction: Retraction, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        self.d_right(retraction.reversed(), &-x, y)
    }

    /// `Ad_{τ(x)⁻¹} y`, which is `y − dL τ_x [x, y]` where `τ` is equivariant.
    pub(super) fn carried_back<'a>(
        &self,
        retraction: Retraction,
        x: &Vector<'a>,
        y: &Vector<'a>,
    ) -> Vector<'a> {
        if retraction.is_equivariant() {
            y - &self.d_left(retraction, x, &self.bracket(x, y))
        } else {
            self.to_body(&self.retract(retraction, x), y)
        }
    }

    /// `Ad_{g⁻¹} x`, from its dual.
    pub(super) fn to_body<'a>(&self, g: &Vector<'a>, x: &Vector<'a>) -> Vector<'a> {
        transposed(x, x.len(), |m| self.to_space(g, m))
    }
}

/// `Aᵀ a` for a linear map `A` of vectors of this dimension.
pub(super) fn transposed<'a>(
    a: &Vector<'a>,
    dimension: usize,
    map: impl FnOnce(&Vector<'a>) -> Vector<'a>,
) -> Vector<'a> {
    let u = placeholders(a.0[0].arena(), "u", dimension);
    gradient(a.dot(&map(&u)), &u.symbols())
}

/// Symbols to differentiate by, when a formula's argument is not itself a symbol.
pub(super) fn placeholders<'a>(arena: &'a Arena, name: &str, dimension: usize) -> Vector<'a> {
    Vector((0..dimension).map(|i| arena.symbol(format!("{name}{i}"), Stage::Iteration)).collect())
}
