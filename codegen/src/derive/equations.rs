//! The equations of motion as text, for documentation.

use crate::expr::{Formulas, gradient};
use crate::group::{EquationNames, Equations, Representation, Semidirect, Side};
use crate::limits::FORMULAS;
use crate::model::{Energy, Factor, InertiaField, System};

impl System<'_> {
    /// The equations of motion as text.
    pub fn equations(&self) -> Vec<String> {
        let mut lines = velocities(self);
        let factors = self.factors.iter().zip(&self.group.factors);
        lines.extend(factors.flat_map(|(factor, algebra)| motion(self, factor, algebra)));
        lines.extend(derivatives(self));
        lines
    }
}

/// The letter of the energy's part that formulas differentiate.
fn energy(system: &System<'_>) -> &'static str {
    match &system.energy {
        Energy::Mechanical { .. } => "V",
        Energy::Hamiltonian(_) => "h",
        Energy::Lagrangian(_) => "l",
    }
}

/// The velocities by the momenta, or Legendre's transform: the momenta by the velocities, and the energy.
fn velocities(system: &System<'_>) -> Vec<String> {
    let each = |relation: fn(&str, &str) -> String| -> Vec<String> {
        let factors = system.factors.iter();
        factors.map(|factor| relation(&factor.velocity_name(), &factor.momentum_name.plain())).collect()
    };
    match &system.energy {
        Energy::Hamiltonian(_) => each(|velocity, momentum| format!("{velocity} = ∂h/∂{momentum}")),
        Energy::Lagrangian(_) => {
            let mut lines = each(|velocity, momentum| format!("{momentum} = ∂l/∂{velocity}"));
            let work = each(|velocity, momentum| format!("{momentum}·{velocity}"));
            lines.push(format!("h = {} − l", work.join(" + ")));
            lines
        }
        Energy::Mechanical { .. } => {
            let blocks = |field: &InertiaField<'_>| {
                field
                    .described
                    .blocks
                    .iter()
                    .map(|block| by_inertia(system, field, block))
                    .collect::<Vec<_>>()
            };
            system.inertias.iter().flat_map(blocks).collect()
        }
    }
}

/// `velocity = inertia⁻¹ momentum`, for all factors of a block of the inertia.
fn by_inertia(system: &System<'_>, field: &InertiaField<'_>, block: &[usize]) -> String {
    let together = |name: &dyn Fn(&Factor<'_>) -> String| {
        let names: Vec<String> = block.iter().map(|&factor| name(&system.factors[factor])).collect();
        if names.len() == 1 { names.concat() } else { format!("({})", names.join(", ")) }
    };
    let velocity = together(&|factor| factor.velocity_name());
    let momentum = together(&|factor| factor.momentum_name.plain());
    format!("{velocity} = {}⁻¹ {momentum}", field.described.name.plain())
}

/// How configuration, momentum and advected parameters of a factor change.
fn motion<'a>(system: &System<'a>, factor: &Factor<'a>, algebra: &Semidirect) -> Vec<String> {
    let energy = energy(system);
    let group = algebra.group;
    let is_own =
        |space: &dyn Representation| group.representations().iter().any(|own| own.name() == space.name());
    let names: Vec<String> = factor.advected.iter().map(|advected| advected.name.plain()).collect();
    let spaces = names.iter().map(String::as_str).zip(&algebra.spaces);
    let (own_spaces, others): (Vec<_>, Vec<_>) = spaces.partition(|(_, space)| is_own(**space));
    let advected: Vec<&str> = own_spaces.iter().map(|(advected, _)| *advected).collect();
    let (name, momentum) = (factor.name.plain(), factor.momentum_name.plain());
    let velocity = factor.velocity_name();
    let equations = group.equations(&EquationNames {
        configuration: &name,
        momentum: &momentum,
        velocity: &velocity,
        advected: &advected,
        energy,
    });
    let Equations { mut configuration, bracket, mut by_energy, advected: rates } = equations;
    let mut rates: Vec<(String, String)> = advected.iter().map(|&name| name.to_owned()).zip(rates).collect();
    for (advected, _) in others {
        by_energy.push(format!("{advected} ⋄ ∂{energy}/∂{advected}"));
        rates.push((advected.to_owned(), format!("ad*({velocity}) {advected}")));
    }
    let is_lagrangian = matches!(system.energy, Energy::Lagrangian(_));
    // the energy's derivatives are those of `−l`
    let (space, own) = if is_lagrangian { ("+", " − ") } else { ("−", " + ") };
    let mut change = bracket.unwrap_or_default();
    for text in by_energy {
        let sign = if change.is_empty() { own.trim_matches([' ', '+']) } else { own };
        change = format!("{change}{sign}{text}");
    }
    if system.side == Side::Right && !group.is_linear() {
        // inversion changes the sign of the velocity
        configuration = format!("hat({velocity}) {name}");
        change = format!("−({change})");
        rates.iter_mut().for_each(|(_, rate)| *rate = format!("−({rate})"));
    }
    if system.depends_on_configuration(factor) {
        change = match (change.is_empty(), is_lagrangian) {
            (true, true) => format!("∂{energy}/∂{name}"),
            (true, false) => format!("−∂{energy}/∂{name}"),
            (false, _) => format!("{change} {space} ∂{energy}/∂{name}"),
        };
    }
    if factor.force.is_some() {
        change = if change.is_empty() { "force".to_owned() } else { format!("{change} + force") };
    }
    if change.is_empty() {
        change = "0".to_owned();
    }
    let mut lines = vec![format!("{name}' = {configuration}"), format!("{momentum}' = {change}")];
    lines.extend(rates.into_iter().map(|(advected, rate)| format!("{advected}' = {rate}")));
    lines
}

/// The derivatives of the energy by the advected parameters, and of a Lagrangian by the velocity.
fn derivatives(system: &System<'_>) -> Vec<String> {
    let energy = energy(system);
    let constants = system.constants.iter().map(|constant| (constant.symbol, constant.path()));
    let mut formulas = Formulas::new(system.time.arena(), constants);
    let (differentiated, by_velocity) = match &system.energy {
        Energy::Lagrangian(lagrangian) => (*lagrangian, true),
        _ => (system.potential(), false),
    };
    let velocities = system.factors.iter().filter(|_| by_velocity).map(|factor| &factor.velocity);
    let advected = system.advected().map(|advected| &advected.value);
    for value in velocities.chain(advected) {
        let gradient = gradient(differentiated, &value.symbols());
        for (symbol, component) in value.iter().zip(gradient.iter()) {
            formulas.push(format!("∂{energy}/∂{symbol}"), component);
        }
    }
    formulas
        .lines(FORMULAS)
        .unwrap_or_else(|| vec![format!("The derivatives of {energy} are too long for this place.")])
}
