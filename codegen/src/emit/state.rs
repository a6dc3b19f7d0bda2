//! The state struct.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};
use syn::ext::IdentExt;

use super::{Names, docs, quantity};
use crate::model::{Part, System};

/// The state of a system:
///
/// ```text
/// pub struct HeavyTopState { pub attitude: UnitQuaternion<f64>, pub momentum: Vector3<f64>, pub gamma: Vector3<f64> }
/// impl State for HeavyTopState { … }
/// ```
pub(super) fn state(system: &System<'_>, names: &Names) -> TokenStream {
    let Names { private, state, visibility, scalar, .. } = names;
    let parts = system.parts();
    let fields = parts.iter().map(|part| {
        let (name, ty, doc) = (&part.name, part_type(part, names), docs::line(&part.doc));
        quote! { #doc pub #name: #ty }
    });
    let doc = docs::lines([
        format!("The state of a [`{}`]: configuration, momentum and advected parameters.", names.system),
        String::new(),
        format!("Conventions of {}: {}.", system.algebra.group.name(), system.algebra.group.conventions()),
    ]);
    let serde_path = names.serde_path();
    let configuration = &parts[0].name;
    let configuration_size = super::kernel::size(parts[0].symbols.len());
    let size = super::kernel::size(system.state_symbols().len());
    let conversion =
        arrays(&parts.iter().map(|part| (part.name.clone(), part.symbols.len())).collect::<Vec<_>>());
    let Conversion { take, elements, give } = conversion;
    let quantities = parts.iter().map(|part| {
        let suffixes: Vec<&str> = part.suffixes.clone();
        quantity(names, &part.name.unraw().to_string(), &suffixes, &part.doc)
    });
    quote! {
        #doc
        #[derive(
            ::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug, ::core::cmp::PartialEq,
            #private::serde::Serialize, #private::serde::Deserialize,
        )]
        #[serde(crate = #serde_path)]
        #visibility struct #state {
            #(#fields,)*
        }

        const _: () = {
        use #private::Stored as __Stored;

        #[automatically_derived]
        impl #private::State for #state {
            type Scalar = #scalar;
            type Components = [#scalar; #size];
            const QUANTITIES: &'static [#private::Quantity] = &[#(#quantities),*];

            #[inline(always)]
            fn to_components(&self) -> [#scalar; #size] {
                #(#take)*
                [#(#elements),*]
            }

            #[inline(always)]
            fn from_components(components: &[#scalar; #size]) -> Self {
                let [#(#elements),*] = *components;
                Self { #(#give),* }
            }

            fn deviation(&self) -> #scalar {
                __Stored::<_, #configuration_size>::deviation(&self.#configuration, 0.0)
            }
        }
        };
    }
}

/// The Rust type of a part of the state.
fn part_type(part: &Part<'_>, names: &Names) -> TokenStream {
    let Names { private, scalar, .. } = names;
    let ty = format_ident!("{}", part.type_name);
    quote! { #private::nalgebra::#ty<#scalar> }
}

/// How fields become one flat array and back.
pub(super) struct Conversion {
    /// `let [gamma_0, …] = Stored::to_array(&self.gamma);` for each field
    pub take: Vec<TokenStream>,
    /// The flat array's elements.
    pub elements: Vec<Ident>,
    /// `gamma: Stored::from_array([gamma_0, …])` for each field
    pub give: Vec<TokenStream>,
}

/// The conversion for fields of these names and numbers of scalars. Paths are given by the caller's `use` of `Stored`.
pub(super) fn arrays(fields: &[(Ident, usize)]) -> Conversion {
    let mut conversion = Conversion { take: Vec::new(), elements: Vec::new(), give: Vec::new() };
    let mut count = 0..;
    for (name, size) in fields {
        let elements: Vec<Ident> = count
            .by_ref()
            .take(*size)
            .map(|n| Ident::new(&format!("x{n}"), proc_macro2::Span::mixed_site()))
            .collect();
        conversion.take.push(quote! { let [#(#elements),*] = __Stored::to_array(&self.#name); });
        conversion.give.push(quote! { #name: __Stored::from_array([#(#elements),*]) });
        conversion.elements.extend(elements);
    }
    conversion
}
