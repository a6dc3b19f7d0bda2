//! Parameters, the parts of the state, and controls, as fields of structs.

use super::{Advected, Name, Slot, System};
use crate::expr::Symbol;
use crate::group::Side;
use crate::identifiers::plain;
use crate::quantity::{Kind, Role};

/// A parameter, a part of the state, or a control: one field of a struct, or an element of one.
#[derive(Clone)]
pub struct Part {
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
    /// Its unit, if the user says one.
    pub unit: Option<String>,
    /// The first line of its documentation.
    pub doc: String,
}

impl<'a> System<'a> {
    /// The parts of the state in the order of storage.
    pub fn parts(&self) -> Vec<Part> {
        self.slots().into_iter().map(|slot| self.state_part(slot)).collect()
    }

    fn state_part(&self, slot: Slot) -> Part {
        let (Slot::Configuration(factor) | Slot::Momentum(factor) | Slot::Advected { factor, .. }) = slot;
        let (group, factor) = (self.group.factors[factor].group, &self.factors[factor]);
        let (role, name, kind, doc) = match slot {
            Slot::Configuration(_) => {
                let doc = if group.is_linear() { "Position." } else { "From body to space coordinates." };
                (Role::Configuration, &factor.name, group.names().kind, doc.to_owned())
            }
            Slot::Momentum(_) => {
                let doc = match group.is_linear() {
                    true => "Momentum.".to_owned(),
                    false => format!("Momentum, {}.", self.side.coordinates()),
                };
                (Role::Momentum, &factor.momentum_name, Kind::Vector(group.dimension()), doc)
            }
            Slot::Advected { place, .. } => {
                let seen = match self.side {
                    Side::Left => "fixed in space, seen in body coordinates",
                    Side::Right => "fixed in the body, seen in space",
                };
                let Advected { name, value } = &factor.advected[place];
                let doc = format!("Advected parameter `{}`, {seen}.", name.ident);
                (Role::Advected, name, Kind::Vector(value.len()), doc)
            }
        };
        let suffixes = match slot {
            Slot::Configuration(_) => group.coordinates(),
            _ => self.axes(slot),
        };
        let suffixes = suffixes.iter().map(|&one| one.to_owned()).collect();
        let (name, symbols) = (name.clone(), self.part(slot).symbols());
        let whole = plain(&name.ident);
        let unit = self.units.iter().find(|(of, _)| *of == whole).map(|(_, unit)| unit.clone());
        Part { role, name, kind, suffixes, symbols, unit, doc }
    }

    /// Suffixes of the components of a tangent vector's part: those of the algebra for a configuration.
    fn axes(&self, slot: Slot) -> &'static [&'static str] {
        match slot {
            Slot::Configuration(factor) | Slot::Momentum(factor) => self.group.factors[factor].group.axes(),
            Slot::Advected { factor, place } => self.group.factors[factor].spaces[place].coordinates(),
        }
    }

    /// The names of a tangent vector's components in the order of storage, part and axis: `attitude_x`.
    pub fn tangent_names(&self) -> Vec<String> {
        let of = |slot| {
            let name = self.state_part(slot).name.plain();
            self.axes(slot).iter().map(move |axis| format!("{name}_{axis}"))
        };
        self.slots().into_iter().flat_map(of).collect()
    }
}
