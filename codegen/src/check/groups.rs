//! The groups and spaces that a description names.

use proc_macro2::{Ident, Span};
use quote::ToTokens;

use crate::diagnostics::{Diagnostics, list, suggestion};
use crate::group::{
    self, Adjoint, Basis, BasisError, Dual, Group, Linear, LinearError, MatrixGroup, NamedMatrix,
    Representation, Retraction,
};
use crate::identifiers::plain;
use crate::parse;

/// Bounds of a basis, for messages.
const BOUNDS: &str = "a basis has up to 16 matrices of 1 to 12 rows, of small whole numbers";

/// A group, with all steps that are asked for.
pub(crate) fn group(
    written: &parse::Group,
    definitions: &[parse::Definition],
    retractions: &[Retraction],
    diagnostics: &mut Diagnostics,
) -> Option<&'static dyn Group> {
    let group = GroupResolver { definitions, depth: 0 }.of(written, None, diagnostics)?;
    if !Retraction::defaults().any(|retraction| group.has(retraction)) {
        let message = format!(
            "there are no steps on {}: its Cayley map leaves the group, and its exponential has no closed form and too many coordinates to be \
             summed",
            group.name()
        );
        diagnostics.push(written.keyword(), message);
        return None;
    }
    for retraction in retractions.iter().filter(|&&retraction| !group.has(retraction)) {
        let message = format!(
            "there are no steps on {} with `{}`: {}",
            group.name(),
            retraction.name(),
            retraction.absence()
        );
        diagnostics.push(written.keyword(), message);
    }
    Some(group)
}

/// From what is written to groups.
#[derive(Clone, Copy)]
struct GroupResolver<'d> {
    definitions: &'d [parse::Definition],
    /// How many definitions led here.
    depth: usize,
}

impl GroupResolver<'_> {
    /// The group, under a name that a definition gives it.
    fn of(
        self,
        written: &parse::Group,
        name: Option<&Ident>,
        diagnostics: &mut Diagnostics,
    ) -> Option<&'static dyn Group> {
        let (text, basis) = match written {
            parse::Group::Named(name) => return named(name, diagnostics),
            parse::Group::Own(name, path) => return self.defined(path, name, diagnostics),
            parse::Group::Matrices(keyword, matrices) => {
                let name = name.map_or_else(|| "matrices".to_owned(), plain);
                return own(&name, keyword, matrices, diagnostics);
            }
            parse::Group::Product(keyword, factors) => self.product(keyword, factors, diagnostics)?,
            parse::Group::Semidirect(keyword, base, spaces) => {
                self.semidirect(keyword, base, spaces, diagnostics)?
            }
            parse::Group::Tangent(keyword, of) => {
                let group = self.of(of, None, diagnostics)?;
                (format!("{keyword}({})", group.name()), basis(group, of.keyword(), diagnostics)?.tangent())
            }
        };
        let name = name.map_or(text, plain);
        let group = basis.and_then(|basis| MatrixGroup::new(&name, &basis)).ok();
        if group.is_none() {
            diagnostics.push(written.keyword(), format!("this group is too large: {BOUNDS}"));
        }
        group.map(|group| group as &dyn Group)
    }

    fn defined(
        self,
        path: &syn::Path,
        at: &Ident,
        diagnostics: &mut Diagnostics,
    ) -> Option<&'static dyn Group> {
        let text = path.to_token_stream().to_string();
        let Some(definition) = self.definitions.iter().find(|definition| definition.path == text) else {
            diagnostics.push(at, format!("`{text}!` is not defined by `lie_group!`"));
            return None;
        };
        if self.depth > self.definitions.len() {
            diagnostics.push(at, format!("`{text}!` is defined by itself"));
            return None;
        }
        let next = Self { depth: self.depth + 1, ..self };
        next.of(&definition.group, Some(&definition.name), diagnostics)
    }

    /// The basis of a product, and how it is written.
    fn product(
        self,
        keyword: &Ident,
        factors: &[(Ident, parse::Group)],
        diagnostics: &mut Diagnostics,
    ) -> Option<(String, Result<Basis, BasisError>)> {
        are_distinct(factors.iter().map(|(name, _)| name), diagnostics)?;
        let (mut found, mut dimension) = (Vec::new(), 0);
        for (name, factor) in factors {
            // what is too large already takes no more time
            if dimension > MatrixGroup::LARGEST {
                return Some((keyword.to_string(), Err(BasisError::TooLarge)));
            }
            let group = self.of(factor, None, diagnostics);
            let basis = group.and_then(|group| basis(group, factor.keyword(), diagnostics));
            dimension += basis.as_ref().map_or(0, Basis::dimension);
            found.push(group.zip(basis).map(|(group, basis)| (name, group, basis)));
        }
        let found: Vec<_> = found.into_iter().collect::<Option<_>>()?;
        let texts: Vec<String> =
            found.iter().map(|(name, group, _)| format!("{name}: {}", group.name())).collect();
        let factors: Vec<(String, Basis)> =
            found.into_iter().map(|(name, _, basis)| (plain(name), basis)).collect();
        Some((format!("{keyword}({})", texts.join(", ")), Basis::product(&factors)))
    }

    /// The basis of a semidirect product, and how it is written.
    fn semidirect(
        self,
        keyword: &Ident,
        (name, base): &(Ident, parse::Group),
        spaces: &[(Ident, parse::Space)],
        diagnostics: &mut Diagnostics,
    ) -> Option<(String, Result<Basis, BasisError>)> {
        are_distinct(spaces.iter().map(|(name, _)| name).chain([name]), diagnostics)?;
        let group = self.of(base, None, diagnostics)?;
        let own = basis(group, base.keyword(), diagnostics)?;
        let (mut found, mut dimension) = (Vec::new(), own.dimension());
        for (name, written) in spaces {
            if dimension > MatrixGroup::LARGEST {
                return Some((keyword.to_string(), Err(BasisError::TooLarge)));
            }
            let space = space(group, written, diagnostics);
            dimension += space.map_or(0, |space| space.coordinates().len());
            found.push(space.map(|space| (plain(name), space)));
        }
        let found: Vec<(String, &'static dyn Representation)> = found.into_iter().collect::<Option<_>>()?;
        let mut text = format!("{keyword}({name}: {}", group.name());
        spaces.iter().for_each(|(name, space)| text.push_str(&format!(", {name}: {space}")));
        Some((format!("{text})"), own.semidirect(&plain(name), &found)))
    }
}

/// A group's algebra as one of matrices.
fn basis(group: &dyn Group, at: &Ident, diagnostics: &mut Diagnostics) -> Option<Basis> {
    let basis = group.basis();
    if basis.is_none() {
        diagnostics.push(at, format!("no basis of matrices is known of {}", group.name()));
    }
    basis
}

fn are_distinct<'n>(names: impl Iterator<Item = &'n Ident>, diagnostics: &mut Diagnostics) -> Option<()> {
    let mut known: Vec<&Ident> = Vec::new();
    let mut distinct = Some(());
    for name in names {
        if known.contains(&name) {
            diagnostics.push(name, format!("`{name}` is named twice"));
            distinct = None;
        }
        known.push(name);
    }
    distinct
}

/// The group of this name.
fn named(name: &Ident, diagnostics: &mut Diagnostics) -> Option<&'static dyn Group> {
    let known = group::catalogue().iter().copied().find(|group| name == group.name());
    let group = known.or_else(|| group::family(&name.to_string()).map(|group| group as &dyn Group));
    if group.is_none() {
        let names: Vec<&str> = group::catalogue().iter().map(|group| group.name()).collect();
        let text = name.to_string();
        let guess = suggestion(&text, &names);
        let help = match group::family_meant(&text) {
            // bounds are not the reason of every size that is not there
            Some(family) => format!("; of `{family}` there are {}", list(group::sizes(family))),
            // what is near is meant; what is not may be somebody's own
            None if guess.ends_with('?') => guess,
            None => {
                let families = list(group::FAMILIES);
                format!("{guess}; families: {families}; one of your own is written `{text}!`")
            }
        };
        diagnostics.push(name, format!("there is no group `{text}`{help}"));
    }
    group
}

/// The group of a basis of the user's own.
fn own(
    name: &str,
    keyword: &Ident,
    basis: &[parse::BasisMatrix],
    diagnostics: &mut Diagnostics,
) -> Option<&'static dyn Group> {
    let (size, matrices) = square(basis, "a basis", diagnostics)?;
    are_distinct(basis.iter().map(|matrix| &matrix.name), diagnostics)?;
    let found = Basis::new(size, &matrices).and_then(|basis| MatrixGroup::new(name, &basis));
    let (at, message) = match found {
        Ok(group) => return Some(group),
        Err(BasisError::Dependent(i)) => {
            (&basis[i].name, format!("`{}` is a combination of the matrices before it", basis[i].name))
        }
        Err(BasisError::NotClosed(i, j)) => {
            let (first, second) = (&basis[i].name, &basis[j].name);
            let bracket = format!("[{first}, {second}] = {first} {second} − {second} {first}");
            (
                first,
                format!(
                    "the commutator {bracket} is no combination of the basis: the matrices are no Lie algebra"
                ),
            )
        }
        Err(_) => (keyword, BOUNDS.to_owned()),
    };
    diagnostics.push(at, message);
    None
}

/// Square matrices of one size with their names, by rows.
fn square(
    matrices: &[parse::BasisMatrix],
    of: &str,
    diagnostics: &mut Diagnostics,
) -> Option<(usize, Vec<NamedMatrix>)> {
    let size = matrices.first().map_or(0, |matrix| matrix.rows.len());
    let mut is_square = true;
    for matrix in matrices {
        if matrix.rows.len() != size || matrix.rows.iter().any(|row| row.len() != size) {
            let (rows, columns) = (matrix.rows.len(), matrix.rows.iter().map(Vec::len).max().unwrap_or(0));
            let message = format!(
                "the matrices of {of} are square and of one size, {size} × {size} here; `{}` is {rows} × {columns}",
                matrix.name
            );
            diagnostics.push(&matrix.name, message);
            is_square = false;
        }
    }
    let rows = matrices.iter().map(|matrix| (plain(&matrix.name), matrix.rows.concat()));
    is_square.then(|| (size, rows.collect()))
}

/// The space of this name on which a group acts.
pub(super) fn known_space(group: &'static dyn Group, name: &str) -> Option<&'static dyn Representation> {
    match name {
        "adjoint" => Some(Adjoint::of(group)),
        "coadjoint" => Some(Dual::of(Adjoint::of(group))),
        _ => group.representations().iter().copied().find(|space| space.name() == name),
    }
}

/// A space on which a group acts.
pub(super) fn space(
    group: &'static dyn Group,
    written: &parse::Space,
    diagnostics: &mut Diagnostics,
) -> Option<&'static dyn Representation> {
    match written {
        parse::Space::Named(name) => {
            let known = known_space(group, &name.to_string());
            if known.is_none() {
                diagnostics.push(name, nothing_acts(&[group], &name.to_string()));
            }
            known
        }
        parse::Space::Dual(_, of) => Some(Dual::of(space(group, of, diagnostics)?)),
        parse::Space::Matrices(keyword, matrices) => given(group, keyword, matrices, diagnostics),
    }
}

/// The space on which the algebra acts by these matrices, one for each of its axes.
fn given(
    group: &'static dyn Group,
    keyword: &Ident,
    written: &[parse::BasisMatrix],
    diagnostics: &mut Diagnostics,
) -> Option<&'static dyn Representation> {
    let (size, matrices) = square(written, "a representation", diagnostics)?;
    let axes = group.axes();
    let names: Vec<&str> = matrices.iter().map(|(name, _)| name.as_str()).collect();
    if names != axes {
        let message = format!(
            "a representation has one matrix for each axis of the algebra, in this order: {}",
            axes.join(", ")
        );
        diagnostics.push(keyword, message);
        return None;
    }
    let basis = basis(group, keyword, diagnostics)?;
    let found = Basis::new(size, &matrices).map_err(|_| LinearError::TooLarge);
    let message = match found.and_then(|rho| Linear::given(&basis, &rho)) {
        Ok(space) => return Some(space),
        Err(LinearError::NoRepresentation(i, j)) => {
            let (first, second) = (names[i], names[j]);
            diagnostics.push_at(
                written.get(i).map_or_else(Span::call_site, |matrix| matrix.name.span()),
                format!(
                    "`{first}` and `{second}` do not commute as the axes of {} do: this is no representation",
                    group.name()
                ),
            );
            return None;
        }
        Err(LinearError::TooLarge) => BOUNDS,
    };
    diagnostics.push(keyword, message);
    None
}

/// Says that none of these groups acts on a space of this name.
pub(super) fn nothing_acts(groups: &[&'static dyn Group], space: &str) -> String {
    let names = list(groups.iter().map(|group| group.name()));
    let mut known: Vec<&str> =
        groups.iter().flat_map(|group| group.representations().iter().map(|space| space.name())).collect();
    known.sort_unstable();
    known.dedup();
    // every group acts on its algebra and on the dual of that
    known.extend(["adjoint", "coadjoint"]);
    let rest = suggestion(space, &known);
    match groups.len() {
        1 => format!("{names} does not act on a space `{space}`{rest}"),
        _ => format!("none of {names} acts on a space `{space}`{rest}"),
    }
}
