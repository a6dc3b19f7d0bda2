//! The kernel of one step: its functions as an implementation of the runtime's `Kernel`.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::code::{arguments, array, arrays, kept, method, record, size, term};
use super::names::Names;
use super::schemes::marker;
use crate::emit::bytes;
use crate::program::{Function, FunctionRole as _, Input, Module, RecordKind, StepProgram, StepRole};
use crate::scheme::Scheme;

/// The name of the struct with a kernel's constants.
pub(super) fn kernel_name(names: &Names, scheme: Scheme) -> Ident {
    // at the place of the macro, not of the user's name, whose style is then not ours to answer for
    format_ident!("{}{}", names.system.to_string().trim_start_matches("r#"), scheme.name())
}

/// The kernel of one system and scheme:
///
/// ```text
/// pub struct HeavyTopCayley<T>([T; 13]);
/// impl Generated<Family<Cayley, 0, 1>> for HeavyTop { type Kernel<T: Scalar> = HeavyTopCayley<T>; }
///
/// const _: () = {
///     impl<T: Scalar> Kernel<T> for HeavyTopCayley<T> { … }
/// };
/// ```
///
/// The inner block does not name the system, which may be called `Kernel`, too.
pub(super) fn kernel(names: &Names, step: &StepProgram) -> TokenStream {
    let Names { system, private, .. } = names;
    let StepProgram { scheme, aliases, module, .. } = step;
    let name = kernel_name(names, *scheme);
    let markers = std::iter::once(scheme).chain(aliases).map(|&scheme| marker(names, scheme));
    let [constants, step_record, iterate] = [RecordKind::Constants, RecordKind::Step, RecordKind::Iterate]
        .map(|kind| record(&module.values, kind));
    let places = size(module.values.places());
    let length = |role, input| size(module.function(role).map_or(0, |function| function.length(input)));
    let parameters = length(StepRole::New, Input::Parameters);
    let [state, controls] = [Input::State, Input::Control].map(|input| length(StepRole::Begin, input));
    let unknown = length(StepRole::Evaluate, Input::Unknown);
    let blocks = step.blocks.iter().map(|&length| size(length));
    let functions = module.functions.iter();
    let functions = functions.map(|one| method(&module.values, one, &signature(one), &result(module, one)));
    let has_fewer_terms = (!step.has_true_jacobian).then(|| {
        quote! { const HAS_TRUE_JACOBIAN: ::core::primitive::bool = false; }
    });
    let is_newton = step.is_newton.then(|| quote! { const IS_NEWTON: ::core::primitive::bool = true; });
    let is_chord = step.is_chord.then(|| quote! { const IS_CHORD: ::core::primitive::bool = true; });
    let is_long = step.is_long.then(|| quote! { const IS_LONG: ::core::primitive::bool = true; });
    let bounded = bounded(&step.bounded);
    let program = bytes::functions(module).map(|function| Literal::byte_string(&function));

    quote! {
        /// What depends on the parameters and the step `h` alone.
        pub struct #name<T>(#constants);
        #private::copied!(#name);

        #(#[automatically_derived]
        impl #private::Generated<#markers> for #system {
            type Kernel<T: #private::Scalar> = #name<T>;
        })*

        const _: () = {
            use #private::{Blocks, Evaluation, Kernel, Program, Scalar};

            #[automatically_derived]
            impl<T: Scalar> Kernel<T> for #name<T> {
                type Parameters = [T; #parameters];
                type State = [T; #state];
                type Control = [T; #controls];
                type Unknown = [T; #unknown];
                type Step = #step_record;
                type Iterate = #iterate;
                type Places<X: Scalar> = [X; #places];

                const BLOCKS: Blocks = &[#(#blocks),*];
                /// `new`, `begin`, `evaluate` and `finish` once more, as bytes: certificates run them in twice the digits.
                const PROGRAM: Program = [#(#program),*];
                #has_fewer_terms
                #is_newton
                #is_chord
                #is_long

                #[inline(always)]
                fn constants(&self) -> &[T] {
                    &self.0
                }
                #(#functions)*

                #bounded
            }
        };
    }
}

fn signature(function: &Function<StepRole>) -> TokenStream {
    let (name, given) = (format_ident!("{}", function.role.name()), arguments(function));
    let length = size(function.results.first().map_or(0, Vec::len));
    match function.role {
        StepRole::New => quote! { fn new(#(#given),*) -> Self },
        StepRole::Begin => quote! { fn begin(#(#given),*) -> Self::Step },
        StepRole::Start => quote! { fn start(#(#given),*) -> [T; #length] },
        StepRole::Evaluate => quote! { fn evaluate(#(#given,)*) -> Evaluation<[T; #length], Self::Iterate> },
        StepRole::Domain => quote! { fn domain(#(#given,)*) -> ::core::option::Option<T> },
        StepRole::Correction | StepRole::FixedPointUpdate | StepRole::Finish => {
            quote! { fn #name(#(#given,)*) -> [T; #length] }
        }
    }
}

/// The results of a function.
fn result(module: &Module<StepRole>, function: &Function<StepRole>) -> TokenStream {
    let arrays = arrays(&module.values, function);
    match function.role {
        StepRole::New => {
            let constants = kept(&module.values, RecordKind::Constants);
            quote! { Self(#constants) }
        }
        StepRole::Begin => kept(&module.values, RecordKind::Step),
        StepRole::Evaluate => {
            let iterate = kept(&module.values, RecordKind::Iterate);
            let [residual, right] = [0, 1].map(|place| array(&module.values, &function.results[place]));
            quote! { Evaluation { residual: #residual, right: #right, iterate: #iterate } }
        }
        StepRole::Domain => {
            let margins = function.results.iter().flatten().map(|margin| term(&module.values, margin));
            let margin = margins.reduce(|a, b| quote! { T::min(#a, #b) });
            quote! { ::core::option::Option::Some(#margin) }
        }
        StepRole::Start | StepRole::Correction | StepRole::FixedPointUpdate | StepRole::Finish => {
            quote! { #(#arrays)* }
        }
    }
}

/// `fn is_bounded(component: usize) -> bool { matches!(component, 0 | 1 | 2 | 3) }`
fn bounded(bounded: &[bool]) -> Option<TokenStream> {
    let bounded = bounded.iter().enumerate().filter(|&(_, &bounded)| bounded);
    let bounded: Vec<Literal> = bounded.map(|(component, _)| size(component)).collect();
    (!bounded.is_empty()).then(|| {
        quote! {
            /// Rotations stay of unit length.
            #[inline]
            fn is_bounded(component: ::core::primitive::usize) -> ::core::primitive::bool {
                ::core::matches!(component, #(#bounded)|*)
            }
        }
    })
}
