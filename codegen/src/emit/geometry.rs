//! The `Geometry` implementation: local coordinates and the Poisson structure of the states.

use proc_macro2::TokenStream;
use quote::quote;

use super::code::size;
use super::functions::{call, function};
use super::names::Names;
use crate::program::{Input, Program, Role};

/// `impl Geometry for HeavyTop { … }`, and `impl Isolated` where nothing acts on the system.
pub(super) fn geometry(program: &Program, names: &Names) -> TokenStream {
    let Names { private, system: name, state, scalar, .. } = names;
    let displacement = program.function(Role::ExponentialDisplacement);
    let count = size(displacement.map_or(0, |(_, function)| function.length(Input::Tangent)));
    let functions = [
        ("exponential", Role::ExponentialDisplacement),
        ("cayley", Role::CayleyDisplacement),
        ("second_kind", Role::SecondKindDisplacement),
        ("differential", Role::Differential),
        ("vector", Role::HamiltonianVector),
        ("force", Role::Force),
    ];
    let functions = functions.map(|(name, role)| function(program, private, role, name));
    let called = |role, name| call(program, names, role, name, &[]);
    let exponential = called(Role::ExponentialDisplacement, "exponential");
    // what the program does not have is displaced by the exponential
    let other =
        |role, name| if program.function(role).is_some() { called(role, name) } else { exponential.clone() };
    let cayley = other(Role::CayleyDisplacement, "cayley");
    let second_kind = other(Role::SecondKindDisplacement, "second_kind");
    let differential = called(Role::Differential, "differential");
    let vector =
        call(program, names, Role::HamiltonianVector, "vector", &[(Input::Tangent, quote! { covector })]);
    let force = called(Role::Force, "force");
    let isolated = isolated(program, names);
    quote! {
        #[allow(unused_variables, clippy::all, clippy::pedantic)]
        const _: () = {
            #(#functions)*

            #[automatically_derived]
            impl #private::Geometry for #name {
                type Tangent = [#scalar; #count];

                fn displace(&self, state: &#state, map: #private::Map, by: &[#scalar; #count]) -> #state {
                    let moved = match map {
                        #private::Map::Exponential => #exponential,
                        #private::Map::Cayley => #cayley,
                        #private::Map::SecondKind => #second_kind,
                    };
                    #private::State::from_components(&moved)
                }

                fn differential(
                    &self,
                    state: &#state,
                    time: #scalar,
                    control: &<Self as #private::System>::Control,
                ) -> [#scalar; #count] {
                    #differential
                }

                fn hamiltonian_vector(&self, state: &#state, covector: &[#scalar; #count]) -> [#scalar; #count] {
                    #vector
                }

                fn force(
                    &self,
                    state: &#state,
                    time: #scalar,
                    control: &<Self as #private::System>::Control,
                ) -> [#scalar; #count] {
                    #force
                }
            }

            #isolated
        };
    }
}

/// `impl Isolated for FreeRigidBody { … }`, where nothing acts on the system.
fn isolated(program: &Program, names: &Names) -> Option<TokenStream> {
    let Names { private, system: name, .. } = names;
    let (_, with_conserved) = program.function(Role::WithConserved)?;
    let [parameters, all, n] =
        [Input::Parameters, Input::State, Input::Conserved].map(|input| with_conserved.length(input));
    // what turns the momentum does not depend on the parameters
    let zeros = vec![quote! { T::of(0.0) }; parameters];
    let (all, n) = (size(all), size(n));
    let conserved = function(program, private, Role::Conserved, "conserved");
    let with_conserved = function(program, private, Role::WithConserved, "with_conserved");
    Some(quote! {
        #conserved
        #with_conserved

        #[automatically_derived]
        impl #private::Isolated for #name {
            type Conserved<T: #private::Scalar> = [T; #n];

            fn conserved<T: #private::Scalar>(state: &[T; #all]) -> [T; #n] {
                conserved(&[#(#zeros),*], state)
            }

            fn with_conserved<T: #private::Scalar>(state: &[T; #all], given: &[T; #n]) -> [T; #all] {
                with_conserved(&[#(#zeros),*], state, given)
            }
        }
    })
}
