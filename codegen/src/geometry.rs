//! The geometry of a system's states: displacements in local coordinates, the Poisson structure, the energy's differential.
//!
//! A tangent vector has, in the order of storage, `δ` for each configuration `g τ(δ)` (`τ(δ) g` for right-invariant systems) and
//! the change of each momentum and advected parameter.

use crate::expr::{Arena, Expr, Stage, Symbol, Vector, gradient};
use crate::group::{Element, Retraction, trivialized_gradient};
use crate::model::{Factor, System};

/// What a tangent or cotangent vector has for one factor.
struct Block<'a> {
    configuration: Vector<'a>,
    momentum: Vector<'a>,
    advected: Vec<Vector<'a>>,
}

/// Symbols for a tangent vector: `by_attitude_x`, …
pub fn tangent_symbols<'a>(arena: &'a Arena, system: &System<'a>, name: &str) -> Vector<'a> {
    let symbol =
        |(part, suffix): &(String, &str)| arena.symbol(format!("{name}_{part}_{suffix}"), Stage::Step);
    Vector(components(system).iter().map(symbol).collect())
}

/// The names of a tangent vector's components: part and axis.
fn components(system: &System<'_>) -> Vec<(String, &'static str)> {
    let name = |ident: &proc_macro2::Ident| crate::identifiers::plain(ident);
    let mut components = Vec::new();
    for factor in &system.factors {
        let axes = factor.algebra.group.axes();
        components.extend(axes.iter().map(|&axis| (name(&factor.name), axis)));
        components.extend(axes.iter().map(|&axis| (name(&factor.momentum_name), axis)));
    }
    for (factor, place) in system.advected_places() {
        let (space, advected) = (factor.algebra.spaces[place], &factor.advected[place]);
        components.extend(space.coordinates().iter().map(|&axis| (advected.name.clone(), axis)));
    }
    components
}

/// A vector in the order of storage, factor by factor.
fn blocks<'a>(system: &System<'a>, vector: &Vector<'a>) -> Vec<Block<'a>> {
    let mut rest = vector.0.as_slice();
    let mut take = |n: usize| {
        let (first, others) = rest.split_at(n);
        rest = others;
        Vector(first.to_vec())
    };
    let mut blocks: Vec<Block<'a>> = system
        .factors
        .iter()
        .map(|factor| {
            let n = factor.momentum.len();
            Block { configuration: take(n), momentum: take(n), advected: Vec::new() }
        })
        .collect();
    // each factor's advected parameters come in the order declared
    for (factor, place) in system.advected_places() {
        let index = system.factors.iter().position(|other| std::ptr::eq(other, factor)).unwrap_or_default();
        blocks[index].advected.push(take(factor.advected[place].value.len()));
    }
    blocks
}

/// Blocks in the order of storage.
fn join<'a>(system: &System<'a>, blocks: &[Block<'a>]) -> Vector<'a> {
    let mut all = Vec::new();
    for block in blocks {
        all.extend(block.configuration.iter());
        all.extend(block.momentum.iter());
    }
    for (factor, place) in system.advected_places() {
        let index = system.factors.iter().position(|other| std::ptr::eq(other, factor)).unwrap_or_default();
        all.extend(blocks[index].advected[place].iter());
    }
    Vector(all)
}

/// The state displaced by a tangent vector.
pub fn displaced<'a>(system: &System<'a>, retraction: Retraction, by: &Vector<'a>) -> Vector<'a> {
    let mut values: Vec<(Symbol, Expr<'a>)> = Vec::new();
    for (factor, block) in system.factors.iter().zip(blocks(system, by)) {
        let group = factor.algebra.group;
        let moved = group.moved(system.side, retraction, &factor.configuration, &block.configuration);
        values.extend(factor.configuration.symbols().into_iter().zip(moved.next.iter()));
        let momentum = &factor.momentum + &block.momentum;
        values.extend(factor.momentum.symbols().into_iter().zip(momentum.iter()));
        for (advected, change) in factor.advected.iter().zip(&block.advected) {
            let moved = &advected.value + change;
            values.extend(advected.value.symbols().into_iter().zip(moved.iter()));
        }
    }
    let moved = |symbol: Symbol| values.iter().find(|(known, _)| *known == symbol).map(|&(_, value)| value);
    Vector(system.state_symbols().into_iter().filter_map(moved).collect())
}

/// The energy's differential: its derivative along every component of a tangent vector.
pub fn differential<'a>(system: &System<'a>) -> Vector<'a> {
    let energy = system.potential();
    let velocity = system.velocity(&system.momentum());
    let mut velocity = velocity.iter();
    let of = |factor: &Factor<'a>| {
        let df = gradient(energy, &factor.configuration.symbols());
        let momentum = velocity.by_ref().take(factor.momentum.len()).collect();
        let advected = factor.advected.iter().map(|a| gradient(energy, &a.value.symbols())).collect();
        Block {
            configuration: trivialized_gradient(
                factor.algebra.group,
                system.side,
                &factor.configuration,
                &df,
            ),
            momentum: Vector(momentum),
            advected,
        }
    };
    let blocks: Vec<Block<'a>> = system.factors.iter().map(of).collect();
    join(system, &blocks)
}

/// The Hamiltonian vector of a covector `dh`: `g' = g ξ`, `(μ, a)' = ad*_(ξ, w) (μ, a) − (dh/dg, 0)` with `ξ = ∂h/∂μ`, `w = ∂h/∂a`.
pub fn hamiltonian_vector<'a>(arena: &'a Arena, system: &System<'a>, covector: &Vector<'a>) -> Vector<'a> {
    let sign = arena.number(system.side.sign());
    let of = |(factor, block): (&Factor<'a>, Block<'a>)| {
        let velocity = Element { base: block.momentum.clone(), spaces: block.advected }.scale(sign);
        let m = Element {
            base: factor.momentum.clone(),
            spaces: factor.advected.iter().map(|a| a.value.clone()).collect(),
        };
        let change = factor.algebra.coadjoint(&velocity, &m);
        Block {
            configuration: block.momentum,
            momentum: &change.base - &block.configuration,
            advected: change.spaces,
        }
    };
    let blocks: Vec<Block<'a>> = system.factors.iter().zip(blocks(system, covector)).map(of).collect();
    join(system, &blocks)
}

/// The forces as a tangent vector; those that name a velocity at the one that belongs to the momentum.
pub fn force<'a>(arena: &'a Arena, system: &System<'a>) -> Vector<'a> {
    let velocities: Vec<Symbol> =
        system.factors.iter().flat_map(|factor| factor.velocity.symbols()).collect();
    let velocity = system.velocity(&system.momentum());
    let known: Vec<_> = velocities.into_iter().zip(velocity.iter()).collect();
    let of = |factor: &Factor<'a>| Block {
        configuration: Vector::zeros(arena, factor.momentum.len()),
        momentum: match &factor.force {
            Some(force) => force.substitute(&known),
            None => Vector::zeros(arena, factor.momentum.len()),
        },
        advected: factor.advected.iter().map(|a| Vector::zeros(arena, a.value.len())).collect(),
    };
    let blocks: Vec<Block<'a>> = system.factors.iter().map(of).collect();
    join(system, &blocks)
}

/// The state with the momenta that belong to these in space coordinates.
pub fn with_spatial_momentum<'a>(system: &System<'a>, spatial: &Vector<'a>) -> Vector<'a> {
    let mut rest = spatial.iter();
    let mut values: Vec<(Symbol, Expr<'a>)> = Vec::new();
    for factor in &system.factors {
        let group = factor.algebra.group;
        let momentum = Vector(rest.by_ref().take(factor.momentum.len()).collect());
        let body = group.to_space(&group.inverse(&factor.configuration), &momentum);
        values.extend(factor.momentum.symbols().into_iter().zip(body.iter()));
    }
    let new =
        |symbol: Symbol, old| values.iter().find(|(known, _)| *known == symbol).map_or(old, |&(_, new)| new);
    let parts = system.parts();
    let components = parts.iter().flat_map(|part| part.symbols.iter().copied().zip(part.value.iter()));
    Vector(components.map(|(symbol, old)| new(symbol, old)).collect())
}
