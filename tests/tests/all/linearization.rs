//! The derivative of a step in closed form against differences of the step itself, with 71 digits.

use coadjoint_codegen::expr::{Arena, Symbol, Vector};
use coadjoint_codegen::group::{Group, Retraction, Side};
use coadjoint_codegen::method::Step;
use coadjoint_codegen::method::linearization::{Linearization, Matrices};
use coadjoint_codegen::method::{family, tangent_lift};
use coadjoint_codegen::model::{Slot, System};
use coadjoint_codegen::quantity::Kind;
use coadjoint_codegen::scheme::Derivatives;
use coadjoint_codegen::scheme::{Member, Scheme};
use coadjoint_support::precise::descriptions::{all_kinds, random_point};
use coadjoint_support::precise::formula::{Formula, Point};
use coadjoint_support::precise::matrix::{Column, Matrix, derivative};
use coadjoint_support::precise::newton::Solver;
use coadjoint_support::precise::real::Real;
use coadjoint_support::precise::residuals::Residuals;

/// Differences are good to half of the digits.
const DIFFERENCE: f64 = 1e-46;

/// `g exp(x)`, or `exp(x) g`
fn moved(side: Side, group: &dyn Group, g: &Column, x: &Column) -> Column {
    let arena = Arena::new();
    let formula = Formula::new(&arena, [group.coordinates().len(), group.dimension()], |[g, x]| {
        side.compose(group, &g, &group.retract(Retraction::Exponential, &x))
    });
    formula.at([g, x])
}

/// The parts of a state, in the order of storage: symbols, and the group of those that are a configuration.
fn parts<'a>(system: &System<'a>) -> Vec<(Vec<Symbol>, Option<&'static dyn Group>)> {
    let group = |slot| match slot {
        Slot::Configuration(factor) => Some(system.group.factors[factor].group),
        Slot::Momentum(_) | Slot::Advected { .. } => None,
    };
    system.slots().into_iter().map(|slot| (system.part(slot).symbols(), group(slot))).collect()
}

/// The state at a point, changed by something in tangent coordinates.
fn changed(system: &System<'_>, point: &Point, change: &Column) -> Point {
    let mut changed = point.clone();
    let mut from = 0;
    for (symbols, group) in parts(system) {
        let value = point.get(&symbols);
        let length = group.map_or(symbols.len(), Group::dimension);
        let part = change.part(from, length);
        let value = match group {
            Some(group) => moved(system.side, group, &value, &part),
            None => &value + &part,
        };
        changed.set(&symbols, &value);
        from += length;
    }
    changed
}

/// The change of stored coordinates in tangent coordinates: `T δ = change` with the tangent map `T` of the place.
fn trivialized(system: &System<'_>, state: &Column, change: &Column) -> Column {
    let mut all = Vec::new();
    let mut from = 0;
    for (symbols, group) in parts(system) {
        let (place, part) = (state.part(from, symbols.len()), change.part(from, symbols.len()));
        from += symbols.len();
        let Some(group) = group else {
            all.extend(part.0);
            continue;
        };
        let n = group.dimension();
        let zero = Column(vec![Real::from(0); n]);
        let there = |x: &Column| moved(system.side, group, &place, x);
        let tangent = Matrix::of_linear(n, |direction| derivative(&zero, direction, there));
        let dual = tangent.transpose();
        all.extend((&dual * &tangent).solve(&(&dual * &part)).0);
    }
    Column(all)
}

/// The change of the parameters that steps are made of, where those change so that users give: of symmetric matrices these are the symmetric parts.
fn symmetric_parts(system: &System<'_>, change: &Column) -> Column {
    let (mut all, mut from) = (Vec::new(), 0);
    for field in &system.parameters {
        let part = change.part(from, field.symbols.len());
        from += field.symbols.len();
        match field.kind {
            Kind::Symmetric(n) => {
                let mirrored = Column((0..n * n).map(|k| part.0[k % n * n + k / n].clone()).collect());
                all.extend((&part + &mirrored).scale(&Real::ratio(1, 2)).0);
            }
            _ => all.extend(part.0),
        }
    }
    Column(all)
}

/// Members of the family; of tangent lifts, which begin as these do and end otherwise, one of three in turn.
fn schemes(retraction: Retraction, turn: u64) -> Vec<Scheme> {
    let ends = [(0, 1), (1, 2), (1, 1)];
    let member = |(n, d)| Member::new(n, d).expect("between 0 and 1");
    let rules = ends.into_iter().chain([(3, 10)]).map(|s| family::METHOD.member(member(s)));
    let rules = rules.chain([tangent_lift::METHOD.member(member(ends[turn as usize % 3]))]);
    rules.map(|rule| Scheme { retraction, rule }).collect()
}

/// One test for each kind of system, so that they run side by side. Descriptions have the same names, with spaces.
macro_rules! kinds {
    ($($name:ident)*) => {
        $(
            #[test]
            fn $name() {
                derivatives_are_those_of_the_step(&stringify!($name).replace('_', " "));
            }
        )*

        #[test]
        fn no_kind_is_left_out() {
            let names: Vec<String> = all_kinds().iter().map(|kind| kind.name.replace(' ', "_")).collect();
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}

kinds! {
    free_body
    free_body_with_a_full_inertia
    heavy_top
    nonlinear_top_with_a_full_inertia
    nonlinear_top_in_two_fields
    vane
    plate_in_the_plane
    heavy_body_in_a_fluid
    two_tops
    spin_and_top_with_one_inertia
    driven_pendulum_with_a_control
    quadrotor
    coupled_bodies
    body_in_the_plane
    body_in_a_fluid
    spin
    free_body_in_space_coordinates
    general_energy
    top_by_its_lagrangian
    double_pendulum
    body_with_a_moving_mass
    body_seen_from_space_by_its_lagrangian
    stiff_point
}

fn derivatives_are_those_of_the_step(name: &str) {
    let mut kinds = (51..).zip(all_kinds());
    let (seed, description) = kinds.find(|(_, kind)| kind.name == name).expect("it is there");
    let mut residuals = Residuals::new();
    for (retraction, turn) in Retraction::ALL.into_iter().zip(seed..) {
        let arena = Arena::new();
        let system = description.system(&arena);
        for scheme in schemes(retraction, turn) {
            let step = scheme.step(&arena, &system);
            check(&arena, &system, &step, seed, &mut residuals);
        }
    }
}

fn check<'a>(arena: &'a Arena, system: &System<'a>, step: &Step<'a>, seed: u64, residuals: &mut Residuals) {
    let linearization = Linearization::new(arena, system, step, Derivatives::ALL);
    let Linearization { state, control, parameters, next, .. } = &linearization;
    let mut point = random_point(system, seed);
    point.set(&Vector(vec![step.h]).symbols(), &Column(vec![Real::ratio(1, 10)]));
    let solver = Solver::new(step);
    let solved = solver.solve(&point);
    let end = solver.next(&solved);
    let unknown = solved.get(&step.unknown.symbols());
    let after = |point: &Point| solver.next(&solver.solve_from(point, &unknown));

    // the transpose is one: λ·(Dφ δ) = (Dφ* λ)·δ, and knows no δ
    let adjoint = linearization.adjoint(arena);
    let mut along = solved.clone();
    let mut random = coadjoint_support::random::Random::new(seed + 200);
    along.set(&adjoint.next.symbols(), &Column::random(next.len(), &mut random));
    let by = [&adjoint.state, &adjoint.control, &adjoint.parameters].map(|by| along.vector(by));
    let changes = [state, control, parameters];
    for change in changes {
        along.set(&change.symbols(), &Column::random(change.len(), &mut random));
    }
    let forward = along.vector(next).dot(&along.vector(&adjoint.next));
    let backward = by.iter().zip(changes).map(|(by, change)| by.dot(&along.vector(change)));
    let backward = backward.fold(Real::from(0), |sum, part| sum + part);
    residuals.vanish("λ·(Dφ δ) − (Dφ* λ)·δ", &(forward - backward), 1e-69);

    // the matrices are of the same map
    let Matrices { through, columns } = linearization.matrices(arena, Derivatives::ALL);
    let of_changes = changes.into_iter().zip(&columns);
    let all = of_changes.flat_map(|(change, columns)| change.iter().zip(columns.iter().flatten()));
    let (mut product, mut of_unknown) = (Column(vec![Real::from(0); next.len()]), None::<Column>);
    for (change, (explicit, unknown)) in all {
        let by = along.vector(&Vector(vec![change]));
        product = &product + &along.vector(explicit).scale(&by.0[0]);
        let part = along.vector(unknown).scale(&by.0[0]);
        of_unknown = Some(of_unknown.map_or(part.clone(), |sum| &sum + &part));
    }
    let of_unknown = of_unknown.expect("a state has components").0;
    for (column, by) in through.iter().flatten().zip(&of_unknown) {
        product = &product + &along.vector(column).scale(by);
    }
    for (product, closed) in product.0.iter().zip(along.vector(next).0) {
        residuals.vanish("(A + B W) δ − Dφ δ", &(product.clone() - closed), 1e-69);
    }

    // along one random direction of state, control and parameters, in which each entry of the matrices shows
    let symbols = [state, control, parameters].map(Vector::symbols);
    let mut random = coadjoint_support::random::Random::new(seed + 100);
    let directions = symbols.each_ref().map(|symbols| Column::random(symbols.len(), &mut random));
    let mut along = solved.clone();
    for (direction, symbols) in directions.iter().zip(&symbols) {
        along.set(symbols, direction);
    }
    let closed = along.vector(next);

    let [by_state, by_control, by_parameters] = &directions;
    let by_parameters = &symmetric_parts(system, by_parameters);
    let shifted = |by: &Column| {
        let by = &by.0[0];
        let mut shifted = changed(system, &point, &by_state.scale(by));
        for (direction, symbols) in
            [(by_control, system.control_symbols()), (by_parameters, system.field_symbols())]
        {
            shifted.set(&symbols, &(&point.get(&symbols) + &direction.scale(by)));
        }
        after(&shifted)
    };
    let one = Column(vec![Real::from(1)]);
    let difference = derivative(&Column(vec![Real::from(0)]), &one, shifted);
    let definition = trivialized(system, &end, &difference);
    residuals.agree("Dφ δ", &closed, &definition, DIFFERENCE);
}
