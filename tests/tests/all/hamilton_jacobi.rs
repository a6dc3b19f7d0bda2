//! Hamilton–Jacobi steps, with 71 digits: for every kind of system the order is what it is called by, the step is its own adjoint, and
//! where nothing forces a left-invariant system it is a Poisson map.

use coadjoint_codegen::expr::Arena;
use coadjoint_codegen::group::Retraction;
use coadjoint_codegen::method::{Step, family, hamilton_jacobi};
use coadjoint_codegen::model::System;
use coadjoint_codegen::scheme::Member;
use coadjoint_support::precise::definition::ProductMatrices;
use coadjoint_support::precise::descriptions::{Description, all_kinds, random_point};
use coadjoint_support::precise::formula::Point;
use coadjoint_support::precise::matrix::{Column, jacobian};
use coadjoint_support::precise::newton::Solver;
use coadjoint_support::precise::real::Real;
use coadjoint_support::precise::residuals::Residuals;

/// A step of a system with numbers for its parameters and controls.
struct Subject<'s, 'a> {
    system: &'s System<'a>,
    point: Point,
    step: &'s Step<'a>,
    solver: Solver<'s, 'a>,
}

impl<'s, 'a> Subject<'s, 'a> {
    fn new(system: &'s System<'a>, point: &Point, step: &'s Step<'a>) -> Self {
        Self { system, point: point.clone(), step, solver: Solver::new(step) }
    }

    fn start(&self) -> Column {
        self.point.get(&self.system.state_symbols())
    }

    /// The state after a step from a state and the time after the start.
    fn next(&self, state: &Column, after: &Real, t: &Real) -> Column {
        let mut point = self.point.with(&self.system.state_symbols(), state);
        let symbols = self.system.time_symbol();
        let time = point.get(&symbols).0.iter().map(|time| time + after).collect();
        point.set(&symbols, &Column(time));
        point.set(&[self.step.h.as_symbol().expect("a symbol")], &Column(vec![t.clone()]));
        self.solver.next(&self.solver.solve(&point))
    }

    /// After so many steps in this time.
    fn many(&self, time: &Real, steps: i64) -> Column {
        let t = time / Real::from(steps);
        (0..steps).fold(self.start(), |state, k| self.next(&state, &(&t * Real::from(k)), &t))
    }

    /// The motion over a time, by extrapolation of a symmetric step of order 2: what is left is of order `2 m`.
    fn extrapolated(&self, time: &Real, m: i64) -> Column {
        let mut row: Vec<Column> = Vec::new();
        for k in 1..=m {
            let mut next = self.many(time, k);
            let mut better = vec![next.clone()];
            for (coarse, j) in row.iter().zip(1..k) {
                let ratio = Real::ratio(k, k - j);
                let factor = Real::from(1) / (&ratio * &ratio - Real::from(1));
                next = &next + &(&next - coarse).scale(&factor);
                better.push(next.clone());
            }
            row = better;
        }
        row.pop().expect("one at least")
    }
}

/// The orders to look at: high ones where there is little to derive.
fn orders(description: &Description, system: &System<'_>, retraction: Retraction) -> &'static [u32] {
    match (description.name, system.dimension()) {
        ("free body", _) => &[4, 6, 8, 10],
        (_, 1..=3) if retraction == Retraction::Exponential => &[4, 6],
        _ => &[4],
    }
}

fn for_each_step(check: impl Fn(&Description, &Subject<'_, '_>, &Subject<'_, '_>, u32, &mut Residuals)) {
    let mut residuals = Residuals::new();
    for (seed, description) in (71..).zip(all_kinds()) {
        let arena = Arena::new();
        let system = description.system(&arena);
        if !hamilton_jacobi::is_for(&system) {
            continue;
        }
        let mut point = random_point(&system, seed);
        if system.inertias.is_empty() {
            // so that energies are those of something
            let parameters = system.parameter_symbols();
            let positive = point.get(&parameters).0.iter().map(|x| x * x + Real::from(1)).collect();
            point.set(&parameters, &Column(positive));
        }
        for retraction in [Retraction::Exponential, Retraction::Cayley] {
            if !system.group.has(retraction) || system.group.is_summed(retraction) {
                continue;
            }
            let midpoint = family::step(&arena, &system, retraction, Member::MIDPOINT);
            let reference = Subject::new(&system, &point, &midpoint);
            for &order in orders(&description, &system, retraction) {
                let step = hamilton_jacobi::step(&arena, &system, retraction, order);
                let subject = Subject::new(&system, &point, &step);
                check(&description, &subject, &reference, order, &mut residuals);
            }
        }
    }
}

#[test]
fn steps_have_their_orders_and_are_symmetric() {
    for_each_step(|description, subject, reference, order, residuals| {
        let error = |t: &Real| {
            let exact = reference.extrapolated(t, i64::from(order) / 2 + 1);
            (&subject.next(&subject.start(), &Real::from(0), t) - &exact).norm().to_f64()
        };
        let [long, short] = [Real::ratio(1, 1000), Real::ratio(1, 2000)];
        let measured = (error(&long) / error(&short)).log2() - 1.0;
        println!("{}, order {order}: {measured:.3}", description.name);
        residuals.vanish("the order is as named", &Real::from(measured - f64::from(order)), 0.1);

        let t = Real::ratio(1, 10);
        let next = subject.next(&subject.start(), &Real::from(0), &t);
        let back = subject.next(&next, &t, &-t.clone());
        residuals.agree("a step back after a step", &back, &subject.start(), 1e-65);
    });
}

#[test]
fn steps_are_poisson_maps() {
    for_each_step(|_, subject, _, _, residuals| {
        let system = subject.system;
        if !system.is_left_invariant() || system.side.sign() < 0 || subject.step.unknown.is_empty() {
            return;
        }
        let factors = system.factors.iter();
        let momentum: Vec<_> = factors
            .flat_map(|factor| {
                let advected = factor.advected.iter().flat_map(|advected| advected.value.symbols());
                factor.momentum.symbols().into_iter().chain(advected)
            })
            .collect();
        let at = |m: &Column| {
            let state = subject.point.with(&momentum, m).get(&system.state_symbols());
            let next = subject.next(&state, &Real::from(0), &Real::ratio(1, 10));
            let mut point = Point::default();
            point.set(&system.state_symbols(), &next);
            point.get(&momentum)
        };
        let (m, matrices) = (subject.point.get(&momentum), ProductMatrices::new(&system.group));
        let derivative = jacobian(&m, at);
        let (before, after) = (matrices.poisson_tensor(&m), matrices.poisson_tensor(&at(&m)));
        let carried = &(&derivative * &before) * &derivative.transpose();
        residuals.agree("D P(m) Dᵀ = P(m')", &carried.entries(), &after.entries(), 5e-45);
        let casimirs: Vec<_> = system.casimirs().found.iter().map(|&(_, casimir)| casimir).collect();
        if !casimirs.is_empty() {
            let casimirs = coadjoint_codegen::expr::Vector(casimirs);
            let value = |m: &Column| subject.point.with(&momentum, m).vector(&casimirs);
            residuals.agree("Casimirs", &value(&at(&m)), &value(&m), 1e-68);
        }
    });
}
