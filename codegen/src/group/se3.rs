//! SE(3), rigid motions of space. The formulas are those of [`rigid`](super::rigid).

use super::rigid::Rigid;
use super::so3::{SO3, Space};
use super::{Component, ComponentValue, GroupNames};
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
    space: &Space(3),
    directions: [&Space(6)],
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
