//! Headers for C: what stands in them. That they compile, and compute what Rust computes, is tested with the catalogue (`systems/tests/c99.rs`).

use coadjoint_codegen::emit::c99::{Options, Steps};
use coadjoint_codegen::program::solver;

use crate::common::tokens;

/// A small header, for review: an explicit step, which needs no solver.
#[test]
fn a_small_header() {
    let (attribute, item) = (
        "group(position: R1), control(push: f64), potential = stiffness * position.x * position.x / 2.0, force = vector![push]",
        "/// A mass on a spring.\nstruct Spring {\n    /// The mass.\n    #[inertia]\n    #[unit(\"kg\")]\n    mass: f64,\n    #[unit(\"N/m\")]\n    stiffness: f64,\n}",
    );
    let options = Options { steps: vec![Steps::of("SymplecticEulerA<Cayley>")], ..Options::default() };
    let header = coadjoint_codegen::c99(tokens(attribute), tokens(item), &options);
    let header = header.or_else(|_| {
        let options =
            Options { steps: vec![Steps::of("SymplecticEulerA<Exponential>")], ..Options::default() };
        coadjoint_codegen::c99(tokens(attribute), tokens(item), &options)
    });
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    let text =
        format!("{attribute}\n{item}\n\n// ─── becomes ───\n\n{}", header.expect("a header").trim_end());
    settings.bind(|| insta::assert_snapshot!("c99_spring", text));
}

/// The solver in C has the numbers of the library's.
#[test]
fn solvers_have_the_same_numbers() {
    let constants = include_str!("../../../runtime/src/solve/constants.rs");
    let predictor = include_str!("../../../runtime/src/solve/predictor.rs");
    let mut compared = 0;
    for text in [constants, predictor] {
        for line in
            text.lines().filter(|line| line.starts_with("pub(super) const ") || line.starts_with("const "))
        {
            let (name, value) =
                line.split_once("const ").and_then(|(_, rest)| rest.split_once(": ")).expect("a constant");
            let value =
                value.split_once("= ").and_then(|(_, value)| value.strip_suffix(';')).expect("its value");
            let numbers = value
                .split(['[', ']', ','])
                .map(|number| number.trim().replace('_', ""))
                .filter(|number| !number.is_empty());
            let numbers: Vec<f64> = numbers
                .map(|number| {
                    let parts = number.split('/').map(|part| part.trim().parse::<f64>().expect("a number"));
                    parts.reduce(|a, b| a / b).expect("a number")
                })
                .collect();
            if name == "PAIRS" {
                continue;
            }
            assert_eq!(solver::values(name), numbers, "{name}");
            compared += 1;
        }
    }
    assert_eq!(compared, solver::CONSTANTS.len());
}

#[test]
fn what_there_is_not_is_told() {
    let told = |attribute: &str, item: &str, scheme: &str| {
        let options = Options { steps: vec![Steps::of(scheme)], ..Options::default() };
        coadjoint_codegen::c99(tokens(attribute), tokens(item), &options).expect_err(scheme).to_string()
    };
    let body = "struct Body { #[inertia] inertia: Vector3<f64> }";
    let message = told("group = SO3", body, "Midpoint<Cayley>");
    assert!(
        message.starts_with(
            "there is no step `Midpoint<Cayley>`: the description asks for SymplecticEulerA<Exponential>, "
        ),
        "{message}"
    );
    let message = told("group = SO3, potential = GRAVITY * attitude.w", body, "Cayley");
    assert!(message.starts_with("C does not know constants of a Rust crate: GRAVITY; "), "{message}");
    let message = told("group = SO4", body, "Cayley");
    assert!(
        message.starts_with("there is no group `SO4`")
            || message.contains("SO4")
            || message.contains("inertia"),
        "{message}"
    );
}

/// Names that C, C++ or a GPU's dialect has a use for, and letters that C has not.
#[test]
fn names_are_made_fit() {
    let item = "struct Straße { #[inertia] int: f64, NAN: f64, ω: f64, class: f64, equation: f64, sin: f64, M_PI: f64, _Bool: f64 }";
    let attribute = "group(position: R1), potential = position.x * (NAN + ω + class + equation + sin.sin() + M_PI + _Bool)";
    let header =
        coadjoint_codegen::c99(tokens(attribute), tokens(item), &Options::default()).expect("a header");
    for field in ["int_", "NAN_", "u3c9_", "class_", "equation_", "sin_", "M_PI_", "x_Bool"] {
        assert!(header.contains(&format!("real {field};\n")), "{field}");
    }
    assert!(
        header.is_ascii()
            || header
                .lines()
                .filter(|line| !line.is_ascii())
                .all(|line| line.trim_start().starts_with("/*") || line.trim_start().starts_with('*'))
    );
}
