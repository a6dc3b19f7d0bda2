//! The rules for advected parameters: each lives in a space that a factor acts on, and on which only one does.

use std::ops::Range;

use super::groups::{known_space, nothing_acts, space};
use super::resolver::Resolver;
use super::{Advected, Factors};
use crate::diagnostics::Diagnostics;
use crate::group::Representation;
use crate::identifiers::Name;
use crate::parse;

impl<'d> Resolver<'d> {
    /// Advected parameters live in spaces that a factor acts on, and on which only one does.
    pub(super) fn advected(&self, diagnostics: &mut Diagnostics) -> Vec<Advected<'d>> {
        if !self.groups_are_known() {
            return Vec::new();
        }
        let parameters = self.attribute.advected.iter();
        parameters.flat_map(|parameter| self.acted_on(parameter, diagnostics).unwrap_or_default()).collect()
    }

    /// The parameter; where an array of factors acts on it, an array with one for each.
    fn acted_on(
        &self,
        written: &'d parse::Advected,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<Advected<'d>>> {
        let candidates = match &written.factor {
            None => 0..self.factors.len(),
            Some(name) => match self.named(name, "") {
                Ok(Factors::One(factor)) => factor..factor + 1,
                Ok(Factors::All(factors)) => return self.one_for_each(written, factors, diagnostics),
                Err(error) => {
                    diagnostics.absorb(error);
                    return None;
                }
            },
        };
        let name = Name { ident: written.name.clone(), place: None };
        if candidates.len() == 1 {
            let factor = candidates.start;
            let space = space(self.factors[factor].group, &written.space, diagnostics)?;
            return Some(vec![Advected { name, written, factor, space }]);
        }
        let wanted = written.space.to_string();
        let parse::Space::Named(keyword) = &written.space else {
            let message =
                format!("which factor acts on `{}`? Write {}", written.name, self.example(written, 0));
            return diagnostics.fail(written.space.keyword(), message);
        };
        let acting: Vec<(usize, &'static dyn Representation)> = candidates
            .clone()
            .filter_map(|factor| Some((factor, known_space(self.factors[factor].group, &wanted)?)))
            .collect();
        match acting.as_slice() {
            &[(factor, space)] => Some(vec![Advected { name, written, factor, space }]),
            [] => {
                let groups: Vec<_> = candidates.map(|factor| self.factors[factor].group).collect();
                diagnostics.fail(keyword, nothing_acts(&groups, &wanted))
            }
            &[(first, _), ..] => {
                let names = acting.iter().map(|&(factor, _)| &self.factors[factor].name);
                let names: Vec<String> =
                    names.filter(|name| name.is_first()).map(|name| name.ident.to_string()).collect();
                let (name, example, all) = (&written.name, self.example(written, first), names.join(" or "));
                let message = match names.len() {
                    1 => format!("which of `{all}` acts on `{name}`? Write {example}"),
                    _ => format!("which factor acts on `{name}`, {all}? Write {example}"),
                };
                diagnostics.fail(keyword, message)
            }
        }
    }

    /// An array of parameters, each acted on by its own of an array of factors.
    fn one_for_each(
        &self,
        written: &'d parse::Advected,
        factors: Range<usize>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<Advected<'d>>> {
        let space = space(self.factors[factors.start].group, &written.space, diagnostics)?;
        let names = Name::all(&written.name, Some(factors.len())).into_iter();
        let each = |(name, factor)| Advected { name, written, factor, space };
        Some(names.zip(factors).map(each).collect())
    }

    /// How to say that this factor acts on a parameter.
    fn example(&self, parameter: &parse::Advected, factor: usize) -> String {
        let (name, space, factor) = (&parameter.name, &parameter.space, &self.factors[factor].name);
        let one = format!("`{name}: {}::{space}`", factor.written());
        match factor.place {
            None => one,
            Some(_) => {
                let all = &factor.ident;
                format!("{one} for one of them, `{name}: {all}::{space}` for an array with one each")
            }
        }
    }
}
