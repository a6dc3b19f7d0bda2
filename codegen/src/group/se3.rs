//! SE(3), rigid motions of space. The formulas are those of [`rigid`](super::rigid).

use super::rigid::Rigid;
use super::so3::{SO3, Space};
use super::{Component, ComponentValue, GroupNames, MatrixFunction, Representation, Translation};
use crate::expr::Vector;
use crate::quantity::Kind;

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
        components: COMPONENTS,
    },
    rotations: &SO3,
    space: &Space,
    directions: [&Directions],
};

/// The fields of an isometry.
const COMPONENTS: &[Component] = &[
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

/// The angular part.
fn angular<'a>(x: &Vector<'a>) -> Vector<'a> {
    x.part(0..3)
}

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
        Space.act_infinitesimally(&angular(x), v)
    }

    /// That of the rotations; but with the motions it is no tangent group.
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        Translation { is_tangent_group: false, ..Space.translation(f, &angular(x), w) }
    }

    fn act<'a>(&self, g: &Vector<'a>, v: &Vector<'a>) -> Option<Vector<'a>> {
        Space.act(&Vector(g.0[..4].to_vec()), v)
    }

    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        Space.transport(f, &angular(x), v)
    }
}
