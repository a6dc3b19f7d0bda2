//! What a whole system may ask for.

use proc_macro2::Ident;

use crate::check::Description;
use crate::diagnostics::Diagnostics;
use crate::expr::Arena;
use crate::limits::{COMPONENTS, DERIVATION};
use crate::parse::{Attribute, EnergyKey, Item};

/// Reports that a system has too many parameters. `None` if so.
pub(crate) fn sizes(description: &Description<'_>, diagnostics: &mut Diagnostics) -> Option<()> {
    let before = diagnostics.len();
    let fields = description
        .parameters
        .iter()
        .map(|field| (&field.name, field.shape.size() * field.length.unwrap_or(1)));
    let controls = description
        .controls
        .iter()
        .map(|control| (&control.name, control.shape.size() * control.length.unwrap_or(1)));
    if let Some(name) = beyond(COMPONENTS, fields.chain(controls)) {
        let message = format!("fields and controls may have {COMPONENTS} numbers together at most");
        diagnostics.push(name, message);
    }
    (diagnostics.len() == before).then_some(())
}

/// The first with which the sum of the sizes is larger than it may be.
fn beyond<'n>(bound: usize, sizes: impl Iterator<Item = (&'n Ident, usize)>) -> Option<&'n Ident> {
    let mut sum = 0;
    let mut sizes = sizes.map(|(name, size)| {
        sum += size;
        (name, sum)
    });
    sizes.find(|&(_, sum)| sum > bound).map(|(name, _)| name)
}

/// Reports that there was too much to derive, or with numbers beyond `f64`, at the expression that most of it comes from. `None` if so.
pub(crate) fn derived(
    arena: &Arena,
    attribute: &Attribute,
    item: &Item,
    diagnostics: &mut Diagnostics,
) -> Option<()> {
    let message = if arena.is_exhausted() {
        format!(
            "the steps of this system take sums and products of more than {DERIVATION} operands to derive; simplify \
             its expressions, or describe a system of fewer dimensions"
        )
    } else if !arena.is_finite() {
        "the derivatives of this have constants that are too large; choose other units".to_owned()
    } else {
        return Some(());
    };
    // of several the whole one is meant, and that comes last
    let energy = EnergyKey::ALL.into_iter().rev().find_map(|key| attribute.energy(key));
    match energy.or(attribute.forces.first().map(|force| &force.value)) {
        Some(expression) => diagnostics.push(expression, message),
        None => diagnostics.push(&item.name, message),
    }
    None
}
