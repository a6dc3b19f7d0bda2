//! What must hold between the parts of a description, one function for each rule.

use syn::Ident;

use super::resolver::Resolver;
use super::{Advected, Factors, Force, momentum_name};
use crate::diagnostics::{Diagnostics, suggestion};
use crate::group::{self, Retraction, part_name};
use crate::identifiers::{Name, plain, velocity_name};
use crate::parse::{Attribute, EnergyKey, Key, scalar_name};
use crate::quantity::ScalarType;

impl<'d> Resolver<'d> {
    fn field_names(&self) -> impl Iterator<Item = &'d Ident> {
        let unreadable = self.item.unreadable.iter().map(|field| &field.name);
        self.item.fields.iter().map(|field| &field.name).chain(unreadable)
    }

    /// The names that the attribute gives: factors, advected parameters, controls; with what they are.
    fn declared(&self) -> Vec<(&'d Ident, &'static str)> {
        let Attribute { factors, advected, controls, .. } = self.attribute;
        let factors =
            factors.iter().filter_map(|factor| Some((factor.name.as_ref()?, "a factor of the group")));
        let advected = advected.iter().map(|advected| (&advected.name, "an advected parameter"));
        let controls = controls.iter().map(|control| (&control.name, "a control"));
        factors.chain(advected).chain(controls).collect()
    }

    /// A Hamiltonian, or a Lagrangian, takes the place of inertia and potential.
    pub(super) fn check_energy(&self, diagnostics: &mut Diagnostics) {
        const CLASHES: [(EnergyKey, EnergyKey, &str); 3] = [
            (
                EnergyKey::Hamiltonian,
                EnergyKey::Potential,
                "the Hamiltonian is the whole energy; add the potential to it, or leave it out",
            ),
            (
                EnergyKey::Lagrangian,
                EnergyKey::Potential,
                "the Lagrangian is kinetic less potential energy; subtract the potential in it, or leave it out",
            ),
            (
                EnergyKey::Lagrangian,
                EnergyKey::Hamiltonian,
                "the Lagrangian says what the Hamiltonian is; give one of `lagrangian` and `hamiltonian`",
            ),
        ];
        for (whole, other, message) in CLASHES {
            if let (Some(whole), Some(_)) = (self.attribute.energy(whole), self.attribute.energy(other)) {
                diagnostics.push(whole, message);
            }
        }
    }

    /// There are steps, on all factors and all spaces, with every retraction that is named, or with one of the usual
    /// ones.
    pub(super) fn check_retractions(&self, advected: &[Advected<'d>], diagnostics: &mut Diagnostics) {
        if !self.groups_are_known() {
            return;
        }
        let named = &self.attribute.retractions;
        for parameter in advected.iter().filter(|parameter| parameter.name.is_first()) {
            for retraction in named.iter().filter(|&&retraction| !parameter.space.has(retraction)) {
                let message = format!("there are no steps with `{}` that move this space", retraction.name());
                diagnostics.push(parameter.written.space.keyword(), message);
            }
        }
        let has = |retraction: Retraction| {
            self.factors.iter().all(|factor| factor.group.has(retraction))
                && advected.iter().all(|advected| advected.space.has(retraction))
        };
        if named.is_empty() && !Retraction::defaults().any(has) {
            let message = "no retraction moves all of these groups and spaces";
            diagnostics.push(self.attribute.factors[0].group.keyword(), message);
        }
    }

    /// Units are those of parts of the state, and of controls.
    pub(super) fn check_units(&self, advected: &[Advected<'d>], diagnostics: &mut Diagnostics) {
        let parts = self.factors.iter().flat_map(|factor| [&factor.name, &factor.momentum_name]);
        let parts = parts.chain(advected.iter().map(|advected| &advected.name));
        let controls = self.attribute.controls.iter().map(|control| plain(&control.name));
        let known: Vec<String> = parts.map(|name| plain(&name.ident)).chain(controls).collect();
        let missing = self.unknown_names(advected);
        for unit in &self.attribute.units {
            let name = plain(&unit.name);
            if known.contains(&name) || missing.contains(&name) {
                continue;
            }
            let is_field = self.field_names().any(|field| plain(field) == name);
            let message = match is_field {
                true => format!("the unit of a parameter stands on its field: `#[unit(\"{}\")]`", unit.unit),
                false => {
                    let names: Vec<&str> = known.iter().map(String::as_str).collect();
                    format!("neither the state nor the controls have `{name}`{}", suggestion(&name, &names))
                }
            };
            diagnostics.push(&unit.name, message);
        }
    }

    /// Parameters do not take names that mean something else.
    pub(super) fn names_are_free(&self, advected: &[Advected<'d>], diagnostics: &mut Diagnostics) {
        let elements = self.elements(advected);
        let mut reserved: Vec<(String, &str)> =
            vec![("t".to_owned(), "the time"), ("time".to_owned(), "the time")];
        for (factor, &group) in self.attribute.factors.iter().zip(&self.groups) {
            let momentum = momentum_name(factor.name.as_ref());
            for part in group.into_iter().flat_map(|group| group.names().parts) {
                reserved.push((part_name(&plain(&momentum), part), "a part of the momentum"));
                reserved.push((part_name(&velocity_name(&momentum), part), "a part of the velocity"));
            }
            reserved.push((velocity_name(&momentum), "the velocity"));
            reserved.push((momentum.to_string(), "the momentum"));
            if let (None, Some(group)) = (&factor.name, group) {
                reserved.push((group.names().configuration.to_owned(), "the configuration"));
            }
        }
        let declared = self.declared();
        for name in self.field_names().chain(declared.iter().map(|&(name, _)| name)) {
            if let Some((_, meaning)) = reserved.iter().find(|(reserved, _)| name == reserved) {
                diagnostics.push(name, format!("`{name}` is {meaning} of this system; choose another name"));
            } else if let Some(element) = elements.iter().find(|element| *name == element.plain()) {
                let message =
                    format!("`{name}` is what tables call `{}`; choose another name", element.written());
                diagnostics.push(name, message);
            } else if name.to_string().starts_with("__") {
                let message = "names that begin with `__` belong to the generated code; choose another name";
                diagnostics.push(name, message);
            }
        }
    }

    /// All that is an element of an array.
    fn elements(&self, advected: &[Advected<'d>]) -> Vec<Name> {
        let factors = self.factors.iter().flat_map(|factor| [&factor.name, &factor.momentum_name]);
        let known = factors.chain(advected.iter().map(|advected| &advected.name)).cloned();
        let fields = self.item.fields.iter().flat_map(|field| Name::all(&field.name, field.length));
        let controls = self.attribute.controls.iter();
        let controls = controls.flat_map(|control| Name::all(&control.name, control.length));
        known.chain(fields).chain(controls).filter(|name| name.place.is_some()).collect()
    }

    /// An expression can tell everything that has a name from everything else.
    pub(super) fn names_are_distinct(&self, diagnostics: &mut Diagnostics) {
        let declared = self.declared();
        for (i, (name, what)) in declared.iter().enumerate() {
            if self.field_names().any(|field| field == *name) {
                let system = &self.item.name;
                let message =
                    format!("`{name}` is also a field of `{system}`; {what} needs a name of its own");
                diagnostics.push(name, message);
            }
            if let Some((_, other)) =
                declared[..i].iter().find(|(earlier, other)| earlier == name && other != what)
            {
                diagnostics.push(name, format!("`{name}` is also {other}; choose another name"));
            }
        }
    }

    /// The forces: each acts on a factor or on an array of them, and says on which.
    pub(super) fn forces(&self, diagnostics: &mut Diagnostics) -> Vec<Force<'d>> {
        let mut acted: Vec<usize> = Vec::new();
        let forces = self.attribute.forces.iter().map(|force| {
            let factors = match &force.factor {
                None => match self.declared_factors.as_slice() {
                    [all] if self.attribute.factors.len() == 1 => Ok(self.declared_as(all)),
                    _ => Err(self.acts_nowhere(&force.value)),
                },
                Some(name) => self.named(name, " to act on"),
            };
            let again = |factors: &Factors| factors.indices().any(|factor| acted.contains(&factor));
            let factors = match (factors, &force.factor) {
                (Ok(factors), Some(name)) if again(&factors) => {
                    diagnostics.fail(name, "a force acts on this already; add one to the other")
                }
                (Ok(factors), _) => Some(factors),
                (Err(error), _) => {
                    if self.groups_are_known() {
                        diagnostics.absorb(error);
                    }
                    None
                }
            };
            acted.extend(factors.iter().flat_map(Factors::indices));
            Force { factors, value: &force.value }
        });
        forces.collect()
    }

    /// Says that a force does not say what it acts on.
    fn acts_nowhere(&self, force: &syn::Expr) -> syn::Error {
        let first =
            self.factors.first().map_or("attitude".to_owned(), |factor| factor.name.ident.to_string());
        syn::Error::new_spanned(force, format!("on what does this force act? Write `force({first} = …)`"))
    }

    /// The numbers that the system is made of: all of them the same.
    pub(super) fn scalar(&self, diagnostics: &mut Diagnostics) -> ScalarType {
        let Attribute { scalar, controls, .. } = self.attribute;
        let fields = self.item.fields.iter().map(|field| (field.scalar, &field.ty));
        let controls =
            controls.iter().filter_map(|control| control.scalar.as_ref().map(|(of, ty)| (*of, ty)));
        let first = scalar.or_else(|| fields.clone().chain(controls.clone()).next().map(|(of, _)| of));
        let expected = first.unwrap_or(ScalarType::F64);
        // fields that are not alike were reported
        let fields = fields.filter(|_| scalar.is_some());
        for (scalar, ty) in fields.chain(controls).filter(|(scalar, _)| *scalar != expected) {
            let (here, there) = (scalar_name(scalar), scalar_name(expected));
            let message =
                format!("this is made of `{here}`, but the system of `{there}`; use one of them for all");
            diagnostics.push(ty, message);
        }
        expected
    }

    /// The names whose declarations are in error.
    pub(super) fn unknown_names(&self, advected: &[Advected<'_>]) -> Vec<String> {
        let mut names: Vec<String> = self.item.unreadable.iter().map(|field| plain(&field.name)).collect();
        for (key, name) in &self.attribute.unreadable {
            match *key {
                Key::Group => names.extend(unknown_factor(Some(name))),
                _ => names.push(plain(name)),
            }
        }
        let found = |name: &Ident| advected.iter().any(|advected| advected.name.ident == *name);
        let lost = self.attribute.advected.iter().filter(|parameter| !found(&parameter.name));
        names.extend(lost.map(|parameter| plain(&parameter.name)));
        if self.attribute.factors.is_empty() {
            names.extend(unknown_factor(None));
        }
        let unknown = self.attribute.factors.iter().zip(&self.groups).filter(|(_, group)| group.is_none());
        names.extend(unknown.flat_map(|(factor, _)| unknown_factor(factor.name.as_ref())));
        names
    }
}

/// What a factor is called, or may be called if it has no name of its own, whose group is not known.
fn unknown_factor(name: Option<&Ident>) -> Vec<String> {
    let momentum = momentum_name(name);
    let mut names = match name {
        Some(name) => vec![plain(name)],
        None => group::catalogue().iter().map(|group| group.names().configuration.to_owned()).collect(),
    };
    let parts = group::catalogue().iter().flat_map(|group| group.names().parts);
    for part in parts {
        names.push(part_name(&plain(&momentum), part));
        names.push(part_name(&velocity_name(&momentum), part));
    }
    names.push(velocity_name(&momentum));
    names.push(plain(&momentum));
    names
}
