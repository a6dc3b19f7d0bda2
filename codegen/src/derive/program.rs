//! From a system to its program: every function that is emitted is derived here.

use super::geometry;
use crate::expr::{Arena, Expr, Stage, Symbol, Vector};
use crate::group::{Retraction, Side};
use crate::identifiers::plain;
use crate::kernel::{self, Inputs};
use crate::language;
use crate::method::linearization::Linearization;
use crate::method::taylor::taylor;
use crate::method::{Iteration, Step};
use crate::model::{Energy, Event, InertiaField, InertiaShape, Part, Place, Relation, System};
use crate::program::{
    Constant, Documentation, Element, Inertia, Input, Interface, Module, Program, Quantity, StepProgram,
    SystemRole, TaylorProgram, Transform,
};
use crate::quantity::Role;
use crate::scheme::{Derivatives, Scheme};

/// Derives a system's program, but for its steps. Its states are displaced along these retractions.
pub(crate) fn program<'a>(arena: &'a Arena, system: &System<'a>, retractions: &[Retraction]) -> Program {
    let functions = [
        energies(arena, system),
        inertias(arena, system),
        geometry(arena, system, retractions),
        events(arena, system),
    ];
    Program {
        interface: interface(system),
        functions: functions.into_iter().flatten().collect(),
        steps: Vec::new(),
        taylor: None,
    }
}

/// A system's public surface.
fn interface(system: &System<'_>) -> Interface {
    let quantity = |part: &Part| {
        let configuration = system.factors.iter().find(|factor| factor.name == part.name);
        let tangent = match part.role {
            Role::Configuration => configuration.map_or(0, |factor| factor.momentum.len()),
            Role::Parameter | Role::Momentum | Role::Advected | Role::Control => part.symbols.len(),
        };
        let element = |Place { index, length }| Element { array: plain(&part.name.ident), index, length };
        let has_side = !matches!(part.role, Role::Parameter | Role::Control);
        Quantity {
            role: part.role,
            name: part.name.plain(),
            element: part.name.place.map(element),
            components: part.suffixes.clone(),
            kind: part.kind,
            tangent: 0..tangent,
            side: has_side.then_some(system.side),
            unit: part.unit.clone(),
            doc: part.doc.clone(),
        }
    };
    let inertia = |inertia: &InertiaField<'_>| Inertia {
        name: inertia.described.name.plain(),
        is_matrix: inertia.described.shape == InertiaShape::Matrix,
        rows: inertia.matrix.rows,
    };
    let constants = system.constants.iter();
    let constant =
        |constant: &language::Constant<'_>| Constant { name: constant.name.clone(), path: constant.path() };
    let (velocity, is_linear) = (system.velocity_relation(), system.group.is_linear());
    Interface {
        name: system.name.clone(),
        scalar: system.scalar,
        side: system.side,
        parameters: in_a_row(system.parameters.iter().map(quantity)),
        constants: constants.map(constant).collect(),
        state: in_a_row(system.parts().iter().map(quantity)),
        controls: in_a_row(system.controls.iter().map(quantity)),
        inertias: system.inertias.iter().map(inertia).collect(),
        events: system.events.iter().map(|event| (event.name.clone(), event.direction)).collect(),
        casimirs: system.casimirs().found.iter().map(|(name, _)| name.clone()).collect(),
        missing_casimirs: system.casimirs().missing,
        dimension: system.dimension(),
        is_autonomous: system.is_autonomous(),
        is_piecewise: system.is_piecewise(),
        is_left_invariant: system.is_left_invariant(),
        is_forced: system.is_forced(),
        velocity: transform(velocity),
        is_velocity_timed: matches!(velocity, Relation::Explicit(value) | Relation::Implicit(value)
            if value.depends_on(&system.time_symbol())),
        momentum: transform(&system.momentum_relation()),
        documentation: Documentation {
            coordinates: if is_linear { "in Cartesian coordinates" } else { system.side.coordinates() },
            equations: system.equations(),
            conventions: conventions(system),
        },
    }
}

/// Quantities with their perturbations one after the other.
fn in_a_row(quantities: impl Iterator<Item = Quantity>) -> Vec<Quantity> {
    let mut end = 0;
    let placed = quantities.map(|quantity| {
        let start = end;
        end += quantity.tangent.len();
        Quantity { tangent: start..end, ..quantity }
    });
    placed.collect()
}

fn transform(relation: &Relation<'_>) -> Transform {
    match relation {
        Relation::Explicit(_) => Transform::Explicit,
        Relation::Implicit(_) => Transform::Newton,
        Relation::Singular => Transform::Singular,
    }
}

/// The conventions of each group, once.
fn conventions(system: &System<'_>) -> Vec<String> {
    let mut conventions: Vec<String> = Vec::new();
    for factor in &system.group.factors {
        let group = factor.group;
        let line = format!("Conventions of {}: {}.", group.name(), group.names().conventions);
        if !conventions.contains(&line) {
            conventions.push(line);
        }
    }
    conventions
}

/// The values of a step that is not long, at most.
const LONG: usize = 400;

/// The step of one scheme, and its derivative as far as it is wanted. The arena is to be its own: what is computed, and
/// in which order, then depends on the scheme alone.
pub(crate) fn step<'a>(
    arena: &'a Arena,
    system: &System<'a>,
    scheme: Scheme,
    aliases: Vec<Scheme>,
    wanted: Derivatives,
) -> Option<StepProgram> {
    let step = scheme.step(arena, system);
    if arena.is_exhausted() {
        return None;
    }
    let module = kernel::step(arena, &step, Inputs::of(system));
    let mut derivative = None;
    if wanted.any() {
        let linearization = Linearization::new(arena, system, &step, wanted);
        if arena.is_exhausted() {
            return None;
        }
        derivative = Some(kernel::derivative(arena, &step, &linearization, wanted, Inputs::of(system)));
    }
    let Step { blocks, bounded, iteration, unknown, .. } = step;
    let has_true_jacobian = matches!(iteration, Iteration::FixedPoint | Iteration::TrueNewton);
    let is_newton = !matches!(iteration, Iteration::FixedPoint);
    let is_chord = match &iteration {
        Iteration::Newton(matrix) => !Vector(matrix.entries.clone()).depends_on(&unknown.symbols()),
        _ => false,
    };
    let is_long = module.values.places() > LONG;
    Some(StepProgram {
        scheme,
        aliases,
        blocks,
        bounded,
        has_true_jacobian,
        is_newton,
        is_chord,
        is_long,
        module,
        derivative,
    })
}

/// The power series of a system's motion. None where a function in its description has no closed recurrence.
pub(crate) fn series<'a>(arena: &'a Arena, system: &System<'a>) -> Option<TaylorProgram> {
    let mut velocity = match system.energy {
        Energy::Lagrangian(_) => system.velocity_symbols().symbols(),
        _ => Vec::new(),
    };
    let taylor = taylor(arena, system)?;
    velocity.extend(&taylor.rate_symbols);
    let inputs = Inputs::of(system).with(Input::Velocity, velocity);
    Some(kernel::taylor(arena, &taylor, inputs))
}

/// Parameters and state.
fn at_state(system: &System<'_>) -> Inputs {
    let inputs = Inputs::default().with(Input::Parameters, system.parameter_symbols());
    inputs.with(Input::State, system.state_symbols())
}

/// Energy, velocity and what is conserved.
fn energies<'a>(arena: &'a Arena, system: &System<'a>) -> Vec<Module<SystemRole>> {
    let casimirs = Vector(system.casimirs().found.iter().map(|&(_, value)| value).collect());
    let inputs = || at_state(system).with(Input::Time, system.time_symbol());
    let mut functions = Vec::new();
    let mut add = |role, value: &Vector<'a>, inputs: Inputs| {
        functions.push(function(arena, system, role, value, inputs));
    };
    add(SystemRole::Energy, &Vector(vec![system.energy()]), inputs());
    add(SystemRole::Casimirs, &casimirs, inputs());
    let in_space = match system.side {
        Side::Left => geometry::conserved(system),
        Side::Right => system.momentum(),
    };
    add(SystemRole::SpatialMomentum, &in_space, inputs());
    let off = system.group.deviation(&system.configuration());
    if !off.is_empty() {
        let inputs = Inputs::default().with(Input::State, system.state_symbols());
        add(SystemRole::Deviation, &Vector(vec![off.dot(&off).sqrt()]), inputs);
    }
    let velocity = system.velocity_symbols().symbols();
    let with_velocity = || inputs().with(Input::Velocity, velocity.clone());
    match system.velocity_relation() {
        Relation::Explicit(value) => add(SystemRole::Velocity, value, inputs()),
        Relation::Implicit(residual) => {
            add(SystemRole::VelocityNewton, &newton(residual, &velocity), with_velocity());
        }
        Relation::Singular => {}
    }
    match system.momentum_relation() {
        Relation::Explicit(value) => add(SystemRole::Momentum, &value, with_velocity()),
        Relation::Implicit(residual) => {
            let newton = newton(&residual, &system.momentum().symbols());
            add(SystemRole::MomentumNewton, &newton, with_velocity());
        }
        Relation::Singular => {}
    }
    functions
}

/// A residual and Newton's correction for it, one after the other.
fn newton<'a>(residual: &Vector<'a>, unknown: &[Symbol]) -> Vector<'a> {
    let jacobian = residual.jacobian(unknown).map(Expr::hold);
    Vector::concat([residual, &jacobian.solve(residual)])
}

/// A function of the state, which is given the controls if it needs them, and the velocity if it needs it and there is
/// no closed form of it.
fn function<'a>(
    arena: &'a Arena,
    system: &System<'a>,
    role: SystemRole,
    value: &Vector<'a>,
    inputs: Inputs,
) -> Module<SystemRole> {
    let others =
        [(Input::Control, system.control_symbols()), (Input::Velocity, system.velocity_symbols().symbols())];
    let needed = others.into_iter().filter(|(input, symbols)| {
        inputs.symbols(*input).is_empty() && !symbols.is_empty() && value.depends_on(symbols)
    });
    let inputs = needed.fold(inputs.clone(), |all, (input, symbols)| all.with(input, symbols));
    kernel::function(arena, role, value, inputs)
}

/// The quantities that may become zero.
fn events<'a>(arena: &'a Arena, system: &System<'a>) -> Vec<Module<SystemRole>> {
    let event = |(place, event): (usize, &Event<'a>)| {
        let inputs = at_state(system).with(Input::Time, system.time_symbol());
        function(arena, system, SystemRole::Event(place), &Vector(vec![event.value]), inputs)
    };
    system.events.iter().enumerate().map(event).collect()
}

/// The pivots, which are positive where inertias are definite.
fn inertias<'a>(arena: &'a Arena, system: &System<'a>) -> Vec<Module<SystemRole>> {
    let pivots = |(place, inertia): (usize, &InertiaField<'a>)| {
        let inputs = Inputs::default().with(Input::Parameters, system.parameter_symbols());
        kernel::function(arena, SystemRole::Pivots(place), &inertia.matrix.ldl().1, inputs)
    };
    system.inertias.iter().enumerate().map(pivots).collect()
}

/// The geometry of the states. They are displaced along these retractions; along any other one by the exponential, for
/// local coordinates are as good as others where there are no steps with the map.
fn geometry<'a>(
    arena: &'a Arena,
    system: &System<'a>,
    retractions: &[Retraction],
) -> Vec<Module<SystemRole>> {
    let by = geometry::tangent_symbols(arena, system, "by");
    let with_tangent = || at_state(system).with(Input::Tangent, by.symbols());
    let with_time = |inputs: Inputs| inputs.with(Input::Time, system.time_symbol());
    let controlled = at_state(system).with(Input::Control, system.control_symbols());
    let displacement = |&retraction: &Retraction| {
        let value = geometry::displaced(system, retraction, &by);
        (SystemRole::Displacement(retraction), value, with_tangent())
    };
    let mut functions: Vec<_> = retractions.iter().map(displacement).collect();
    functions.extend([
        (SystemRole::Differential, geometry::differential(system), with_time(at_state(system))),
        (SystemRole::HamiltonianVector, geometry::hamiltonian_vector(arena, system, &by), with_tangent()),
        (SystemRole::Force, geometry::force(arena, system), with_time(controlled)),
    ]);
    if is_isolated(system) {
        let symbol = |i: usize| arena.symbol(format!("conserved_{i}"), Stage::Step);
        let conserved = Vector((0..system.dimension()).map(symbol).collect());
        let inputs = at_state(system).with(Input::Conserved, conserved.symbols());
        functions.push((SystemRole::Conserved, geometry::conserved(system), at_state(system)));
        functions.push((SystemRole::WithConserved, geometry::with_conserved(system, &conserved), inputs));
    }
    let module = |(role, value, inputs)| function(arena, system, role, &value, inputs);
    functions.into_iter().map(module).collect()
}

/// Whether nothing acts on the system, whose momentum on the other side of the configuration is then constant.
fn is_isolated(system: &System<'_>) -> bool {
    system.is_left_invariant() && system.factors.iter().all(|factor| factor.advected.is_empty())
}
