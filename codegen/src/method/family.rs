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
//! on the dual `m = (μ, a)` of the semidirect algebra of each factor; `s = 0` is the paper's (6.5), with forces (6.20). Factors
//! meet in the energy and the forces alone. It is the cotangent lift of `(ḡ, v) ↦ (ḡ τ(−sv), ḡ τ((1−s)v))`, with `τ̄(x) = τ(−x)⁻¹`: the
//! second part of `m̄`, by definition `s (dR τ_{−sη})* m⁻`, is that of `m_k`, for `dR τ̄_x = dL τ_{−x}`.
//!
//! Every member is symplectic, for a left-invariant system it keeps the Poisson bracket and all Casimirs, and its adjoint is `1 − s`, for
//! any `τ`: `s = ½` is symmetric and of order 2, others are of order 1. But where `τ` is a [function of one
//! matrix](crate::group::MatrixFunction), `τ̄ = τ`, and all members of a left-invariant system are their own adjoints and of order 2.
//!
//! A right-invariant system, `g' = ζ g`, is by `γ = g⁻¹` a left-invariant one with the velocity `−ζ` and the momentum `−m`: `η` changes
//! its sign in all that is linear in `m`, increments stand on the other side of `g`, and `τ̄` carries momenta where `τ` moves `g`.
//!
//! A Lagrangian `l` has `∂h/∂g = −∂l/∂g`, `∂h/∂a = −∂l/∂a` at the velocity `η/t`, and its equation to solve is the one before that of `h`
//! is inverted: `∂l/∂ξ(ḡ, η/t, ā) = μ̄`.
//!
//! Three facts shape what is emitted:
//!
//! * Where `τ` is equivariant, `Ad*_{τ(x)} m = m + ad*_x (dR τ_x)* m` for *any* `x`, so the update needs no rotation, reuses what the
//!   equation computed, and keeps the Casimirs whatever residual the solver leaves.
//! * `ā` depends on the group's part `y` of `η` alone. Where `h = ½ μ·𝕀⁻¹μ + V`, so does `v = ∂V/∂a(ā)`, and `μ̄ = 𝕀 y / t` in
//!   forces: the advected unknowns and `μ̄` are eliminated, and `dim g` equations `𝕀 y / t = μ̄(y)` remain. So it is with a Lagrangian.
//!   A Hamiltonian has `μ̄` as a second unknown, as far as [`presolve`](super::presolve) does not find it.
//! * Where the right side does not depend on the unknown, the step is explicit.

use super::discretization::{Discretization, Path};
use super::names::ValueNames;
use super::presolve::{Equation, presolve};
use super::{Increment, Step};
use crate::expr::{Arena, Expr, Number, Stage, Symbol, Vector, gradient};
use crate::group::{Retraction, SemidirectVector};
use crate::model::{Energy, Factor, FactorPart, Relation, Slot, System};
use crate::scheme::Member;

/// A member of the family for a system.
struct Family<'s, 'a> {
    system: &'s System<'a>,
    map: Discretization<'a>,
}

/// What a factor's part of the step is made of before the energy is known at the intermediate point: functions of `y` alone.
struct Motion<'s, 'a> {
    factor: &'s Factor<'a>,
    names: ValueNames<'s, 'a>,
    /// The number `k` for which the unknown is `y/k`.
    unknown_scale: Expr<'a>,
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

/// The intermediate point, for all factors together.
struct Intermediate<'a> {
    /// `m̄` as the energy and the forces see it.
    momentum: Vector<'a>,
    /// What configurations, momenta, velocities, advected parameters and the time are there.
    values: Vec<(Symbol, Expr<'a>)>,
}

/// What a factor's part of the step comes to.
struct Arrival<'a> {
    /// `μ̄`, times the unknown's scale.
    scaled_mean: Vector<'a>,
    /// The state after the step.
    next: FactorPart<'a>,
}

/// The step of a member of the family.
pub fn step<'a>(arena: &'a Arena, system: &System<'a>, retraction: Retraction, member: Member) -> Step<'a> {
    let family = Family { system, map: Discretization::new(arena, system, retraction, member) };
    let motions: Vec<Motion<'_, 'a>> =
        system.factors.iter().map(|factor| Motion::new(&family, factor)).collect();
    let intermediate = family.intermediate(&motions);
    let arrivals: Vec<Arrival<'a>> =
        motions.iter().map(|motion| family.arrival(motion, &intermediate)).collect();
    let presolved = presolve(family.equations(&motions, &arrivals, &intermediate));
    let paths: Vec<Path<'_, 'a>> = motions.iter().map(Motion::path).collect();
    let next: Vec<FactorPart<'a>> = arrivals.into_iter().map(|arrival| arrival.next).collect();
    family.map.lifted(system, presolved, &paths, &next)
}

impl<'s, 'a> Motion<'s, 'a> {
    fn new(family: &Family<'_, 'a>, factor: &'s Factor<'a>) -> Self {
        let Family { system, map: Discretization { moving, carrying, early, late, .. } } = *family;
        let (arena, algebra) = (early.arena(), &factor.algebra);
        let group = algebra.group;
        let scale = group.unknown_scale(moving.behind);
        let names = ValueNames::new(system, factor, scale);
        let (x, mean) = (names.symbols(arena, names.unknown()), names.symbols(arena, "mu"));
        let unknown_scale = arena.number(Number::ratio(scale, 1));
        let y = x.scale(unknown_scale);
        let (y_early, y_late) = (y.scale(early), y.scale(late));

        let sign = arena.number(system.side.sign());
        let (x_early, x_late) = (y_early.scale(sign), y_late.scale(sign));
        let a = factor.advected_values();
        let mean_minus = algebra.d_right_dual_spaces(carrying.before, &x_early, &a);
        let a_minus = algebra.carry_all(carrying.before, &x_early, &a, &mean_minus);
        let mean_plus = algebra.d_right_dual_spaces(carrying.behind, &x_late, &a_minus);
        let means = mean_plus.iter().zip(&mean_minus);
        let a_bar = means.map(|(plus, minus)| &plus.scale(late) + &minus.scale(early)).collect();

        let increment = names.group("increment_early", &group.retract(moving.before, &y_early).hold());
        let g_bar = system.side.compose(group, &factor.configuration, &increment).hold();
        let g_bar = names.configuration("mean", &g_bar);
        Self { factor, names, unknown_scale, x, y, y_late, mean, a_bar, g_bar }
    }

    /// The same values, kept whole as multiples by the unknown's scale: what is made of the unknown and multiplied by it again has that
    /// factor.
    fn keep_multiple(&self, element: &SemidirectVector<'a>) -> SemidirectVector<'a> {
        element.scale(self.unknown_scale).hold().scale(self.unknown_scale.recip())
    }

    /// `μ̄ = …` for a general energy, which has `μ̄` as an unknown.
    fn mean_equation(&self, arrival: &Arrival<'a>) -> Equation<'a> {
        let mean = arrival.scaled_mean.scale(self.unknown_scale.recip());
        Equation {
            unknown: self.mean.clone(),
            blocks: self.factor.algebra.group.blocks(),
            left: self.mean.clone(),
            right: mean.clone(),
            solved: Some(mean),
            start: self.factor.momentum.clone(),
            names: self.names.components("mu"),
        }
    }

    /// `y = t ∂h/∂μ` for a general energy.
    fn velocity_equation(&self, velocity: &Vector<'a>, start: &Vector<'a>) -> Equation<'a> {
        let scaled = |vector: &Vector<'a>| vector.scale(self.unknown_scale.recip());
        let right = scaled(velocity);
        Equation {
            unknown: self.x.clone(),
            blocks: self.factor.algebra.group.blocks(),
            left: self.x.clone(),
            right: right.clone(),
            solved: Some(right),
            start: scaled(start),
            names: self.names.components(self.names.unknown()),
        }
    }

    /// The way of its configuration.
    fn path(&self) -> Path<'s, 'a> {
        Path { factor: self.factor, middle: self.g_bar.clone(), y: self.y.clone() }
    }
}

impl<'a> Family<'_, 'a> {
    /// Everything that the energy and the forces are functions of.
    fn intermediate(&self, motions: &[Motion<'_, 'a>]) -> Intermediate<'a> {
        let Self { system, map: Discretization { step, early, .. } } = *self;
        let y = Vector::concat(motions.iter().map(|motion| &motion.y));
        let velocity = y.scale(step.recip());
        let later = step * early;

        let mut values = Vec::new();
        let mut is = |what: &Vector<'a>, value: &Vector<'a>| {
            values.extend(what.symbols().into_iter().zip(value.iter()));
        };
        for (motion, velocity) in motions.iter().zip(&system.split_momentum(&velocity)) {
            let factor = motion.factor;
            is(&factor.configuration, &motion.g_bar);
            is(&factor.velocity, velocity);
            for (advected, mean) in factor.advected.iter().zip(&motion.a_bar) {
                is(&advected.value, mean);
            }
        }
        is(&Vector(vec![system.time]), &Vector(vec![system.time + later]));
        let momentum = match &system.energy {
            Energy::Mechanical { inertia, .. } => inertia.scale(step.recip()).times(&y),
            Energy::Hamiltonian(_) => Vector::concat(motions.iter().map(|motion| &motion.mean)),
            Energy::Lagrangian(lagrangian) => {
                gradient(*lagrangian, &system.velocity_symbols().symbols()).substitute(&values)
            }
        };
        values.extend(system.momentum().symbols().into_iter().zip(momentum.iter()));
        Intermediate { momentum, values }
    }

    /// `m̄`, `m_{k+1}` and `g_{k+1}` of a factor.
    fn arrival(&self, motion: &Motion<'_, 'a>, intermediate: &Intermediate<'a>) -> Arrival<'a> {
        let Self { system, map: Discretization { moving, carrying, early, late, .. } } = *self;
        let Motion { factor, names, y, .. } = motion;
        let (algebra, arena) = (&factor.algebra, early.arena());
        let w = self.advected_velocity(motion, intermediate);
        let kick = self.kick(motion, intermediate);

        let eta = SemidirectVector { base: y.clone(), spaces: w }.scale(arena.number(system.side.sign()));
        let (eta_early, eta_late) = (eta.scale(early), eta.scale(late));
        let m = factor.momentum_and_advected();
        let mean_minus = motion.keep_multiple(&algebra.d_right_dual(carrying.before, &eta_early, &m));
        let m_minus = algebra.carry_momentum(carrying.before, &eta_early, &m, &mean_minus);
        let m_plus = match kick {
            Some(kick) => SemidirectVector {
                base: names.algebra("momentum_kicked", &(&m_minus.base + &kick).hold()),
                spaces: m_minus.spaces,
            },
            None => m_minus,
        };
        let mean_plus = motion.keep_multiple(&algebra.d_right_dual(carrying.behind, &eta_late, &m_plus));
        let m_bar = mean_plus.scale(late).plus(&mean_minus.scale(early));
        let scaled_mean = m_bar.scale(motion.unknown_scale).hold().base;
        let m_next = algebra.carry_momentum(carrying.behind, &eta_late, &m_plus, &mean_plus);

        // two increments, one of which is none where s is 0 or 1: only the exponential has τ(sη) τ((1−s)η) = τ(η)
        let moved = algebra.group.moved(system.side, moving.behind, &motion.g_bar, &motion.y_late);

        names.group("increment", &moved.increment);
        names.configuration("moved", &moved.moved);
        names.scalar(&format!("{}_squared", names.unknown()), motion.x.dot(&motion.x));
        names.multiple_of("momentum_mean", &scaled_mean);
        names.algebra("momentum_next", &m_next.base);
        names.advected("mean", &motion.a_bar);
        names.advected("next", &m_next.spaces);
        let next = FactorPart { configuration: moved.next, momentum: m_next.base, advected: m_next.spaces };
        Arrival { scaled_mean, next }
    }

    /// `w = t ∂h/∂a`, the advected part of `η`.
    fn advected_velocity(&self, motion: &Motion<'_, 'a>, there: &Intermediate<'a>) -> Vec<Vector<'a>> {
        let energy = self.system.potential();
        let w = motion.factor.advected.iter().map(|a| {
            let gradient = gradient(energy, &a.value.symbols());
            gradient.substitute(&there.values).scale(self.map.step)
        });
        let w: Vec<_> = w.collect();
        motion.names.advected("kick", &w);
        w
    }

    /// `−t T*L_ḡ ∂h/∂g + t F`, if anything but the bracket changes the momentum.
    fn kick(&self, motion: &Motion<'_, 'a>, there: &Intermediate<'a>) -> Option<Vector<'a>> {
        let kick = self.system.kick(motion.factor)?;
        let kick = kick.substitute(&there.values).scale(self.map.step).hold();
        Some(motion.names.algebra("kick", &kick))
    }

    /// The equations for all unknowns.
    fn equations(
        &self,
        motions: &[Motion<'_, 'a>],
        arrivals: &[Arrival<'a>],
        intermediate: &Intermediate<'a>,
    ) -> Vec<Equation<'a>> {
        let system = self.system;
        let start = system.split_momentum(&self.start());
        let Energy::Hamiltonian(energy) = &system.energy else {
            let momenta = system.split_momentum(&intermediate.momentum);
            let sets = coupled_factors(system).into_iter();
            let equation =
                |set: Vec<usize>| self.momentum_equation(&set, motions, arrivals, &momenta, &start);
            return sets.map(equation).collect();
        };
        let velocity = gradient(*energy, &system.momentum().symbols());
        let velocity = velocity.substitute(&intermediate.values).scale(self.map.step);
        let velocities = system.split_momentum(&velocity);
        let means = motions.iter().zip(arrivals).map(|(motion, arrival)| motion.mean_equation(arrival));
        let means: Vec<Equation<'a>> = means.collect();
        let velocities = motions
            .iter()
            .zip(velocities.iter().zip(&start))
            .map(|(motion, (velocity, start))| motion.velocity_equation(velocity, start));
        means.into_iter().chain(velocities).collect()
    }

    /// A first approximation of `y`: `t ξ_k`, or rest where no closed form gives the velocity.
    fn start(&self) -> Vector<'a> {
        match self.system.velocity_relation() {
            Relation::Explicit(velocity) => velocity.scale(self.map.step),
            Relation::Implicit(_) | Relation::Singular => {
                Vector::zeros(self.map.step.arena(), self.system.dimension())
            }
        }
    }

    /// `𝕀 y / t = μ̄`, or `∂l/∂ξ(y/t) = μ̄`, for a set of factors that the kinetic energy couples; both sides times the unknown's scale.
    fn momentum_equation(
        &self,
        set: &[usize],
        motions: &[Motion<'_, 'a>],
        arrivals: &[Arrival<'a>],
        momenta: &[Vector<'a>],
        start: &[Vector<'a>],
    ) -> Equation<'a> {
        let motions = || set.iter().map(|&factor| &motions[factor]);
        let scales = motions().flat_map(|motion| vec![motion.unknown_scale; motion.x.len()]);
        let scales: Vec<Expr<'a>> = scales.collect();
        let times = |of: &Vector<'a>| Vector(of.iter().zip(&scales).map(|(x, &scale)| x * scale).collect());
        let per = |of: &Vector<'a>| Vector(of.iter().zip(&scales).map(|(x, &scale)| x / scale).collect());
        let of_set = |of: &[Vector<'a>]| Vector::concat(set.iter().map(|&factor| &of[factor]));

        let right = Vector::concat(set.iter().map(|&factor| &arrivals[factor].scaled_mean));
        let names: Vec<String> =
            motions().flat_map(|motion| motion.names.components(motion.names.unknown())).collect();
        let rows: Vec<usize> = set.iter().flat_map(|&factor| self.system.momentum_range(factor)).collect();
        let solved = match &self.system.energy {
            Energy::Mechanical { inertia, .. } => {
                Some(inertia.block(&rows).solve_symmetric(&per(&right)).scale(self.map.step))
            }
            _ => None,
        };
        let left = times(&of_set(momenta));
        for (left, name) in left.iter().zip(&names) {
            left.named(format!("inertia_{name}"));
        }
        Equation {
            unknown: Vector::concat(motions().map(|motion| &motion.x)),
            blocks: motions().flat_map(|motion| motion.factor.algebra.group.blocks()).collect(),
            left,
            solved: solved.map(|solved| per(&solved)),
            right,
            start: per(&of_set(start)),
            names,
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
        _ => system.inertias.iter().flat_map(|field| field.blocks.clone()).collect(),
    };
    let mut sets: Vec<Vec<usize>> = (0..system.factors.len()).map(|factor| vec![factor]).collect();
    for block in coupled {
        let is_touched = |set: &Vec<usize>| set.iter().any(|factor| block.contains(factor));
        let (touched, mut apart): (Vec<_>, Vec<_>) = sets.into_iter().partition(is_touched);
        let mut joined = touched.concat();
        joined.sort_unstable();
        apart.push(joined);
        sets = apart;
    }
    sets.sort_unstable();
    sets
}

/// What of the state is bounded if the unknown is: the rotations that the unknown moves, not what is known before.
pub(super) fn bounded(system: &System<'_>, increments: &[Vec<Increment<'_>>]) -> Vec<bool> {
    let mut bounded = Vec::new();
    for slot in system.slots() {
        let length = slot.of(&system.state()).len();
        let rotation = match slot {
            Slot::Configuration(factor) => {
                let mut by = increments[factor].iter().flat_map(|increment| increment.by.iter());
                let unknown = by.all(|x| x.stage() >= Stage::Iteration);
                if unknown { system.factors[factor].algebra.group.unit_coordinates() } else { 0 }
            }
            Slot::Momentum(_) | Slot::Advected { .. } => 0,
        };
        bounded.extend((0..length).map(|i| i < rotation));
    }
    bounded
}
