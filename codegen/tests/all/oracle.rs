//! Programs in doubles against the expressions that they were made from: the fast form of what the tests of the workspace do with 77
//! digits, for every function of every kind of system.

use crate::evaluate::Evaluate as _;
use crate::interpret::{Call as _, CallError, Given};
use coadjoint_codegen::derive::geometry;
use coadjoint_codegen::emit::bytes;
use coadjoint_codegen::expr::{Arena, Stage, Symbol, Vector};
use coadjoint_codegen::group::Retraction;
use coadjoint_codegen::kernel::{self, Inputs};
use coadjoint_codegen::method::linearization::{Linearization, Matrices};
use coadjoint_codegen::method::{family, tangent_lift};
use coadjoint_codegen::model::{Energy, Relation, System};
use coadjoint_codegen::program::{DerivativeRole, FunctionRole, Input, Module, StepRole, SystemRole};
use coadjoint_codegen::scheme::Derivatives;
use coadjoint_codegen::scheme::Member;

use crate::bytes::Machine;
use crate::common::{system, tokens};

/// One system for each way in which steps differ: what stands in the attribute, and the struct.
const SYSTEMS: [(&str, &str); 15] = [
    ("group = SO3", "struct A { #[inertia] j: Vector3<f64> }"),
    ("group = SO3", "struct A { #[inertia] j: Matrix3<f64> }"),
    (
        "group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi) / 3.0",
        "struct A { #[inertia] j: Vector3<f64>, weight: f64, chi: Vector3<f64> }",
    ),
    ("group = SO3, invariance = right", "struct A { #[inertia] j: Vector3<f64> }"),
    ("group = SE3", "struct A { #[inertia] j: Vector6<f64> }"),
    (
        "group = SE2, advected(a: R2), potential = k * a.norm_squared()",
        "struct A { #[inertia] j: Vector3<f64>, k: f64 }",
    ),
    (
        "group(first: SO3, second: SO2), control(push: f64), potential = k * first.w.powi(5) * second.cos_angle(), \
         force(first = vector![push, -drag * first_velocity.y, t.sin()])",
        "struct A { #[inertia(first)] i: Vector3<f64>, #[inertia(second)] j: f64, k: f64, drag: f64 }",
    ),
    (
        "group = R2, potential = (position.x * k).exp() + position.y.powi(2).sqrt()",
        "struct A { #[inertia] m: f64, k: f64 }",
    ),
    (
        "group = SO3, hamiltonian = (momentum.norm_squared() / mass + 1.0).sqrt() + attitude.w.atan2(mass)",
        "struct A { mass: f64 }",
    ),
    (
        "group = SO3, hamiltonian = momentum.norm_squared() * mass + momentum.x * attitude.w",
        "struct A { mass: f64 }",
    ),
    (
        "group = R2, lagrangian = velocity.norm_squared() * mass + velocity.x * velocity.y * (position.x - position.y).cos() - position.y",
        "struct A { mass: f64 }",
    ),
    (
        "group(first: SO3, second: R1), advected(gamma: first::R3), control(push: f64), force(second = vector![push]), \
         lagrangian = first_velocity.norm_squared() * j * (2.0 + second.x.sin()) + second_velocity.x.powi(2) - gamma.x * t",
        "struct A { j: f64 }",
    ),
    (
        "group = SO3, potential = k * vector![attitude.i, attitude.j, attitude.k].norm().atan2(attitude.w).powi(2) / 8.0, \
         force = -drag * velocity.norm() * velocity",
        "struct A { #[inertia] j: Vector3<f64>, k: f64, drag: f64 }",
    ),
    (
        "group = R2, potential = k * position.norm().powf(2.3) / 8.0, force = -drag * velocity.norm().sqrt() * velocity",
        "struct A { #[inertia] m: f64, k: f64, drag: f64 }",
    ),
    (
        "group = R2, lagrangian = -mass * (64.0 - velocity.norm_squared() * 0.25).sqrt() - position.x.sin()",
        "struct A { mass: f64 }",
    ),
];

/// A value for every symbol: between one and two, different for each, so that no function is outside of its domain. Steps are shorter: series of
/// Stumpff functions lose all digits where their argument is large.
fn value(arena: &Arena, symbol: Symbol) -> f64 {
    let name = arena.symbol_info(symbol).name;
    let hash = name.bytes().fold(17_u32, |hash, byte| hash.wrapping_mul(31).wrapping_add(u32::from(byte)));
    let value = 1.0 + f64::from(hash % 1009) / 1009.0;
    if name == "h" { value / 4.0 } else { value }
}

fn values(arena: &Arena, symbols: &[Symbol]) -> Vec<f64> {
    symbols.iter().map(|&symbol| value(arena, symbol)).collect()
}

fn direct(arena: &Arena, vector: &Vector<'_>) -> Vec<f64> {
    vector.evaluate(&|symbol| value(arena, symbol))
}

/// Equal up to roundoff.
fn assert_close(computed: &[f64], direct: &[f64], what: &str) {
    assert_eq!(computed.len(), direct.len(), "{what}");
    let size = direct.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    for (computed, direct) in computed.iter().zip(direct) {
        assert!((computed - direct).abs() < 1e-9 * size, "{what}: {computed} instead of {direct}");
    }
}

/// All arrays of a system.
fn given(arena: &Arena, system: &System<'_>) -> Given<f64> {
    Given::default()
        .with(Input::Parameters, values(arena, &system.parameter_symbols()))
        .with(Input::State, values(arena, &system.state_symbols()))
        .with(Input::Time, values(arena, &system.time_symbol()))
        .with(Input::Control, values(arena, &system.control_symbols()))
}

fn call<R: FunctionRole>(module: &Module<R>, role: R, given: &Given<f64>) -> Vec<Vec<f64>> {
    module.call(role, given).unwrap_or_else(|error| panic!("{role:?}: {error}")).results
}

/// What is given, with the record that a function returns.
fn with_record<R: FunctionRole>(module: &Module<R>, role: R, given: Given<f64>) -> Given<f64> {
    let returned = module.call(role, &given).unwrap_or_else(|error| panic!("{role:?}: {error}"));
    let (kind, fields) = returned.record.expect("a record");
    given.with(Input::Record(kind), fields)
}

#[test]
fn steps_compute_their_equations() {
    for description in SYSTEMS {
        for retraction in Retraction::ALL {
            for member in [Member::SYMPLECTIC_EULER_A, Member::MIDPOINT, Member::SYMPLECTIC_EULER_B] {
                let arena = Arena::new();
                let system = system(&arena, description);
                let step = family::step(&arena, &system, retraction, member);
                let what = format!("{}, {}, {}", description.0, retraction.name(), member.s());
                check_step(&arena, &system, &step, &what);
            }
        }
    }
}

#[test]
fn tangent_lifts_compute_their_equations() {
    for description in SYSTEMS {
        for retraction in Retraction::ALL {
            for member in [Member::SYMPLECTIC_EULER_A, Member::MIDPOINT, Member::SYMPLECTIC_EULER_B] {
                let arena = Arena::new();
                let system = system(&arena, description);
                let step = tangent_lift::step(&arena, &system, retraction, member);
                let what = format!("{}, {}, lift {}", description.0, retraction.name(), member.s());
                check_step(&arena, &system, &step, &what);
            }
        }
    }
}

fn check_step<'a>(
    arena: &'a Arena,
    system: &System<'a>,
    step: &coadjoint_codegen::method::Step<'a>,
    what: &str,
) {
    let module = kernel::step(arena, step, Inputs::of(system));
    let unknown = step.unknown.symbols();
    let given = given(arena, system)
        .with(Input::StepSize, direct(arena, &Vector(vec![step.h])))
        .with(Input::Unknown, values(arena, &unknown));
    let given = with_record(&module, StepRole::New, given);
    let given = with_record(&module, StepRole::Begin, given);
    let one = |role, given: &Given<f64>| call(&module, role, given).concat();
    assert_close(&one(StepRole::Start, &given), &direct(arena, &step.start), what);
    let residual = direct(arena, &(&step.left - &step.right));
    let right = direct(arena, &step.right);
    assert_close(&one(StepRole::Evaluate, &given), &[residual.clone(), right.clone()].concat(), what);
    let given = with_record(&module, StepRole::Evaluate, given)
        .with(Input::Residual, residual.clone())
        .with(Input::Right, right.clone());
    assert_close(&one(StepRole::Finish, &given), &direct(arena, &step.next), what);
    assert_eq!(module.function(StepRole::Domain).is_some(), !step.domain.is_empty(), "{what}");
    if !step.domain.is_empty() {
        assert_close(&one(StepRole::Domain, &given), &direct(arena, &Vector(step.domain.clone())), what);
    }
    // as bytes they compute the same
    let bytes: Vec<Vec<u8>> = bytes::functions(&module).collect();
    let [parameters, state, time, control] = [
        system.parameter_symbols(),
        system.state_symbols(),
        system.time_symbol().to_vec(),
        system.control_symbols(),
    ]
    .map(|symbols| values(arena, &symbols));
    let (h, at) = (direct(arena, &Vector(vec![step.h])), values(arena, &unknown));
    let all: [&[f64]; 8] = [&parameters, &h, &state, &time, &control, &at, &residual, &right];
    let mut machine = Machine::default();
    let results: Vec<Vec<f64>> = bytes.iter().map(|code| machine.call(code, all).concat()).collect();
    assert_close(&results[2], &[residual.clone(), right.clone()].concat(), what);
    assert_close(&results[3], &direct(arena, &step.next), what);
    // the correction solves the linearized equation
    let jacobian = (&step.left - &step.right).jacobian(&unknown);
    let correction = one(StepRole::Correction, &given);
    let row =
        |i: usize| direct(arena, &jacobian.row(i)).iter().zip(&correction).map(|(a, x)| a * x).sum::<f64>();
    let image: Vec<f64> = (0..unknown.len()).map(row).collect();
    assert_close(&image, &residual, what);
    // the update solves the equation with this right side, which is linear; of an equation without denominators it goes further
    if module.function(StepRole::FixedPointUpdate).is_some() {
        let update = one(StepRole::FixedPointUpdate, &given);
        let at = |symbol| match unknown.iter().position(|known| *known == symbol) {
            Some(place) => update[place],
            None => value(arena, symbol),
        };
        let left = direct(arena, &step.left);
        let there = step.left.evaluate(&at);
        let went = there.iter().zip(&left).map(|(there, here)| here - there);
        let factors: Vec<f64> = went.zip(&residual).map(|(went, residual)| went / residual).collect();
        if factors.iter().all(|factor| *factor > 1.0 + 1e-6) {
            // no more than 1 + |x|², with unknowns below 2
            let most = 1.0 + 4.0 * unknown.len() as f64;
            assert!(factors.iter().all(|factor| *factor < most), "{what}: {factors:?}");
        } else {
            assert_close(&there, &right, what);
        }
    }
}

#[test]
fn derivatives_compute_their_linearization() {
    for description in SYSTEMS {
        let arena = Arena::new();
        let system = system(&arena, description);
        let retraction = Retraction::Cayley;
        let step = family::step(&arena, &system, retraction, Member::SYMPLECTIC_EULER_A);
        let linearization = Linearization::new(&arena, &system, &step, Derivatives::ALL);
        let inputs = Inputs::of(&system);
        let module = kernel::derivative(&arena, &step, &linearization, Derivatives::ALL, inputs);
        let adjoint = linearization.adjoint(&arena);
        let of = |vector: &Vector<'_>| direct(&arena, vector);
        let given = given(&arena, &system)
            .with(Input::StepSize, of(&Vector(vec![step.h])))
            .with(Input::Unknown, of(&step.unknown))
            .with(Input::StatePerturbation, of(&linearization.state))
            .with(Input::ControlPerturbation, of(&linearization.control))
            .with(Input::ParameterPerturbation, of(&linearization.parameters))
            .with(Input::Costate, of(&adjoint.next));
        let given = with_record(&module, DerivativeRole::Point, given);
        let Matrices { through, columns } = linearization.matrices(&arena, Derivatives::ALL);
        let mut expected = vec![
            (DerivativeRole::Tangent, vec![linearization.next.clone()]),
            (DerivativeRole::Adjoint, vec![adjoint.state, adjoint.control, adjoint.parameters]),
        ];
        expected.extend(through.map(|columns| (DerivativeRole::Through, columns)));
        let roles = [DerivativeRole::WrtState, DerivativeRole::WrtControl, DerivativeRole::WrtParameters];
        for (role, columns) in roles.into_iter().zip(columns) {
            let columns = columns.map(|columns| columns.into_iter().flat_map(<[_; 2]>::from).collect());
            expected.extend(columns.map(|columns| (role, columns)));
        }
        assert_eq!(module.functions.len(), expected.len() + 1, "{}", description.0);
        for (role, vectors) in expected {
            let computed = call(&module, role, &given);
            for (computed, vector) in computed.iter().zip(&vectors) {
                assert_close(computed, &of(vector), &format!("{}, {role:?}", description.0));
            }
        }
    }
}

#[test]
fn functions_of_systems_compute_their_expressions() {
    for description in SYSTEMS {
        let program =
            coadjoint_codegen::program(tokens(description.0), tokens(description.1)).expect("a program");
        let arena = Arena::new();
        let system = system(&arena, description);
        let by = geometry::tangent_symbols(&arena, &system, "by");
        let symbol = |i: usize| arena.symbol(format!("conserved_{i}"), Stage::Step);
        let conserved = Vector((0..system.dimension()).map(symbol).collect::<Vec<_>>());
        let given = given(&arena, &system)
            .with(Input::Tangent, direct(&arena, &by))
            .with(Input::Conserved, direct(&arena, &conserved))
            .with(Input::Velocity, direct(&arena, &system.velocity_symbols()));
        let casimirs = Vector(system.casimirs().found.iter().map(|&(_, value)| value).collect());
        let mut expected = vec![
            (SystemRole::Energy, Vector(vec![system.energy()])),
            (SystemRole::Casimirs, casimirs),
            (SystemRole::Differential, geometry::differential(&system)),
            (SystemRole::HamiltonianVector, geometry::hamiltonian_vector(&arena, &system, &by)),
            (SystemRole::Force, geometry::force(&arena, &system)),
        ];
        // along retractions that the program has no steps with, too
        for retraction in Retraction::ALL {
            let (role, value) =
                (SystemRole::Displacement(retraction), geometry::displaced(&system, retraction, &by));
            let inputs = Inputs::of(&system).with(Input::Tangent, by.symbols());
            let module = kernel::function(&arena, role, &value, inputs);
            assert_close(&call(&module, role, &given).concat(), &direct(&arena, &value), description.0);
            let has_steps = program.steps.iter().any(|step| step.scheme.retraction == retraction);
            let is_there = has_steps || retraction == Retraction::Exponential;
            assert_eq!(program.function(role).is_some(), is_there);
        }
        let newton = |residual: &Vector<'_>, role: SystemRole| {
            let (module, _) = program.function(role).expect("where there is no closed form");
            let computed = call(module, role, &given).concat();
            assert_close(&computed[..residual.len()], &direct(&arena, residual), description.0);
        };
        match system.velocity_relation() {
            Relation::Explicit(velocity) => expected.push((SystemRole::Velocity, velocity.clone())),
            Relation::Implicit(residual) => newton(residual, SystemRole::VelocityNewton),
            Relation::Singular => assert!(program.function(SystemRole::Velocity).is_none()),
        }
        match system.momentum_relation() {
            Relation::Explicit(momentum) => expected.push((SystemRole::Momentum, momentum)),
            Relation::Implicit(residual) => newton(&residual, SystemRole::MomentumNewton),
            Relation::Singular => assert!(program.function(SystemRole::Momentum).is_none()),
        }
        let inertias = system.inertias.iter().enumerate();
        expected.extend(inertias.map(|(place, inertia)| (SystemRole::Pivots(place), inertia.matrix.ldl().1)));
        if program.function(SystemRole::WithConserved).is_some() {
            expected.push((SystemRole::Conserved, geometry::conserved(&system)));
            expected.push((SystemRole::WithConserved, geometry::with_conserved(&system, &conserved)));
        }
        for (role, expressions) in &expected {
            let (module, _) = program.function(*role).expect("every system has it");
            let computed = call(module, *role, &given).concat();
            assert_close(&computed, &direct(&arena, expressions), &format!("{}, {role:?}", description.0));
        }
    }
}

/// Twice the kinetic energy is `μ·v`, with `𝕀 v = μ`.
#[test]
fn the_energy_is_that_of_the_inertia() {
    for description in [SYSTEMS[0], SYSTEMS[1], SYSTEMS[4]] {
        let arena = Arena::new();
        let system = system(&arena, description);
        let Energy::Mechanical { inertia, .. } = &system.energy else { panic!("an inertia") };
        // far from singular, as inertias are
        let diagonal: Vec<Symbol> = (0..inertia.rows).filter_map(|i| inertia.at(i, i).as_symbol()).collect();
        let at = |symbol| value(&arena, symbol) + if diagonal.contains(&symbol) { 4.0 } else { 0.0 };
        let [mu, v] = [system.momentum(), system.velocity()].map(|vector| vector.evaluate(&at));
        let image = inertia.times(&system.velocity()).evaluate(&at);
        assert_close(&image, &mu, description.1);
        let twice: f64 = mu.iter().zip(&v).map(|(mu, v)| mu * v).sum();
        assert_close(&[system.energy().evaluate(&at)], &[twice / 2.0], description.1);
    }
}

#[test]
fn calls_without_what_they_need_are_errors() {
    let arena = Arena::new();
    let system = system(&arena, SYSTEMS[0]);
    let step = family::step(&arena, &system, Retraction::Cayley, Member::SYMPLECTIC_EULER_A);
    let module = kernel::step(&arena, &step, Inputs::of(&system));
    let call = |role, given: &Given<f64>| module.call(role, given).map(|_| ());
    let none = Given::default();
    assert_eq!(call(StepRole::Domain, &none), Err(CallError::NoFunction("domain".to_owned())));
    assert_eq!(call(StepRole::New, &none), Err(CallError::NotGiven(Input::Parameters)));
    let short = Given::default().with(Input::Parameters, [1.0, 2.0]).with(Input::StepSize, [0.1]);
    assert_eq!(call(StepRole::New, &short), Err(CallError::NotGiven(Input::Parameters)));
    assert!(CallError::NotGiven(Input::State).to_string().contains("State"));
}
