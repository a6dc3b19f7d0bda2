//! The `System` implementation: parameters, checks, energy, invariants.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};
use syn::ext::IdentExt;

use super::code::size;
use super::state::{Conversion, arrays};
use super::{Names, function, quantity};
use crate::model::{InertiaShape, Role as QuantityRole, System};
use crate::program::{Program, Role};

/// `impl System for HeavyTop { … }` and the functions it calls.
pub(super) fn system(system: &System<'_>, program: &Program, names: &Names) -> TokenStream {
    let Names { private, system: name, .. } = names;
    let functions = [
        ("energy", Role::Energy),
        ("velocity", Role::Velocity),
        ("casimirs", Role::Casimirs),
        ("spatial_momentum", Role::SpatialMomentum),
    ];
    let functions = functions.map(|(name, role)| function(program, private, role, name));
    let pivots = (0..system.inertias.len()).map(|place| {
        let role = Role::Pivots(place);
        function(program, private, role, &role.name())
    });
    let (types, parameters) = (types(system, program, names), parameters(system, names));
    let (validate, evaluations) = (validate(system, names), evaluations(program, names));
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
fn types(system: &System<'_>, program: &Program, names: &Names) -> TokenStream {
    let Names { private, system: name, state, control, scalar, .. } = names;
    let text = name.unraw().to_string();
    let parameters = size(system.parameter_symbols().len());
    let state_size = size(system.state_symbols().len());
    let control_size = size(system.control_symbols().len());
    let control = match system.controls.is_empty() {
        true => quote! { #private::NoControl<#scalar> },
        false => quote! { #control },
    };
    let Program { casimirs, dimension, is_autonomous, is_left_invariant, is_forced, .. } = program;
    let standard = match is_left_invariant {
        true => quote! { #private::Family<R, 0, 1> },
        false => quote! { #private::StormerVerlet<R> },
    };
    let (casimir_count, dimension) = (size(casimirs.len()), size(*dimension));
    let quantities = system.parameters.iter().map(|field| {
        let name = field.name.unraw().to_string();
        quantity(names, &name, QuantityRole::Parameter, &field.suffixes(), &field.doc)
    });
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
fn parameters(system: &System<'_>, names: &Names) -> TokenStream {
    let scalar = &names.scalar;
    let fields: Vec<_> =
        system.parameters.iter().map(|field| (field.name.clone(), field.symbols.len())).collect();
    let Conversion { take, elements, give } = arrays(&fields);
    let constants = system.constants.iter().map(|constant| &constant.tokens);
    let unused = vec![quote! { _ }; system.constants.len()];
    let size = size(system.parameter_symbols().len());
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
fn validate(system: &System<'_>, names: &Names) -> TokenStream {
    let private = &names.private;
    let finite = system.parameters.iter().map(|field| {
        let (field, text, size) = (&field.name, field.name.unraw().to_string(), size(field.symbols.len()));
        quote! { #private::require_finite(#text, &__Stored::<_, #size>::to_array(&self.#field))?; }
    });
    let definite = system.inertias.iter().enumerate().map(|(place, inertia)| {
        let (name, text) = (&inertia.name, inertia.name.unraw().to_string());
        let rows = size(inertia.matrix.rows);
        let symmetric = (inertia.shape == InertiaShape::Matrix).then(|| {
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
fn evaluations(program: &Program, names: &Names) -> TokenStream {
    let Names { private, state, scalar, .. } = names;
    let (casimirs, dimension) = (size(program.casimirs.len()), size(program.dimension));
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
