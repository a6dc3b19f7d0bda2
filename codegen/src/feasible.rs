//! Rules for what a description asks of the derivation: how much there may be of it, and which inverses it needs.

use proc_macro2::Ident;

use crate::check::Description;
use crate::diagnostics::Diagnostics;
use crate::expr::Arena;
use crate::limits::{COMPONENTS, DERIVATION};
use crate::model::{Relation, System};
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

/// Reports that there was too much to derive, or with numbers beyond `f64`, at the expression that most of it comes
/// from. `None` if so.
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
        if system
            .sources
            .energies
            .iter()
            .any(|source| source.key == EnergyKey::Lagrangian && !source.has_meaning)
        {
            // what is wrong with it was reported, and stands for nothing
            return None;
        }
        let message = "the second derivative of this by the velocity is singular, so that no velocity belongs to a momentum; \
                       each component of the velocity needs a kinetic energy";
        diagnostics.push(lagrangian, message);
        return None;
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
        diagnostics.push(hamiltonian, message);
        return None;
    }
    Some(())
}
