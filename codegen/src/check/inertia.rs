//! The rules for inertias: each factor has exactly one, unless a Hamiltonian or a Lagrangian says what the energy is.

use std::ops::Range;

use syn::Ident;

use super::resolver::Resolver;
use super::{Inertia, InertiaShape};
use crate::diagnostics::{Diagnostics, list};
use crate::group::{Group, is_same};
use crate::identifiers::Name;
use crate::parse::{self, Field};
use crate::quantity::Shape;

impl<'d> Resolver<'d> {
    /// The inertias: each factor has exactly one, unless a Hamiltonian or a Lagrangian says what the energy is.
    pub(super) fn inertias(&self, diagnostics: &mut Diagnostics) -> Vec<Inertia> {
        let groups_are_known = self.groups_are_known();
        if groups_are_known {
            self.check_named_factors(diagnostics);
        }
        if !self.attribute.has_whole_energy() {
            self.check_coverage(diagnostics);
        }
        let mut inertias = Vec::new();
        for (index, field) in self.item.fields.iter().enumerate() {
            let Some(mark) = field.inertia.as_ref() else { continue };
            let (shape, n) = inertia_shape(field.shape);
            let blocks = match (self.attribute.has_whole_energy(), field.length) {
                (true, length) => {
                    square(field, n, diagnostics).map(|()| vec![Vec::new(); length.unwrap_or(1)])
                }
                (false, _) if !groups_are_known => None,
                (false, None) => self.inertia_blocks(field, mark, n, diagnostics).map(|blocks| vec![blocks]),
                (false, Some(length)) => self.inertia_of_each(field, length, mark, n, diagnostics),
            };
            let names = Name::all(&field.name, field.length).into_iter();
            let of_element = |(name, blocks)| Inertia { field: index, name, shape, blocks };
            inertias.extend(names.zip(blocks.unwrap_or_default()).map(of_element));
        }
        inertias
    }

    /// The factors that a mark `#[inertia(…)]` names, all if it names none.
    fn marked_factors(&self, mark: &parse::Inertia) -> Vec<usize> {
        match mark.factors.as_slice() {
            [] => (0..self.factors.len()).collect(),
            names => {
                let known = names.iter().filter_map(|name| self.named(name, "").ok());
                known.flat_map(|factors| factors.indices()).collect()
            }
        }
    }

    /// The fields marked as inertia, readable or not.
    fn marks(&self) -> Vec<(&'d Ident, &'d parse::Inertia)> {
        let readable = self.item.fields.iter().map(|field| (&field.name, &field.inertia));
        let unreadable = self.item.unreadable.iter().map(|field| (&field.name, &field.inertia));
        readable.chain(unreadable).filter_map(|(name, inertia)| Some((name, inertia.as_ref()?))).collect()
    }

    /// `#[inertia(…)]` names factors.
    fn check_named_factors(&self, diagnostics: &mut Diagnostics) {
        for (_, mark) in self.marks() {
            let mut known: Vec<usize> = Vec::new();
            for name in &mark.factors {
                match self.named(name, " of the group") {
                    Err(error) => diagnostics.absorb(error),
                    Ok(factors) if factors.indices().any(|factor| known.contains(&factor)) => {
                        diagnostics.push(name, format!("`{name}` is named twice; keep one of them"));
                    }
                    Ok(factors) => known.extend(factors.indices()),
                }
            }
        }
    }

    /// Each factor has exactly one inertia.
    fn check_coverage(&self, diagnostics: &mut Diagnostics) {
        let marks = self.marks();
        if marks.is_empty() {
            let message = "which parameter is the inertia? Mark one field with `#[inertia]`, or give a `hamiltonian` or a \
                           `lagrangian`";
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
        for factors in &self.declared_factors {
            self.check_coverage_of(factors, &marks, diagnostics);
        }
    }

    /// Checks that a factor, or each of an array, has one inertia; the first problem of an array is enough.
    fn check_coverage_of(
        &self,
        factors: &Range<usize>,
        marks: &[(&'d Ident, &'d parse::Inertia)],
        diagnostics: &mut Diagnostics,
    ) {
        let of = |factor: usize| -> Vec<&(&'d Ident, &'d parse::Inertia)> {
            marks.iter().filter(|(_, mark)| self.marked_factors(mark).contains(&factor)).collect()
        };
        let Some(factor) = factors.clone().find(|&factor| of(factor).len() != 1) else { return };
        let found = of(factor);
        // of an array that has the problem as a whole by its name
        let is_whole = factors.clone().all(|other| of(other).len() == found.len());
        let name = &self.factors[factor].name;
        let name = if is_whole { name.ident.to_string() } else { name.written() };
        match found.last() {
            None => {
                let message = format!("`{name}` has no inertia; mark one field with `#[inertia({name})]`");
                diagnostics.push(&self.item.name, message);
            }
            Some((_, last)) => {
                let names = list(found.iter().map(|(name, _)| name.to_string()));
                let message = format!(
                    "`{name}` has several inertias, {names}; `#[inertia(…)]` names the factors of each"
                );
                diagnostics.push_at(last.span, message);
            }
        }
    }

    /// An inertia is a scalar, the diagonal of a matrix, or a matrix, of the dimension of the factors that it is for;
    /// or, for several factors with the same group, of the dimension of each. `n` is its own, if it has one.
    fn inertia_blocks(
        &self,
        field: &Field,
        mark: &parse::Inertia,
        n: Option<usize>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<Vec<usize>>> {
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
        diagnostics.fail(&field.ty, message)
    }

    /// The elements of an array are the inertias of as many factors, in their order; `n` is the dimension of each, if
    /// it has one.
    fn inertia_of_each(
        &self,
        field: &Field,
        length: usize,
        mark: &parse::Inertia,
        n: Option<usize>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<Vec<Vec<usize>>>> {
        let factors = self.marked_factors(mark);
        if factors.len() != length {
            let (name, count) = (&field.name, factors.len());
            let message = match self.factors.as_slice() {
                [only] => format!(
                    "`{name}` is an array, one inertia for each of {length} factors, but there is one factor; its principal moments are a \
                     vector of {}",
                    only.group.dimension()
                ),
                _ => format!(
                    "`{name}` is an array of {length}, but it is the inertia of {count} factors, one of each"
                ),
            };
            return diagnostics.fail(&field.ty, message);
        }
        let groups = factors.iter().map(|&factor| self.factors[factor].group);
        let mut others = groups.filter(|group| field.shape != Shape::Scalar && n != Some(group.dimension()));
        if let Some(group) = others.next() {
            let (name, d, found) = (group.name(), group.dimension(), field.shape.describe());
            let message = format!(
                "`{name}` has dimension {d}, so its inertia is a vector of {d} (principal moments), a {d}×{d} matrix or a \
                 scalar, but each of these is {found}"
            );
            return diagnostics.fail(&field.ty, message);
        }
        Some(factors.into_iter().map(|factor| vec![vec![factor]]).collect())
    }
}

/// How an inertia of that shape is given, and of what dimension it is: `None` for a scalar, which is of any, and for
/// what is not square.
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
    let message = format!("an inertia is a scalar, a vector or a square matrix, but this is {found}");
    diagnostics.fail(&field.ty, message)
}
