//! What is derived for a step: of its own scheme alone, and no more than its equations need.

use coadjoint_codegen::emit::StepExpansion;
use coadjoint_codegen::expand;
use coadjoint_codegen::group::Retraction;
use coadjoint_codegen::program::{Module, Statement, StepRole, Term};

use crate::common::tokens;

/// The steps of a description: what stands in the attribute, and the struct.
fn steps(attribute: &str, item: &str) -> Vec<StepExpansion> {
    expand(tokens(attribute), tokens(item)).expect("a valid description").steps
}

/// Byte for byte the same, whatever else is asked for.
#[test]
fn a_step_depends_on_its_own_scheme_alone() {
    let (top, item) = (
        "group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi)",
        "struct Top { #[inertia] inertia: Matrix3<f64>, weight: f64, chi: Vector3<f64> }",
    );
    let all = [
        "",
        "retractions(Cayley)",
        "methods(TangentLift, Midpoint)",
        "derivatives",
        "methods(Family(1, 4)), derivatives(state)",
    ];
    let cayley = |asked: &str| {
        let steps = steps(&format!("{top}, {asked}"), item);
        let step =
            steps.into_iter().find(|step| step.program.scheme.type_name() == "SymplecticEulerA<Cayley>");
        let step = step.expect("it is always there");
        (step.program.module.to_string(), step.tokens.to_string())
    };
    let alone = cayley(all[0]);
    for asked in all {
        assert!(cayley(asked) == alone, "`{asked}` changes the step");
    }
}

/// The left side of the equation is linear with constant coefficients wherever there is an inertia.
#[test]
fn every_inertia_has_an_update_of_the_fixed_point_iteration() {
    for inertia in ["f64", "Vector3<f64>", "Matrix3<f64>"] {
        for side in ["left", "right"] {
            let item = format!("struct Body {{ #[inertia] inertia: {inertia} }}");
            let steps = steps(&format!("group = SO3, invariance = {side}, methods(Midpoint)"), &item);
            for step in &steps {
                let name = step.program.scheme.type_name();
                let update = step.program.module.function(StepRole::FixedPointUpdate);
                assert!(update.is_some(), "{inertia}, {side}, {name}");
            }
        }
    }
}

/// With all moments in it, the update is a matrix by a vector: nine products more than three, none of them in the evaluation but those of
/// the inertia itself.
#[test]
fn a_full_inertia_costs_its_own_products_alone() {
    let operations = |inertia: &str, role: StepRole| {
        let item = format!("struct Body {{ #[inertia] inertia: {inertia} }}");
        let steps = steps("group = SO3", &item);
        let step = steps.into_iter().find(|step| step.program.scheme.retraction == Retraction::Cayley);
        step.expect("a Cayley step").program.module.operations(role)
    };
    let [diagonal, full] =
        ["Vector3<f64>", "Matrix3<f64>"].map(|inertia| operations(inertia, StepRole::FixedPointUpdate));
    // three of each are what is left of the denominator
    assert_eq!((diagonal.additions, diagonal.multiplications), (3, 6));
    assert_eq!((full.additions, full.multiplications), (9, 12));
    let [diagonal, full] =
        ["Vector3<f64>", "Matrix3<f64>"].map(|inertia| operations(inertia, StepRole::Evaluate));
    assert_eq!(full.additions - diagonal.additions, 6);
    // by four, as the unknown is the half of the increment
    assert!(full.multiplications - diagonal.multiplications <= 9, "{full} instead of {diagonal}");
}

/// A sum whose parts are known at different times is made once, however often it is a factor.
#[test]
fn sums_of_several_stages_are_made_once() {
    let steps = steps(
        "group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi)",
        "struct Top { #[inertia] inertia: Vector3<f64>, weight: f64, chi: Vector3<f64> }",
    );
    let exponential = steps.iter().find(|step| step.program.scheme.retraction == Retraction::Exponential);
    let evaluate = exponential.expect("it is always there").program.module.operations(StepRole::Evaluate);
    // counted by hand: twelve less than with the cross products of the two parts apart
    assert_eq!((evaluate.additions, evaluate.multiplications, evaluate.divisions), (42, 60, 0));
}

/// In text, the arrays that a function returns are called what they are.
#[test]
fn results_have_names() {
    let steps = steps("group = SO3, derivatives", "struct Body { #[inertia] inertia: Vector3<f64> }");
    let step = steps.into_iter().find(|step| step.program.scheme.retraction == Retraction::Exponential);
    let StepExpansion { program, .. } = step.expect("it is always there");
    let derivative = program.derivative.expect("it is asked for").to_string();
    let text = program.module.to_string() + &derivative;
    for name in [
        "unknown",
        "residual",
        "right",
        "correction",
        "margin",
        "next",
        "tangent",
        "wrt_state",
        "wrt_parameters",
    ] {
        assert!(text.contains(&format!("    {name}[0] <- ")), "{name} in\n{text}");
    }
}

/// A vector of the dual of a space has its coordinates, and as many of them: of a space of matrices and of any other.
#[test]
fn duals_have_the_coordinates_of_their_space() {
    let item = "struct Body { #[inertia] inertia: Vector3<f64> }";
    for (group, space) in [("SL(2)", "R2"), ("SO3", "R3")] {
        let attribute = format!(
            "group = {group}, advected(v: {space}, w: dual({space})), potential = v.x * w.x + v.y * w.y"
        );
        let text = steps(&attribute, item)[0].program.module.to_string();
        for name in ["v_next_x", "v_next_y", "w_next_x", "w_next_y"] {
            assert!(text.contains(name), "{group}: {name} in\n{text}");
        }
    }
}

/// A change of one term changes the names that it concerns and no others.
#[test]
fn a_change_of_one_term_changes_the_lines_of_that_term() {
    let lines = |potential: &str| {
        let steps = steps(
            &format!("group(first: SO3, second: SO3), potential = {potential}"),
            "struct Pair { #[inertia(first)] one: Vector3<f64>, #[inertia(second)] two: Vector3<f64>, k: f64 }",
        );
        let step = steps.into_iter().find(|step| step.program.scheme.retraction == Retraction::Cayley);
        let module = step.expect("a Cayley step").program.module;
        module.text(&[StepRole::Evaluate]).lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let (before, after) =
        (lines("k * first.w.powi(2)"), lines("k * first.w.powi(2) + k * (first.i * first.w).sin()"));
    let of_second = |lines: &[String]| {
        let second = lines.iter().filter(|line| line.trim_start().starts_with("second_"));
        second.cloned().collect::<Vec<_>>()
    };
    assert!(of_second(&before).len() > 4);
    assert_eq!(of_second(&before), of_second(&after));
}

/// The end of a step has the terms that a chord leaves out from the last iterate: it is as long for all orders.
#[test]
fn what_a_chord_leaves_out_is_not_computed_twice() {
    let steps = steps(
        "group(first: SO3, second: SO3), potential = k * (first.inverse() * second).w.powi(2),
            retractions(Exponential), methods(HamiltonJacobi(4), HamiltonJacobi(6))",
        "struct Pair { #[inertia(first)] one: Vector3<f64>, #[inertia(second)] two: Vector3<f64>, k: f64 }",
    );
    let count = |order: u32, role: StepRole| {
        let name = format!("HamiltonJacobi<Exponential, {order}>");
        let step =
            steps.iter().find(|step| step.program.scheme.type_name() == name).expect("it is asked for");
        step.program.module.operations(role).multiplications
    };
    let [fourth, sixth] = [4, 6].map(|order| count(order, StepRole::Finish));
    assert!(sixth < fourth + 6, "{fourth}, {sixth}");
    assert!(5 * fourth < 2 * count(4, StepRole::Evaluate), "{fourth}");
}

/// High powers take as many multiplications as squaring needs.
#[test]
fn powers_are_made_by_squaring() {
    let steps = steps(
        "group = R1, potential = position.x.powi(17) / 17.0",
        "struct Particle { #[inertia] mass: f64 }",
    );
    let module = &steps[0].program.module;
    let multiplications: usize = [StepRole::New, StepRole::Begin, StepRole::Evaluate, StepRole::Finish]
        .map(|role| module.operations(role).multiplications)
        .iter()
        .sum();
    // x¹⁶ by four, by h, and h/m by the momentum
    assert!(multiplications <= 6, "{module}");
}

/// No two values of one function have the same name.
#[test]
fn modules_name_each_value_once() {
    let steps = steps("group = SE3, derivatives", "struct Body { #[inertia] inertia: Matrix6<f64> }");
    for step in &steps {
        names_are_distinct(&step.program.module);
        step.program.derivative.iter().for_each(names_are_distinct);
    }
}

fn names_are_distinct<R>(module: &Module<R>) {
    let mut numbered = std::collections::BTreeSet::new();
    for function in &module.functions {
        let mut named = std::collections::BTreeSet::new();
        for statement in &function.statements {
            let values = match statement {
                Statement::Let { value, .. } => vec![*value],
                Statement::Stumpff { values, .. } => values.iter().flatten().copied().collect(),
            };
            for value in values {
                let name = module.values.name(value);
                assert!(named.insert(name.to_owned()), "{name}");
                // a number is that of one value, whatever function computes it
                if name.rsplit_once('_').is_some_and(|(_, number)| number.parse::<usize>().is_ok()) {
                    assert!(numbered.insert(name.to_owned()), "{name}");
                }
            }
        }
    }
}

/// A long sum of products stands in lines that can be read, and are no deeper than a parser's stack.
#[test]
fn long_sums_are_cut_into_lines() {
    let terms = |count: usize| (1..=count).map(|k| format!("({k}.0 * position.x).sin()")).collect::<Vec<_>>();
    let item = "struct Particle { #[inertia] mass: f64 }";
    let steps = steps(&format!("group = R1, potential = {}", terms(200).join(" + ")), item);
    for step in &steps {
        fn depth(term: &Term) -> usize {
            match term {
                Term::MulAdd { addend, .. } => 1 + depth(addend),
                _ => 0,
            }
        }
        for function in &step.program.module.functions {
            for statement in &function.statements {
                if let Statement::Let { term, .. } = statement {
                    assert!(depth(term) <= 8, "{}", step.program.module.values.term(term));
                }
            }
        }
        syn::parse2::<syn::File>(step.tokens.clone()).expect("items");
    }
}

/// The body of four dimensions as the two rotations that make one of four dimensions: its inertia couples them.
#[test]
fn four_dimensions_cost_what_two_rotations_cost() {
    for retraction in ["Exponential", "Cayley"] {
        let total = |group: &str, inertia: &str| {
            let attribute = format!("{group}, retractions({retraction})");
            let item = format!("struct Body {{ #[inertia] j: {inertia} }}");
            let module = &steps(&attribute, &item)[0].program.module;
            // a step from the last one's increment: two evaluations, one correction, and the rest
            [(StepRole::Begin, 1), (StepRole::Evaluate, 2), (StepRole::Correction, 1), (StepRole::Finish, 1)]
                .map(|(role, count)| count * module.operations(role).total())
                .iter()
                .sum::<usize>()
        };
        let derived = total("group = SO(4)", "SVector<f64, 6>");
        let as_two = total("group(a: SO3, b: SO3)", "SMatrix<f64, 6, 6>");
        assert!(derived < 2 * as_two, "{retraction}: {derived} operations, and {as_two} as two rotations");
    }
}
