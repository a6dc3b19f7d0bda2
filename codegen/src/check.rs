//! What must hold between the parts of a description, one function for each rule.

use proc_macro2::Span;
use quote::format_ident;
use syn::Ident;
use syn::ext::IdentExt;

use crate::diagnostics::{Diagnostics, list, suggestion};
use crate::group::{self, Group};
use crate::parse::{Attribute, Factor, GROUP, Inertia, Item, Shape};
use crate::scheme::Rule;

/// A description, seen as a whole.
struct Subject<'d> {
    attribute: &'d Attribute,
    item: &'d Item,
}

/// The group of this name.
pub fn group(name: &Ident) -> Option<&'static dyn Group> {
    group::catalogue().iter().copied().find(|group| name == group.name())
}

/// What a factor's configuration is called.
pub fn factor_name(factor: &Factor, group: &dyn Group) -> Ident {
    factor.name.clone().unwrap_or_else(|| format_ident!("{}", group.configuration_name()))
}

/// What a factor's momentum is called: `momentum` where there is only one group, `attitude_momentum` for a factor `attitude`.
pub fn momentum_name(factor: &Factor) -> Ident {
    match &factor.name {
        Some(name) => format_ident!("{}_momentum", name.unraw(), span = name.span()),
        None => format_ident!("momentum"),
    }
}

impl Subject<'_> {
    /// The factors whose groups are known: what they are called, and their groups.
    fn factors(&self) -> Vec<(Ident, &'static dyn Group)> {
        let known = |factor: &Factor| {
            let group = group(&factor.group)?;
            Some((factor_name(factor, group), group))
        };
        self.attribute.factors.iter().filter_map(known).collect()
    }

    /// Whether all factors' groups are known, so that something can be missing.
    fn groups_are_known(&self) -> bool {
        !self.attribute.factors.is_empty() && self.factors().len() == self.attribute.factors.len()
    }

    /// The fields marked as inertia, readable or not.
    fn inertias(&self) -> Vec<(&Ident, &Inertia)> {
        let readable = self.item.fields.iter().map(|field| (&field.name, &field.inertia));
        let unreadable = self.item.unreadable.iter().map(|field| (&field.name, &field.inertia));
        readable.chain(unreadable).filter_map(|(name, inertia)| Some((name, inertia.as_ref()?))).collect()
    }

    fn field_names(&self) -> impl Iterator<Item = &Ident> {
        let unreadable = self.item.unreadable.iter().map(|field| &field.name);
        self.item.fields.iter().map(|field| &field.name).chain(unreadable)
    }

    /// The names that the attribute gives: factors, advected parameters, controls; with what they are.
    fn declared(&self) -> Vec<(&Ident, &'static str)> {
        let Attribute { factors, advected, controls, .. } = self.attribute;
        let factors =
            factors.iter().filter_map(|factor| Some((factor.name.as_ref()?, "a factor of the group")));
        let advected = advected.iter().map(|advected| (&advected.name, "an advected parameter"));
        let controls = controls.iter().map(|control| (&control.name, "a control"));
        factors.chain(advected).chain(controls).collect()
    }
}

/// The rules, in the order in which their complaints are listed.
const RULES: [fn(&Subject<'_>, &mut Diagnostics); 10] = [
    groups_are_known,
    hamiltonian_says_all,
    inertia_names_factors,
    inertia_is_there_once,
    inertia_fits_the_group,
    spaces_are_known,
    names_are_free,
    names_are_distinct,
    forces_act_on_factors,
    controls_are_of_one_scalar,
];

/// Reports every rule that a description breaks.
pub fn structure(attribute: &Attribute, item: &Item, diagnostics: &mut Diagnostics) {
    let subject = Subject { attribute, item };
    RULES.iter().for_each(|rule| rule(&subject, diagnostics));
}

/// A system moves on groups of the catalogue.
fn groups_are_known(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    let names: Vec<&str> = group::catalogue().iter().map(|group| group.name()).collect();
    for factor in &subject.attribute.factors {
        if group(&factor.group).is_none() {
            let name = factor.group.to_string();
            diagnostics
                .push(&factor.group, format!("there is no group `{name}`{}", suggestion(&name, &names)));
        }
    }
    if subject.attribute.factors.is_empty() && !subject.attribute.has(GROUP) {
        let message = format!(
            "the group of the configuration is missing; write `#[lie_poisson_system({}, …)]`",
            GROUP.example
        );
        diagnostics.push_at(Span::call_site(), message);
    }
}

/// A Hamiltonian takes the place of inertia and potential.
fn hamiltonian_says_all(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    let Some(hamiltonian) = &subject.attribute.hamiltonian else { return };
    if subject.attribute.potential.is_some() {
        diagnostics.push(
            hamiltonian,
            "the Hamiltonian is the whole energy; add the potential to it, or leave it out",
        );
    }
    if subject.attribute.methods.contains(&Rule::TangentLift) {
        diagnostics.push(
            hamiltonian,
            "the tangent lift is made from an inertia; leave out `TangentLift`, or the Hamiltonian",
        );
    }
    for (_, mark) in subject.inertias() {
        let message = "the Hamiltonian says how the energy depends on the momentum; leave out `#[inertia]`";
        diagnostics.push_at(mark.span, message);
    }
}

/// `#[inertia(…)]` names factors.
fn inertia_names_factors(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    if !subject.groups_are_known() {
        return;
    }
    let factors: Vec<String> = subject.factors().iter().map(|(name, _)| name.to_string()).collect();
    let known: Vec<&str> = factors.iter().map(String::as_str).collect();
    for (_, mark) in subject.inertias() {
        for (i, name) in mark.factors.iter().enumerate() {
            let text = name.to_string();
            if !factors.contains(&text) {
                let message =
                    format!("there is no factor `{text}` of the group{}", suggestion(&text, &known));
                diagnostics.push(name, message);
            } else if mark.factors[..i].contains(name) {
                diagnostics.push(name, format!("`{text}` is named twice; keep one of them"));
            }
        }
    }
}

/// Each factor has exactly one inertia.
fn inertia_is_there_once(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    if subject.attribute.hamiltonian.is_some() {
        return;
    }
    let inertias = subject.inertias();
    if inertias.is_empty() {
        let message = "which parameter is the inertia? Mark one field with `#[inertia]`";
        diagnostics.push(&subject.item.name, message);
        return;
    }
    let factors = subject.factors();
    if factors.len() <= 1 {
        if inertias.len() > 1 {
            let names = list(inertias.iter().map(|(name, _)| name.to_string()));
            for (_, mark) in inertias {
                let message =
                    format!("a system has one inertia, but {names} are marked; keep one `#[inertia]`");
                diagnostics.push_at(mark.span, message);
            }
        }
        return;
    }
    for (factor, _) in &factors {
        let of: Vec<_> = inertias
            .iter()
            .filter(|(_, mark)| mark.factors.is_empty() || mark.factors.contains(factor))
            .collect();
        match of.as_slice() {
            [] => {
                let message =
                    format!("`{factor}` has no inertia; mark one field with `#[inertia({factor})]`");
                diagnostics.push(&subject.item.name, message);
            }
            [_] => {}
            several => {
                let names = list(several.iter().map(|(name, _)| name.to_string()));
                let (_, mark) = several[several.len() - 1];
                let message = format!(
                    "`{factor}` has several inertias, {names}; `#[inertia(…)]` names the factors of each"
                );
                diagnostics.push_at(mark.span, message);
            }
        }
    }
}

/// An inertia is a scalar, the diagonal of a matrix, or a matrix, of the dimension of the factors that it is for.
fn inertia_fits_the_group(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    if !subject.groups_are_known() {
        return;
    }
    let factors = subject.factors();
    for field in &subject.item.fields {
        let Some(mark) = &field.inertia else { continue };
        let of: Vec<_> = factors
            .iter()
            .filter(|(name, _)| mark.factors.is_empty() || mark.factors.contains(name))
            .collect();
        let n: usize = of.iter().map(|(_, group)| group.dimension()).sum();
        let fits = match field.shape {
            Shape::Scalar => true,
            Shape::Vector(length) => length == n,
            Shape::Matrix(rows, columns) => rows == n && columns == n,
        };
        if !fits && n > 0 {
            let groups = list(of.iter().map(|(_, group)| group.name()));
            let (has, moments) = match of.len() {
                1 => ("has", "principal moments"),
                _ => ("together have", "a diagonal"),
            };
            let message = format!(
                "{groups} {has} dimension {n}, so its inertia is a vector of {n} ({moments}), a {n}×{n} matrix or a \
                 scalar, but this is {}",
                field.shape.describe()
            );
            diagnostics.push(&field.ty, message);
        }
    }
}

/// Advected parameters live in spaces that a factor acts on.
fn spaces_are_known(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    if !subject.groups_are_known() {
        return;
    }
    let factors = subject.factors();
    let acts =
        |group: &dyn Group, space: &str| group.representations().iter().any(|known| known.name() == space);
    for parameter in &subject.attribute.advected {
        let space = parameter.space.to_string();
        let of: Vec<&(Ident, &dyn Group)> = match &parameter.factor {
            None => factors.iter().collect(),
            Some(name) => factors.iter().filter(|(factor, _)| factor == name).collect(),
        };
        if let (Some(name), true) = (&parameter.factor, of.is_empty()) {
            let known: Vec<String> = factors.iter().map(|(factor, _)| factor.to_string()).collect();
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let message = format!("there is no factor `{name}`{}", suggestion(&name.to_string(), &known));
            diagnostics.push(name, message);
            continue;
        }
        let acting: Vec<String> = of
            .iter()
            .filter(|(_, group)| acts(*group, &space))
            .map(|(factor, _)| factor.to_string())
            .collect();
        match acting.as_slice() {
            [_] => {}
            [] => {
                let groups = list(of.iter().map(|(_, group)| group.name()));
                let known: Vec<&str> = of
                    .iter()
                    .flat_map(|(_, group)| group.representations().iter().map(|space| space.name()))
                    .collect();
                let rest = if known.is_empty() { String::new() } else { suggestion(&space, &known) };
                let message = match of.len() {
                    1 => format!("{groups} does not act on a space `{space}`{rest}"),
                    _ => format!("none of {groups} acts on a space `{space}`{rest}"),
                };
                diagnostics.push(&parameter.space, message);
            }
            [first, ..] => {
                let message = format!(
                    "which factor acts on `{}`, {}? Write `{}: {first}::{space}`",
                    parameter.name,
                    acting.join(" or "),
                    parameter.name
                );
                diagnostics.push(&parameter.space, message);
            }
        }
    }
}

/// Parameters do not take names that mean something else.
fn names_are_free(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    let mut reserved: Vec<(String, &str)> =
        vec![("t".to_owned(), "the time"), ("time".to_owned(), "the time")];
    for factor in &subject.attribute.factors {
        let momentum = momentum_name(factor);
        reserved.push((crate::identifiers::velocity_name(&momentum), "the velocity"));
        reserved.push((momentum.to_string(), "the momentum"));
        if let (None, Some(group)) = (&factor.name, group(&factor.group)) {
            reserved.push((group.configuration_name().to_owned(), "the configuration"));
        }
    }
    let declared = subject.declared();
    for name in subject.field_names().chain(declared.iter().map(|&(name, _)| name)) {
        if let Some((_, meaning)) = reserved.iter().find(|(reserved, _)| name == reserved) {
            diagnostics.push(name, format!("`{name}` is {meaning} of this system; choose another name"));
        } else if name.to_string().starts_with("__") {
            diagnostics
                .push(name, "names that begin with `__` belong to the generated code; choose another name");
        }
    }
}

/// An expression can tell everything that has a name from everything else.
fn names_are_distinct(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    let declared = subject.declared();
    for (i, (name, what)) in declared.iter().enumerate() {
        if subject.field_names().any(|field| field == *name) {
            let message = format!(
                "`{name}` is also a field of `{}`; {what} needs a name of its own",
                subject.item.name
            );
            diagnostics.push(name, message);
        }
        if let Some((_, other)) =
            declared[..i].iter().find(|(earlier, other)| earlier == name && other != what)
        {
            diagnostics.push(name, format!("`{name}` is also {other}; choose another name"));
        }
    }
}

/// A force acts on a factor, and says on which.
fn forces_act_on_factors(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    if !subject.groups_are_known() {
        return;
    }
    let factors: Vec<String> = subject.factors().iter().map(|(name, _)| name.to_string()).collect();
    let known: Vec<&str> = factors.iter().map(String::as_str).collect();
    for force in &subject.attribute.forces {
        match &force.factor {
            None if factors.len() > 1 => {
                let message = format!("on what does this force act? Write `force({} = …)`", factors[0]);
                diagnostics.push(&force.value, message);
            }
            Some(name) if !factors.contains(&name.to_string()) => {
                let message =
                    format!("there is no factor `{name}` to act on{}", suggestion(&name.to_string(), &known));
                diagnostics.push(name, message);
            }
            _ => {}
        }
    }
}

/// Controls are made of the same numbers as parameters.
fn controls_are_of_one_scalar(subject: &Subject<'_>, diagnostics: &mut Diagnostics) {
    let fields = subject.item.fields.first().map(|field| field.scalar);
    let controls = subject.attribute.controls.iter().find_map(|control| Some(control.scalar.as_ref()?.0));
    let Some(expected) = fields.or(controls) else { return };
    for control in &subject.attribute.controls {
        if let Some((scalar, ty)) = &control.scalar
            && *scalar != expected
        {
            let (here, there) = (scalar.name(), expected.name());
            let message =
                format!("this is made of `{here}`, but the system of `{there}`; use one of them for all");
            diagnostics.push(ty, message);
        }
    }
}
