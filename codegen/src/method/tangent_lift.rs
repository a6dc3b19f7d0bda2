//! The tangent lifts (5.1), (5.3), (5.5), (5.7): the steps of the Lagrangian side.
//!
//! The tangent map of the discretization map `D(ḡ, v) = (ḡ τ(−sv), ḡ τ((1−s)v))` takes the motion `(η, ξ'(ḡ, η))` of a
//! point `(ḡ, η)` with the velocity `η`, times the step `t`, to the start and the end of a step. With `y = tη`, the
//! unknown,
//!
//! ```text
//! ḡ = g_k τ(−sy)⁻¹
//! ξ_k = Ad_{τ(−sy)⁻¹} η − s t dL τ_{−sy} ξ'(ḡ, η)                the equation to solve
//! ξ_{k+1} = Ad_{τ((1−s)y)⁻¹} η + (1−s) t dL τ_{(1−s)y} ξ'(ḡ, η),   g_{k+1} = ḡ τ((1−s)y)
//! ```
//!
//! where `τ` is equivariant with `Ad_{τ(x)⁻¹} x = x`. Explicit for `s = 0`; on Rⁿ the θ-family on TQ. Advected
//! parameters are carried along, `ā = τ(−sy) a_k`.
//!
//! The state has momenta, so that the [Legendre transform](crate::model::Relation) stands at both ends: `ξ_k` belongs
//! to `μ_k`, and `μ_{k+1}` to `ξ_{k+1}`. What of it has no closed form is an unknown more; where there is none, which
//! was reported, the step makes no sense.

use super::discretization::{Discretization, Values, values};
use super::motion::Field;
use super::names::symbols;
use super::presolve::{Equation, presolve};
use super::step::Step;
use crate::expr::{Arena, Expr, Vector};
use crate::group::Retraction;
use crate::model::{Parts, Relation, System};
use crate::scheme::{Member, Method, Named};

/// The family of tangent lifts.
pub const METHOD: Method = Method {
    name: "TangentLift",
    word: "tangent-lift",
    about: "the tangent lift with another s",
    doc: DOC,
    orders: &[],
    usual_order: None,
    named: &[
        Named {
            name: "TangentLift",
            word: "tangent-lift",
            about: "the tangent lift, where it was generated: explicit, order 1, not symplectic",
            member: Member::SYMPLECTIC_EULER_A,
            doc: "",
        },
        Named {
            name: "TangentMidpoint",
            word: "tangent-midpoint",
            about: "the tangent lift with s = 1/2, where it was generated: order 2, not symplectic",
            member: Member::MIDPOINT,
            doc: "The [tangent lift](TangentLift) with `s = ½`, symmetric and of order 2.",
        },
    ],
    bare: None,
    needs_momentum: Some("tangent lifts"),
    is_symplectic: false,
    is_one_map: false,
};

const DOC: &str = "\
The tangent lift (5.7) of the discretization map with `s = N/D`, in lowest terms and from 0 to 1: a step of the Lagrangian side. With the
velocity `ξ`, its change `ξ'` along the motion, and the velocity `η` at the intermediate point `ḡ = g_k τ(shη)`, solve for `η`

```text
ξ_k = η − s h dL τ_{−shη} ξ'(ḡ, η)
```

and take `ξ_{k+1} = η + (1−s) h dL τ_{(1−s)hη} ξ'(ḡ, η)`, `g_{k+1} = ḡ τ((1−s)hη)`. Velocities belong to momenta by the inertia, or by the
Legendre transform of the Lagrangian or Hamiltonian.

The member `s = 0` is explicit. The configuration stays on its group and advected parameters on their orbits. Of order 1, `s = ½` of order 2
and symmetric; not symplectic, and no Poisson map: energy and momentum drift. To compare with, not to compute with. Asked for with
`methods(TangentLift)`, `methods(TangentLift(1, 4))` or `methods(TangentMidpoint)`.";

/// A tangent lift of a system.
struct Lift<'s, 'a>(Discretization<'s, 'a>);

/// Where the system is on its way.
struct Motion<'a> {
    /// The unknown: symbols.
    x: Vector<'a>,
    /// `tη`
    y: Vector<'a>,
    /// Configuration and advected parameters at the intermediate point and after the step.
    nodes: [Node<'a>; 2],
}

/// A place on the way.
struct Node<'a> {
    configuration: Vector<'a>,
    advected: Vec<Vector<'a>>,
}

/// The step of a member of the family of lifts.
pub fn step<'a>(arena: &'a Arena, system: &System<'a>, retraction: Retraction, member: Member) -> Step<'a> {
    let lift = Lift(Discretization::new(arena, system, retraction, member));
    let motion = lift.motion();
    let mut equations = Vec::new();
    let velocity = lift.velocity(&mut equations);
    let kick = lift.kick(&motion, &mut equations);
    equations.push(lift.equation(&motion, &velocity, &kick));
    let next = lift.next(&motion, &kick, &mut equations);
    lift.0.lifted(presolve(equations), &motion.y, &next)
}

impl<'a> Lift<'_, 'a> {
    fn motion(&self) -> Motion<'a> {
        let Discretization { system, names, moving, carrying, early, late, .. } = &self.0;
        let (arena, group) = (early.arena(), &system.group);
        let x = symbols(arena, names.unknown());
        let y = names.times_scale(&x);
        let (y_early, y_late) = (y.scale(*early), y.scale(*late));
        let increment = group.retract(moving.before, &y_early).hold();
        let middle = group.compose(system.side, &system.configuration(), &increment).hold();
        let end = group.moved(system.side, moving.behind, &middle, &y_late).next;
        let sign = arena.number(system.side.sign());
        let advected = group.carry(carrying.before, &y_early.scale(sign), &system.advected_values());
        let advected_next = group.carry(carrying.behind, &y_late.scale(sign), &advected);
        let nodes =
            [Node { configuration: middle, advected }, Node { configuration: end, advected: advected_next }];
        Motion { x, y, nodes }
    }

    /// An equation that holds no closed form, for each factor: `left = right`.
    fn implicit(&self, what: &str, [unknown, left, right, start]: [&Vector<'a>; 4]) -> Vec<Equation<'a>> {
        let group = &self.0.system.group;
        let (left, names) = (left.clone(), self.0.names.components(what));
        let explicit = self.0.explicit(unknown, right.clone(), start.clone());
        let whole = Equation { left, solved: None, names, ..explicit };
        whole.apart(group, &(0..group.factors.len()).map(|factor| vec![factor]).collect::<Vec<_>>())
    }

    /// What configurations, velocities, advected parameters and the time are at a node, with this share of the step
    /// behind it.
    fn values(&self, node: &Node<'a>, velocity: &Vector<'a>, share: Expr<'a>) -> Values<'a> {
        let later = self.0.step * share;
        values(self.0.system, &node.configuration, velocity, &node.advected, later)
    }

    /// `ξ_k`, with an equation if it has no closed form.
    fn velocity(&self, equations: &mut Vec<Equation<'a>>) -> Vector<'a> {
        let system = self.0.system;
        let residual = match system.velocity_relation() {
            Relation::Explicit(velocity) => return velocity.hold(),
            Relation::Implicit(residual) => residual,
            Relation::Singular => return system.velocity_symbols(),
        };
        let (arena, momentum) = (self.0.step.arena(), system.momentum());
        let velocity = symbols(arena, self.0.names.components("velocity"));
        let at = system.velocity_symbols().symbols().into_iter();
        let left = (residual + &momentum).substitute(&at.zip(velocity.iter()).collect::<Vec<_>>());
        let start = Vector::zeros(arena, velocity.len());
        equations.extend(self.implicit("velocity", [&velocity, &left, &momentum, &start]));
        velocity
    }

    /// The momentum at a node, with an equation if it has no closed form.
    fn momentum(&self, values: &Values<'a>, what: &str, equations: &mut Vec<Equation<'a>>) -> Vector<'a> {
        let system = self.0.system;
        let residual = match system.momentum_relation() {
            Relation::Explicit(momentum) => return momentum.substitute(values),
            Relation::Implicit(residual) => residual,
            Relation::Singular => return system.momentum(),
        };
        let momentum = symbols(self.0.step.arena(), self.0.names.components(what));
        let mut at = values.clone();
        at.extend(system.momentum().symbols().into_iter().zip(momentum.iter()));
        let velocity = system.velocity_symbols();
        let left = (&residual + &velocity).substitute(&at);
        let right = velocity.substitute(values);
        equations.extend(self.implicit(what, [&momentum, &left, &right, &system.momentum()]));
        momentum
    }

    /// `t ξ'(ḡ, η)`
    fn kick(&self, motion: &Motion<'a>, equations: &mut Vec<Equation<'a>>) -> Vector<'a> {
        let eta = motion.y.scale(self.0.step.recip());
        let mut values = self.values(&motion.nodes[0], &eta, self.0.early);
        let momentum = self.momentum(&values, "mu", equations);
        values.extend(self.0.system.momentum().symbols().into_iter().zip(momentum.iter()));
        Field::new(self.0.step.arena(), self.0.system)
            .acceleration
            .substitute(&values)
            .scale(self.0.step)
            .hold()
    }

    /// `Ad_{τ(x)⁻¹} y` for a multiple `x` of `y` and velocities in the body, `Ad_{τ(x)} y` for those in space: `y`,
    /// where `τ` is equivariant.
    fn turned(&self, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        if self.0.moving.behind.is_equivariant() {
            return y.clone();
        }
        let signed = x.scale(self.0.step.arena().number(self.0.system.side.sign()));
        self.0.system.group.carried_back(self.0.carrying.behind, &signed, y)
    }

    /// `Ad_{τ(−sy)⁻¹} y = t ξ_k + s t dL τ_{−sy} t ξ'`
    fn equation(&self, motion: &Motion<'a>, velocity: &Vector<'a>, kick: &Vector<'a>) -> Equation<'a> {
        let Discretization { step, early, .. } = self.0;
        let back = motion.y.scale(-early);
        let right = velocity + &self.0.carried_velocity(&back, kick).scale(early);
        let right = self.0.names.per_scale(&right.scale(step));
        let start = match self.0.system.velocity_relation() {
            Relation::Explicit(_) => self.0.names.per_scale(&velocity.scale(step)),
            _ => Vector::zeros(step.arena(), right.len()),
        };
        let left = self.0.names.per_scale(&self.turned(&back, &motion.y));
        let explicit = self.0.explicit(&motion.x, right, start);
        Equation { solved: explicit.solved.filter(|_| left == motion.x), left, ..explicit }
    }

    /// The state after the step, with an equation for the momentum if it has no closed form.
    fn next(&self, motion: &Motion<'a>, kick: &Vector<'a>, equations: &mut Vec<Equation<'a>>) -> Parts<'a> {
        let Discretization { step, late, .. } = self.0;
        let on = motion.y.scale(late);
        let change = self.0.carried_velocity(&on, kick).scale(late);
        let velocity = &self.turned(&on, &motion.y).scale(step.recip()) + &change;
        let [_, end] = &motion.nodes;
        let values = self.values(end, &velocity, step.arena().one());
        let momentum = self.momentum(&values, "momentum_next", equations);
        Parts { configuration: end.configuration.clone(), momentum, advected: end.advected.clone() }
    }
}
