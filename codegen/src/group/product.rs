//! The group of a system: a direct product, each factor with the spaces that it acts on.
//!
//! An element of the group has what each factor's has, one after the other; so has one of the algebra or of its dual,
//! and so have the spaces. Factors do not act on each other: everything is theirs, each by itself. They meet in a
//! system's energy and forces alone.

use std::ops::Range;

use super::{Moved, Retraction, Semidirect, SemidirectVector, Side};
use crate::expr::{Expr, Vector};

/// A product of groups.
#[derive(Clone)]
pub struct Product {
    /// The factors, each with its spaces.
    pub factors: Vec<Semidirect>,
}

/// Where the parts of a factor stand.
#[derive(Clone)]
pub struct Place {
    /// In the algebra and its dual.
    pub algebra: Range<usize>,
    /// Among the stored coordinates.
    pub stored: Range<usize>,
    /// Among the spaces.
    pub spaces: Range<usize>,
}

impl Place {
    /// What an element of the algebra or of its dual has for the factor.
    pub fn algebra<'a>(&self, x: &Vector<'a>) -> Vector<'a> {
        x.part(self.algebra.clone())
    }

    /// What an element of the group has for the factor.
    pub fn stored<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        g.part(self.stored.clone())
    }

    /// The part in the spaces of the factor.
    pub fn spaces<'v, 'a>(&self, a: &'v [Vector<'a>]) -> &'v [Vector<'a>] {
        &a[self.spaces.clone()]
    }

    /// What an element of the semidirect algebra or of its dual has for the factor.
    pub fn semidirect<'a>(&self, m: &SemidirectVector<'a>) -> SemidirectVector<'a> {
        SemidirectVector { base: self.algebra(&m.base), spaces: self.spaces(&m.spaces).to_vec() }
    }
}

impl Product {
    /// The factors and where their parts stand.
    pub fn parts(&self) -> impl Iterator<Item = (&Semidirect, Place)> {
        let mut place = Place { algebra: 0..0, stored: 0..0, spaces: 0..0 };
        self.factors.iter().map(move |factor| {
            let next = |range: &Range<usize>, length: usize| range.end..range.end + length;
            place = Place {
                algebra: next(&place.algebra, factor.group.dimension()),
                stored: next(&place.stored, factor.group.coordinates().len()),
                spaces: next(&place.spaces, factor.spaces.len()),
            };
            (factor, place.clone())
        })
    }

    /// Where the parts of each factor stand.
    pub fn places(&self) -> Vec<Place> {
        self.parts().map(|(_, place)| place).collect()
    }

    /// Applies a map to each factor, one after the other.
    fn each<'a>(&self, of: impl Fn(&Semidirect, &Place) -> Vector<'a>) -> Vector<'a> {
        Vector(self.parts().flat_map(|(factor, place)| of(factor, &place).0).collect())
    }

    /// Applies a map to each factor's spaces.
    fn each_space<'a>(&self, of: impl Fn(&Semidirect, &Place) -> Vec<Vector<'a>>) -> Vec<Vector<'a>> {
        self.parts().flat_map(|(factor, place)| of(factor, &place)).collect()
    }

    /// Applies a map to each factor's semidirect algebra, or the dual of it.
    fn each_semidirect<'a>(
        &self,
        of: impl Fn(&Semidirect, &Place) -> SemidirectVector<'a>,
    ) -> SemidirectVector<'a> {
        let (mut base, mut spaces) = (Vec::new(), Vec::new());
        for (factor, place) in self.parts() {
            let part = of(factor, &place);
            base.extend(part.base.0);
            spaces.extend(part.spaces);
        }
        SemidirectVector { base: Vector(base), spaces }
    }

    /// Dimension of the algebra.
    pub fn dimension(&self) -> usize {
        self.factors.iter().map(|factor| factor.group.dimension()).sum()
    }

    /// The lengths of the blocks of coordinates of the algebra that have a unit in common.
    pub fn blocks(&self) -> Vec<usize> {
        self.factors.iter().flat_map(|factor| factor.group.blocks()).collect()
    }

    /// Whether the group is a vector space.
    pub fn is_linear(&self) -> bool {
        self.factors.iter().all(|factor| factor.group.is_linear())
    }

    /// Whether there are steps with a retraction.
    pub fn has(&self, retraction: Retraction) -> bool {
        self.factors.iter().all(|factor| factor.has(retraction))
    }

    /// Whether a retraction is summed as a series, term by term.
    pub fn is_summed(&self, retraction: Retraction) -> bool {
        self.factors.iter().any(|factor| factor.is_summed(retraction))
    }

    /// For each factor the number `k` for which its unknown is `η/k`.
    pub fn unknown_scales(&self, retraction: Retraction) -> Vec<i128> {
        self.factors.iter().map(|factor| factor.group.unknown_scale(retraction)).collect()
    }

    /// Positive, all of them, where the retraction is a local diffeomorphism.
    pub fn domain<'a>(&self, retraction: Retraction, x: &Vector<'a>) -> Vec<Expr<'a>> {
        self.parts().flat_map(|(factor, place)| factor.domain(retraction, &place.algebra(x))).collect()
    }

    /// Each factor's part times its own number.
    pub fn multiplied<'a>(&self, x: &Vector<'a>, by: &[Expr<'a>]) -> Vector<'a> {
        let parts = self.parts().zip(by);
        Vector(parts.flat_map(|((_, place), &by)| place.algebra(x).scale(by).0).collect())
    }

    /// Each factor's part times its own number, in the spaces too.
    pub fn all_multiplied<'a>(&self, m: &SemidirectVector<'a>, by: &[Expr<'a>]) -> SemidirectVector<'a> {
        let spaces = self.parts().zip(by).flat_map(|((_, place), &by)| {
            place.spaces(&m.spaces).iter().map(move |a| a.scale(by)).collect::<Vec<_>>()
        });
        SemidirectVector { base: self.multiplied(&m.base, by), spaces: spaces.collect() }
    }
}

/// On the group.
impl Product {
    /// `τ(x)`
    pub fn retract<'a>(&self, retraction: Retraction, x: &Vector<'a>) -> Vector<'a> {
        self.each(|factor, place| factor.group.retract(retraction, &place.algebra(x)))
    }

    /// `g h`, on the other side `h g`.
    pub fn compose<'a>(&self, side: Side, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a> {
        self.each(|factor, place| side.compose(factor.group, &place.stored(g), &place.stored(h)))
    }

    /// `g⁻¹`
    pub fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        self.each(|factor, place| factor.group.inverse(&place.stored(g)))
    }

    /// `g τ(x)`, on the other side `τ(x) g`.
    pub fn moved<'a>(&self, side: Side, retraction: Retraction, g: &Vector<'a>, x: &Vector<'a>) -> Moved<'a> {
        let parts = self.parts();
        let parts = parts
            .map(|(factor, place)| factor.group.moved(side, retraction, &place.stored(g), &place.algebra(x)));
        let parts: Vec<Moved<'a>> = parts.collect();
        Moved {
            increment: Vector::concat(parts.iter().map(|part| &part.increment)),
            moved: Vector::concat(parts.iter().map(|part| &part.moved)),
            next: Vector::concat(parts.iter().map(|part| &part.next)),
        }
    }

    /// The defect of an element, for those factors that are not on it by the type of what is stored.
    pub fn deviation<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let parts = self.parts().filter_map(|(factor, place)| factor.group.deviation(&place.stored(g)));
        Vector(parts.flat_map(|part| part.0).collect())
    }

    /// `d/dδ|₀ f(g τ(δ))` of a function with gradient `df` by the stored coordinates, on the other side with `τ(δ) g`.
    pub fn trivialized_gradient<'a>(&self, side: Side, g: &Vector<'a>, df: &Vector<'a>) -> Vector<'a> {
        self.each(|factor, place| {
            factor.group.trivialized_gradient(side, &place.stored(g), &place.stored(df))
        })
    }

    /// The perturbation of the stored coordinates where `g` becomes `g τ(δ)`, on the other side `τ(δ) g`.
    pub fn stored_perturbation<'a>(&self, side: Side, g: &Vector<'a>, delta: &Vector<'a>) -> Vector<'a> {
        self.each(|factor, place| {
            factor.group.stored_perturbation(side, &place.stored(g), &place.algebra(delta))
        })
    }
}

/// On the algebra, its dual and the spaces.
impl Product {
    /// `dL τ_x y`
    pub fn d_left<'a>(&self, retraction: Retraction, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        self.each(|factor, place| factor.group.d_left(retraction, &place.algebra(x), &place.algebra(y)))
    }

    /// `dR τ_x y`
    pub fn d_right<'a>(&self, retraction: Retraction, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        self.each(|factor, place| factor.group.d_right(retraction, &place.algebra(x), &place.algebra(y)))
    }

    /// `Ad_{τ(x)⁻¹} y`
    pub fn carried_back<'a>(&self, retraction: Retraction, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        self.each(|factor, place| factor.group.carried_back(retraction, &place.algebra(x), &place.algebra(y)))
    }

    /// `Ad_{g⁻¹} x`
    pub fn to_body<'a>(&self, g: &Vector<'a>, x: &Vector<'a>) -> Vector<'a> {
        self.each(|factor, place| factor.group.to_body(&place.stored(g), &place.algebra(x)))
    }

    /// `Ad*_{g⁻¹} m`
    pub fn to_space<'a>(&self, g: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        self.each(|factor, place| factor.group.to_space(&place.stored(g), &place.algebra(m)))
    }

    /// `(dR τ_(x,w))* (m, a)`
    pub fn d_right_dual<'a>(
        &self,
        retraction: Retraction,
        xi: &SemidirectVector<'a>,
        mu: &SemidirectVector<'a>,
    ) -> SemidirectVector<'a> {
        self.each_semidirect(|factor, place| {
            factor.d_right_dual(retraction, &place.semidirect(xi), &place.semidirect(mu))
        })
    }

    /// `P(x)ᵀ a` for each space: the `V*` part of `(dR τ_(x,w))* (m, a)`.
    pub fn d_right_dual_spaces<'a>(
        &self,
        retraction: Retraction,
        x: &Vector<'a>,
        a: &[Vector<'a>],
    ) -> Vec<Vector<'a>> {
        self.each_space(|factor, place| {
            factor.d_right_dual_spaces(retraction, &place.algebra(x), place.spaces(a))
        })
    }

    /// `Ad*_{τ(x, w)} (m, a)`, with `mean = (dR τ_(x,w))* (m, a)`.
    pub fn carry_momentum<'a>(
        &self,
        retraction: Retraction,
        xi: &SemidirectVector<'a>,
        mu: &SemidirectVector<'a>,
        mean: &SemidirectVector<'a>,
    ) -> SemidirectVector<'a> {
        self.each_semidirect(|factor, place| {
            let [xi, mu, mean] = [xi, mu, mean].map(|whole| place.semidirect(whole));
            factor.carry_momentum(retraction, &xi, &mu, &mean)
        })
    }

    /// `m − Σ J(p, a)`, the part of `Ad*_{exp(p)} (m, a)` in the dual of the algebra.
    pub fn shifted<'a>(&self, m: &Vector<'a>, p: &[Vector<'a>], a: &[Vector<'a>]) -> Vector<'a> {
        self.each(|factor, place| factor.shifted(&place.algebra(m), place.spaces(p).iter(), place.spaces(a)))
    }

    /// `Ad*_{τ(x)} a` for each space, with `mean = P(x)ᵀ a`.
    pub fn carry_all<'a>(
        &self,
        retraction: Retraction,
        x: &Vector<'a>,
        a: &[Vector<'a>],
        mean: &[Vector<'a>],
    ) -> Vec<Vector<'a>> {
        self.each_space(|factor, place| {
            factor.carry_all(retraction, &place.algebra(x), place.spaces(a), place.spaces(mean))
        })
    }

    /// `Ad*_{τ(x)} a` for each space.
    pub fn carry<'a>(&self, retraction: Retraction, x: &Vector<'a>, a: &[Vector<'a>]) -> Vec<Vector<'a>> {
        self.each_space(|factor, place| factor.carry(retraction, &place.algebra(x), place.spaces(a)))
    }

    /// `ad*_(x,w) (m, a)`
    pub fn coadjoint<'a>(
        &self,
        xi: &SemidirectVector<'a>,
        mu: &SemidirectVector<'a>,
    ) -> SemidirectVector<'a> {
        self.each_semidirect(|factor, place| factor.coadjoint(&place.semidirect(xi), &place.semidirect(mu)))
    }

    /// The `V*` part of `ad*_(x,w) (m, a)`, which depends on `x` and `a` alone.
    pub fn coadjoint_spaces<'a>(&self, x: &Vector<'a>, a: &[Vector<'a>]) -> Vec<Vector<'a>> {
        self.each_space(|factor, place| factor.coadjoint_spaces(&place.algebra(x), place.spaces(a)))
    }
}

/// Ranges of these lengths, one after the other.
pub(crate) fn consecutive(lengths: impl IntoIterator<Item = usize>) -> Vec<Range<usize>> {
    let mut end = 0;
    let range = |length: usize| {
        end += length;
        end - length..end
    };
    lengths.into_iter().map(range).collect()
}
