//! The kernel of one step: its functions as an implementation of the runtime's `Kernel`.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::code::{array, arrays, body, inlined, kept, record, size, term};
use super::names::Names;
use super::schemes::marker;
use super::{bytecode, docs};
use crate::program::{Function, Input, Module, RecordKind, Role, StepProgram};
use crate::scheme::Scheme;

/// What the struct with a kernel's constants is called.
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
    let [constants, step_record, iterate] =
        [RecordKind::Constants, RecordKind::Step, RecordKind::Iterate].map(|kind| record(module, kind));
    let places = size(module.places());
    let length = |role, input| size(module.function(role).map_or(0, |function| function.length(input)));
    let parameters = length(Role::New, Input::Parameters);
    let [state, controls] = [Input::State, Input::Control].map(|input| length(Role::Begin, input));
    let unknown = length(Role::Evaluate, Input::Unknown);
    let blocks = step.blocks.iter().map(|&length| size(length));
    let functions = module.functions.iter().map(|function| method(module, function));
    let no_update = module.function(Role::FixedPointUpdate).is_none().then(|| {
        quote! { const HAS_FIXED_POINT_UPDATE: ::core::primitive::bool = false; }
    });
    let bounded = bounded(&step.bounded);
    let program = bytecode::functions(module).map(|function| Literal::byte_string(&function));

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
                #no_update

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

/// One function as a method of the runtime's `Kernel`.
fn method(module: &Module, function: &Function) -> TokenStream {
    let doc = docs::line(&format!("{}: {}.", purpose(function.role), function.operations()));
    let signature = signature(function);
    let body = body(module, function);
    let result = result(module, function);
    let inlined = inlined();
    quote! {
        #doc
        #inlined
        #signature {
            #body
            #result
        }
    }
}

fn purpose(role: Role) -> &'static str {
    match role {
        Role::New => "Once, when the stepper is built",
        Role::Begin => "Once a step",
        Role::Start => "A first approximation of the unknown",
        Role::Evaluate => "Once an iteration: the residual and the right side of the equation",
        Role::Correction => "Once an iteration: the Newton correction",
        Role::FixedPointUpdate => "Once an iteration: the next iterate of the fixed-point iteration",
        Role::Domain => "Positive within the retraction's domain",
        _ => "Once a step: the next state",
    }
}

fn signature(function: &Function) -> TokenStream {
    let length = |input| size(function.length(input));
    let (state, unknown) = (length(Input::State), length(Input::Unknown));
    let solved = quote! {
        &self,
        state: &[T; #state],
        step: &Self::Step,
        unknown: &[T; #unknown],
        evaluation: &Evaluation<[T; #unknown], Self::Iterate>,
    };
    match function.role {
        Role::New => {
            let parameters = length(Input::Parameters);
            quote! { fn new(parameters: &[T; #parameters], step: T) -> Self }
        }
        Role::Begin => {
            let controls = length(Input::Control);
            quote! { fn begin(&self, state: &[T; #state], time: T, control: &[T; #controls]) -> Self::Step }
        }
        Role::Start => {
            let unknown = size(function.results.iter().map(Vec::len).sum());
            quote! { fn start(&self, state: &[T; #state], step: &Self::Step) -> [T; #unknown] }
        }
        Role::Evaluate => quote! {
            fn evaluate(
                &self,
                state: &[T; #state],
                step: &Self::Step,
                unknown: &[T; #unknown],
            ) -> Evaluation<[T; #unknown], Self::Iterate>
        },
        Role::Correction => quote! { fn correction(#solved) -> [T; #unknown] },
        Role::FixedPointUpdate => quote! { fn fixed_point_update(#solved) -> [T; #unknown] },
        Role::Domain => quote! { fn domain(#solved) -> ::core::option::Option<T> },
        _ => quote! { fn finish(#solved) -> [T; #state] },
    }
}

/// What a function returns.
fn result(module: &Module, function: &Function) -> TokenStream {
    let arrays = arrays(module, function);
    match function.role {
        Role::New => {
            let constants = kept(module, RecordKind::Constants);
            quote! { Self(#constants) }
        }
        Role::Begin => kept(module, RecordKind::Step),
        Role::Evaluate => {
            let iterate = kept(module, RecordKind::Iterate);
            let [residual, right] = [0, 1].map(|place| array(module, &function.results[place]));
            quote! { Evaluation { residual: #residual, right: #right, iterate: #iterate } }
        }
        Role::Domain => {
            let margins = function.results.iter().flatten().map(|margin| term(module, margin));
            let margin = margins.reduce(|a, b| quote! { T::min(#a, #b) });
            quote! { ::core::option::Option::Some(#margin) }
        }
        _ => quote! { #(#arrays)* },
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
            fn is_bounded(component: usize) -> bool {
                ::core::matches!(component, #(#bounded)|*)
            }
        }
    })
}
