//! Facts about quantities: names, places in flat lists, rotations, matrices.

use std::ops::Range;

use coadjoint::system::{Kind, Quantity, Role};

/// Joins the names of a quantity and a component: `chi_x`, or `weight` for a scalar.
pub fn component_name(quantity: &Quantity, component: &str) -> String {
    if component.is_empty() { quantity.name.to_owned() } else { format!("{}_{component}", quantity.name) }
}

/// Lists roles and places of quantities in tangent vectors.
pub(crate) fn tangent_places(quantities: &[Quantity]) -> impl Iterator<Item = (Role, Range<usize>)> + '_ {
    quantities.iter().map(|quantity| (quantity.role, quantity.tangent()))
}

/// Counts the components that are those of a rotation, and writes no rotation; none of a vector.
pub(crate) fn rotation(quantity: &Quantity) -> Option<(usize, &'static str)> {
    match quantity.kind {
        Kind::UnitQuaternion | Kind::RigidMotion3 => Some((4, "1,0,0,0")),
        Kind::UnitComplex | Kind::RigidMotion2 => Some((2, "1,0")),
        _ => None,
    }
}

/// Counts the rows of the matrix that a configuration is; none if it is no matrix.
pub(crate) fn matrix_order(quantity: &Quantity) -> Option<usize> {
    match (quantity.role, quantity.kind) {
        (Role::Configuration, Kind::Matrix(rows, _)) => Some(rows),
        _ => None,
    }
}
