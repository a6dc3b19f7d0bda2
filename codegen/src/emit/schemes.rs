//! Which steps there are: the types that stand for them, and how they are chosen from while a program runs.

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use super::{Names, block};
use crate::program::StepProgram;
use crate::scheme::{Member, Rule, Scheme};

/// The type that stands for a scheme: `Family<Cayley, 0, 1>`.
pub(super) fn marker(names: &Names, scheme: Scheme) -> TokenStream {
    let Names { private, coadjoint, .. } = names;
    let retraction = format_ident!("{}", scheme.retraction.name());
    match scheme.rule {
        Rule::Family(member) => {
            let s = fraction(member);
            quote! { #private::Family<#coadjoint::#retraction, #s> }
        }
        Rule::TangentLift(member) => {
            let s = fraction(member);
            quote! { #private::TangentLift<#coadjoint::#retraction, #s> }
        }
    }
}

/// `1, 4`
fn fraction(Member { numerator, denominator }: Member) -> TokenStream {
    let [numerator, denominator] = [numerator, denominator].map(Literal::u32_unsuffixed);
    quote! { #numerator, #denominator }
}

/// `impl Schemes for HeavyTop { … }`: shows a visitor the type of the step that is asked for. `impl Retracted<Cayley> for HeavyTop { … }` for each
/// retraction that there is.
pub(super) fn schemes(names: &Names, steps: &[StepProgram]) -> TokenStream {
    let Names { system, private, coadjoint, .. } = names;
    let mut retractions: Vec<_> = steps.iter().map(|step| step.scheme.retraction.name()).collect();
    retractions.dedup();
    let retracted = retractions.into_iter().map(|retraction| {
        let retraction = format_ident!("{retraction}");
        quote! {
            #[automatically_derived]
            impl #private::Retracted<#coadjoint::#retraction> for #system {
                type Scheme = <Self as #private::System>::Standard<#coadjoint::#retraction>;
            }
        }
    });
    let arms = steps.iter().map(|StepProgram { scheme, aliases, .. }| {
        let map = format_ident!("{}", scheme.retraction.name());
        let rules = std::iter::once(scheme).chain(aliases).map(|scheme| match scheme.rule {
            Rule::Family(member) => {
                let s = fraction(member);
                quote! { #private::Rule::Member(#s) }
            }
            Rule::TangentLift(member) => {
                let s = fraction(member);
                quote! { #private::Rule::TangentLift(#s) }
            }
        });
        let marker = marker(names, *scheme);
        quote! { (#private::Map::#map, #(#rules)|*) => #private::Visitor::visit::<#marker>(visitor) }
    });
    let schemes = quote! {
        #(#retracted)*

        #[automatically_derived]
        impl #private::Schemes for #system {
            #[inline]
            fn visit<V: #private::Visitor<Self>>(
                map: #private::Map,
                rule: #private::Rule,
                visitor: V,
            ) -> ::core::option::Option<V::Output> {
                ::core::option::Option::Some(match (map, rule) {
                    #(#arms,)*
                    _ => return ::core::option::Option::None,
                })
            }
        }
    };
    block(&schemes)
}
