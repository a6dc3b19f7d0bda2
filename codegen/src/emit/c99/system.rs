//! Functions of a system: energy, invariants, velocities, and what tells whether parameters and states are such.

use std::fmt::Write as _;

use super::code::{Arithmetic, Spelling, uses};
use super::kernel::{four_sums, unused};
use super::names::places;
use super::template::Words;
use crate::program::{Function, FunctionRole as _, Input, Program, Quantity, SystemRole, Term, Transform};
use crate::quantity::{Kind, Role, ScalarType};

const NUMBERS: &str = include_str!("text/numbers.c");
const VELOCITY: &str = include_str!("text/velocity.c");

/// How far a state may be off its group.
const DEVIATION: f64 = 1e-3;

/// The functions that are there for people.
const PUBLIC: [SystemRole; 5] = [
    SystemRole::Velocity,
    SystemRole::Momentum,
    SystemRole::Energy,
    SystemRole::Casimirs,
    SystemRole::SpatialMomentum,
];

/// The roles of all functions that a header has.
pub(super) fn roles(program: &Program) -> Vec<SystemRole> {
    let pivots = (0..program.interface.inertias.len()).map(SystemRole::Pivots);
    let mut roles: Vec<SystemRole> =
        [SystemRole::Deviation, SystemRole::VelocityNewton].into_iter().chain(pivots).collect();
    roles.extend(PUBLIC);
    let is_there = |role: &SystemRole| {
        program
            .function(*role)
            .is_some_and(|(_, function)| function.results.iter().any(|array| !array.is_empty()))
    };
    roles.retain(is_there);
    roles
}

/// The functions of a system, and what tells whether parameters and states are such.
pub(super) fn system(program: &Program, spelling: &Spelling<'_>, words: &Words) -> String {
    let mut text = String::new();
    let is_apart = |role: &SystemRole| PUBLIC.contains(role) || *role == SystemRole::VelocityNewton;
    let roles = roles(program);
    for role in roles.iter().filter(|role| !is_apart(role)) {
        text += &function(program, spelling, *role);
    }
    text += &numbers(program, spelling, words);
    for role in roles.iter().filter(|role| is_apart(role)) {
        text += &function(program, spelling, *role);
        if *role == SystemRole::VelocityNewton {
            text += &velocity_by_newton(program, spelling, words);
        }
    }
    text
}

/// Whether a function needs something, and if it is given the velocity, what this is computed from.
fn needs(program: &Program, function: &Function<SystemRole>, input: Input) -> bool {
    let velocity = || {
        let role = match program.interface.velocity {
            Transform::Explicit => SystemRole::Velocity,
            Transform::Newton | Transform::Singular => SystemRole::VelocityNewton,
        };
        program.function(role).is_some_and(|(_, function)| uses(function, input))
    };
    uses(function, input)
        || function.role != SystemRole::Momentum && uses(function, Input::Velocity) && velocity()
}

/// What a function declares, and what it is called with, behind parameters and state.
fn more(
    program: &Program,
    spelling: &Spelling<'_>,
    function: &Function<SystemRole>,
) -> (Vec<String>, String) {
    let s = spelling.prefix;
    let (mut declared, mut called) = (Vec::new(), String::new());
    if needs(program, function, Input::Time) {
        declared.push(format!("{s}_real time"));
        called += ", time";
    }
    if needs(program, function, Input::Control) {
        declared.push(format!("const {s}_control *control"));
        called += ", control";
    }
    (declared, called)
}

/// One function.
fn function(program: &Program, spelling: &Spelling<'_>, role: SystemRole) -> String {
    let Some((module, function)) = program.function(role) else { return String::new() };
    let (s, upper) = (spelling.prefix, spelling.prefix.to_uppercase());
    let real = format!("{s}_real");
    let (more, called) = more(program, spelling, function);
    let mut arguments = match role {
        SystemRole::Deviation => vec![format!("const {s}_state *state")],
        SystemRole::Pivots(_) => vec![format!("const {s}_parameters *parameters")],
        _ => vec![format!("const {s}_parameters *parameters"), format!("const {s}_state *state")],
    };
    arguments.extend(more);
    let arrays: Vec<&[Term]> = function.results.iter().map(Vec::as_slice).collect();
    let mut body = String::new();
    let is_given = matches!(role, SystemRole::Momentum | SystemRole::VelocityNewton);
    let velocity = if uses(function, Input::Velocity) && !is_given {
        let n = program.interface.dimension;
        _ = writeln!(body, "    {real} velocity[{n}];");
        match program.interface.velocity {
            Transform::Explicit => format!("    {s}_velocity(parameters, state{called}, velocity);\n"),
            Transform::Newton | Transform::Singular => {
                format!("    (void){s}_velocity(parameters, state{called}, velocity);\n")
            }
        }
    } else {
        String::new()
    };
    if is_given && uses(function, Input::Velocity) {
        arguments.push(format!("const {real} *velocity"));
    }
    let computed = spelling.body(&module.values, function, Arithmetic::Plain, &arrays);
    // declarations first
    body += &velocity;
    body += &computed;
    let is_number = role == SystemRole::Energy;
    for (place, term) in function.results.iter().flatten().enumerate() {
        let term = spelling.term(&module.values, term, Arithmetic::Plain);
        match is_number {
            true => _ = writeln!(body, "    return {term};"),
            false => _ = writeln!(body, "    result[{place}] = {term};"),
        }
    }
    if !is_number {
        arguments.push(format!("{real} *result"));
    }
    let kind = if is_number { real.as_str() } else { "void" };
    let of = results(program, role).map_or_else(String::new, |names| format!(": {names}"));
    format!(
        "/* {}{of}. {}. */\n{upper}_FN {kind} {s}_{}({})\n{{\n{}{body}}}\n\n",
        role.signature().purpose,
        capitalized(&function.operations().to_string()),
        role.name(),
        arguments.join(", "),
        unused(&arguments, &body),
    )
}

/// The names of the results, where these are numbers of different kinds.
fn results(program: &Program, role: SystemRole) -> Option<String> {
    (role == SystemRole::Casimirs).then(|| program.interface.casimirs.join(", "))
}

fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

/// Velocity by Newton's method.
fn velocity_by_newton(program: &Program, spelling: &Spelling<'_>, words: &Words) -> String {
    let Some((_, function)) = program.function(SystemRole::VelocityNewton) else { return String::new() };
    let (declared, called) = more(program, spelling, function);
    let declared: String = declared.iter().map(|argument| format!(", {argument}")).collect();
    let given = if uses(function, Input::Velocity) { ", velocity" } else { "" };
    let trial = if uses(function, Input::Velocity) { ", trial" } else { "" };
    words
        .clone()
        .with("DIMENSION", program.interface.dimension.to_string())
        .with("TWICE", (2 * program.interface.dimension).to_string())
        .with("MORE", declared)
        .with("HERE", format!("{called}{given}"))
        .with("THERE", format!("{called}{trial}"))
        .fill(VELOCITY)
}

/// What tells whether numbers, parameters and states are such.
fn numbers(program: &Program, spelling: &Spelling<'_>, words: &Words) -> String {
    let (s, interface) = (spelling.prefix, &program.interface);
    let all = |quantities: &[Quantity], name: &str| -> Vec<String> {
        places(quantities).into_iter().map(|place| format!("{name}->{place}")).collect()
    };
    let finite = |places: &[String]| match places {
        [] => "1".to_owned(),
        _ => places.iter().map(|place| format!("{s}_is_finite({place})")).collect::<Vec<_>>().join(" && "),
    };
    let (state, control) = (all(&interface.state, "x"), all(&interface.controls, "u"));
    let parameters = all(&interface.parameters, "parameters");
    let same: Vec<String> =
        places(&interface.state).iter().map(|place| format!("a->{place} == b->{place}")).collect();
    let rotations = interface.state.iter().filter(|part| part.role == Role::Configuration);
    let rotations = rotations.filter_map(|part| {
        let count = match part.kind {
            Kind::UnitComplex | Kind::RigidMotion2 => 2,
            Kind::UnitQuaternion | Kind::RigidMotion3 => 4,
            Kind::Scalar | Kind::Vector(_) | Kind::Symmetric(_) | Kind::Matrix(..) => return None,
        };
        let places = places(std::slice::from_ref(part));
        let squares: Vec<String> =
            places[..count].iter().map(|place| format!("state->{place} * state->{place}")).collect();
        Some(Words::default().with("LENGTH", format!("{}({})", spelling.math("sqrt"), squares.join(" + "))))
    });
    let matrices = interface.parameters.iter().filter_map(|parameter| match parameter.kind {
        Kind::Symmetric(rows) => {
            let first = places(std::slice::from_ref(parameter)).into_iter().next()?;
            Some(
                Words::default()
                    .with("ENTRIES", format!("&parameters->{first}"))
                    .with("ROWS", rows.to_string()),
            )
        }
        _ => None,
    });
    let inertias = (0..interface.inertias.len()).map(|place| {
        let pivots = program
            .function(SystemRole::Pivots(place))
            .map_or(0, |(_, function)| function.results.iter().map(Vec::len).sum());
        Words::default().with("PIVOTS", SystemRole::Pivots(place).name()).with("ROWS", pivots.to_string())
    });
    let matrices: Vec<Words> = matrices.collect();
    let inertias: Vec<Words> = inertias.collect();
    let has_domain = program.steps.iter().any(|step| {
        step.module
            .function(crate::program::StepRole::Domain)
            .is_some_and(|function| function.results.iter().map(Vec::len).sum::<usize>() > 1)
    });
    let arrays = [
        ("parameters", &interface.parameters),
        ("state", &interface.state),
        ("control", &interface.controls),
    ];
    let arrays =
        arrays.into_iter().filter(|(_, quantities)| !quantities.is_empty()).map(|(name, quantities)| {
            let component = |(k, place): (usize, String)| {
                Words::default().with("PLACE", place).with("COMPONENT", k.to_string())
            };
            let components: Vec<Words> = places(quantities).into_iter().enumerate().map(component).collect();
            let count = components.len().to_string();
            Words::default().with("STRUCT", name).with("LENGTH", count).each("component", components)
        });
    words
        .clone()
        .each("array", arrays.collect())
        .with("STATE_SUM", four_sums(&state))
        .with("STATE_FINITE", finite(&state))
        .with("CONTROL_FINITE", finite(&control))
        .with("PARAMETERS_FINITE", finite(&parameters))
        .with("SAME", same.join(" && "))
        .with("DEVIATION", spelling.number(DEVIATION))
        .holds("control", !interface.controls.is_empty())
        .holds("deviation", program.function(SystemRole::Deviation).is_some())
        .holds("symmetric", !matrices.is_empty())
        .holds("pivots", !inertias.is_empty())
        .holds("minimum", has_domain)
        .each(
            "place",
            places(&interface.state).into_iter().map(|place| Words::default().with("PLACE", place)).collect(),
        )
        .each("rotation", rotations.collect())
        .each("matrix", matrices)
        .each("inertia", inertias)
        .fill(NUMBERS)
}

/// What stands for a scalar type in C.
pub(super) fn scalar(scalar: ScalarType) -> &'static str {
    match scalar {
        ScalarType::F64 => "double",
        ScalarType::F32 => "float",
    }
}
