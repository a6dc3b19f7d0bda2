//! Reading the attribute and the struct, and the rules between them.

use coadjoint_codegen::check::{self, GroupFacts};
use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::parse::{
    ADVECTED, Attribute, GROUP, Item, POTENTIAL, ScalarType, Shape, without_helpers,
};
use proc_macro2::TokenStream;
use quote::quote;

/// The problems found, each as the text it underlines and the message.
fn told(diagnostics: Diagnostics) -> Vec<(String, String)> {
    let errors = diagnostics.finish().err().into_iter().flatten();
    errors.map(|error| (error.span().source_text().unwrap_or_default(), error.to_string())).collect()
}

fn tokens(text: &str) -> TokenStream {
    text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// Asserts what is underlined and how the messages begin.
#[track_caller]
fn compare(text: &str, problems: &[(String, String)], expected: &[(&str, &str)]) {
    assert_eq!(problems.len(), expected.len(), "{text}: {problems:#?}");
    for ((place, message), (expected_place, beginning)) in problems.iter().zip(expected) {
        assert_eq!(place, expected_place, "{text}: {message}");
        assert!(message.starts_with(beginning), "{text}: {message}");
    }
}

#[track_caller]
fn attribute(text: &str, expected: &[(&str, &str)]) -> Attribute {
    let mut diagnostics = Diagnostics::new();
    let attribute = Attribute::parse(tokens(text), &mut diagnostics);
    compare(text, &told(diagnostics), expected);
    attribute
}

#[track_caller]
fn item(text: &str, expected: &[(&str, &str)]) -> Option<Item> {
    let mut diagnostics = Diagnostics::new();
    let item = Item::parse(tokens(text), &mut diagnostics);
    compare(text, &told(diagnostics), expected);
    item
}

fn advected(attribute: &Attribute) -> Vec<String> {
    attribute.advected.iter().map(|parameter| format!("{}: {}", parameter.name, parameter.space)).collect()
}

#[test]
fn a_whole_attribute() {
    let attribute = attribute(
        "group = SO3, advected(gamma: R3, delta: R3,), potential = weight * gamma.dot(&chi) + f(1, 2), \
         crate = my::coadjoint,",
        &[],
    );
    assert_eq!(attribute.group.as_ref().expect("a group"), "SO3");
    assert_eq!(advected(&attribute), ["gamma: R3", "delta: R3"]);
    let potential = attribute.potential.as_ref().expect("a potential");
    assert_eq!(quote!(#potential).to_string(), quote!(weight * gamma.dot(&chi) + f(1, 2)).to_string());
    let path = attribute.krate.as_ref().expect("a path");
    assert_eq!(quote!(#path).to_string(), "my :: coadjoint");
    assert!(attribute.has(GROUP) && attribute.has(POTENTIAL));
}

#[test]
fn nothing_is_an_attribute_too() {
    let attribute = attribute("", &[]);
    assert!(attribute.group.is_none() && attribute.potential.is_none() && !attribute.has(GROUP));
    assert!(attribute.advected.is_empty());
}

#[test]
fn keys() {
    let read =
        attribute("grup = SO3, potential = a", &[("grup", "there is no key `grup`; did you mean `group`?")]);
    assert!(read.potential.is_some());
    attribute(
        "colour = red",
        &[("colour", "there is no key `colour`; known: `group`, `advected`, `potential` and `crate`")],
    );
    attribute("group = SO3, group = SO2", &[("group", "`group` is given twice; keep one of them")]);
    attribute("3, group = SO3", &[("3", "expected a key, such as `group = SO3`")]);
    attribute(", group = SO3", &[(",", "expected a key, such as `group = SO3`")]);
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
    assert!(read.has(GROUP) && read.has(ADVECTED));
    attribute("group(SO3)", &[("(", "expected `=`; write `group = SO3`")]);
    attribute("group = 3, potential = 1.0", &[("3", "expected identifier; write `group = SO3`")]);
    attribute("advected = gamma", &[("=", "expected parentheses; write")]);
    attribute("advected[gamma: R3]", &[("[", "expected parentheses; write")]);
    attribute("advected()", &[("advected", "`advected` names no parameter; write")]);
    attribute("potential == a", &[("=", "expected `=`; write")]);
    attribute(
        "crate = \"my::path\"",
        &[("\"my::path\"", "write the path without quotes: `crate = my::path`")],
    );
    attribute("crate = ", &[("=", "`crate` has no value; write `crate = path::to::coadjoint`")]);
    attribute("crate: a", &[(":", "expected `=`; write `crate = path::to::coadjoint`")]);
    attribute("group = SO(3)", &[("SO(3)", "write the name of the group in one word: `SO3`")]);
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
    assert!(read.group.is_some() && read.potential.is_some());
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
            ("gamma", "two advected parameters are called `gamma`"),
            ("delta", "`delta` needs the space it lives in; write `delta: R3`"),
            (":", "expected a name; an advected parameter is written `gamma: R3`"),
            ("3", "expected a space; an advected parameter is written `gamma: R3`"),
        ],
    );
    assert_eq!(advected(&read), ["gamma: R3", "zeta: R3"]);
    assert!(read.group.is_some());
}

#[test]
fn problems_inside_an_expression_end_with_it() {
    let read = attribute("potential = a.dot(1 2) + , group = SO3", &[("2", "expected `,`")]);
    assert!(read.group.is_some() && read.potential.is_none() && read.has(POTENTIAL));
    attribute(
        "potential = (a + ) * 2.0, grup = SO3",
        &[(")", "unexpected end of input, expected an expression"), ("grup", "there is no key `grup`")],
    );
}

const TOP: &str = "
    /// A top.
    ///
    ///     with code
    #[derive(Clone)]
    pub(crate) struct Top {
        /// Moments.
        ///
        /// About the fixed point.
        #[inertia]
        #[serde(default)]
        pub inertia: Vector3<f64>,
        weight: f64,
    }";

#[test]
fn a_whole_struct() {
    let top = item(TOP, &[]).expect("a struct");
    assert_eq!(top.name, "Top");
    assert_eq!(top.docs, ["A top.", "", "    with code"]);
    let [inertia, weight] = top.fields.as_slice() else { panic!("two fields") };
    assert_eq!((inertia.name.to_string().as_str(), inertia.shape), ("inertia", Shape::Vector(3)));
    assert_eq!((inertia.doc.as_str(), weight.doc.as_str()), ("Moments.", ""));
    assert_eq!((weight.shape, weight.scalar), (Shape::Scalar, ScalarType::F64));
    assert!(inertia.inertia.is_some() && weight.inertia.is_none());
    let without: syn::ItemStruct = syn::parse_str(&TOP.replace("#[inertia]", "")).expect("a struct");
    assert_eq!(top.declaration, without);
}

#[test]
fn what_is_no_struct_with_named_fields() {
    item("enum A { B }", &[("enum A { B }", "`#[lie_poisson_system]` describes a struct")]);
    item("fn a() {}", &[("fn a() {}", "`#[lie_poisson_system]` describes a struct")]);
    item("struct A(f64);", &[("(f64)", "the parameters of a system need names")]);
    item("struct A;", &[("A", "a system needs parameters, at least its inertia")]);
    let none = item(
        "struct A<T, const N: usize> { #[inertia] a: T }",
        &[("<T, const N: usize>", "a system cannot be generic"), ("T", "`a` cannot be of this type")],
    );
    assert!(none.is_none());
}

#[test]
fn fields() {
    let read = item(
        "struct A { #[inertia] a: Vec<f64>, b: f64, c: (f64, f64) }",
        &[
            ("Vec<f64>", "`a` cannot be of this type; a parameter is `f64`, `f32`, or a vector or matrix"),
            ("(f64, f64)", "`c` cannot be of this type"),
        ],
    );
    let read = read.expect("a struct");
    assert_eq!(read.fields.len(), 1);
    assert!(read.unreadable[0].name == "a" && read.unreadable[0].inertia.is_some());
    item(
        "struct A { a: f64, b: Vector3<f32>, c: f64 }",
        &[("Vector3<f32>", "this is made of `f32`, but `a` of `f64`; use one of them")],
    );
    item(
        "struct A { #[cfg(unix)] a: f64 }",
        &[("#[cfg(unix)]", "the parameters of a system cannot depend on `cfg`")],
    );
    item(
        "struct A { #[inertia(body)] a: f64, #[inertia] #[inertia] b: f64 }",
        &[
            ("#[inertia(body)]", "`#[inertia]` takes no arguments"),
            ("#[inertia]", "`#[inertia]` is given twice; once is enough"),
        ],
    );
}

#[test]
fn helpers_are_removed_from_what_cannot_be_read() {
    let cleaned = without_helpers(tokens("struct A<T>(#[inertia] f64, #[serde(skip)] T);"));
    assert_eq!(cleaned.to_string(), tokens("struct A<T>(f64, #[serde(skip)] T);").to_string());
    assert_eq!(without_helpers(tokens("enum A {}")).to_string(), "enum A { }");
}

fn catalogue() -> Vec<GroupFacts> {
    vec![
        GroupFacts { name: "SO3", dimension: 3, spaces: vec![("R3", 3)] },
        GroupFacts { name: "SE2", dimension: 3, spaces: vec![("R2", 2), ("R3", 3)] },
    ]
}

/// Asserts the rules that a description breaks.
#[track_caller]
fn breaks(attribute: &str, item: &str, expected: &[(&str, &str)]) {
    let mut diagnostics = Diagnostics::new();
    let attribute = Attribute::parse(tokens(attribute), &mut diagnostics);
    let text = item;
    let item = Item::parse(tokens(item), &mut diagnostics).expect("a struct");
    assert!(diagnostics.is_empty() || text.contains("Broken"), "{text}");
    let mut found = Diagnostics::new();
    check::structure(&attribute, &item, &catalogue(), &mut found);
    check::potential(&attribute, &item, &catalogue(), &mut found);
    compare(text, &told(found), expected);
}

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
    breaks("group = SO4", body, &[("SO4", "there is no group `SO4`; did you mean `SO3`?")]);
    breaks("group = Circle", body, &[("Circle", "there is no group `Circle`; known: `SO3` and `SE2`")]);
    breaks(
        "group = SO3, advected(p: R2)",
        body,
        &[("R2", "SO3 does not act on a space `R2`; did you mean `R3`?")],
    );
    breaks("group = SO3, advected(p: Q7)", body, &[("Q7", "SO3 does not act on a space `Q7`; known: `R3`")]);
    breaks(
        "group = SO3, advected(j: R3)",
        body,
        &[("j", "`j` is also a field of `Body`; the advected parameter")],
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
            "SO3 has dimension 3, so its inertia is a vector of 3 (principal moments), a 3×3 matrix or a scalar, but this \
         is a 2×3 matrix",
        )],
    );
    breaks(
        "group = SO3, advected(attitude: R3)",
        "struct Body { #[inertia] momentum: f64, __a: f64 }",
        &[
            ("momentum", "`momentum` is the momentum of every system; choose another name"),
            ("__a", "names that begin with `__` belong to the generated code"),
            ("attitude", "`attitude` is the configuration of every system; choose another name"),
        ],
    );
}

#[test]
fn the_potential_is_looked_at_whatever_else_is_wrong() {
    let body = "struct Body { #[inertia] j: f64, weight: f64, r#type: f64 }";
    breaks(
        "group = SO4, advected(gamma: R3), potential = wieght * gamma.z + r#type",
        body,
        &[("SO4", "there is no group"), ("wieght", "there is no `wieght` here; did you mean `weight`?")],
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
        &[("R9", "SO3 does not act")],
    );
}

#[test]
fn what_could_not_be_read_is_not_missing() {
    breaks("group = SO3", "struct A { #[inertia] j: Broken }", &[]);
    let mut ignored = Diagnostics::new();
    let attribute = Attribute::parse(tokens("group = 3"), &mut ignored);
    let item = Item::parse(tokens("struct A { #[inertia] j: f64 }"), &mut ignored).expect("a struct");
    let mut found = Diagnostics::new();
    check::structure(&attribute, &item, &catalogue(), &mut found);
    check::potential(&attribute, &item, &catalogue(), &mut found);
    assert!(found.is_empty());
}

#[test]
fn a_missing_group_is_reported_once() {
    let mut ignored = Diagnostics::new();
    let attribute = Attribute::parse(TokenStream::new(), &mut ignored);
    let item = Item::parse(tokens("struct A { #[inertia] j: f64 }"), &mut ignored).expect("a struct");
    let mut found = Diagnostics::new();
    check::structure(&attribute, &item, &catalogue(), &mut found);
    check::potential(&attribute, &item, &catalogue(), &mut found);
    let [(_, message)] = &told(found)[..] else { panic!("one problem") };
    assert!(
        message.starts_with(
            "the group of the configuration is missing; write `#[lie_poisson_system(group = SO3"
        )
    );
}
