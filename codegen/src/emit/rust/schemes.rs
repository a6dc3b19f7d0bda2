//! Which steps there are: the types that stand for them, and how they are chosen from while a program runs.

use proc_macro2::{Literal, TokenStream};
use quote::{ToTokens, format_ident, quote};

use super::functions::block;
use super::names::Names;
use crate::program::StepProgram;
use crate::scheme::{Member, Parameter, Scheme};

/// The type that stands for a scheme: `Family<Cayley, 0, 1>`.
pub(super) fn marker(names: &Names, scheme: Scheme) -> TokenStream {
    let Names { private, coadjoint, .. } = names;
    let Scheme { retraction, rule } = scheme;
    let [method, retraction] = [rule.method.name, retraction.name()].map(|name| format_ident!("{name}"));
    let s = parameter(rule.parameter);
    quote! { #private::#method<#coadjoint::#retraction, #s> }
}

/// `1, 4` or `6`
fn parameter(parameter: Parameter) -> TokenStream {
    let literal = Literal::u32_unsuffixed;
    match parameter {
        Parameter::Share(Member { numerator, denominator }) => {
            let [numerator, denominator] = [numerator, denominator].map(literal);
            quote! { #numerator, #denominator }
        }
        Parameter::Order(order) => literal(order).into_token_stream(),
    }
}

/// `impl Schemes for HeavyTop { … }`: shows a visitor the type of the step that is asked for.
/// `impl Retracted<Cayley> for HeavyTop { … }` for each retraction that there is.
pub(super) fn schemes(names: &Names, steps: &[StepProgram]) -> TokenStream {
    let Names { system, private, coadjoint, .. } = names;
    let named = |step: &StepProgram| [vec![step.scheme], step.aliases.clone()].concat();
    let mut retractions: Vec<_> = steps.iter().flat_map(named).map(|scheme| scheme.retraction).collect();
    retractions.sort_unstable();
    retractions.dedup();
    let retracted = retractions.into_iter().map(|retraction| {
        let name = format_ident!("{}", retraction.name());
        // what is not odd makes no symmetric step of the first member
        let scheme = match retraction.is_odd() {
            true => quote! { <Self as #private::System>::Standard<#coadjoint::#name> },
            false => quote! { #private::StormerVerlet<#coadjoint::#name> },
        };
        quote! {
            #[automatically_derived]
            impl #private::Retracted<#coadjoint::#name> for #system {
                type Scheme = #scheme;
            }
        }
    });
    let patterns = |step: &StepProgram| {
        let patterns = named(step).into_iter().map(|scheme| {
            let Scheme { retraction, rule } = scheme;
            let [map, named] = [retraction.name(), rule.method.name].map(|name| format_ident!("{name}"));
            let s = parameter(rule.parameter);
            quote! { (#private::RetractionKind::#map, #private::Rule::#named(#s)) }
        });
        quote! { #(#patterns)|* }
    };
    let arms = steps.iter().map(|step| {
        let (patterns, marker) = (patterns(step), marker(names, step.scheme));
        quote! { #patterns => #private::Visitor::visit::<#marker>(visitor) }
    });
    let linearized = steps.iter().filter(|step| step.derivative.is_some()).map(|step| {
        let marker = marker(names, step.scheme);
        let patterns = patterns(step);
        quote! {
            #patterns => #private::LinearizedVisitor::visit::<
                <Self as #private::Generated<#marker>>::Kernel<<Self as #private::System>::Scalar>
            >(visitor)
        }
    });
    let visit = |name: &str, visitor: &str, arms: Vec<TokenStream>| {
        let [name, visitor] = [name, visitor].map(|name| format_ident!("{name}"));
        quote! {
            #[inline]
            fn #name<V: #private::#visitor<Self>>(
                map: #private::RetractionKind,
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
    let linearized: Vec<TokenStream> = linearized.collect();
    // by default there are none
    let linearized =
        (!linearized.is_empty()).then(|| visit("visit_linearized", "LinearizedVisitor", linearized));
    let visit = visit("visit", "Visitor", arms.collect());
    let schemes = quote! {
        #(#retracted)*

        #[automatically_derived]
        impl #private::LinearizedSchemes for #system {
            #linearized
        }

        #[automatically_derived]
        impl #private::Schemes for #system {
            #visit
        }
    };
    block(&schemes)
}
