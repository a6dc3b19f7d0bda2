//! SE(2) and SE(3), rigid motions of the plane and of space: rotations and the translations that they rotate, as one
//! group `K ⋉ V`.
//!
//! Coordinates of the algebra: angular, then linear velocity, both in body coordinates; the dual likewise. Storage: the
//! rotation's coordinates, then the translation from space origin to body origin, in space coordinates.
//!
//! * Elements `(R, p)`, `(R, p)(S, q) = (RS, p + Rq)`; algebra `(x, w)` with angular part `x` and linear part `w`, in
//!   body coordinates: `[(x, w), (y, u)] = ([x, y], ρ_x u − ρ_y w)`.
//! * `τ(x, w) = (τ(x), P(x) w)`: `P = φ₁(ρ_x)` for the exponential, `(1 − ρ_x/2)⁻¹` for Cayley. The logarithmic
//!   derivatives are those that [`Semidirect`] derives.

use super::semidirect::momentum_map;
use super::so2::{Plane, SO2};
use super::so3::{SO3, Space};
use super::{
    Component, ComponentValue, Group, GroupNames, MatrixFunction, Representation, Retraction, Semidirect,
    SemidirectVector, Translation,
};
use crate::expr::{Expr, Number, Vector};
use crate::quantity::Kind;

/// Rotations and the space they act on.
pub struct Rigid {
    names: GroupNames,
    rotations: &'static dyn Group,
    /// The space that the rotations translate in.
    space: &'static dyn Representation,
    /// The same with the motions acting on it: directions, which translations leave alone.
    directions: [&'static dyn Representation; 1],
}

impl Rigid {
    fn semidirect(&self) -> Semidirect {
        Semidirect { group: self.rotations, spaces: vec![self.space] }
    }

    /// The angular and the linear part.
    fn split<'a>(&self, x: &Vector<'a>) -> SemidirectVector<'a> {
        let n = self.rotations.dimension();
        SemidirectVector { base: x.part(0..n), spaces: vec![x.part(n..x.len())] }
    }

    /// The rotation and the translation.
    fn parts<'a>(&self, g: &Vector<'a>) -> (Vector<'a>, Vector<'a>) {
        let n = self.rotations.coordinates().len();
        (g.part(0..n), g.part(n..g.len()))
    }

    /// `R v`
    fn turned<'a>(&self, rotation: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        // rotations act on the space that they translate in
        self.rotations.act(rotation, v).unwrap_or_else(|| v.clone())
    }
}

impl Group for Rigid {
    fn names(&self) -> &GroupNames {
        &self.names
    }

    fn unknown_scale(&self, retraction: Retraction) -> i128 {
        self.rotations.unknown_scale(retraction)
    }

    fn bracket<'a>(&self, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        let (x, y) = (self.split(x), self.split(y));
        let linear = &self.space.act_infinitesimally(&x.base, &y.spaces[0])
            - &self.space.act_infinitesimally(&y.base, &x.spaces[0]);
        join(self.rotations.bracket(&x.base, &y.base), &linear)
    }

    fn closed_form<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vector<'a> {
        let x = self.split(x);
        let rotation = self.rotations.closed_form(f, &x.base);
        let Translation { body_part, rotated_part, .. } = self.space.translation(f, &x.base, &x.spaces[0]);
        let translation = &body_part + &self.turned(&rotation, &rotated_part);
        join(rotation, &translation)
    }

    fn closed_d_right_dual<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let dual = self.semidirect().d_right_dual(f.into(), &self.split(x), &self.split(m));
        join(dual.base, &dual.spaces[0])
    }

    fn closed_domain<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vec<Expr<'a>> {
        if f == MatrixFunction::Cayley {
            return Vec::new();
        }
        // dR exp is singular at a full turn
        let edge = x.0[0].arena().number(Number::FOUR_PI_SQUARED);
        vec![edge - self.split(x).base.squared_norm()]
    }

    fn compose<'a>(&self, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a> {
        let ((r, p), (s, q)) = (self.parts(g), self.parts(h));
        join(self.rotations.compose(&r, &s), &(&p + &self.turned(&r, &q)))
    }

    fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let (r, p) = self.parts(g);
        let inverse = self.rotations.inverse(&r);
        let back = -&self.turned(&inverse, &p);
        join(inverse, &back)
    }

    fn normalize<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let (r, p) = self.parts(g);
        join(self.rotations.normalize(&r), &p)
    }

    /// `Ad*_{g⁻¹} (m, a) = (K-part of m and of the moment of R a about the origin, R a)`: the moment is `−J(p, R a)`,
    /// with `J(p, a) · y = a · ρ_y p`, from the translation that the inverse brings.
    fn to_space<'a>(&self, g: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let (r, p) = self.parts(g);
        let m = self.split(m);
        let linear = self.turned(&r, &m.spaces[0]);
        let angular = self.rotations.to_space(&r, &m.base);
        let moment = momentum_map(self.space, &p, &linear);
        join(&angular + &moment, &linear)
    }

    fn representations(&self) -> &[&'static dyn Representation] {
        &self.directions
    }
}

fn join<'a>(first: Vector<'a>, second: &Vector<'a>) -> Vector<'a> {
    Vector::concat([&first, second])
}

/// Rigid motions of the plane.
pub static SE2: Rigid = Rigid {
    names: GroupNames {
        name: "SE2",
        conventions: "pose: isometry from body to space coordinates; momentum: angular momentum first, then linear, in body coordinates",
        configuration: "pose",
        kind: Kind::RigidMotion2,
        coordinates: &["re", "im", "px", "py"],
        unit_coordinates: 2,
        axes: &["angular", "linear_x", "linear_y"],
        blocks: &[1, 2],
        parts: &["angular", "linear"],
        components: PLANE,
    },
    rotations: &SO2,
    space: &Plane(1),
    directions: [&Plane(3)],
};

/// The fields of an isometry of the plane.
const PLANE: &[Component] = &[
    Component {
        name: "rotation",
        called: false,
        of: |g| ComponentValue::Element(&SO2, Vector(g.0[..2].to_vec())),
    },
    Component {
        name: "translation",
        called: false,
        of: |g| ComponentValue::Vector(Vector(g.0[2..].to_vec())),
    },
];

/// Rigid motions of space.
pub static SE3: Rigid = Rigid {
    names: GroupNames {
        name: "SE3",
        conventions: "pose: isometry from body to space coordinates; momentum: angular part first, then linear, both in body coordinates",
        configuration: "pose",
        kind: Kind::RigidMotion3,
        coordinates: &["w", "x", "y", "z", "px", "py", "pz"],
        unit_coordinates: 4,
        axes: &["angular_x", "angular_y", "angular_z", "linear_x", "linear_y", "linear_z"],
        blocks: &[3, 3],
        parts: &["angular", "linear"],
        components: SPACE,
    },
    rotations: &SO3,
    space: &Space(3),
    directions: [&Space(6)],
};

/// The fields of an isometry of space.
const SPACE: &[Component] = &[
    Component {
        name: "rotation",
        called: false,
        of: |g| ComponentValue::Element(&SO3, Vector(g.0[..4].to_vec())),
    },
    Component {
        name: "translation",
        called: false,
        of: |g| ComponentValue::Vector(Vector(g.0[4..].to_vec())),
    },
];
