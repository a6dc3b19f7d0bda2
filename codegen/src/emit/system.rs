//! The `System` implementation: parameters, checks, energy, invariants.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};
use syn::ext::IdentExt;

use super::code::size;
use super::state::{Conversion, arrays};
use super::{Names, function, quantity};
use crate::program::{Interface, Program, Role};

/// `impl System for HeavyTop { … }` and the functions it calls.
pub(super) fn system(program: &Program, names: &Names) -> TokenStream {
    let Names { private, system: name, .. } = names;
    let functions = [
        ("energy", Role::Energy),
        ("velocity", Role::Velocity),
        ("casimirs", Role::Casimirs),
        ("spatial_momentum", Role::SpatialMomentum),
    ];
    let functions = functions.map(|(name, role)| function(program, private, role, name));
    let interface = &program.interface;
    let pivots = (0..interface.inertias.len()).map(|place| {
        let role = Role::Pivots(place);
        function(program, private, role, &role.name())
    });
    let (types, parameters) = (types(interface, names), parameters(interface, names));
    let (validate, evaluations) = (validate(interface, names), evaluations(interface, names));
    quote! {
        #[allow(unused_variables, clippy::all, clippy::pedantic)]
        const _: () = {
            use #private::Stored as __Stored;

            #(#functions)*
            #(#pivots)*

            #[automatically_derived]
            impl #private::System for #name {
                #types
                #parameters
                #validate
                #evaluations
            }
        };
    }
}

/// The associated types and constants.
fn types(interface: &Interface, names: &Names) -> TokenStream {
    let Names { private, system: name, state, control, scalar, .. } = names;
    let text = name.unraw().to_string();
    let Interface { casimirs, is_autonomous, is_left_invariant, is_forced, .. } = interface;
    let [parameters, state_size, control_size, casimir_count, dimension] = [
        interface.parameter_length(),
        interface.state_length(),
        interface.control_length(),
        casimirs.len(),
        interface.dimension,
    ]
    .map(size);
    let control = match interface.controls.is_empty() {
        true => quote! { #private::NoControl<#scalar> },
        false => quote! { #control },
    };
    let standard = match is_left_invariant {
        true => quote! { #private::Family<R, 0, 1> },
        false => quote! { #private::StormerVerlet<R> },
    };
    let quantities = interface.parameters.iter().map(|field| quantity(names, field));
    quote! {
        type Scalar = #scalar;
        type State = #state;
        type StateComponents<T: #private::Scalar> = [T; #state_size];
        type Parameters<T: #private::Scalar> = [T; #parameters];
        type Control = #control;
        type ControlComponents<T: #private::Scalar> = [T; #control_size];
        type Casimirs = [#scalar; #casimir_count];
        type Momentum = #private::nalgebra::SVector<#scalar, #dimension>;
        type Standard<R> = #standard;

        const NAME: &'static ::core::primitive::str = #text;
        const PARAMETERS: &'static [#private::Quantity] = &[#(#quantities),*];
        const CASIMIRS: &'static [&'static ::core::primitive::str] = &[#(#casimirs),*];
        const AUTONOMOUS: ::core::primitive::bool = #is_autonomous;
        const INVARIANT: ::core::primitive::bool = #is_left_invariant;
        const FORCED: ::core::primitive::bool = #is_forced;
    }
}

/// The parameters as a flat array and back.
fn parameters(interface: &Interface, names: &Names) -> TokenStream {
    let Names { scalar, constants, .. } = names;
    let Conversion { take, elements, give } = arrays(&interface.parameters, names);
    let unused = vec![quote! { _ }; interface.constants];
    let size = size(interface.parameter_length());
    quote! {
        fn to_parameters(&self) -> [#scalar; #size] {
            #(#take)*
            [#(#elements,)* #(#constants,)*]
        }

        fn from_parameters(parameters: &[#scalar; #size]) -> Self {
            let [#(#elements,)* #(#unused,)*] = *parameters;
            Self { #(#give),* }
        }
    }
}

/// Finite parameters, symmetric and positive definite inertias.
fn validate(interface: &Interface, names: &Names) -> TokenStream {
    let private = &names.private;
    let finite = interface.parameters.iter().map(|field| {
        let (ident, text, size) = (names.of(field), &field.name, size(field.components.len()));
        quote! { #private::require_finite(#text, &__Stored::<_, #size>::to_array(&self.#ident))?; }
    });
    let definite = interface.inertias.iter().enumerate().map(|(place, inertia)| {
        let text = &inertia.name;
        let name = names.identifiers.get(text);
        let rows = size(inertia.rows);
        let symmetric = inertia.is_matrix.then(|| {
            quote! {
                #private::require_symmetric(
                    #text,
                    &__Stored::<_, { #rows * #rows }>::to_array(&self.#name),
                    #rows,
                )?;
            }
        });
        let pivots = format_ident!("{}", Role::Pivots(place).name());
        quote! {
            #symmetric
            #private::require_positive_definite(#text, &#pivots(&self.to_parameters()))?;
        }
    });
    quote! {
        fn validate(&self) -> ::core::result::Result<(), #private::ParameterError> {
            #(#finite)*
            #(#definite)*
            ::core::result::Result::Ok(())
        }
    }
}

/// What is computed of a state.
fn evaluations(interface: &Interface, names: &Names) -> TokenStream {
    let Names { private, state, scalar, .. } = names;
    let (casimirs, dimension) = (size(interface.casimirs.len()), size(interface.dimension));
    let momentum = quote! { #private::nalgebra::SVector<#scalar, #dimension> };
    let at = |time: TokenStream| {
        quote! { &self.to_parameters(), &#private::State::to_components(state), #time }
    };
    let (at_time, at_any_time) = (at(quote! { time }), at(quote! { 0.0 }));
    quote! {
        fn energy_at(&self, state: &#state, time: #scalar) -> #scalar {
            let [energy] = energy(#at_time);
            energy
        }

        fn velocity_at(&self, state: &#state, time: #scalar) -> #momentum {
            __Stored::from_array(velocity(#at_time))
        }

        fn casimirs(&self, state: &#state) -> [#scalar; #casimirs] {
            casimirs(#at_any_time)
        }

        fn spatial_momentum(&self, state: &#state) -> #momentum {
            __Stored::from_array(spatial_momentum(#at_any_time))
        }
    }
}
