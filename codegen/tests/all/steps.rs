//! What the steps of the family say of themselves beside their equations: where they are defined, what stays bounded, which rules are one
//! map; and what documentation says of the motion.

use crate::evaluate::Evaluate as _;
use coadjoint_codegen::expand;
use coadjoint_codegen::expr::Arena;
use coadjoint_codegen::group::Retraction;
use coadjoint_codegen::kernel::{self, Inputs};
use coadjoint_codegen::method::{Step, family};
use coadjoint_codegen::model::{Slot, System};
use coadjoint_codegen::program::StepRole;
use coadjoint_codegen::scheme::{Member, Scheme};
use std::f64::consts::TAU;

use crate::common::{system, tokens};

fn member(numerator: u32, denominator: u32) -> Member {
    Member::new(numerator, denominator).expect("between 0 and 1")
}

fn step<'a>(system: &System<'a>, retraction: Retraction, member: Member) -> Step<'a> {
    family::step(system.time.arena(), system, retraction, member)
}

const TWO_BODIES: &str =
    "struct Two { #[inertia(first)] j: Vector3<f64>, #[inertia(second)] k: Vector3<f64> }";

/// With the exponential a part of a step is defined for less than a full turn, and both parts of it are.
#[test]
fn the_longer_part_of_a_step_ends_at_a_full_turn() {
    let arena = Arena::new();
    let system = system(&arena, ("group(first: SO3, second: SO3)", TWO_BODIES));
    for (numerator, denominator, longer) in
        [(0, 1, 1.0), (1, 4, 0.75), (1, 2, 0.5), (2, 3, 2.0 / 3.0), (1, 1, 1.0)]
    {
        let step = step(&system, Retraction::Exponential, member(numerator, denominator));
        assert_eq!(step.domain.len(), 2, "an edge for each body");
        let unknown = step.unknown.symbols();
        assert_eq!(unknown.len(), 6, "the increments of both bodies");
        for (body, edge) in step.domain.iter().enumerate() {
            let at = |angle: f64| {
                // about an axis askew, the other body being far outside
                let axis = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0];
                edge.evaluate(&|symbol| {
                    let place = unknown.iter().position(|known| *known == symbol).expect("an unknown");
                    if place / 3 == body { angle * axis[place % 3] } else { 100.0 }
                })
            };
            let s = format!("s = {numerator}/{denominator}, body {body}");
            assert!(at(0.999 * TAU / longer) > 0.0, "{s} inside");
            assert!(at(1.001 * TAU / longer) < 0.0, "{s} outside");
        }
        let everywhere = self::step(&system, Retraction::Cayley, member(numerator, denominator));
        assert!(everywhere.domain.is_empty(), "the Cayley map is defined everywhere");
    }
}

/// For each part of the state how many of its first components are bounded, where any is.
fn bounded(system: &System<'_>, step: &Step<'_>) -> Vec<(Slot, usize)> {
    let mut rest = step.bounded.iter().copied();
    let count = |slot: Slot| {
        let part: Vec<bool> = rest.by_ref().take(system.part(slot).len()).collect();
        let first = part.iter().take_while(|bounded| **bounded).count();
        assert!(!part[first..].contains(&true), "{slot:?}: those that are bounded stand in front");
        (slot, first)
    };
    let counts: Vec<_> = system.slots().into_iter().map(count).collect();
    assert_eq!(rest.count(), 0);
    counts.into_iter().filter(|&(_, count)| count > 0).collect()
}

#[test]
fn rotations_by_the_unknown_are_bounded() {
    let one = |inertia: &str| format!("struct Body {{ #[inertia] j: {inertia} }}");
    let two = |first: &str, second: &str| {
        format!("struct Two {{ #[inertia({first})] j: f64, #[inertia({second})] k: Vector3<f64> }}")
    };
    let (first, second) = (Slot::Configuration(0), Slot::Configuration(1));
    for (attribute, item, rotations) in [
        ("group = SO3", one("Vector3<f64>"), vec![(first, 4)]),
        ("group = SE3", one("Matrix6<f64>"), vec![(first, 4)]),
        ("group = SE2", one("Matrix3<f64>"), vec![(first, 2)]),
        ("group = R3", one("f64"), vec![]),
        // a free rotor's angle follows from the state alone, without iteration
        ("group = SO2", one("f64"), vec![]),
        ("group(rotor: SO2, body: SO3)", two("rotor", "body"), vec![(second, 4)]),
        ("group(body: SO3, rotor: SO2)", two("rotor", "body"), vec![(first, 4)]),
        // but not where its inertia is that of the body, too
        ("group(rotor: SO2, body: SO3)", one("f64"), vec![(first, 2), (second, 4)]),
    ] {
        let arena = Arena::new();
        let system = system(&arena, (attribute, &item));
        for (numerator, denominator) in [(0, 1), (1, 2), (1, 1)] {
            let step = step(&system, Retraction::Exponential, member(numerator, denominator));
            assert_eq!(bounded(&system, &step), rotations, "{attribute}, s = {numerator}/{denominator}");
        }
    }
}

/// How many increments move the configuration.
#[test]
fn a_configuration_moves_at_once_where_the_intermediate_point_is_an_end() {
    let arena = Arena::new();
    let system = system(&arena, ("group(first: SO3, second: SO3)", TWO_BODIES));
    for retraction in Retraction::ALL {
        for (numerator, denominator, count) in [(0, 1, 1), (1, 3, 2), (1, 2, 2), (1, 1, 1)] {
            let step = step(&system, retraction, member(numerator, denominator));
            assert_eq!(step.increments.len(), count, "s = {numerator}/{denominator}");
        }
    }
}

#[test]
fn the_last_member_is_the_first_where_nothing_depends_on_the_configuration() {
    let body = "struct Body { #[inertia] j: f64 }";
    let first = family::METHOD.member(Member::SYMPLECTIC_EULER_A);
    let last = family::METHOD.member(Member::SYMPLECTIC_EULER_B);
    for (attribute, same) in [
        ("group = SO3", true),
        ("group = SO3, advected(gamma: R3), potential = gamma.x", true),
        ("group = SO3, potential = attitude.w", false),
        ("group = SO3, force = -momentum", false),
        ("group = SO3, advected(gamma: R3), potential = gamma.x * t", false),
    ] {
        let arena = Arena::new();
        let system = system(&arena, (attribute, body));
        let midpoint = family::METHOD.member(Member::MIDPOINT);
        let original = |retraction, rule| {
            let original = Scheme { retraction, rule }.original(&system, Retraction::Exponential);
            assert_eq!(original.retraction, retraction);
            original.rule
        };
        for retraction in Retraction::defaults() {
            assert_eq!(original(retraction, last), if same { first } else { last }, "{attribute}");
            assert_eq!(original(retraction, midpoint), midpoint);
        }
        // a retraction that is not odd is another one backwards
        assert_eq!(original(Retraction::SecondKind, last), last);
    }
}

/// On a vector space they are all the identity: one kernel has the names of all.
#[test]
fn retractions_of_a_vector_space_are_one() {
    let names = |attribute: &str| -> Vec<Vec<String>> {
        let (attribute, item) = (attribute.parse().expect("tokens"), "struct Point { #[inertia] m: f64 }");
        let program =
            coadjoint_codegen::program(attribute, item.parse().expect("tokens")).expect("a program");
        let names = |step: &coadjoint_codegen::program::StepProgram| {
            std::iter::once(&step.scheme).chain(&step.aliases).map(|scheme| scheme.type_name()).collect()
        };
        program.steps.iter().map(names).collect()
    };
    assert_eq!(
        names("group = R2, potential = position.x"),
        [
            ["SymplecticEulerA<Exponential>", "SymplecticEulerA<Cayley>"],
            ["SymplecticEulerB<Exponential>", "SymplecticEulerB<Cayley>"]
        ]
    );
    let mixed = names("group(a: R2, b: SO2), retractions(Cayley, SecondKind), force(a = a)");
    assert!(mixed.iter().all(|names| names.len() == 1), "{mixed:?}");
}

/// What is multiplied by 2 in the equation is not divided by 2 again in its derivative.
#[test]
fn newtons_method_undoes_no_scale() {
    let heavy_top = "group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi)";
    let fields = "struct Top { #[inertia] j: Vector3<f64>, weight: f64, chi: Vector3<f64> }";
    for (attribute, item) in
        [("group = SO3", "struct Body { #[inertia] j: Vector3<f64> }"), (heavy_top, fields)]
    {
        let arena = Arena::new();
        let system = system(&arena, (attribute, item));
        let step = step(&system, Retraction::Cayley, Member::SYMPLECTIC_EULER_A);
        let module = kernel::step(&arena, &step, Inputs::of(&system));
        let (evaluate, correction) =
            (module.operations(StepRole::Evaluate), module.operations(StepRole::Correction));
        assert!(evaluate.multiplications <= 15 && evaluate.divisions == 1, "{attribute}: {evaluate}");
        assert!(correction.multiplications <= 49 && correction.divisions == 1, "{attribute}: {correction}");
    }
}

/// The text that documents a system.
fn documentation(attribute: &str, item: &str) -> String {
    let expansion = expand(tokens(attribute), tokens(item)).expect("a sound description");
    expansion.declaration.to_string()
}

/// `g' = ζ g` has the opposite brackets; translations are the same on both sides.
#[test]
fn documentation_tells_the_sides_apart() {
    let item = "struct Pair { #[inertia(body)] j: Vector3<f64>, #[inertia(place)] m: f64 }";
    let of = |side: &str| {
        let attribute =
            "group(body: SO3, place: R3), advected(gamma: R3), potential = m * gamma.z, invariance = ";
        documentation(&format!("{attribute}{side}"), item)
    };
    let (left, right) = (of("left"), of("right"));
    for (side, text, lines) in [
        (
            "left",
            &left,
            [
                "body' = body hat(body_velocity)",
                "body_momentum' = body_momentum × body_velocity + gamma × ∂V/∂gamma",
                "gamma' = gamma × body_velocity",
            ],
        ),
        (
            "right",
            &right,
            [
                "body' = hat(body_velocity) body",
                "body_momentum' = −(body_momentum × body_velocity + gamma × ∂V/∂gamma)",
                "gamma' = −(gamma × body_velocity)",
            ],
        ),
    ] {
        for line in lines.into_iter().chain(["place' = place_velocity", "place_momentum' = 0"]) {
            assert!(text.contains(line), "{side}: `{line}` in {text}");
        }
    }
}

/// What is carried along by any action is not told as a vector that turns is.
#[test]
fn documentation_tells_the_spaces_apart() {
    let text = documentation(
        "group = SE3, advected(gamma: R3, screw: adjoint), potential = m * gamma.dot(&gamma) + screw.dot(&screw)",
        "struct Carrier { #[inertia] m: f64 }",
    );
    for line in ["screw ⋄ ∂V/∂screw", "screw' = ad*(velocity) screw", "gamma ⋄ ∂V/∂gamma"] {
        assert!(text.contains(line), "`{line}` in {text}");
    }
    assert!(!text.contains("×"), "{text}");
}

/// What is wrong with a Hamilton–Jacobi step that is asked for is said, and no more than that.
#[test]
fn orders_that_there_are_none_of_are_refused() {
    let refused = |methods: &str, about: &str| {
        let attribute = format!("group = SO3, {methods}");
        let item = "struct Body { #[inertia] j: Vector3<f64> }";
        let error = expand(tokens(&attribute), tokens(item)).map(|_| ()).expect_err(methods);
        assert_eq!(
            error.into_iter().map(|one| one.to_string()).filter(|one| one.contains(about)).count(),
            1,
            "{methods}"
        );
    };
    for order in ["", "(5)", "()", "(six)", "(6, 2)", "(4294967296)"] {
        refused(&format!("methods(HamiltonJacobi{order})"), "takes the order of the step");
    }
    refused("methods(HamiltonJacobi(6)), retractions(SecondKind)", "`Exponential` and `Cayley`");
}
