//! What must hold between the parts of a description, one function for each rule.

use proc_macro2::Span;
use quote::format_ident;
use syn::Ident;

use super::groups::{group, known_space, space};
use super::{Advected, Factor, Force, Inertia, InertiaShape, momentum_name};
use crate::diagnostics::{Diagnostics, list, suggestion};
use crate::group::{self, Group, Representation, Retraction, is_same, part_name};
use crate::identifiers::{plain, velocity_name};
use crate::limits::DIMENSION;
use crate::parse::{self, Attribute, Field, GROUP, Item, Shape};

/// A description while it is resolved.
pub(super) struct Subject<'d> {
    attribute: &'d Attribute,
    item: &'d Item,
    /// The groups of all factors, as far as they are known.
    groups: Vec<Option<&'static dyn Group>>,
    /// The factors whose groups are known.
    factors: Vec<Factor>,
}

impl<'d> Subject<'d> {
    /// Finds the groups: of the catalogue, of a family, or of a basis of the user's own.
    pub(super) fn new(attribute: &'d Attribute, item: &'d Item, diagnostics: &mut Diagnostics) -> Self {
        let retractions = attribute.named_retractions();
        let mut dimension = 0;
        let known = |factor: &parse::Factor| {
            // nothing more is looked up for a system that is too large already
            if dimension > DIMENSION {
                return None;
            }
            let group = group(&factor.group, &attribute.definitions, retractions, diagnostics)?;
            dimension += group.dimension();
            if dimension > DIMENSION {
                let name = factor.name.as_ref().unwrap_or_else(|| factor.group.keyword());
                diagnostics.push(name, format!("a system may have dimension {DIMENSION} at most"));
                return None;
            }
            Some(group)
        };
        let groups: Vec<_> = attribute.factors.iter().map(known).collect();
        let mut factors = Vec::new();
        for (factor, group) in attribute.factors.iter().zip(&groups) {
            let Some(group) = *group else { continue };
            let name = factor.name.clone();
            factors.push(Factor {
                name: name.unwrap_or_else(|| format_ident!("{}", group.configuration_name())),
                momentum_name: momentum_name(factor.name.as_ref()),
                group,
            });
        }
        if attribute.factors.is_empty() && !attribute.has(GROUP) {
            let message = format!(
                "the group of the configuration is missing; write `#[lie_poisson_system({}, …)]`",
                GROUP.example
            );
            diagnostics.push_at(Span::call_site(), message);
        }
        Self { attribute, item, groups, factors }
    }

    pub(super) fn into_factors(self) -> Vec<Factor> {
        self.factors
    }

    /// Whether all factors' groups are known, so that something can be missing.
    fn groups_are_known(&self) -> bool {
        let readable = !self.attribute.unreadable.iter().any(|&(key, _)| key == GROUP);
        readable && !self.factors.is_empty() && self.factors.len() == self.attribute.factors.len()
    }

    /// The factor of this name.
    fn factor(&self, name: &Ident) -> Option<usize> {
        self.factors.iter().position(|factor| factor.name == *name)
    }

    /// What to say after a name that no factor has.
    fn factor_suggestion(&self, written: &Ident) -> String {
        let known: Vec<String> = self.factors.iter().map(|factor| factor.name.to_string()).collect();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        suggestion(&written.to_string(), &known)
    }

    /// The factors that a mark `#[inertia(…)]` names, all if it names none.
    fn marked_factors(&self, mark: &parse::Inertia) -> Vec<usize> {
        match mark.factors.as_slice() {
            [] => (0..self.factors.len()).collect(),
            names => names.iter().filter_map(|name| self.factor(name)).collect(),
        }
    }

    /// The fields marked as inertia, readable or not.
    fn marks(&self) -> Vec<(&'d Ident, &'d parse::Inertia)> {
        let readable = self.item.fields.iter().map(|field| (&field.name, &field.inertia));
        let unreadable = self.item.unreadable.iter().map(|field| (&field.name, &field.inertia));
        readable.chain(unreadable).filter_map(|(name, inertia)| Some((name, inertia.as_ref()?))).collect()
    }

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
        let Attribute { potential, hamiltonian, lagrangian, .. } = self.attribute;
        if let (Some(hamiltonian), Some(_)) = (hamiltonian, potential) {
            let message = "the Hamiltonian is the whole energy; add the potential to it, or leave it out";
            diagnostics.push(hamiltonian, message);
        }
        if let (Some(lagrangian), Some(_)) = (lagrangian, potential) {
            let message = "the Lagrangian is kinetic less potential energy; subtract the potential in it, or leave it out";
            diagnostics.push(lagrangian, message);
        }
        if let (Some(lagrangian), Some(_)) = (lagrangian, hamiltonian) {
            let message =
                "the Lagrangian says what the Hamiltonian is; give one of `lagrangian` and `hamiltonian`";
            diagnostics.push(lagrangian, message);
        }
    }

    /// The inertias: each factor has exactly one, unless a Hamiltonian or a Lagrangian says what the energy is.
    pub(super) fn inertias(&self, diagnostics: &mut Diagnostics) -> Vec<Inertia> {
        if self.groups_are_known() {
            self.check_named_factors(diagnostics);
        }
        if !self.attribute.has_whole_energy() {
            self.check_coverage(diagnostics);
        }
        let fields = self.item.fields.iter().enumerate();
        let marked = fields.filter_map(|(index, field)| Some((index, field, field.inertia.as_ref()?)));
        let inertias = marked.filter_map(|(index, field, mark)| {
            let (shape, n) = inertia_shape(field.shape);
            let blocks = match self.attribute.has_whole_energy() {
                true => square(field, n, diagnostics).map(|()| Vec::new()),
                false => self.inertia_blocks(field, mark, n, diagnostics),
            };
            Some(Inertia { field: index, shape, blocks: blocks? })
        });
        inertias.collect()
    }

    /// `#[inertia(…)]` names factors.
    fn check_named_factors(&self, diagnostics: &mut Diagnostics) {
        for (_, mark) in self.marks() {
            for (i, name) in mark.factors.iter().enumerate() {
                if self.factor(name).is_none() {
                    let guess = self.factor_suggestion(name);
                    diagnostics.push(name, format!("there is no factor `{name}` of the group{guess}"));
                } else if mark.factors[..i].contains(name) {
                    diagnostics.push(name, format!("`{name}` is named twice; keep one of them"));
                }
            }
        }
    }

    /// Each factor has exactly one inertia.
    fn check_coverage(&self, diagnostics: &mut Diagnostics) {
        let marks = self.marks();
        if marks.is_empty() {
            let message = "which parameter is the inertia? Mark one field with `#[inertia]`";
            diagnostics.push(&self.item.name, message);
            return;
        }
        if !self.groups_are_known() {
            return;
        }
        if self.factors.len() == 1 {
            if marks.len() > 1 {
                let names = list(marks.iter().map(|(name, _)| name.to_string()));
                for (_, mark) in marks {
                    let message =
                        format!("a system has one inertia, but {names} are marked; keep one `#[inertia]`");
                    diagnostics.push_at(mark.span, message);
                }
            }
            return;
        }
        for Factor { name: factor, .. } in &self.factors {
            let of: Vec<_> = marks
                .iter()
                .filter(|(_, mark)| mark.factors.is_empty() || mark.factors.contains(factor))
                .collect();
            match of.as_slice() {
                [] => {
                    let message =
                        format!("`{factor}` has no inertia; mark one field with `#[inertia({factor})]`");
                    diagnostics.push(&self.item.name, message);
                }
                [_] => {}
                [.., (_, last)] => {
                    let names = list(of.iter().map(|(name, _)| name.to_string()));
                    let message = format!(
                        "`{factor}` has several inertias, {names}; `#[inertia(…)]` names the factors of each"
                    );
                    diagnostics.push_at(last.span, message);
                }
            }
        }
    }

    /// An inertia is a scalar, the diagonal of a matrix, or a matrix, of the dimension of the factors that it is for; or, for several factors
    /// with the same group, of the dimension of each. `n` is its own, if it has one.
    fn inertia_blocks(
        &self,
        field: &Field,
        mark: &parse::Inertia,
        n: Option<usize>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<Vec<usize>>> {
        if !self.groups_are_known() {
            return None;
        }
        let factors = self.marked_factors(mark);
        let groups: Vec<&dyn Group> = factors.iter().map(|&factor| self.factors[factor].group).collect();
        let (first, others) = groups.split_first()?;
        let joint: usize = groups.iter().map(|group| group.dimension()).sum();
        let alike = !others.is_empty() && others.iter().all(|group| is_same(*group, *first));
        if n == Some(joint) || field.shape == Shape::Scalar {
            return Some(vec![factors]);
        }
        if alike && n == Some(first.dimension()) {
            return Some(factors.into_iter().map(|factor| vec![factor]).collect());
        }
        let names = list(groups.iter().map(|group| group.name()));
        let (has, moments) = match groups.len() {
            1 => ("has", "principal moments"),
            _ => ("together have", "a diagonal"),
        };
        let each = match first.dimension() {
            d if alike => {
                format!("; where all have the same inertia, a vector of {d} or a {d}×{d} matrix will do")
            }
            _ => String::new(),
        };
        let message = format!(
            "{names} {has} dimension {joint}, so its inertia is a vector of {joint} ({moments}), a {joint}×{joint} matrix \
             or a scalar, but this is {}{each}",
            field.shape.describe()
        );
        diagnostics.push(&field.ty, message);
        None
    }

    /// Advected parameters live in spaces that a factor acts on, and on which only one does.
    pub(super) fn advected(&self, diagnostics: &mut Diagnostics) -> Vec<Advected<'d>> {
        if !self.groups_are_known() {
            return Vec::new();
        }
        let parameters = self.attribute.advected.iter();
        parameters.filter_map(|parameter| self.acted_on(parameter, diagnostics)).collect()
    }

    fn acted_on(
        &self,
        parameter: &'d parse::Advected,
        diagnostics: &mut Diagnostics,
    ) -> Option<Advected<'d>> {
        let candidates: Vec<usize> = match &parameter.factor {
            None => (0..self.factors.len()).collect(),
            Some(name) => match self.factor(name) {
                Some(factor) => vec![factor],
                None => {
                    let guess = self.factor_suggestion(name);
                    diagnostics.push(name, format!("there is no factor `{name}`{guess}"));
                    return None;
                }
            },
        };
        let (wanted, name) = (parameter.space.to_string(), &parameter.name);
        if let &[factor] = candidates.as_slice() {
            let space = space(self.factors[factor].group, &parameter.space, diagnostics)?;
            return Some(Advected { name, factor, space });
        }
        let parse::Space::Named(keyword) = &parameter.space else {
            let message =
                format!("which factor acts on `{name}`? Write `{name}: {}::{wanted}`", self.factors[0].name);
            diagnostics.push(parameter.space.keyword(), message);
            return None;
        };
        let acting: Vec<(usize, &'static dyn Representation)> = candidates
            .iter()
            .filter_map(|&factor| Some((factor, known_space(self.factors[factor].group, &wanted)?)))
            .collect();
        match acting.as_slice() {
            &[(factor, space)] => Some(Advected { name, factor, space }),
            [] => {
                let groups: Vec<_> = candidates.iter().map(|&factor| self.factors[factor].group).collect();
                diagnostics.push(keyword, nothing_acts(&groups, &wanted));
                None
            }
            &[(first, _), ..] => {
                let names: Vec<String> =
                    acting.iter().map(|&(factor, _)| self.factors[factor].name.to_string()).collect();
                let message = format!(
                    "which factor acts on `{name}`, {}? Write `{name}: {}::{wanted}`",
                    names.join(" or "),
                    self.factors[first].name
                );
                diagnostics.push(keyword, message);
                None
            }
        }
    }

    /// There are steps, on all factors and all spaces, with every retraction that is named, or with one of the usual ones.
    pub(super) fn check_retractions(&self, advected: &[Advected<'d>], diagnostics: &mut Diagnostics) {
        if !self.groups_are_known() {
            return;
        }
        let named = self.attribute.named_retractions();
        for (parameter, written) in advected.iter().filter_map(|advected| {
            let written = self.attribute.advected.iter().find(|written| written.name == *advected.name);
            Some((advected, written?))
        }) {
            for retraction in named.iter().filter(|&&retraction| !parameter.space.has(retraction)) {
                let message = format!("there are no steps with `{}` that move this space", retraction.name());
                diagnostics.push(written.space.keyword(), message);
            }
        }
        let has = |retraction: Retraction| {
            self.factors.iter().all(|factor| factor.group.has(retraction))
                && advected.iter().all(|advected| advected.space.has(retraction))
        };
        if named.is_empty() && !Retraction::DEFAULT.into_iter().any(has) {
            let message = "no retraction moves all of these groups and spaces";
            diagnostics.push(self.attribute.factors[0].group.keyword(), message);
        }
    }

    /// No two things have the same name.
    pub(super) fn check_names(&self, diagnostics: &mut Diagnostics) {
        self.names_are_free(diagnostics);
        self.names_are_distinct(diagnostics);
    }

    /// Parameters do not take names that mean something else.
    fn names_are_free(&self, diagnostics: &mut Diagnostics) {
        let mut reserved: Vec<(String, &str)> =
            vec![("t".to_owned(), "the time"), ("time".to_owned(), "the time")];
        for (factor, &group) in self.attribute.factors.iter().zip(&self.groups) {
            let momentum = momentum_name(factor.name.as_ref());
            for part in group.into_iter().flat_map(|group| group.parts()) {
                reserved.push((part_name(&plain(&momentum), part), "a part of the momentum"));
                reserved.push((part_name(&velocity_name(&momentum), part), "a part of the velocity"));
            }
            reserved.push((velocity_name(&momentum), "the velocity"));
            reserved.push((momentum.to_string(), "the momentum"));
            if let (None, Some(group)) = (&factor.name, group) {
                reserved.push((group.configuration_name().to_owned(), "the configuration"));
            }
        }
        let declared = self.declared();
        for name in self.field_names().chain(declared.iter().map(|&(name, _)| name)) {
            if let Some((_, meaning)) = reserved.iter().find(|(reserved, _)| name == reserved) {
                diagnostics.push(name, format!("`{name}` is {meaning} of this system; choose another name"));
            } else if name.to_string().starts_with("__") {
                diagnostics.push(
                    name,
                    "names that begin with `__` belong to the generated code; choose another name",
                );
            }
        }
    }

    /// An expression can tell everything that has a name from everything else.
    fn names_are_distinct(&self, diagnostics: &mut Diagnostics) {
        let declared = self.declared();
        for (i, (name, what)) in declared.iter().enumerate() {
            if self.field_names().any(|field| field == *name) {
                let message = format!(
                    "`{name}` is also a field of `{}`; {what} needs a name of its own",
                    self.item.name
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

    /// The forces: each acts on a factor, and says on which.
    pub(super) fn forces(&self, diagnostics: &mut Diagnostics) -> Vec<Force<'d>> {
        let known = self.groups_are_known();
        let forces = self.attribute.forces.iter().map(|force| {
            let factor = match &force.factor {
                None => (self.attribute.factors.len() == 1 && known).then_some(0),
                Some(name) => self.factor(name),
            };
            match &force.factor {
                None if known && factor.is_none() => {
                    let message =
                        format!("on what does this force act? Write `force({} = …)`", self.factors[0].name);
                    diagnostics.push(&force.value, message);
                }
                Some(name) if known && factor.is_none() => {
                    let guess = self.factor_suggestion(name);
                    diagnostics.push(name, format!("there is no factor `{name}` to act on{guess}"));
                }
                _ => {}
            }
            Force { factor, value: &force.value }
        });
        forces.collect()
    }

    /// Controls are made of the same numbers as parameters.
    pub(super) fn check_scalars(&self, diagnostics: &mut Diagnostics) {
        let fields = self.item.fields.first().map(|field| field.scalar);
        let controls = self.attribute.controls.iter().find_map(|control| Some(control.scalar.as_ref()?.0));
        let Some(expected) = fields.or(controls) else { return };
        for control in &self.attribute.controls {
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

    /// The names whose declarations are in error.
    pub(super) fn unknown_names(&self, advected: &[Advected<'_>]) -> Vec<String> {
        let mut names: Vec<String> = self.item.unreadable.iter().map(|field| plain(&field.name)).collect();
        for (key, name) in &self.attribute.unreadable {
            match *key {
                GROUP => names.extend(unknown_factor(Some(name))),
                _ => names.push(plain(name)),
            }
        }
        let found = |name: &Ident| advected.iter().any(|advected| advected.name == name);
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

/// How an inertia of that shape is given, and of what dimension it is: `None` for a scalar, which is of any, and for what is not square.
fn inertia_shape(shape: Shape) -> (InertiaShape, Option<usize>) {
    match shape {
        Shape::Scalar => (InertiaShape::Scalar, None),
        Shape::Vector(n) => (InertiaShape::Diagonal, Some(n)),
        Shape::Matrix(rows, columns) => (InertiaShape::Matrix, (rows == columns).then_some(rows)),
    }
}

/// An inertia beside a Hamiltonian or a Lagrangian is anything that can be positive definite.
fn square(field: &Field, n: Option<usize>, diagnostics: &mut Diagnostics) -> Option<()> {
    if n.is_some() || field.shape == Shape::Scalar {
        return Some(());
    }
    let found = field.shape.describe();
    diagnostics
        .push(&field.ty, format!("an inertia is a scalar, a vector or a square matrix, but this is {found}"));
    None
}

/// What a factor is called, or may be called if it has no name of its own, whose group is not known.
fn unknown_factor(name: Option<&Ident>) -> Vec<String> {
    let momentum = momentum_name(name);
    let mut names = match name {
        Some(name) => vec![plain(name)],
        None => group::catalogue().iter().map(|group| group.configuration_name().to_owned()).collect(),
    };
    let parts = group::catalogue().iter().flat_map(|group| group.parts());
    for part in parts {
        names.push(part_name(&plain(&momentum), part));
        names.push(part_name(&velocity_name(&momentum), part));
    }
    names.push(velocity_name(&momentum));
    names.push(plain(&momentum));
    names
}

/// Says that none of these groups acts on a space of this name.
pub(super) fn nothing_acts(groups: &[&'static dyn Group], space: &str) -> String {
    let names = list(groups.iter().map(|group| group.name()));
    let mut known: Vec<&str> =
        groups.iter().flat_map(|group| group.representations().iter().map(|space| space.name())).collect();
    known.sort_unstable();
    known.dedup();
    let rest = suggestion(space, &known);
    match groups.len() {
        1 => format!("{names} does not act on a space `{space}`{rest}"),
        _ => format!("none of {names} acts on a space `{space}`{rest}"),
    }
}
