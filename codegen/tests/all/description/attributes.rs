//! The attribute as it is read.

use coadjoint_codegen::parse::{EnergyKey, Key};
use coadjoint_codegen::quantity::Direction;

const POTENTIAL: Key = Key::Energy(EnergyKey::Potential);
use quote::quote;

use super::{advected, attribute};

#[test]
fn a_whole_attribute() {
    let attribute = attribute(
        "group = SO3, advected(gamma: R3, delta: R3,), potential = weight * gamma.dot(&chi) + f(1, 2), \
         crate = my::coadjoint,",
        &[],
    );
    let [factor] = &attribute.factors[..] else { panic!("one group") };
    assert!(factor.name.is_none() && factor.group.keyword() == "SO3");
    assert_eq!(advected(&attribute), ["gamma: R3", "delta: R3"]);
    let potential = attribute.energy(EnergyKey::Potential).expect("a potential");
    assert_eq!(quote!(#potential).to_string(), quote!(weight * gamma.dot(&chi) + f(1, 2)).to_string());
    let path = attribute.krate.as_ref().expect("a path");
    assert_eq!(quote!(#path).to_string(), "my :: coadjoint");
    assert!(attribute.has(Key::Group) && attribute.has(POTENTIAL));
}

#[test]
fn nothing_is_an_attribute_too() {
    let attribute = attribute("", &[]);
    assert!(attribute.factors.is_empty() && attribute.energies.is_empty() && !attribute.has(Key::Group));
    assert!(attribute.advected.is_empty());
}

#[test]
fn keys() {
    let read =
        attribute("grup = SO3, potential = a", &[("grup", "there is no key `grup`; did you mean `group`?")]);
    assert!(read.energy(EnergyKey::Potential).is_some() && read.has(Key::Group));
    // the right one counts, wherever it stands
    for both in ["grup = SO3, group = SO2", "group = SO2, grup = SO3"] {
        let read = attribute(both, &[("grup", "there is no key `grup`; did you mean `group`?")]);
        let factors = format!("{:?}", read.factors);
        assert!(factors.contains("SO2") && !factors.contains("SO3"), "{factors}");
    }
    attribute(
        "colour = red",
        &[(
            "colour",
            "there is no key `colour`; known: `group`, `advected`, `potential`, `hamiltonian`, `lagrangian`, `control`, `force`, `event`, `invariance`, `methods`, `retractions`, `derivatives`, `taylor`, `units`, `scalar` and `crate`",
        )],
    );
    attribute("group = SO3, group = SO2", &[("group", "`group` is given twice; keep one of them")]);
    attribute("3, group = SO3", &[("3", "expected a key, such as `group = SO3`")]);
    attribute(", group = SO3", &[(",", "expected a key, such as `group = SO3`")]);
}

#[test]
fn events() {
    let read = attribute("group = R3, event(apogee = a + b, falling, high = c, low = d, both, at = e)", &[]);
    let read: Vec<_> = read.events.iter().map(|one| (one.name.to_string(), one.direction)).collect();
    let expected = [("apogee", Direction::Falling), ("high", Direction::Both), ("low", Direction::Both)];
    let expected = expected.into_iter().chain([("at", Direction::Both)]);
    assert_eq!(read, expected.map(|(name, direction)| (name.to_owned(), direction)).collect::<Vec<_>>());
    attribute("event(a = b, faling)", &[("faling", "`faling` has no quantity; did you mean `falling`?")]);
    attribute("event(a)", &[("a", "`a` has no quantity; write `event(apogee = ")]);
    attribute("event(3)", &[("3", "expected a name, `=` and a quantity; write `event(apogee = ")]);
    attribute("event(a = b, a = c)", &[("a", "`a` is named twice in `event`")]);
    attribute("event = b", &[("=", "expected parentheses; write `event(apogee = ")]);
}

#[test]
fn values() {
    let read = attribute(
        "group = , potential = , advected",
        &[
            ("=", "`group` has no value; write `group = SO3`"),
            ("=", "`potential` has no value; write `potential = "),
            ("advected", "expected parentheses; write `advected(gamma: R3)`"),
        ],
    );
    assert!(read.has(Key::Group) && read.has(Key::Advected));
    attribute("group(SO3)", &[("SO3", "`SO3` needs the group it moves on; write `SO3: SO3`")]);
    attribute("group = 3, potential = 1.0", &[("3", "expected identifier; write `group = SO3`")]);
    attribute("advected = gamma", &[("=", "expected parentheses; write")]);
    attribute("advected[gamma: R3]", &[("[", "expected parentheses; write")]);
    attribute("advected()", &[("advected", "`advected` names nothing; write")]);
    attribute("potential == a", &[("=", "expected `=`; write")]);
    attribute(
        "crate = \"my::path\"",
        &[("\"my::path\"", "write the path without quotes: `crate = my::path`")],
    );
    attribute("crate = ", &[("=", "`crate` has no value; write `crate = path::to::coadjoint`")]);
    attribute("crate: a", &[(":", "expected `=`; write `crate = path::to::coadjoint`")]);
    let read = attribute("group = SO(3)", &[]);
    assert_eq!(*read.factors[0].group.keyword(), "SO3");
    attribute("group = SO(n)", &[("SO", "write the name of the group in one word, such as `SO3`")]);
    attribute(
        "crate = a::<b>",
        &[("<", "expected path segment after `::`; write `crate = path::to::coadjoint`")],
    );
}

#[test]
fn commas() {
    let read = attribute(
        "group = SO3 advected(gamma: R3 delta: R3) potential = a",
        &[
            ("advected", "expected a comma before this"),
            ("delta", "expected a comma before this"),
            ("potential", "expected a comma before this"),
        ],
    );
    assert_eq!(advected(&read), ["gamma: R3", "delta: R3"]);
    assert!(!read.factors.is_empty() && read.energy(EnergyKey::Potential).is_some());
    let read = attribute(
        "group = SO3 SO2, potential = a b c, advected(gamma: R3)",
        &[("SO2", "expected a comma before this"), ("b", "expected a comma before this")],
    );
    assert_eq!(read.advected.len(), 1);
}

#[test]
fn advected_parameters() {
    let read = attribute(
        "advected(gamma: R3, gamma: R3, delta, : R3, eta: 3, zeta: R3), group = SO3",
        &[
            ("gamma", "`gamma` is named twice in `advected`"),
            ("delta", "`delta` needs the space it lives in; write `delta: R3`"),
            (":", "expected a name; an advected parameter is written `gamma: R3`"),
            ("3", "expected a space; an advected parameter is written `gamma: R3`"),
        ],
    );
    assert_eq!(advected(&read), ["gamma: R3", "zeta: R3"]);
    assert!(!read.factors.is_empty());
}

#[test]
fn problems_inside_an_expression_end_with_it() {
    let read = attribute("potential = a.dot(1 2) + , group = SO3", &[("2", "expected `,`")]);
    assert!(!read.factors.is_empty() && read.energies.is_empty() && read.has(POTENTIAL));
    attribute(
        "potential = (a + ) * 2.0, grup = SO3",
        &[(")", "unexpected end of input, expected an expression"), ("grup", "there is no key `grup`")],
    );
}
