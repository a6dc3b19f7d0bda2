//! The discretization map that steps are lifts of: `D(ḡ, v) = (ḡ τ(−sv), ḡ τ((1−s)v))`, from an intermediate point `ḡ`
//! to both ends of a step.

use super::names::ValueNames;
use super::presolve::{Equation, Presolved};
use super::step::{Increment, Iteration, Step, step_symbol};
use crate::expr::{Arena, Expr, Matrix, Number, Stage, Symbol, Vector};
use crate::group::{Retraction, Side};
use crate::model::{Parts, Relation, Slot, System};
use crate::scheme::Member;

/// A discretization map for a system, and the step that it is taken with.
#[derive(Clone)]
pub(super) struct Discretization<'s, 'a> {
    pub system: &'s System<'a>,
    pub names: ValueNames<'s, 'a>,
    /// The retractions that move configurations.
    pub moving: Halves,
    /// What carries momenta and advected parameters where configurations are moved so.
    pub carrying: Halves,
    /// `t`
    pub step: Expr<'a>,
    /// `s`, the share of the step before the intermediate point.
    pub early: Expr<'a>,
    /// `1 − s`, the share behind it.
    pub late: Expr<'a>,
}

/// The retractions before the intermediate point and behind it.
#[derive(Clone, Copy)]
pub(super) struct Halves {
    pub before: Retraction,
    pub behind: Retraction,
}

/// Values of symbols.
pub(super) type Values<'a> = Vec<(Symbol, Expr<'a>)>;

/// Binds symbols to values.
pub(super) fn bind<'a>(values: &mut Values<'a>, what: &Vector<'a>, value: &Vector<'a>) {
    values.extend(what.symbols().into_iter().zip(value.iter()));
}

/// What configurations, velocities, advected parameters and the time are at a place on the way, so much later than the
/// start.
pub(super) fn values<'a>(
    system: &System<'a>,
    configuration: &Vector<'a>,
    velocity: &Vector<'a>,
    advected: &[Vector<'a>],
    later: Expr<'a>,
) -> Values<'a> {
    let mut values = Values::new();
    bind(&mut values, &system.configuration(), configuration);
    bind(&mut values, &system.velocity_symbols(), velocity);
    for (advected, value) in system.advected().zip(advected) {
        bind(&mut values, &advected.value, value);
    }
    bind(&mut values, &Vector(vec![system.time]), &Vector(vec![system.time + later]));
    values
}

impl<'s, 'a> Discretization<'s, 'a> {
    /// The map with this `s` for a system.
    pub(super) fn new(
        arena: &'a Arena,
        system: &'s System<'a>,
        retraction: Retraction,
        member: Member,
    ) -> Self {
        let s = member.s();
        let moving = Halves { before: retraction.reversed(), behind: retraction };
        let Halves { before, behind } = moving;
        Self {
            system,
            names: ValueNames::new(system, retraction),
            moving,
            carrying: Halves { before: system.side.carrying(before), behind: system.side.carrying(behind) },
            step: step_symbol(arena),
            early: arena.number(s),
            late: arena.number(Number::ONE + -s),
        }
    }

    /// A first approximation of `y`: `t ξ_k`, or near to it where no closed form gives the velocity.
    pub(super) fn start(&self) -> Vector<'a> {
        let velocity = match self.system.velocity_relation() {
            Relation::Explicit(velocity) => velocity.clone(),
            Relation::Implicit(residual) => self.near_velocity(residual),
            Relation::Singular => Vector::zeros(self.step.arena(), self.system.dimension()),
        };
        velocity.scale(self.step)
    }

    /// Nearly the root of `∂l/∂ξ − m`: half of the way from rest and the other half along the path on which `m` grows (Davidenko's equation, by
    /// Euler's method), and two steps of Newton's method. An equation of higher order has roots near others than this one. Rest itself
    /// where that leads nowhere, as beyond the speeds that an energy is defined for.
    fn near_velocity(&self, residual: &Vector<'a>) -> Vector<'a> {
        let symbols = self.system.velocity_symbols().symbols();
        let jacobian = residual.jacobian(&symbols).map(Expr::hold);
        let values = |vector: &Vector<'a>, velocity: &Vector<'a>| {
            vector
                .substitute(&symbols.iter().copied().zip(velocity.iter()).collect::<Vec<_>>())
                .map(Expr::hold)
        };
        let corrected = |velocity: &Vector<'a>, residual: &Vector<'a>| {
            let entries = values(&Vector(jacobian.entries.clone()), velocity).0;
            let matrix = Matrix::new(jacobian.rows, jacobian.columns, entries);
            (velocity - &matrix.solve(residual)).map(Expr::hold)
        };
        // as near to rest as derivatives of norms there allow
        let share = |all: i128| self.step.arena().number(Number::ratio(1, all));
        let rest = self.system.momentum().scale(share(1_000_000_000_000_000));
        let missing = values(residual, &rest);
        let half = missing.scale(share(2));
        let mut velocity = corrected(&corrected(&rest, &half), &half);
        for _ in 0..2 {
            velocity = corrected(&velocity, &values(residual, &velocity));
        }
        let [left, before] = [values(residual, &velocity), missing].map(|vector| vector.dot(&vector));
        let is_nearer = (left - before).hold();
        velocity.map(|component| is_nearer.choose(component, self.step.arena().zero()))
    }

    /// `dL τ_x v` for velocities in the body, `dR τ_x v` for those in space.
    pub(super) fn carried_velocity(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        let (group, retraction) = (&self.system.group, self.moving.behind);
        match self.system.side {
            Side::Left => group.d_left(retraction, x, v),
            Side::Right => group.d_right(retraction, x, v),
        }
    }

    /// `unknown = right`, in the system's order.
    pub(super) fn explicit(
        &self,
        unknown: &Vector<'a>,
        right: Vector<'a>,
        start: Vector<'a>,
    ) -> Equation<'a> {
        Equation {
            unknown: unknown.clone(),
            blocks: self.system.group.blocks(),
            left: unknown.clone(),
            solved: Some(right.clone()),
            right,
            start,
            names: self.names.unknown(),
        }
    }

    /// The step from what is left of its equations, the `y` by which it moves the configuration, and the state after it.
    pub(super) fn lifted(
        &self,
        Presolved { equations, found }: Presolved<'a>,
        y: &Vector<'a>,
        next: &Parts<'a>,
    ) -> Step<'a> {
        let system = self.system;
        // to the intermediate point and on; where `s` is 0 or 1 at once
        let increments = [(self.early, self.moving.before), (self.late, self.moving.behind)];
        let increments = increments.into_iter().filter(|(share, _)| !share.is_zero());
        let increment = |(share, retraction): (Expr<'a>, Retraction)| Increment {
            retraction,
            by: y.scale(share).substitute(&found),
        };
        let increments: Vec<Increment<'a>> = increments.map(increment).collect();
        // both parts of the step are inside the retraction's domain if the longer one is
        let longer = if self.early.as_number() > self.late.as_number() { self.early } else { self.late };
        let domain = system.group.domain(self.moving.behind, &y.scale(longer)).into_iter();
        let join =
            |part: for<'e> fn(&'e Equation<'a>) -> &'e Vector<'a>| Vector::concat(equations.iter().map(part));
        let (left, right) = (join(|equation| &equation.left), join(|equation| &equation.right));
        let unknown = join(|equation| &equation.unknown);
        let matrix = (&left - &right).jacobian(&unknown.symbols());
        let is_linear = is_linear(&left, &unknown.symbols());
        Step {
            h: self.step,
            given: [system.time_symbol(), system.control_symbols()].concat(),
            domain: domain.map(|margin| margin.substitute(&found)).collect(),
            unknown,
            blocks: equations.iter().flat_map(|equation| equation.blocks.clone()).collect(),
            start: join(|equation| &equation.start),
            matrix,
            iteration: if is_linear { Iteration::FixedPoint } else { Iteration::TrueNewton },
            left,
            right,
            slow: Vector(Vec::new()),
            next: system.join_state(next).substitute(&found),
            bounded: bounded(system, &increments),
            increments,
        }
    }
}

/// Whether a function of the unknowns is linear, with coefficients that depend on parameters and step alone.
fn is_linear(function: &Vector<'_>, unknown: &[Symbol]) -> bool {
    let coefficients = function.jacobian(unknown).entries;
    coefficients.iter().all(|entry| entry.stage() <= Stage::Parameters)
        && function.at_zero(unknown).iter().all(|value| value.is_zero())
        && !function.chooses_by(unknown)
}

/// Components of the state that are bounded if the unknown is: the rotations that the unknown moves, not what is known
/// before.
fn bounded(system: &System<'_>, increments: &[Increment<'_>]) -> Vec<bool> {
    let places = system.group.places();
    let mut bounded = Vec::new();
    for slot in system.slots() {
        let length = system.part(slot).len();
        let rotation = match slot {
            Slot::Configuration(factor) => {
                let by = increments.iter().map(|increment| places[factor].algebra(&increment.by));
                let unknown = by.flat_map(|by| by.0).all(|x| x.stage() >= Stage::Iteration);
                if unknown { system.group.factors[factor].group.names().unit_coordinates } else { 0 }
            }
            Slot::Momentum(_) | Slot::Advected { .. } => 0,
        };
        bounded.extend((0..length).map(|i| i < rotation));
    }
    bounded
}
