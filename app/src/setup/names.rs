//! Names that users write: of whole quantities and of single components.

use std::ops::Range;

use coadjoint::system::{Quantity, Role};

use crate::catalogue::quantities::{Component, components};
use crate::catalogue::suggest::did_you_mean;
use crate::catalogue::{Entry, unit};
use crate::error::SetupError;

/// Names in some parts of a setup, with a word for them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Names(&'static [Part], &'static str);

impl Names {
    pub(crate) const ALL: Self = Self(
        &[Part::Parameters, Part::State, Part::Controls, Part::Velocities],
        "parameter, state quantity or control",
    );
    /// Those of what members of an ensemble may differ in.
    pub(crate) const VARIED: Self = Self(&[Part::Parameters, Part::State], "parameter or state quantity");
    pub(crate) const PARAMETERS: Self = Self(&[Part::Parameters], "parameter");
    pub(crate) const STATE: Self = Self(&[Part::State, Part::Velocities], "state quantity");
    pub(crate) const CONTROLS: Self = Self(&[Part::Controls], "control");
}

/// The part of a setup that a name belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Parameters,
    State,
    Controls,
    /// Those that belong to the momenta of the state.
    Velocities,
}

impl Part {
    /// Lists its quantities.
    fn quantities(self, entry: &Entry) -> &'static [Quantity] {
        match self {
            Part::Parameters => entry.description.parameters,
            Part::State | Part::Velocities => entry.description.state,
            Part::Controls => entry.description.controls,
        }
    }
}

/// A name that can be set, and the numbers it stands for.
#[derive(Clone, Debug)]
pub(super) struct Name {
    pub(super) name: String,
    pub(super) part: Part,
    pub(super) quantity: &'static Quantity,
    pub(super) slots: Range<usize>,
    pub(super) unit: &'static str,
}

impl Name {
    /// Whole quantities first, then their components.
    fn all(entry: &Entry, which: Names) -> Vec<Name> {
        let mut whole = Vec::new();
        let mut single = Vec::new();
        for &part in which.0 {
            let quantities = part.quantities(entry);
            // a number in a list of one has a component's name too, as in tables
            let named = components(quantities).filter(|component| component.quantity.components != [""]);
            single.extend(named.map(|Component { quantity, name, unit, slot }| Name {
                name,
                part,
                quantity,
                slots: slot..slot + 1,
                unit,
            }));
            whole.extend(Quantity::with_ranges(quantities).map(|(quantity, slots)| {
                let (name, unit) = (quantity.name.to_owned(), unit(quantity));
                Name { name, part, quantity, slots, unit }
            }));
        }
        whole.extend(single);
        whole.retain(|name| name.part != Part::Velocities || name.quantity.role == Role::Momentum);
        for name in whole.iter_mut().filter(|name| name.part == Part::Velocities) {
            (name.name, name.unit) = (velocity(&name.name), "");
        }
        whole
    }

    /// Whether it is that of the whole quantity.
    pub(super) fn is_whole(&self) -> bool {
        self.name == self.quantity.name
    }
}

/// Names the velocity that belongs to a momentum: `attitude_velocity_x` to `attitude_momentum_x`.
pub(super) fn velocity(momentum: &str) -> String {
    momentum.replacen("momentum", "velocity", 1)
}

/// Finds the numbers of a name.
pub(super) fn named(entry: &Entry, which: Names, name: &str) -> Result<Name, SetupError> {
    let mut names = Name::all(entry, which);
    let Some(index) = names.iter().position(|candidate| candidate.name == name) else {
        let hint = did_you_mean(name, names.iter().map(|candidate| candidate.name.as_str()));
        let reason = format!("`{}` has no {} `{name}`{hint} {}", entry.name, which.1, known(entry, which));
        return Err(SetupError::new(reason));
    };
    Ok(names.swap_remove(index))
}

/// The names of whole quantities: `(parameters: inertia, weight, chi; state: attitude, momentum, gamma)`.
fn known(entry: &Entry, which: Names) -> String {
    let parts = [(Part::Parameters, "parameters"), (Part::State, "state"), (Part::Controls, "controls")];
    let known = parts.into_iter().filter_map(|(part, title)| {
        let names: Vec<&str> = part.quantities(entry).iter().map(|quantity| quantity.name).collect();
        // most systems have no controls
        let is_shown = part != Part::Controls || (which.0.contains(&part) && !names.is_empty());
        is_shown.then(|| format!("{title}: {}", names.join(", ")))
    });
    format!("({})", known.collect::<Vec<_>>().join("; "))
}

/// Numbers separated by commas, the value of a name; `within` is what the user wrote.
pub(super) fn numbers(within: &str, value: &str) -> Result<Vec<f64>, SetupError> {
    let number = |text: &str| {
        let text = text.trim();
        text.parse::<f64>().map_err(|_| SetupError::new(format!("`{text}` is not a number (in `{within}`)")))
    };
    value.split(',').map(number).collect()
}

/// How many numbers, in words.
pub(super) fn count(numbers: usize) -> String {
    if numbers == 1 { "one number".to_owned() } else { format!("{numbers} numbers separated by commas") }
}
