//! The equations of motion as text, for documentation.

use quote::ToTokens;

use crate::expr::{Formulas, gradient};
use crate::group::{EquationNames, Side};
use crate::identifiers::{plain, velocity_name};
use crate::limits::FORMULAS;
use crate::model::{Factor, Hamiltonian, InertiaField, System};

impl System<'_> {
    /// The equations of motion as text.
    pub fn equations(&self) -> Vec<String> {
        let mut lines = velocities(self);
        lines.extend(self.factors.iter().flat_map(|factor| motion(self, factor)));
        lines.extend(derivatives(self));
        lines
    }
}

/// What formulas call the part of the energy that they differentiate.
fn energy(system: &System<'_>) -> &'static str {
    match &system.hamiltonian {
        Hamiltonian::Mechanical { .. } => "V",
        Hamiltonian::General(_) => "h",
    }
}

/// The velocities by the momenta.
fn velocities(system: &System<'_>) -> Vec<String> {
    match &system.hamiltonian {
        Hamiltonian::General(_) => {
            let by_momentum = |factor: &Factor<'_>| {
                let momentum = &factor.momentum_name;
                format!("{} = ∂h/∂{}", velocity_name(momentum), plain(momentum))
            };
            system.factors.iter().map(by_momentum).collect()
        }
        Hamiltonian::Mechanical { .. } => {
            let blocks = |field: &InertiaField<'_>| {
                field.blocks.iter().map(|block| by_inertia(system, field, block)).collect::<Vec<_>>()
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
    let velocity = together(&|factor| velocity_name(&factor.momentum_name));
    let momentum = together(&|factor| plain(&factor.momentum_name));
    format!("{velocity} = {}⁻¹ {momentum}", plain(&field.name))
}

/// How configuration, momentum and advected parameters of a factor change.
fn motion<'a>(system: &System<'a>, factor: &Factor<'a>) -> Vec<String> {
    let energy = energy(system);
    let advected: Vec<&str> = factor.advected.iter().map(|a| a.name.as_str()).collect();
    let (name, momentum) = (plain(&factor.name), plain(&factor.momentum_name));
    let velocity = velocity_name(&factor.momentum_name);
    let mut equations = factor.algebra.group.equations(&EquationNames {
        configuration: &name,
        momentum: &momentum,
        velocity: &velocity,
        advected: &advected,
    });
    let mut change = equations.momentum.join(" + ").replace("∂V", &format!("∂{energy}"));
    if system.side == Side::Right && !factor.algebra.group.is_linear() {
        // inversion changes the sign of the velocity
        equations.configuration = format!("{name}' = hat({velocity}) {name}");
        change = format!("−({change})");
        for line in &mut equations.advected {
            if let Some((left, right)) = line.split_once(" = ") {
                *line = format!("{left} = −({right})");
            }
        }
    }
    if system.depends_on_configuration(factor) {
        let space = if change.is_empty() { "" } else { " " };
        change = format!("{change}{space}−{space}∂{energy}/∂{name}");
    }
    if factor.force.is_some() {
        change = if change.is_empty() { "force".to_owned() } else { format!("{change} + force") };
    }
    if change.is_empty() {
        change = "0".to_owned();
    }
    let mut lines = vec![equations.configuration, format!("{momentum}' = {change}")];
    lines.extend(equations.advected);
    lines
}

/// The derivatives of the energy by the advected parameters.
fn derivatives(system: &System<'_>) -> Vec<String> {
    let energy = energy(system);
    let constants = system.constants.iter().map(|constant| (constant.symbol, path(&constant.tokens)));
    let mut formulas = Formulas::new(system.time.arena(), constants);
    for advected in system.factors.iter().flat_map(|factor| &factor.advected) {
        let symbols = advected.value.symbols();
        let gradient = gradient(system.potential(), &symbols);
        for (symbol, component) in advected.value.iter().zip(gradient.iter()) {
            formulas.push(format!("∂{energy}/∂{symbol}"), component);
        }
    }
    formulas
        .lines(FORMULAS)
        .unwrap_or_else(|| vec![format!("The derivatives of {energy} are too long for this place.")])
}

/// A path as it is usually written: with spaces between words alone.
fn path(tokens: &syn::Expr) -> String {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    tokens.to_token_stream().into_iter().fold(String::new(), |mut text, token| {
        let token = token.to_string();
        if text.ends_with(is_part) && token.starts_with(is_part) {
            text.push(' ');
        }
        text + &token
    })
}
