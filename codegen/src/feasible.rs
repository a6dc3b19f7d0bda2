//! Rules for what a description asks of the derivation: how much there may be of it, and which inverses it needs.

use crate::check::Description;
use crate::diagnostics::Diagnostics;
use crate::expr::Arena;
use crate::limits::{COMPONENTS, DERIVATION};
use crate::method::hamilton_jacobi;
use crate::model::{Relation, System};
use crate::parse::{Attribute, EnergyKey, Item, Key};

/// Reports that a system has too many parameters. `None` if so.
pub(crate) fn sizes(description: &Description<'_>, diagnostics: &mut Diagnostics) -> Option<()> {
    let fields = description.item.fields.iter().map(|field| (&field.name, field.shape, field.length));
    let controls =
        description.attribute.controls.iter().map(|control| (&control.name, control.shape, control.length));
    let mut sum = 0;
    for (name, shape, length) in fields.chain(controls) {
        sum += shape.size() * length.unwrap_or(1);
        if sum > COMPONENTS {
            let message = format!("fields and controls may have {COMPONENTS} numbers together at most");
            return diagnostics.fail(name, message);
        }
    }
    Some(())
}

/// Reports that there was too much to derive, or with numbers beyond `f64`, at the expression that most of it comes
/// from, and the rule of a lower order of which there is not too much. `None` if so.
pub(crate) fn derived(
    arena: &Arena,
    attribute: &Attribute,
    item: &Item,
    lower: impl FnOnce() -> Option<String>,
    diagnostics: &mut Diagnostics,
) -> Option<()> {
    let message = if arena.is_exhausted() {
        let lower = lower().map(|rule| format!("take `{rule}`, the highest order that fits"));
        let ways = lower.into_iter().chain(lighter(attribute).into_iter().map(str::to_owned));
        format!(
            "deriving the steps of this system takes sums and products of more than {DERIVATION} operands, the bound of what compiles in \
             seconds; {}",
            ways.collect::<Vec<_>>().join(", or ")
        )
    } else if !arena.is_finite() {
        "the derivatives of this have constants that are too large; choose other units".to_owned()
    } else {
        return Some(());
    };
    at_energy(message, attribute, item, diagnostics)
}

/// Reports a problem of what a system's expressions are together: at an energy, of several at the whole one, which comes
/// last, else at a force.
fn at_energy(
    message: impl std::fmt::Display,
    attribute: &Attribute,
    item: &Item,
    diagnostics: &mut Diagnostics,
) -> Option<()> {
    let energy = EnergyKey::ALL.into_iter().rev().find_map(|key| attribute.energy(key));
    match energy.or(attribute.forces.first().map(|force| &force.value)) {
        Some(expression) => diagnostics.fail(expression, message),
        None => diagnostics.fail(&item.name, message),
    }
}

/// Reports a motion that has no power series by recurrences, where they are asked for. `None` if so.
pub(crate) fn has_series(
    there_is_one: bool,
    attribute: &Attribute,
    item: &Item,
    diagnostics: &mut Diagnostics,
) -> Option<()> {
    if there_is_one {
        return Some(());
    }
    let message = "a function in this has no power series by a recurrence, as `angle()` and `scaled_axis()` have none; leave out `taylor`";
    at_energy(message, attribute, item, diagnostics)
}

/// What to change of a description that asks for too much, what costs most first.
fn lighter(attribute: &Attribute) -> Vec<&'static str> {
    let ways = [
        (attribute.has(Key::Derivatives), "leave out `derivatives`, or name those that you need"),
        (attribute.has(Key::Taylor), "leave out `taylor`"),
        (attribute.has(Key::Methods), "leave out `methods`, as the standard steps are there without it"),
        (!attribute.has(Key::Retractions), "take one retraction, `retractions(Cayley)`"),
        (true, "simplify its expressions"),
        (true, "describe a system of fewer dimensions"),
    ];
    ways.into_iter().filter_map(|(is_a_way, way)| is_a_way.then_some(way)).collect()
}

/// Reports steps whose derivation no retraction that is asked for allows. `None` if so.
pub(crate) fn retractions(attribute: &Attribute, item: &Item, diagnostics: &mut Diagnostics) -> Option<()> {
    let named = &attribute.retractions;
    let is_possible = named.is_empty() || named.iter().any(|retraction| retraction.is_equivariant());
    match attribute.methods.iter().find(|rule| rule.is_of_order()) {
        Some(rule) if !is_possible => {
            let message = format!(
                "`{}` steps are made with the retractions `Exponential` and `Cayley`: name one of them in `retractions(…)`",
                rule.method.name
            );
            diagnostics.fail(&item.name, message)
        }
        _ => Some(()),
    }
}

/// Reports a Lagrangian without a velocity for each momentum, and tangent lifts without a momentum for each velocity.
/// `None` if so.
pub(crate) fn legendre(
    system: &System<'_>,
    attribute: &Attribute,
    diagnostics: &mut Diagnostics,
) -> Option<()> {
    let [hamiltonian, lagrangian] =
        [EnergyKey::Hamiltonian, EnergyKey::Lagrangian].map(|key| attribute.energy(key));
    if let (Some(lagrangian), Relation::Singular) = (lagrangian, system.velocity_relation()) {
        let mut sources = system.sources.energies.iter();
        if sources.any(|source| source.key == EnergyKey::Lagrangian && !source.has_meaning) {
            // what is wrong with it was reported, and stands for nothing
            return None;
        }
        let message = "the second derivative of this by the velocity is singular, so that no velocity belongs to a momentum; \
                       each component of the velocity needs a kinetic energy";
        return diagnostics.fail(lagrangian, message);
    }
    if !hamilton_jacobi::is_for(system)
        && let Some(hamiltonian) = hamiltonian
        && attribute.methods.iter().any(|rule| *rule.method == hamilton_jacobi::METHOD)
    {
        let message = "with forces, Hamilton–Jacobi steps need the momentum of a velocity in closed form, which this does not give; \
                       leave out `HamiltonJacobi`, or the forces";
        return diagnostics.fail(hamiltonian, message);
    }
    let needing =
        attribute.methods.iter().find_map(|rule| Some((rule.method.name, rule.method.needs_momentum?)));
    if let (Some(hamiltonian), Some((method, who))) = (hamiltonian, needing)
        && matches!(system.momentum_relation(), Relation::Singular)
    {
        let message = format!(
            "the second derivative of this by the momentum is singular, so that no momentum belongs to a velocity, as {who} \
             need it; leave out `{method}`"
        );
        return diagnostics.fail(hamiltonian, message);
    }
    Some(())
}
