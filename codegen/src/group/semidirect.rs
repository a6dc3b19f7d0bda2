//! Semidirect products `G ⋉ (V₁ ⊕ … ⊕ V_k)`: what advected parameters make of a group.
//!
//! Nothing here is a closed form of any one group: logarithmic derivative and coadjoint action are derived from the
//! group's and the representations' by differentiation.
//!
//! With `τ(x, w) = (τ(x), P(x) w)` the right logarithmic derivative is
//! `dR τ_(x,w)(y, u) = (r, D_x[P(x) w] y + P(x) u − ρ_r P(x) w)`, `r = dR τ_x y`: the derivative of the translation,
//! less what carrying it back by `τ(x, w)⁻¹` takes. With `P(x) w = f(x) + τ(x) e` the derivative of `τ(x) e` is
//! `ρ_r τ(x) e` by the very definition of `r`, which cancels, and `D_x f(x) y − ρ_r f(x)` remains.
//!
//! As `τ(x, w) = exp(f) τ(x) exp(e)`, so is the coadjoint action; where `τ` is equivariant,
//! `Ad*_τ m = m + ad* (dR τ)* m` is shorter. In coordinates of the second kind the spaces' axes come after the group's:
//! `f = 0`, `e = w`, and backwards `f = w`, `e = 0`.

use super::calculus::{placeholders, transposed};
use super::{Group, Law, Representation, Retraction, Translation};
use crate::expr::{Expr, Vector, gradient};

/// A group together with the spaces its advected parameters live in.
#[derive(Clone)]
pub struct Semidirect {
    /// `G`
    pub group: &'static dyn Group,
    /// `V₁, …, V_k`
    pub spaces: Vec<&'static dyn Representation>,
}

/// An element of the semidirect algebra `(x, w₁, …)` or of its dual `(m, a₁, …)`.
#[derive(Clone)]
pub struct SemidirectVector<'a> {
    /// `x` or `m`
    pub base: Vector<'a>,
    /// `w₁, …` or `a₁, …`
    pub spaces: Vec<Vector<'a>>,
}

impl<'a> SemidirectVector<'a> {
    /// `factor · self`
    pub fn scale(&self, factor: Expr<'a>) -> Self {
        Self {
            base: self.base.scale(factor),
            spaces: self.spaces.iter().map(|space| space.scale(factor)).collect(),
        }
    }

    /// Each component kept whole.
    pub fn hold(&self) -> Self {
        Self { base: self.base.hold(), spaces: self.spaces.iter().map(Vector::hold).collect() }
    }

    /// `self + other`
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            base: &self.base + &other.base,
            spaces: self.spaces.iter().zip(&other.spaces).map(|(a, b)| a + b).collect(),
        }
    }
}

impl Semidirect {
    /// Whether there are steps with a retraction, on the group and on the spaces.
    pub fn has(&self, retraction: Retraction) -> bool {
        self.group.has(retraction) && self.spaces.iter().all(|space| space.has(retraction))
    }

    /// Whether a retraction is summed as a series, term by term.
    pub fn is_summed(&self, retraction: Retraction) -> bool {
        self.group.is_summed(retraction) || self.spaces.iter().any(|space| space.is_summed(retraction))
    }

    /// Positive, all of them, where the retraction is a local diffeomorphism.
    pub fn domain<'a>(&self, retraction: Retraction, x: &Vector<'a>) -> Vec<Expr<'a>> {
        let mut domain = self.group.domain(retraction, x);
        domain.extend(self.spaces.iter().flat_map(|space| space.domain(retraction, x)));
        domain
    }

    /// The spaces, each with the group that acts on it.
    fn acted(&self) -> impl Iterator<Item = Acted> {
        self.spaces.iter().map(|&space| Acted { group: self.group, space })
    }

    /// `P(x)ᵀ a` for each space: the `V*` part of `(dR τ_(x,w))* (m, a)`, which depends on `x` and `a` alone.
    pub fn d_right_dual_spaces<'a>(
        &self,
        retraction: Retraction,
        x: &Vector<'a>,
        a: &[Vector<'a>],
    ) -> Vec<Vector<'a>> {
        self.acted().zip(a).map(|(space, a)| space.translation_dual(retraction, x, a)).collect()
    }

    /// `Ad*_{τ(x)} a` for each space.
    pub fn carry<'a>(&self, retraction: Retraction, x: &Vector<'a>, a: &[Vector<'a>]) -> Vec<Vector<'a>> {
        self.acted().zip(a).map(|(space, a)| space.carry(retraction, x, a)).collect()
    }

    /// The same with `mean = P(x)ᵀ a`.
    pub fn carry_all<'a>(
        &self,
        retraction: Retraction,
        x: &Vector<'a>,
        a: &[Vector<'a>],
        mean: &[Vector<'a>],
    ) -> Vec<Vector<'a>> {
        if !retraction.is_equivariant() {
            return self.carry(retraction, x, a);
        }
        let change = self.coadjoint_spaces(x, mean);
        a.iter().zip(&change).map(|(a, change)| a + change).collect()
    }

    /// `Ad*_{τ(x, w)} (m, a)`, with `mean = (dR τ_(x,w))* (m, a)`.
    pub fn carry_momentum<'a>(
        &self,
        retraction: Retraction,
        xi: &SemidirectVector<'a>,
        mu: &SemidirectVector<'a>,
        mean: &SemidirectVector<'a>,
    ) -> SemidirectVector<'a> {
        let map = match retraction.row().law {
            Law::Function(_) => return mu.plus(&self.coadjoint(xi, mean)),
            Law::Composite(map) => map,
        };
        let translations = self.acted().zip(&xi.spaces);
        let translations: Vec<_> =
            translations.map(|(space, w)| space.translation(retraction, &xi.base, w)).collect();
        let before = translations.iter().map(|translation| &translation.body_part);
        let m = self.shifted(&mu.base, before, &mu.spaces);
        let m = map.coadjoint(self.group, &xi.base, &m);
        let spaces = self.carry_all(retraction, &xi.base, &mu.spaces, &mean.spaces);
        let after = translations.iter().map(|translation| &translation.rotated_part);
        SemidirectVector { base: self.shifted(&m, after, &spaces).hold(), spaces }
    }

    /// `m − Σ J(p, a)`, the `g*` part of `Ad*_{exp(p)} (m, a)`.
    pub(super) fn shifted<'p, 'a: 'p>(
        &self,
        m: &Vector<'a>,
        translations: impl Iterator<Item = &'p Vector<'a>>,
        a: &[Vector<'a>],
    ) -> Vector<'a> {
        let spaces = self.acted().zip(translations.zip(a));
        spaces.fold(m.clone(), |m, (space, (p, a))| &m - &momentum_map(space.space, p, a))
    }

    /// The `g*` part of `(dR τ_(x,w))* (m, a)`.
    ///
    /// It is `(dR τ_x)* (m − Σ J(f(x), a)) + Σ ∇_x (a · f(x))`, with the momentum map `J(p, a) · y = a · ρ_y p`. On a
    /// tangent group, whose algebra is `g` over the dual numbers `x + ε w`, each `a` gives the derivative of
    /// `(dR τ_x)* a` along `w` instead.
    pub fn d_right_dual_base<'a>(
        &self,
        retraction: Retraction,
        x: &Vector<'a>,
        w: &[Vector<'a>],
        mu: &SemidirectVector<'a>,
    ) -> Vector<'a> {
        let arena = mu.base.0[0].arena();
        let at = placeholders(arena, "x", x.len());
        let symbols = at.symbols();
        let here: Vec<_> = symbols.iter().copied().zip(x.iter()).collect();

        let mut carried = mu.base.clone();
        let mut by_translation = Vector::zeros(arena, x.len());
        for ((space, w), a) in self.acted().zip(w).zip(&mu.spaces) {
            let translation = space.translation(retraction, &at, w);
            let change = if translation.is_tangent_group {
                self.group.d_right_dual(retraction, &at, a).derivative_along(&symbols, w)
            } else {
                let body_part = translation.body_part.substitute(&here);
                carried = &carried - &momentum_map(space.space, &body_part, a);
                gradient(a.dot(&translation.body_part), &symbols)
            };
            by_translation = &by_translation + &change.substitute(&here);
        }
        let carried = carried.hold().named("momentum_carried", self.group.axes());
        &self.group.d_right_dual(retraction, x, &carried) + &by_translation
    }

    /// `(dR τ_(x,w))* (m, a)`
    pub fn d_right_dual<'a>(
        &self,
        retraction: Retraction,
        xi: &SemidirectVector<'a>,
        mu: &SemidirectVector<'a>,
    ) -> SemidirectVector<'a> {
        SemidirectVector {
            base: self.d_right_dual_base(retraction, &xi.base, &xi.spaces, mu),
            spaces: self.d_right_dual_spaces(retraction, &xi.base, &mu.spaces),
        }
    }

    /// `ad*_(x,w) (m, a)`: the dual of the bracket `[(x, w), (y, u)] = ([x, y], ρ_x u − ρ_y w)`.
    pub fn coadjoint<'a>(
        &self,
        xi: &SemidirectVector<'a>,
        mu: &SemidirectVector<'a>,
    ) -> SemidirectVector<'a> {
        let base = transposed(&mu.base, xi.base.len(), |y| self.group.bracket(&xi.base, y));
        let base = self.shifted(&base, xi.spaces.iter(), &mu.spaces);
        SemidirectVector { base, spaces: self.coadjoint_spaces(&xi.base, &mu.spaces) }
    }

    /// The `V*` part of `ad*_(x,w) (m, a)`, which depends on `x` and `a` alone.
    pub fn coadjoint_spaces<'a>(&self, x: &Vector<'a>, a: &[Vector<'a>]) -> Vec<Vector<'a>> {
        self.acted().zip(a).map(|(space, a)| space.coadjoint(x, a)).collect()
    }
}

/// A space, and the group that acts on it.
pub struct Acted {
    /// `G`
    pub group: &'static dyn Group,
    /// `V`
    pub space: &'static dyn Representation,
}

impl Acted {
    /// `P(x) w`
    pub fn translation<'a>(&self, retraction: Retraction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        match retraction.row().law {
            Law::Function(f) => self.space.translation(f, x, w),
            Law::Composite(map) => map.translation(w),
        }
    }

    /// `τ(x) v`
    pub fn transport<'a>(&self, retraction: Retraction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        match retraction.row().law {
            Law::Function(f) => self.space.transport(f, x, v),
            Law::Composite(map) => map.transport(self.group, self.space, x, v),
        }
    }

    /// `P(x)ᵀ a`
    fn translation_dual<'a>(&self, retraction: Retraction, x: &Vector<'a>, a: &Vector<'a>) -> Vector<'a> {
        transposed(a, a.len(), |u| {
            let Translation { body_part, rotated_part, .. } = self.translation(retraction, x, u);
            &body_part + &self.transport(retraction, x, &rotated_part)
        })
    }

    /// `Ad*_{τ(x)} a`: `a + ad*_x P(x)ᵀ a` where `τ` is equivariant.
    pub fn carry<'a>(&self, retraction: Retraction, x: &Vector<'a>, a: &Vector<'a>) -> Vector<'a> {
        if !retraction.is_equivariant() {
            return transposed(a, a.len(), |u| self.transport(retraction, x, u));
        }
        a + &self.coadjoint(x, &self.translation_dual(retraction, x, a))
    }

    /// `ad*_x a`, with `(ad*_x a) · u = a · ρ_x u`.
    fn coadjoint<'a>(&self, x: &Vector<'a>, a: &Vector<'a>) -> Vector<'a> {
        transposed(a, a.len(), |u| self.space.act_infinitesimally(x, u))
    }
}

/// `J(p, a)`, with `J(p, a) · y = a · ρ_y p`.
pub(super) fn momentum_map<'a>(space: &dyn Representation, p: &Vector<'a>, a: &Vector<'a>) -> Vector<'a> {
    transposed(a, space.algebra_dimension(), |y| space.act_infinitesimally(y, p))
}
