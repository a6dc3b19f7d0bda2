//! Reading the attribute and the struct, and the rules between them.

use coadjoint_codegen::check;
use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::expr::Arena;
use coadjoint_codegen::model::System;
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
    let [factor] = &attribute.factors[..] else { panic!("one group") };
    assert!(factor.name.is_none() && factor.group == "SO3");
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
    assert!(attribute.factors.is_empty() && attribute.potential.is_none() && !attribute.has(GROUP));
    assert!(attribute.advected.is_empty());
}

#[test]
fn keys() {
    let read =
        attribute("grup = SO3, potential = a", &[("grup", "there is no key `grup`; did you mean `group`?")]);
    assert!(read.potential.is_some());
    attribute(
        "colour = red",
        &[(
            "colour",
            "there is no key `colour`; known: `group`, `advected`, `potential`, `hamiltonian`, `lagrangian`, `control`, `force`, `invariance`, `methods`, `retractions`, `derivatives` and `crate`",
        )],
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
    assert_eq!(read.factors[0].group, "SO3");
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
    assert!(!read.factors.is_empty() && read.potential.is_some());
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
    assert!(!read.factors.is_empty() && read.potential.is_none() && read.has(POTENTIAL));
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
        "struct A { #[inertia()] a: f64, #[inertia] #[inertia] b: f64 }",
        &[
            ("#[inertia()]", "`#[inertia(…)]` names the factors that it is the inertia of"),
            ("#[inertia]", "`#[inertia]` is given twice; once is enough"),
        ],
    );
}

#[test]
fn helpers_are_removed_from_what_cannot_be_read() {
    let cleaned = without_helpers(tokens("struct A<T>(#[inertia] f64, #[serde(skip)] T);"));
    assert_eq!(cleaned, syn::parse_str("struct A<T>(f64, #[serde(skip)] T);").ok());
    assert_eq!(without_helpers(tokens("enum A {}")), None);
}

/// Everything that is wrong with a description as a whole.
fn problems(attribute: &Attribute, item: &Item) -> Diagnostics {
    let mut found = Diagnostics::new();
    let description = check::resolve(attribute, item, &mut found);
    let arena = Arena::new();
    let system = System::build(&arena, &description, &mut found);
    assert_eq!(system.is_some(), description.is_sound());
    found
}

/// Asserts the rules that a description breaks.
#[track_caller]
fn breaks(attribute: &str, item: &str, expected: &[(&str, &str)]) {
    let mut diagnostics = Diagnostics::new();
    let attribute = Attribute::parse(tokens(attribute), &mut diagnostics);
    let text = item;
    let item = Item::parse(tokens(item), &mut diagnostics).expect("a struct");
    assert!(diagnostics.is_empty() || text.contains("Broken"), "{text}");
    let found = problems(&attribute, &item);
    compare(text, &told(found), expected);
}

/// What the whole of the macro says.
#[track_caller]
fn expands(attribute: &str, item: &str, expected: &[(&str, &str)]) {
    let error = coadjoint_codegen::expand(tokens(attribute), tokens(item)).err();
    let told = error.into_iter().flatten();
    let told = told.map(|error| (error.span().source_text().unwrap_or_default(), error.to_string()));
    compare(attribute, &told.collect::<Vec<_>>(), expected);
}

#[test]
fn energies_without_a_legendre_transform() {
    let bare = "struct Body { j: f64 }";
    let singular = "the second derivative of this by the velocity is singular";
    let sum = "(velocity.x + velocity.y + velocity.z).exp() * j";
    for degenerate in ["j * velocity.x.powi(2)", "j * velocity.y", sum] {
        expands(&format!("group = SO3, lagrangian = {degenerate}"), bare, &[(degenerate, singular)]);
    }
    // one problem, one error
    let vector = "velocity * j";
    expands(
        &format!("group = SO3, lagrangian = {vector}"),
        bare,
        &[(vector, "the Lagrangian must be a scalar, but this is a vector of 3")],
    );
    // no velocity has a momentum here, but only a tangent lift needs one
    let linear = "group = SO3, hamiltonian = j * momentum.z";
    expands(linear, bare, &[]);
    let singular = "the second derivative of this by the momentum is singular";
    expands(&format!("{linear}, methods(TangentLift)"), bare, &[("j * momentum.z", singular)]);
    expands("group = SO3, hamiltonian = j * momentum.norm_squared(), methods(TangentLift(1, 4))", bare, &[]);
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
fn bases_of_groups() {
    let body = "struct Body { #[inertia] j: f64 }";
    for sound in [
        "group = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] }, advected(v: R2), potential = v.x",
        "group(a: SL(2), b: matrices { x: [0, 1; -1, 0] }), potential = a[(0, 0)] + b.trace()",
        "group = SE2(3)",
        "group = SP(4)",
    ] {
        breaks(sound, body, &[]);
    }
    breaks(
        "group = matrices { a: [1, 0; 0, 1], b: [0, 1; 0, 0], c: [2, 1; 0, 2] }",
        body,
        &[("c", "`c` is a combination of the matrices before it")],
    );
    breaks(
        "group = matrices { a: [0, 1, 0; 0, 0, 0; 0, 0, 0], b: [0, 0, 0; 0, 0, 1; 0, 0, 0] }",
        body,
        &[("a", "the commutator [a, b] = a b − b a is no combination of the basis")],
    );
    breaks(
        "group = matrices { a: [0, 1; 0, 0], b: [1, 0] }",
        body,
        &[("b", "the matrices of a basis are square and of one size, 2 × 2 here; `b` is 1 × 2")],
    );
    breaks("group = SU(3)", body, &[("SU", "there are no steps on SU3: its Cayley map leaves the group")]);
    breaks(
        "group = SL(2), retractions(SecondKind)",
        body,
        &[("SL", "there are no steps on SL2 with `SecondKind`")],
    );
    breaks(
        "group = SL(2), advected(v: R3)",
        body,
        &[("R3", "`SL2` does not act on a space `R3`; known: `R2`")],
    );
    // neither large numbers nor many of them are more than an error
    breaks("group = SL(6)", body, &[("SL", "there is no group `SL6`")]);
    breaks("group = SU(3)", body, &[("SU", "there are no steps on SU3")]);
    let dense = (0..6).map(|i| {
        let row = |r: i64| {
            (0..6)
                .map(|c| (2_000_000_011 - 977 * (7 * i + 5 * r * r + c)).to_string())
                .collect::<Vec<_>>()
                .join(", ")
        };
        format!("a{i}: [{}]", (0..6).map(row).collect::<Vec<_>>().join("; "))
    });
    let dense = format!("group = matrices {{ {} }}", dense.collect::<Vec<_>>().join(", "));
    let mut diagnostics = Diagnostics::new();
    let attribute = Attribute::parse(tokens(&dense), &mut diagnostics);
    let item = Item::parse(tokens(body), &mut diagnostics).expect("a struct");
    let _ = check::resolve(&attribute, &item, &mut diagnostics);
    assert!(!told(diagnostics).is_empty());
    breaks("group = SO(40)", body, &[("SO", "there is no group `SO40`")]);
}

#[test]
fn rules() {
    let body = "struct Body { #[inertia] j: Vector3<f64> }";
    breaks("group = S4", body, &[("S4", "there is no group `S4`; known: `R1`, `R2`, `R3`")]);
    breaks("group = so3", body, &[("so3", "there is no group `so3`; did you mean `SO3`?")]);
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
fn factors() {
    let pair = "struct Pair { #[inertia(first)] j: Vector3<f64>, #[inertia(second)] m: f64 }";
    breaks("group(first: SO3, second: R3)", pair, &[]);
    breaks("group(first: SO3, second: R(3))", pair, &[]);
    breaks("group(first: SO3, second: R3)", "struct Pair { #[inertia] j: SMatrix<f64, 6, 6> }", &[]);
    breaks(
        "group(first: SO3, second: R3)",
        "struct Pair { #[inertia(first)] j: f64, #[inertia(frist)] k: f64 }",
        &[
            ("frist", "there is no factor `frist` of the group; did you mean `first`?"),
            ("Pair", "`second` has no inertia; mark one field with `#[inertia(second)]`"),
        ],
    );
    breaks(
        "group(first: SO3, second: R3)",
        "struct Pair { #[inertia] j: f64, #[inertia(second)] k: f64 }",
        &[("inertia", "`second` has several inertias, `j` and `k`")],
    );
    breaks(
        "group(first: SO3, second: R3)",
        "struct Pair { #[inertia] j: Vector3<f64> }",
        &[("Vector3<f64>", "`SO3` and `R3` together have dimension 6, so its inertia is a vector of 6")],
    );
    breaks(
        "group(first: SO3, second: SO3), advected(gamma: R3)",
        pair,
        &[("R3", "which factor acts on `gamma`, first or second? Write `gamma: first::R3`")],
    );
    breaks("group(first: SO3, second: SO3), advected(gamma: second::R3)", pair, &[]);
    breaks(
        "group(first: SO3, second: SO3), advected(gamma: third::R3)",
        pair,
        &[("third", "there is no factor `third`")],
    );
    breaks(
        "group(first: SO3, second: R3), advected(first: R3)",
        pair,
        &[("first", "`first` is also a factor of the group")],
    );
    attribute("group(a: SO3, a: R3)", &[("a", "`a` is named twice in `group`")]);
}

#[test]
fn energies_forces_and_controls() {
    let body = "struct Body { #[inertia] j: f64 }";
    let bare = "struct Body { j: f64 }";
    breaks("group = SO3, hamiltonian = momentum.norm_squared() / j", bare, &[]);
    breaks(
        "group = SO3, hamiltonian = momentum.x, potential = j",
        body,
        &[("momentum.x", "the Hamiltonian is the whole energy")],
    );
    breaks(
        "group = SO3, potential = j * momentum.x + velocity.y + u, control(u: f64)",
        body,
        &[
            ("momentum", "a potential does not depend on the momentum; an energy that does is written"),
            ("velocity", "a potential does not depend on the velocity"),
            ("u", "an energy does not depend on controls; they act through `force`"),
        ],
    );
    breaks(
        "group = SO3, hamiltonian = velocity.x",
        bare,
        &[("velocity", "an energy is a function of the momentum; write it in `momentum`")],
    );
    breaks("group = SO3, control(u: R3, w: f64), force = u - j * velocity + w * momentum", body, &[]);
    breaks(
        "group = SO3, force = j",
        body,
        &[("j", "this force must be a vector of 3, but this is a scalar")],
    );
    breaks("group = SO2, force = j * angle.sin_angle()", body, &[]);
    breaks(
        "group(a: SO3, b: R3), force = a_momentum, force(c = b)",
        "struct Broken { #[inertia] j: f64 }",
        &[("a_momentum", "on what does this force act? Write `force(a = …)`")],
    );
    breaks("group(a: SO3, b: R3), force(c = b)", body, &[("c", "there is no factor `c` to act on")]);
    breaks(
        "group = SO3, control(u: f32)",
        body,
        &[("f32", "this is made of `f32`, but the system of `f64`")],
    );
    breaks(
        "group = SO3, control(j: f64)",
        body,
        &[("j", "`j` is also a field of `Body`; a control needs a name of its own")],
    );
    breaks("group = SO3, hamiltonian = momentum.x, methods(TangentLift(1, 4))", bare, &[]);
    breaks("group = SO3, lagrangian = velocity.norm_squared() * j", bare, &[]);
    breaks(
        "group = SO3, lagrangian = velocity.x, potential = j, hamiltonian = momentum.x",
        bare,
        &[
            ("momentum.x", "the Hamiltonian is the whole energy"),
            ("velocity.x", "the Lagrangian is kinetic less potential energy"),
            ("velocity.x", "the Lagrangian says what the Hamiltonian is; give one of"),
        ],
    );
    breaks(
        "group = SE3, lagrangian = j * linear_velocity.x + angular_momentum.y + u, control(u: f64)",
        bare,
        &[
            (
                "angular_momentum",
                "a Lagrangian is a function of the velocity; write it in `angular_velocity`",
            ),
            ("u", "an energy does not depend on controls"),
        ],
    );
    attribute("control(u: String)", &[("String", "`u` cannot be of this type; a control is a number")]);
    attribute(
        "methods(Midpiont)",
        &[("Midpiont", "there is no method `Midpiont`; did you mean `Midpoint`?")],
    );
    attribute(
        "methods(Cayley)",
        &[("Cayley", "`Cayley` is a retraction, not a method: the standard steps with it are generated")],
    );
    attribute(
        "methods(Family(3, 2))",
        &[("Family", "the parameter s of a method is a fraction between 0 and 1")],
    );
    attribute("invariance = up", &[("up", "a system is `left`- or `right`-invariant")]);
}

#[test]
fn configurations_in_expressions() {
    let body = "struct Body { #[inertia] j: f64 }";
    breaks("group = SO3, potential = (attitude.inverse() * Vector3::z()).x + attitude.w", body, &[]);
    breaks(
        "group = SE3, potential = pose.translation.x + (pose * Point3::origin()).coords.dot(&(pose.rotation * Vector3::y()))",
        body,
        &[],
    );
    breaks("group = SO2, potential = angle.cos_angle() * j", body, &[]);
    breaks("group = R3, potential = position.norm().ln() * t.sin()", body, &[]);
    breaks(
        "group = SO3, potential = attitude.x",
        body,
        &[("x", "an element of SO3 has no component `x`, but `w`, `i`, `j` and `k`")],
    );
    breaks(
        "group = SO2, potential = angle.cos_angle",
        body,
        &[("cos_angle", "`cos_angle` is a method: write `.cos_angle()`")],
    );
    breaks(
        "group = SO3, potential = attitude.angle()",
        body,
        &[("angle", "an element of SO3 has no method `angle` here")],
    );
    breaks(
        "group = SO3, potential = (attitude * j).x",
        body,
        &[("*", "an element of SO3 cannot be multiplied by a scalar")],
    );
    breaks(
        "group = SO3, potential = attitude",
        body,
        &[("attitude", "the potential must be a scalar, but this is an element of SO3")],
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
    let attribute = Attribute::parse(tokens("group = 3"), &mut ignored);
    let item = Item::parse(tokens("struct A { #[inertia] j: f64 }"), &mut ignored).expect("a struct");
    let found = problems(&attribute, &item);
    assert!(found.is_empty());
}

#[test]
fn a_missing_group_is_reported_once() {
    let mut ignored = Diagnostics::new();
    let attribute = Attribute::parse(TokenStream::new(), &mut ignored);
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
        &mut found,
    );
    assert_eq!(found.len(), 3);
    let item = Item::parse(tokens("struct A { #[inertia(a)] j: f64 }"), &mut found).expect("a struct");
    compare("names", &told(problems(&attribute, &item)), &[]);
}

/// The warnings about a description without problems.
fn warnings(attribute: &str, item: &str) -> Vec<(String, String)> {
    let mut found = Diagnostics::new();
    let attribute = Attribute::parse(tokens(attribute), &mut found);
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
        ["arm: the parameter `arm` is in no energy and no force", "pull: the control `pull` is in no force"]
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
    let attribute = Attribute::parse(tokens("group = R3, potential = maß * mass"), &mut found);
    let item = Item::parse(tokens(body), &mut found).expect("a struct");
    assert_eq!(problems(&attribute, &item).warnings().count(), 0);
}

#[test]
fn inertias_beside_a_hamiltonian() {
    breaks(
        "group = SO3, hamiltonian = momentum.dot(&(j.try_inverse().unwrap() * momentum)) / 2.0",
        "struct Body { #[inertia] j: Matrix3<f64> }",
        &[],
    );
    // some factors only, and several for one
    breaks(
        "group(a: SO3, b: R3), hamiltonian = a_momentum.dot(&a_momentum.component_div(&(j + k))) + b_momentum.norm()",
        "struct Body { #[inertia(a)] j: Vector3<f64>, #[inertia(a)] k: Vector3<f64> }",
        &[],
    );
    breaks(
        "group = SO3, hamiltonian = momentum.x * j.m11",
        "struct Body { #[inertia] j: Matrix2x3<f64> }",
        &[(
            "Matrix2x3<f64>",
            "an inertia is a scalar, a vector or a square matrix, but this is a 2×3 matrix",
        )],
    );
    // of the angular part alone
    breaks(
        "group = SE3, hamiltonian = (j.try_inverse().unwrap() * angular_momentum).dot(&angular_momentum) + linear_momentum.norm()",
        "struct Body { #[inertia] j: Matrix3<f64> }",
        &[],
    );
}

#[test]
fn equal_factors_share_an_inertia() {
    let pair = |ty: &str| format!("struct Pair {{ #[inertia] j: {ty} }}");
    let equal = "group(a: SO3, b: SO3)";
    for ty in ["f64", "Vector3<f64>", "Matrix3<f64>", "Vector6<f64>", "Matrix6<f64>"] {
        breaks(equal, &pair(ty), &[]);
    }
    breaks(
        equal,
        &pair("Vector2<f64>"),
        &[(
            "Vector2<f64>",
            "`SO3` and `SO3` together have dimension 6, so its inertia is a vector of 6 (a diagonal), a 6×6 matrix or a \
            scalar, but this is a vector of 2; where all have the same inertia, a vector of 3 or a 3×3 matrix will do",
        )],
    );
    // of equal dimension, but not the same thing
    breaks(
        "group(a: SO3, b: R3)",
        &pair("Vector3<f64>"),
        &[("Vector3<f64>", "`SO3` and `R3` together have dimension 6")],
    );
    breaks(
        "group(a: SO3, b: R1, c: SO3)",
        "struct Three { #[inertia(a, c)] j: Vector3<f64>, #[inertia(b)] m: f64 }",
        &[],
    );
}

#[test]
fn parts_of_momenta() {
    let body = "struct Body { #[inertia] j: f64 }";
    breaks(
        "group = SE3, hamiltonian = angular_momentum.norm_squared() / j + linear_momentum.dot(&momentum.fixed_rows::<3>(3))",
        "struct Body { j: f64 }",
        &[],
    );
    breaks(
        "group = SE2, hamiltonian = angular_momentum.powi(2) / j + linear_momentum.y",
        "struct Body { j: f64 }",
        &[],
    );
    breaks(
        "group = SE3, force = (-j * angular_velocity, linear_momentum.cross(&linear_velocity))",
        body,
        &[],
    );
    breaks("group = SE2, force = (-j * angular_velocity, -linear_velocity)", body, &[]);
    breaks(
        "group(hull: SE3, rotor: SO2), force(hull = (hull_angular_momentum, hull_linear_velocity))",
        body,
        &[],
    );
    breaks(
        "group = SE3, force = (angular_velocity, j)",
        body,
        &[(
            "(angular_velocity, j)",
            "this force must be a vector of 6, or its parts `(angular, linear)`, but this is a tuple of 2",
        )],
    );
    breaks(
        "group = SE2, force = angular_velocity",
        body,
        &[(
            "angular_velocity",
            "this force must be a vector of 3, or its parts `(angular, linear)`, but this is a scalar",
        )],
    );
}

#[test]
fn parts_of_momenta_are_names_like_others() {
    let body = "struct Body { #[inertia] j: f64 }";
    breaks(
        "group = SE3, potential = linear_momentum.x + angular_velocity.x",
        body,
        &[
            ("linear_momentum", "a potential does not depend on the momentum"),
            ("angular_velocity", "a potential does not depend on the velocity"),
        ],
    );
    breaks(
        "group = SE3, hamiltonian = linear_velocity.x",
        "struct Body { j: f64 }",
        &[("linear_velocity", "an energy is a function of the momentum; write it in `linear_momentum`")],
    );
    breaks(
        "group = SE3, control(linear_velocity: R3)",
        body,
        &[(
            "linear_velocity",
            "`linear_velocity` is a part of the velocity of this system; choose another name",
        )],
    );
    // other groups have no such parts, and leave the names alone
    breaks("group = SO3, control(linear_velocity: R3), force = linear_velocity", body, &[]);
    breaks(
        "group = SE3, potential = pose.momentum",
        body,
        &[("momentum", "an element of SE3 has no component `momentum`, but `rotation` and `translation`")],
    );
}

#[test]
fn points() {
    let body = "struct Body { #[inertia] j: f64, arm: Vector3<f64> }";
    breaks("group = SE3, potential = pose.transform_point(&Point3::from(arm)).z", body, &[]);
    breaks(
        "group = SE3, potential = (pose * arm).z",
        body,
        &[(
            "*",
            "`*` only turns a vector, as in nalgebra; write `pose.transform_vector(&v)` if that is meant, or",
        )],
    );
    breaks(
        "group = SE3, potential = pose.transform_point(&arm).z",
        body,
        &[(
            "&arm",
            "`transform_point` of an element of SE3 does not take a vector of 3; the point is `Point3::from(v)`",
        )],
    );
    breaks(
        "group = SO3, potential = attitude.transform_vector(&Point3::from(arm)).z",
        body,
        &[(
            "&Point3::from(arm)",
            "`transform_vector` of an element of SO3 does not take a point in 3 dimensions; the vector to it is `p.coords`",
        )],
    );
    breaks(
        "group = SE2, potential = pose.transform_point(&Point3::from(arm)).x",
        body,
        &[(
            "&Point3::from(arm)",
            "`transform_point` of an element of SE2 does not take a point in 3 dimensions",
        )],
    );
    breaks(
        "group = SE3, potential = (Point3::from(arm) + Point3::origin()).x",
        body,
        &[("+", "a point in 3 dimensions cannot be added to a point in 3 dimensions")],
    );
    breaks(
        "group = SE3, potential = Point3::from(j).x + Point3::new(j, j).x + Point3::form(arm).x + Point2::from(arm).x",
        body,
        &[
            ("j", "`Point3::from` takes a vector of 3, but this is a scalar"),
            ("new", "`Point3::new` takes 3 arguments, not 2"),
            ("form", "there is no `Point3::form` here; did you mean `from`?"),
            ("arm", "`Point2::from` takes a vector of 2, but this is a vector of 3"),
        ],
    );
    breaks(
        "group = SE3, potential = Point3::from(arm).norm()",
        body,
        &[("norm", "a point in 3 dimensions has no methods")],
    );
}
