//! SE(3), rigid motions of space.
//!
//! Coordinates of the algebra: angular, then linear velocity, both in body coordinates; the dual likewise. Storage: the rotation's
//! coordinates, then the translation from space origin to body origin, in space coordinates. The formulas are those of
//! [`rigid`](super::rigid).

use super::rigid::Rigid;
use super::so3::{SO3, Space};
use super::{
    Component, ComponentValue, Group, MatrixFunction, Representation, Retraction, Semidirect, Translation,
};
use crate::expr::{Expr, Vector};
use crate::quantity::Kind;

/// Rigid motions of space.
pub struct SE3;

fn rigid() -> Rigid {
    Rigid(Semidirect { group: &SO3, spaces: vec![&Space] })
}

impl Group for SE3 {
    fn name(&self) -> &'static str {
        "SE3"
    }

    fn conventions(&self) -> &'static str {
        "pose: isometry from body to space coordinates; momentum: angular part first, then linear, both in body coordinates"
    }

    fn configuration_name(&self) -> &'static str {
        "pose"
    }

    fn configuration_kind(&self) -> Kind {
        Kind::RigidMotion3
    }

    fn coordinates(&self) -> &'static [&'static str] {
        &["w", "x", "y", "z", "px", "py", "pz"]
    }

    fn unit_coordinates(&self) -> usize {
        SO3.unit_coordinates()
    }

    fn dimension(&self) -> usize {
        6
    }

    fn blocks(&self) -> Vec<usize> {
        vec![3, 3]
    }

    fn parts(&self) -> &'static [&'static str] {
        &["angular", "linear"]
    }

    fn axes(&self) -> &'static [&'static str] {
        &["angular_x", "angular_y", "angular_z", "linear_x", "linear_y", "linear_z"]
    }

    fn unknown_scale(&self, retraction: Retraction) -> i128 {
        SO3.unknown_scale(retraction)
    }

    fn bracket<'a>(&self, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        rigid().bracket(x, y)
    }

    fn closed_form<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vector<'a> {
        rigid().retract(f, x)
    }

    fn closed_d_right_dual<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        rigid().d_right_dual(f, x, m)
    }

    fn closed_domain<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vec<Expr<'a>> {
        SO3.closed_domain(f, &rigid().split(x).base)
    }

    fn compose<'a>(&self, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a> {
        rigid().compose(g, h)
    }

    fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        rigid().inverse(g)
    }

    fn normalize<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        rigid().normalize(g)
    }

    fn to_space<'a>(&self, g: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        rigid().to_space(g, m)
    }

    fn representations(&self) -> &[&'static dyn Representation] {
        &[&Directions]
    }

    fn components(&self) -> &'static [Component] {
        COMPONENTS
    }
}

/// The fields of an isometry.
static COMPONENTS: &[Component] = &[
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

/// R³ with the rotations of the motions acting on it: directions, which translations leave alone.
struct Directions;

impl Representation for Directions {
    fn name(&self) -> &'static str {
        Space.name()
    }

    fn coordinates(&self) -> &'static [&'static str] {
        Space.coordinates()
    }

    fn algebra_dimension(&self) -> usize {
        6
    }

    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        Space.act_infinitesimally(&rigid().split(x).base, v)
    }

    /// That of the rotations; but with the motions it is no tangent group.
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        Translation { is_tangent_group: false, ..Space.translation(f, &rigid().split(x).base, w) }
    }

    fn act<'a>(&self, g: &Vector<'a>, v: &Vector<'a>) -> Option<Vector<'a>> {
        Space.act(&Vector(g.0[..4].to_vec()), v)
    }

    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        Space.transport(f, &rigid().split(x).base, v)
    }
}
