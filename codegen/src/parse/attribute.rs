//! The arguments of `#[lie_poisson_system(…)]`.

use proc_macro2::{Group, TokenStream, TokenTree};
use quote::quote;
use syn::ext::IdentExt;
use syn::parse::discouraged::Speculative;
use syn::parse::{ParseStream, Parser};
use syn::{Ident, LitStr, Token, parenthesized, token};

use super::nesting;
use crate::diagnostics::{Diagnostics, suggestion};

/// A key of the attribute: how it is called and how it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    /// What stands before `=` or `(`.
    pub name: &'static str,
    /// An example, for messages.
    pub example: &'static str,
}

/// The Lie group of the configuration.
pub const GROUP: Key = Key { name: "group", example: "group = SO3" };
/// The parameters that the group acts on.
pub const ADVECTED: Key = Key { name: "advected", example: "advected(gamma: R3)" };
/// The potential energy.
pub const POTENTIAL: Key = Key { name: "potential", example: "potential = weight * gamma.dot(&chi)" };
/// Where the runtime crate is found.
pub const CRATE: Key = Key { name: "crate", example: "crate = path::to::coadjoint" };

/// All keys, in the order in which messages list them.
const KEYS: [Key; 4] = [GROUP, ADVECTED, POTENTIAL, CRATE];

/// What the attribute says. Problems were reported where they were found, and what they concern is left out.
#[derive(Debug, Default)]
pub struct Attribute {
    /// `group = SO3`
    pub group: Option<Ident>,
    /// `advected(gamma: R3, …)`, in the order written.
    pub advected: Vec<Advected>,
    /// `potential = …`
    pub potential: Option<syn::Expr>,
    /// `crate = …`
    pub krate: Option<syn::Path>,
    /// The keys that were there, whether or not their values could be read.
    given: Vec<Key>,
}

/// One advected parameter.
#[derive(Debug)]
pub struct Advected {
    /// What the user calls it.
    pub name: Ident,
    /// The space it lives in.
    pub space: Ident,
}

impl Attribute {
    /// Reads the tokens between the parentheses of the attribute.
    pub fn parse(tokens: TokenStream, diagnostics: &mut Diagnostics) -> Self {
        let mut attribute = Self::default();
        if let Some((span, message)) = nesting::excess(&tokens) {
            diagnostics.push_at(span, message);
            // nothing was read, so nothing can be said to be missing
            attribute.given = KEYS.to_vec();
            return attribute;
        }
        let entries = |input: ParseStream<'_>| {
            while !input.is_empty() {
                attribute.entry(input, diagnostics);
            }
            Ok(())
        };
        if let Err(error) = entries.parse2(tokens) {
            diagnostics.absorb(error);
        }
        attribute
    }

    /// Whether the key was written, even if its value could not be read.
    pub fn has(&self, key: Key) -> bool {
        self.given.contains(&key)
    }

    /// One `key = value` or `key(…)`, with the comma after it. Always consumes something.
    fn entry(&mut self, input: ParseStream<'_>, diagnostics: &mut Diagnostics) {
        let key = match Ident::parse_any(input) {
            Ok(key) => key,
            Err(error) => {
                diagnostics.push_at(error.span(), format!("expected a key, such as `{}`", GROUP.example));
                skip_entry(input);
                return;
            }
        };
        let name = key.to_string();
        let Some(&known) = KEYS.iter().find(|known| known.name == name) else {
            let names = KEYS.map(|key| key.name);
            diagnostics.push(&key, format!("there is no key `{name}`{}", suggestion(&name, &names)));
            skip_entry(input);
            return;
        };
        let again = self.has(known);
        if again {
            diagnostics.push(&key, format!("`{name}` is given twice; keep one of them"));
        }
        self.given.push(known);
        // a second value is read all the same, for the sake of problems in it
        let mut ignored = Self::default();
        let target = if again { &mut ignored } else { self };
        let value = input.fork();
        let read = match known {
            GROUP => group(&value, diagnostics).map(|group| target.group = group),
            POTENTIAL => equals(&value, known, diagnostics).map(|potential| target.potential = potential),
            CRATE => crate_path(&value, diagnostics).map(|path| target.krate = path),
            _ => advected(&value, &key, diagnostics).map(|list| target.advected = list),
        };
        finish_entry(input, &value, read, diagnostics);
    }
}

/// `= value`. `None` where the value is missing, which is reported.
fn equals<T: syn::parse::Parse>(
    input: ParseStream<'_>,
    key: Key,
    diagnostics: &mut Diagnostics,
) -> syn::Result<Option<T>> {
    if !input.peek(Token![=]) || input.peek(Token![==]) {
        return Err(input.error(format!("expected `=`; write `{}`", key.example)));
    }
    let sign: Token![=] = input.parse()?;
    if input.is_empty() || input.peek(Token![,]) {
        diagnostics.push(sign, format!("`{}` has no value; write `{}`", key.name, key.example));
        return Ok(None);
    }
    input.parse().map(Some)
}

/// `= SO3`
fn group(input: ParseStream<'_>, diagnostics: &mut Diagnostics) -> syn::Result<Option<Ident>> {
    let name: Option<Ident> =
        equals(input, GROUP, diagnostics).map_err(|error| with_example(error, GROUP))?;
    if let Some(name) = &name
        && input.peek(token::Paren)
    {
        let dimension: Group = input.parse()?;
        let message = format!("write the name of the group in one word: `{name}{}`", dimension.stream());
        diagnostics.push(quote!(#name #dimension), message);
        return Ok(None);
    }
    Ok(name)
}

/// The error with an example of the key's use, unless it has one already.
fn with_example(error: syn::Error, key: Key) -> syn::Error {
    let message = error.to_string();
    if message.contains(key.example) {
        return error;
    }
    syn::Error::new(error.span(), format!("{message}; write `{}`", key.example))
}

/// `= path::to::coadjoint`
fn crate_path(input: ParseStream<'_>, diagnostics: &mut Diagnostics) -> syn::Result<Option<syn::Path>> {
    let ahead = input.fork();
    if ahead.parse::<Token![=]>().is_ok() && ahead.peek(LitStr) {
        let text: LitStr = ahead.parse()?;
        input.advance_to(&ahead);
        diagnostics.push(&text, format!("write the path without quotes: `crate = {}`", text.value()));
        return Ok(None);
    }
    if ahead.is_empty() || ahead.peek(Token![,]) {
        return equals::<syn::Path>(input, CRATE, diagnostics);
    }
    input.parse::<Token![=]>().map_err(|error| with_example(error, CRATE))?;
    syn::Path::parse_mod_style(input).map(Some).map_err(|error| with_example(error, CRATE))
}

/// `(name: Space, …)`
fn advected(
    input: ParseStream<'_>,
    key: &Ident,
    diagnostics: &mut Diagnostics,
) -> syn::Result<Vec<Advected>> {
    if !input.peek(token::Paren) {
        let missing = input.is_empty() || input.peek(Token![,]);
        let place = if missing { key.span() } else { input.span() };
        return Err(syn::Error::new(place, format!("expected parentheses; write `{}`", ADVECTED.example)));
    }
    let content;
    parenthesized!(content in input);
    if content.is_empty() {
        diagnostics.push(key, format!("`advected` names no parameter; write `{}`", ADVECTED.example));
    }
    let mut list: Vec<Advected> = Vec::new();
    while !content.is_empty() {
        let parameter = content.fork();
        let read = advected_parameter(&parameter).map(|parameter| {
            if list.iter().any(|earlier| earlier.name == parameter.name) {
                let message = format!("two advected parameters are called `{}`", parameter.name);
                diagnostics.push(&parameter.name, message);
            } else {
                list.push(parameter);
            }
        });
        finish_entry(&content, &parameter, read, diagnostics);
    }
    Ok(list)
}

/// `name: Space`
fn advected_parameter(input: ParseStream<'_>) -> syn::Result<Advected> {
    let explain = |error: syn::Error, expected: &str| {
        let message = format!("expected {expected}; an advected parameter is written `gamma: R3`");
        syn::Error::new(error.span(), message)
    };
    let name: Ident = input.parse().map_err(|error| explain(error, "a name"))?;
    let ends_here = input.is_empty() || input.peek(Token![,]);
    if ends_here {
        let message = format!("`{name}` needs the space it lives in; write `{name}: R3`");
        return Err(syn::Error::new_spanned(&name, message));
    }
    input.parse::<Token![:]>().map_err(|error| explain(error, "a colon"))?;
    let space = input.parse().map_err(|error| explain(error, "a space"))?;
    Ok(Advected { name, space })
}

/// Goes on after an entry: behind its comma if it was read up to `end`, otherwise wherever the next one begins.
///
/// Entries are read from a fork, because syn remembers the tokens that a failed parser leaves behind and would complain
/// about them a second time.
fn finish_entry(
    input: ParseStream<'_>,
    end: ParseStream<'_>,
    read: syn::Result<()>,
    diagnostics: &mut Diagnostics,
) {
    if let Err(error) = read {
        diagnostics.absorb(error);
        return skip_entry(input);
    }
    input.advance_to(end);
    let comma = input.parse::<Option<Token![,]>>();
    if input.is_empty() || comma.is_ok_and(|comma| comma.is_some()) {
        return;
    }
    // a forgotten comma is no reason to skip what follows
    diagnostics.push_at(input.span(), "expected a comma before this");
    if !starts_entry(input) {
        skip_entry(input);
    }
}

/// Whether a known `key =` or `key(`, or a `name:`, comes next.
fn starts_entry(input: ParseStream<'_>) -> bool {
    let ahead = input.fork();
    let Ok(name) = Ident::parse_any(&ahead) else { return false };
    let known = KEYS.iter().any(|key| name == key.name);
    ahead.peek(Token![:]) || known && (ahead.peek(Token![=]) || ahead.peek(token::Paren))
}

/// Everything up to and with the next comma.
fn skip_entry(input: ParseStream<'_>) {
    while let Ok(token) = input.parse::<TokenTree>() {
        if matches!(&token, TokenTree::Punct(punct) if punct.as_char() == ',') {
            return;
        }
    }
}
