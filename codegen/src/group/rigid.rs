//! Rigid motions: what SE(2) and SE(3) have in common, rotations and the translations that they rotate, as one group `K ⋉ V`.
//!
//! * Elements `(R, p)`, `(R, p)(S, q) = (RS, p + Rq)`; algebra `(x, w)` with angular part `x` and linear part `w`, in body
//!   coordinates: `[(x, w), (y, u)] = ([x, y], ρ_x u − ρ_y w)`.
//! * `τ(x, w) = (τ(x), P(x) w)`: `P = φ₁(ρ_x)` for the exponential, `(1 − ρ_x/2)⁻¹` for Cayley. The logarithmic derivatives are
//!   those that [`Semidirect`] derives.

use super::{MatrixFunction, Semidirect, SemidirectVector, Translation};
use crate::expr::Vector;

/// Rotations and the space they act on.
pub(super) struct Rigid(pub(super) Semidirect);

impl Rigid {
    /// The angular and the linear part.
    pub(super) fn split<'a>(&self, x: &Vector<'a>) -> SemidirectVector<'a> {
        let (angular, linear) = x.0.split_at(self.0.group.dimension());
        SemidirectVector { base: Vector(angular.to_vec()), spaces: vec![Vector(linear.to_vec())] }
    }

    /// The rotation and the translation.
    fn parts<'a>(&self, g: &Vector<'a>) -> (Vector<'a>, Vector<'a>) {
        let (rotation, translation) = g.0.split_at(self.0.group.coordinates().len());
        (Vector(rotation.to_vec()), Vector(translation.to_vec()))
    }

    /// `R v`
    fn turned<'a>(&self, rotation: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        // rotations act on the space that they translate in
        self.0.group.act(rotation, v).unwrap_or_else(|| v.clone())
    }

    pub(super) fn bracket<'a>(&self, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        let (space, x, y) = (self.0.spaces[0], self.split(x), self.split(y));
        let linear = &space.act_infinitesimally(&x.base, &y.spaces[0])
            - &space.act_infinitesimally(&y.base, &x.spaces[0]);
        join(self.0.group.bracket(&x.base, &y.base), &linear)
    }

    pub(super) fn retract<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vector<'a> {
        let (space, x) = (self.0.spaces[0], self.split(x));
        let rotation = self.0.group.closed_form(f, &x.base);
        let Translation { body_part, rotated_part, .. } = space.translation(f, &x.base, &x.spaces[0]);
        let translation = &body_part + &self.turned(&rotation, &rotated_part);
        join(rotation, &translation)
    }

    pub(super) fn d_right_dual<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let dual = self.0.d_right_dual(f.into(), &self.split(x), &self.split(m));
        join(dual.base, &dual.spaces[0])
    }

    pub(super) fn compose<'a>(&self, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a> {
        let ((r, p), (s, q)) = (self.parts(g), self.parts(h));
        join(self.0.group.compose(&r, &s), &(&p + &self.turned(&r, &q)))
    }

    pub(super) fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let (r, p) = self.parts(g);
        let inverse = self.0.group.inverse(&r);
        let back = -&self.turned(&inverse, &p);
        join(inverse, &back)
    }

    pub(super) fn normalize<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let (r, p) = self.parts(g);
        join(self.0.group.normalize(&r), &p)
    }

    /// `Ad*_{g⁻¹} (m, a) = (K-part of m and of the moment of R a about the origin, R a)`: the moment is `−J(p, R a)`, with
    /// `J(p, a) · y = a · ρ_y p`, from the translation that the inverse brings.
    pub(super) fn to_space<'a>(&self, g: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let (r, p) = self.parts(g);
        let m = self.split(m);
        let linear = self.turned(&r, &m.spaces[0]);
        let angular = self.0.group.to_space(&r, &m.base);
        let moment = self.0.momentum_map(0, &p, &linear);
        join(&angular + &moment, &linear)
    }
}

fn join<'a>(first: Vector<'a>, second: &Vector<'a>) -> Vector<'a> {
    let mut both = first.0;
    both.extend(second.iter());
    Vector(both)
}
