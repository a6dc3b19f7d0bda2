//! What is wrong with a text, shown at its place.

use coadjoint_dynamic::Model;

/// What is said of a text.
fn said(text: &str) -> String {
    Model::from_file(text, "top.rs", None).map_or_else(|error| error.to_string(), |_| "nothing".to_owned())
}

#[test]
fn all_problems_are_shown_at_once() {
    insta::assert_snapshot!(said(
        "use coadjoint::prelude::*;

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gama.dot(&chi) + G * gamma.z,
    metods(Midpoint),
)]
struct HeavyTop {
    #[inertia]
    inertia: Vector3<f64>,
    weight: String,
    chi: Vector3<f64>,
}
"
    ));
}

#[test]
fn constants_that_stand_nowhere_are_refused() {
    insta::assert_snapshot!(said(
        "#[lie_poisson_system(group = R1, potential = mass * G * position.x + LOST + std::f64::consts::PI)]
struct Stone {
    #[inertia]
    mass: f64,
}
const LOST: f64 = 2.0 * NOWHERE;
"
    ));
}

#[test]
fn what_is_no_rust_is_shown_where_it_is() {
    insta::assert_snapshot!(said(
        "#[lie_poisson_system(group = SO3)]\nstruct Body {\n    #[inertia] inertia: Vector3<f64>,\n"
    ));
    insta::assert_snapshot!(said("#[lie_poisson_system(group = SO3, potential = \"open)]\nstruct Body {}"));
    insta::assert_snapshot!(said(
        "#[lie_poisson_system(group = SO3)]\nstruct Body {\n    #[inertia] inertia Vector3<f64>,\n}"
    ));
}

#[test]
fn there_is_a_description_or_one_is_chosen() {
    insta::assert_snapshot!(said("struct Body;"));
    insta::assert_snapshot!(said(""));
    let two = "#[lie_poisson_system(group = SO3)] struct A { #[inertia] i: f64 }
#[lie_poisson_system(group = SO3)] struct B { #[inertia] i: Vector3<f64> }";
    insta::assert_snapshot!(said(two));
    insta::assert_snapshot!(Model::from_file(two, "two.rs", Some("C")).unwrap_err());
    assert_eq!(Model::from_file(two, "two.rs", Some("B")).unwrap().name(), "B");
}

#[test]
fn numbers_are_doubles() {
    insta::assert_snapshot!(said(
        "#[lie_poisson_system(group = SO3, scalar = f32)] struct A { #[inertia] i: Vector3<f32> }"
    ));
}

#[test]
fn functions_and_groups_that_stand_nowhere_are_refused() {
    insta::assert_snapshot!(said(
        "#[lie_poisson_system(group = R3, potential = density(position.z))]
struct A {
    #[inertia]
    mass: f64,
}"
    ));
    insta::assert_snapshot!(said(
        "#[lie_poisson_system(group = Areas!)]
struct A {
    #[inertia]
    inertia: Vector3<f64>,
}"
    ));
}

#[test]
fn what_is_wrong_beside_the_struct_is_shown_too() {
    insta::assert_snapshot!(said(
        "lie_group! { Areas = matrices { h: [1, 0; 0, -1, e: [0, 1; 0, 0] } }
#[expression]
fn density(height: f64) -> f64 { (height }
"
    ));
    insta::assert_snapshot!(said(
        "lie_group! { Areas = matrices { h: [1, 0; 0, -1], e: [0, 1; 0] } }
#[lie_poisson_system(group = Areas!)]
struct A {
    #[inertia]
    inertia: Vector2<f64>,
}"
    ));
}

#[test]
fn a_long_line_is_shown_in_part() {
    let text = format!(
        "#[lie_poisson_system(group = R1, potential = {} + wrong * position.x)] struct A {{ #[inertia] m: f64 }}",
        "m * position.x + ".repeat(40).trim_end_matches(" + ")
    );
    insta::assert_snapshot!(said(&text));
}

#[test]
fn what_a_compiler_would_refuse_is_refused() {
    let refused = [
        (
            "#[lie_poisson_system(group = R1, potential = k * position.x) * (position.x)]
struct A { #[inertia] m: f64, k: f64 }",
            "top.rs:1:62",
            "the attribute ends before this",
        ),
        (
            "#[lie_poisson_system(group = R1, potential = k * position.x)]
#[lie_poisson_system(group = R1, potential = 2.0 * k * position.x)]
struct A { #[inertia] m: f64, k: f64 }",
            "top.rs:2:1",
            "a struct is described once",
        ),
        (
            "#[lie_poisson_system(group = R1, potential = k * position.x)]
struct A { #[inertia] m: f64, k: f64, k: f64 }",
            "top.rs:2:39",
            "`k` is the name of a field before",
        ),
        (
            "const G: f64 = 9.81kg;
#[lie_poisson_system(group = R1, potential = m * G * position.x)]
struct A { #[inertia] m: f64 }",
            "top.rs:1:16",
            "",
        ),
        (
            "#[lie_poisson_system(group = R1, methods(HamiltonJacobi(6k)))]
struct A { #[inertia] m: f64 }",
            "top.rs:1:42",
            "takes the order of the step",
        ),
        (
            "#[lie_poisson_system(group = R1, potential = k * (position.x − 1.0))]
struct A { #[inertia] m: f64, k: f64 }",
            "top.rs:1:62",
            "`−` is no sign of Rust: write `-`",
        ),
    ];
    for (text, place, message) in refused {
        let said = said(text);
        assert!(said.contains(place) && said.contains(message), "{said}");
    }
}
