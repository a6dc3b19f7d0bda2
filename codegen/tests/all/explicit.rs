//! Hamilton–Jacobi steps of motions that are linear: their equations are solved as they are derived, and nothing is left to iterate on. Their
//! programs are held against the equations of motion, written by hand and solved with many small steps.

use crate::common::{system, tokens};
use crate::interpret::{Call as _, Given};
use coadjoint_codegen::emit::c99::{Options, Steps};
use coadjoint_codegen::expr::{Arena, Symbol};
use coadjoint_codegen::group::Retraction;
use coadjoint_codegen::kernel::{self, Inputs};
use coadjoint_codegen::method::hamilton_jacobi;
use coadjoint_codegen::program::{Input, Module, RecordKind, StepRole};

const MASS: f64 = 1.25;
const STIFFNESS: f64 = 1.5;
const GYRATION: f64 = 0.75;
const DRAG: f64 = 0.5;
const PUSH: f64 = 0.625;
const CONTROL: f64 = 0.375;
const START: f64 = 0.25;

/// A system, its state at the start, and how this changes: `change(t, state)`.
type Motion = (&'static str, &'static str, &'static [f64], fn(f64, &[f64]) -> Vec<f64>);

const OSCILLATOR: Motion = (
    "group = R1, potential = 0.5 * stiffness * position.x.powi(2)",
    "struct A { #[inertia] mass: f64, stiffness: f64 }",
    &[0.5, -0.75],
    |_, y| vec![y[1] / MASS, -STIFFNESS * y[0]],
);

const PARTICLE: Motion =
    ("group = R2", "struct A { #[inertia] mass: f64 }", &[0.5, 1.0, -0.75, 2.0], |_, y| {
        vec![y[2] / MASS, y[3] / MASS, 0.0, 0.0]
    });

/// Its angle is stored as cosine and sine.
const ROTOR: Motion = ("group = SO2", "struct A { #[inertia] mass: f64 }", &[0.6, 0.8, 1.5], |_, y| {
    vec![-y[1] * y[2] / MASS, y[0] * y[2] / MASS, 0.0]
});

/// By a force alone.
const BRAKED: Motion = (
    "group = R3, force = -drag * velocity",
    "struct A { #[inertia] mass: f64, drag: f64 }",
    &[0.5, -0.25, 0.75, 0.5, 1.0, -0.5],
    |_, y| {
        let rate = |k: usize| y[3 + k] / MASS;
        (0..3).map(rate).chain((0..3).map(|k| -DRAG * rate(k))).collect()
    },
);

/// A Penning trap: a field along the axis, and a potential that confines on this axis alone.
const TRAP: Motion = (
    "group = R3, hamiltonian = momentum.norm_squared() / (2.0 * mass) \
     - gyration * (position.x * momentum.y - position.y * momentum.x) \
     + stiffness * (position.z.powi(2) - 0.5 * position.x.powi(2) - 0.5 * position.y.powi(2)) / 8.0 \
     + 0.5 * mass * gyration.powi(2) * (position.x.powi(2) + position.y.powi(2))",
    "struct A { mass: f64, stiffness: f64, gyration: f64 }",
    &[0.5, -0.25, 0.75, 0.5, 1.0, -0.5],
    |_, y| {
        let radial = STIFFNESS / 8.0 - MASS * GYRATION * GYRATION;
        vec![
            y[3] / MASS + GYRATION * y[1],
            y[4] / MASS - GYRATION * y[0],
            y[5] / MASS,
            GYRATION * y[4] + radial * y[0],
            -GYRATION * y[3] + radial * y[1],
            -STIFFNESS * y[2] / 4.0,
        ]
    },
);

/// By drag, a force that changes with the time, and a control.
const DRIVEN: Motion = (
    "group = R1, control(pull: f64), potential = 0.5 * stiffness * position.x.powi(2), \
     force = vector![push * t.sin() + pull - drag * velocity.x]",
    "struct A { #[inertia] mass: f64, stiffness: f64, push: f64, drag: f64 }",
    &[0.5, -0.75],
    |t, y| vec![y[1] / MASS, -STIFFNESS * y[0] + PUSH * t.sin() + CONTROL - DRAG * y[1] / MASS],
);

const MOTIONS: [Motion; 6] = [
    OSCILLATOR,
    TRAP,
    // a field across a plane, by a Lagrangian: the momentum has its potential
    (
        "group = R2, lagrangian = 0.5 * mass * velocity.norm_squared() \
         + gyration * (position.x * velocity.y - position.y * velocity.x) - 0.5 * stiffness * position.norm_squared()",
        "struct A { mass: f64, stiffness: f64, gyration: f64 }",
        &[0.5, -0.25, 0.75, 1.0],
        |_, y| {
            let v = [(y[2] + GYRATION * y[1]) / MASS, (y[3] - GYRATION * y[0]) / MASS];
            vec![v[0], v[1], GYRATION * v[1] - STIFFNESS * y[0], -GYRATION * v[0] - STIFFNESS * y[1]]
        },
    ),
    // a stiffness and a load that change with the time
    (
        "group = R1, potential = 0.5 * stiffness * (1.0 + 0.5 * t.sin()) * position.x.powi(2) - push * t.cos() * position.x",
        "struct A { #[inertia] mass: f64, stiffness: f64, push: f64 }",
        &[0.5, -0.75],
        |t, y| vec![y[1] / MASS, -STIFFNESS * (1.0 + 0.5 * t.sin()) * y[0] + PUSH * t.cos()],
    ),
    DRIVEN,
    // two factors that a spring couples
    (
        "group(cart: R1, load: R2), potential = 0.5 * stiffness * ((cart.x - load.x).powi(2) + load.y.powi(2))",
        "struct A { #[inertia(cart)] mass: f64, #[inertia(load)] stiffness: f64 }",
        &[0.5, -0.25, 0.75, 0.5, 1.0, -0.5],
        |_, y| {
            // the state has each factor's position and momentum
            let pull = STIFFNESS * (y[0] - y[2]);
            let [load_x, load_y] = [y[4] / STIFFNESS, y[5] / STIFFNESS];
            vec![y[1] / MASS, -pull, load_x, load_y, pull, -STIFFNESS * y[3]]
        },
    ),
];

/// The state after a time, by Runge–Kutta steps that are small enough to leave rounding alone.
fn moved((_, _, start, change): Motion, time: f64) -> Vec<f64> {
    let count = 1000;
    let h = time / f64::from(count);
    (0..count).fold(start.to_vec(), |y, k| {
        let t = START + f64::from(k) * h;
        let ahead = |by: f64, slope: &[f64]| -> Vec<f64> {
            y.iter().zip(slope).map(|(y, slope)| y + by * slope).collect()
        };
        let first = change(t, &y);
        let second = change(t + 0.5 * h, &ahead(0.5 * h, &first));
        let third = change(t + 0.5 * h, &ahead(0.5 * h, &second));
        let last = change(t + h, &ahead(h, &third));
        let mean = |k: usize| (first[k] + 2.0 * (second[k] + third[k]) + last[k]) / 6.0;
        let mean: Vec<f64> = (0..y.len()).map(mean).collect();
        ahead(h, &mean)
    })
}

/// The state after one step, by the program.
fn stepped((attribute, item, start, _): Motion, order: u32, h: f64) -> Vec<f64> {
    let arena = Arena::new();
    let system = system(&arena, (attribute, item));
    let step = hamilton_jacobi::step(&arena, &system, Retraction::Exponential, order);
    assert!(step.unknown.is_empty(), "{attribute}, order {order}: {} unknowns are left", step.unknown.len());
    let module = kernel::step(&arena, &step, Inputs::of(&system));
    let parameter = |symbol: &Symbol| match arena.symbol_info(*symbol).name.as_str() {
        "mass" => MASS,
        "stiffness" => STIFFNESS,
        "gyration" => GYRATION,
        "drag" => DRAG,
        "push" => PUSH,
        name => panic!("a parameter `{name}`"),
    };
    let given = Given::default()
        .with(Input::Parameters, system.parameter_symbols().iter().map(parameter))
        .with(Input::State, start.to_vec())
        .with(Input::Time, system.time_symbol().iter().map(|_| START))
        .with(Input::Control, system.control_symbols().iter().map(|_| CONTROL))
        .with(Input::StepSize, [h])
        .with(Input::Unknown, [])
        .with(Input::Residual, [])
        .with(Input::Right, []);
    let roles = [StepRole::New, StepRole::Begin, StepRole::Evaluate];
    let given = roles.into_iter().fold(given, |given, role| with_record(&module, role, given));
    assert!(module.function(StepRole::FixedPointUpdate).is_none(), "{attribute}: nothing is iterated");
    module
        .call(StepRole::Finish, &given)
        .unwrap_or_else(|error| panic!("{attribute}: {error}"))
        .results
        .concat()
}

/// What is given, with the record that a function returns.
fn with_record(module: &Module<StepRole>, role: StepRole, given: Given<f64>) -> Given<f64> {
    let returned = module.call(role, &given).unwrap_or_else(|error| panic!("{role:?}: {error}"));
    let (kind, fields): (RecordKind, _) = returned.record.expect("a record");
    given.with(Input::Record(kind), fields)
}

fn error(motion: Motion, order: u32, h: f64) -> f64 {
    let next = stepped(motion, order, h).into_iter().zip(moved(motion, h));
    next.map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

/// Asserts what errors of a step and of one of half its length tell of the order.
fn has_order(motion: Motion, order: u32, h: f64) {
    let [large, small] = [h, h / 2.0].map(|h| error(motion, order, h));
    let measured = (large / small).log2() - 1.0;
    let what = format!("{}, order {order}", motion.0);
    println!("{measured:.3}: {what} of {large:.1e} and {small:.1e}");
    assert!(small > 1e-12, "{what}: rounding leaves {small:e}");
    // orders of symmetric steps are two apart
    assert!((measured - f64::from(order)).abs() < 0.4, "{what}: {measured}");
}

#[test]
fn steps_of_linear_motions_have_their_orders() {
    for motion in MOTIONS {
        for (order, h) in [(4, 0.125), (6, 0.15)] {
            has_order(motion, order, h);
        }
    }
    for (order, h) in [(8, 1.0), (10, 1.5)] {
        has_order(OSCILLATOR, order, h);
    }
    for (order, h) in [(4, 0.5), (6, 1.0)] {
        has_order(BRAKED, order, h);
    }
}

#[test]
fn steps_of_free_motions_are_exact() {
    for motion in [PARTICLE, ROTOR] {
        for order in [4, 6, 8, 10] {
            let error = error(motion, order, 1.0);
            assert!(error < 1e-13, "{}, order {order}: {error:e}", motion.0);
        }
    }
}

/// Whole programs: their derivatives, as Rust, and as C.
#[test]
fn programs_of_linear_motions_are_written() {
    let name = "HamiltonJacobi<Exponential, 4>";
    for (attribute, item, ..) in [OSCILLATOR, ROTOR, TRAP, DRIVEN] {
        let attribute = format!("{attribute}, methods(HamiltonJacobi(4)), derivatives");
        let program = coadjoint_codegen::program(tokens(&attribute), tokens(item)).expect("a program");
        let step = program.steps.iter().find(|step| step.scheme.type_name() == name).expect("a step");
        let is_iterated = step.is_newton || step.module.function(StepRole::FixedPointUpdate).is_some();
        assert!(!is_iterated && step.derivative.is_some(), "{attribute}");
        let rust = coadjoint_codegen::expand(tokens(&attribute), tokens(item)).expect("a sound description");
        assert!(rust.declaration.to_string().contains("HamiltonJacobi"), "{attribute}");
        let options = Options { steps: vec![Steps::of(name)], ..Options::default() };
        let header = coadjoint_codegen::c99(tokens(&attribute), tokens(item), &options);
        assert!(header.is_ok_and(|header| header.contains("_step(")), "{attribute}");
    }
}
