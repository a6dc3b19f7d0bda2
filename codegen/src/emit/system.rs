//! The `System` implementation: parameters, checks, energy, invariants.

use proc_macro2::TokenStream;
use quote::quote;
use syn::ext::IdentExt;

use super::kernel::{Layout, function, size as array_size};
use super::state::{Conversion, arrays};
use super::{Names, docs, quantity};
use crate::expr::{Arena, Vector};
use crate::kernel;
use crate::model::{InertiaShape, Role, Side, System};

/// `impl System for HeavyTop { … }` and the functions it calls.
pub(super) fn system<'a>(arena: &'a Arena, system: &System<'a>, names: &Names) -> TokenStream {
    let Names { private, system: name, state, scalar, .. } = names;
    let text = name.unraw().to_string();

    let fields: Vec<_> =
        system.parameters.iter().map(|field| (field.name.clone(), field.symbols.len())).collect();
    let Conversion { take, elements, give } = arrays(&fields);
    let constants = system.constants.iter().map(|constant| &constant.tokens);
    let unused = vec![quote! { _ }; system.constants.len()];
    let size = array_size(system.parameter_symbols().len());
    let state_size = array_size(system.state_symbols().len());
    let control_size = array_size(system.control_symbols().len());
    let control = match system.controls.is_empty() {
        true => quote! { #private::NoControl<#scalar> },
        false => {
            let control = &names.control;
            quote! { #control }
        }
    };
    let standard = match system.is_left_invariant() {
        true => quote! { #private::Family<R, 0, 1> },
        false => quote! { #private::StormerVerlet<R> },
    };
    let autonomous = system.is_autonomous();
    let invariant = system.is_left_invariant();
    let forced = system.factors.iter().any(|factor| factor.force.is_some());
    let quantities = system.parameters.iter().map(|field| {
        quantity(names, &field.name.unraw().to_string(), Role::Parameter, &field.suffixes(), &field.doc)
    });

    let casimirs = system.casimirs();
    let casimir_names = casimirs.iter().map(|(name, _)| name);
    let casimir_count = array_size(casimirs.len());
    let casimir_values = Vector(casimirs.iter().map(|&(_, value)| value).collect());

    let spatial = system.factors.iter().flat_map(|factor| match system.side {
        Side::Left => factor.algebra.group.to_space(&factor.configuration, &factor.momentum).0,
        Side::Right => factor.momentum.0.clone(),
    });
    let spatial = Vector(spatial.collect());
    let dimension = array_size(system.dimension());
    let momentum_type = quote! { #private::nalgebra::SVector<#scalar, #dimension> };
    let emitted = |name: &str, outputs: &Vector<'a>, takes_state: bool| {
        let (section, symbols) = kernel::function(arena, outputs);
        let doc = docs::line(&format!("{}.", section.operations()));
        let Layout { parameters, state, time, .. } = Layout::new(system, &symbols);
        let mut arrays = vec![("parameters", parameters)];
        if takes_state {
            arrays.push(("state", state));
        }
        let function = function(name, private, &section, &arrays, takes_state.then_some(time.as_str()));
        quote! { #doc #function }
    };
    let energy = emitted("energy", &Vector(vec![system.energy()]), true);
    let velocity = emitted("velocity", &system.velocity(&system.momentum()), true);
    let casimirs = emitted("casimirs", &casimir_values, true);
    let spatial_momentum = emitted("spatial_momentum", &spatial, true);

    let finite = system.parameters.iter().map(|field| {
        let (field, text, size) =
            (&field.name, field.name.unraw().to_string(), array_size(field.symbols.len()));
        quote! { #private::require_finite(#text, &__Stored::<_, #size>::to_array(&self.#field))?; }
    });
    let mut pivots = TokenStream::new();
    let mut definite = TokenStream::new();
    for (index, inertia) in system.inertias.iter().enumerate() {
        let (name, text) = (&inertia.name, inertia.name.unraw().to_string());
        let rows = array_size(inertia.matrix.rows);
        if inertia.shape == InertiaShape::Matrix {
            definite.extend(quote! {
                #private::require_symmetric(
                    #text,
                    &__Stored::<_, { #rows * #rows }>::to_array(&self.#name),
                    #rows,
                )?;
            });
        }
        let function =
            if system.inertias.len() == 1 { "pivots".to_owned() } else { format!("pivots_{index}") };
        pivots.extend(emitted(&function, &inertia.matrix.ldl().1, false));
        let function = quote::format_ident!("{function}");
        definite.extend(
            quote! { #private::require_positive_definite(#text, &#function(&self.to_parameters()))?; },
        );
    }

    quote! {
        #[allow(unused_variables, clippy::all, clippy::pedantic)]
        const _: () = {
            use #private::Stored as __Stored;

            #energy
            #velocity
            #casimirs
            #spatial_momentum
            #pivots

            #[automatically_derived]
            impl #private::System for #name {
                type Scalar = #scalar;
                type State = #state;
                type StateComponents<T: #private::Scalar> = [T; #state_size];
                type Parameters<T: #private::Scalar> = [T; #size];
                type Control = #control;
                type ControlComponents<T: #private::Scalar> = [T; #control_size];
                type Casimirs = [#scalar; #casimir_count];
                type Momentum = #momentum_type;
                type Standard<R> = #standard;

                const NAME: &'static ::core::primitive::str = #text;
                const PARAMETERS: &'static [#private::Quantity] = &[#(#quantities),*];
                const CASIMIRS: &'static [&'static ::core::primitive::str] = &[#(#casimir_names),*];
                const AUTONOMOUS: ::core::primitive::bool = #autonomous;
                const INVARIANT: ::core::primitive::bool = #invariant;
                const FORCED: ::core::primitive::bool = #forced;

                fn to_parameters(&self) -> [#scalar; #size] {
                    #(#take)*
                    [#(#elements,)* #(#constants,)*]
                }

                fn from_parameters(parameters: &[#scalar; #size]) -> Self {
                    let [#(#elements,)* #(#unused,)*] = *parameters;
                    Self { #(#give),* }
                }

                fn validate(&self) -> ::core::result::Result<(), #private::ParameterError> {
                    #(#finite)*
                    #definite
                    ::core::result::Result::Ok(())
                }

                fn energy_at(&self, state: &#state, time: #scalar) -> #scalar {
                    let [energy] = energy(&self.to_parameters(), &#private::State::to_components(state), time);
                    energy
                }

                fn velocity_at(&self, state: &#state, time: #scalar) -> #momentum_type {
                    __Stored::from_array(velocity(
                        &self.to_parameters(),
                        &#private::State::to_components(state),
                        time,
                    ))
                }

                fn casimirs(&self, state: &#state) -> [#scalar; #casimir_count] {
                    casimirs(&self.to_parameters(), &#private::State::to_components(state), 0.0)
                }

                fn spatial_momentum(&self, state: &#state) -> #momentum_type {
                    __Stored::from_array(spatial_momentum(
                        &self.to_parameters(),
                        &#private::State::to_components(state),
                        0.0,
                    ))
                }
            }
        };
    }
}
