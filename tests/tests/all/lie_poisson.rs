//! The family of steps against its definition and its theorems, with 71 digits: for every system, retraction and `s` the step is
//! a Poisson map that keeps all Casimirs, and its adjoint is the step of `1 − s`. With a retraction that is a function of one matrix it is
//! its own adjoint and has order 2; with others that is so for `s = ½` alone, and the order of the rest is 1.

use coadjoint_codegen::expr::{Arena, Symbol, Vector, gradient};
use coadjoint_codegen::group::{Retraction, Semidirect};
use coadjoint_codegen::method::{Increment, Step, family};
use coadjoint_codegen::model::{Energy, Factor, System};
use coadjoint_codegen::scheme;
use coadjoint_support::precise::definition::{ProductMatrices, SemidirectMatrices, realization};
use coadjoint_support::precise::descriptions::{Description, left_invariant, random_point};
use coadjoint_support::precise::formula::{Formula, Point};
use coadjoint_support::precise::matrix::{Column, Matrix, jacobian};
use coadjoint_support::precise::newton::Solver;
use coadjoint_support::precise::real::Real;
use coadjoint_support::precise::residuals::Residuals;

/// For what holds to the last digits.
const EXACT: f64 = 1e-70;

/// The members of the family that are tested.
fn parameters() -> [scheme::Member; 4] {
    [(0, 1), (1, 2), (1, 1), (3, 10)].map(|(n, d)| scheme::Member::new(n, d).expect("between 0 and 1"))
}

/// A system with numbers for its parameters and state.
struct Subject<'a> {
    system: &'a System<'a>,
    matrices: ProductMatrices<'a>,
    point: Point,
    /// The symbols of `m`, which is `(μ, a)` for each factor.
    momentum: Vec<Symbol>,
    /// `∂h/∂m`
    velocity: Vector<'a>,
}

impl<'a> Subject<'a> {
    fn new(system: &'a System<'a>, seed: u64) -> Self {
        let of = |factor: &Factor<'a>| {
            let advected = factor.advected.iter().flat_map(|advected| advected.value.symbols());
            factor.momentum.symbols().into_iter().chain(advected).collect::<Vec<_>>()
        };
        let momentum: Vec<Symbol> = system.factors.iter().flat_map(of).collect();
        Self {
            system,
            matrices: ProductMatrices::new(&system.group),
            point: random_point(system, seed),
            velocity: gradient(system.energy(), &momentum),
            momentum,
        }
    }

    /// The initial momentum.
    fn start(&self) -> Column {
        self.point.get(&self.momentum)
    }

    /// `∂h/∂m` at a momentum.
    fn velocity(&self, m: &Column) -> Column {
        self.point.with(&self.momentum, m).vector(&self.velocity)
    }

    /// `ad*_{∂h/∂m} m`, the equations of motion.
    fn field(&self, m: &Column) -> Column {
        self.matrices.infinitesimal_coadjoint(&self.velocity(m), m)
    }

    /// The flow over a time, by many steps of Runge and Kutta's method and one extrapolation.
    fn flow(&self, time: &Real) -> Column {
        let runge_kutta = |steps: i64| {
            let h = time / Real::from(steps);
            let along = |m: &Column, k: &Column, part: Real| m + &k.scale(&(&h * part));
            (0..steps).fold(self.start(), |m, _| {
                let k1 = self.field(&m);
                let k2 = self.field(&along(&m, &k1, Real::ratio(1, 2)));
                let k3 = self.field(&along(&m, &k2, Real::ratio(1, 2)));
                let k4 = self.field(&along(&m, &k3, Real::from(1)));
                let sum = &(&k1 + &k4) + &(&k2 + &k3).scale(&Real::from(2));
                along(&m, &sum, Real::ratio(1, 6))
            })
        };
        let (coarse, fine) = (runge_kutta(6), runge_kutta(12));
        &fine + &(&fine - &coarse).scale(&Real::ratio(1, 15))
    }
}

/// One member of the family for one system.
struct Member<'s, 'a> {
    subject: &'s Subject<'a>,
    retraction: Retraction,
    member: scheme::Member,
    s: Real,
    step: &'s Step<'a>,
    solver: Solver<'s, 'a>,
}

impl Member<'_, '_> {
    /// The point with step size `t` and momentum `m`.
    fn at(&self, t: &Real, m: &Column) -> Point {
        let mut point = self.subject.point.with(&self.subject.momentum, m);
        point.set(&Vector(vec![self.step.h]).symbols(), &Column(vec![t.clone()]));
        point
    }

    /// The whole state after a step.
    fn next(&self, t: &Real, m: &Column) -> Column {
        self.solver.next(&self.solver.solve(&self.at(t, m)))
    }

    /// What a state has for these symbols.
    fn part(&self, state: &Column, symbols: &[Symbol]) -> Column {
        let mut point = Point::default();
        point.set(&self.subject.system.state_symbols(), state);
        point.get(symbols)
    }

    /// The momentum of a state.
    fn momentum(&self, state: &Column) -> Column {
        self.part(state, &self.subject.momentum)
    }

    /// The momentum after a step.
    fn advance(&self, t: &Real, m: &Column) -> Column {
        self.momentum(&self.next(t, m))
    }
}

/// Checks one system after the other.
fn for_each_system(check: impl Fn(&Description, &Subject<'_>, &mut Residuals)) {
    let mut residuals = Residuals::new();
    for (seed, description) in (31..).zip(left_invariant()) {
        let arena = Arena::new();
        let system = description.system(&arena);
        check(&description, &Subject::new(&system, seed), &mut residuals);
    }
}

/// Checks each member of the family for each system.
fn for_each_member(check: impl Fn(&Member<'_, '_>, &mut Residuals)) {
    for_each_system(|_, subject, residuals| {
        members(subject, |member| check(member, residuals));
    });
}

fn members(subject: &Subject<'_>, mut check: impl FnMut(&Member<'_, '_>)) {
    for retraction in Retraction::ALL {
        for member in parameters() {
            with_member(subject, retraction, member, &mut check);
        }
    }
}

fn with_member<R>(
    subject: &Subject<'_>,
    retraction: Retraction,
    member: scheme::Member,
    check: impl FnOnce(&Member<'_, '_>) -> R,
) -> R {
    let arena = subject.system.time.arena();
    let step = family::step(arena, subject.system, retraction, member);
    let s = subject.point.scalar(arena.number(member.s()));
    check(&Member { subject, retraction, member, s, solver: Solver::new(&step), step: &step })
}

impl Member<'_, '_> {
    /// Whether the step is its own adjoint, and of order 2.
    fn is_symmetric(&self) -> bool {
        self.retraction.is_odd() && self.retraction.is_equivariant()
            || self.member == scheme::Member::MIDPOINT
    }
}

fn tenth() -> Real {
    Real::ratio(1, 10)
}

#[test]
fn energy_and_velocity_are_those_of_the_inertia() {
    for_each_system(|_, subject, residuals| {
        let system = subject.system;
        let Energy::Mechanical { inertia, potential } = &system.energy else {
            panic!("these have an inertia")
        };
        let n = inertia.rows;
        let value = |i: usize, j: usize| subject.point.scalar(inertia.at(i, j));
        let inertia = Matrix::from_fn(n, n, value);
        assert_eq!(inertia, inertia.transpose());
        let m = subject.point.get(&system.momentum().symbols());
        let velocity = inertia.solve(&m);
        let by_system = subject.point.vector(&system.velocity());
        residuals.agree("velocity = 𝕀⁻¹ μ", &by_system, &velocity, EXACT);
        let derivative = subject.point.vector(&gradient(system.energy(), &system.momentum().symbols()));
        residuals.agree("∂h/∂μ = 𝕀⁻¹ μ", &derivative, &velocity, EXACT);
        let kinetic = subject.point.scalar(system.energy() - *potential);
        residuals.vanish("h − V = ½ μ·𝕀⁻¹μ", &(kinetic - m.dot(&velocity) / Real::from(2)), EXACT);
    });
}

/// The definition, with η the solution of the step's equation and everything else from matrices:
///
/// ```text
/// m⁻ = Ad*_{τ(−sη)⁻¹} m
/// m̄  = (1−s) (dR τ_{(1−s)η})* m⁻ + s (dR τ_{−sη})* m⁻
/// η  = t ∂h/∂m(m̄)
/// m' = Ad*_{τ((1−s)η)} m⁻,   g' = g τ(−sη)⁻¹ τ((1−s)η)
/// ```
#[test]
fn steps_solve_their_definition() {
    for_each_member(|member, residuals| {
        let Member { subject, retraction, s, .. } = member;
        let matrices = &subject.matrices;
        let (t, m) = (tenth(), subject.start());
        let solved = member.solver.solve(&member.at(&t, &m));
        let next = member.solver.next(&solved);

        let late = Real::from(1) - s;
        let carried = |eta: &Column| matrices.coadjoint_back(*retraction, &eta.scale(&-s), &m);
        let mean = |eta: &Column| {
            let carried = carried(eta);
            let dual = |x: &Column| matrices.d_right_dual(*retraction, x, &carried);
            &dual(&eta.scale(&late)).scale(&late) + &dual(&eta.scale(&-s)).scale(s)
        };
        // the group's part of η is what the configuration moves by; the advected part of m̄ depends on it alone, and gives that of η
        let whole = moved_by(&solved, &member.step.increments);
        let places = subject.system.group.places().into_iter();
        let y: Vec<Column> =
            places.map(|place| whole.part(place.algebra.start, place.algebra.len())).collect();
        let eta_with = |advected: &Column| {
            let parts = matrices.split_all(advected).into_iter().zip(&y);
            let parts =
                parts.flat_map(|(parts, y)| std::iter::once(y.clone()).chain(parts.into_iter().skip(1)));
            Column::stack(parts.collect::<Vec<_>>().iter())
        };
        let without = eta_with(&Column::zeros(m.len()));
        let eta = eta_with(&subject.velocity(&mean(&without)).scale(&t));

        let velocity = subject.velocity(&mean(&eta)).scale(&t);
        residuals.agree("η = t ∂h/∂m(m̄)", &velocity, &eta, 1e-48);
        let moved = matrices.coadjoint(*retraction, &eta.scale(&late), &carried(&eta));
        residuals.agree("m' = Ad*_{τ((1−s)η)} m⁻", &member.momentum(&next), &moved, EXACT);

        let factors = subject.system.factors.iter().zip(&subject.system.group.factors);
        for ((factor, algebra), y) in factors.zip(&y) {
            let alone = Semidirect { group: algebra.group, spaces: Vec::new() };
            let (matrices, realization) = (SemidirectMatrices::new(&alone), realization(alone.group));
            let configuration = factor.configuration.symbols();
            let g = realization.matrix(&subject.point.get(&configuration));
            let increment = |part: &Real| matrices.retract(*retraction, &y.scale(part));
            let g_next = realization.matrix(&member.part(&next, &configuration));
            let increment = increment(&-s).inverse().times(&increment(&late)).entries();
            let n = g.rows();
            let moved = &g * &Matrix::from_fn(n, n, |i, j| increment[i * n + j].clone());
            residuals.agree("g' = g τ(−sη)⁻¹ τ((1−s)η)", &g_next.entries(), &moved.entries(), EXACT);
        }
    });
}

/// The sum of what the configuration is moved by.
fn moved_by(solved: &Point, increments: &[Increment<'_>]) -> Column {
    let by = increments.iter().map(|increment| solved.vector(&increment.by));
    by.reduce(|sum, by| &sum + &by).expect("a configuration moves")
}

#[test]
fn steps_keep_all_casimirs() {
    for_each_member(|member, residuals| {
        let casimirs = &member.subject.system.casimirs().found;
        let casimirs = Vector(casimirs.iter().map(|&(_, casimir)| casimir).collect());
        let at = |m: &Column| member.at(&tenth(), m).vector(&casimirs);
        let start = member.subject.start();
        let next = member.advance(&tenth(), &start);
        residuals.agree("Casimirs", &at(&next), &at(&start), EXACT);
    });
}

#[test]
fn steps_without_a_potential_keep_the_momentum_in_space() {
    for_each_member(|member, residuals| {
        let (m, arena) = (member.subject.start(), Arena::new());
        let next = member.next(&tenth(), &m);
        let Subject { system, point, .. } = member.subject;
        let factors = system.factors.iter().zip(&system.group.factors);
        for (factor, algebra) in factors.filter(|(factor, _)| factor.advected.is_empty()) {
            let (group, configuration) = (algebra.group, factor.configuration.symbols());
            let dimensions = [configuration.len(), group.dimension()];
            let to_space = Formula::new(&arena, dimensions, |[g, m]| group.to_space(&g, &m));
            let momentum = factor.momentum.symbols();
            let before = to_space.at([&point.get(&configuration), &point.get(&momentum)]);
            let after = to_space.at([&member.part(&next, &configuration), &member.part(&next, &momentum)]);
            residuals.agree("momentum in space", &after, &before, EXACT);
        }
    });
}

#[test]
fn steps_are_poisson_maps() {
    for_each_member(|member, residuals| {
        let (t, m) = (tenth(), member.subject.start());
        let solved = member.solver.solve(&member.at(&t, &m));
        let unknown = solved.get(&member.step.unknown.symbols());
        let next = |m: &Column| {
            let nearby = member.solver.solve_from(&member.at(&t, m), &unknown);
            member.momentum(&member.solver.next(&nearby))
        };
        let derivative = jacobian(&m, next);
        let before = member.subject.matrices.poisson_tensor(&m);
        let after = member.subject.matrices.poisson_tensor(&next(&m));
        let carried = &(&derivative * &before) * &derivative.transpose();
        residuals.agree("D P(m) Dᵀ = P(m')", &carried.entries(), &after.entries(), 5e-47);
    });
}

#[test]
fn the_adjoint_of_a_step_is_that_of_the_other_end() {
    for_each_member(|member, residuals| {
        let Member { subject, retraction, member: scheme::Member { numerator, denominator }, .. } = *member;
        let start = subject.start();
        let next = member.advance(&tenth(), &start);
        let other = scheme::Member::new(denominator - numerator, denominator).expect("between 0 and 1");
        let back = with_member(subject, retraction, other, |other| other.advance(&-tenth(), &next));
        residuals.agree("a step back with 1 − s after a step with s", &back, &start, EXACT);

        // what is not symmetric has no even order: see below
        if member.is_symmetric() {
            let back = member.advance(&-tenth(), &next);
            residuals.agree("a step back after a step", &back, &start, EXACT);
        }
    });
}

#[test]
fn steps_have_the_order_that_their_symmetry_makes() {
    for_each_system(|description, subject, residuals| {
        let (long, short) = (Real::ratio(1, 50), Real::ratio(1, 100));
        let (after_long, after_short) = (subject.flow(&long), subject.flow(&short));
        let start = subject.start();
        members(subject, |member| {
            let error = |t: &Real, flow: &Column| (&member.advance(t, &start) - flow).norm().to_f64();
            let (long, short) = (error(&long, &after_long), error(&short, &after_short));
            let order = (long / short).log2() - 1.0;
            assert!(short > 1e-10, "{}: the reference is finer than {short:e}", description.name);
            // where the first terms of the error nearly cancel, those behind them show
            let expected = if member.is_symmetric() { 2.0 } else { 1.0 };
            residuals.vanish("order − 1 or 2", &Real::from(order - expected), 0.1);
        });
    });
}
