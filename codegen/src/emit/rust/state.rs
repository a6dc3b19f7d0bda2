//! The structs of state and controls.

use std::collections::BTreeMap;

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};
use syn::ext::IdentExt;

use super::code::{inlined, size};
use super::docs;
use super::functions::function;
use super::names::{Names, fields, quantity, whole};
use crate::program::{Program, Quantity, SystemRole};
use crate::quantity::{Kind, Role};

/// The state of a system, and its controls if it has any:
///
/// ```text
/// pub struct HeavyTopState { pub attitude: UnitQuaternion<f64>, pub momentum: Vector3<f64>, pub gamma: Vector3<f64> }
/// impl State for HeavyTopState { … }
/// ```
pub(super) fn state(program: &Program, names: &Names) -> TokenStream {
    let Names { state, scalar, private, .. } = names;
    let interface = &program.interface;
    let mut lines = vec![
        format!("The state of a [`{}`]: configuration, momentum and advected parameters.", names.system),
        String::new(),
    ];
    lines.extend(interface.documentation.conventions.iter().cloned());
    lines
        .extend(["", "By default configurations are the identity, and all else is zero."].map(str::to_owned));
    let identity = interface.state.iter().flat_map(identity);
    let default = quote! {
        impl ::core::default::Default for #state {
            fn default() -> Self {
                #private::State::from_components(&[#(#identity),*])
            }
        }
    };
    let configurations = interface.state.iter().filter(|part| part.role == Role::Configuration);
    let deviations = configurations.map(|part| {
        let (place, size) = (names.place(part), size(part.components.len()));
        quote! { __Stored::<_, #size>::deviation(&self.#place, 0.0) }
    });
    let of_matrices = program.function(SystemRole::Deviation).map(|_| {
        let function = function(program, names, SystemRole::Deviation);
        quote! {
            #[allow(clippy::all, clippy::pedantic)]
            #function
            let [largest] = off(&#private::State::to_components(self));
        }
    });
    let deviation = quote! {
        #[inline]
        fn deviation(&self) -> #scalar {
            let largest = 0.0;
            #of_matrices
            #(let largest = #private::larger(largest, #deviations);)*
            largest
        }
    };
    let state =
        record(state, &lines, &interface.state, format_ident!("State"), &quote! {}, &deviation, names);
    if interface.controls.is_empty() {
        return quote! { #state #default };
    }
    let lines =
        [format!("The controls of a [`{}`], held constant over a step; all zero by default.", names.system)];
    let derived = quote! { ::core::default::Default, };
    let control = record(
        &names.control,
        &lines,
        &interface.controls,
        format_ident!("Control"),
        &derived,
        &quote! {},
        names,
    );
    quote! { #state #default #control }
}

/// The numbers of the identity, if it is a configuration's part; else zeros.
fn identity(part: &Quantity) -> Vec<TokenStream> {
    let is_one = |k: usize| match part.kind {
        _ if part.role != Role::Configuration => false,
        Kind::UnitComplex | Kind::UnitQuaternion | Kind::RigidMotion2 | Kind::RigidMotion3 => k == 0,
        Kind::Matrix(_, columns) => k.is_multiple_of(columns + 1),
        Kind::Scalar | Kind::Vector(_) | Kind::Symmetric(_) => false,
    };
    let number = |k| {
        if is_one(k) {
            quote! { 1.0 }
        } else {
            quote! { 0.0 }
        }
    };
    (0..part.components.len()).map(number).collect()
}

/// A struct of parts with its implementation of a trait of the runtime's that shows it as a flat array.
fn record(
    name: &Ident,
    doc: &[String],
    parts: &[Quantity],
    of: Ident,
    derived: &TokenStream,
    rest: &TokenStream,
    names: &Names,
) -> TokenStream {
    let Names { private, visibility, scalar, .. } = names;
    let field = |field: Vec<&Quantity>| {
        let (name, ty, doc) = (names.of(field[0]), field_type(&field, names), docs::line(&field[0].doc));
        (quote! { #name: #ty }, doc)
    };
    let (fields, docs): (Vec<_>, Vec<_>) = fields(parts).into_iter().map(field).unzip();
    let doc = docs::lines(doc);
    let size = size(parts.iter().map(|part| part.components.len()).sum());
    let Conversion { take, elements, give } = arrays(parts, names);
    let quantities = parts.iter().map(|part| quantity(names, part));
    let serialization = serialization(name, &fields, names);
    let inlined = inlined();
    quote! {
        #doc
        #[derive(
            ::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug, ::core::cmp::PartialEq, #derived
        )]
        #visibility struct #name {
            #(#docs pub #fields,)*
        }

        #serialization

        const _: () = {
        use #private::Stored as __Stored;

        #[automatically_derived]
        impl #private::#of for #name {
            type Scalar = #scalar;
            type Components = [#scalar; #size];
            const QUANTITIES: &'static [#private::Quantity] = &[#(#quantities),*];

            #inlined
            fn to_components(&self) -> [#scalar; #size] {
                #(#take)*
                [#(#elements),*]
            }

            #inlined
            fn from_components(components: &[#scalar; #size]) -> Self {
                let [#(#elements),*] = *components;
                Self { #(#give),* }
            }

            #rest
        }
        };
    }
}

/// Serde's traits for a struct of parts, by a macro of the runtime that knows whether its feature `serde` is on: what
/// is generated is a function of the description alone.
fn serialization(name: &Ident, fields: &[TokenStream], names: &Names) -> TokenStream {
    let Names { coadjoint, private, .. } = names;
    // serde's derive macros want paths as strings
    let serde = quote! { #coadjoint::serde }.to_string().replace(' ', "");
    let (remote, named) = (name.to_string(), name.unraw().to_string());
    quote! {
        #private::serialization! {
            #name,
            #[serde(crate = #serde, remote = #remote, rename = #named)]
            struct { #(#fields),* }
        }
    }
}

/// The Rust type of a field.
fn field_type(field: &[&Quantity], names: &Names) -> TokenStream {
    let ty = kind_type(field[0].kind, names);
    match field[0].element {
        None => ty,
        Some(_) => {
            let length = size(field.len());
            quote! { [#ty; #length] }
        }
    }
}

/// The type of a kind: one of nalgebra's, by its own name if it has one. Those of vectors and matrices end at 6.
pub(super) fn kind_type(kind: Kind, names: &Names) -> TokenStream {
    let Names { private, scalar, .. } = names;
    let named = |name: String| {
        let ty = format_ident!("{name}");
        quote! { #private::nalgebra::#ty<#scalar> }
    };
    match kind {
        Kind::Scalar => scalar.clone(),
        Kind::UnitComplex => named("UnitComplex".to_owned()),
        Kind::UnitQuaternion => named("UnitQuaternion".to_owned()),
        Kind::RigidMotion2 => named("Isometry2".to_owned()),
        Kind::RigidMotion3 => named("Isometry3".to_owned()),
        Kind::Vector(n @ 1..=6) => named(format!("Vector{n}")),
        Kind::Vector(n) => {
            let n = size(n);
            quote! { #private::nalgebra::SVector<#scalar, #n> }
        }
        Kind::Matrix(n @ 1..=6, columns) if n == columns => named(format!("Matrix{n}")),
        Kind::Symmetric(n) => kind_type(Kind::Matrix(n, n), names),
        Kind::Matrix(rows, columns) => {
            let (rows, columns) = (size(rows), size(columns));
            quote! { #private::nalgebra::SMatrix<#scalar, #rows, #columns> }
        }
    }
}

/// How fields become one flat array and back.
pub(super) struct Conversion {
    /// `let [gamma_0, …] = Stored::to_array(&self.gamma);` for each quantity
    pub take: Vec<TokenStream>,
    /// The flat array's elements.
    pub elements: Vec<Ident>,
    /// `gamma: Stored::from_array([gamma_0, …])` for each field; of an array in brackets, for each element
    pub give: Vec<TokenStream>,
}

/// The conversion for fields of these names and numbers of scalars. Paths are given by the caller's `use` of `Stored`.
pub(super) fn arrays(quantities: &[Quantity], names: &Names) -> Conversion {
    let mut conversion = Conversion { take: Vec::new(), elements: Vec::new(), give: Vec::new() };
    let mut count = 0..;
    let mut values = BTreeMap::new();
    for quantity in quantities {
        let place = names.place(quantity);
        let elements: Vec<Ident> = count
            .by_ref()
            .take(quantity.components.len())
            .map(|n| Ident::new(&format!("x{n}"), proc_macro2::Span::mixed_site()))
            .collect();
        let stored = quote! { __Stored::to_array(&self.#place) };
        let array = match quantity.kind {
            Kind::Symmetric(n) => {
                let (private, n) = (&names.private, size(n));
                quote! { #private::symmetric_part(#stored, #n) }
            }
            _ => stored,
        };
        conversion.take.push(quote! { let [#(#elements),*] = #array; });
        values.insert(&quantity.name, quote! { __Stored::from_array([#(#elements),*]) });
        conversion.elements.extend(elements);
    }
    for field in fields(quantities) {
        let given: Vec<TokenStream> =
            field.iter().filter_map(|quantity| values.remove(&quantity.name)).collect();
        let (name, value) = (names.of(field[0]), whole(&field, &given));
        conversion.give.push(quote! { #name: #value });
    }
    conversion
}
