//! What is generated, for review: each snapshot shows a description and what becomes of it.
//!
//! After a change that is meant, accept with `INSTA_UPDATE=always cargo test --package coadjoint-codegen --test all snapshots`,
//! and read the difference.

use coadjoint_codegen::emit::Expansion;
use coadjoint_codegen::expand;
use coadjoint_codegen::group::Retraction;
use coadjoint_codegen::program::{Module, Operations, StepRole};
use proc_macro2::TokenStream;
use quote::quote;

/// The systems that the program runs, as they are described there.
const FREE_RIGID_BODY: &str = include_str!("../../../systems/src/free_rigid_body.rs");
const HEAVY_TOP: &str = include_str!("../../../systems/src/heavy_top.rs");
const QUADROTOR: &str = include_str!("../../../systems/src/quadrotor.rs");
const DOUBLE_PENDULUM: &str = include_str!("../../../systems/src/double_pendulum.rs");
const COUPLED_BODIES: &str = include_str!("../../../systems/src/coupled_bodies.rs");

/// The annotated struct in a source file, with its documentation: the lines between two empty ones.
fn description(source: &str) -> &str {
    source
        .split("\n\n")
        .find(|paragraph| paragraph.contains("#[lie_poisson_system"))
        .expect("a description in the file")
        .trim_end()
}

/// What the macro makes of a description.
fn expansion(description: &str) -> Expansion {
    let mut item: syn::ItemStruct = syn::parse_str(description).expect("a struct");
    let place = item
        .attrs
        .iter()
        .position(|attribute| attribute.path().is_ident("lie_poisson_system"))
        .expect("an annotation");
    let attribute = item.attrs.remove(place);
    let arguments = attribute.meta.require_list().expect("arguments").tokens.clone();
    expand(arguments, quote!(#item)).expect("an expansion")
}

/// Input and output in one text.
fn beside(description: &str, output: &str) -> String {
    format!("{description}\n\n// ─── becomes ───\n\n{}", output.trim_end())
}

/// The code of one step.
fn step(description: &str, retraction: Retraction) -> TokenStream {
    let steps = expansion(description).steps;
    let step = steps.into_iter().find(|step| step.program.scheme.retraction == retraction);
    step.expect("a step with this retraction").tokens
}

/// Tokens of items as formatted Rust.
fn pretty(tokens: TokenStream) -> String {
    match syn::parse2::<syn::File>(tokens.clone()) {
        Ok(file) => prettyplease::unparse(&file),
        Err(error) => panic!("generated code cannot be parsed: {error}\n{tokens}"),
    }
}

/// Compares with the snapshot of that name.
fn assert_snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    // programs as bytes say what the functions above them say
    settings.add_filter(r#"b"(?:[^"\\]|\\.)+""#, "b\"…\"");
    settings.bind(|| insta::assert_snapshot!(name, text));
}

#[test]
fn steps_of_the_free_rigid_body() {
    let input = description(FREE_RIGID_BODY);
    for (name, retraction) in [
        ("free_rigid_body_exponential", Retraction::Exponential),
        ("free_rigid_body_cayley", Retraction::Cayley),
        ("free_rigid_body_second_kind", Retraction::SecondKind),
    ] {
        assert_snapshot(name, &beside(input, &pretty(step(input, retraction))));
    }
}

#[test]
fn the_derivative_of_a_step_of_the_free_rigid_body() {
    let input = &description(FREE_RIGID_BODY).replace("group = SO3,", "group = SO3,\n    derivatives,");
    let steps = expansion(input).steps;
    let step = steps.into_iter().find(|step| step.program.scheme.retraction == Retraction::Cayley);
    let tokens = step.and_then(|step| step.derivative).expect("derivatives are asked for");
    assert_snapshot("free_rigid_body_cayley_derivative", &beside(input, &pretty(tokens)));
}

#[test]
fn steps_of_the_heavy_top() {
    let input = description(HEAVY_TOP);
    for (name, retraction) in
        [("heavy_top_exponential", Retraction::Exponential), ("heavy_top_cayley", Retraction::Cayley)]
    {
        assert_snapshot(name, &beside(input, &pretty(step(input, retraction))));
    }
}

/// What does not depend on the retraction: declaration, state, potential, energy, Casimirs.
#[test]
fn the_heavy_top_as_a_system() {
    let input = description(HEAVY_TOP);
    let Expansion { declaration, state, expressions, system, .. } = expansion(input);
    let output = pretty(quote! { #declaration #state #expressions #system });
    assert_snapshot("heavy_top_system", &beside(input, &output));
}

/// All of a small system with every key: controls, a force with a velocity in it, constants of the user's own, and what derivatives bring.
#[test]
fn all_of_a_driven_point() {
    let input = "\
/// A point on a spring in a wind, that a jet pushes.
#[lie_poisson_system(
    group(position: R2),
    control(jet: f64),
    potential = GRAVITY * mass * position.y + stiffness * position.norm_squared() / 3.0,
    force = vector![jet - drag * position_velocity.x, wind * (2.0 * t).sin()],
    derivatives,
)]
pub struct Point {
    #[inertia]
    mass: f64,
    stiffness: f64,
    drag: f64,
    wind: f64,
}";
    let Expansion { declaration, state, expressions, system, geometry, tangents, steps, schemes, .. } =
        expansion(input);
    let step = steps.into_iter().next().expect("a step");
    let (step, derivative) = (step.tokens, step.derivative.expect("derivatives are asked for"));
    let all =
        quote! { #declaration #state #expressions #system #geometry #tangents #step #derivative #schemes };
    assert_snapshot("driven_point", &beside(input, &pretty(all)));
}

/// The power series of a small motion with functions in it, and the time.
#[test]
fn the_series_of_a_pendulum() {
    let input = "\
#[lie_poisson_system(
    group(position: R1),
    hamiltonian = position_momentum.x.powi(2) / (2.0 * mass) - weight * position.x.cos() * t,
    taylor,
)]
pub struct Pendulum {
    mass: f64,
    weight: f64,
}";
    assert_snapshot("pendulum_taylor", &beside(input, &pretty(expansion(input).taylor)));
}

/// An event of a motion with a series of its own, and one without.
#[test]
fn the_events_of_a_point() {
    let input = "\
#[lie_poisson_system(
    group(position: R1),
    control(push: f64),
    force = push,
    event(turn = position_velocity.x, rising, high = position.x.sin() - level * t, near = position.x.abs() - level),
    taylor,
)]
pub struct Point {
    #[inertia]
    mass: f64,
    level: f64,
}";
    let Expansion { expressions, system, taylor, .. } = expansion(input);
    assert_snapshot("point_events", &beside(input, &pretty(quote! { #expressions #system #taylor })));
}

/// Arrays of factors, fields and controls, forces as parts, advected parameters of two kinds, coordinates of the second kind: what users see.
#[test]
fn two_carts_and_a_lamp() {
    let input = "\
/// Two carts on a plane that springs hold, one with an arrow, and a lamp.
#[lie_poisson_system(
    group(carts: [SE2; 2], lamp: SU2),
    advected(arrow: carts[0]::R2, field: lamp::coadjoint),
    control(pushes: [f64; 2]),
    potential = carts.iter().map(|cart| cart.translation.vector.norm_squared()).sum::<f64>() * stiffness[0] / 2.0
        + arrow.x * stiffness[1] + field.z,
    force(
        carts = [
            (-carts_angular_momentum[0], pushes[0] * carts_linear_velocity[1]),
            (-carts_angular_momentum[1], pushes[1] * carts_linear_velocity[0]),
        ],
    ),
    invariance = left,
    retractions(SecondKind),
)]
pub(crate) struct Carts {
    #[inertia(carts)]
    masses: [Vector3<f64>; 2],
    #[inertia(lamp)]
    inertia: Matrix3<f64>,
    stiffness: [f64; 2],
}";
    let Expansion { state, expressions, schemes, .. } = expansion(input);
    assert_snapshot("carts", &beside(input, &pretty(quote! { #state #expressions #schemes })));
}

/// The intermediate representation of a small step: shorter to review than code.
#[test]
fn the_kernel_of_the_free_rigid_body() {
    let input = description(FREE_RIGID_BODY);
    let steps = expansion(input).steps;
    let step = steps
        .iter()
        .find(|step| step.program.scheme.retraction == Retraction::Cayley)
        .expect("a Cayley step");
    assert_snapshot("free_rigid_body_cayley_kernel", &beside(input, &step.program.module.to_string()));
}

/// What forces and a potential on the group add, with each of the family's named members: the steps of a driven pendulum with friction.
#[test]
fn the_kernels_of_a_driven_pendulum() {
    let input = "\
/// A pendulum with friction that a motor drives.
#[lie_poisson_system(
    group = SO2,
    potential = -weight * angle.cos_angle(),
    control(torque: f64),
    force = vector![torque - friction * velocity.x],
    methods(SymplecticEulerB, Midpoint),
)]
struct Pendulum {
    #[inertia]
    inertia: f64,
    weight: f64,
    friction: f64,
}";
    let steps = expansion(input).steps;
    let kernels: Vec<String> = steps
        .iter()
        .filter(|step| step.program.scheme.retraction == Retraction::Cayley)
        .map(|step| format!("─── {} ───\n\n{}", step.program.scheme.type_name(), step.program.module))
        .collect();
    assert_eq!(kernels.len(), 3);
    assert_snapshot("driven_pendulum_kernels", &beside(input, &kernels.join("\n")));
}

/// The functions of a step that tell the system, as the first member of the family with the Cayley map has them.
fn sections(name: &str, input: &str, roles: &[StepRole]) {
    let steps = expansion(input).steps;
    let step = steps.iter().find(|step| step.program.scheme.retraction == Retraction::Cayley);
    let module = &step.expect("a Cayley step").program.module;
    assert_snapshot(name, &beside(input, &module.text(roles)));
}

/// Rotation and translation in one equation.
#[test]
fn a_body_in_a_fluid() {
    let input = "\
/// A body that moves in an ideal fluid, along its principal axes.
#[lie_poisson_system(group = SE3)]
struct Body {
    #[inertia]
    inertia: Vector6<f64>,
}";
    sections("body_in_a_fluid", input, &[StepRole::Evaluate, StepRole::FixedPointUpdate, StepRole::Domain]);
}

/// Two factors that meet in the potential alone: each is kicked, and goes on by itself.
#[test]
fn two_coupled_pendulums() {
    let input = "\
/// Two pendulums with a torsion spring between them.
#[lie_poisson_system(
    group(first: SO2, second: SO2),
    potential = -stiffness * (first.inverse() * second).cos_angle(),
)]
struct Pendulums {
    #[inertia(first)]
    first_inertia: f64,
    #[inertia(second)]
    second_inertia: f64,
    stiffness: f64,
}";
    let roles = [
        StepRole::New,
        StepRole::Begin,
        StepRole::Start,
        StepRole::Evaluate,
        StepRole::Correction,
        StepRole::Finish,
    ];
    sections("two_coupled_pendulums", input, &roles);
}

/// An energy that is not quadratic: momentum and velocity are both unknown.
#[test]
fn a_general_hamiltonian() {
    let input = "\
/// A point that moves at nearly the speed of light.
#[lie_poisson_system(
    group = R1,
    hamiltonian = (momentum.x.powi(2) + mass.powi(2)).sqrt() + stiffness * position.x.powi(2) / 2.0,
    methods(Midpoint),
)]
struct Relativistic {
    mass: f64,
    stiffness: f64,
}";
    let steps = expansion(input).steps;
    let step = steps.iter().find(|step| step.program.scheme.type_name() == "Midpoint<Exponential>");
    let module = &step.expect("a midpoint step").program.module;
    assert_snapshot("general_hamiltonian", &beside(input, &module.to_string()));
}

/// A mass matrix that depends on the configuration: nothing is inverted but where the velocity is asked for.
#[test]
fn a_double_pendulum_by_its_lagrangian() {
    let input = description(DOUBLE_PENDULUM);
    let Expansion { declaration, steps, .. } = expansion(input);
    let step = steps.iter().find(|step| step.program.scheme.type_name() == "SymplecticEulerA<Cayley>");
    let module = &step.expect("a first step").program.module;
    assert_snapshot("double_pendulum", &beside(input, &format!("{}\n{module}", pretty(declaration))));
}

/// A velocity without a closed form: what stands in its place, and what needs it.
#[test]
fn a_velocity_without_a_closed_form() {
    let input = "\
/// A point that moves at nearly the speed of light.
#[lie_poisson_system(group = R1, lagrangian = -mass * (1.0 - velocity.x.powi(2)).sqrt())]
struct Relativistic {
    mass: f64,
}";
    let Expansion { system, geometry, .. } = expansion(input);
    assert_snapshot("velocity_without_closed_form", &beside(input, &pretty(quote! { #system #geometry })));
}

/// What `invariance = right` changes: signs, and the side on which the attitude is turned.
#[test]
fn a_right_invariant_system() {
    let input = "\
/// A rigid body seen from space, by the velocity there.
#[lie_poisson_system(group = SO3, invariance = right)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}";
    sections("right_invariant", input, &[StepRole::Evaluate, StepRole::Finish]);
}

/// A step that has nothing to solve for.
#[test]
fn an_explicit_step() {
    let input = "\
/// A mass on a spring.
#[lie_poisson_system(group = R1, potential = stiffness * position.x.powi(2) / 2.0)]
struct Oscillator {
    #[inertia]
    mass: f64,
    stiffness: f64,
}";
    let steps = expansion(input).steps;
    assert_snapshot("explicit_step", &beside(input, &pretty(steps[0].tokens.clone())));
}

/// Systems that nobody looked at while the generator was made faster have no operation that their equations do not need. Their rotations
/// are those of free bodies, with the operations of these and not one more; what else they compute has been counted by hand.
#[test]
fn no_system_computes_what_its_equations_do_not_need() {
    fn module(source: &str, retraction: Retraction) -> Module<StepRole> {
        let steps = expansion(description(source)).steps;
        let step = steps.into_iter().find(|step| step.program.scheme.retraction == retraction);
        step.expect("a step with this retraction").program.module
    }
    let of = |module: &Module<StepRole>, role: StepRole| {
        let Operations { additions, multiplications, divisions, roots, stumpff, functions, .. } =
            module.operations(role);
        [additions, multiplications, divisions, roots, stumpff, functions]
    };
    let times = |n: usize, operations: [usize; 6]| operations.map(|count| n * count);
    for retraction in [Retraction::Cayley, Retraction::Exponential] {
        let free = module(FREE_RIGID_BODY, retraction);
        let quadrotor = module(QUADROTOR, retraction);
        let coupled = module(COUPLED_BODIES, retraction);
        // a translation is explicit: iterations know nothing of it
        for (bodies, system) in [(1, &quadrotor), (2, &coupled)] {
            for role in [StepRole::Evaluate, StepRole::Correction, StepRole::FixedPointUpdate] {
                assert_eq!(of(system, role), times(bodies, of(&free, role)));
            }
        }
        let once = |module: &Module<StepRole>| {
            let (begin, finish) = (of(module, StepRole::Begin), of(module, StepRole::Finish));
            core::array::from_fn(|k| begin[k] + finish[k])
        };
        let besides = |system: &Module<StepRole>, bodies: usize| {
            let [all, rotation] = [once(system), times(bodies, once(&free))];
            assert_eq!(all[2..], rotation[2..]);
            [all[0] - rotation[0], all[1] - rotation[1]]
        };
        // additions and multiplications: h M onto Π 3 and 3; wy + xz and wx − yz 2 and 4 (x² + y² is part of |q|²), by 2hF 0 and 3, the third
        // component of the thrust with the weight 2 and 3; onto p 3; h p/m onto x 3 and 3
        assert_eq!(besides(&quadrotor, 1), [13, 16]);
        // q₁* q₂: 12 and 16; its vector times its scalar part and 2hk: 4; onto Π₁ and off Π₂: 6
        assert_eq!(besides(&coupled, 2), [18, 20]);
    }
}
