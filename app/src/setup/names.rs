//! Names that users write: of whole quantities and of single components.

use std::ops::Range;

use coadjoint::system::Quantity;

use crate::catalogue::suggest::did_you_mean;
use crate::catalogue::{Entry, component_name, component_unit, unit};
use crate::error::SetupError;

/// Which names can be assigned to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Names {
    /// All of them.
    All,
    /// Those of what members of an ensemble may differ in: parameters and the state.
    Varied,
    /// Those of parameters.
    Parameters,
    /// Those of the state.
    State,
    /// Those of controls.
    Controls,
}

impl Names {
    /// Whether they are those of this part, among others.
    fn include(self, part: Part) -> bool {
        match self {
            Names::All => true,
            Names::Varied => part != Part::Controls,
            Names::Parameters => part == Part::Parameters,
            Names::State => part == Part::State,
            Names::Controls => part == Part::Controls,
        }
    }

    /// Names their kind in messages.
    fn kind(self) -> &'static str {
        match self {
            Names::All => "parameter, state quantity or control",
            Names::Varied => "parameter or state quantity",
            Names::Parameters => "parameter",
            Names::State => "state quantity",
            Names::Controls => "control",
        }
    }
}

/// The part of a setup that a name belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Parameters,
    State,
    Controls,
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
        for (part, quantities) in parts(entry).into_iter().filter(|(part, _)| which.include(*part)) {
            for (quantity, slots) in Quantity::with_ranges(quantities) {
                // a number in a list of one has a component's name too, as in tables
                if quantity.components != [""] {
                    single.extend(quantity.components.iter().enumerate().map(|(k, component)| {
                        let (name, slot) = (component_name(quantity, component), slots.start + k);
                        let unit = component_unit(quantity, k);
                        Name { name, part, quantity, slots: slot..slot + 1, unit }
                    }));
                }
                let (name, unit) = (quantity.name.to_owned(), unit(quantity));
                whole.push(Name { name, part, quantity, slots, unit });
            }
        }
        whole.extend(single);
        whole
    }

    /// Whether it is that of the whole quantity.
    pub(super) fn is_whole(&self) -> bool {
        self.name == self.quantity.name
    }
}

/// Finds the numbers of a name.
pub(super) fn named(entry: &Entry, which: Names, name: &str) -> Result<Name, SetupError> {
    let mut names = Name::all(entry, which);
    let Some(index) = names.iter().position(|candidate| candidate.name == name) else {
        let hint = did_you_mean(name, names.iter().map(|candidate| candidate.name.as_str()));
        let reason =
            format!("`{}` has no {} `{name}`{hint} {}", entry.name, which.kind(), known(entry, which));
        return Err(SetupError::new(name, "", reason));
    };
    Ok(names.swap_remove(index))
}

/// The quantities of each part.
fn parts(entry: &Entry) -> [(Part, &'static [Quantity]); 3] {
    let description = &entry.description;
    [
        (Part::Parameters, description.parameters),
        (Part::State, description.state),
        (Part::Controls, description.controls),
    ]
}

/// The names of whole quantities: `(parameters: inertia, weight, chi; state: attitude, momentum, gamma)`.
fn known(entry: &Entry, which: Names) -> String {
    // most systems have no controls
    let shown = |part: &Part, quantities: &[Quantity]| match part {
        Part::Controls => which.include(*part) && !quantities.is_empty(),
        _ => true,
    };
    let parts = parts(entry).into_iter().filter(|(part, quantities)| shown(part, quantities));
    let known = parts.map(|(part, quantities)| {
        let title = match part {
            Part::Parameters => "parameters",
            Part::State => "state",
            Part::Controls => "controls",
        };
        format!("{title}: {}", quantities.iter().map(|q| q.name).collect::<Vec<_>>().join(", "))
    });
    format!("({})", known.collect::<Vec<_>>().join("; "))
}

/// Numbers separated by commas, the value of a name.
pub(super) fn numbers(name: &str, value: &str) -> Result<Vec<f64>, SetupError> {
    let number = |text: &str| {
        let text = text.trim();
        text.parse::<f64>().map_err(|_| {
            SetupError::new(name, value, format!("`{text}` is not a number (in `{name}={value}`)"))
        })
    };
    value.split(',').map(number).collect()
}

/// How many numbers, in words.
pub(super) fn count(numbers: usize) -> String {
    if numbers == 1 { "one number".to_owned() } else { format!("{numbers} numbers separated by commas") }
}
