//! The parts of the state, and the controls, as fields of generated structs.

use super::{Advected, Factor, Name, Slot, System};
use crate::expr::{Symbol, Vector};
use crate::group::{Group, Representation, Side};
use crate::quantity::{Kind, Role};

/// A part of the state, or a control: one field of a generated struct, or an element of one.
#[derive(Clone)]
pub struct Part<'a> {
    /// Its role in the system.
    pub role: Role,
    /// Its name.
    pub name: Name,
    /// Its kind.
    pub kind: Kind,
    /// Suffixes of the components' names.
    pub suffixes: Vec<String>,
    /// Its components' symbols.
    pub symbols: Vec<Symbol>,
    /// Its components.
    pub value: Vector<'a>,
    /// The first line of its documentation.
    pub doc: String,
}

impl<'a> System<'a> {
    /// The parts of the state in the order of storage.
    pub fn parts(&self) -> Vec<Part<'a>> {
        let part = |slot| match slot {
            Slot::Configuration(factor) => {
                self.factors[factor].configuration_part(self.group.factors[factor].group)
            }
            Slot::Momentum(factor) => {
                self.factors[factor].momentum_part(self.group.factors[factor].group, self.side)
            }
            Slot::Advected { factor, place } => {
                self.factors[factor].advected[place].part(self.group.factors[factor].spaces[place], self.side)
            }
        };
        self.slots().into_iter().map(part).collect()
    }
}

impl<'a> Factor<'a> {
    fn configuration_part(&self, group: &dyn Group) -> Part<'a> {
        let doc = if group.is_linear() { "Position." } else { "From body to space coordinates." };
        Part {
            role: Role::Configuration,
            name: self.name.clone(),
            kind: group.names().kind,
            suffixes: owned(group.coordinates()),
            symbols: self.configuration.symbols(),
            value: self.configuration.clone(),
            doc: doc.to_owned(),
        }
    }

    fn momentum_part(&self, group: &dyn Group, side: Side) -> Part<'a> {
        Part {
            role: Role::Momentum,
            name: self.momentum_name.clone(),
            kind: Kind::Vector(group.dimension()),
            suffixes: owned(group.axes()),
            symbols: self.momentum.symbols(),
            value: self.momentum.clone(),
            doc: if group.is_linear() {
                "Momentum.".to_owned()
            } else {
                format!("Momentum, {}.", side.coordinates())
            },
        }
    }
}

impl<'a> Advected<'a> {
    fn part(&self, space: &dyn Representation, side: Side) -> Part<'a> {
        let seen = match side {
            Side::Left => "fixed in space, seen in body coordinates",
            Side::Right => "fixed in the body, seen in space",
        };
        Part {
            role: Role::Advected,
            name: self.name.clone(),
            kind: Kind::Vector(space.coordinates().len()),
            suffixes: owned(space.coordinates()),
            symbols: self.value.symbols(),
            value: self.value.clone(),
            doc: format!("Advected parameter `{}`, {seen}.", self.name.ident),
        }
    }
}

fn owned(suffixes: &[&str]) -> Vec<String> {
    suffixes.iter().map(|&suffix| suffix.to_owned()).collect()
}
