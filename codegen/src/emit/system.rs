//! The `System` implementation: parameters, checks, energy, invariants.

use proc_macro2::TokenStream;
use quote::quote;
use syn::ext::IdentExt;

use super::kernel::{Layout, function, size as array_size};
use super::state::{Conversion, arrays};
use super::{Names, docs, quantity};
use crate::expr::{Arena, Vector};
use crate::kernel;
use crate::model::{InertiaShape, System};

/// `impl System for HeavyTop { … }` and the functions it calls.
pub(super) fn system<'a>(arena: &'a Arena, system: &System<'a>, names: &Names) -> TokenStream {
    let Names { private, system: name, state, scalar, .. } = names;
    let group = system.algebra.group;
    let text = name.unraw().to_string();

    let fields: Vec<_> =
        system.parameters.iter().map(|field| (field.name.clone(), field.symbols.len())).collect();
    let Conversion { take, elements, give } = arrays(&fields);
    let constants = system.constants.iter().map(|constant| &constant.tokens);
    let unused = vec![quote! { _ }; system.constants.len()];
    let size = array_size(system.parameter_symbols().len());
    let state_size = array_size(system.state_symbols().len());
    let quantities = system
        .parameters
        .iter()
        .map(|field| quantity(names, &field.name.unraw().to_string(), &field.suffixes(), &field.doc));

    let casimirs = system.casimirs();
    let casimir_names = casimirs.iter().map(|(name, _)| name);
    let casimir_count = array_size(casimirs.len());
    let casimir_values = Vector(casimirs.iter().map(|&(_, value)| value).collect());

    let spatial = group.to_space(&system.configuration, &system.momentum);
    let momentum_type = quote::format_ident!("Vector{}", group.dimension());
    let emitted = |name: &str, outputs: &Vector<'a>, takes_state: bool| {
        let (section, symbols) = kernel::function(arena, outputs);
        let layout = Layout {
            parameters: system.parameter_symbols().iter().map(|&s| symbols.get(s)).collect(),
            state: system.state_symbols().iter().map(|&s| symbols.get(s)).collect(),
        };
        let doc = docs::line(&format!("{}.", section.operations()));
        let function = function(name, private, &section, &layout, takes_state);
        quote! { #doc #function }
    };
    let energy = emitted("energy", &Vector(vec![system.energy()]), true);
    let casimirs = emitted("casimirs", &casimir_values, true);
    let spatial_momentum = emitted("spatial_momentum", &spatial, true);
    let (_, pivots) = system.inertia.ldl();
    let pivots = emitted("pivots", &pivots, false);

    let finite = system.parameters.iter().map(|field| {
        let (field, text, size) =
            (&field.name, field.name.unraw().to_string(), array_size(field.symbols.len()));
        quote! { #private::require_finite(#text, &__Stored::<_, #size>::to_array(&self.#field))?; }
    });
    let inertia = &system.inertia_field;
    let (inertia_name, inertia_text) = (&inertia.name, inertia.name.unraw().to_string());
    let dimension = array_size(group.dimension());
    let symmetric = (inertia.shape == InertiaShape::Matrix).then(|| {
        quote! {
            #private::require_symmetric(
                #inertia_text,
                &__Stored::<_, { #dimension * #dimension }>::to_array(&self.#inertia_name),
                #dimension,
            )?;
        }
    });

    quote! {
        #[allow(unused_variables, clippy::all, clippy::pedantic)]
        const _: () = {
            use #private::Stored as __Stored;

            #energy
            #casimirs
            #spatial_momentum
            #pivots

            #[automatically_derived]
            impl #private::System for #name {
                type Scalar = #scalar;
                type State = #state;
                type StateComponents<T: #private::Scalar> = [T; #state_size];
                type Parameters<T: #private::Scalar> = [T; #size];
                type Casimirs = [#scalar; #casimir_count];
                type Momentum = #private::nalgebra::#momentum_type<#scalar>;

                const NAME: &'static ::core::primitive::str = #text;
                const PARAMETERS: &'static [#private::Quantity] = &[#(#quantities),*];
                const CASIMIRS: &'static [&'static ::core::primitive::str] = &[#(#casimir_names),*];

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
                    #symmetric
                    #private::require_positive_definite(#inertia_text, &pivots(&self.to_parameters()))
                }

                fn energy(&self, state: &#state) -> #scalar {
                    let [energy] = energy(&self.to_parameters(), &#private::State::to_components(state));
                    energy
                }

                fn casimirs(&self, state: &#state) -> [#scalar; #casimir_count] {
                    casimirs(&self.to_parameters(), &#private::State::to_components(state))
                }

                fn spatial_momentum(&self, state: &#state) -> #private::nalgebra::#momentum_type<#scalar> {
                    __Stored::from_array(spatial_momentum(
                        &self.to_parameters(),
                        &#private::State::to_components(state),
                    ))
                }
            }
        };
    }
}

/// The potential as the user wrote it, as a method: rustc checks its types, and tools find their way in it.
pub(super) fn potential(system: &System<'_>, names: &Names) -> TokenStream {
    let Some(potential) = &system.potential_source else { return quote! {} };
    // as a statement, so that syn puts parentheses around a block in front of an operator
    let potential = syn::Stmt::Expr(potential.clone(), None);
    let Names { private, system: name, scalar, visibility, .. } = names;
    let arguments = system.advected_parts();
    let parameters = arguments.iter().map(|part| {
        let (argument, ty) = (&part.name, quote::format_ident!("{}", part.type_name));
        quote! { #argument: &#private::nalgebra::#ty<#scalar> }
    });
    let fields = system.parameters.iter().map(|field| &field.name);
    let copies = arguments.iter().map(|part| {
        let argument = &part.name;
        quote! { let #argument = *#argument; }
    });
    let doc = docs::line("The potential energy, as described.");
    quote! {
        impl #name {
            #doc
            #[allow(unused_variables, unused_parens, unused_braces, clippy::all)]
            #visibility fn potential(&self, #(#parameters),*) -> #scalar {
                // the elementary functions of floats, where there is no std
                #[allow(unused_imports)]
                use #private::nalgebra::{ComplexField as _, RealField as _};
                let Self { #(#fields,)* } = *self;
                #(#copies)*
                #potential
            }
        }
    }
}
