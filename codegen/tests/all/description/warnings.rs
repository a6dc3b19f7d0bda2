//! What has no effect.

use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::parse::{Attribute, Item};

use super::problems;
use crate::common::tokens;

/// The warnings about a description without problems.
fn warnings(attribute: &str, item: &str) -> Vec<(String, String)> {
    let mut found = Diagnostics::new();
    let attribute = Attribute::parse(tokens(attribute), &coadjoint_codegen::method::known(), &mut found);
    let item = Item::parse(tokens(item), &mut found).expect("a struct");
    let found = problems(&attribute, &item);
    assert!(found.is_empty());
    found.warnings().map(|(name, message)| (name, message.to_owned())).collect()
}

#[test]
fn what_has_no_effect_is_warned_of() {
    let body = "struct Body { #[inertia] j: f64, mass: f64, arm: Vector3<f64> }";
    let warned = |attribute: &str| -> Vec<String> {
        warnings(attribute, body).into_iter().map(|(name, message)| format!("{name}: {message}")).collect()
    };
    assert_eq!(warned("group = R3, potential = mass * position.dot(&arm)"), [""; 0]);
    assert_eq!(
        warned("group = R3, control(push: R3, pull: f64), force = push * mass"),
        [
            "arm: the parameter `arm` is in no energy and no force",
            "pull: the control `pull` is in no energy and no force",
        ]
    );
    assert_eq!(
        warned("group = R3, control(push: R3), potential = mass * position.dot(&(arm - push))"),
        [""; 0]
    );
    assert_eq!(
        warned("group = R3, hamiltonian = momentum.dot(&arm) / mass"),
        ["j: the inertia `j` is not in the Hamiltonian, which is the whole energy"]
    );
    // a name that a variable of a block takes is another name
    assert_eq!(
        warned("group = R3, potential = { let mass = 2.0; mass * position.dot(&arm) }"),
        ["mass: the parameter `mass` is in no energy and no force"]
    );
    // that would be told as problems of the same thing
    let mut found = Diagnostics::new();
    let attribute = Attribute::parse(
        tokens("group = R3, potential = maß * mass"),
        &coadjoint_codegen::method::known(),
        &mut found,
    );
    let item = Item::parse(tokens(body), &mut found).expect("a struct");
    assert_eq!(problems(&attribute, &item).warnings().count(), 0);
}
