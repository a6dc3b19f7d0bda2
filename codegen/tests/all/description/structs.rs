//! The struct as it is read.

use coadjoint_codegen::parse::without_helpers;
use coadjoint_codegen::quantity::{ScalarType, Shape};

use super::item;
use crate::common::tokens;

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
    for empty in ["struct A;", "struct A {}"] {
        assert!(item(empty, &[]).is_some_and(|item| item.fields.is_empty()));
    }
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
