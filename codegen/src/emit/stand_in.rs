//! What takes the place of an item whose description is in error.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use crate::diagnostics::Diagnostics;
use crate::parse::{Attribute, CONTROL, DERIVATIVES, without_helpers};

/// Aliases of a type that is itself the error, under all the names that users write: rustc takes whatever is done with such a type without
/// further complaint. The struct is there too, out of sight, for what else there is to say about it.
/// Of an item without a name to stand in for, the item as it is.
pub(crate) fn stand_in(item: TokenStream, attribute: &Attribute, diagnostics: Diagnostics) -> TokenStream {
    let mut errors = diagnostics.into_compile_errors();
    let item = match without_helpers(item.clone()) {
        Some(read) if read.generics.params.is_empty() && !errors.is_empty() => read,
        read => {
            let item = read.map_or(item, |read| quote! { #read });
            return quote! { #item #(#errors)* };
        }
    };
    let first = errors.remove(0);
    let (name, visibility) = (&item.ident, &item.vis);
    let mut others: Vec<Ident> = vec![format_ident!("{name}State")];
    if attribute.has(CONTROL) {
        others.push(format_ident!("{name}Control"));
    }
    if attribute.has(DERIVATIVES) {
        others.push(format_ident!("{name}Indices"));
    }
    quote! {
        const _: () = { #item };
        #visibility type #name = #first;
        #(#visibility type #others = #name;)*
        #(#errors)*
    }
}
