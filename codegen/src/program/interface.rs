//! What is to be seen of a system from outside.

use crate::model::{Role, StoredAs};

/// The data that go in and out of a system's functions, and what is known of it.
#[derive(Clone, Debug)]
pub struct Interface {
    /// The user's parameters, in the order of the flat array.
    pub parameters: Vec<Quantity>,
    /// How many constants of the user's own code stand behind them in that array.
    pub constants: usize,
    /// The parts of the state, in the order of storage.
    pub state: Vec<Quantity>,
    /// What is given from outside and held over a step.
    pub controls: Vec<Quantity>,
    /// The parameters that are inertias.
    pub inertias: Vec<Inertia>,
    /// What the Casimirs are called.
    pub casimirs: Vec<String>,
    /// How many more there are that have no name: of a high degree, or no polynomials.
    pub missing_casimirs: usize,
    /// The dimension of the configuration.
    pub dimension: usize,
    /// Whether the energy is an invariant of the motion.
    pub is_autonomous: bool,
    /// Whether nothing but momentum and advected parameters has a part in the motion.
    pub is_left_invariant: bool,
    /// Whether forces act.
    pub is_forced: bool,
    /// For people.
    pub documentation: Documentation,
}

/// A parameter, a part of the state, or a control.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// What it is to the system.
    pub role: Role,
    /// What it is called.
    pub name: String,
    /// Where it stands in an array, if it does.
    pub element: Option<Element>,
    /// What the components' names add to its own.
    pub components: Vec<String>,
    /// What it is stored as.
    pub stored: StoredAs,
    /// How many components its perturbation has: of a configuration as many as the algebra.
    pub perturbation: usize,
    /// The first line of its documentation.
    pub doc: String,
}

/// A place in an array of the user's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Element {
    /// What the user calls the array.
    pub array: String,
    /// The index.
    pub index: usize,
    /// How long the array is.
    pub length: usize,
}

/// A parameter that is an inertia, and has to be positive definite.
#[derive(Clone, Debug)]
pub struct Inertia {
    /// The parameter.
    pub name: String,
    /// Whether it is a matrix, which has to be symmetric.
    pub is_matrix: bool,
    /// The dimension of what it is for.
    pub rows: usize,
}

/// What is said of a system in words and formulas.
#[derive(Clone, Debug)]
pub struct Documentation {
    /// In which coordinates the equations are.
    pub coordinates: &'static str,
    /// The equations of motion.
    pub equations: Vec<String>,
    /// The conventions of each group.
    pub conventions: Vec<String>,
}

impl Quantity {
    /// The field that it stands in: its own, or that of its array.
    pub fn field(&self) -> &str {
        self.element.as_ref().map_or(&self.name, |element| &element.array)
    }
}

impl Interface {
    /// How many components the perturbation of the state has.
    pub fn state_perturbation(&self) -> usize {
        perturbation(&self.state)
    }

    /// How many components the controls have.
    pub fn control_length(&self) -> usize {
        length(&self.controls)
    }

    /// How many components the user's parameters have.
    pub fn field_length(&self) -> usize {
        length(&self.parameters)
    }

    /// The length of the flat array of parameters.
    pub fn parameter_length(&self) -> usize {
        self.field_length() + self.constants
    }

    /// The length of the flat array of the state.
    pub fn state_length(&self) -> usize {
        length(&self.state)
    }
}

fn length(quantities: &[Quantity]) -> usize {
    quantities.iter().map(|quantity| quantity.components.len()).sum()
}

fn perturbation(quantities: &[Quantity]) -> usize {
    quantities.iter().map(|quantity| quantity.perturbation).sum()
}
