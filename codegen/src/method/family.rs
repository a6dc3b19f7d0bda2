//! The one family of steps.
//!
//! For a retraction `τ` and a parameter `s ∈ [0, 1]`, with `t` the step and the unknown `η = t ζ`, `ζ` the velocity:
//!
//! ```text
//! m⁻ = Ad*_{τ̄(sη)} m_k                                         carried to the intermediate point
//! ḡ  = g_k τ̄(sη)
//! m⁺ = m⁻ − t T*L_ḡ ∂h/∂g(ḡ, m̄) + t F(ḡ, m̄, u)                 the kick of a potential on the group and of forces
//! m̄  = (1−s) (dR τ_{(1−s)η})* m⁺ + s (dR τ̄_{sη})* m_k
//! η  = t ∂h/∂m(ḡ, m̄)                                           the equation to solve
//! m_{k+1} = Ad*_{τ((1−s)η)} m⁺,   g_{k+1} = ḡ τ((1−s)η)
//! ```
//!
//! on the dual `m = (μ, a)` of the semidirect algebra of the system's group; `s = 0` is the paper's (6.5), with forces
//! (6.20). It is the cotangent lift of `(ḡ, v) ↦ (ḡ τ(−sv), ḡ τ((1−s)v))`, with `τ̄(x) = τ(−x)⁻¹`: the second part of
//! `m̄`, by definition `s (dR τ_{−sη})* m⁻`, is that of `m_k`, for `dR τ̄_x = dL τ_{−x}`.
//!
//! Every member is symplectic, for a left-invariant system it keeps the Poisson bracket and all Casimirs, and its
//! adjoint is `1 − s`, for any `τ`: `s = ½` is symmetric and of order 2, others are of order 1. But where `τ` is a
//! [function of one matrix](crate::group::MatrixFunction), `τ̄ = τ`, and all members of a left-invariant system are
//! their own adjoints and of order 2.
//!
//! A right-invariant system, `g' = ζ g`, is by `γ = g⁻¹` a left-invariant one with the velocity `−ζ` and the momentum
//! `−m`: `η` changes its sign in all that is linear in `m`, increments stand on the other side of `g`, and `τ̄` carries
//! momenta where `τ` moves `g`.
//!
//! A Lagrangian `l` has `∂h/∂g = −∂l/∂g`, `∂h/∂a = −∂l/∂a` at the velocity `η/t`, and its equation to solve is the one
//! before that of `h` is inverted: `∂l/∂ξ(ḡ, η/t, ā) = μ̄`.
//!
//! Three facts shape what is emitted:
//!
//! * Where `τ` is equivariant, `Ad*_{τ(x)} m = m + ad*_x (dR τ_x)* m` for *any* `x`, so the update needs no rotation,
//!   reuses what the equation computed, and keeps the Casimirs whatever residual the solver leaves.
//! * `ā` depends on the group's part `y` of `η` alone. Where `h = ½ μ·𝕀⁻¹μ + V`, so does `v = ∂V/∂a(ā)`, and
//!   `μ̄ = 𝕀 y / t` in forces: the advected unknowns and `μ̄` are eliminated, and `dim g` equations `𝕀 y / t = μ̄(y)`
//!   remain. So it is with a Lagrangian. A Hamiltonian has `μ̄` as a second unknown, as far as
//!   [`presolve`](super::presolve) does not find it.
//! * Where the right side does not depend on the unknown, the step is explicit.

use super::discretization::{Discretization, Values, bind, values};
use super::names::symbols;
use super::presolve::{Equation, presolve};
use super::step::Step;
use crate::expr::{Arena, Vector, gradient, uncoupled};
use crate::group::{Retraction, SemidirectVector};
use crate::model::{Energy, Factor, Parts, System};
use crate::scheme::{Member, Method, Named};

/// The family of steps.
pub const METHOD: Method = Method {
    name: "Family",
    word: "family",
    about: "another member s of the family, from 0 to 1, where it was generated",
    doc: DOC,
    orders: &[],
    usual_order: None,
    named: &[
        Named {
            name: "SymplecticEulerA",
            word: "euler-a",
            about: "symplectic Euler, the paper's reduced step: order 2 where it is the standard, else 1",
            member: Member::SYMPLECTIC_EULER_A,
            doc: "The member `s = 0` of the [family](Family): for left-invariant systems the reduced step (6.5) of the paper.",
        },
        Named {
            name: "Midpoint",
            word: "midpoint",
            about: "the implicit midpoint step on the group, order 2",
            member: Member::MIDPOINT,
            doc: "The member `s = ½` of the [family](Family), symmetric and of order 2 for every system.",
        },
        Named {
            name: "SymplecticEulerB",
            word: "euler-b",
            about: "the adjoint of `euler-a`",
            member: Member::SYMPLECTIC_EULER_B,
            doc: "The member `s = 1` of the [family](Family), the adjoint of [`SymplecticEulerA`].",
        },
    ],
    bare: Some(Member::SYMPLECTIC_EULER_A),
    needs_momentum: None,
    is_symplectic: true,
    is_one_map: true,
};

const DOC: &str = "\
The member `s = N/D`, in lowest terms and from 0 to 1, of the family of one-step schemes with the retraction `R`.

The step's equation is set up at the point `s` of the way from its start to its end: with the step `h`, solve for `η`

```text
g_s = g_k τ(−sη)⁻¹
m   = Ad*_{τ(−sη)⁻¹} μ_k
μ_s = (1−s) (dR τ_{(1−s)η})* m + s (dR τ_{−sη})* m
η   = h ∂h/∂μ(μ_s)
```

and take `μ_{k+1} = Ad*_{τ((1−s)η)} m`, `g_{k+1} = g_s τ((1−s)η)`. A potential on the group, forces and explicit time act there
too: at `g_s` and the time `t_k + s h`, with the share `1 − s` before and `s` after.

- For left-invariant systems without forces, every member is a Poisson map and keeps the Casimirs, with any retraction. With
  [`Exponential`] and [`Cayley`](coadjoint::Cayley) it is symmetric and of order 2.
- With a potential on the group, every member is symplectic on `T*G`. Its adjoint, the inverse of the step `−h`, is the member
  `1 − s`: only `s = ½` is symmetric and of order 2, the others are of order 1. So it is with a
  retraction that is no function of one matrix, for left-invariant systems too.
- With forces no member is symplectic, nor is the motion; orders and adjoints are as with a potential.";

/// A member of the family for a system.
struct Family<'s, 'a>(Discretization<'s, 'a>);

/// The motion before the energy is known at the intermediate point: functions of `y` alone.
struct Motion<'a> {
    /// The unknown: symbols.
    x: Vector<'a>,
    /// The group's part of `η`.
    y: Vector<'a>,
    /// `(1−s) y`
    y_late: Vector<'a>,
    /// Stands for `μ̄` in the energy's derivatives, where they need it.
    mean: Vector<'a>,
    /// The mean of the advected parameters.
    a_bar: Vec<Vector<'a>>,
    /// `ḡ`
    g_bar: Vector<'a>,
}

/// The intermediate point.
struct Intermediate<'a> {
    /// `m̄` as the energy and the forces see it.
    momentum: Vector<'a>,
    /// What configurations, momenta, velocities, advected parameters and the time are there.
    values: Values<'a>,
}

/// The end of the step.
struct Update<'a> {
    /// `μ̄`, times the unknown's scale.
    scaled_mean: Vector<'a>,
    /// The state after the step.
    next: Parts<'a>,
}

/// The step of a member of the family.
pub fn step<'a>(arena: &'a Arena, system: &System<'a>, retraction: Retraction, member: Member) -> Step<'a> {
    let family = Family(Discretization::new(arena, system, retraction, member));
    let motion = family.motion();
    let intermediate = family.intermediate(&motion);
    let update = family.update(&motion, &intermediate);
    let presolved = presolve(family.equations(&motion, &update, &intermediate));
    family.0.lifted(presolved, &motion.y, &update.next)
}

impl<'a> Family<'_, 'a> {
    fn motion(&self) -> Motion<'a> {
        let Discretization { system, names, moving, carrying, early, late, .. } = &self.0;
        let (arena, group) = (early.arena(), &system.group);
        let (x, mean) = (symbols(arena, names.unknown()), symbols(arena, names.components("mu")));
        let y = self.0.names.times_scale(&x);
        let (y_early, y_late) = (y.scale(*early), y.scale(*late));

        let sign = arena.number(system.side.sign());
        let (x_early, x_late) = (y_early.scale(sign), y_late.scale(sign));
        let a = system.advected_values();
        let mean_minus = group.d_right_dual_spaces(carrying.before, &x_early, &a);
        let a_minus = group.carry_all(carrying.before, &x_early, &a, &mean_minus);
        let mean_plus = group.d_right_dual_spaces(carrying.behind, &x_late, &a_minus);
        let means = mean_plus.iter().zip(&mean_minus);
        let a_bar = means.map(|(plus, minus)| &plus.scale(*late) + &minus.scale(*early)).collect();

        let increment = names.group("increment_early", &group.retract(moving.before, &y_early).hold());
        let g_bar = group.compose(system.side, &system.configuration(), &increment).hold();
        let g_bar = names.configuration("mean", &g_bar);
        Motion { x, y, y_late, mean, a_bar, g_bar }
    }

    /// Everything that the energy and the forces are functions of.
    fn intermediate(&self, motion: &Motion<'a>) -> Intermediate<'a> {
        let Discretization { system, step, early, .. } = self.0;
        let velocity = motion.y.scale(step.recip());
        let later = step * early;

        let mut values = values(system, &motion.g_bar, &velocity, &motion.a_bar, later);
        let momentum = match &system.energy {
            Energy::Mechanical { inertia, .. } => inertia.scale(step.recip()).times(&motion.y),
            Energy::Hamiltonian(_) => motion.mean.clone(),
            Energy::Lagrangian(lagrangian) => {
                gradient(*lagrangian, &system.velocity_symbols().symbols()).substitute(&values)
            }
        };
        bind(&mut values, &system.momentum(), &momentum);
        Intermediate { momentum, values }
    }

    /// `m̄`, `m_{k+1}` and `g_{k+1}`.
    fn update(&self, motion: &Motion<'a>, intermediate: &Intermediate<'a>) -> Update<'a> {
        let Discretization { system, names, moving, carrying, early, late, .. } = &self.0;
        let (group, arena) = (&system.group, early.arena());
        let w = self.advected_velocity(intermediate);
        let kick = self.kick(intermediate);

        let eta = SemidirectVector { base: motion.y.clone(), spaces: w };
        let eta = eta.scale(arena.number(system.side.sign()));
        let (eta_early, eta_late) = (eta.scale(*early), eta.scale(*late));
        let m = system.momentum_and_advected();
        let mean_minus = self.0.names.keep_multiple(&group.d_right_dual(carrying.before, &eta_early, &m));
        let m_minus = group.carry_momentum(carrying.before, &eta_early, &m, &mean_minus);
        let m_plus = match kick {
            Some(kick) => {
                SemidirectVector { base: self.kicked(&m_minus.base, &kick), spaces: m_minus.spaces }
            }
            None => m_minus,
        };
        let mean_plus = self.0.names.keep_multiple(&group.d_right_dual(carrying.behind, &eta_late, &m_plus));
        let m_bar = mean_plus.scale(*late).plus(&mean_minus.scale(*early));
        let scaled_mean = self.0.names.times_scale(&m_bar.base).hold();
        let m_next = group.carry_momentum(carrying.behind, &eta_late, &m_plus, &mean_plus);

        // two increments, one of which is none where s is 0 or 1: only the exponential has τ(sη) τ((1−s)η) = τ(η)
        let moved = group.moved(system.side, moving.behind, &motion.g_bar, &motion.y_late);

        names.group("increment", &moved.increment);
        names.configuration("moved", &moved.moved);
        names.squares(&motion.x);
        names.multiple_of("momentum_mean", &scaled_mean);
        names.algebra("momentum_next", &m_next.base);
        names.advected("mean", &motion.a_bar);
        names.advected("next", &m_next.spaces);
        let next = Parts { configuration: moved.next, momentum: m_next.base, advected: m_next.spaces };
        Update { scaled_mean, next }
    }

    /// `w = t ∂h/∂a`, the advected part of `η`.
    fn advected_velocity(&self, there: &Intermediate<'a>) -> Vec<Vector<'a>> {
        let energy = self.0.system.potential();
        let w = self.0.system.advected().map(|a| {
            let gradient = gradient(energy, &a.value.symbols());
            gradient.substitute(&there.values).scale(self.0.step)
        });
        let w: Vec<_> = w.collect();
        self.0.names.advected("kick", &w);
        w
    }

    /// `−t T*L_ḡ ∂h/∂g + t F`, if anything but the bracket changes the momentum.
    fn kick(&self, there: &Intermediate<'a>) -> Option<Vector<'a>> {
        let kick = self.0.system.kick()?;
        let kick = kick.substitute(&there.values).scale(self.0.step).hold();
        Some(self.0.names.algebra("kick", &kick))
    }

    /// `m⁺` from `m⁻`; what nothing kicks stays as it is.
    fn kicked(&self, momentum: &Vector<'a>, kick: &Vector<'a>) -> Vector<'a> {
        let (system, names) = (self.0.system, self.0.names.components("momentum_kicked"));
        let mut kicked = momentum.clone();
        for (factor, place) in system.factors.iter().zip(system.group.places()) {
            for row in place.algebra.filter(|_| system.is_kicked(factor)) {
                kicked.0[row] = (kicked.0[row] + kick.0[row]).hold().named(names[row].as_str());
            }
        }
        kicked
    }

    /// The equations for all unknowns.
    fn equations(
        &self,
        motion: &Motion<'a>,
        update: &Update<'a>,
        intermediate: &Intermediate<'a>,
    ) -> Vec<Equation<'a>> {
        let Discretization { system, names, .. } = &self.0;
        match &system.energy {
            Energy::Hamiltonian(energy) => {
                let alone: Vec<Vec<usize>> = (0..system.factors.len()).map(|factor| vec![factor]).collect();
                let velocity = gradient(*energy, &system.momentum().symbols());
                let velocity = velocity.substitute(&intermediate.values).scale(self.0.step);
                // `μ̄ = …`, which is an unknown too, and `y = t ∂h/∂μ`
                let mean = self.0.names.per_scale(&update.scaled_mean);
                let mean = self.0.explicit(&motion.mean, mean, system.momentum());
                let mean = Equation { names: names.components("mu"), ..mean };
                let velocity = self.0.names.per_scale(&velocity);
                let velocity = self.0.explicit(&motion.x, velocity, self.0.names.per_scale(&self.0.start()));
                [mean, velocity].iter().flat_map(|equation| equation.apart(&system.group, &alone)).collect()
            }
            _ => {
                let equation = self.momentum_equation(motion, update, intermediate);
                for (left, name) in equation.left.iter().zip(names.unknown()) {
                    left.named(format!("inertia_{name}"));
                }
                equation.apart(&system.group, &coupled_factors(system))
            }
        }
    }

    /// `𝕀 y / t = μ̄`, or `∂l/∂ξ(y/t) = μ̄`, both sides times the unknown's scale.
    fn momentum_equation(
        &self,
        motion: &Motion<'a>,
        update: &Update<'a>,
        intermediate: &Intermediate<'a>,
    ) -> Equation<'a> {
        let right = update.scaled_mean.clone();
        let solved = match &self.0.system.energy {
            Energy::Mechanical { inertia, .. } => {
                Some(inertia.solve_symmetric(&self.0.names.per_scale(&right)).scale(self.0.step))
            }
            _ => None,
        };
        Equation {
            left: self.0.names.times_scale(&intermediate.momentum),
            solved: solved.map(|solved| self.0.names.per_scale(&solved)),
            ..self.0.explicit(&motion.x, right, self.0.names.per_scale(&self.0.start()))
        }
    }
}

/// The factors in sets whose momenta depend on the velocities of each other.
fn coupled_factors(system: &System<'_>) -> Vec<Vec<usize>> {
    let coupled: Vec<Vec<usize>> = match &system.energy {
        Energy::Lagrangian(lagrangian) => {
            let depends = |on: &Factor<'_>, momentum: &Vector<'_>| {
                let velocity = on.velocity.symbols();
                momentum.depends_on(&velocity)
            };
            let momenta = system.factors.iter();
            let momenta = momenta.map(|factor| gradient(*lagrangian, &factor.velocity.symbols()));
            let with = |(place, momentum): (usize, Vector<'_>)| {
                let others = system.factors.iter().enumerate();
                let others = others.filter(|(other, factor)| *other == place || depends(factor, &momentum));
                others.map(|(other, _)| other).collect()
            };
            momenta.enumerate().map(with).collect()
        }
        _ => system.inertias.iter().flat_map(|field| field.described.blocks.clone()).collect(),
    };
    uncoupled(system.factors.len(), |i, j| coupled.iter().any(|set| set.contains(&i) && set.contains(&j)))
}
