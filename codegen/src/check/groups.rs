//! The groups and spaces that a description names.

use proc_macro2::Ident;
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
    let group = Resolved { definitions, depth: 0, diagnostics }.group(written, None)?;
    let name = group.name();
    if !Retraction::defaults().any(|retraction| group.has(retraction)) {
        let message = format!(
            "there are no steps on {name}: its Cayley map leaves the group, and its exponential has no closed form and too many \
             coordinates to be summed"
        );
        return diagnostics.fail(written.keyword(), message);
    }
    for retraction in retractions.iter().filter(|&&retraction| !group.has(retraction)) {
        let (retraction, absence) = (retraction.name(), retraction.row().absence);
        let message = format!("there are no steps on {name} with `{retraction}`: {absence}");
        diagnostics.push(written.keyword(), message);
    }
    Some(group)
}

/// A space on which a group acts.
pub(super) fn space(
    group: &'static dyn Group,
    written: &parse::Space,
    diagnostics: &mut Diagnostics,
) -> Option<&'static dyn Representation> {
    Resolved { definitions: &[], depth: 0, diagnostics }.space(group, written)
}

/// The basis of a group that is made of others, and how it is written.
type Compound = (String, Result<Basis, BasisError>);

/// From what is written to groups and spaces.
struct Resolved<'d> {
    definitions: &'d [parse::Definition],
    /// How many definitions led here.
    depth: usize,
    diagnostics: &'d mut Diagnostics,
}

impl Resolved<'_> {
    /// The group, under a name that a definition gives it.
    fn group(&mut self, written: &parse::Group, name: Option<&Ident>) -> Option<&'static dyn Group> {
        let (text, basis) = match written {
            parse::Group::Named(name) => return self.named(name),
            parse::Group::Own(name, path) => return self.defined(path, name),
            parse::Group::Matrices(keyword, matrices) => {
                let name = name.map_or_else(|| "matrices".to_owned(), plain);
                return self.of_basis(&name, keyword, matrices);
            }
            parse::Group::Product(keyword, factors) => self.product(keyword, factors)?,
            parse::Group::Semidirect(keyword, base, spaces) => self.semidirect(keyword, base, spaces)?,
            parse::Group::Tangent(keyword, of) => {
                let group = self.group(of, None)?;
                (format!("{keyword}({})", group.name()), self.basis(group, of.keyword())?.tangent())
            }
        };
        let name = name.map_or(text, plain);
        match basis.and_then(|basis| MatrixGroup::new(&name, &basis)) {
            Ok(group) => Some(group),
            Err(_) => self.diagnostics.fail(written.keyword(), format!("this group is too large: {BOUNDS}")),
        }
    }

    fn defined(&mut self, path: &syn::Path, at: &Ident) -> Option<&'static dyn Group> {
        let text = path.to_token_stream().to_string();
        let Some(definition) = self.definitions.iter().find(|definition| definition.path == text) else {
            return self.diagnostics.fail(at, format!("`{text}!` is not defined by `lie_group!`"));
        };
        if self.depth > self.definitions.len() {
            return self.diagnostics.fail(at, format!("`{text}!` is defined by itself"));
        }
        self.depth += 1;
        let group = self.group(&definition.group, Some(&definition.name));
        self.depth -= 1;
        group
    }

    fn product(&mut self, keyword: &Ident, factors: &[(Ident, parse::Group)]) -> Option<Compound> {
        self.are_distinct(factors.iter().map(|(name, _)| name))?;
        let (mut found, mut dimension) = (Vec::new(), 0);
        for (name, factor) in factors {
            // what is too large already takes no more time
            if dimension > MatrixGroup::LARGEST {
                return Some((keyword.to_string(), Err(BasisError::TooLarge)));
            }
            let group = self.group(factor, None);
            let basis = group.and_then(|group| self.basis(group, factor.keyword()));
            dimension += basis.as_ref().map_or(0, Basis::dimension);
            let text = group.map(|group| format!("{name}: {}", group.name()));
            found.push(text.zip(basis).map(|(text, basis)| (text, (plain(name), basis))));
        }
        let (texts, factors): (Vec<_>, Vec<_>) = found.into_iter().collect::<Option<_>>()?;
        Some((format!("{keyword}({})", texts.join(", ")), Basis::product(&factors)))
    }

    fn semidirect(
        &mut self,
        keyword: &Ident,
        (name, base): &(Ident, parse::Group),
        spaces: &[(Ident, parse::Space)],
    ) -> Option<Compound> {
        self.are_distinct(spaces.iter().map(|(name, _)| name).chain([name]))?;
        let group = self.group(base, None)?;
        let own = self.basis(group, base.keyword())?;
        let (mut found, mut dimension) = (Vec::new(), own.dimension());
        for (name, written) in spaces {
            if dimension > MatrixGroup::LARGEST {
                return Some((keyword.to_string(), Err(BasisError::TooLarge)));
            }
            let space = self.space(group, written);
            dimension += space.map_or(0, |space| space.coordinates().len());
            found.push(space.map(|space| (plain(name), space)));
        }
        let found: Vec<(String, &'static dyn Representation)> = found.into_iter().collect::<Option<_>>()?;
        let mut text = format!("{keyword}({name}: {}", group.name());
        spaces.iter().for_each(|(name, space)| text.push_str(&format!(", {name}: {space}")));
        Some((format!("{text})"), own.semidirect(&plain(name), &found)))
    }

    /// A group's algebra as one of matrices.
    fn basis(&mut self, group: &dyn Group, at: &Ident) -> Option<Basis> {
        let message = || format!("no basis of matrices is known of {}", group.name());
        group.basis().or_else(|| self.diagnostics.fail(at, message()))
    }

    fn are_distinct<'n>(&mut self, names: impl Iterator<Item = &'n Ident>) -> Option<()> {
        let mut known: Vec<&Ident> = Vec::new();
        let mut distinct = Some(());
        for name in names {
            if known.contains(&name) {
                distinct = self.diagnostics.fail(name, format!("`{name}` is named twice"));
            }
            known.push(name);
        }
        distinct
    }

    /// The group of this name.
    fn named(&mut self, name: &Ident) -> Option<&'static dyn Group> {
        let known = group::catalogue().iter().copied().find(|group| name == group.name());
        let text = name.to_string();
        if let Some(group) = known.or_else(|| group::family(&text).map(|group| group as &dyn Group)) {
            return Some(group);
        }
        let names: Vec<&str> = group::catalogue().iter().map(|group| group.name()).collect();
        let guess = suggestion(&text, &names);
        let of_size = |name: &&str| name.starts_with('R');
        let help = match group::family_meant(&text) {
            None if text.strip_prefix('R').is_some_and(|n| n.parse::<u32>().is_ok()) => {
                format!("; of `R(n)` there are {}", list(names.iter().copied().filter(of_size)))
            }
            // bounds are not the reason of every size that is not there
            Some(family) => format!("; of `{family}` there are {}", list(group::sizes(family))),
            // what is near is meant; what is not may be somebody's own
            None if guess.ends_with('?') => guess,
            None => written_otherwise(&text).unwrap_or_else(|| {
                let families = list(group::FAMILIES);
                let near = near(&text).map_or(String::new(), |near| format!("; did you mean `{near}`?"));
                format!(
                    "{near}{guess}; families: {families}; one of your own, which `lie_group!` defines, is written `{text}!`"
                )
            }),
        };
        self.diagnostics.fail(name, format!("there is no group `{text}`{help}"))
    }

    /// The group of a basis of the user's own.
    fn of_basis(
        &mut self,
        name: &str,
        keyword: &Ident,
        basis: &[parse::BasisMatrix],
    ) -> Option<&'static dyn Group> {
        let (size, matrices) = self.square(basis, "a basis")?;
        self.are_distinct(basis.iter().map(|matrix| &matrix.name))?;
        match Basis::new(size, &matrices).and_then(|basis| MatrixGroup::new(name, &basis)) {
            Ok(group) => Some(group),
            Err(BasisError::Dependent(i)) => {
                let name = &basis[i].name;
                self.diagnostics.fail(name, format!("`{name}` is a combination of the matrices before it"))
            }
            Err(BasisError::NotClosed(i, j)) => {
                let (first, second) = (&basis[i].name, &basis[j].name);
                let message = format!(
                    "the commutator [{first}, {second}] = {first} {second} − {second} {first} is no combination of the basis: \
                     the matrices are no Lie algebra"
                );
                self.diagnostics.fail(first, message)
            }
            Err(_) => self.diagnostics.fail(keyword, BOUNDS),
        }
    }

    /// Square matrices of one size with their names, by rows.
    fn square(&mut self, matrices: &[parse::BasisMatrix], of: &str) -> Option<(usize, Vec<NamedMatrix>)> {
        let size = matrices.first().map_or(0, |matrix| matrix.rows.len());
        let mut is_square = Some(());
        for parse::BasisMatrix { name, rows } in matrices {
            if rows.len() != size || rows.iter().any(|row| row.len() != size) {
                let (rows, columns) = (rows.len(), rows.iter().map(Vec::len).max().unwrap_or(0));
                let message = format!(
                    "the matrices of {of} are square and of one size, {size} × {size} here; `{name}` is {rows} × {columns}"
                );
                is_square = self.diagnostics.fail(name, message);
            }
        }
        let rows = matrices.iter().map(|matrix| (plain(&matrix.name), matrix.rows.concat()));
        is_square.map(|()| (size, rows.collect()))
    }

    /// A space on which a group acts.
    fn space(
        &mut self,
        group: &'static dyn Group,
        written: &parse::Space,
    ) -> Option<&'static dyn Representation> {
        match written {
            parse::Space::Named(name) => {
                let text = name.to_string();
                let message = || nothing_acts(&[group], &text);
                known_space(group, &text).or_else(|| self.diagnostics.fail(name, message()))
            }
            parse::Space::Dual(_, of) => Some(Dual::of(self.space(group, of)?)),
            parse::Space::Matrices(keyword, matrices) => self.given(group, keyword, matrices),
        }
    }

    /// The space on which the algebra acts by these matrices, one for each of its axes.
    fn given(
        &mut self,
        group: &'static dyn Group,
        keyword: &Ident,
        written: &[parse::BasisMatrix],
    ) -> Option<&'static dyn Representation> {
        let (size, matrices) = self.square(written, "a representation")?;
        let axes = group.axes();
        let names: Vec<&str> = matrices.iter().map(|(name, _)| name.as_str()).collect();
        if names != axes {
            let axes = axes.join(", ");
            let message = format!(
                "a representation has one matrix for each axis of the algebra, in this order: {axes}"
            );
            return self.diagnostics.fail(keyword, message);
        }
        let basis = self.basis(group, keyword)?;
        let found = Basis::new(size, &matrices).map_err(|_| LinearError::TooLarge);
        match found.and_then(|rho| Linear::given(&basis, &rho)) {
            Ok(space) => Some(space),
            Err(LinearError::NoRepresentation(i, j)) => {
                let (first, second, name) = (names[i], names[j], group.name());
                let message = format!(
                    "`{first}` and `{second}` do not commute as the axes of {name} do: this is no representation"
                );
                self.diagnostics.fail(&written[i].name, message)
            }
            Err(LinearError::TooLarge) => self.diagnostics.fail(keyword, BOUNDS),
        }
    }
}

/// The group of a family whose name was written without its first letters, or in small ones: `SU(2)` of `U2`, `SL(3)` of `sl3`.
fn near(written: &str) -> Option<String> {
    let stem = written.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let (size, folded) = (&written[stem.len()..], stem.to_lowercase());
    let families = group::FAMILIES.into_iter().filter_map(|family| family.strip_suffix("(n)"));
    let found = families.filter(|family| !folded.is_empty() && family.to_lowercase().ends_with(&folded));
    found
        .map(|family| format!("{family}({size})"))
        .find(|name| group::family(&group::one_word(name)).is_some())
}

/// How to write what is known by this name, and no group here.
fn written_otherwise(name: &str) -> Option<String> {
    let stem = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    match (stem, name[stem.len()..].parse::<u32>().ok()?) {
        ("U" | "S" | "T", 1) => Some("; turns in a plane are `SO2`".to_owned()),
        ("U", n @ (2 | 3)) => Some(format!(
            "; a phase beside `SU({n})` covers it: `group(element: SU({n}), phase: SO2)`; \
             of its own matrices `lie_group!` makes `U{n}!`"
        )),
        ("S", 2) => {
            Some("; a sphere is none, and `SO3` turns it: the guide's page `spheres` shows how".to_owned())
        }
        ("S" | "Spin", 3) => Some("; unit quaternions are `SU2`".to_owned()),
        ("T", n @ 2..=32) => Some(format!("; one angle for each dimension is `group(angles: [SO2; {n}])`")),
        _ => None,
    }
}

/// The space of this name on which a group acts.
pub(super) fn known_space(group: &'static dyn Group, name: &str) -> Option<&'static dyn Representation> {
    match name {
        "adjoint" => Some(Adjoint::of(group)),
        "coadjoint" => Some(Dual::of(Adjoint::of(group))),
        _ => group.representations().iter().copied().find(|space| space.name() == name),
    }
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
