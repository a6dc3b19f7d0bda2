//! Functions of a user's own, and where expressions call functions.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use quote::ToTokens;
use syn::parse::{Parse, ParseStream};
use syn::{Block, ItemFn, Path, Signature};

use super::shape::scalar_named;

/// A function that `#[expression]` stands above.
#[derive(Clone, Debug)]
pub struct OwnFunction {
    /// As a description calls it.
    pub path: Path,
    /// Its name, arguments and result.
    pub signature: Signature,
    /// Its value.
    pub body: Block,
}

impl OwnFunction {
    /// A function as its macro hands it back, under the path that it was asked for by.
    pub(crate) fn parse(path: Path, input: ParseStream<'_>) -> syn::Result<Self> {
        let ItemFn { sig, block, .. } = ItemFn::parse(input)?;
        Ok(Self { path, signature: sig, body: *block })
    }

    /// The functions that it calls, by their paths from where it is called itself.
    pub fn calls(&self) -> Vec<Path> {
        let calls = calls(self.body.to_token_stream());
        calls.into_iter().map(|path| seen_from(Some(&self.path), &path)).collect()
    }
}

/// A path within a function as it is seen from where that is called: both are in one module.
pub fn seen_from(function: Option<&Path>, path: &Path) -> Path {
    let is_known = |first: &str| {
        matches!(first, "crate" | "self" | "super" | "std" | "core" | "alloc")
            || scalar_named(first).is_some()
    };
    let (Some(function), Some(first)) = (function, path.segments.first()) else { return path.clone() };
    if path.leading_colon.is_some() || is_known(&first.ident.to_string()) {
        return path.clone();
    }
    let module = function.segments.iter().take(function.segments.len() - 1);
    let segments = module.chain(&path.segments).cloned().collect();
    Path { leading_colon: function.leading_colon, segments }
}

/// The paths of the functions that are called, but for those of types.
pub fn calls(tokens: TokenStream) -> Vec<Path> {
    let trees: Vec<TokenTree> = tokens.into_iter().collect();
    let is_mark = |place: usize, mark: char| {
        place.checked_sub(1).is_some_and(|k| matches!(&trees[k], TokenTree::Punct(p) if p.as_char() == mark))
    };
    let mut all = Vec::new();
    for (end, tree) in trees.iter().enumerate() {
        let TokenTree::Group(group) = tree else { continue };
        let mut start = end;
        while start > 0 && matches!(trees[start - 1], TokenTree::Ident(_)) {
            start -= 1;
            if !(is_mark(start, ':') && start > 2 && is_mark(start - 1, ':')) {
                break;
            }
            start -= 2;
        }
        if group.delimiter() == Delimiter::Parenthesis && start < end && !is_mark(start, '.') {
            let path = syn::parse2::<Path>(trees[start..end].iter().cloned().collect());
            all.extend(path.ok().filter(is_own));
        }
        all.extend(calls(group.stream()));
    }
    all
}

/// Whether it may be the path of a function that is none of a type's.
fn is_own(path: &Path) -> bool {
    let mut names = path.segments.iter().rev().map(|segment| segment.ident.to_string());
    let is_small = |name: &String| !name.starts_with(|first: char| first.is_uppercase());
    names
        .next()
        .is_some_and(|name| is_small(&name) && (path.segments.len() > 1 || !OF_NUMBERS.contains(&&*name)))
        && names.next().is_none_or(|owner| is_small(&owner) && scalar_named(&owner).is_none())
}

/// Methods of numbers that mathematics writes as functions: no function of a user's own has one of these names alone.
pub const OF_NUMBERS: [&str; 18] = [
    "abs", "acos", "asin", "atan", "atan2", "cos", "cosh", "exp", "hypot", "ln", "log", "pow", "powf",
    "powi", "sin", "sinh", "sqrt", "tan",
];
