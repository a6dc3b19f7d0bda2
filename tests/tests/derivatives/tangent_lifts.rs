//! Tangent lifts against their definition, with 71 digits: the tangent map of the discretization map
//! `D(ḡ, v) = (ḡ τ(−sv), ḡ τ((1−s)v))` along the motion of a point `(ḡ, tη)` whose velocity is `η`. Motion, momenta and velocities are taken
//! from the energy by differences.

use coadjoint_codegen::expr::{Arena, Vector, gradient};
use coadjoint_codegen::group::{Group, Retraction, Side};
use coadjoint_codegen::method::{Step, tangent_lift};
use coadjoint_codegen::model::{Energy, System};
use coadjoint_codegen::scheme::Member;
use coadjoint_support::precise::definition::{self, ProductMatrices, realization};
use coadjoint_support::precise::descriptions::{all_kinds, random_point};
use coadjoint_support::precise::formula::{Formula, Point};
use coadjoint_support::precise::matrix::{Column, Matrix, derivative, jacobian};
use coadjoint_support::precise::newton::Solver;
use coadjoint_support::precise::real::Real;
use coadjoint_support::precise::residuals::Residuals;

/// For what holds to the last digits.
const EXACT: f64 = 1e-69;
/// Differences are good to half of the digits.
const DIFFERENCE: f64 = 5e-47;

/// A system by its energy alone.
struct Mechanics<'s, 'a> {
    system: &'s System<'a>,
    matrices: ProductMatrices<'s>,
    /// What the energy is differentiated in: the Hamiltonian, of a Lagrangian `−l`.
    energy: coadjoint_codegen::expr::Expr<'a>,
    /// `∂h/∂μ`, of a Lagrangian `∂l/∂ξ`.
    fibre: Vector<'a>,
}

/// `f(x) = y` by Newton's iteration on differences.
fn solved(mut x: Column, y: &Column, f: impl Fn(&Column) -> Column) -> Column {
    for _ in 0..30 {
        let residual = &f(&x) - y;
        if residual.norm() < Real::ten_to(-66) {
            return x;
        }
        x = &x - &jacobian(&x, &f).solve(&residual);
    }
    panic!("no solution");
}

impl<'s, 'a> Mechanics<'s, 'a> {
    fn new(system: &'s System<'a>) -> Self {
        let momentum = system.momentum().symbols();
        let (energy, fibre) = match &system.energy {
            Energy::Lagrangian(l) => (-*l, gradient(*l, &system.velocity_symbols().symbols())),
            _ => (system.energy(), gradient(system.energy(), &momentum)),
        };
        let matrices = ProductMatrices::new(&system.group);
        Self { system, matrices, energy, fibre }
    }

    fn is_lagrangian(&self) -> bool {
        matches!(self.system.energy, Energy::Lagrangian(_))
    }

    /// The velocity at a state.
    fn velocity(&self, point: &Point) -> Column {
        let (momenta, velocities) =
            (self.system.momentum().symbols(), self.system.velocity_symbols().symbols());
        if !self.is_lagrangian() {
            return point.vector(&self.fibre);
        }
        let of = |velocity: &Column| point.with(&velocities, velocity).vector(&self.fibre);
        solved(Column::zeros(velocities.len()), &point.get(&momenta), of)
    }

    /// The momentum of a velocity.
    fn momentum(&self, point: &Point, velocity: &Column) -> Column {
        let (momenta, velocities) =
            (self.system.momentum().symbols(), self.system.velocity_symbols().symbols());
        if self.is_lagrangian() {
            return point.with(&velocities, velocity).vector(&self.fibre);
        }
        let of = |momentum: &Column| point.with(&momenta, momentum).vector(&self.fibre);
        solved(point.get(&momenta), velocity, of)
    }

    /// The configuration of a factor moved by an element of the algebra along the exponential, in stored coordinates.
    fn displaced(&self, group: &dyn Group, g: &Column, by: &Column) -> Column {
        moved(group, self.system.side, Retraction::Exponential, g, by)
    }

    /// `μ' = ad*_ξ μ − ∂h/∂g + F` and `a'` at a point that has a velocity and the momentum that belongs to it.
    fn change(&self, point: &Point) -> Vec<Column> {
        let sign = Real::from(self.system.side.sign());
        let (mut xi, mut m, mut kicks) = (Vec::new(), Vec::new(), Vec::new());
        for (factor, algebra) in self.system.factors.iter().zip(&self.system.group.factors) {
            xi.push(point.get(&factor.velocity.symbols()));
            m.push(point.get(&factor.momentum.symbols()));
            for advected in &factor.advected {
                let symbols = advected.value.symbols();
                xi.push(point.vector(&gradient(self.energy, &symbols)));
                m.push(point.get(&symbols));
            }
            let configuration = factor.configuration.symbols();
            let g = point.get(&configuration);
            let energy = |by: &Column| {
                let there = point.with(&configuration, &self.displaced(algebra.group, &g, by));
                Column(vec![there.scalar(self.energy)])
            };
            let n = algebra.group.dimension();
            let by_configuration = jacobian(&Column::zeros(n), energy).transpose().column(0);
            let force = factor.force.as_ref().map_or_else(|| Column::zeros(n), |force| point.vector(force));
            kicks.push(&force - &by_configuration);
        }
        let xi = Column::stack(&xi).scale(&sign);
        let parts = self.matrices.split_all(&self.matrices.infinitesimal_coadjoint(&xi, &Column::stack(&m)));
        let mut change = Vec::new();
        for (part, kick) in parts.into_iter().zip(kicks) {
            change.push(&part[0] + &kick);
            change.extend(part.into_iter().skip(1));
        }
        change
    }

    /// The change of the velocity along the motion.
    fn acceleration(&self, point: &Point) -> Column {
        let change = self.change(point);
        let along = |by: &Column| {
            let by = &by[0];
            let (mut there, mut changes) = (point.clone(), change.iter());
            for (factor, algebra) in self.system.factors.iter().zip(&self.system.group.factors) {
                let velocity = point.get(&factor.velocity.symbols()).scale(by);
                let configuration = factor.configuration.symbols();
                let g = self.displaced(algebra.group, &point.get(&configuration), &velocity);
                there.set(&configuration, &g);
                let values =
                    std::iter::once(&factor.momentum).chain(factor.advected.iter().map(|a| &a.value));
                for (value, change) in values.zip(changes.by_ref()) {
                    there.set(&value.symbols(), &(&point.get(&value.symbols()) + &change.scale(by)));
                }
            }
            let time = self.system.time_symbol();
            there.set(&time, &(&point.get(&time) + &Column(vec![by.clone()])));
            self.velocity(&there)
        };
        derivative(&Column::zeros(1), &Column(vec![Real::from(1)]), along)
    }
}

/// `g τ(x)`, or `τ(x) g`, in stored coordinates.
fn moved(group: &dyn Group, side: Side, retraction: Retraction, g: &Column, x: &Column) -> Column {
    let arena = Arena::new();
    let formula =
        Formula::new(&arena, [g.len(), x.len()], |[g, x]| group.moved(side, retraction, &g, &x).next);
    formula.at([g, x])
}

/// `τ(x)` by its definition.
fn retract(group: &dyn Group, retraction: Retraction, x: &Column) -> Matrix {
    definition::retract(retraction, x, |x| realization(group).hat(x))
}

/// `g x`, or `x g`.
fn product(side: Side, g: &Matrix, x: &Matrix) -> Matrix {
    match side {
        Side::Left => g * x,
        Side::Right => x * g,
    }
}

/// The velocity of `D^1` or `D^2` of a point that moves: `ḡ exp(εη) τ(share t(η + ε ξ'))` at `ε = 0`, and where it is.
fn prolonged(
    group: &dyn Group,
    side: Side,
    retraction: Retraction,
    g: &Matrix,
    [eta, acceleration]: [&Column; 2],
    share: &Real,
) -> (Matrix, Column) {
    let at = |by: &Column| {
        let by = &by[0];
        let start = product(side, g, &retract(group, Retraction::Exponential, &eta.scale(by)));
        let v = (eta + &acceleration.scale(by)).scale(share);
        product(side, &start, &retract(group, retraction, &v))
    };
    let here = at(&Column::zeros(1));
    let inverse = here.inverse();
    let rows = here.rows();
    let velocity = derivative(&Column::zeros(1), &Column(vec![Real::from(1)]), |by| at(by).entries());
    let velocity = Matrix::from_fn(rows, rows, |i, j| velocity[i * rows + j].clone());
    let velocity = match side {
        Side::Left => &inverse * &velocity,
        Side::Right => &velocity * &inverse,
    };
    (here, realization(group).vee(&velocity))
}

fn check(
    mechanics: &Mechanics<'_, '_>,
    retraction: Retraction,
    s: Member,
    step: &Step<'_>,
    seed: u64,
    residuals: &mut Residuals,
) {
    let system = mechanics.system;
    let arena = system.time.arena();
    let (t, share) = (Real::ratio(1, 10), random_point(system, seed).scalar(arena.number(s.s())));
    let mut start = random_point(system, seed);
    start.set(&Vector(vec![step.h]).symbols(), &Column(vec![t.clone()]));
    let solver = Solver::new(step);
    let solution = solver.solve(&start);
    let mut end = start.clone();
    end.set(&system.state_symbols(), &solver.next(&solution));
    let time = system.time_symbol();
    end.set(&time, &(&start.get(&time) + &Column(vec![t.clone()])));

    // the intermediate point, from what the configurations move by
    let by = step.increments.iter().map(|increment| solution.vector(&increment.by));
    let whole = by.reduce(|sum, by| &sum + &by).expect("the configuration moves");
    let split = |column: &Column| {
        let places = system.group.places().into_iter();
        places.map(|place| column.part(place.algebra.start, place.algebra.len())).collect::<Vec<_>>()
    };
    let y = split(&whole);
    let late = (Real::from(1) - &share) * &t;
    let early = &share * &t;
    let mut middle = start.clone();
    middle.set(&time, &(&start.get(&time) + &Column(vec![early.clone()])));
    let factors = || system.factors.iter().zip(&system.group.factors);
    for ((factor, algebra), y) in factors().zip(&y) {
        let configuration = factor.configuration.symbols();
        let by = y.scale(&share);
        let (g, back) = (start.get(&configuration), retraction.reversed());
        let g = moved(algebra.group, system.side, back, &g, &by);
        middle.set(&configuration, &g);
        middle.set(&factor.velocity.symbols(), &y.scale(&(Real::from(1) / &t)));
    }
    let advected = |from: &Point, part: &Real, moving: Retraction| {
        let sign = Real::from(system.side.sign());
        let (mut x, mut m) = (Vec::new(), Vec::new());
        for (factor, y) in system.factors.iter().zip(&y) {
            x.push(y.scale(&(part * &sign)));
            m.push(Column::zeros(y.len()));
            for a in &factor.advected {
                x.push(Column::zeros(a.value.len()));
                m.push(from.get(&a.value.symbols()));
            }
        }
        let carried = mechanics.matrices.coadjoint(
            system.side.carrying(moving),
            &Column::stack(&x),
            &Column::stack(&m),
        );
        let mut to = from.clone();
        for (factor, parts) in system.factors.iter().zip(mechanics.matrices.split_all(&carried)) {
            for (a, value) in factor.advected.iter().zip(&parts[1..]) {
                to.set(&a.value.symbols(), value);
            }
        }
        to
    };
    let middle = advected(&middle, &share, retraction.reversed());
    let eta = middle.get(&system.velocity_symbols().symbols());
    let momentum = mechanics.momentum(&middle, &eta);
    let middle = middle.with(&system.momentum().symbols(), &momentum);
    let acceleration = mechanics.acceleration(&middle);

    let (mut first, mut last) = (Vec::new(), Vec::new());
    for ((factor, algebra), (eta, change)) in factors().zip(split(&eta).iter().zip(&split(&acceleration))) {
        let matrix =
            |point: &Point| realization(algebra.group).matrix(&point.get(&factor.configuration.symbols()));
        let ends = [(-early.clone(), &start, &mut first), (late.clone(), &end, &mut last)];
        for (share, at, velocities) in ends {
            let (g, velocity) =
                prolonged(algebra.group, system.side, retraction, &matrix(&middle), [eta, change], &share);
            residuals.agree("D(ḡ, tη) = (g_k, g_{k+1})", &g.entries(), &matrix(at).entries(), EXACT);
            velocities.push(velocity);
        }
        let carried = advected(&middle, &(Real::from(1) - &share), retraction);
        for a in &factor.advected {
            let symbols = a.value.symbols();
            residuals.agree("a_{k+1}", &carried.get(&symbols), &end.get(&symbols), EXACT);
        }
    }
    for (what, velocities, at) in [("ξ_k", first, &start), ("ξ_{k+1}", last, &end)] {
        residuals.agree(what, &mechanics.velocity(at), &Column::stack(&velocities), DIFFERENCE);
    }
}

#[test]
fn tangent_lifts_are_tangent_maps_of_the_discretization() {
    let mut residuals = Residuals::new();
    for (seed, description) in (51..).zip(all_kinds()) {
        for retraction in Retraction::ALL {
            for (numerator, denominator) in [(0, 1), (1, 4), (1, 2), (3, 4), (1, 1)] {
                let arena = Arena::new();
                let system = description.system(&arena);
                let member = Member::new(numerator, denominator).expect("between 0 and 1");
                let step = tangent_lift::step(&arena, &system, retraction, member);
                check(&Mechanics::new(&system), retraction, member, &step, seed, &mut residuals);
            }
        }
    }
}

/// The order on every group, and that steps stay on the group.
mod orders {
    use coadjoint::composition::Order6;
    use coadjoint::nalgebra::{Isometry2, Isometry3, Translation2, Translation3, UnitComplex, Vector6};
    use coadjoint::prelude::*;
    use coadjoint::{Discretized, State, System, TangentLift, TangentMidpoint};

    #[lie_poisson_system(group = R3, methods(TangentLift, TangentMidpoint, TangentLift(1, 4)), potential = position.norm_squared().powi(2) + position.x)]
    struct Point {
        #[inertia]
        mass: f64,
    }

    #[lie_poisson_system(group = SO2, methods(TangentLift, TangentMidpoint, TangentLift(1, 4)), potential = angle.cos_angle(), force = -0.3 * velocity)]
    struct Pendulum {
        #[inertia]
        inertia: f64,
    }

    #[lie_poisson_system(group = SO3, methods(TangentLift, TangentMidpoint, TangentLift(1, 4)), advected(gamma: R3), potential = gamma.z + gamma.x * gamma.y)]
    struct Top {
        #[inertia]
        inertia: Vector3<f64>,
    }

    #[lie_poisson_system(group = SU2, methods(TangentLift, TangentMidpoint, TangentLift(1, 4)), hamiltonian = momentum.x.powi(2) + momentum.y.powi(2) / 3.0 + momentum.z.powi(2) / 2.0 + momentum.x * spin.w)]
    struct Spin {}

    #[lie_poisson_system(group = SE2, methods(TangentLift, TangentMidpoint, TangentLift(1, 4)), lagrangian = velocity.norm_squared() + velocity.x * velocity.y * pose.rotation.cos_angle() - pose.translation.x.powi(2))]
    struct Plate {}

    #[lie_poisson_system(group = SE3, invariance = right, methods(TangentLift, TangentMidpoint, TangentLift(1, 4)))]
    struct Fluid {
        #[inertia]
        inertia: Vector6<f64>,
    }

    const TIME: f64 = 0.4;

    fn after<S: System<Scalar = f64> + Discretized<M>, M>(
        system: &S,
        start: &S::State,
        steps: u32,
    ) -> Vec<f64> {
        let mut state = start.clone();
        let mut stepper = system.stepper::<M>(TIME / f64::from(steps)).expect("a stepper");
        for _ in 0..steps {
            stepper.step(&mut state).expect("a step");
        }
        state.to_components().as_ref().to_vec()
    }

    /// The slope of the error over three steps.
    fn order<S: System<Scalar = f64> + Discretized<M>, M>(
        system: &S,
        start: &S::State,
        reference: &[f64],
    ) -> f64 {
        let error = |steps| {
            let state = after::<S, M>(system, start, steps);
            state.iter().zip(reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let errors = [80, 160, 320].map(error);
        let slopes = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        // three points on a line
        assert!((slopes[0] - slopes[1]).abs() < 0.05, "{slopes:?}");
        (slopes[0] + slopes[1]) / 2.0
    }

    fn has_orders<S>(system: &S, start: &S::State)
    where
        S: System<Scalar = f64>
            + Discretized<Order6<Exponential>>
            + Discretized<TangentLift>
            + Discretized<TangentLift<Cayley>>
            + Discretized<TangentLift<Exponential, 1, 4>>
            + Discretized<TangentLift<Cayley, 1, 4>>
            + Discretized<TangentMidpoint>
            + Discretized<TangentMidpoint<Cayley>>,
    {
        let reference = after::<S, Order6<Exponential>>(system, start, 200);
        let slopes = [
            (1.0, order::<S, TangentLift>(system, start, &reference)),
            (1.0, order::<S, TangentLift<Cayley>>(system, start, &reference)),
            (1.0, order::<S, TangentLift<Exponential, 1, 4>>(system, start, &reference)),
            (1.0, order::<S, TangentLift<Cayley, 1, 4>>(system, start, &reference)),
            (2.0, order::<S, TangentMidpoint>(system, start, &reference)),
            (2.0, order::<S, TangentMidpoint<Cayley>>(system, start, &reference)),
        ];
        println!("{}: {slopes:.3?}", S::NAME);
        for (expected, slope) in slopes {
            assert!((slope - expected).abs() < 0.05, "{}: {slopes:?}", S::NAME);
        }
    }

    /// How far configurations come off the group over many steps.
    fn stays<S, M>(system: &S, start: &S::State)
    where
        S: System<Scalar = f64> + Discretized<M>,
    {
        let mut state = start.clone();
        let mut stepper = system.stepper::<M>(0.01).expect("a stepper");
        let mut worst = 0.0_f64;
        for _ in 0..20_000 {
            stepper.step(&mut state).expect("a step");
            worst = worst.max(state.deviation());
        }
        assert!(worst < 1e-14, "{}: {worst:e}", S::NAME);
    }

    fn turn() -> UnitQuaternion<f64> {
        UnitQuaternion::from_euler_angles(0.3, -0.5, 0.9)
    }

    #[test]
    fn of_a_point_and_a_pendulum() {
        let start = PointState { position: vector![0.4, 0.2, -0.3], momentum: vector![0.5, 1.0, 0.1] };
        has_orders(&Point { mass: 0.7 }, &start);
        let pendulum = Pendulum { inertia: 0.5 };
        let start = PendulumState { angle: UnitComplex::new(0.4), momentum: vector![0.8] };
        has_orders(&pendulum, &start);
        stays::<_, TangentLift>(&pendulum, &start);
        stays::<_, TangentMidpoint<Cayley>>(&pendulum, &start);
    }

    #[test]
    fn of_rotations() {
        let top = Top { inertia: vector![1.0, 1.5, 2.0] };
        let start =
            TopState { attitude: turn(), momentum: vector![0.3, 1.0, -0.5], gamma: vector![0.0, 0.6, 0.8] };
        has_orders(&top, &start);
        stays::<_, TangentMidpoint<Cayley>>(&top, &start);
        let start = SpinState { spin: turn(), momentum: vector![0.3, 1.0, -0.5] };
        has_orders(&Spin {}, &start);
        stays::<_, TangentMidpoint>(&Spin {}, &start);
    }

    #[test]
    fn of_motions() {
        let pose = Isometry2::from_parts(Translation2::new(0.3, 0.1), UnitComplex::new(0.7));
        let start = PlateState { pose, momentum: vector![0.3, 0.2, -0.4] };
        has_orders(&Plate {}, &start);
        stays::<_, TangentMidpoint<Cayley>>(&Plate {}, &start);
        let fluid = Fluid { inertia: Vector6::new(1.0, 1.5, 2.0, 1.0, 1.2, 1.7) };
        let pose = Isometry3::from_parts(Translation3::new(0.3, 0.1, 0.2), turn());
        let start = FluidState { pose, momentum: Vector6::new(0.3, 1.0, -0.5, 0.2, 0.1, 0.4) };
        has_orders(&fluid, &start);
        stays::<_, TangentMidpoint>(&fluid, &start);
    }
}
