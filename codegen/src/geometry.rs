//! The geometry of a system's states: displacements in local coordinates, the Poisson structure, the energy's differential.
//!
//! A tangent vector has, in the order of storage, `δ` for each configuration `g τ(δ)` (`τ(δ) g` for right-invariant systems) and
//! the change of each momentum and advected parameter.

use crate::expr::{Arena, Stage, Vector, gradient};
use crate::group::{Retraction, SemidirectVector, Side, trivialized_gradient};
use crate::model::{Factor, FactorPart, Slot, System};

/// Symbols for a tangent vector: `by_attitude_x`, …
pub fn tangent_symbols<'a>(arena: &'a Arena, system: &System<'a>, name: &str) -> Vector<'a> {
    let symbol =
        |(part, suffix): &(String, &str)| arena.symbol(format!("{name}_{part}_{suffix}"), Stage::Step);
    Vector(components(system).iter().map(symbol).collect())
}

/// The names of a tangent vector's components: part and axis.
fn components(system: &System<'_>) -> Vec<(String, &'static str)> {
    let of = |slot| {
        let (name, axes) = match slot {
            Slot::Configuration(factor) => {
                let factor = &system.factors[factor];
                (factor.name.plain(), factor.algebra.group.axes())
            }
            Slot::Momentum(factor) => {
                let factor = &system.factors[factor];
                (factor.momentum_name.plain(), factor.algebra.group.axes())
            }
            Slot::Advected { factor, place } => {
                let factor = &system.factors[factor];
                (factor.advected[place].name.plain(), factor.algebra.spaces[place].coordinates())
            }
        };
        axes.iter().map(move |&axis| (name.clone(), axis))
    };
    system.slots().into_iter().flat_map(of).collect()
}

/// The state displaced by a tangent vector.
pub fn displaced<'a>(system: &System<'a>, retraction: Retraction, by: &Vector<'a>) -> Vector<'a> {
    let displaced = |(factor, by): (&Factor<'a>, FactorPart<'a>)| FactorPart {
        configuration: factor
            .algebra
            .group
            .moved(system.side, retraction, &factor.configuration, &by.configuration)
            .next,
        momentum: &factor.momentum + &by.momentum,
        advected: factor.advected.iter().zip(&by.advected).map(|(a, change)| &a.value + change).collect(),
    };
    let parts: Vec<FactorPart<'a>> =
        system.factors.iter().zip(system.split_tangent(by)).map(displaced).collect();
    system.join(&parts)
}

/// The energy's differential: its derivative along every component of a tangent vector.
pub fn differential<'a>(system: &System<'a>) -> Vector<'a> {
    let energy = system.potential();
    let velocities = system.split_momentum(&system.velocity());
    let of = |(factor, velocity): (&Factor<'a>, Vector<'a>)| {
        let (group, g) = (factor.algebra.group, &factor.configuration);
        let df = gradient(energy, &g.symbols());
        let advected = factor.advected.iter().map(|a| gradient(energy, &a.value.symbols())).collect();
        let configuration = trivialized_gradient(group, system.side, g, &df);
        FactorPart { configuration, momentum: velocity, advected }
    };
    let parts: Vec<FactorPart<'a>> = system.factors.iter().zip(velocities).map(of).collect();
    system.at_velocity(&system.join(&parts))
}

/// The Hamiltonian vector of a covector `dh`: `g' = g ξ`, `(μ, a)' = ad*_(ξ, w) (μ, a) − (dh/dg, 0)` with `ξ = ∂h/∂μ`, `w = ∂h/∂a`.
pub fn hamiltonian_vector<'a>(arena: &'a Arena, system: &System<'a>, covector: &Vector<'a>) -> Vector<'a> {
    let sign = arena.number(system.side.sign());
    let of = |(factor, dh): (&Factor<'a>, FactorPart<'a>)| {
        let velocity = SemidirectVector { base: dh.momentum.clone(), spaces: dh.advected }.scale(sign);
        let change = factor.algebra.coadjoint(&velocity, &factor.momentum_and_advected());
        FactorPart {
            configuration: dh.momentum,
            momentum: &change.base - &dh.configuration,
            advected: change.spaces,
        }
    };
    let parts: Vec<FactorPart<'a>> =
        system.factors.iter().zip(system.split_tangent(covector)).map(of).collect();
    system.join(&parts)
}

/// The forces as a tangent vector; those that name a velocity at the one that belongs to the momentum.
pub fn force<'a>(arena: &'a Arena, system: &System<'a>) -> Vector<'a> {
    let of = |factor: &Factor<'a>| FactorPart {
        configuration: Vector::zeros(arena, factor.momentum.len()),
        momentum: match &factor.force {
            Some(force) => system.at_velocity(force),
            None => Vector::zeros(arena, factor.momentum.len()),
        },
        advected: factor.advected.iter().map(|a| Vector::zeros(arena, a.value.len())).collect(),
    };
    let parts: Vec<FactorPart<'a>> = system.factors.iter().map(of).collect();
    system.join(&parts)
}

/// The momenta on the other side of the configuration, constant where nothing acts on the system: in space, `Ad*_{g⁻¹} μ`, of a
/// left-invariant one, in the body, `Ad*_g μ`, of a right-invariant one.
pub fn conserved<'a>(system: &System<'a>) -> Vector<'a> {
    let of = |factor: &Factor<'a>| {
        let (group, g) = (factor.algebra.group, &factor.configuration);
        match system.side {
            Side::Left => group.to_space(g, &factor.momentum).0,
            Side::Right => group.to_space(&group.inverse(g), &factor.momentum).0,
        }
    };
    Vector(system.factors.iter().flat_map(of).collect())
}

/// The state with the momenta that belong to these on the other side of the configuration.
pub fn with_conserved<'a>(system: &System<'a>, conserved: &Vector<'a>) -> Vector<'a> {
    let mut parts = system.state();
    let conserved = system.split_momentum(conserved);
    for ((factor, part), conserved) in system.factors.iter().zip(&mut parts).zip(conserved) {
        let (group, g) = (factor.algebra.group, &part.configuration);
        part.momentum = match system.side {
            Side::Left => group.to_space(&group.inverse(g), &conserved),
            Side::Right => group.to_space(g, &conserved),
        };
    }
    system.join(&parts)
}
