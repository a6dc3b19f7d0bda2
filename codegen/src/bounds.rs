//! What a whole system may ask for.

use crate::check;
use crate::diagnostics::Diagnostics;
use crate::expr::Arena;
use crate::limits::{COMPONENTS, DERIVATION, DIMENSION};
use crate::parse::{Attribute, Item};

/// Reports that a system has too many dimensions or parameters.
pub(crate) fn sizes(attribute: &Attribute, item: &Item, diagnostics: &mut Diagnostics) {
    let mut dimension = 0;
    for factor in &attribute.factors {
        dimension += check::group(&factor.group).map_or(0, |group| group.dimension());
        if dimension > DIMENSION {
            let message = format!("a system may have dimension {DIMENSION} at most");
            diagnostics.push(&factor.group, message);
            break;
        }
    }
    let mut components = 0;
    let fields = item.fields.iter().map(|field| (&field.name, field.shape));
    let controls = attribute.controls.iter().map(|control| (&control.name, control.shape));
    for (name, shape) in fields.chain(controls) {
        components += shape.size();
        if components > COMPONENTS {
            let message = format!("fields and controls may have {COMPONENTS} numbers together at most");
            diagnostics.push(name, message);
            break;
        }
    }
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
    let energy = attribute.hamiltonian.as_ref().or(attribute.potential.as_ref());
    match energy.or(attribute.forces.first().map(|force| &force.value)) {
        Some(expression) => diagnostics.push(expression, message),
        None => diagnostics.push(&item.name, message),
    }
    None
}
