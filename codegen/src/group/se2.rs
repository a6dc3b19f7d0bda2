//! SE(2), rigid motions of the plane.
//!
//! Coordinates of the algebra: angular, then linear velocity, both in body coordinates; the dual likewise. Storage: the rotation's
//! coordinates, then the translation from space origin to body origin, in space coordinates. The formulas are those of
//! [`rigid`](super::rigid).

use super::rigid::Rigid;
use super::so2::{Plane, SO2};
use super::{Component, ComponentValue, Group, MatrixFunction, Representation, Semidirect};
use crate::expr::{Expr, Number, Vector};
use crate::quantity::Kind;

/// Rigid motions of the plane.
pub struct SE2;

fn rigid() -> Rigid {
    Rigid(Semidirect { group: &SO2, spaces: vec![&Plane(1)] })
}

impl Group for SE2 {
    fn name(&self) -> &'static str {
        "SE2"
    }

    fn conventions(&self) -> &'static str {
        "pose: isometry from body to space coordinates; momentum: angular momentum first, then linear, in body coordinates"
    }

    fn configuration_name(&self) -> &'static str {
        "pose"
    }

    fn configuration_kind(&self) -> Kind {
        Kind::RigidMotion2
    }

    fn coordinates(&self) -> &'static [&'static str] {
        &["re", "im", "px", "py"]
    }

    fn unit_coordinates(&self) -> usize {
        SO2.unit_coordinates()
    }

    fn dimension(&self) -> usize {
        3
    }

    fn blocks(&self) -> Vec<usize> {
        vec![1, 2]
    }

    fn parts(&self) -> &'static [&'static str] {
        &["angular", "linear"]
    }

    fn axes(&self) -> &'static [&'static str] {
        &["angular", "linear_x", "linear_y"]
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
        match f {
            // dR exp is singular at a full turn
            MatrixFunction::Exponential => {
                vec![x.0[0].arena().number(Number::FOUR_PI_SQUARED) - x.0[0] * x.0[0]]
            }
            MatrixFunction::Cayley => Vec::new(),
        }
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
        &[&Plane(3)]
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
        of: |g| ComponentValue::Element(&SO2, Vector(g.0[..2].to_vec())),
    },
    Component {
        name: "translation",
        called: false,
        of: |g| ComponentValue::Vector(Vector(g.0[2..].to_vec())),
    },
];
