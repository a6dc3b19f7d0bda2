//! What must hold between the parts of a description, one function for each rule.

use proc_macro2::Span;
use syn::Ident;
use syn::ext::IdentExt;

use crate::diagnostics::{Diagnostics, list, suggestion};
use crate::expr::{Arena, Stage};
use crate::language::{Scope, Value, lower_scalar};
use crate::parse::{Attribute, GROUP, Item, Shape};

/// What the rules need to know about a group of the catalogue.
#[derive(Clone, Debug)]
pub struct GroupFacts {
    /// As the user writes it.
    pub name: &'static str,
    /// The dimension of its Lie algebra.
    pub dimension: usize,
    /// The spaces it acts on, with their dimensions.
    pub spaces: Vec<(&'static str, usize)>,
}

/// A description, together with what it is measured by.
struct Subject<'d> {
    attribute: &'d Attribute,
    item: &'d Item,
    catalogue: &'d [GroupFacts],
}

impl Subject<'_> {
    /// The group, if it is one of the catalogue.
    fn group(&self) -> Option<&GroupFacts> {
        let name = self.attribute.group.as_ref()?;
        self.catalogue.iter().find(|group| name == group.name)
    }

    /// The fields marked as inertia, readable or not.
    fn inertias(&self) -> Vec<(&Ident, Span)> {
        let readable = self.item.fields.iter().map(|field| (&field.name, field.inertia));
        let unreadable = self.item.unreadable.iter().map(|field| (&field.name, field.inertia));
        readable.chain(unreadable).filter_map(|(name, inertia)| Some((name, inertia?))).collect()
    }

    fn field_names(&self) -> impl Iterator<Item = &Ident> {
        let unreadable = self.item.unreadable.iter().map(|field| &field.name);
        self.item.fields.iter().map(|field| &field.name).chain(unreadable)
    }
}

/// The rules, in the order in which their complaints are listed.
const RULES: [fn(&Subject<'_>, &mut Diagnostics); 6] = [
    group_is_known,
    inertia_is_there_once,
    inertia_fits_the_group,
    spaces_are_known,
    names_are_free,
    advected_are_not_fields,
];

/// Reports every rule that a description breaks.
pub fn structure(
    attribute: &Attribute,
    item: &Item,
    catalogue: &[GroupFacts],
    diagnostics: &mut Diagnostics,
) {
    let subject = Subject { attribute, item, catalogue };
    RULES.iter().for_each(|rule| rule(&subject, diagnostics));
}

/// Reports all problems of the potential, which must be a scalar in parameters and advected parameters.
///
/// Its meaning is worked out for the sake of problems alone, so that they are reported together with all others, a missing
/// group or inertia included.
pub fn potential(
    attribute: &Attribute,
    item: &Item,
    catalogue: &[GroupFacts],
    diagnostics: &mut Diagnostics,
) {
    let Some(potential) = &attribute.potential else { return };
    let subject = Subject { attribute, item, catalogue };
    let (arena, mut scope) = (Arena::new(), Scope::new());
    for field in &item.fields {
        let name = field.name.unraw().to_string();
        let value = Value::symbols(&arena, &name, field.shape, Stage::Parameters);
        scope.define(name, value);
    }
    for field in &item.unreadable {
        scope.define_unknown(field.name.unraw().to_string());
    }
    for parameter in &attribute.advected {
        let name = parameter.name.unraw().to_string();
        let mut spaces = subject.group().into_iter().flat_map(|group| &group.spaces);
        match spaces.find(|(space, _)| parameter.space == space) {
            Some(&(_, n)) => {
                let value = Value::symbols(&arena, &name, Shape::Vector(n), Stage::Step);
                scope.define(name, value);
            }
            None => scope.define_unknown(name),
        }
    }
    lower_scalar("the potential", potential, &mut scope, &arena, diagnostics);
}

/// A system moves on a group of the catalogue.
fn group_is_known(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    let names: Vec<&str> = subject.catalogue.iter().map(|group| group.name).collect();
    match &subject.attribute.group {
        Some(group) if subject.group().is_none() => {
            let name = group.to_string();
            diagnostics.push(group, format!("there is no group `{name}`{}", suggestion(&name, &names)));
        }
        Some(_) => {}
        None if subject.attribute.has(GROUP) => {}
        None => {
            let message = format!(
                "the group of the configuration is missing; write `#[lie_poisson_system({}, …)]`",
                GROUP.example
            );
            diagnostics.push_at(Span::call_site(), message);
        }
    }
}

/// Exactly one field is the inertia.
fn inertia_is_there_once(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    match subject.inertias().as_slice() {
        [] => diagnostics
            .push(&subject.item.name, "which parameter is the inertia? Mark one field with `#[inertia]`"),
        [_] => {}
        several => {
            let names = list(several.iter().map(|(name, _)| name.to_string()));
            for (_, mark) in several {
                let message =
                    format!("a system has one inertia, but {names} are marked; keep one `#[inertia]`");
                diagnostics.push_at(*mark, message);
            }
        }
    }
}

/// The inertia is a scalar, the diagonal of a matrix, or a matrix, of the group's dimension.
fn inertia_fits_the_group(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    let Some(group) = subject.group() else { return };
    let n = group.dimension;
    for field in subject.item.fields.iter().filter(|field| field.inertia.is_some()) {
        let fits = match field.shape {
            Shape::Scalar => true,
            Shape::Vector(length) => length == n,
            Shape::Matrix(rows, columns) => rows == n && columns == n,
        };
        if !fits {
            let message = format!(
                "{} has dimension {n}, so its inertia is a vector of {n} (principal moments), a {n}×{n} matrix or a \
                 scalar, but this is {}",
                group.name,
                field.shape.describe()
            );
            diagnostics.push(&field.ty, message);
        }
    }
}

/// Advected parameters live in spaces that the group acts on.
fn spaces_are_known(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    let Some(group) = subject.group() else { return };
    let names: Vec<&str> = group.spaces.iter().map(|(name, _)| *name).collect();
    for parameter in &subject.attribute.advected {
        let space = parameter.space.to_string();
        if !names.contains(&space.as_str()) {
            let message =
                format!("{} does not act on a space `{space}`{}", group.name, suggestion(&space, &names));
            diagnostics.push(&parameter.space, message);
        }
    }
}

/// Names with a meaning of their own in every system.
const RESERVED: [(&str, &str); 4] = [
    ("attitude", "the configuration"),
    ("momentum", "the momentum"),
    ("t", "the time"),
    ("time", "the time"),
];

/// Parameters do not take names that mean something else.
fn names_are_free(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    let advected = subject.attribute.advected.iter().map(|parameter| &parameter.name);
    for name in subject.field_names().chain(advected) {
        if let Some((_, meaning)) = RESERVED.iter().find(|(reserved, _)| name == reserved) {
            diagnostics.push(name, format!("`{name}` is {meaning} of every system; choose another name"));
        } else if name.to_string().starts_with("__") {
            diagnostics
                .push(name, "names that begin with `__` belong to the generated code; choose another name");
        }
    }
}

/// An expression can tell a parameter from an advected one.
fn advected_are_not_fields(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    for parameter in &subject.attribute.advected {
        if subject.field_names().any(|field| *field == parameter.name) {
            let message = format!(
                "`{}` is also a field of `{}`; the advected parameter is part of the state and needs a name of its own",
                parameter.name, subject.item.name
            );
            diagnostics.push(&parameter.name, message);
        }
    }
}
