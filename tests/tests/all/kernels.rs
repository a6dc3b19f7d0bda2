//! Straight-line code against the expressions it was made from: factoring, sharing, staging and naming change no value.

use coadjoint_codegen::derive::geometry;
use coadjoint_codegen::expr::{Arena, Expr, Stage, Symbol, Vector};
use coadjoint_codegen::group::{Retraction, Side};
use coadjoint_codegen::kernel::{self, Inputs};
use coadjoint_codegen::method::linearization::{Linearization, Matrices};
use coadjoint_codegen::method::{Step, family, step_symbol};
use coadjoint_codegen::model::{Energy, Relation, System};
use coadjoint_codegen::program::{DerivativeRole, Input, Module, StepRole, SystemRole};
use coadjoint_codegen::scheme::Derivatives;
use coadjoint_codegen::scheme::Member;
use coadjoint_support::interpret::Given;
use coadjoint_support::precise::descriptions::{all_kinds, random_point, rigid_bodies};
use coadjoint_support::precise::formula::Point;
use coadjoint_support::precise::interpreter::{Stages, call, linear_maps, stages};
use coadjoint_support::precise::matrix::{Column, jacobian};
use coadjoint_support::precise::real::Real;
use coadjoint_support::precise::trees::{Forest, for_all, forests, numbers, relative};
use coadjoint_support::random::Random;
use proptest::prelude::*;

/// Names that generated code also has uses for.
const NAMES: [&str; 6] = ["energy_1", "c2", "half_energy_1", "step", "energy_2_1", "energy_1_1"];

#[test]
fn functions_compute_their_expressions() {
    let strategy = (forests(NAMES.len(), 3, 4), numbers(NAMES.len()));
    for_all("functions", 300, strategy, 5e-70, |(forest, x)| {
        let plain = forest.values(x)?;
        let arena = Arena::new();
        let variables: Vec<Expr<'_>> = NAMES
            .iter()
            .enumerate()
            .map(|(i, &name)| arena.symbol(name, [Stage::Parameters, Stage::Step, Stage::Iteration][i % 3]))
            .collect();
        let outputs = Vector(forest.build(&variables));
        Some(relative(&computed(&arena, &outputs, &Vector(variables), x), &plain))
    });
}

/// What a function of these variables computes.
fn computed<'a>(arena: &'a Arena, outputs: &Vector<'a>, variables: &Vector<'a>, x: &Column) -> Column {
    let inputs = Inputs::default().with(Input::State, variables.symbols());
    let module = kernel::function(arena, SystemRole::Energy, outputs, inputs);
    call(&module, SystemRole::Energy, &Given::default().with(Input::State, x.0.clone())).remove(0)
}

#[test]
fn a_value_that_occurs_twice_in_a_sum_counts_twice() {
    let arena = Arena::new();
    let [a, b, c, d] = ["a", "b", "c", "d"].map(|name| arena.symbol(name, Stage::Step));
    let variables = Vector(vec![a, b, c, d]);
    // kept whole, `a b` is a term of its own beside `a b`; for the code both are one value
    let outputs = Vector(vec![
        a * b + (a * b).hold() + c,
        a * b + c + d,
        (a - b).hold() - (b - a).hold() + c,
        (a - b).hold() + (b - a).hold() + d + c,
        (a - b).hold() + c - d,
    ]);
    let values = Column::random(4, &mut Random::new(5));
    let mut point = Point::default();
    point.set(&variables.symbols(), &values);
    let difference = relative(&computed(&arena, &outputs, &variables, &values), &point.vector(&outputs));
    assert!(difference < Real::ten_to(-69), "{difference:?}");
}

/// A step of random expressions in two parameters and the step size, two coordinates of the state, and the unknowns. The second
/// coordinate of the state is given as controls are: at the beginning of a step only.
#[derive(Clone, Debug)]
struct RandomStep {
    unknowns: usize,
    /// Of parameters and state: as many as there are unknowns.
    start: Forest,
    /// Of everything: left, right and two more for the next state.
    equations: Forest,
    /// Of everything: one.
    domain: Forest,
}

/// Parameters, with the step size, and coordinates of the state.
const PARAMETERS: usize = 3;
const STATE: usize = 2;

fn random_steps() -> BoxedStrategy<(RandomStep, Column)> {
    let step = |unknowns: usize| {
        let all = PARAMETERS + STATE + unknowns;
        let start = forests(PARAMETERS + STATE, 1, unknowns);
        let equations = forests(all, 2, 2 * unknowns + STATE);
        let domain = forests(all, 1, 1);
        (start, equations, domain, numbers(all)).prop_map(move |(start, equations, domain, x)| {
            (RandomStep { unknowns, start, equations, domain }, x)
        })
    };
    prop_oneof![step(1), step(2), step(3)].boxed()
}

/// A step together with the symbols that it is made of.
struct Symbolic<'a> {
    step: Step<'a>,
    parameters: Vec<Symbol>,
    state: Vec<Symbol>,
}

impl RandomStep {
    fn build<'a>(&self, arena: &'a Arena) -> Symbolic<'a> {
        let symbols = |names: &[&str], stage| -> Vec<Expr<'a>> {
            names.iter().map(|&name| arena.symbol(name, stage)).collect()
        };
        let parameters = symbols(&["correction_1", "half_h"], Stage::Parameters);
        let h = step_symbol(arena);
        let state = symbols(&["c2", "residual_1_1"], Stage::Step);
        let unknown = symbols(&["right_1", "jacobian_11", "step"][..self.unknowns], Stage::Iteration);

        let early = [parameters.clone(), vec![h]].concat();
        let start = self.start.build(&[early.clone(), state.clone()].concat());
        let equations = self.equations.build(&[early.clone(), state.clone(), unknown.clone()].concat());
        let (left, rest) = equations.split_at(self.unknowns);
        let (right, next) = rest.split_at(self.unknowns);
        let domain = self.domain.build(&[early.clone(), state.clone(), unknown.clone()].concat());
        // a plain linear part makes most Jacobians regular
        let left: Vec<_> = left.iter().zip(&unknown).map(|(&left, &x)| left + x * 4).collect();
        let step = Step {
            h,
            unknown: Vector(unknown.clone()),
            blocks: vec![self.unknowns],
            start: Vector(start),
            iteration: coadjoint_codegen::method::Iteration::FixedPoint,
            matrix: (&Vector(left.clone()) - &Vector(right.to_vec()))
                .jacobian(&Vector(unknown.clone()).symbols()),
            left: Vector(left),
            right: Vector(right.to_vec()),
            given: Vector(state[STATE - 1..].to_vec()).symbols(),
            domain,
            increments: Vec::new(),
            bounded: Vec::new(),
            slow: Vector(Vec::new()),
            next: Vector(next.to_vec()),
        };
        Symbolic { step, parameters: Vector(parameters).symbols(), state: Vector(state).symbols() }
    }
}

/// What functions are given of a step: parameters, the state that the caller keeps, and what is given at the beginning alone.
fn inputs(symbolic: &Symbolic<'_>) -> [(Input, Vec<Symbol>); 3] {
    let Symbolic { step, parameters, state } = symbolic;
    let state = state.iter().copied().filter(|symbol| !step.given.contains(symbol)).collect();
    [(Input::Parameters, parameters.clone()), (Input::State, state), (Input::Control, step.given.clone())]
}

fn module<'a>(arena: &'a Arena, symbolic: &Symbolic<'a>) -> Module<StepRole> {
    let inputs = inputs(symbolic).into_iter();
    let inputs = inputs.fold(Inputs::default(), |all, (input, symbols)| all.with(input, symbols));
    kernel::step(arena, &symbolic.step, inputs)
}

/// Runs a step's functions at a point, stage after stage.
fn run(module: &Module<StepRole>, symbolic: &Symbolic<'_>, point: &Point) -> Stages {
    let given = Given::default()
        .with(Input::StepSize, [point.scalar(symbolic.step.h)])
        .with(Input::Unknown, point.vector(&symbolic.step.unknown).0);
    let inputs = inputs(symbolic).into_iter();
    let given = inputs.fold(given, |all, (input, symbols)| all.with(input, point.get(&symbols).0));
    stages(module, &given)
}

/// How far a kernel's results are from the step's expressions at a point, and its correction from solving the linearized equation
/// (`None` where that is close to singular).
fn deviation(stages: &Stages, step: &Step<'_>, point: &Point) -> (Real, Option<Real>) {
    let residual = |point: &Point| &point.vector(&step.left) - &point.vector(&step.right);
    let mut computed = vec![&stages.start, &stages.residual, &stages.right, &stages.next];
    let mut direct =
        vec![point.vector(&step.start), residual(point), point.vector(&step.right), point.vector(&step.next)];
    computed.push(&stages.margins);
    direct.push(point.vector(&Vector(step.domain.clone())));
    let values = relative(&Column::stack(computed), &Column::stack(&direct));

    let unknown = step.unknown.symbols();
    let x = point.get(&unknown);
    let linear = jacobian(&x, |x| residual(&point.with(&unknown, x)));
    let regular = linear.determinant_magnitude() > Real::ratio(1, 100) && linear.norm() < Real::from(1000);
    let correction = regular.then(|| relative(&(&linear * &stages.correction), &residual(point)));
    (values, correction)
}

/// How far the left side at the update of the fixed-point iteration is from `D right − (D − 1) left`; `None` where there is no update. `D` is one,
/// or, of an equation without denominators, what `dR cay_x = (…)/D` is divided by on SO(3): `1 + |x|²`, as the unknown is the half of `η`.
fn deviation_of_update(
    stages: &Stages,
    step: &Step<'_>,
    point: &Point,
    has_denominators: bool,
) -> Option<Real> {
    let update = stages.update.as_ref()?;
    let unknown = step.unknown.symbols();
    let x = point.get(&unknown);
    let more = if has_denominators { x.dot(&x) } else { Real::from(0) };
    let left = point.with(&unknown, update).vector(&step.left);
    let residual = &point.vector(&step.left) - &stages.right;
    Some(relative(&left, &(&stages.right - &residual.scale(&more))))
}

fn larger(a: Real, b: Real) -> Real {
    if b > a { b } else { a }
}

#[test]
fn kernels_of_random_steps_compute_their_expressions() {
    for_all("random kernels", 150, random_steps(), 5e-70, |(random, x)| {
        deviation_of_random(random, x).map(|(values, _)| values)
    });
}

#[test]
fn corrections_of_random_steps_solve_the_linearized_equation() {
    for_all("random corrections", 150, random_steps(), 5e-45, |(random, x)| {
        deviation_of_random(random, x)?.1
    });
}

fn deviation_of_random(random: &RandomStep, x: &Column) -> Option<(Real, Option<Real>)> {
    random.start.values(&x.part(0, PARAMETERS + STATE))?;
    random.equations.values(x)?;
    random.domain.values(x)?;

    let arena = Arena::new();
    let symbolic = random.build(&arena);
    let module = module(&arena, &symbolic);
    let Symbolic { step, parameters, state } = &symbolic;
    let symbols = [parameters.clone(), Vector(vec![step.h]).symbols(), state.clone(), step.unknown.symbols()];
    let mut point = Point::default();
    point.set(&symbols.concat(), x);
    Some(deviation(&run(&module, &symbolic, &point), step, &point))
}

#[test]
fn kernels_of_rigid_bodies_compute_their_steps() {
    let mut worst = (Real::from(0), Real::from(0));
    let (mut updates, mut cleared_updates) = (0, 0);
    for (seed, description) in (0..).zip(rigid_bodies()) {
        for (retraction, s) in
            Retraction::ALL.into_iter().flat_map(|r| [(r, Member::SYMPLECTIC_EULER_A), (r, Member::MIDPOINT)])
        {
            let what = format!("{}, {}, s = {}", description.name, retraction.name(), s.s());
            let arena = Arena::new();
            let system = description.system(&arena);
            let step = family::step(&arena, &system, retraction, s);
            let mut point = random_point(&system, seed);
            point.set(&Vector(vec![step.h]).symbols(), &Column(vec![Real::ratio(1, 10)]));
            let unknown = step.unknown.symbols();
            point.set(&unknown, &Column::random(unknown.len(), &mut Random::new(seed)));

            let symbolic =
                Symbolic { step, parameters: system.parameter_symbols(), state: system.state_symbols() };
            let stages = run(&module(&arena, &symbolic), &symbolic, &point);
            let (values, correction) = deviation(&stages, &symbolic.step, &point);
            let correction = correction.expect("the Jacobian of a short step is regular");
            let [whole, cleared] = [false, true].map(|has_denominators| {
                let update = deviation_of_update(&stages, &symbolic.step, &point, has_denominators);
                update.expect("an inertia is linear and constant")
            });
            updates += 1;
            if !(whole < Real::ten_to(-70)) {
                assert!(cleared < Real::ten_to(-69), "{what}: {whole:?} {cleared:?}");
                assert!(retraction == Retraction::Cayley, "{what}");
                cleared_updates += 1;
            }
            assert!(values < Real::ten_to(-70), "{what}: {values:?}");
            assert!(correction < Real::ten_to(-46), "{what}: {correction:?}");
            worst = (larger(worst.0, values), larger(worst.1, correction));
        }
    }
    assert_eq!(updates, 2 * Retraction::ALL.len() * rigid_bodies().len());
    // the step of three bodies on SO(3) at s = 0
    assert_eq!(cleared_updates, 3);
    println!("kernels of rigid bodies: values {:?}, corrections {:?}", worst.0, worst.1);
}

/// What functions are given of a system: all of its arrays at a point.
fn given(system: &System<'_>, point: &Point) -> Given<Real> {
    Given::default()
        .with(Input::Parameters, point.get(&system.parameter_symbols()).0)
        .with(Input::State, point.get(&system.state_symbols()).0)
        .with(Input::Time, point.get(&system.time_symbol()).0)
        .with(Input::Control, point.get(&system.control_symbols()).0)
}

/// Every function of a system's program, by the interpreter, against the expressions it was made from.
#[test]
fn functions_of_systems_compute_their_expressions() {
    for (seed, description) in (71..).zip(all_kinds()) {
        let (program, arena) = (description.program(), Arena::new());
        let system = description.system(&arena);
        let by = geometry::tangent_symbols(&arena, &system, "by");
        let symbol = |i: usize| arena.symbol(format!("conserved_{i}"), Stage::Step);
        let conserved = Vector((0..system.dimension()).map(symbol).collect());
        let mut point = random_point(&system, seed);
        if let Energy::Hamiltonian(_) = &system.energy {
            // a mass, of which a root is taken
            let parameters = point.get(&system.parameter_symbols());
            let positive = parameters.0.iter().map(Real::abs).collect();
            point.set(&system.parameter_symbols(), &Column(positive));
        }
        let random = &mut Random::new(seed);
        point.set(&by.symbols(), &Column::random(by.len(), random));
        point.set(&conserved.symbols(), &Column::random(conserved.len(), random));
        let velocity = system.velocity_symbols();
        point.set(&velocity.symbols(), &Column::random(velocity.len(), random));
        let given = given(&system, &point)
            .with(Input::Tangent, point.vector(&by).0)
            .with(Input::Conserved, point.vector(&conserved).0)
            .with(Input::Velocity, point.vector(&velocity).0);

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
            let difference = relative(&call(&module, role, &given)[0], &point.vector(&value));
            assert!(difference < Real::ten_to(-69), "{}, {role:?}: {difference:?}", description.name);
        }
        let newton = |residual: &Vector<'_>, role: SystemRole| {
            let (module, _) = program.function(role).expect("where there is no closed form");
            let computed = call(module, role, &given).remove(0);
            let difference = relative(&computed.part(0, residual.len()), &point.vector(residual));
            assert!(difference < Real::ten_to(-69), "{}, {role:?}: {difference:?}", description.name);
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
            let computed = call(module, *role, &given);
            assert_eq!(computed.len(), 1);
            let difference = relative(&computed[0], &point.vector(expressions));
            assert!(difference < Real::ten_to(-69), "{}, {role:?}: {difference:?}", description.name);
        }
        // the constant momentum, which goes back to the same state; of a left-invariant system that in space
        if let Some((module, _)) = program.function(SystemRole::WithConserved) {
            let of =
                |role| call(program.function(role).expect("there with the other").0, role, &given).remove(0);
            let conserved = of(SystemRole::Conserved);
            assert_eq!(conserved == of(SystemRole::SpatialMomentum), system.side == Side::Left);
            let given = given.clone().with(Input::Conserved, conserved.0);
            let back = call(module, SystemRole::WithConserved, &given).remove(0);
            let difference = relative(&back, &point.get(&system.state_symbols()));
            assert!(difference < Real::ten_to(-69), "{}: {difference:?}", description.name);
        }
        let newtons = [SystemRole::VelocityNewton, SystemRole::MomentumNewton].into_iter();
        let newtons = newtons.filter(|&role| program.function(role).is_some()).count();
        let displacements = Retraction::ALL.map(SystemRole::Displacement).into_iter();
        let displacements = displacements.filter(|&role| program.function(role).is_some()).count();
        let all = 1 + expected.len() + newtons + displacements;
        assert_eq!(program.functions.iter().map(|module| module.functions.len()).sum::<usize>(), all);
    }
}

/// The linear maps of every derivative, by the interpreter, against the linearization that they were made from.
#[test]
fn derivatives_compute_their_linearization() {
    let kinds = |retraction| (91..).zip(all_kinds()).map(move |kind| (retraction, kind));
    for (retraction, (seed, description)) in Retraction::ALL.into_iter().flat_map(kinds) {
        let arena = Arena::new();
        let system = description.system(&arena);
        let step = family::step(&arena, &system, retraction, Member::MIDPOINT);
        let linearization = Linearization::new(&arena, &system, &step, Derivatives::ALL);
        let inputs = Inputs::of(&system);
        let module = kernel::derivative(&arena, &step, &linearization, Derivatives::ALL, inputs);
        let adjoint = linearization.adjoint(&arena);
        let changes = [&linearization.state, &linearization.control, &linearization.parameters];

        let mut point = random_point(&system, seed);
        let random = &mut Random::new(seed);
        point.set(&Vector(vec![step.h]).symbols(), &Column(vec![Real::ratio(1, 10)]));
        for symbols in [&step.unknown, &adjoint.next].into_iter().chain(changes) {
            point.set(&symbols.symbols(), &Column::random(symbols.len(), random));
        }
        let given = given(&system, &point)
            .with(Input::StepSize, [point.scalar(step.h)])
            .with(Input::Unknown, point.vector(&step.unknown).0)
            .with(Input::StatePerturbation, point.vector(changes[0]).0)
            .with(Input::ControlPerturbation, point.vector(changes[1]).0)
            .with(Input::ParameterPerturbation, point.vector(changes[2]).0)
            .with(Input::Costate, point.vector(&adjoint.next).0);

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
        let computed = linear_maps(&module, &given);
        assert_eq!(computed.len(), expected.len());
        for (role, vectors) in expected {
            let direct: Vec<Column> = vectors.iter().map(|vector| point.vector(vector)).collect();
            let stacked = |all: &[Column]| Column::stack(all.iter().collect::<Vec<_>>());
            let (computed, direct) = (stacked(&computed[&role]), stacked(&direct));
            let difference = relative(&computed, &direct);
            let what = format!("{}, {}, {role:?}", description.name, retraction.name());
            assert!(difference < Real::ten_to(-69), "{what}: {difference:?}");
        }
    }
}
