//! What is to be seen of a system from outside.

use std::ops::Range;

use crate::quantity::{Direction, Kind, Role, ScalarType, Side};

/// The data that go in and out of a system's functions, and what is known of it.
#[derive(Clone, Debug)]
pub struct Interface {
    /// The user's name for the system.
    pub name: String,
    /// The numbers that it is made of.
    pub scalar: ScalarType,
    /// Where momentum and velocity are taken.
    pub side: Side,
    /// The user's parameters, in the order of the flat array.
    pub parameters: Vec<Quantity>,
    /// The constants of the user's own code that stand behind them in that array.
    pub constants: Vec<Constant>,
    /// The parts of the state, in the order of storage.
    pub state: Vec<Quantity>,
    /// The controls, held over a step.
    pub controls: Vec<Quantity>,
    /// The parameters that are inertias.
    pub inertias: Vec<Inertia>,
    /// The events: their names, and which zeros count.
    pub events: Vec<(String, Direction)>,
    /// The Casimirs' names.
    pub casimirs: Vec<String>,
    /// How many more there are that have no name: of a high degree, or no polynomials.
    pub missing_casimirs: usize,
    /// The dimension of the configuration.
    pub dimension: usize,
    /// Whether the energy is an invariant of the motion.
    pub is_autonomous: bool,
    /// Whether energy or forces choose by state or time.
    pub is_piecewise: bool,
    /// Whether nothing but momentum and advected parameters has a part in the motion.
    pub is_left_invariant: bool,
    /// Whether forces act.
    pub is_forced: bool,
    /// The velocity by the momentum.
    pub velocity: Transform,
    /// Whether the velocity at a state depends on time.
    pub is_velocity_timed: bool,
    /// The momentum by the velocity.
    pub momentum: Transform,
    /// For people.
    pub documentation: Documentation,
}

/// A parameter, a part of the state, or a control.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// Its role in the system.
    pub role: Role,
    /// Its name.
    pub name: String,
    /// Where it stands in an array, if it does.
    pub element: Option<Element>,
    /// Suffixes of the components' names.
    pub components: Vec<String>,
    /// Its mathematical kind.
    pub kind: Kind,
    /// Where its perturbation stands within that of all parameters, of the state, or of all controls. The perturbation
    /// of a configuration is an element of the algebra.
    pub tangent: Range<usize>,
    /// Where it is taken; none of what has no side: parameters and controls.
    pub side: Option<Side>,
    /// Its unit, if the user says one.
    pub unit: Option<String>,
    /// The first line of its documentation.
    pub doc: String,
}

/// A constant that only the user's code knows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constant {
    /// A name for its value.
    pub name: String,
    /// Its path in the user's code.
    pub path: String,
}

/// How one of velocity and momentum is computed from the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transform {
    /// In closed form.
    Explicit,
    /// By Newton's method.
    Newton,
    /// Not at all: the energy has a singular second derivative.
    Singular,
}

/// A place in an array of the user's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Element {
    /// The user's name for the array.
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

/// Documentation of a system, in words and formulas.
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
        self.state.last().map_or(0, |last| last.tangent.end)
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
        self.field_length() + self.constants.len()
    }

    /// The length of the flat array of the state.
    pub fn state_length(&self) -> usize {
        length(&self.state)
    }
}

fn length(quantities: &[Quantity]) -> usize {
    quantities.iter().map(|quantity| quantity.components.len()).sum()
}
