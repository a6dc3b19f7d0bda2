//! The motion of a system as a vector field, in its velocity.

use super::discretization::{Values, bind};
use crate::expr::{Arena, Derivative, Expr, Symbol, Vector, gradient};
use crate::group::SemidirectVector;
use crate::model::{Energy, System};

/// How a state changes along the motion, as functions of configuration, velocity, the momentum that belongs to it,
/// advected parameters, time and controls.
pub(super) struct Field<'a> {
    /// The change of the configuration's stored coordinates.
    pub configuration: Vector<'a>,
    /// `ad*_ξ a`, the change of the advected parameters.
    pub advected: Vec<Vector<'a>>,
    /// `μ' = ad*_ξ μ − T*L_g ∂h/∂g + F`
    pub momentum: Vector<'a>,
    /// `ξ'`, by `μ'` and by what a velocity is to a momentum.
    pub acceleration: Vector<'a>,
}

impl<'a> Field<'a> {
    /// The motion with controls that are held.
    pub(super) fn new(arena: &'a Arena, system: &System<'a>) -> Self {
        Self::driven(arena, system, &[])
    }

    /// The motion with controls that change at these rates.
    pub(super) fn driven(arena: &'a Arena, system: &System<'a>, rates: &[(Symbol, Expr<'a>)]) -> Self {
        let (group, g, xi) = (&system.group, system.configuration(), system.velocity_symbols());
        let by_advected = system.advected().map(|a| gradient(system.potential(), &a.value.symbols()));
        let velocity = SemidirectVector { base: xi.clone(), spaces: by_advected.collect() };
        let velocity = velocity.scale(arena.number(system.side.sign()));
        let bracket = group.coadjoint(&velocity, &system.momentum_and_advected());
        let configuration = group.stored_perturbation(system.side, &g, &xi);
        let change = system.kick().map_or_else(|| bracket.base.clone(), |kick| &bracket.base + kick);
        let mut direction = Values::new();
        bind(&mut direction, &g, &configuration);
        for (advected, change) in system.advected().zip(&bracket.spaces) {
            bind(&mut direction, &advected.value, change);
        }
        direction.extend(system.time_symbol().into_iter().map(|time| (time, arena.one())));
        direction.extend(rates.iter().copied());
        let acceleration = match &system.energy {
            Energy::Mechanical { inertia, .. } => inertia.solve_symmetric(&change),
            Energy::Hamiltonian(energy) => {
                let momentum = system.momentum().symbols();
                direction.extend(momentum.iter().copied().zip(change.iter()));
                let mut along = Derivative::along(arena, &direction);
                gradient(*energy, &momentum).map(|component| along.of(component))
            }
            Energy::Lagrangian(lagrangian) => {
                let velocity = system.velocity_symbols().symbols();
                let momentum = gradient(*lagrangian, &velocity);
                let mut along = Derivative::along(arena, &direction);
                let rest = momentum.map(|component| along.of(component));
                momentum.jacobian(&velocity).map(Expr::hold).solve(&(&change - &rest).hold())
            }
        };
        Self { configuration, advected: bracket.spaces, momentum: change, acceleration }
    }
}
