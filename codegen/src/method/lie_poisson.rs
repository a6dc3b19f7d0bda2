//! The one family of steps for left-invariant systems with `h = ½ μ·𝕀⁻¹μ + V(a)`.
//!
//! For a retraction `τ` and a parameter `s ∈ [0, 1]`, with `t` the step and the unknown `η = t ζ`, `ζ` the velocity:
//!
//! ```text
//! m⁻ = Ad*_{τ(sη)} m_k                                         carried to the intermediate point
//! m̄  = (1−s) (dR τ_{(1−s)η})* m⁻ + s (dR τ_{−sη})* m⁻
//! η  = t ∂h/∂m(m̄)                                              the equation to solve
//! m_{k+1} = Ad*_{τ((1−s)η)} m⁻,   g_{k+1} = g_k τ(sη) τ((1−s)η)
//! ```
//!
//! on the dual `m = (μ, a)` of the semidirect algebra; `s = 0` is the paper's (6.5). Every member keeps the Poisson
//! bracket and all Casimirs, is its own adjoint, and has order 2.
//!
//! Two facts shape what is emitted:
//!
//! * `Ad*_{τ(x)} m = m + ad*_x (dR τ_x)* m` for *any* `x`, so the update needs no rotation, reuses what the equation computed,
//!   and keeps the Casimirs whatever residual the solver leaves.
//! * `ā` depends on the group's part `y` of `η` alone, hence so does `v = ∂V/∂a(ā)`: the advected unknowns are eliminated and
//!   `dim g` equations `𝕀 y / t = μ̄(y)` remain.

use super::{Step, step_symbol};
use crate::expr::{Arena, Number, Stage, Vector, gradient};
use crate::group::{Element, Retraction};
use crate::model::System;

/// The step with parameter `s` of the family.
pub fn step<'a>(arena: &'a Arena, system: &System<'a>, retraction: Retraction, s: Number) -> Step<'a> {
    let algebra = &system.algebra;
    let group = algebra.group;
    let axes = group.axes();
    let t = step_symbol(arena);
    let (early, late) = (arena.number(s), arena.number(Number::ONE + -s));

    let y = Vector(axes.iter().map(|axis| arena.symbol(format!("eta_{axis}"), Stage::Iteration)).collect());
    let a = system.advected_values();

    // the advected parameters at the intermediate point and in the mean, functions of y alone
    let (y_early, y_late) = (y.scale(early), y.scale(late));
    let a_minus: Vec<_> = {
        let mean = algebra.d_right_dual_spaces(retraction, &y_early, &a);
        let change = algebra.coadjoint_spaces(&y_early, &mean);
        a.iter().zip(&change).map(|(a, change)| a + change).collect()
    };
    let a_bar: Vec<_> = {
        let after = algebra.d_right_dual_spaces(retraction, &y_late, &a_minus);
        let before = algebra.d_right_dual_spaces(retraction, &-&y_early, &a_minus);
        after.iter().zip(&before).map(|(after, before)| &after.scale(late) + &before.scale(early)).collect()
    };

    // hence the advected part of the velocity, w = t ∂V/∂a(ā)
    let at_mean: Vec<_> = system
        .advected
        .iter()
        .zip(&a_bar)
        .flat_map(|((_, a), a_bar)| a.symbols().into_iter().zip(a_bar.iter()).collect::<Vec<_>>())
        .collect();
    let w: Vec<_> = system
        .advected
        .iter()
        .map(|(_, a)| gradient(system.potential, &a.symbols()).substitute(&at_mean).scale(t))
        .collect();

    let eta = Element { base: y.clone(), spaces: w.clone() };
    let (eta_early, eta_late) = (eta.scale(early), eta.scale(late));

    let m = Element { base: system.momentum.clone(), spaces: a };
    let m_minus = {
        let mean = algebra.d_right_dual(retraction, &eta_early, &m);
        m.plus(&algebra.coadjoint(&eta_early, &mean))
    };
    let after = algebra.d_right_dual(retraction, &eta_late, &m_minus).hold();
    let before = algebra.d_right_dual(retraction, &eta_early.scale(arena.number(-1)), &m_minus);
    let m_bar = after.scale(late).plus(&before.scale(early)).hold();
    let m_next = m_minus.plus(&algebra.coadjoint(&eta_late, &after));
    // two turns, one of which is none where s is 0 or 1: only the exponential has τ(sη) τ((1−s)η) = τ(η)
    let moved = [&y_early, &y_late].into_iter().fold(system.configuration.clone(), |g, part| {
        let turn = group.retract(retraction, part).hold().named("turn", group.coordinates());
        group.compose(&g, &turn).hold()
    });
    let g_next =
        group.normalize(&moved.named(&format!("{}_moved", group.configuration_name()), group.coordinates()));

    let left = system.inertia.scale(t.recip()).times(&y);
    let start = system.velocity(&system.momentum).scale(t);

    y.dot(&y).named("eta_squared");
    m_bar.base.named("momentum_mean", axes);
    left.named("inertia_eta", axes);
    m_next.base.named("momentum_next", axes);
    for (((name, _), space), ((mean, kick), next)) in
        system.advected.iter().zip(&algebra.spaces).zip(a_bar.iter().zip(&w).zip(&m_next.spaces))
    {
        mean.named(&format!("{name}_mean"), space.coordinates());
        kick.named(&format!("{name}_kick"), space.coordinates());
        next.named(&format!("{name}_next"), space.coordinates());
    }

    let mut next = g_next.0;
    next.extend(m_next.base.iter());
    next.extend(m_next.spaces.iter().flat_map(|space| space.iter().collect::<Vec<_>>()));
    Step {
        h: t,
        domain: group.domain(retraction, &y),
        unknown: y,
        start,
        left,
        right: m_bar.base,
        next: Vector(next),
    }
}
