//! What perturbations of a system's state, controls and parameters are: their types, and where their parts stand in
//! them.

use std::collections::BTreeSet;

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::code::size;
use super::docs;
use super::names::Names;
use crate::program::Interface;
use crate::scheme::Derivatives;

/// `impl Differentiable for HeavyTop { … }`, and the index ranges of all parts within perturbations.
pub(super) fn tangents(interface: &Interface, names: &Names, wanted: Derivatives) -> TokenStream {
    let Names { private, coadjoint, system: name, scalar, visibility, .. } = names;
    let places = index_ranges(interface, names);
    let [state, control, parameters] =
        [interface.state_perturbation(), interface.control_length(), interface.field_length()].map(size);
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
        format!("A configuration changes by an element of the algebra, `{}`.", interface.side.displaced("δ")),
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

/// A constant for each quantity: where it stands within the perturbations.
fn index_ranges(interface: &Interface, names: &Names) -> Vec<TokenStream> {
    let coadjoint = &names.coadjoint;
    let mut taken = BTreeSet::new();
    let mut ranges = Vec::new();
    let all = [
        ("perturbations of the state", &interface.state),
        ("perturbations of the controls", &interface.controls),
        ("perturbations of the parameters", &interface.parameters),
    ];
    for (of, quantities) in all {
        for quantity in quantities {
            let mut constant = quantity.name.to_uppercase();
            // fields may differ by their cases alone
            while !taken.insert(constant.clone()) {
                constant.push('_');
            }
            let constant = Ident::new(&constant, names.of(quantity).span());
            let doc = docs::line(&format!("`{}` in {of}.", quantity.name));
            let (first, length) = (size(quantity.tangent.start), size(quantity.tangent.len()));
            let ty = quote! { #coadjoint::derivative::IndexRange };
            ranges.push(quote! { #doc pub const #constant: #ty<#first, #length> = #ty; });
        }
    }
    ranges
}
