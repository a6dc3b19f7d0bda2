//! The `Geometry` implementation: local coordinates and the Poisson structure of the states.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::code::size;
use super::functions::{call, function};
use super::names::Names;
use crate::program::{Input, Program, SystemRole};
use crate::scheme::Retraction;

/// `impl Geometry for HeavyTop { … }`, and `impl Isolated` where nothing acts on the system.
pub(super) fn geometry(program: &Program, names: &Names) -> TokenStream {
    let Names { private, system: name, state, scalar, .. } = names;
    let count = size(program.interface.state_perturbation());
    let others = [SystemRole::Differential, SystemRole::HamiltonianVector, SystemRole::Force];
    let functions = Retraction::ALL.map(SystemRole::Displacement).into_iter().chain(others);
    let functions = functions.map(|role| function(program, names, role));
    let called = |role| call(program, names, role, &[]);
    // what the program does not have is displaced by the exponential
    let displaced = Retraction::ALL.map(|retraction| {
        let is_there = program.function(SystemRole::Displacement(retraction)).is_some();
        let along = if is_there { retraction } else { Retraction::Exponential };
        called(SystemRole::Displacement(along))
    });
    let maps = Retraction::ALL.map(|retraction| format_ident!("{}", retraction.name()));
    let differential = called(SystemRole::Differential);
    let covector = [(Input::Tangent, quote! { covector })];
    let vector = call(program, names, SystemRole::HamiltonianVector, &covector);
    let force = called(SystemRole::Force);
    let isolated = isolated(program, names);
    quote! {
        #[allow(unused_variables, clippy::all, clippy::pedantic)]
        const _: () = {
            #(#functions)*

            #[automatically_derived]
            impl #private::Geometry for #name {
                type Tangent = [#scalar; #count];

                fn displace(&self, state: &#state, map: #private::RetractionKind, by: &[#scalar; #count]) -> #state {
                    let moved = match map {
                        #(#private::RetractionKind::#maps => #displaced,)*
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
    program.function(SystemRole::Conserved)?;
    let given = [(Input::State, quote! { state }), (Input::Conserved, quote! { given })];
    let [to_conserved, from_conserved] =
        [SystemRole::Conserved, SystemRole::WithConserved].map(|role| call(program, names, role, &given));
    let (all, n) = (size(program.interface.state_length()), size(program.interface.dimension));
    let conserved = function(program, names, SystemRole::Conserved);
    let with_conserved = function(program, names, SystemRole::WithConserved);
    Some(quote! {
        #conserved
        #with_conserved

        #[automatically_derived]
        impl #private::Isolated for #name {
            type Conserved<T: #private::Scalar> = [T; #n];

            fn conserved<T: #private::Scalar>(state: &[T; #all]) -> [T; #n] {
                #to_conserved
            }

            fn with_conserved<T: #private::Scalar>(state: &[T; #all], given: &[T; #n]) -> [T; #all] {
                #from_conserved
            }
        }
    })
}
