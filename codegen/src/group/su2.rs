//! SU(2), unit quaternions: the double cover of the rotations of space, as spins see it.
//!
//! * Algebra: `su(2) ≅ R³`, `x` standing for the pure quaternion `x/2`, which is `−i x·σ/2`; bracket `[x, y] = x × y`,
//!   `ad*_x m = m × x`.
//! * Storage: the unit quaternion `w, x, y, z` itself, of which `q` and `−q` are different elements; `g' = g (0, ξ)/2`.
//! * `exp x = (c₀(z/4), c₁(z/4) x/2)` with `z = |x|²`, as for [`SO3`](super::SO3). The Cayley map is that of the
//!   quaternions, not of the rotation matrices: with `a = x/4`, `cay x = (1 − a)⁻¹(1 + a) = (1 − |a|², 2a)/(1 + |a|²)`,
//!   and `dR cay_x y = ((1 − |a|²) y + 2 a × y + 2 (a·y) a)/(1 + |a|²)²`.

use super::so3::{self, SO3};
use super::{Basis, EquationNames, Equations, Group, GroupNames, MatrixFunction, Representation, Retraction};
use crate::expr::{Expr, Number, Vector};

/// Unit quaternions.
pub struct SU2;

/// `a = x/4` and `|a|²`
fn quarter<'a>(x: &Vector<'a>) -> (Vector<'a>, Expr<'a>) {
    let a = x.scale(x.0[0].arena().number(Number::ratio(1, 4)));
    let squared = x.squared_norm().scale(Number::ratio(1, 16));
    (a, squared)
}

const NAMES: GroupNames = GroupNames {
    name: "SU2",
    conventions: "spin: unit quaternion, not identified with its negative; momentum and velocity: body coordinates",
    configuration: "spin",
    ..so3::NAMES
};

impl Group for SU2 {
    fn names(&self) -> &GroupNames {
        &NAMES
    }

    fn equations(&self, names: &EquationNames<'_>) -> Equations {
        SO3.equations(names)
    }

    fn unknown_scale(&self, retraction: Retraction) -> i128 {
        if retraction == Retraction::Cayley { 4 } else { 1 }
    }

    fn bracket<'a>(&self, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        x.cross(y)
    }

    fn closed_form<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vector<'a> {
        match f {
            MatrixFunction::Exponential => SO3.closed_form(f, x),
            MatrixFunction::Cayley => {
                let (a, squared) = quarter(x);
                let shared = (squared + 1).recip();
                let mut quaternion = vec![shared.scale(2) - 1];
                quaternion.extend(a.scale(shared.scale(2)).iter());
                Vector(quaternion)
            }
        }
    }

    /// The transpose has `−a` in the place of `a`.
    fn closed_d_right_dual<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        match f {
            MatrixFunction::Exponential => SO3.closed_d_right_dual(f, x, m),
            MatrixFunction::Cayley => {
                let (a, squared) = quarter(x);
                let two = squared.arena().number(2);
                let shared = (squared + 1).recip();
                let rotated = &m.scale(-squared + 1) - &a.cross(m).scale(two);
                (&rotated + &a.scale(a.dot(m).scale(2))).scale(shared * shared)
            }
        }
    }

    fn closed_domain<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vec<Expr<'a>> {
        SO3.closed_domain(f, x)
    }

    fn compose<'a>(&self, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a> {
        SO3.compose(g, h)
    }

    fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        SO3.inverse(g)
    }

    fn normalize<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        SO3.normalize(g)
    }

    fn to_space<'a>(&self, g: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        SO3.to_space(g, m)
    }

    /// None: the Cayley map of the quaternions rotates space otherwise than that of the rotation matrices does.
    fn representations(&self) -> &[&'static dyn Representation] {
        &[]
    }

    /// As the rotations that they cover.
    fn act<'a>(&self, g: &Vector<'a>, v: &Vector<'a>) -> Option<Vector<'a>> {
        SO3.act(g, v)
    }

    /// As `x/2` multiplies quaternions from the left: the axes of the family of this name are others, and of another
    /// length.
    fn basis(&self) -> Option<Basis> {
        Basis::of_action(self.axes(), self.coordinates().len(), |x, q| {
            let mut pure = vec![x.0[0].arena().zero()];
            pure.extend(x.iter().map(|component| component / 2));
            self.compose(&Vector(pure), q)
        })
    }
}
