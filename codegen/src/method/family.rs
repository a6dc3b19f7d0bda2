//! The one family of steps.
//!
//! For a retraction `τ` and a parameter `s ∈ [0, 1]`, with `t` the step and the unknown `η = t ζ`, `ζ` the velocity:
//!
//! ```text
//! m⁻ = Ad*_{τ(sη)} m_k                                         carried to the intermediate point
//! ḡ  = g_k τ(sη)
//! m⁺ = m⁻ − t T*L_ḡ ∂h/∂g(ḡ, m̄) + t F(ḡ, m̄, u)                 the kick of a potential on the group and of forces
//! m̄  = (1−s) (dR τ_{(1−s)η})* m⁺ + s (dR τ_{−sη})* m⁻
//! η  = t ∂h/∂m(ḡ, m̄)                                           the equation to solve
//! m_{k+1} = Ad*_{τ((1−s)η)} m⁺,   g_{k+1} = ḡ τ((1−s)η)
//! ```
//!
//! on the dual `m = (μ, a)` of the semidirect algebra of each factor; `s = 0` is the paper's (6.5), with forces (6.20). Factors
//! meet in the energy and the forces alone. For a left-invariant system every member keeps the Poisson bracket and all
//! Casimirs, is its own adjoint, and has order 2; with a potential on the group every member is symplectic, the adjoint of `s` is
//! `1 − s`, and the order is 1 but for `s = ½`.
//!
//! A right-invariant system, `g' = ζ g`, is by `γ = g⁻¹` a left-invariant one with the velocity `−ζ` and the momentum `−m`: `η` changes
//! its sign in all that is linear in `m`, and turns stand on the other side of `g`.
//!
//! Four facts shape what is emitted:
//!
//! * `(dR τ_{−x})* Ad*_{τ(x)} m = (dR τ_x)* m`, so that the second part of `m̄` is `s (dR τ_{sη})* m_k`.
//! * `Ad*_{τ(x)} m = m + ad*_x (dR τ_x)* m` for *any* `x`, so the update needs no rotation, reuses what the equation computed,
//!   and keeps the Casimirs whatever residual the solver leaves.
//! * `ā` depends on the group's part `y` of `η` alone. Where `h = ½ μ·𝕀⁻¹μ + V`, so does `v = ∂V/∂a(ā)`, and `μ̄ = 𝕀 y / t` in
//!   forces: the advected unknowns and `μ̄` are eliminated, and `dim g` equations `𝕀 y / t = μ̄(y)` remain. Any other energy has
//!   `μ̄` as a second unknown, as far as [`elimination`](super::elimination) does not find it.
//! * Where the right side does not depend on the unknown, the step is explicit.

use super::elimination::{Eliminated, Equation, eliminate};
use super::{Step, Turn, step_symbol};
use crate::expr::{Arena, Expr, Number, Stage, Symbol, Vector, gradient};
use crate::group::{Element, Retraction};
use crate::identifiers::plain;
use crate::model::{Factor, Hamiltonian, System};
use crate::scheme::Member;

/// What a factor's part of the step is made of before the energy is known at the intermediate point: functions of `y` alone.
struct Motion<'a> {
    /// What names of its values begin with.
    prefix: String,
    /// What the unknown is called.
    name: &'static str,
    /// What the name of a value begins with that has the unit for a factor.
    times: &'static str,
    /// What it is counted in.
    unit: Expr<'a>,
    /// The unknown, `y` in these units: symbols.
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

/// The step of a member of the family.
pub fn step<'a>(arena: &'a Arena, system: &System<'a>, retraction: Retraction, member: Member) -> Step<'a> {
    let s = member.s();
    let t = step_symbol(arena);
    let (early, late) = (arena.number(s), arena.number(Number::ONE + -s));

    let motions: Vec<Motion<'a>> =
        system.factors.iter().map(|factor| Motion::new(system, factor, retraction, early, late)).collect();
    let y = Vector(motions.iter().flat_map(|motion| motion.y.0.clone()).collect());
    // what is made of the unknown and multiplied by it again has its factor
    let doubled = |element: Element<'a>, unit: Expr<'a>| element.scale(unit).hold().scale(unit.recip());

    // everything that the energy and the forces are functions of, at the intermediate point
    let momentum_mean = match &system.hamiltonian {
        Hamiltonian::Mechanical { inertia, .. } => inertia.scale(t.recip()).times(&y),
        Hamiltonian::General(_) => Vector(motions.iter().flat_map(|motion| motion.mean.0.clone()).collect()),
    };
    let velocity = y.scale(t.recip());
    let intermediate = at_intermediate_point(system, &motions, &momentum_mean, &velocity, t * early);
    let energy = system.potential();

    let mut rights = Vec::new();
    let mut nexts = Vec::new();
    for (factor, motion) in system.factors.iter().zip(&motions) {
        let Motion { prefix, unit, x, y, y_late, .. } = motion;
        let algebra = &factor.algebra;
        let axes = algebra.group.axes();
        let w: Vec<Vector<'a>> = factor
            .advected
            .iter()
            .map(|a| gradient(energy, &a.value.symbols()).substitute(&intermediate).scale(t))
            .collect();
        for ((advected, space), w) in factor.advected.iter().zip(&algebra.spaces).zip(&w) {
            w.named(&format!("{}_kick", advected.name), space.coordinates());
        }
        let kick = system
            .kick(factor)
            .map(|kick| kick.substitute(&intermediate).scale(t).hold().named(&format!("{prefix}kick"), axes));

        let eta = Element { base: y.clone(), spaces: w }.scale(arena.number(system.side.sign()));
        let (eta_early, eta_late) = (eta.scale(early), eta.scale(late));
        let m = Element {
            base: factor.momentum.clone(),
            spaces: factor.advected.iter().map(|a| a.value.clone()).collect(),
        };
        let before = doubled(algebra.d_right_dual(retraction, &eta_early, &m), *unit);
        let m_minus = m.plus(&algebra.coadjoint(&eta_early, &before));
        let m_plus = match kick {
            Some(kick) => Element {
                base: (&m_minus.base + &kick).hold().named(&format!("{prefix}momentum_kicked"), axes),
                spaces: m_minus.spaces.clone(),
            },
            None => m_minus.clone(),
        };
        let after = doubled(algebra.d_right_dual(retraction, &eta_late, &m_plus), *unit);
        // in the equation it has the factor, too
        let m_bar = after.scale(late).plus(&before.scale(early)).scale(*unit).hold();
        let m_next = m_plus.plus(&algebra.coadjoint(&eta_late, &after));

        // two turns, one of which is none where s is 0 or 1: only the exponential has τ(sη) τ((1−s)η) = τ(η)
        let moved = algebra.group.moved(system.side, retraction, &motion.g_bar, y_late);
        moved.turn.named(&format!("{prefix}turn"), algebra.group.coordinates());
        moved.moved.named(&format!("{}_moved", plain(&factor.name)), algebra.group.coordinates());
        let g_next = moved.next;

        x.dot(x).named(format!("{prefix}{}_squared", motion.name));
        m_bar.base.named(&format!("{prefix}{}momentum_mean", motion.times), axes);
        m_next.base.named(&format!("{prefix}momentum_next"), axes);
        for ((advected, space), (mean, next)) in
            factor.advected.iter().zip(&algebra.spaces).zip(motion.a_bar.iter().zip(&m_next.spaces))
        {
            mean.named(&format!("{}_mean", advected.name), space.coordinates());
            next.named(&format!("{}_next", advected.name), space.coordinates());
        }
        rights.push(m_bar.base.clone());
        nexts.push((factor, g_next, m_next));
    }

    let equations = equations(system, &motions, &rights, &momentum_mean, &intermediate, t);
    let Eliminated { equations, found } = eliminate(equations);
    let settled = |vector: &Vector<'a>| vector.substitute(&found);
    let join = |part: for<'e> fn(&'e Equation<'a>) -> &'e Vector<'a>| {
        Vector(equations.iter().flat_map(|equation| part(equation).0.clone()).collect())
    };

    let turns = system.factors.iter().zip(&motions).map(|(factor, motion)| {
        let first = (factor.configuration.clone(), motion.y.scale(early));
        let second = (motion.g_bar.clone(), motion.y_late.clone());
        let turns = [(early, first), (late, second)].into_iter().filter(|(share, _)| !share.is_zero());
        turns.map(|(_, (from, by))| Turn { from: settled(&from), by: settled(&by) }).collect()
    });
    let turns: Vec<Vec<Turn<'a>>> = turns.collect();
    let turned = system.factors.iter().zip(&turns).filter(|(_, turns)| {
        // by the unknown, not by what is known before
        turns.iter().flat_map(|turn| turn.by.iter()).all(|x| x.stage() >= Stage::Iteration)
    });
    let unit: Vec<Symbol> = turned
        .flat_map(|(factor, _)| {
            factor.configuration.symbols().into_iter().take(factor.algebra.group.unit_coordinates())
        })
        .collect();
    let edge = if early.as_number() > late.as_number() { early } else { late };
    let domain = motions.iter().zip(&system.factors).filter_map(|(motion, factor)| {
        let margin = factor.algebra.group.domain(retraction, &motion.y.scale(edge))?;
        Some(margin.substitute(&found))
    });
    Step {
        h: t,
        given: [system.time_symbol(), system.control_symbols()].concat(),
        domain: domain.collect(),
        turns,
        unknown: join(|equation| &equation.unknown),
        blocks: equations.iter().flat_map(|equation| equation.blocks.clone()).collect(),
        start: join(|equation| &equation.start),
        left: join(|equation| &equation.left),
        right: join(|equation| &equation.right),
        next: settled(&in_order(system, &nexts)),
        bounded: system.state_symbols().iter().map(|symbol| unit.contains(symbol)).collect(),
    }
}

impl<'a> Motion<'a> {
    fn new(
        system: &System<'a>,
        factor: &Factor<'a>,
        retraction: Retraction,
        early: Expr<'a>,
        late: Expr<'a>,
    ) -> Self {
        let arena = early.arena();
        let algebra = &factor.algebra;
        let group = algebra.group;
        let prefix = match system.factors.len() {
            1 => String::new(),
            _ => format!("{}_", plain(&factor.name)),
        };
        let symbols = |name: &str| {
            let symbol = |axis: &&str| arena.symbol(format!("{prefix}{name}_{axis}"), Stage::Iteration);
            Vector(group.axes().iter().map(symbol).collect())
        };
        let unit = group.unit(retraction);
        let (name, times) = match unit {
            1 => ("eta", ""),
            2 => ("half_eta", "twice_"),
            _ => ("quarter_eta", "four_times_"),
        };
        let (x, mean) = (symbols(name), symbols("mu"));
        let unit = arena.number(Number::ratio(unit, 1));
        let y = x.scale(unit);
        let sign = arena.number(system.side.sign());
        let (y_early, y_late) = (y.scale(early), y.scale(late));
        let (x_early, x_late) = (y_early.scale(sign), y_late.scale(sign));
        let a: Vec<Vector<'a>> = factor.advected.iter().map(|a| a.value.clone()).collect();
        let before = algebra.d_right_dual_spaces(retraction, &x_early, &a);
        let a_minus: Vec<_> = {
            let change = algebra.coadjoint_spaces(&x_early, &before);
            a.iter().zip(&change).map(|(a, change)| a + change).collect()
        };
        let after = algebra.d_right_dual_spaces(retraction, &x_late, &a_minus);
        let a_bar = after
            .iter()
            .zip(&before)
            .map(|(after, before)| &after.scale(late) + &before.scale(early))
            .collect();
        let turn = group.retract(retraction, &y_early).hold();
        let turn = turn.named(&format!("{prefix}turn_early"), group.coordinates());
        let g_bar = system.side.compose(group, &factor.configuration, &turn).hold();
        let g_bar = g_bar.named(&format!("{}_mean", plain(&factor.name)), group.coordinates());
        Self { prefix, name, times, unit, x, y, y_late, mean, a_bar, g_bar }
    }
}

/// What configurations, momenta, velocities, advected parameters and the time are at the intermediate point.
fn at_intermediate_point<'a>(
    system: &System<'a>,
    motions: &[Motion<'a>],
    momentum: &Vector<'a>,
    velocity: &Vector<'a>,
    later: Expr<'a>,
) -> Vec<(Symbol, Expr<'a>)> {
    let mut there = Vec::new();
    let mut is = |what: &Vector<'a>, value: &mut dyn Iterator<Item = Expr<'a>>| {
        there.extend(what.symbols().into_iter().zip(value));
    };
    let (mut momentum, mut velocity) = (momentum.iter(), velocity.iter());
    for (factor, motion) in system.factors.iter().zip(motions) {
        let n = factor.momentum.len();
        is(&factor.configuration, &mut motion.g_bar.iter());
        is(&factor.momentum, &mut momentum.by_ref().take(n));
        is(&factor.velocity, &mut velocity.by_ref().take(n));
        for (advected, mean) in factor.advected.iter().zip(&motion.a_bar) {
            is(&advected.value, &mut mean.iter());
        }
    }
    is(&Vector(vec![system.time]), &mut std::iter::once(system.time + later));
    there
}

/// `𝕀 y / t = μ̄` for each block of factors that an inertia couples; or `y = t ∂h/∂μ` and `μ̄ = …`.
fn equations<'a>(
    system: &System<'a>,
    motions: &[Motion<'a>],
    rights: &[Vector<'a>],
    momentum_mean: &Vector<'a>,
    intermediate: &[(Symbol, Expr<'a>)],
    t: Expr<'a>,
) -> Vec<Equation<'a>> {
    let names = |motion: &Motion<'a>, what: &str, factor: &Factor<'a>| -> Vec<String> {
        let axes = factor.algebra.group.axes().iter();
        axes.map(|axis| format!("{}{what}_{axis}", motion.prefix)).collect()
    };
    let velocity = system.velocity(&system.momentum()).scale(t);
    let offsets: Vec<usize> = system
        .factors
        .iter()
        .scan(0, |offset, factor| {
            let here = *offset;
            *offset += factor.momentum.len();
            Some(here)
        })
        .collect();
    let slice = |vector: &Vector<'a>, factor: usize| {
        let from = offsets[factor];
        vector.0[from..from + system.factors[factor].momentum.len()].to_vec()
    };
    let collect = |factors: &[usize], part: &dyn Fn(usize) -> Vec<Expr<'a>>| {
        Vector(factors.iter().flat_map(|&factor| part(factor)).collect())
    };

    let inertia = match &system.hamiltonian {
        Hamiltonian::Mechanical { inertia, .. } => inertia,
        Hamiltonian::General(energy) => {
            let gradient = gradient(*energy, &system.momentum().symbols()).substitute(intermediate).scale(t);
            let mut equations = Vec::new();
            for (f, (factor, motion)) in system.factors.iter().zip(motions).enumerate() {
                let mean = rights[f].scale(motion.unit.recip());
                equations.push(Equation {
                    unknown: motion.mean.clone(),
                    blocks: factor.algebra.group.blocks(),
                    left: motion.mean.clone(),
                    right: mean.clone(),
                    solved: mean,
                    start: factor.momentum.clone(),
                    names: names(motion, "mu", factor),
                });
            }
            for (f, (factor, motion)) in system.factors.iter().zip(motions).enumerate() {
                let in_units = |of: &Vector<'a>| Vector(slice(of, f)).scale(motion.unit.recip());
                let right = in_units(&gradient);
                equations.push(Equation {
                    unknown: motion.x.clone(),
                    blocks: factor.algebra.group.blocks(),
                    left: motion.x.clone(),
                    right: right.clone(),
                    solved: right,
                    start: in_units(&velocity),
                    names: names(motion, motion.name, factor),
                });
            }
            return equations;
        }
    };
    blocks(system)
        .into_iter()
        .map(|block| {
            let rows: Vec<usize> = block
                .iter()
                .flat_map(|&f| offsets[f]..offsets[f] + system.factors[f].momentum.len())
                .collect();
            let right = collect(&block, &|f| rights[f].0.clone());
            let names: Vec<String> =
                block.iter().flat_map(|&f| names(&motions[f], motions[f].name, &system.factors[f])).collect();
            let left = collect(&block, &|f| slice(momentum_mean, f));
            let units = collect(&block, &|f| vec![motions[f].unit; motions[f].x.len()]);
            let times =
                |of: &Vector<'a>| Vector(of.iter().zip(units.iter()).map(|(x, unit)| x * unit).collect());
            let per =
                |of: &Vector<'a>| Vector(of.iter().zip(units.iter()).map(|(x, unit)| x / unit).collect());
            let start = collect(&block, &|f| slice(&velocity, f));
            let solved = inertia.block(&rows).solve_symmetric(&per(&right)).scale(t);
            let left = times(&left);
            for (left, name) in left.iter().zip(&names) {
                left.named(format!("inertia_{name}"));
            }
            Equation {
                unknown: collect(&block, &|f| motions[f].x.0.clone()),
                blocks: block.iter().flat_map(|&f| system.factors[f].algebra.group.blocks()).collect(),
                left,
                solved: per(&solved),
                right,
                start: per(&start),
                names,
            }
        })
        .collect()
}

/// The factors, together with those that share a field of inertia with them.
fn blocks(system: &System<'_>) -> Vec<Vec<usize>> {
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    for factor in 0..system.factors.len() {
        if blocks.iter().any(|block| block.contains(&factor)) {
            continue;
        }
        let shared = system.inertias.iter().filter(|field| field.factors.contains(&factor));
        let mut block: Vec<usize> = shared.flat_map(|field| field.factors.clone()).collect();
        block.sort_unstable();
        block.dedup();
        blocks.push(block);
    }
    blocks
}

/// The next state in the order of storage.
fn in_order<'a>(system: &System<'a>, nexts: &[(&Factor<'a>, Vector<'a>, Element<'a>)]) -> Vector<'a> {
    let mut values: Vec<(Symbol, Expr<'a>)> = Vec::new();
    for (factor, g, m) in nexts {
        values.extend(factor.configuration.symbols().into_iter().zip(g.iter()));
        values.extend(factor.momentum.symbols().into_iter().zip(m.base.iter()));
        for (advected, next) in factor.advected.iter().zip(&m.spaces) {
            values.extend(advected.value.symbols().into_iter().zip(next.iter()));
        }
    }
    let next = |symbol: Symbol| values.iter().find(|(known, _)| *known == symbol).map(|&(_, value)| value);
    Vector(system.state_symbols().into_iter().filter_map(next).collect())
}
