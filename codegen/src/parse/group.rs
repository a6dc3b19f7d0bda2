//! Groups, and the spaces on which they act, as they are written.

use quote::format_ident;
use syn::ext::IdentExt;
use syn::parse::{Parse, ParseStream};
use syn::{Ident, LitInt, Token, braced, bracketed, parenthesized, token};

use crate::diagnostics::Explained;
use crate::group::{FAMILIES, family_meant, one_word};

/// A group.
#[derive(Debug)]
pub enum Group {
    /// `SO3`, `SO(4)`: one with a name.
    Named(Ident),
    /// `Shears!`, `groups::Shears!`: one that `lie_group!` defines.
    Own(Ident, syn::Path),
    /// `matrices { h: [1, 0; 0, -1], … }`: one of matrices, from its basis.
    Matrices(Ident, Vec<BasisMatrix>),
    /// `product(attitude: SO3, position: R3)`
    Product(Ident, Vec<(Ident, Group)>),
    /// `semidirect(attitude: SO3, velocity: R3, …)`: a group and spaces on which it acts.
    Semidirect(Ident, Box<(Ident, Group)>, Vec<(Ident, Space)>),
    /// `tangent(SO3)`
    Tangent(Ident, Box<Group>),
}

/// A space on which a group acts.
#[derive(Debug)]
pub enum Space {
    /// `R3`, `adjoint`, `coadjoint`
    Named(Ident),
    /// `dual(R2)`
    Dual(Ident, Box<Space>),
    /// `matrices { h: [2], … }`: one matrix for each axis of the algebra.
    Matrices(Ident, Vec<BasisMatrix>),
}

/// `h: [1, 0; 0, -1]`
#[derive(Debug)]
pub struct BasisMatrix {
    /// The name of the coordinate along it.
    pub name: Ident,
    /// Its entries, row by row.
    pub rows: Vec<Vec<i64>>,
}

impl Group {
    /// The word that it begins with.
    pub fn keyword(&self) -> &Ident {
        match self {
            Self::Named(name) | Self::Own(name, _) => name,
            Self::Matrices(keyword, _)
            | Self::Product(keyword, _)
            | Self::Semidirect(keyword, ..)
            | Self::Tangent(keyword, _) => keyword,
        }
    }

    /// The paths of groups that `lie_group!` defines.
    pub fn own(&self) -> Vec<&syn::Path> {
        match self {
            Self::Named(_) | Self::Matrices(..) => Vec::new(),
            Self::Own(_, path) => vec![path],
            Self::Product(_, factors) => factors.iter().flat_map(|(_, factor)| factor.own()).collect(),
            Self::Semidirect(_, base, _) => base.1.own(),
            Self::Tangent(_, of) => of.own(),
        }
    }
}

impl Space {
    /// The word that it begins with.
    pub fn keyword(&self) -> &Ident {
        match self {
            Self::Named(keyword) | Self::Dual(keyword, _) | Self::Matrices(keyword, _) => keyword,
        }
    }
}

/// As it is written.
impl std::fmt::Display for Space {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Named(name) => write!(f, "{name}"),
            Self::Dual(keyword, space) => write!(f, "{keyword}({space})"),
            Self::Matrices(keyword, _) => write!(f, "{keyword} {{ … }}"),
        }
    }
}

/// A group, whose first word has been read.
pub(crate) fn group(input: ParseStream<'_>, keyword: Ident) -> syn::Result<Group> {
    if keyword == "matrices" && input.peek(token::Brace) {
        return Ok(Group::Matrices(keyword, basis(input)?));
    }
    if input.peek(Token![::]) || input.peek(Token![!]) && !input.peek(Token![!=]) {
        let (mut name, mut path) = (keyword.clone(), syn::Path::from(keyword));
        while input.parse::<Option<Token![::]>>()?.is_some() {
            name = Ident::parse_any(input)?;
            path.segments.push(name.clone().into());
        }
        let message = format!("a group of your own, from `lie_group!`, is written `{name}!`");
        input.parse::<Token![!]>().explained(message)?;
        return Ok(Group::Own(name, path));
    }
    if !input.peek(token::Paren) {
        return Ok(Group::Named(keyword));
    }
    let word = keyword.to_string();
    if !["product", "semidirect", "tangent"].contains(&word.as_str()) {
        return sized_name(input, keyword).map(Group::Named);
    }
    let content;
    parenthesized!(content in input);
    match word.as_str() {
        "product" => {
            let factors = content.parse_terminated(|input| named(input, PRODUCT), Token![,])?;
            if factors.is_empty() {
                let message = format!("a product has factors; write `{PRODUCT}`");
                return Err(syn::Error::new_spanned(keyword, message));
            }
            Ok(Group::Product(keyword, factors.into_iter().collect()))
        }
        "semidirect" => {
            let base = Box::new(named(&content, SEMIDIRECT)?);
            let space = |input: ParseStream<'_>| {
                let name = declared_name(input, "velocity: R3", "a space", "a space that the group acts on")?;
                Ok((name, space(input)?))
            };
            if !content.is_empty() {
                content.parse::<Token![,]>()?;
            }
            let spaces = content.parse_terminated(space, Token![,])?;
            if spaces.is_empty() {
                let message = format!("a semidirect product has spaces; write `{SEMIDIRECT}`");
                return Err(syn::Error::new_spanned(keyword, message));
            }
            Ok(Group::Semidirect(keyword, base, spaces.into_iter().collect()))
        }
        _ => {
            let first = first_word(&content).explained("expected a group, as in `tangent(SO3)`")?;
            let of = group(&content, first)?;
            if !content.is_empty() {
                return Err(content.error("a tangent group is that of one group, as in `tangent(SO3)`"));
            }
            Ok(Group::Tangent(keyword, Box::new(of)))
        }
    }
}

const PRODUCT: &str = "product(attitude: SO3, position: R3)";
const SEMIDIRECT: &str = "semidirect(attitude: SO3, velocity: R3, position: R3)";

/// `attitude: SO3`, within a product.
fn named(input: ParseStream<'_>, example: &str) -> syn::Result<(Ident, Group)> {
    let message = format!("each group has a name; write `{example}`");
    let name: Ident = input.parse().explained(&message)?;
    if !input.peek(Token![:]) {
        return Err(syn::Error::new_spanned(&name, message));
    }
    input.parse::<Token![:]>()?;
    let keyword = first_word(input).explained("expected a group, such as `SO3`")?;
    Ok((name, group(input, keyword)?))
}

/// `R3`, `adjoint`, `dual(R2)`, `matrices { … }`
pub(super) fn space(input: ParseStream<'_>) -> syn::Result<Space> {
    let keyword = first_word(input).explained("expected a space, such as `R3`")?;
    if keyword == "matrices" && input.peek(token::Brace) {
        return Ok(Space::Matrices(keyword, basis(input)?));
    }
    if keyword == "dual" && input.peek(token::Paren) {
        let content;
        parenthesized!(content in input);
        let of = space(&content)?;
        if !content.is_empty() {
            return Err(content.error("expected one space, as in `dual(R3)`"));
        }
        return Ok(Space::Dual(keyword, Box::new(of)));
    }
    Ok(Space::Named(keyword))
}

/// The first word of a group or a space; `crate`, `self` and `super` too, with which paths begin.
pub(super) fn first_word(input: ParseStream<'_>) -> syn::Result<Ident> {
    let of_path = input.peek(Token![crate]) || input.peek(Token![self]) || input.peek(Token![super]);
    if of_path { Ident::parse_any(input) } else { input.parse() }
}

/// `{ h: [1, 0; 0, -1], … }`
fn basis(input: ParseStream<'_>) -> syn::Result<Vec<BasisMatrix>> {
    let content;
    braced!(content in input);
    Ok(content.parse_terminated(basis_matrix, Token![,])?.into_iter().collect())
}

/// `h: [1, 0; 0, -1]`
fn basis_matrix(input: ParseStream<'_>) -> syn::Result<BasisMatrix> {
    let name = declared_name(input, "h: [1, 0; 0, -1]", "a matrix of a basis", "its rows")?;
    let content;
    bracketed!(content in input);
    let mut rows = vec![Vec::new()];
    while !content.is_empty() {
        let negative = content.parse::<Option<Token![-]>>()?.is_some();
        let entry: LitInt = content.parse().explained(
            "expected a whole number, as in `[1, 0; 0, -1]`; of halves write the double, and scale the coordinate",
        )?;
        if !entry.suffix().is_empty() {
            return Err(syn::Error::new_spanned(&entry, "expected a whole number without a suffix"));
        }
        let value = i64::from(entry.base10_parse::<i32>()?);
        if let Some(row) = rows.last_mut() {
            row.push(if negative { -value } else { value });
        }
        if content.parse::<Option<Token![;]>>()?.is_some() {
            rows.push(Vec::new());
        } else if !content.is_empty() {
            content.parse::<Token![,]>()?;
        }
    }
    Ok(BasisMatrix { name, rows })
}

/// `R(3)` is another way to write `R3`, `SO(2, 1)` to write `SO21`.
fn sized_name(input: ParseStream<'_>, name: Ident) -> syn::Result<Ident> {
    let content;
    parenthesized!(content in input);
    let sizes = content.parse_terminated(<LitInt as Parse>::parse, Token![,]);
    // syn takes a sign for a part of the literal
    let is_size = |size: &LitInt| size.suffix().is_empty() && size.base10_parse::<u32>().is_ok();
    match sizes {
        Ok(sizes) if !sizes.is_empty() && !sizes.trailing_punct() && sizes.iter().all(is_size) => {
            let digits: Vec<&str> = sizes.iter().map(LitInt::base10_digits).collect();
            let whole = format_ident!("{}{}", name, digits.concat(), span = name.span());
            let written = format!("{name}({})", digits.join(", "));
            if !is_meant(&name, &digits, &written) {
                return Err(syn::Error::new_spanned(&name, format!("there is no group `{written}`")));
            }
            Ok(whole)
        }
        _ => Err(syn::Error::new_spanned(
            &name,
            format!("write the name of the group in one word, such as `{name}3`"),
        )),
    }
}

/// Whether these numbers, one behind the other, are not those of another family: `SO(21)` is not `SO(2, 1)`, nor
/// `SE(23)` or `SE(2, 3)` `SE2(3)`.
fn is_meant(name: &Ident, digits: &[&str], written: &str) -> bool {
    if digits.len() > 1 {
        return FAMILIES.contains(&written);
    }
    let whole = format!("{name}{}", digits.concat());
    let is_other = |family: &str| family.contains(',') && whole == one_word(family);
    let stem = family_meant(&whole).and_then(|family| family.split_once('('));
    !FAMILIES.into_iter().any(is_other) && stem.is_none_or(|(stem, _)| name == stem)
}

/// The name in front of a colon.
pub(super) fn declared_name(
    input: ParseStream<'_>,
    example: &str,
    what: &str,
    needs: &str,
) -> syn::Result<Ident> {
    let message = |expected: &str| format!("expected {expected}; {what} is written `{example}`");
    let name: Ident = input.parse().explained(message("a name"))?;
    if input.is_empty() || input.peek(Token![,]) {
        let (_, ty) = example.split_once(": ").unwrap_or_default();
        return Err(syn::Error::new_spanned(&name, format!("`{name}` needs {needs}; write `{name}: {ty}`")));
    }
    input.parse::<Token![:]>().explained(message("a colon"))?;
    Ok(name)
}
