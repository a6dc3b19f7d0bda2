//! The tangent lift (5.7): a step of the Lagrangian side, explicit.
//!
//! With the velocity `ξ = 𝕀⁻¹μ`, its change `ξ' = 𝕀⁻¹μ'` along the motion and the step `t`:
//!
//! ```text
//! g_{k+1} = g_k τ(tξ),   ξ_{k+1} = Ad_{τ(tξ)⁻¹} ξ + dL τ_{tξ}(t ξ')
//! ```
//!
//! with `Ad_{τ(tξ)⁻¹} ξ = ξ` where `τ` is equivariant. Advected parameters are carried along, `a_{k+1} = τ(tξ)⁻¹ a`.

use super::{Increment, Step, step_symbol};
use crate::expr::{Arena, Vector};
use crate::geometry::{differential, force, hamiltonian_vector};
use crate::group::{Retraction, carried_back, d_left};
use crate::model::{FactorPart, Hamiltonian, System};

/// The step; of a system with a general Hamiltonian the one with the velocity `∂h/∂μ` and unit inertia would make no sense, so
/// that the [checks](crate::check) admit none.
pub fn step<'a>(arena: &'a Arena, system: &System<'a>, retraction: Retraction) -> Step<'a> {
    let t = step_symbol(arena);
    let sign = arena.number(system.side.sign());
    let velocity = system.velocity(&system.momentum()).hold();
    let acceleration = acceleration(arena, system).scale(t).hold();

    let (mut next, mut velocity_next) = (system.state(), Vec::new());
    let (mut domain, mut increments) = (Vec::new(), Vec::new());
    let rates = system.split_momentum(&velocity).into_iter().zip(system.split_momentum(&acceleration));
    for ((factor, next), (velocity, acceleration)) in system.factors.iter().zip(&mut next).zip(rates) {
        let (group, g) = (factor.algebra.group, &factor.configuration);
        let x = velocity.scale(t).hold();
        next.configuration = group.moved(system.side, retraction, g, &x).next;
        let (carrying, signed) = (system.side.carrying(retraction), x.scale(sign));
        let carried = match carrying.is_equivariant() {
            true => velocity,
            false => carried_back(group, carrying, &signed, &velocity),
        };
        velocity_next.push(&carried + &d_left(group, carrying, &signed, &acceleration));
        for (space, a) in next.advected.iter_mut().enumerate() {
            *a = factor.algebra.carry(space, carrying, &signed, a);
        }
        domain.extend(group.domain(retraction, &x));
        increments.push(vec![Increment { retraction, from: g.clone(), by: x }]);
    }
    set_momenta(system, &mut next, &velocity_next);
    Step {
        h: t,
        given: [system.time_symbol(), system.control_symbols()].concat(),
        unknown: Vector(Vec::new()),
        blocks: Vec::new(),
        start: Vector(Vec::new()),
        left: Vector(Vec::new()),
        right: Vector(Vec::new()),
        domain,
        increments,
        next: system.join(&next),
        bounded: vec![false; system.state_symbols().len()],
    }
}

/// `𝕀⁻¹ μ'` along the motion.
fn acceleration<'a>(arena: &'a Arena, system: &System<'a>) -> Vector<'a> {
    let flow = hamiltonian_vector(arena, system, &differential(system));
    let motion = &flow + &force(arena, system);
    let changes = system.split_tangent(&motion);
    system.velocity(&Vector::concat(changes.iter().map(|change| &change.momentum)))
}

/// Puts the momenta `𝕀 ξ` in their places.
fn set_momenta<'a>(system: &System<'a>, parts: &mut [FactorPart<'a>], velocities: &[Vector<'a>]) {
    let velocity = Vector::concat(velocities);
    let momentum = match &system.hamiltonian {
        Hamiltonian::Mechanical { inertia, .. } => inertia.times(&velocity),
        Hamiltonian::General(_) => velocity,
    };
    for (part, momentum) in parts.iter_mut().zip(system.split_momentum(&momentum)) {
        part.momentum = momentum;
    }
}
