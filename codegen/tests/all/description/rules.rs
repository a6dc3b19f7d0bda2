//! Rules between the parts of a description, and no false errors after a first.

use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::parse::{Attribute, Item};
use proc_macro2::TokenStream;

use super::{breaks, expands, problems};
use crate::common::{compare, tokens, told};

#[test]
fn a_sound_description_breaks_no_rule() {
    for inertia in ["f64", "Vector3<f64>", "Matrix3<f64>"] {
        breaks("group = SO3", &format!("struct A {{ #[inertia] j: {inertia} }}"), &[]);
    }
    breaks(
        "group = SO3, advected(gamma: R3), potential = g * gamma.z",
        "struct A { #[inertia] j: f64, g: f64 }",
        &[],
    );
}

#[test]
fn rules() {
    let body = "struct Body { #[inertia] j: Vector3<f64> }";
    breaks("group = S4", body, &[("S4", "there is no group `S4`; known: `R1`, `R2`, `R3`")]);
    breaks("group = so3", body, &[("so3", "there is no group `so3`; did you mean `SO3`?")]);
    // what a misspelt key declares is not said to be missing too
    let key = ("controls", "there is no key `controls`; did you mean `control`?");
    expands("group = SO3, controls(torque: R3), force = torque", body, &[key]);
    breaks("group = Circle", body, &[("Circle", "there is no group `Circle`; known: `R1`")]);
    breaks(
        "group = SO3, advected(p: R2)",
        body,
        &[("R2", "`SO3` does not act on a space `R2`; known: `R3`")],
    );
    breaks(
        "group = SO3, advected(p: Q7)",
        body,
        &[("Q7", "`SO3` does not act on a space `Q7`; known: `R3`")],
    );
    breaks(
        "group = SO3, advected(j: R3)",
        body,
        &[("j", "`j` is also a field of `Body`; an advected parameter needs a name")],
    );
    breaks(
        "group = SO3",
        "struct Body { j: f64 }",
        &[("Body", "which parameter is the inertia? Mark one field")],
    );
    breaks(
        "group = SO3",
        "struct Body { #[inertia] j: f64, #[inertia] k: f64 }",
        &[
            ("inertia", "a system has one inertia, but `j` and `k` are marked; keep one `#[inertia]`"),
            ("inertia", "a system has one inertia, but `j` and `k` are marked; keep one `#[inertia]`"),
        ],
    );
    breaks(
        "group = SO3",
        "struct Body { #[inertia] j: Matrix2x3<f64> }",
        &[(
            "Matrix2x3<f64>",
            "`SO3` has dimension 3, so its inertia is a vector of 3 (principal moments), a 3×3 matrix or a scalar, but this \
         is a 2×3 matrix",
        )],
    );
    breaks(
        "group = SO3, advected(attitude: R3)",
        "struct Body { #[inertia] momentum: f64, __a: f64 }",
        &[
            ("momentum", "`momentum` is the momentum of this system; choose another name"),
            ("__a", "names that begin with `__` belong to the generated code"),
            ("attitude", "`attitude` is the configuration of this system; choose another name"),
        ],
    );
}

#[test]
fn the_potential_is_looked_at_whatever_else_is_wrong() {
    let body = "struct Body { #[inertia] j: f64, weight: f64, r#type: f64 }";
    breaks(
        "group = S4, advected(gamma: R3), potential = wieght * gamma.z + r#type",
        body,
        &[("S4", "there is no group"), ("wieght", "there is no `wieght` here; did you mean `weight`?")],
    );
    breaks(
        "group(a: S4, b: SO3), potential = a * b_momentum",
        "struct Body { #[inertia(a)] j: f64, #[inertia(b)] k: f64 }",
        &[("S4", "there is no group"), ("b_momentum", "a potential does not depend on the momentum")],
    );
    breaks(
        "group = SO3, advected(gamma: R3), potential = weight * gamma",
        "struct Body { weight: f64 }",
        &[
            ("Body", "which parameter is the inertia?"),
            ("weight * gamma", "the potential must be a scalar, but this is a vector of 3"),
        ],
    );
    breaks(
        "group = SO3, advected(gamma: R9), potential = weight * gamma.z",
        body,
        &[("R9", "`SO3` does not act")],
    );
}

#[test]
fn what_could_not_be_read_is_not_missing() {
    breaks("group = SO3", "struct A { #[inertia] j: Broken }", &[]);
    let mut ignored = Diagnostics::new();
    let attribute = Attribute::parse(tokens("group = 3"), &coadjoint_codegen::method::known(), &mut ignored);
    let item = Item::parse(tokens("struct A { #[inertia] j: f64 }"), &mut ignored).expect("a struct");
    let found = problems(&attribute, &item);
    assert!(found.is_empty());
}

#[test]
fn a_missing_group_is_reported_once() {
    let mut ignored = Diagnostics::new();
    let attribute = Attribute::parse(TokenStream::new(), &coadjoint_codegen::method::known(), &mut ignored);
    let item = Item::parse(tokens("struct A { #[inertia] j: f64 }"), &mut ignored).expect("a struct");
    let found = problems(&attribute, &item);
    let [(_, message)] = &told(found)[..] else { panic!("one problem") };
    assert!(
        message.starts_with(
            "the group of the configuration is missing; write `#[lie_poisson_system(group = SO3"
        )
    );
}

#[test]
fn names_of_what_could_not_be_read_are_no_further_problems() {
    let mut found = Diagnostics::new();
    let attribute = Attribute::parse(
        tokens(
            "group(a: SO(n), b: R3), advected(gamma: 3), control(u: String), potential = gamma.z + a.x, force(b = u * a_momentum)",
        ),
        &coadjoint_codegen::method::known(),
        &mut found,
    );
    assert_eq!(found.len(), 3);
    let item = Item::parse(tokens("struct A { #[inertia(a)] j: f64 }"), &mut found).expect("a struct");
    compare("names", &told(problems(&attribute, &item)), &[]);
}
