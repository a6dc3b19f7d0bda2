//! `coadjoint show`: the generated code, as the macro emits it, formatted.

use std::io::Write;

use clap::Args;
use coadjoint_codegen::emit::StepExpansion;
use coadjoint_codegen::group;
use coadjoint_codegen::scheme::Scheme;
use proc_macro2::{Group, Literal, TokenStream, TokenTree};
use quote::ToTokens;
use syn::{Item, ItemStruct, Meta};

use super::description::DescriptionArguments;
use crate::catalogue::{Catalogue, Entry};
use crate::error::Error;
use crate::setup::Retraction;

/// The arguments of `show`.
#[derive(Debug, Args)]
pub(crate) struct ShowArguments {
    /// The system; `list` shows all
    #[cfg_attr(feature = "description", arg(required_unless_present = "description"))]
    #[cfg_attr(not(feature = "description"), arg(required = true))]
    pub(crate) system: Option<String>,
    #[command(flatten)]
    pub(crate) described: DescriptionArguments,
    /// Only the step built on this map; `exp` and `cay` for short
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
    /// The code of the steps' derivatives, too
    #[arg(long)]
    pub(crate) derivatives: bool,
}

pub(crate) fn show(
    catalogue: &Catalogue,
    arguments: &ShowArguments,
    console: &mut dyn Write,
) -> Result<(), Error> {
    let entry = arguments.described.system(catalogue, arguments.system.as_deref())?;
    let code = generated(entry, arguments.retraction, arguments.derivatives)
        .map_err(|error| Error::Generator { system: entry.name.clone(), reason: error.to_string() })?;
    write!(console, "{code}")?;
    Ok(())
}

/// The code generated from an entry's source, for one retraction or all, with its derivatives or without.
fn generated(entry: &Entry, retraction: Option<Retraction>, derivatives: bool) -> syn::Result<String> {
    let (attribute, item) = description(entry.source)?;
    let tokens = expand(attribute, item, retraction, derivatives)?;
    Ok(prettyplease::unparse(&syn::parse2(without_bytes(tokens))?))
}

/// With `b"..."` in the place of what nobody can read: programs as bytes, which say what the functions beside them say.
fn without_bytes(tokens: TokenStream) -> TokenStream {
    let shown = |tree: TokenTree| match tree {
        TokenTree::Group(group) => {
            TokenTree::Group(Group::new(group.delimiter(), without_bytes(group.stream())))
        }
        TokenTree::Literal(literal) if literal.to_string().starts_with("b\"") => {
            TokenTree::Literal(Literal::byte_string(b"..."))
        }
        tree => tree,
    };
    tokens.into_iter().map(shown).collect()
}

/// Expands the struct as the macro does, with the steps that were asked for.
fn expand(
    attribute: TokenStream,
    item: TokenStream,
    retraction: Option<Retraction>,
    derivatives: bool,
) -> syn::Result<TokenStream> {
    // the catalogue's descriptions ask for none
    let asked = derivatives.then(|| quote::quote! { derivatives, });
    let mut expansion = coadjoint_codegen::expand(quote::quote! { #asked #attribute }, item)?;
    if let Some(retraction) = retraction {
        let requested = match retraction {
            Retraction::Exponential => group::Retraction::Exponential,
            Retraction::Cayley => group::Retraction::Cayley,
            Retraction::SecondKind => group::Retraction::SecondKind,
        };
        let is_wanted = |scheme: &Scheme| scheme.retraction == requested;
        expansion.steps.retain(|StepExpansion { program, .. }| {
            is_wanted(&program.scheme) || program.aliases.iter().any(is_wanted)
        });
        // it names all steps
        expansion.schemes = TokenStream::new();
    }
    Ok(expansion.into_tokens())
}

/// The arguments of the attribute in a system's file, and the struct it stands on.
fn description(source: &str) -> syn::Result<(TokenStream, TokenStream)> {
    let file = syn::parse_file(source)?;
    let described = file.items.into_iter().find_map(|item| match item {
        Item::Struct(item) => take_attribute(item),
        _ => None,
    });
    described
        .ok_or_else(|| syn::Error::new(proc_macro2::Span::call_site(), "no struct is described in its file"))
}

fn take_attribute(mut item: ItemStruct) -> Option<(TokenStream, TokenStream)> {
    let is_ours = |attribute: &syn::Attribute| {
        attribute.path().segments.last().is_some_and(|segment| segment.ident == "lie_poisson_system")
    };
    let position = item.attrs.iter().position(is_ours)?;
    let arguments = match item.attrs.remove(position).meta {
        Meta::List(list) => list.tokens,
        _ => TokenStream::new(),
    };
    Some((arguments, item.into_token_stream()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::catalogue;

    #[test]
    fn the_attribute_is_taken_off_the_struct() {
        let source = "use a::b; struct Other; #[doc = \"x\"] #[m::lie_poisson_system(group = SO3)] struct Body { a: f64 }";
        let (attribute, item) = description(source).expect("there is one");
        assert_eq!(attribute.to_string(), "group = SO3");
        let item: ItemStruct = syn::parse2(item).expect("a struct");
        assert_eq!(item.ident, "Body");
        assert_eq!(item.attrs.len(), 1);
        assert!(description("struct Other;").is_err());
    }

    #[test]
    fn every_system_can_be_shown() {
        for entry in catalogue().entries() {
            for retraction in [None, Some(Retraction::Exponential), Some(Retraction::Cayley)] {
                let code = generated(entry, retraction, false).expect("its own generator takes it");
                assert!(code.contains("struct") && !code.contains("Linearized<"), "{}", entry.name);
            }
            let code = generated(entry, Some(Retraction::Cayley), true).expect("its own generator takes it");
            assert!(code.contains("impl<T: Scalar> Linearized<T"), "{}", entry.name);
            assert!(code.contains("b\"...\"") && !code.contains("\\x"), "{}", entry.name);
        }
    }
}
