//! SE(2), rigid motions of the plane. The formulas are those of [`rigid`](super::rigid).

use super::rigid::Rigid;
use super::so2::{Plane, SO2};
use super::{Component, ComponentValue, GroupNames};
use crate::expr::Vector;
use crate::quantity::Kind;

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
        components: COMPONENTS,
    },
    rotations: &SO2,
    space: &Plane(1),
    directions: [&Plane(3)],
};

/// The fields of an isometry.
const COMPONENTS: &[Component] = &[
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
