//! The tangent lifts (5.1), (5.3), (5.5), (5.7): the steps of the Lagrangian side.
//!
//! The tangent map of the discretization map `D(ḡ, v) = (ḡ τ(−sv), ḡ τ((1−s)v))` takes the motion `(η, ξ'(ḡ, η))` of a point `(ḡ, η)` with
//! the velocity `η`, times the step `t`, to the start and the end of a step. With `y = tη`, the unknown,
//!
//! ```text
//! ḡ = g_k τ(−sy)⁻¹
//! ξ_k = Ad_{τ(−sy)⁻¹} η − s t dL τ_{−sy} ξ'(ḡ, η)                the equation to solve
//! ξ_{k+1} = Ad_{τ((1−s)y)⁻¹} η + (1−s) t dL τ_{(1−s)y} ξ'(ḡ, η),   g_{k+1} = ḡ τ((1−s)y)
//! ```
//!
//! where `τ` is equivariant with `Ad_{τ(x)⁻¹} x = x`. Explicit for `s = 0`; on Rⁿ the θ-family on TQ. Advected parameters are carried along,
//! `ā = τ(−sy) a_k`.
//!
//! The state has momenta, so that the [Legendre transform](crate::model::Relation) stands at both ends: `ξ_k` belongs to `μ_k`, and
//! `μ_{k+1}` to `ξ_{k+1}`. What of it has no closed form is an unknown more; where there is none, which was reported, the step makes no sense.

use super::Step;
use super::discretization::{Discretization, Path};
use super::names::ValueNames;
use super::presolve::{Equation, presolve};
use crate::expr::{Arena, Derivative, Expr, Number, Symbol, Vector, gradient};
use crate::group::{
    Retraction, SemidirectVector, Side, carried_back, d_left, d_right, stored_perturbation, to_body,
};
use crate::model::{Energy, Factor, FactorPart, Relation, System};
use crate::scheme::Member;

/// A tangent lift of a system.
struct Lift<'s, 'a> {
    system: &'s System<'a>,
    map: Discretization<'a>,
}

/// A factor on its way.
struct Motion<'s, 'a> {
    factor: &'s Factor<'a>,
    names: ValueNames<'s, 'a>,
    /// The number `k` for which the unknown is `y/k`.
    unknown_scale: Expr<'a>,
    /// The unknown: symbols.
    x: Vector<'a>,
    /// `tη`
    y: Vector<'a>,
    /// Configuration and advected parameters at the intermediate point and after the step.
    stations: [Station<'a>; 2],
}

/// Where a factor is.
struct Station<'a> {
    configuration: Vector<'a>,
    advected: Vec<Vector<'a>>,
}

/// Values of symbols.
type Values<'a> = Vec<(Symbol, Expr<'a>)>;

/// The step of a member of the family of lifts.
pub fn step<'a>(arena: &'a Arena, system: &System<'a>, retraction: Retraction, member: Member) -> Step<'a> {
    let lift = Lift { system, map: Discretization::new(arena, system, retraction, member) };
    let motions: Vec<Motion<'_, 'a>> =
        system.factors.iter().map(|factor| Motion::new(&lift, factor)).collect();
    let mut equations = Vec::new();
    let velocity = lift.velocity(&motions, &mut equations);
    let kick = lift.kick(&motions, &mut equations);
    equations.push(lift.equation(&motions, &velocity, &kick));
    let next = lift.next(&motions, &kick, &mut equations);

    let paths: Vec<Path<'_, 'a>> = motions.iter().map(Motion::path).collect();
    lift.map.lifted(system, presolve(equations), &paths, &next)
}

impl<'s, 'a> Motion<'s, 'a> {
    fn new(lift: &Lift<'_, 'a>, factor: &'s Factor<'a>) -> Self {
        let Lift { system, map: Discretization { moving, carrying, early, late, .. } } = *lift;
        let retraction = moving.behind;
        let (arena, algebra) = (early.arena(), &factor.algebra);
        let scale = algebra.group.unknown_scale(retraction);
        let names = ValueNames::new(system, factor, scale);
        let x = names.symbols(arena, names.unknown());
        let unknown_scale = arena.number(Number::ratio(scale, 1));
        let y = x.scale(unknown_scale);
        let (y_early, y_late) = (y.scale(early), y.scale(late));
        let increment = algebra.group.retract(moving.before, &y_early).hold();
        let middle = system.side.compose(algebra.group, &factor.configuration, &increment).hold();
        let end = algebra.group.moved(system.side, retraction, &middle, &y_late).next;
        let before = factor.advected_values();
        let advected = lift.carried_along(factor, carrying.before, &before, &y_early);
        let advected_next = lift.carried_along(factor, carrying.behind, &advected, &y_late);
        let stations = [
            Station { configuration: middle, advected },
            Station { configuration: end, advected: advected_next },
        ];
        Self { factor, names, unknown_scale, x, y, stations }
    }

    /// An equation for all components of something that belongs to this factor: `left = right`, which holds no closed form.
    fn equation(&self, what: &str, unknown: Vector<'a>, left: Vector<'a>, right: Vector<'a>) -> Equation<'a> {
        Equation {
            start: Vector::zeros(self.unknown_scale.arena(), unknown.len()),
            unknown,
            blocks: self.factor.algebra.group.blocks(),
            left,
            right,
            solved: None,
            names: self.names.components(what),
        }
    }

    /// The way of its configuration.
    fn path(&self) -> Path<'s, 'a> {
        Path { factor: self.factor, middle: self.stations[0].configuration.clone(), y: self.y.clone() }
    }
}

impl<'a> Lift<'_, 'a> {
    /// Advected parameters where the configuration is moved by an element of the algebra.
    fn carried_along(
        &self,
        factor: &Factor<'a>,
        carrying: Retraction,
        from: &[Vector<'a>],
        by: &Vector<'a>,
    ) -> Vec<Vector<'a>> {
        let signed = by.scale(self.map.early.arena().number(self.system.side.sign()));
        let carry = |(space, a)| factor.algebra.carry(space, carrying, &signed, a);
        from.iter().enumerate().map(carry).collect()
    }

    /// What configurations, velocities, advected parameters and the time are at a station, with this share of the step behind it.
    fn values(
        &self,
        motions: &[Motion<'_, 'a>],
        station: usize,
        velocity: &Vector<'a>,
        share: Expr<'a>,
    ) -> Values<'a> {
        let system = self.system;
        let mut values = Vec::new();
        let mut is = |what: &Vector<'a>, value: &Vector<'a>| {
            values.extend(what.symbols().into_iter().zip(value.iter()));
        };
        for (motion, velocity) in motions.iter().zip(system.split_momentum(velocity)) {
            let (factor, station) = (motion.factor, &motion.stations[station]);
            is(&factor.configuration, &station.configuration);
            is(&factor.velocity, &velocity);
            for (advected, value) in factor.advected.iter().zip(&station.advected) {
                is(&advected.value, value);
            }
        }
        is(&Vector(vec![system.time]), &Vector(vec![system.time + self.map.step * share]));
        values
    }

    /// `ξ_k`, with an equation if it has no closed form.
    fn velocity(&self, motions: &[Motion<'_, 'a>], equations: &mut Vec<Equation<'a>>) -> Vector<'a> {
        let system = self.system;
        let residual = match system.velocity_relation() {
            Relation::Explicit(velocity) => return velocity.hold(),
            Relation::Implicit(residual) => residual,
            Relation::Singular => return system.velocity_symbols(),
        };
        let momentum = system.momentum();
        let unknown = |motion: &Motion<'_, 'a>| motion.names.symbols(self.map.step.arena(), "velocity");
        let unknowns: Vec<Vector<'a>> = motions.iter().map(unknown).collect();
        let velocity = Vector::concat(&unknowns);
        let symbols = system.velocity_symbols().symbols().into_iter();
        let left = (residual + &momentum).substitute(&symbols.zip(velocity.iter()).collect::<Vec<_>>());
        let parts = system.split_momentum(&left).into_iter().zip(system.split_momentum(&momentum));
        for ((motion, unknown), (left, right)) in motions.iter().zip(unknowns).zip(parts) {
            equations.push(motion.equation("velocity", unknown, left, right));
        }
        velocity
    }

    /// The momentum at a station, with an equation if it has no closed form.
    fn momentum(
        &self,
        motions: &[Motion<'_, 'a>],
        values: &Values<'a>,
        what: &str,
        equations: &mut Vec<Equation<'a>>,
    ) -> Vector<'a> {
        let system = self.system;
        let residual = match system.momentum_relation() {
            Relation::Explicit(momentum) => return momentum.substitute(values),
            Relation::Implicit(residual) => residual,
            Relation::Singular => return system.momentum(),
        };
        let unknown = |motion: &Motion<'_, 'a>| motion.names.symbols(self.map.step.arena(), what);
        let unknowns: Vec<Vector<'a>> = motions.iter().map(unknown).collect();
        let momentum = Vector::concat(&unknowns);
        let mut at = values.clone();
        at.extend(system.momentum().symbols().into_iter().zip(momentum.iter()));
        let velocity = system.velocity_symbols();
        let left = (&residual + &velocity).substitute(&at);
        let right = velocity.substitute(values);
        let parts = system.split_momentum(&left).into_iter().zip(system.split_momentum(&right));
        for ((motion, unknown), (left, right)) in motions.iter().zip(unknowns).zip(parts) {
            let equation = motion.equation(what, unknown, left, right);
            equations.push(Equation { start: motion.factor.momentum.clone(), ..equation });
        }
        momentum
    }

    /// `t ξ'(ḡ, η)`
    fn kick(&self, motions: &[Motion<'_, 'a>], equations: &mut Vec<Equation<'a>>) -> Vector<'a> {
        let eta = Vector::concat(motions.iter().map(|motion| &motion.y)).scale(self.map.step.recip());
        let mut values = self.values(motions, 0, &eta, self.map.early);
        let momentum = self.momentum(motions, &values, "mu", equations);
        values.extend(self.system.momentum().symbols().into_iter().zip(momentum.iter()));
        acceleration(self.map.step.arena(), self.system).substitute(&values).scale(self.map.step).hold()
    }

    /// `dL τ_x v` for velocities in the body, `dR τ_x v` for those in space.
    fn carried(&self, factor: &Factor<'a>, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        let (group, retraction) = (factor.algebra.group, self.map.moving.behind);
        match self.system.side {
            Side::Left => d_left(group, retraction, x, v),
            Side::Right => d_right(group, retraction, x, v),
        }
    }

    /// `Ad_{τ(x)⁻¹} y` for a multiple `x` of `y` and velocities in the body, `Ad_{τ(x)} y` for those in space: `y`, where `τ` is equivariant.
    fn turned(&self, factor: &Factor<'a>, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        if self.map.moving.behind.is_equivariant() {
            return y.clone();
        }
        let side = self.system.side;
        let signed = x.scale(self.map.step.arena().number(side.sign()));
        carried_back(factor.algebra.group, self.map.carrying.behind, &signed, y)
    }

    /// `Ad_{τ(−sy)⁻¹} y = t ξ_k + s t dL τ_{−sy} t ξ'`
    fn equation(&self, motions: &[Motion<'_, 'a>], velocity: &Vector<'a>, kick: &Vector<'a>) -> Equation<'a> {
        let split = |vector: &Vector<'a>| self.system.split_momentum(vector).into_iter();
        let parts = motions.iter().zip(split(velocity).zip(split(kick)));
        let right = parts.map(|(motion, (velocity, kick))| {
            let back =
                self.carried(motion.factor, &motion.y.scale(-self.map.early), &kick).scale(self.map.early);
            (&velocity + &back).scale(self.map.step / motion.unknown_scale)
        });
        let right = Vector::concat(&right.collect::<Vec<_>>());
        let start = motions.iter().zip(split(velocity));
        let start = start.map(|(motion, velocity)| velocity.scale(self.map.step / motion.unknown_scale));
        let start = match self.system.velocity_relation() {
            Relation::Explicit(_) => Vector::concat(&start.collect::<Vec<_>>()),
            _ => Vector::zeros(self.map.step.arena(), right.len()),
        };
        let unknown = Vector::concat(motions.iter().map(|motion| &motion.x));
        let left = motions.iter().map(|motion| {
            let turned = self.turned(motion.factor, &motion.y.scale(-self.map.early), &motion.y);
            turned.scale(motion.unknown_scale.recip())
        });
        let left = Vector::concat(&left.collect::<Vec<_>>());
        Equation {
            solved: (left == unknown).then(|| right.clone()),
            left,
            unknown,
            blocks: motions.iter().flat_map(|motion| motion.factor.algebra.group.blocks()).collect(),
            right,
            start,
            names: motions.iter().flat_map(|m| m.names.components(m.names.unknown())).collect(),
        }
    }

    /// The state after the step, with an equation for the momentum if it has no closed form.
    fn next(
        &self,
        motions: &[Motion<'_, 'a>],
        kick: &Vector<'a>,
        equations: &mut Vec<Equation<'a>>,
    ) -> Vec<FactorPart<'a>> {
        let parts = motions.iter().zip(self.system.split_momentum(kick));
        let velocity = parts.map(|(motion, kick)| {
            let late = motion.y.scale(self.map.late);
            let change = self.carried(motion.factor, &late, &kick).scale(self.map.late);
            &self.turned(motion.factor, &late, &motion.y).scale(self.map.step.recip()) + &change
        });
        let velocity = Vector::concat(&velocity.collect::<Vec<_>>());
        let values = self.values(motions, 1, &velocity, self.map.step.arena().one());
        let momentum = self.momentum(motions, &values, "momentum_next", equations);
        let next = motions.iter().zip(self.system.split_momentum(&momentum));
        let part = |(motion, momentum): (&Motion<'_, 'a>, Vector<'a>)| {
            let [_, Station { configuration, advected }] = &motion.stations;
            FactorPart { configuration: configuration.clone(), momentum, advected: advected.clone() }
        };
        next.map(part).collect()
    }
}

/// `ξ'` along the motion, a function of configuration, velocity, the momentum that belongs to it, advected parameters, time and controls: by
/// `μ' = ad*_ξ μ − T*L_g ∂h/∂g + F`, and by what a velocity is to a momentum.
fn acceleration<'a>(arena: &'a Arena, system: &System<'a>) -> Vector<'a> {
    let (mut direction, mut changes) = (Vec::new(), Vec::new());
    let sign = arena.number(system.side.sign());
    for factor in &system.factors {
        let (group, g, xi) = (factor.algebra.group, &factor.configuration, &factor.velocity);
        let by_advected = |a: &crate::model::Advected<'a>| gradient(system.potential(), &a.value.symbols());
        let velocity =
            SemidirectVector { base: xi.clone(), spaces: factor.advected.iter().map(by_advected).collect() };
        let change = factor.algebra.coadjoint(&velocity.scale(sign), &factor.momentum_and_advected());
        let in_body = match system.side {
            Side::Left => xi.clone(),
            Side::Right => to_body(group, g, xi),
        };
        let momentum = system.kick(factor).map_or_else(|| change.base.clone(), |kick| &change.base + kick);
        let mut is = |what: &Vector<'a>, value: &Vector<'a>| {
            direction.extend(what.symbols().into_iter().zip(value.iter()));
        };
        is(g, &stored_perturbation(group, g, &in_body));
        for (advected, change) in factor.advected.iter().zip(&change.spaces) {
            is(&advected.value, change);
        }
        changes.push(momentum);
    }
    direction.extend(system.time_symbol().into_iter().map(|time| (time, arena.one())));
    let change = Vector::concat(&changes);
    match &system.energy {
        Energy::Mechanical { inertia, .. } => inertia.solve_symmetric(&change),
        Energy::Hamiltonian(energy) => {
            let momentum = system.momentum().symbols();
            direction.extend(momentum.iter().copied().zip(change.iter()));
            let mut along = Derivative::along(arena, &direction);
            gradient(*energy, &momentum).map(|component| along.of(component))
        }
        Energy::Lagrangian(lagrangian) => {
            let velocity = system.velocity_symbols().symbols();
            let momentum = gradient(*lagrangian, &velocity);
            let mut along = Derivative::along(arena, &direction);
            let rest = momentum.map(|component| along.of(component));
            momentum.jacobian(&velocity).map(Expr::hold).solve(&(&change - &rest).hold())
        }
    }
}
