//! Power series of a motion as Rust.

use std::collections::HashMap;

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use super::code::{array, inlined, kept, method, record, size, term};
use super::functions::block;
use super::names::Names;
use crate::program::{Function, Input, Interface, RecordKind, TaylorProgram, TaylorRole, Term, Values};

/// `impl PowerSeries for HeavyTop { … }`
pub(super) fn taylor(names: &Names, interface: &Interface, series: &TaylorProgram) -> TokenStream {
    let Names { private, system, scalar, .. } = names;
    let TaylorProgram { blocks, controls, rates, events, module } = series;
    let function = |role| module.function(role);
    let given = function(TaylorRole::Leading).map_or(0, |function| function.length(Input::Velocity));
    let velocity = size(given);
    let lanes = function(TaylorRole::Next).map_or(0, |function| function.length(Input::Sums));
    let (unknowns, lanes) = (size(blocks.iter().sum()), size(lanes.next_multiple_of(TOGETHER)));
    let blocks = blocks.iter().map(|&length| size(length));
    let places = [("CONTROLS", controls), ("RATES", rates)].map(|(name, place)| {
        let (name, place) = (Ident::new(name, Span::call_site()), size((*place)?));
        Some(quote! {
            const #name: ::core::option::Option<::core::primitive::usize> = ::core::option::Option::Some(#place);
        })
    });
    let event_count = size(events.len());
    let events = (!events.is_empty()).then(|| {
        let events = events.iter().map(|&place| size(place));
        quote! { const EVENTS_WITH_SERIES: &'static [::core::primitive::usize] = &[#(#events),*]; }
    });
    let products = Products::of(series);
    let (operands, products) = (size(products.operands.len()), products.functions(&lanes));
    let kept = record(&module.values, RecordKind::Step);
    let functions = module.functions.iter().map(|one| {
        let signature = signature(one.role, interface, &velocity);
        method(&module.values, one, &signature, &result(&module.values, one))
    });
    let dimension = size(interface.dimension);
    let found = quote! {
        #private::Stored::<_, #dimension>::to_array(&#private::System::velocity_at(self, state, time, control))
    };
    let start = match given {
        0 => quote! { [] },
        given if given == interface.dimension => found,
        _ => quote! {
            let mut velocity = [<#scalar as Scalar>::of(0.0); #velocity];
            for (to, number) in velocity.iter_mut().zip(#found) {
                *to = number;
            }
            velocity
        },
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
                type Operands<T: Scalar> = [T; #operands];
                type Velocity<T: Scalar> = [T; #velocity];
                type Events<T: Scalar> = [T; #event_count];

                const BLOCKS: Blocks = &[#(#blocks),*];
                #(#places)*
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
                #products
            }
        };
    })
}

/// Products are as many as fill whole registers: some of them are nobody's.
const TOGETHER: usize = 8;

/// So many sums of products are under way at a time: they and what they are made of are in registers.
const UNDER_WAY: usize = 12;

/// The products of series.
#[derive(Default)]
struct Products {
    /// What they are of, each once.
    operands: Vec<TokenStream>,
    /// The places of both operands of each among these.
    pairs: Vec<[usize; 2]>,
}

impl Products {
    fn of(series: &TaylorProgram) -> Self {
        let next = series.module.function(TaylorRole::Next);
        next.map_or_else(Self::default, |next| Self::new(&series.module.values, next))
    }

    fn new(values: &Values, next: &Function<TaylorRole>) -> Self {
        let (mut operands, mut places) = (Vec::new(), HashMap::new());
        let mut place = |operand: &Term| {
            let operand = term(values, operand);
            *places.entry(operand.to_string()).or_insert_with(|| {
                operands.push(operand);
                operands.len() - 1
            })
        };
        let [left, right] = [1, 2].map(|place| next.results.get(place).map_or(&[][..], Vec::as_slice));
        let pairs = left.iter().zip(right).map(|(left, right)| [place(left), place(right)]).collect();
        Self { operands, pairs }
    }

    /// What the products are, in two ways: for the sums of all of one number side by side, and for those of numbers that are side by side themselves.
    fn functions(&self, lanes: &Literal) -> TokenStream {
        let (length, inlined) = (size(self.operands.len()), inlined());
        let spare = self.pairs.len().next_multiple_of(TOGETHER) - self.pairs.len();
        let zeros = || std::iter::repeat_n(quote! { T::of(0.0) }, spare);
        let side = |side: usize| {
            let operand = self.pairs.iter().map(|pair| size(pair[side]));
            let operand = operand.map(|place| quote! { operands[#place] }).chain(zeros());
            quote! { [#(#operand),*] }
        };
        let (left, right) = (side(0), side(1));
        let name = |k: usize| Ident::new(&format!("sum_{}", k + 1), Span::call_site());
        let sums = (0..self.pairs.len()).map(name).collect::<Vec<_>>();
        let parts = self.pairs.chunks(UNDER_WAY).zip(sums.chunks(UNDER_WAY)).map(|(pairs, sums)| {
            let count = size(sums.len());
            let terms = pairs.iter().zip(sums).map(|(pair, sum)| {
                let [left, right] = pair.map(size);
                quote! { #sum = left[#left].mul_add(right[#right], #sum); }
            });
            quote! {
                let [#(mut #sums),*] = [T::of(0.0); #count];
                for (left, right) in terms.clone() {
                    #(#terms)*
                }
            }
        });
        let all = sums.iter().map(|sum| quote! { #sum }).chain(zeros());
        quote! {
            #inlined
            fn lanes<T: Scalar>(operands: &[T; #length]) -> [[T; #lanes]; 2] {
                [#left, #right]
            }

            #inlined
            fn sums<'s, T: Scalar>(
                terms: impl ::core::iter::Iterator<Item = (&'s [T; #length], &'s [T; #length])> + ::core::clone::Clone,
            ) -> [T; #lanes] {
                #(#parts)*
                [#(#all),*]
            }
        }
    }
}

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
        TaylorRole::Rate => quote! {
            fn rate<T: Scalar>(step: &Self::Kept<T>, end: &Self::Coefficients<T>) -> Self::Coefficients<T>
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
            let Products { operands, .. } = Products::new(values, function);
            quote! { Next { change: #change, operands: [#(#operands),*], events: #events } }
        }
        TaylorRole::Rate | TaylorRole::Finish => quote! { #(#results)* },
    }
}
