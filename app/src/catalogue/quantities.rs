//! Facts about quantities by their components: names, places in flat lists, rotations, matrices.

use std::ops::Range;

use coadjoint::system::{Quantity, Role};

/// Joins the names of a quantity and a component: `chi_x`, or `weight` for a scalar.
pub fn component_name(quantity: &Quantity, component: &str) -> String {
    if component.is_empty() { quantity.name.to_owned() } else { format!("{}_{component}", quantity.name) }
}

/// Pairs each quantity with its place in the flat list.
pub(crate) fn laid_out(quantities: &[Quantity]) -> impl Iterator<Item = (&Quantity, Range<usize>)> {
    quantities.iter().scan(0, |start, quantity| {
        let slots = *start..*start + quantity.components.len();
        *start = slots.end;
        Some((quantity, slots))
    })
}

/// Lists roles and places of quantities in tangent vectors: a configuration has as many numbers as the momentum behind
/// it.
pub(crate) fn tangent_places(quantities: &[Quantity]) -> impl Iterator<Item = (Role, Range<usize>)> + '_ {
    quantities.iter().enumerate().scan(0, |start, (index, quantity)| {
        let whose = if quantity.role == Role::Configuration { quantities.get(index + 1) } else { None };
        let place = *start..*start + whose.unwrap_or(quantity).components.len();
        *start = place.end;
        Some((quantity.role, place))
    })
}

/// The components of rotations, in space and in the plane, and no rotation; those of rigid motions begin with them.
const ROTATIONS: [(&[&str], &str); 2] = [(&["w", "x", "y", "z"], "1,0,0,0"), (&["re", "im"], "1,0")];
/// The components behind them in rigid motions.
const TRANSLATIONS: [&[&str]; 3] = [&[], &["px", "py"], &["px", "py", "pz"]];

/// Counts the components that are those of a rotation, and writes no rotation; none of a vector.
pub(crate) fn rotation(quantity: &Quantity) -> Option<(usize, &'static str)> {
    ROTATIONS.iter().find_map(|(names, unit)| {
        let rest = quantity.components.strip_prefix(*names)?;
        TRANSLATIONS.contains(&rest).then_some((names.len(), *unit))
    })
}

/// Counts the rows of the matrix that a configuration is, with components `11`, `12`, …; none if it is no matrix.
pub(crate) fn matrix_order(quantity: &Quantity) -> Option<usize> {
    let rows = (1..=9).find(|rows| rows * rows == quantity.components.len())?;
    let mut names = (0..rows * rows).map(|k| format!("{}{}", k / rows + 1, k % rows + 1));
    let is_matrix = quantity.role == Role::Configuration
        && quantity.components.iter().all(|name| names.next().as_deref() == Some(name));
    is_matrix.then_some(rows)
}
