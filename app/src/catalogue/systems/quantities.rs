//! Facts about quantities: names, places in flat lists, rotations, matrices.

use coadjoint::system::{Kind, Quantity, Role};

/// Joins the names of a quantity and a component: `chi_x`, or `weight` for a scalar.
pub fn component_name(quantity: &Quantity, component: &str) -> String {
    if component.is_empty() { quantity.name.to_owned() } else { format!("{}_{component}", quantity.name) }
}

/// Tells the unit of a component, empty where none is known.
///
/// A pure number has none. Where components differ, the description lists their units, separated by commas:
/// `"1, 1, m, m"`. A list shorter than the quantity begins anew, so that of a matrix each column has a unit.
pub fn component_unit(quantity: &Quantity, component: usize) -> &'static str {
    let units: Vec<&str> = quantity.unit.unwrap_or_default().split(',').map(str::trim).collect();
    match units[component % units.len()] {
        "1" => "",
        unit => unit,
    }
}

/// Tells the unit of all components, empty where they differ.
pub fn unit(quantity: &Quantity) -> &'static str {
    let first = component_unit(quantity, 0);
    let is_first = |component| component_unit(quantity, component) == first;
    if (1..quantity.components.len()).all(is_first) { first } else { "" }
}

/// A component of a quantity.
pub(crate) struct Component {
    pub(crate) quantity: &'static Quantity,
    /// Joined with its quantity's.
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    /// Its place in a list of the numbers of all quantities.
    pub(crate) slot: usize,
}

/// Lists all components of some quantities, in order.
pub(crate) fn components(quantities: &'static [Quantity]) -> impl Iterator<Item = Component> {
    Quantity::with_ranges(quantities).flat_map(|(quantity, slots)| {
        let one = move |(k, component): (usize, &&str)| {
            let (name, unit) = (component_name(quantity, component), component_unit(quantity, k));
            Component { quantity, name, unit, slot: slots.start + k }
        };
        quantity.components.iter().enumerate().map(one)
    })
}

/// Collects values by their keys, in the order in which these come.
pub(crate) fn by_key<K: PartialEq, V>(pairs: impl Iterator<Item = (K, V)>) -> Vec<(K, Vec<V>)> {
    let mut parts: Vec<(K, Vec<V>)> = Vec::new();
    for (key, value) in pairs {
        match parts.iter_mut().find(|(known, _)| *known == key) {
            Some((_, values)) => values.push(value),
            None => parts.push((key, vec![value])),
        }
    }
    parts
}

/// Counts the numbers of tangent vectors.
pub(crate) fn tangent_length(state: &[Quantity]) -> usize {
    state.last().map_or(0, |quantity| quantity.tangent().end)
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
