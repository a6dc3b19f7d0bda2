//! What an expansion calls things: the names and paths that all parts of it share.

use std::collections::BTreeMap;

use proc_macro2::{Ident, TokenStream};
use quote::{ToTokens, format_ident, quote};

use super::code::size;
use crate::identifiers::plain;
use crate::model::System;
use crate::parse::Item;
use crate::program::{Interface, Quantity};
use crate::quantity::{Kind, ScalarType};

/// The names and paths that all parts of an expansion share.
pub struct Names {
    /// The user's struct.
    pub system: Ident,
    /// Its state.
    pub state: Ident,
    /// Its controls, if it has any.
    pub control: Ident,
    /// Who may see the struct.
    pub visibility: syn::Visibility,
    /// `f64` or `f32`
    pub scalar: TokenStream,
    /// The path of the runtime crate.
    pub coadjoint: TokenStream,
    /// The path of what generated code needs of it.
    pub private: TokenStream,
    /// Constants of the user's own code that stand behind the parameters.
    pub constants: Vec<TokenStream>,
    /// The user's names for parameters, parts of the state and controls, at the user's tokens.
    pub identifiers: BTreeMap<String, Ident>,
}

impl Names {
    /// The names for a system; `coadjoint` is the path of the runtime crate if it is not `::coadjoint`.
    pub fn new(
        interface: &Interface,
        item: &Item,
        coadjoint: Option<&syn::Path>,
        source: &System<'_>,
    ) -> Self {
        let coadjoint = coadjoint.map_or_else(|| quote! { ::coadjoint }, |path| quote! { #path });
        let scalar = match interface.scalar {
            ScalarType::F64 => quote! { f64 },
            ScalarType::F32 => quote! { f32 },
        };
        let system = item.name.clone();
        let parameters = source.parameters.iter().map(|field| field.name.ident.clone());
        let parts = source.parts().into_iter().map(|part| part.name.ident);
        let controls = source.controls.iter().map(|part| part.name.ident.clone());
        let identifiers = parameters.chain(parts).chain(controls).map(|ident| (plain(&ident), ident));
        Self {
            state: format_ident!("{system}State"),
            control: format_ident!("{system}Control"),
            system,
            visibility: item.visibility.clone(),
            scalar: quote! { ::core::primitive::#scalar },
            private: quote! { #coadjoint::__private },
            coadjoint,
            constants: source.constants.iter().map(|constant| constant.tokens.to_token_stream()).collect(),
            identifiers: identifiers.collect(),
        }
    }

    /// The user's name for a parameter, a part of the state or a control; of an element of an array the array.
    pub(super) fn of(&self, quantity: &Quantity) -> Ident {
        let known = self.identifiers.get(quantity.field()).cloned();
        known.unwrap_or_else(|| format_ident!("{}", quantity.field()))
    }

    /// Where it stands in its struct: `attitude`, `spins[0]`.
    pub(super) fn place(&self, quantity: &Quantity) -> TokenStream {
        let field = self.of(quantity);
        match &quantity.element {
            None => quote! { #field },
            Some(element) => {
                let index = size(element.index);
                quote! { #field[#index] }
            }
        }
    }
}

/// The fields of a struct of quantities: each with the one that it is, or with the elements of the array that it is.
pub(super) fn fields(quantities: &[Quantity]) -> Vec<Vec<&Quantity>> {
    let mut fields: Vec<Vec<&Quantity>> = Vec::new();
    for quantity in quantities {
        match fields.iter_mut().find(|field| field[0].field() == quantity.field()) {
            Some(field) => field.push(quantity),
            None => fields.push(vec![quantity]),
        }
    }
    fields
}

/// Several values in the place of a field: an array, or the one that there is.
pub(super) fn whole(field: &[&Quantity], values: &[TokenStream]) -> TokenStream {
    match (&field[0].element, values) {
        (None, [value]) => value.clone(),
        _ => quote! { [#(#values),*] },
    }
}

/// `quantity("gamma", Role::Advected, Kind::Vector(3), &["x", "y", "z"], 6, 9, "", "…")`
pub(super) fn quantity(names: &Names, quantity: &Quantity) -> TokenStream {
    let private = &names.private;
    let Quantity { name, role, components, kind, tangent, unit, doc, .. } = quantity;
    // the runtime's have the same names
    let role = format_ident!("{}", format!("{role:?}"));
    let kind = match *kind {
        Kind::Scalar => quote! { Scalar },
        Kind::Vector(n) => sized("Vector", &[n]),
        Kind::Symmetric(n) => sized("SymmetricMatrix", &[n]),
        Kind::Matrix(rows, columns) => sized("Matrix", &[rows, columns]),
        Kind::UnitComplex => quote! { UnitComplex },
        Kind::UnitQuaternion => quote! { UnitQuaternion },
        Kind::RigidMotion2 => quote! { RigidMotion2 },
        Kind::RigidMotion3 => quote! { RigidMotion3 },
    };
    let tangent = [tangent.start, tangent.end].map(size);
    let [start, end] = &tangent;
    let unit = unit.as_deref().unwrap_or("");
    quote! {
        #private::quantity(
            #name, #private::Role::#role, #private::Kind::#kind, &[#(#components),*], #start, #end, #unit, #doc
        )
    }
}

/// `Vector(3)`
fn sized(kind: &str, sizes: &[usize]) -> TokenStream {
    let (kind, sizes) = (format_ident!("{kind}"), sizes.iter().map(|n| size(*n)));
    quote! { #kind(#(#sizes),*) }
}
