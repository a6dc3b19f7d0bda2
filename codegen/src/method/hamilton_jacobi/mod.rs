//! Steps of any even order from one equation: the Hamilton–Jacobi equation solved as a power series in the step.
//!
//! The step is that of the [family](super::family) with `s = ½`, where advected parameters are part of the
//! configuration:
//!
//! ```text
//! ḡ = g_k τ(η/2),   m⁻ = Ad*_{τ(−η/2)⁻¹} m_k
//! m⁺ = m⁻ + κ
//! m̄ = ½ (dR τ_{η/2})* m⁺ + ½ (dL τ_{−η/2})* m_k
//! m_{k+1} = Ad*_{τ(η/2)} m⁺,   g_{k+1} = ḡ τ(η/2)
//! ```
//!
//! with `η` and `κ` from a generating function: they are `∂S/∂m̄` and `−∂S/∂g` of a function `S(ḡ, m̄, t)`, or `m̄` and
//! `κ` are `∂R/∂η` and `∂R/∂g` of `R(ḡ, η, t)`. Whatever the function is, the step is symplectic, and keeps Casimirs; it is
//! symmetric if the function is odd in `t`, `R` at constant `η/t`. `S = t h` is the midpoint step. The motion itself has
//! Hamilton's principal function
//!
//! ```text
//! R = ∫ ⟨μ, ξ⟩ − h dτ,   S = ⟨m̄, η⟩ − R
//! ```
//!
//! along the motion from `ḡ τ(−η/2)` to `ḡ τ(η/2)` in the time `t`, which solves the Hamilton–Jacobi equation
//! `∂S/∂t = h`. Cut behind `t^{p−1}`, it makes a step of order `p`.
//!
//! * With a Hamiltonian it is `S` that is derived: its argument is the momentum. With a Lagrangian it is `R`. With an
//!   inertia both are steps, and the one that takes fewer operations at order 4 is taken.
//! * It is `R` where forces act, too: what is left of it then are its derivatives, with which the step is symmetric and of
//!   order `p`, and not symplectic, as the motion is not.
//! * Where `h` does not depend on the configuration, the exponential has a step of fewer operations: the
//!   advected parameters are then part of the momentum.
//!
//! Ge and Marsden, Phys. Lett. A 133 (1988) 134; Ferraro, de León, Marrero, Martín de Diego and Vaquero,
//! arXiv:1606.00847.

mod momentum;
mod path;
mod reduced;
mod velocity;

use super::discretization::{Discretization, Values, bind, values};
use super::motion::Field;
use super::names::symbols;
use super::presolve::{Equation, presolve_only};
use super::step::{Iteration, Step};
use crate::expr::{Arena, Expr, Number, Series, Vector};
use crate::group::Retraction;
use crate::model::{Energy, Parts, Relation, System};
use crate::scheme::{Member, Method};

/// Hamilton–Jacobi steps.
pub const METHOD: Method = Method {
    name: "HamiltonJacobi",
    word: "hamilton-jacobi",
    about: "order 4 to 10 from one equation, where it was generated",
    doc: DOC,
    orders: &[4, 6, 8, 10],
    usual_order: Some(6),
    named: &[],
    bare: None,
    needs_momentum: None,
    is_symplectic: true,
    is_one_map: false,
};

const DOC: &str = "\
A step of the even order `P`, from 4 to 10, from one equation: symplectic, for left-invariant systems a Poisson map that keeps the Casimirs,
and symmetric, as [`Midpoint`] is. Asked for with `methods(HamiltonJacobi(6))`.

Where the midpoint step solves `∂l/∂ξ(ḡ, η/h) = m̄` with the Lagrangian `l`, the action over a step in the lowest order, this solves the same
with the action up to order `P`, a power series in the step that the macro derives: with the unknown `η`, `ḡ = g_k τ(η/2)`,

```text
m⁻ = Ad*_{τ(−η/2)⁻¹} μ_k,   m⁺ = m⁻ + ∂R/∂g
∂R/∂η = ½ (dR τ_{η/2})* m⁺ + ½ (dL τ_{−η/2})* μ_k
μ_{k+1} = Ad*_{τ(η/2)} m⁺,   g_{k+1} = ḡ τ(η/2)
```

where `R(ḡ, η, h)` is the action of the motion from `ḡ τ(−η/2)` to `ḡ τ(η/2)` in the time `h`: Hamilton's principal function, which solves the
Hamilton–Jacobi equation. There has to be a momentum for each velocity in closed form, as there is for every inertia, Lagrangian, and
Hamiltonian that is quadratic in the momentum. With forces the step is not symplectic, nor is the motion; order and symmetry stay. Controls
are held over a step; what changes within it belongs into the description, as a function of `t`.

Ge and Marsden, Phys. Lett. A 133 (1988) 134.";

/// The order of the step that Newton's matrix is taken from where it has a few rows, and not many more operations than the
/// equation: terms of higher order change it by little. Another one is that of the midpoint step, and iterations have one
/// of its first terms.
const COARSE: usize = 4;

/// The most rows of a matrix of these terms.
const FEW: usize = 3;

/// Its operations that are beside those of the equation, for which an iteration waits: a pendulum's steps of 0.1 s take a
/// third longer with the matrix of the midpoint step, a heavy top's, of 1,100 operations, half as long.
const SHORT: usize = 256;

/// The derivatives of a generating function, functions of the state's symbols, which stand for what is in the middle of
/// the step, and of the step.
enum Derivatives<'a> {
    /// Of one of the momentum: `η/t` and, if there is any, `κ/t`.
    OfMomentum { velocity: Vector<'a>, kick: Option<Vector<'a>> },
    /// Of one of the velocity: `m̄` where the step is nothing, what it is more, and, if there is any, `κ/t` of the midpoint
    /// step, and what that is more.
    OfVelocity {
        momentum: Vector<'a>,
        correction: Option<Vector<'a>>,
        kick: Option<Vector<'a>>,
        kick_correction: Option<Vector<'a>>,
    },
}

/// Whether there are steps of a system: with the velocity held fixed there has to be a momentum for it in closed form.
pub fn is_for(system: &System<'_>) -> bool {
    !by_velocity(system) || matches!(system.momentum_relation(), Relation::Explicit(_))
}

/// Whether the only generating function is that of the velocity.
fn by_velocity(system: &System<'_>) -> bool {
    matches!(system.energy, Energy::Lagrangian(_)) || system.is_forced()
}

/// Whether the momentum has a generating function, too.
fn has_both(system: &System<'_>) -> bool {
    matches!(system.energy, Energy::Mechanical { .. })
}

/// The step of this order.
pub fn step<'a>(arena: &'a Arena, system: &System<'a>, retraction: Retraction, order: u32) -> Step<'a> {
    if reduced::is_for(system, retraction) {
        let discretization = Discretization::new(arena, system, retraction, Member::SYMPLECTIC_EULER_A);
        return reduced::step(&discretization, order as usize);
    }
    let has_kick = !system.is_left_invariant() || system.advected().next().is_some();
    // with the exponential all members of the family are one where nothing kicks
    let is_first = retraction == Retraction::Exponential && !has_kick;
    let member = if is_first { Member::SYMPLECTIC_EULER_A } else { Member::MIDPOINT };
    let step_by = |is_velocity: bool, retraction: Retraction, order: usize, left: Option<&[String]>| {
        let discretization = Discretization::new(arena, system, retraction, member);
        let derivatives = match is_velocity {
            true => velocity::derivatives(&discretization, order),
            false => momentum::derivatives(&discretization, order),
        };
        HamiltonJacobi(discretization).step(derivatives, left)
    };
    let is_velocity = by_velocity(system)
        || has_both(system) && {
            let [by_velocity, by_momentum] = [true, false].map(|is_velocity| {
                let step = step_by(is_velocity, retraction, COARSE, None).0;
                Vector::concat([&step.left, &step.right, &step.next]).operations()
            });
            by_velocity < by_momentum
        };
    let step_of = |retraction, order, left: Option<&[String]>| step_by(is_velocity, retraction, order, left);
    let (whole, left) = step_of(retraction, order as usize, None);
    if whole.unknown.is_empty() {
        // of a motion that is linear, for example: there is no iteration to find a matrix for
        return whole;
    }
    let coarse = if system.group.is_summed(retraction) { Retraction::Coarse } else { retraction };
    let jacobian = |residual: &Vector<'a>| residual.jacobian(&whole.unknown.symbols());
    let residual_of = |order: usize| {
        let step = step_of(coarse, order, Some(&left)).0;
        whole.residual_of(&step).map(Expr::with_short_stumpff)
    };
    let fine = (whole.unknown.len() <= FEW).then(|| jacobian(&residual_of(COARSE)));
    if let Some(matrix) = &fine {
        let operations = Vector(matrix.entries.clone()).operations();
        if operations <= (&whole.left - &whole.right).operations().max(SHORT) {
            return Step { iteration: Iteration::Newton(matrix.clone()), matrix: matrix.clone(), ..whole };
        }
    }
    let residual = residual_of(2);
    let increments = increments(system, retraction, member, &whole);
    let iteration = Iteration::Chord(jacobian(&linear(&residual, &increments)));
    // what iterations do not solve is worth the longer one
    Step { matrix: fine.unwrap_or_else(|| jacobian(&residual)), iteration, ..whole }
}

/// The unknowns that are increments, not momenta.
fn increments<'a>(
    system: &System<'a>,
    retraction: Retraction,
    member: Member,
    step: &Step<'a>,
) -> Vec<Expr<'a>> {
    let arena = step.h.arena();
    let names = Discretization::new(arena, system, retraction, member).names.unknown();
    let is_one = |x: &Expr<'a>| x.as_symbol().is_some_and(|x| names.contains(&arena.symbol_info(x).name));
    step.unknown.iter().filter(is_one).collect()
}

/// A residual up to terms of the second degree in these symbols.
fn linear<'a>(residual: &Vector<'a>, symbols: &[Expr<'a>]) -> Vector<'a> {
    residual.map(|component| {
        let arena = component.arena();
        let mut series = Series::new(arena);
        for &x in symbols {
            series.push(x, Vec::new());
            series.push(x, vec![x]);
        }
        let parts = (0..2).filter_map(|weight| series.part(component, weight).first().copied());
        parts.fold(arena.zero(), |sum, part| sum + part)
    })
}

/// A step of a system.
struct HamiltonJacobi<'s, 'a>(Discretization<'s, 'a>);

impl<'a> HamiltonJacobi<'_, 'a> {
    /// The step, and the names of the unknowns that are left in it: these are to be left if they are given.
    fn step(&self, derivatives: Derivatives<'a>, left: Option<&[String]>) -> (Step<'a>, Vec<String>) {
        let Discretization { system, names, moving, carrying, step, early, late } = &self.0;
        let (arena, group) = (step.arena(), &system.group);
        let (x, mean) = (symbols(arena, names.unknown()), symbols(arena, names.components("mu")));
        let y = names.times_scale(&x);
        let (y_early, y_late) = (y.scale(*early), y.scale(*late));
        let sign = arena.number(system.side.sign());
        let (x_early, x_late) = (y_early.scale(sign), y_late.scale(sign));

        // to the middle
        let increment = names.group("increment_early", &group.retract(moving.before, &y_early).hold());
        let g_bar = group.compose(system.side, &system.configuration(), &increment).hold();
        let g_bar = names.configuration("mean", &g_bar);
        let a_bar = group.carry(carrying.before, &x_early, &system.advected_values());
        let a_bar: Vec<_> = a_bar.iter().map(Vector::hold).collect();
        let mean_minus = self.carried_dual(carrying.before, &x_early, &system.momentum());
        let m_minus = self.carried(carrying.before, &x_early, &system.momentum(), &mean_minus);

        let velocity = y.scale(step.recip());
        let mut there = values(system, &g_bar, &velocity, &a_bar, *step * *early);
        if let Derivatives::OfMomentum { .. } = derivatives {
            bind(&mut there, &system.momentum(), &mean);
        }
        let at_middle = |vector: &Vector<'a>| vector.substitute(&there);
        let (Derivatives::OfMomentum { kick, .. } | Derivatives::OfVelocity { kick, .. }) = &derivatives;

        // and on
        let mut slow = Vector(Vec::new());
        let m_plus = match kick {
            Some(kick) => {
                let mut kick = at_middle(kick).scale(*step);
                if let Derivatives::OfVelocity { kick_correction: Some(more), .. } = &derivatives {
                    slow = names.algebra("kick_correction", &at_middle(more).scale(*step).hold());
                    kick = &kick + &slow;
                }
                let kick = names.algebra("kick", &kick.hold());
                self.kicked(&m_minus, &kick)
            }
            None => m_minus,
        };
        let mean_plus = self.carried_dual(carrying.behind, &x_late, &m_plus);
        let m_bar = &mean_plus.scale(*late) + &mean_minus.scale(*early);
        let m_next = self.carried(carrying.behind, &x_late, &m_plus, &mean_plus);
        let a_next = group.carry(carrying.behind, &x_late, &a_bar);
        let moved = group.moved(system.side, moving.behind, &g_bar, &y_late);
        let scaled_mean = names.times_scale(&m_bar).hold();

        let equations = match &derivatives {
            Derivatives::OfMomentum { velocity, .. } => {
                let mean_right = names.per_scale(&scaled_mean);
                let mean = self.0.explicit(&mean, mean_right, system.momentum());
                let mean = Equation { names: names.components("mu"), ..mean };
                let velocity = names.per_scale(&at_middle(velocity).scale(*step));
                vec![mean, self.0.explicit(&x, velocity, names.per_scale(&self.start()))]
            }
            Derivatives::OfVelocity { momentum, correction, .. } => {
                let right = match correction {
                    Some(correction) => {
                        let correction = names.algebra("correction", &at_middle(correction).hold());
                        &scaled_mean - &names.times_scale(&correction)
                    }
                    None => scaled_mean.clone(),
                };
                vec![self.equation(&x, &at_middle(momentum), right)]
            }
        };
        names.group("increment", &moved.increment);
        names.configuration("moved", &moved.moved);
        names.squares(&x);
        names.multiple_of("momentum_mean", &scaled_mean);
        names.algebra("momentum_next", &m_next);
        names.advected("mean", &a_bar);
        names.advected("next", &a_next);
        let next = Parts { configuration: moved.next, momentum: m_next, advected: a_next };
        let presolved = presolve_only(equations, left);
        let left = presolved.equations.iter().flat_map(|equation| equation.names.clone()).collect();
        let slow = slow.substitute(&presolved.found);
        (Step { slow, ..self.0.lifted(presolved, &y, &next) }, left)
    }

    /// A first approximation of `η`: `t ξ`, with the velocity of the momentum after half of the step. From rest that is where it goes to, where terms
    /// of higher order have derivatives that they have not at rest, as those of drag.
    fn start(&self) -> Vector<'a> {
        let Discretization { system, step, .. } = &self.0;
        let Relation::Explicit(velocity) = system.velocity_relation() else { return self.0.start() };
        let (mut now, mut middle) = (Values::new(), Values::new());
        bind(&mut now, &system.velocity_symbols(), &velocity.hold());
        let change = Field::new(step.arena(), system).momentum.substitute(&now);
        let half = *step * step.arena().number(Number::ratio(1, 2));
        bind(&mut middle, &system.momentum(), &(&system.momentum() + &change.scale(half)).hold());
        velocity.substitute(&middle).scale(*step)
    }

    /// `(dR τ_x)* m`, on the group alone.
    fn carried_dual(&self, retraction: Retraction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let [x, m] = [x, m].map(|base| self.0.on_the_group(base));
        self.0.names.keep_multiple(&self.0.system.group.d_right_dual(retraction, &x, &m)).base
    }

    /// `Ad*_{τ(x)} m`, on the group alone, with `mean = (dR τ_x)* m`.
    fn carried(
        &self,
        retraction: Retraction,
        x: &Vector<'a>,
        m: &Vector<'a>,
        mean: &Vector<'a>,
    ) -> Vector<'a> {
        let [x, m, mean] = [x, m, mean].map(|base| self.0.on_the_group(base));
        self.0.system.group.carry_momentum(retraction, &x, &m, &mean).base
    }

    /// `m⁺` from `m⁻`; what nothing kicks stays as it is.
    fn kicked(&self, momentum: &Vector<'a>, kick: &Vector<'a>) -> Vector<'a> {
        let names = self.0.names.components("momentum_kicked");
        let rows = momentum.iter().zip(kick.iter()).zip(names);
        let kicked = rows.map(|((m, kick), name)| match kick.is_zero() {
            true => m,
            false => (m + kick).hold().named(name),
        });
        Vector(kicked.collect())
    }

    /// `m̄(η) = …`, both sides times the unknown's scale.
    fn equation(&self, x: &Vector<'a>, momentum: &Vector<'a>, right: Vector<'a>) -> Equation<'a> {
        let Discretization { system, names, step, .. } = &self.0;
        let solved = match &system.energy {
            Energy::Mechanical { inertia, .. } => {
                let y = inertia.solve_symmetric(&names.per_scale(&right)).scale(*step);
                Some(names.per_scale(&y))
            }
            _ => None,
        };
        Equation {
            left: names.times_scale(momentum),
            solved,
            ..self.0.explicit(x, right, names.per_scale(&self.start()))
        }
    }
}
