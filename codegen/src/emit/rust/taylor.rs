//! Power series of a motion as Rust.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::code::{array, kept, method, record, size};
use super::functions::block;
use super::names::Names;
use crate::expr::Number;
use crate::program::{Function, Input, Interface, RecordKind, TaylorProgram, TaylorRole, Term, Values};

/// `impl PowerSeries for HeavyTop { … }`
pub(super) fn taylor(names: &Names, interface: &Interface, series: &TaylorProgram) -> TokenStream {
    let Names { private, system, scalar, .. } = names;
    let TaylorProgram { blocks, controls, events, module } = series;
    let function = |role| module.function(role);
    let has_velocity =
        function(TaylorRole::Leading).is_some_and(|function| function.length(Input::Velocity) > 0);
    let velocity = size(if has_velocity { interface.dimension } else { 0 });
    let lanes = function(TaylorRole::Next).map_or(0, |function| function.length(Input::Sums));
    let (unknowns, lanes) = (size(blocks.iter().sum()), size(lanes.next_multiple_of(TOGETHER)));
    let blocks = blocks.iter().map(|&length| size(length));
    let controls = controls.map(|place| {
        let place = size(place);
        quote! {
            const CONTROLS: ::core::option::Option<::core::primitive::usize> = ::core::option::Option::Some(#place);
        }
    });
    let event_count = size(events.len());
    let events = (!events.is_empty()).then(|| {
        let events = events.iter().map(|&place| size(place));
        quote! { const EVENTS_WITH_SERIES: &'static [::core::primitive::usize] = &[#(#events),*]; }
    });
    let kept = record(&module.values, RecordKind::Step);
    let functions = module.functions.iter().map(|one| {
        let signature = signature(one.role, interface, &velocity);
        method(&module.values, one, &signature, &result(&module.values, one))
    });
    let start = match has_velocity {
        true => quote! {
            #private::Stored::<_, #velocity>::to_array(&#private::System::velocity_at(self, state, time, control))
        },
        false => quote! { [] },
    };
    block(&quote! {
        type __System = #system;

        const _: () = {
            use #private::{Blocks, Leading, Next, PowerSeries, Scalar};

            #[automatically_derived]
            impl PowerSeries for __System {
                type Kept<T: Scalar> = #kept;
                type Coefficients<T: Scalar> = [T; #unknowns];
                type Lanes<T: Scalar> = [T; #lanes];
                type Velocity<T: Scalar> = [T; #velocity];
                type Events<T: Scalar> = [T; #event_count];

                const BLOCKS: Blocks = &[#(#blocks),*];
                #controls
                #events

                fn start_velocity(
                    &self,
                    state: &<Self as #private::System>::State,
                    time: #scalar,
                    control: &<Self as #private::System>::Control,
                ) -> [#scalar; #velocity] {
                    #start
                }

                #(#functions)*
            }
        };
    })
}

/// Products are as many as fill whole registers: some of them are nobody's.
const TOGETHER: usize = 8;

fn signature(role: TaylorRole, interface: &Interface, velocity: &Literal) -> TokenStream {
    let [parameters, state, control] =
        [interface.parameter_length(), interface.state_length(), interface.control_length()].map(size);
    match role {
        TaylorRole::Leading => quote! {
            fn leading<T: Scalar>(
                parameters: &[T; #parameters],
                state: &[T; #state],
                time: T,
                control: &[T; #control],
                velocity: &[T; #velocity],
            ) -> Leading<Self, T>
        },
        TaylorRole::Next => quote! {
            fn next<T: Scalar>(
                step: &Self::Kept<T>,
                coefficients: &Self::Coefficients<T>,
                sums: &Self::Lanes<T>,
                order: T,
            ) -> Next<Self, T>
        },
        TaylorRole::Finish => quote! {
            fn finish<T: Scalar>(step: &Self::Kept<T>, end: &Self::Coefficients<T>) -> [T; #state]
        },
    }
}

/// The results of a function.
fn result(values: &Values, function: &Function<TaylorRole>) -> TokenStream {
    let results: Vec<TokenStream> = function.results.iter().map(|result| array(values, result)).collect();
    match function.role {
        TaylorRole::Leading => {
            let kept = kept(values, RecordKind::Step);
            let [start, change, events] = [0, 1, 2].map(|place| results.get(place));
            quote! { Leading { kept: #kept, start: #start, change: #change, events: #events } }
        }
        TaylorRole::Next => {
            let (change, events) = (results.first(), results.get(3));
            let [left, right] = [1, 2].map(|place| {
                let numbers = function.results.get(place).map_or(&[][..], Vec::as_slice);
                let spare = numbers.len().next_multiple_of(TOGETHER) - numbers.len();
                let zeros = std::iter::repeat_n(Term::Number(Number::ZERO), spare);
                array(values, &numbers.iter().cloned().chain(zeros).collect::<Vec<_>>())
            });
            quote! { Next { change: #change, operands: [#left, #right], events: #events } }
        }
        TaylorRole::Finish => quote! { #(#results)* },
    }
}
