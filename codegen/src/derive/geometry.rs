//! The geometry of a system's states: displacements in local coordinates, the Poisson structure, the energy's
//! differential.
//!
//! A tangent vector has, in the order of storage, `δ` for each configuration `g τ(δ)` (`τ(δ) g` for right-invariant
//! systems) and the change of each momentum and advected parameter.

use crate::expr::{Arena, Stage, Vector, gradient};
use crate::group::{Retraction, SemidirectVector, Side};
use crate::model::{Parts, System};

/// Symbols for a tangent vector: `by_attitude_x`, …
pub fn tangent_symbols<'a>(arena: &'a Arena, system: &System<'a>, name: &str) -> Vector<'a> {
    let symbol = |component| arena.symbol(format!("{name}_{component}"), Stage::Step);
    Vector(system.tangent_names().into_iter().map(symbol).collect())
}

/// The state displaced by a tangent vector.
pub fn displaced<'a>(system: &System<'a>, retraction: Retraction, by: &Vector<'a>) -> Vector<'a> {
    let (state, by) = (system.state(), system.split_tangent(by));
    let moved = system.group.moved(system.side, retraction, &state.configuration, &by.configuration);
    system.join_state(&Parts {
        configuration: moved.next,
        momentum: &state.momentum + &by.momentum,
        advected: state.advected.iter().zip(&by.advected).map(|(a, change)| a + change).collect(),
    })
}

/// The energy's differential: its derivative along every component of a tangent vector.
pub fn differential<'a>(system: &System<'a>) -> Vector<'a> {
    let (energy, g) = (system.potential(), system.configuration());
    let df = gradient(energy, &g.symbols());
    system.at_velocity(&system.join_tangent(&Parts {
        configuration: system.group.trivialized_gradient(system.side, &g, &df),
        momentum: system.velocity(),
        advected: system.advected().map(|a| gradient(energy, &a.value.symbols())).collect(),
    }))
}

/// The Hamiltonian vector of a covector `dh`: `g' = g ξ`, `(μ, a)' = ad*_(ξ, w) (μ, a) − (dh/dg, 0)` with `ξ = ∂h/∂μ`,
/// `w = ∂h/∂a`.
pub fn hamiltonian_vector<'a>(arena: &'a Arena, system: &System<'a>, covector: &Vector<'a>) -> Vector<'a> {
    let dh = system.split_tangent(covector);
    let velocity = SemidirectVector { base: dh.momentum.clone(), spaces: dh.advected };
    let velocity = velocity.scale(arena.number(system.side.sign()));
    let change = system.group.coadjoint(&velocity, &system.momentum_and_advected());
    system.join_tangent(&Parts {
        configuration: dh.momentum,
        momentum: &change.base - &dh.configuration,
        advected: change.spaces,
    })
}

/// The forces as a tangent vector; those that name a velocity at the one that belongs to the momentum.
pub fn force<'a>(arena: &'a Arena, system: &System<'a>) -> Vector<'a> {
    let nothing = Vector::zeros(arena, system.dimension());
    system.join_tangent(&Parts {
        configuration: nothing.clone(),
        momentum: system.force().map_or(nothing, |force| system.at_velocity(&force)),
        advected: system.advected().map(|a| Vector::zeros(arena, a.value.len())).collect(),
    })
}

/// The momenta on the other side of the configuration, constant where nothing acts on the system: in space,
/// `Ad*_{g⁻¹} μ`, of a left-invariant one, in the body, `Ad*_g μ`, of a right-invariant one.
pub fn conserved<'a>(system: &System<'a>) -> Vector<'a> {
    let g = system.configuration();
    match system.side {
        Side::Left => system.group.to_space(&g, &system.momentum()),
        Side::Right => system.group.to_space(&system.group.inverse(&g), &system.momentum()),
    }
}

/// The state with the momenta that belong to these on the other side of the configuration.
pub fn with_conserved<'a>(system: &System<'a>, conserved: &Vector<'a>) -> Vector<'a> {
    let g = system.configuration();
    let momentum = match system.side {
        Side::Left => system.group.to_space(&system.group.inverse(&g), conserved),
        Side::Right => system.group.to_space(&g, conserved),
    };
    system.join_state(&Parts { momentum, ..system.state() })
}
