//! What takes the place of an item whose description is in error.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};
use syn::ext::IdentExt;
use syn::parse_quote;

use crate::diagnostics::Diagnostics;
use crate::parse::{Attribute, Key, without_helpers};

/// The struct, of a type that has the first of the errors as an argument, and aliases of a type that does not exist
/// under all other names that users write: rustc takes what is done with such types without further complaint. An item
/// that is no plain struct is left as it is.
pub(crate) fn stand_in(item: TokenStream, attribute: &Attribute, diagnostics: Diagnostics) -> TokenStream {
    let mut errors = diagnostics.into_compile_errors();
    let mut item = match without_helpers(item.clone()) {
        Some(read) if read.generics.params.is_empty() && !errors.is_empty() => read,
        read => {
            let item = read.map_or(item, |read| quote! { #read });
            return quote! { #item #(#errors)* };
        }
    };
    let first = errors.remove(0);
    let (name, visibility) = (item.ident.clone(), item.vis.clone());
    let hidden = format_ident!("__{}", name.unraw());
    item.ident = hidden.clone();
    // a constant, which need not be used
    item.generics.params.push(parse_quote! { const ERROR: ::core::primitive::usize });
    let mut others: Vec<Ident> = vec![format_ident!("{}State", name.unraw())];
    if attribute.has(Key::Control) {
        others.push(format_ident!("{}Control", name.unraw()));
    }
    if attribute.has(Key::Derivatives) {
        others.push(format_ident!("{}Indices", name.unraw()));
    }
    quote! {
        #item
        #visibility type #name = #hidden<{ #first }>;
        #(#visibility type #others = <#name as ::core::iter::IntoIterator>::Item;)*
        #(#errors)*
    }
}
