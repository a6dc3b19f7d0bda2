//! Documentation of generated items.

use proc_macro2::TokenStream;
use quote::quote;

/// One line of documentation.
pub(super) fn line(text: &str) -> TokenStream {
    let text = format!(" {text}");
    quote! { #[doc = #text] }
}

/// Several lines; empty ones separate paragraphs.
pub(super) fn lines<S: AsRef<str>>(texts: impl IntoIterator<Item = S>) -> TokenStream {
    texts
        .into_iter()
        .map(|text| match text.as_ref() {
            "" => quote! { #[doc = ""] },
            text => line(text),
        })
        .collect()
}
