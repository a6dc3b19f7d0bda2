//! The tangent lift (5.7): a step of the Lagrangian side, explicit.
//!
//! With the velocity `ξ = 𝕀⁻¹μ`, its change `ξ' = 𝕀⁻¹μ'` along the motion and the step `t`:
//!
//! ```text
//! g_{k+1} = g_k τ(tξ),   ξ_{k+1} = Ad_{τ(tξ)⁻¹} ξ + dL τ_{tξ}(t ξ') = ξ + dL τ_{tξ}(t ξ')
//! ```
//!
//! as `τ(tξ)` commutes with `ξ`. Advected parameters are carried along, `a_{k+1} = τ(tξ)⁻¹ a`.

use super::{Step, Turn, step_symbol};
use crate::expr::{Arena, Expr, Symbol, Vector};
use crate::geometry::{differential, force, hamiltonian_vector};
use crate::group::{Retraction, d_right};
use crate::model::{Hamiltonian, System};

/// The step; of a system with a general Hamiltonian the one with the velocity `∂h/∂μ` and unit inertia would make no sense, so
/// that the [checks](crate::check) admit none.
pub fn step<'a>(arena: &'a Arena, system: &System<'a>, retraction: Retraction) -> Step<'a> {
    let t = step_symbol(arena);
    let motion = {
        let flow = hamiltonian_vector(arena, system, &differential(system));
        let force = force(arena, system);
        &flow + &force
    };
    // `μ'` stands behind `g' = g ξ` for each factor
    let mut changes = Vec::new();
    let mut row = 0;
    for factor in &system.factors {
        let n = factor.momentum.len();
        changes.extend(motion.0[row + n..row + 2 * n].iter().copied());
        row += 2 * n;
    }
    let velocity = system.velocity(&system.momentum()).hold();
    let acceleration = system.velocity(&Vector(changes)).scale(t).hold();

    let mut values: Vec<(Symbol, Expr<'a>)> = Vec::new();
    let mut domain = Vec::new();
    let mut turns = Vec::new();
    let (mut velocities, mut accelerations) = (velocity.iter(), acceleration.iter());
    let mut velocity_next = Vec::new();
    for factor in &system.factors {
        let (algebra, n) = (&factor.algebra, factor.momentum.len());
        let velocity = Vector(velocities.by_ref().take(n).collect());
        let acceleration = Vector(accelerations.by_ref().take(n).collect());
        let x = velocity.scale(t).hold();
        let sign = arena.number(system.side.sign());
        let moved = algebra.group.moved(system.side, retraction, &factor.configuration, &x);
        values.extend(factor.configuration.symbols().into_iter().zip(moved.next.iter()));
        // dL τ_x = dR τ_{−x}, and the other way round on the other side
        let change = d_right(algebra.group, retraction, &x.scale(-sign), &acceleration);
        velocity_next.extend((&velocity + &change).0);
        let a: Vec<Vector<'a>> = factor.advected.iter().map(|a| a.value.clone()).collect();
        let signed = x.scale(sign);
        let mean = algebra.d_right_dual_spaces(retraction, &signed, &a);
        for (a, change) in a.iter().zip(algebra.coadjoint_spaces(&signed, &mean)) {
            values.extend(a.symbols().into_iter().zip((a + &change).iter()));
        }
        domain.extend(algebra.group.domain(retraction, &x));
        turns.push(vec![Turn { from: factor.configuration.clone(), by: x }]);
    }
    let momentum = match &system.hamiltonian {
        Hamiltonian::Mechanical { inertia, .. } => inertia.times(&Vector(velocity_next)),
        Hamiltonian::General(_) => Vector(velocity_next),
    };
    values.extend(system.momentum().symbols().into_iter().zip(momentum.iter()));

    let next = |symbol: Symbol| values.iter().find(|(known, _)| *known == symbol).map(|&(_, value)| value);
    Step {
        h: t,
        given: [system.time_symbol(), system.control_symbols()].concat(),
        unknown: Vector(Vec::new()),
        blocks: Vec::new(),
        start: Vector(Vec::new()),
        left: Vector(Vec::new()),
        right: Vector(Vec::new()),
        domain,
        turns,
        next: Vector(system.state_symbols().into_iter().filter_map(next).collect()),
        bounded: vec![false; system.state_symbols().len()],
    }
}
