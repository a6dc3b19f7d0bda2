//! The macro as rustc calls it, and what is derived by what is asked for.

use coadjoint_codegen::program::{
    DerivativeRole, FunctionRole, Module, Program, StepRole, SystemRole, Transform,
};
use coadjoint_codegen::quantity::{Kind, ScalarType, Side};
use coadjoint_codegen::{
    expand, expression, lie_group, lie_poisson_system, lie_poisson_system_with, program,
};

use crate::common::tokens;

const TOP: &str = "group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi)";
const ITEM: &str = "pub struct Top { #[inertia] inertia: Vector3<f64>, weight: f64, chi: Vector3<f64> }";
const DRIVEN: &str = "group = SO3, control(torque: R3), force = torque";
const BODY: &str = "struct Body { #[inertia] inertia: Vector3<f64> }";

fn derived(attribute: &str, item: &str) -> Program {
    program(tokens(attribute), tokens(item)).unwrap_or_else(|error| panic!("{attribute}: {error}"))
}

#[test]
fn the_macro_gives_what_is_expanded() {
    let whole = lie_poisson_system(tokens(TOP), tokens(ITEM)).to_string();
    let expansion = expand(tokens(TOP), tokens(ITEM)).expect("no problem");
    assert_eq!(whole, expansion.into_tokens().to_string());
    let items = syn::parse_str::<syn::File>(&whole).expect("items").items;
    assert!(items.len() > 8, "{} items", items.len());
}

#[test]
fn problems_are_compile_errors_beside_the_names_that_users_write() {
    let whole = lie_poisson_system(tokens("group = SO3, potential = wieght"), tokens(BODY)).to_string();
    assert!(whole.contains("compile_error") && whole.contains("wieght"), "{whole}");
    assert!(whole.contains("BodyState"), "{whole}");
    assert!(expand(tokens("group = SO3, potential = wieght"), tokens(BODY)).is_err());
    assert!(program(tokens("group = S4"), tokens(BODY)).is_err());
}

/// Where nothing can be derived, all names that users write stand for what rustc takes without further complaint.
#[test]
fn what_cannot_be_derived_has_a_stand_in() {
    let of = |attribute: &str, item: &str| lie_poisson_system(tokens(attribute), tokens(item)).to_string();
    let whole = of("group = S4, control(torque: R3), derivatives", BODY);
    let names = ["type Body = __Body <", "type BodyState", "type BodyControl", "type BodyIndices"];
    for part in names.into_iter().chain(["const ERROR", "compile_error"]) {
        assert!(whole.contains(part), "`{part}` in {whole}");
    }
    assert!(!of("group = S4", BODY).contains("BodyControl"));
    // what has parameters of its own is left as it is
    let generic = of("group = S4", "struct Body<T> { #[inertia] inertia: T }");
    assert!(generic.contains("struct Body < T >") && !generic.contains("BodyState"), "{generic}");
}

/// A group's macro hands its tokens on, and a system asks for those that it does not know.
#[test]
fn groups_are_handed_on_by_macros() {
    let areas = "matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] }";
    let one = lie_group(tokens(&format!("/// Maps.\npub Areas = {areas}; Others = SO3"))).to_string();
    let rules = syn::parse_str::<syn::File>(&one).expect("items").items;
    let macros = rules.iter().filter_map(|item| match item {
        syn::Item::Macro(rules) => rules.ident.as_ref().map(ToString::to_string),
        _ => None,
    });
    assert_eq!(macros.collect::<Vec<_>>(), ["__group_Areas", "__group_Others"]);
    let names = rules.iter().filter_map(|item| match item {
        syn::Item::Use(name) => Some((matches!(name.vis, syn::Visibility::Public(_)), name.attrs.len())),
        _ => None,
    });
    // with the documentation, and the allowance not to be used
    assert_eq!(names.collect::<Vec<_>>(), [(true, 2), (false, 1)]);
    let exported = one.matches("macro_export").count();
    assert_eq!(exported, 1, "{one}");

    let (attribute, item) = ("group = Areas !", "struct Drop { # [inertia] j : f64 }");
    let asked = lie_poisson_system(tokens(attribute), tokens(item)).to_string();
    assert!(asked.starts_with("Areas ! {") && asked.contains("lie_poisson_system_with"), "{asked}");
    let known = format!("\"Areas\" => Areas = {areas};");
    let answer = format!("{{ {known} }} {{ {attribute} }} {{ {item} }}");
    let whole = lie_poisson_system_with(tokens(&answer)).to_string();
    let same = lie_poisson_system(tokens(&format!("group = {areas}")), tokens(item)).to_string();
    let size = |text: &str| syn::parse_str::<syn::File>(text).expect("items").items.len();
    assert_eq!(size(&whole), size(&same));
    assert!(whole.contains("DropState"), "{whole}");
}

/// A function's macro does the same; a function that one calls is asked for in the module of that one.
#[test]
fn functions_are_handed_on_by_macros() {
    let density = "fn density (h : f64) -> f64 { thin (h) . exp () }";
    let one = expression(tokens(""), tokens(&format!("pub {density}"))).to_string();
    assert!(one.starts_with(&format!("pub {density}")), "{one}");
    assert!(one.contains("macro_rules ! __function_density"), "{one}");
    assert!(one.ends_with("pub (crate) use __function_density as density ;"), "{one}");

    let item = "struct Ball { # [inertia] mass : f64 }";
    let attribute =
        "group = R1 , potential = vector ! [mass * (air :: density (position . x))] . dot (& position)";
    let asked = lie_poisson_system(tokens(attribute), tokens(item)).to_string();
    assert!(asked.starts_with("air :: density ! {"), "{asked}");
    let known = format!("\"air::density\" => {density} ;");
    let answer = |known: &str| format!("{{ {known} }} {{ {attribute} }} {{ {item} }}");
    let asked = lie_poisson_system_with(tokens(&answer(&known))).to_string();
    assert!(asked.starts_with("air :: thin ! {") && asked.contains("\"air::density\""), "{asked}");
    let known = format!("{known} \"air::thin\" => fn thin(h: f64) -> f64 {{ -h / 2.0 }};");
    let whole = lie_poisson_system_with(tokens(&answer(&known))).to_string();
    assert!(whole.contains("BallState") && !whole.contains("compile_error"), "{whole}");

    // constructors, methods, patterns and functions of numbers are none of the user's own
    for known in [
        "Vector3::new(x, y, z).dot(&UnitQuaternion::new(v))",
        "f64::sin(x) * (x)",
        "if (x < 1.0) { x } else { (x) }",
        "v.x.abs()",
    ] {
        let system = format!("group = R1, hamiltonian = {known}");
        assert!(!lie_poisson_system(tokens(&system), tokens(item)).to_string().contains("_with"), "{known}");
    }
    for (attribute, item) in
        [("now", "fn f() -> f64 { 1.0 }"), ("", "fn f<T>(x: T) -> T { x }"), ("", "struct S;")]
    {
        assert!(expression(tokens(attribute), tokens(item)).to_string().contains("compile_error"), "{item}");
    }
}

/// Of a retraction that is not odd the first member is not symmetric: a bare one stands for the step of Störmer and Verlet.
#[test]
fn a_bare_retraction_stands_for_a_symmetric_step() {
    let scheme = |retraction: &str| {
        let attribute = format!("group = SO3, retractions({retraction})");
        let text = expand(tokens(&attribute), tokens(BODY)).expect("no problem").into_tokens().to_string();
        let (_, after) =
            text.split_once(&format!("Retracted < :: coadjoint :: {retraction} > for Body")).expect("one");
        after.split(';').next().expect("a type").to_owned()
    };
    assert!(scheme("SecondKind").contains("StormerVerlet"), "{}", scheme("SecondKind"));
    assert!(scheme("Cayley").contains("Standard"), "{}", scheme("Cayley"));
}

/// As it is written: a number, a vector, or parts.
#[test]
fn a_force_has_the_type_that_it_is_written_with() {
    let result = |attribute: &str| {
        let text =
            expand(tokens(attribute), tokens("struct Body { #[inertia] j: f64 }")).expect("no problem");
        let text = text.into_tokens().to_string();
        let (_, after) = text.split_once("fn force").expect("a force");
        let (_, after) = after.split_once("->").expect("a result");
        let whole = after.split('{').next().expect("a type").replace(' ', "");
        whole.replace("::core::primitive::", "").replace("::coadjoint::__private::nalgebra::", "")
    };
    let parts = "force = (-j * angular_velocity, -linear_velocity)";
    assert_eq!(result(&format!("group = SE2, {parts}")), "(f64,Vector2<f64>)");
    assert_eq!(result(&format!("group = SE3, {parts}")), "(Vector3<f64>,Vector3<f64>)");
    assert_eq!(result("group = R1, force = -j"), "f64");
    assert_eq!(result("group = SO3, force = -momentum"), "Vector3<f64>");
}

/// Each derivative brings its functions, and those that composed steps need.
#[test]
fn derivatives_are_those_that_are_asked_for() {
    let all = [
        DerivativeRole::Point,
        DerivativeRole::Tangent,
        DerivativeRole::Adjoint,
        DerivativeRole::Through,
        DerivativeRole::WrtState,
        DerivativeRole::WrtControl,
    ];
    let all = [&all[..], &[DerivativeRole::WrtParameters]].concat();
    for (asked, roles) in [
        ("derivatives", all.clone()),
        (
            "derivatives(state)",
            vec![DerivativeRole::Point, DerivativeRole::Through, DerivativeRole::WrtState],
        ),
        (
            "derivatives(controls)",
            vec![
                DerivativeRole::Point,
                DerivativeRole::Through,
                DerivativeRole::WrtState,
                DerivativeRole::WrtControl,
            ],
        ),
        (
            "derivatives(parameters)",
            vec![
                DerivativeRole::Point,
                DerivativeRole::Through,
                DerivativeRole::WrtState,
                DerivativeRole::WrtParameters,
            ],
        ),
        ("derivatives(tangent)", vec![DerivativeRole::Point, DerivativeRole::Tangent]),
        ("derivatives(adjoint)", vec![DerivativeRole::Point, DerivativeRole::Adjoint]),
    ] {
        let program = derived(&format!("{DRIVEN}, {asked}"), BODY);
        for step in &program.steps {
            let derivative = step.derivative.as_ref().expect("asked for");
            let found: Vec<DerivativeRole> =
                derivative.functions.iter().map(|function| function.role).collect();
            assert_eq!(found, roles, "{asked}");
        }
    }
    assert!(derived(DRIVEN, BODY).steps.iter().all(|step| step.derivative.is_none()));
}

/// What is given to each function, in the order of its arguments.
#[test]
fn functions_are_given_what_the_runtime_gives_them() {
    let program = derived(&format!("{DRIVEN}, derivatives"), BODY);
    let step = &program.steps[0];
    fn signature<R: FunctionRole>(module: &Module<R>, role: R) -> String {
        let arguments = &module.function(role).expect("it is there").arguments;
        let inputs: Vec<String> = arguments.iter().map(|argument| format!("{:?}", argument.input)).collect();
        inputs.join(", ")
    }
    let of = |role| signature(&step.module, role);
    assert_eq!(of(StepRole::New), "Parameters, StepSize");
    assert_eq!(of(StepRole::Begin), "Record(Constants), State, Time, Control");
    assert_eq!(of(StepRole::Start), "Record(Constants), State, Record(Step)");
    assert_eq!(of(StepRole::Evaluate), "Record(Constants), State, Record(Step), Unknown");
    let solved = "Record(Constants), State, Record(Step), Unknown, Residual, Record(Iterate)";
    assert_eq!((of(StepRole::Correction), of(StepRole::Finish)), (solved.to_owned(), solved.to_owned()));
    assert_eq!(of(StepRole::FixedPointUpdate), solved.replace("Residual", "Right"));
    let derivative = step.derivative.as_ref().expect("asked for");
    let of = |role| signature(derivative, role);
    assert_eq!(of(DerivativeRole::Point), "Parameters, StepSize, State, Time, Control, Unknown");
    let tangent = "Record(Point), StatePerturbation, ControlPerturbation, ParameterPerturbation";
    assert_eq!(of(DerivativeRole::Tangent), tangent);
    assert_eq!(of(DerivativeRole::Adjoint), "Record(Point), Costate");
    assert_eq!(
        (of(DerivativeRole::Through), of(DerivativeRole::WrtState)),
        ("Record(Point)".to_owned(), "Record(Point)".to_owned())
    );
}

#[test]
fn what_is_seen_of_a_system_is_what_was_described() {
    let interface = derived(&format!("{TOP}, force = -momentum"), ITEM).interface;
    let names = |quantities: &[coadjoint_codegen::program::Quantity]| {
        quantities.iter().map(|quantity| quantity.name.clone()).collect::<Vec<_>>()
    };
    assert_eq!(names(&interface.parameters), ["inertia", "weight", "chi"]);
    assert_eq!(names(&interface.state), ["attitude", "momentum", "gamma"]);
    assert!(interface.controls.is_empty());
    assert_eq!(interface.parameters[0].components, ["x", "y", "z"]);
    assert_eq!(interface.parameters[1].components, [""]);
    assert_eq!(interface.state[0].components, ["w", "x", "y", "z"]);
    let kinds: Vec<Kind> = interface.state.iter().map(|part| part.kind).collect();
    assert_eq!(kinds, [Kind::UnitQuaternion, Kind::Vector(3), Kind::Vector(3)]);
    let tangents: Vec<_> = interface.state.iter().map(|part| part.tangent.clone()).collect();
    assert_eq!(tangents, [0..3, 3..6, 6..9]);
    assert!(interface.state.iter().all(|part| part.side == Some(Side::Left)));
    assert!(interface.parameters.iter().all(|field| field.side.is_none()));
    assert_eq!((interface.scalar, interface.side), (ScalarType::F64, Side::Left));
    assert_eq!((interface.velocity, interface.momentum), (Transform::Explicit, Transform::Explicit));
    assert_eq!((interface.state_length(), interface.parameter_length()), (10, 7));
    assert_eq!((interface.state_perturbation(), interface.control_length()), (9, 0));
    assert!(interface.is_forced && !interface.is_autonomous && !interface.is_left_invariant);
    assert_eq!(interface.casimirs, ["|gamma|²"]);
    let timed =
        "group = R1, lagrangian = (1.0 + t * t) * velocity.norm_squared() * std::f64::consts::PI / 2.0";
    let timed = derived(timed, "struct Bead { #[inertia] mass: Matrix1<f64> }").interface;
    assert!(timed.is_velocity_timed && !interface.is_velocity_timed);
    assert_eq!((timed.name.as_str(), timed.parameters[0].kind), ("Bead", Kind::Symmetric(1)));
    let constant = ("const_pi".to_owned(), "std::f64::consts::PI".to_owned());
    let constants = timed.constants.into_iter().map(|constant| (constant.name, constant.path));
    assert_eq!(constants.collect::<Vec<_>>(), [constant]);
    let free = derived("group = SO3", BODY).interface;
    assert!(!free.is_forced && free.is_autonomous && free.is_left_invariant);
    assert_eq!(free.casimirs, ["|momentum|²"]);
    assert_eq!((free.inertias.len(), free.inertias[0].rows, free.inertias[0].is_matrix), (1, 3, false));
}

/// Whose momentum is constant on the other side of the configuration.
#[test]
fn systems_that_nothing_acts_on_are_isolated() {
    for (attribute, item, isolated) in [
        ("group = SO3", BODY, true),
        ("group = SO3, invariance = right", BODY, true),
        (DRIVEN, BODY, false),
        (TOP, ITEM, false),
    ] {
        let expansion = expand(tokens(attribute), tokens(item)).expect("no problem");
        assert_eq!(expansion.geometry.to_string().contains("Isolated"), isolated, "{attribute}");
        assert_eq!(
            derived(attribute, item).function(SystemRole::WithConserved).is_some(),
            isolated,
            "{attribute}"
        );
    }
}

/// What is emitted for several factors: the nearest edge of all domains, each configuration's deviation, velocities at their places.
#[test]
fn every_factor_has_its_part_in_what_is_emitted() {
    let attribute = "group(first: SO3, second: SE2), force(second = -drag * second_velocity)";
    let item =
        "struct Two { #[inertia(first)] i: Vector3<f64>, #[inertia(second)] j: Vector3<f64>, drag: f64 }";
    let expansion = expand(tokens(attribute), tokens(item)).expect("no problem");
    let expressions = expansion.expressions.to_string();
    assert!(expressions.contains("fixed_rows :: < 3 > (3)"), "{expressions}");
    let state = expansion.state.to_string();
    assert_eq!(state.matches(":: deviation (& self").count(), 2, "{state}");
    let exponential = &expansion.steps[0];
    let domain = exponential.program.module.function(StepRole::Domain).expect("two edges");
    assert_eq!(domain.results.concat().len(), 2);
    let emitted = exponential.tokens.to_string();
    assert!(emitted.contains("T :: min (T :: of"), "{emitted}");
}

/// The first problem of a description.
fn problem(attribute: &str, item: &str) -> Option<String> {
    expand(tokens(attribute), tokens(item)).err().map(|error| error.to_string())
}

#[test]
fn sizes_and_names_have_their_bounds() {
    let with = |field: &str| format!("struct A {{ #[inertia] j: Vector3<f64>, {field} }}");
    let group = "group = SO3, potential = 0.0 * a[0]";
    assert_eq!(problem(group, &with("a: SVector<f64, 32>")), None);
    assert!(problem(group, &with("a: SVector<f64, 33>")).is_some_and(|message| message.contains("32")));
    for (name, meaning) in [("t", "the time"), ("time", "the time"), ("momentum", "the momentum")] {
        let message = problem("group = SO3", &with(&format!("{name}: f64"))).expect("the name is taken");
        assert!(message.contains(meaning), "{message}");
    }
}

/// Only powers of two change no digit.
#[test]
fn only_powers_of_two_scale_exactly() {
    use coadjoint_codegen::expr::Number;
    let exact = |numerator: i128, denominator: i128| Number::ratio(numerator, denominator).scales_exactly();
    for (numerator, denominator) in [(2, 1), (4, 1), (1, 2), (1, 8), (1 << 40, 1)] {
        assert!(exact(numerator, denominator), "{numerator}/{denominator}");
    }
    for (numerator, denominator) in [(1, 1), (3, 1), (6, 1), (1, 3), (3, 4), (-2, 1), (5, 2)] {
        assert!(!exact(numerator, denominator), "{numerator}/{denominator}");
    }
}

/// Slips of a third of a name are guessed, and of three letters at most.
#[test]
fn suggestions_are_near() {
    use coadjoint_codegen::diagnostics::nearest;
    let known = ["Exponential", "Cayley"];
    assert_eq!(nearest("Exponentxyz", &known), Some("Exponential"));
    assert_eq!(nearest("Exponenwxyz", &known), None);
    assert_eq!(nearest("Calyey", &known), Some("Cayley"));
    assert_eq!(nearest("Caxxxy", &known), None);
}
