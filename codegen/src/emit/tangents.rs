//! What perturbations of a system's state, controls and parameters are: their types, and where their parts stand in them.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};
use syn::ext::IdentExt;

use super::code::size;
use super::{Names, docs};
use crate::derivatives::Derivatives;
use crate::model::{Role, System};

/// `impl Differentiable for HeavyTop { … }`, and the index ranges of all parts within perturbations.
pub(super) fn tangents(system: &System<'_>, names: &Names, wanted: Derivatives) -> TokenStream {
    let Names { private, coadjoint, system: name, scalar, visibility, .. } = names;
    let mut places = Vec::new();
    let mut taken = std::collections::BTreeSet::new();
    let mut place = |of: &str, field: &Ident, from: usize, length: usize| {
        let text = field.unraw().to_string();
        let mut constant = text.to_uppercase();
        // fields may differ by their cases alone
        while !taken.insert(constant.clone()) {
            constant.push('_');
        }
        let constant = Ident::new(&constant, field.span());
        let doc = docs::line(&format!("`{text}` in {of}."));
        let (from, length) = (size(from), size(length));
        places.push(quote! { #doc pub const #constant: #coadjoint::derivative::IndexRange<#from, #length> = #coadjoint::derivative::IndexRange; });
    };
    let mut state = 0;
    for part in system.parts() {
        let length = match part.role {
            Role::Configuration => system
                .factors
                .iter()
                .find(|factor| factor.name == part.name)
                .map_or(0, |factor| factor.algebra.group.dimension()),
            _ => part.symbols.len(),
        };
        place("perturbations of the state", &part.name, state, length);
        state += length;
    }
    let mut control = 0;
    for part in &system.controls {
        place("perturbations of the controls", &part.name, control, part.symbols.len());
        control += part.symbols.len();
    }
    let mut parameters = 0;
    for field in &system.parameters {
        place("perturbations of the parameters", &field.name, parameters, field.symbols.len());
        parameters += field.symbols.len();
    }
    let [state, control, parameters] = [state, control, parameters].map(size);
    let wanted = [
        ("WrtState", wanted.state),
        ("WrtControl", wanted.controls),
        ("WrtParameters", wanted.parameters),
        ("Tangent", wanted.tangent),
        ("Adjoint", wanted.adjoint),
    ];
    let wanted = wanted.into_iter().filter(|&(_, wanted)| wanted).map(|(map, _)| format_ident!("{map}"));
    let indices = format_ident!("{name}Indices");
    let docs = docs::lines([
        format!(
            "The index ranges of the parts of a [`{name}`] within perturbations of its state, controls and parameters."
        ),
        String::new(),
        "A configuration changes by an element of the algebra, `g exp(δ)`.".to_owned(),
    ]);
    quote! {
        #docs
        #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]
        #visibility struct #indices;

        #[allow(dead_code)]
        impl #indices { #(#places)* }

        #[automatically_derived]
        impl #private::Differentiable for #name {
            type StatePerturbation<V: #private::Entry> = [V; #state];
            type ControlPerturbation<V: #private::Entry> = [V; #control];
            type ParameterPerturbation<V: #private::Entry> = [V; #parameters];
            type StateVector = #private::nalgebra::SVector<#scalar, #state>;
            type ControlVector = #private::nalgebra::SVector<#scalar, #control>;
            type ParameterVector = #private::nalgebra::SVector<#scalar, #parameters>;
            type WrtState = #private::nalgebra::SMatrix<#scalar, #state, #state>;
            type WrtControl = #private::nalgebra::SMatrix<#scalar, #state, #control>;
            type WrtParameters = #private::nalgebra::SMatrix<#scalar, #state, #parameters>;
        }

        #(#[automatically_derived]
        impl #private::Derives<#coadjoint::derivative::#wanted> for #name {})*
    }
}
