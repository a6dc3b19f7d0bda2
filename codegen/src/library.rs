//! The tables of retractions and methods, handed to macros of the libraries: these say what is made of a row, so that a new
//! row is all that a retraction or a method needs there.

use proc_macro2::{Literal, TokenStream};
use quote::{ToTokens, format_ident, quote};

use crate::group::Retraction;
use crate::method;
use crate::scheme::{Method, Named};

/// Calls a macro with the retractions, each with what is known of it.
///
/// ```text
/// callback! { #[doc = "…"] Cayley { is_odd: true, is_matrix_function: true, spoken: "Cayley", word: "cayley", short: "cay", about: "…" } … }
/// ```
pub fn retractions(callback: TokenStream) -> TokenStream {
    let rows = Retraction::ALL.into_iter().map(|retraction| {
        let (row, name) = (retraction.row(), format_ident!("{}", retraction.name()));
        let (doc, spoken, short, about) = (row.doc, row.spoken, row.short, row.about);
        let word = row.snake_name.replace('_', "-");
        let (is_odd, is_matrix_function) = (retraction.is_odd(), retraction.is_equivariant());
        quote! {
            #[doc = #doc]
            #name {
                is_odd: #is_odd,
                is_matrix_function: #is_matrix_function,
                spoken: #spoken,
                word: #word,
                short: #short,
                about: #about
            }
        }
    });
    quote! { #callback! { #(#rows)* } }
}

/// Calls a macro with the methods: those whose parameter is a share of the step, with the names of some members, and
/// those whose parameter is an order.
///
/// ```text
/// callback! {
///     share {
///         #[doc = "…"] Family {
///             word: "family", about: "…", is_symplectic: true, is_one_map: true,
///             named: { #[doc = "…"] Midpoint(1, 2) { word: "midpoint", about: "…" } … }
///         } …
///     }
///     order { #[doc = "…"] HamiltonJacobi { word: "…", about: "…", is_symplectic: true, orders: [4, 6, 8, 10], usual: 6 } … }
/// }
/// ```
pub fn methods(callback: TokenStream) -> TokenStream {
    let literal = Literal::u32_unsuffixed;
    let named = |of: &Method, Named { name, word, about, member, doc }: &Named| {
        let ident = format_ident!("{name}");
        let [numerator, denominator] = [member.numerator, member.denominator].map(literal);
        // the method's own type stands for it
        let doc = (*name != of.name).then(|| quote! { #[doc = #doc] });
        quote! { #doc #ident(#numerator, #denominator) { word: #word, about: #about } }
    };
    let (mut shares, mut orders) = (Vec::new(), Vec::new());
    for method in method::known() {
        let Method { word, about, doc, is_symplectic, is_one_map, .. } = method;
        let name = format_ident!("{}", method.name);
        match method.usual_order {
            None => {
                let named = method.named.iter().map(|one| named(method, one));
                shares.push(quote! {
                    #[doc = #doc]
                    #name {
                        word: #word,
                        about: #about,
                        is_symplectic: #is_symplectic,
                        is_one_map: #is_one_map,
                        named: { #(#named)* }
                    }
                });
            }
            Some(usual) => {
                let of = method.orders.iter().map(|&order| literal(order).into_token_stream());
                let usual = literal(usual);
                orders.push(quote! {
                    #[doc = #doc]
                    #name {
                        word: #word,
                        about: #about,
                        is_symplectic: #is_symplectic,
                        orders: [#(#of),*],
                        usual: #usual
                    }
                });
            }
        }
    }
    quote! { #callback! { share { #(#shares)* } order { #(#orders)* } } }
}
