//! What a description needs of the second derivatives of its energy.

use crate::diagnostics::Diagnostics;
use crate::model::{EnergyKey, Relation, System};
use crate::parse::Attribute;

/// Reports a Lagrangian without a velocity for each momentum, and tangent lifts without a momentum for each velocity. `None` if so.
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
