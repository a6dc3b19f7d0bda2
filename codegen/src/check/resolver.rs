//! A description while it is resolved: its factors, and which of them are meant.

use std::ops::Range;

use proc_macro2::Span;
use quote::format_ident;
use syn::Ident;

use super::groups::group;
use super::{Factor, Factors, momentum_name};
use crate::diagnostics::{Diagnostics, suggestion};
use crate::group::Group;
use crate::identifiers::Name;
use crate::limits::DIMENSION;
use crate::parse::{self, Attribute, FactorName, Item, Key};

/// A description while it is resolved.
pub(super) struct Resolver<'d> {
    pub(super) attribute: &'d Attribute,
    pub(super) item: &'d Item,
    /// The groups of what is declared as a factor or an array of them, as far as they are known.
    pub(super) groups: Vec<Option<&'static dyn Group>>,
    /// The factors whose groups are known, one after the other.
    pub(super) factors: Vec<Factor>,
    /// Which of them each declaration stands for.
    pub(super) declared_factors: Vec<Range<usize>>,
}

impl<'d> Resolver<'d> {
    /// Finds the groups: of the catalogue, of a family, or of a basis of the user's own.
    pub(super) fn new(attribute: &'d Attribute, item: &'d Item, diagnostics: &mut Diagnostics) -> Self {
        let retractions = &attribute.retractions;
        let mut dimension = 0;
        let known = |factor: &parse::Factor| {
            // nothing more is looked up for a system that is too large already
            if dimension > DIMENSION {
                return None;
            }
            let group = group(&factor.group, &attribute.definitions, retractions, diagnostics)?;
            dimension += group.dimension() * factor.length.unwrap_or(1);
            if dimension > DIMENSION {
                let name = factor.name.as_ref().unwrap_or_else(|| factor.group.keyword());
                let message = format!(
                    "the factors of a system may have dimension {DIMENSION} together; up to here they have {dimension}"
                );
                return diagnostics.fail(name, message);
            }
            Some(group)
        };
        let groups: Vec<_> = attribute.factors.iter().map(known).collect();
        let (mut factors, mut declared_factors) = (Vec::new(), Vec::new());
        for (factor, group) in attribute.factors.iter().zip(&groups) {
            let Some(group) = *group else { continue };
            let start = factors.len();
            factors.extend(elements(factor, group));
            declared_factors.push(start..factors.len());
        }
        if attribute.factors.is_empty() && !attribute.has(Key::Group) {
            let example = Key::Group.example();
            let message = format!(
                "the group of the configuration is missing; write `#[lie_poisson_system({example}, …)]`"
            );
            diagnostics.push_at(Span::call_site(), message);
        }
        Self { attribute, item, groups, factors, declared_factors }
    }

    /// Whether all factors' groups are known, so that something can be missing.
    pub(super) fn groups_are_known(&self) -> bool {
        let readable = !self.attribute.unreadable.iter().any(|&(key, _)| key == Key::Group);
        readable && !self.factors.is_empty() && self.groups.iter().all(Option::is_some)
    }

    /// The factors that a declaration stands for.
    pub(super) fn declared_as(&self, factors: &Range<usize>) -> Factors {
        match self.factors[factors.start].name.place {
            None => Factors::One(factors.start),
            Some(_) => Factors::All(factors.clone()),
        }
    }

    /// The factors of this name; what to say if there are none. `what` says in the message what for: ` of the group`.
    pub(super) fn named(&self, name: &FactorName, what: &str) -> syn::Result<Factors> {
        let is_named = |factors: &&Range<usize>| self.factors[factors.start].name.ident == name.ident;
        let Some(factors) = self.declared_factors.iter().find(is_named) else {
            let ident = &name.ident;
            let message = format!("there is no factor `{ident}`{what}{}", self.factor_suggestion(ident));
            return Err(syn::Error::new_spanned(ident, message));
        };
        let all = self.declared_as(factors);
        let Some(index) = &name.index else { return Ok(all) };
        let message = match all {
            Factors::One(_) => format!("`{}` is one factor, not an array of them", name.ident),
            Factors::All(factors) if index.value < factors.len() => {
                return Ok(Factors::One(factors.start + index.value));
            }
            Factors::All(factors) => {
                format!("`{}` has {} factors, 0 to {}", name.ident, factors.len(), factors.len() - 1)
            }
        };
        Err(syn::Error::new_spanned(&index.literal, message))
    }

    /// The suggestion after a name that no factor has.
    fn factor_suggestion(&self, written: &Ident) -> String {
        let known = self.factors.iter().filter(|factor| factor.name.is_first());
        let known: Vec<String> = known.map(|factor| factor.name.ident.to_string()).collect();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        suggestion(&written.to_string(), &known)
    }
}

/// A factor, or each of an array of them.
fn elements(factor: &parse::Factor, group: &'static dyn Group) -> impl Iterator<Item = Factor> {
    let own = factor.name.clone().unwrap_or_else(|| format_ident!("{}", group.names().configuration));
    let momentum = momentum_name(factor.name.as_ref());
    Name::all(&own, factor.length).into_iter().map(move |name| Factor {
        momentum_name: Name { ident: momentum.clone(), place: name.place },
        name,
        group,
    })
}
