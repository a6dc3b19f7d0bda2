//! Derivatives of steps as Rust.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};
use syn::ext::IdentExt;

use super::kernel::{
    Layout, fields, keep, kernel_name, local, size, statement, term, unpack_array, unpack_fields, unpack_time,
};
use super::{Names, docs};
use crate::kernel::{Derivative, Section, Term};
use crate::method::Scheme;
use crate::model::{Role, System};

/// The derivative of one scheme's step, to stand beside its kernel:
///
/// ```text
/// const _: () = {
///     pub struct Point<T> { … }
///     impl<T: Scalar> Linearized<T, HeavyTop> for HeavyTopCayley<T> { … }
/// };
/// ```
///
/// What stands in it does not name the system, which may be called `Point` or `Linearized`, too.
pub(super) fn derivative(
    system: &System<'_>,
    names: &Names,
    scheme: Scheme,
    derivative: &Derivative,
) -> TokenStream {
    let Names { private, system: system_name, .. } = names;
    let kernel = kernel_name(names, scheme);
    let layout = Layout::new(system, &derivative.symbols);
    let Derivative {
        fields: values, point, tangent, adjoint, matrices, unknown, changes, costate, h, ..
    } = derivative;
    let point_name = format_ident!("Point");
    let of_point = fields(&point_name, "What the derivative is made of at one point.", values);
    let [state_changes, control_changes, parameter_changes] = changes;
    let [n, controls, parameters] =
        [state_changes, control_changes, parameter_changes].map(|c| size(c.len()));
    let (all_parameters, all_controls) = (size(layout.parameters.len()), size(layout.control.len()));
    let (all_state, unknowns) = (size(layout.state.len()), size(unknown.len()));

    let at = {
        let unpack = [
            unpack_array("parameters", &layout.parameters, point),
            unpack_array("state", &layout.state, point),
            unpack_array("control", &layout.control, point),
            unpack_array("unknown", unknown, point),
            unpack_time(&layout.time, point),
        ];
        let step = h.iter().filter(|h| point.inputs.contains(h)).map(|h| local(h));
        let statements = point.statements.iter().map(statement);
        let kept = keep(&point_name, values);
        quote! { #(#unpack)* #(let #step = step;)* #(#statements)* #kept }
    };
    let body = |section: &Section, arrays: &[(&str, &Vec<String>)]| {
        let values = unpack_fields(&quote! { Point }, values, section, &quote! { *point });
        let arrays = arrays.iter().map(|(array, names)| unpack_array(array, names, section));
        let statements = section.statements.iter().map(statement);
        quote! { #values #(#arrays)* #(#statements)* }
    };
    let array = |results: &[Term]| {
        let results = results.iter().map(term);
        quote! { [#(#results),*] }
    };
    let counts = changes.each_ref().map(Vec::len);
    let arrays = [("state", state_changes), ("control", control_changes), ("parameters", parameter_changes)];
    let (tangent_body, next) = (body(tangent, &arrays), array(&tangent.results));
    let adjoint_body = body(adjoint, &[("costate", costate)]);
    let (by_state, others) = adjoint.results.split_at(counts[0]);
    let (by_control, by_parameters) = others.split_at(counts[1]);
    let [by_state, by_control, by_parameters] = [by_state, by_control, by_parameters].map(array);
    let [at_doc, tangent_doc, adjoint_doc] = [
        ("What the derivative is made of", point),
        ("The change of the next state", tangent),
        ("The transpose", adjoint),
    ]
    .map(|(what, section)| docs::line(&format!("{what}: {}.", section.operations())));
    let matrices = [("by_state", &n), ("by_control", &controls), ("by_parameters", &parameters)]
        .into_iter()
        .zip(matrices)
        .map(|((name, columns), section)| {
            let function = format_ident!("{name}");
            let doc =
                docs::line(&format!("The derivative {}: {}.", name.replace('_', " "), section.operations()));
            let body = body(section, &[]);
            let (through, rest) = section.results.split_at(unknown.len() * counts[0]);
            let through = through.chunks(counts[0].max(1)).map(array);
            let rest = rest.chunks((counts[0] + unknown.len()).max(1));
            let (explicit, products): (Vec<TokenStream>, Vec<TokenStream>) = rest
                .enumerate()
                .map(|(j, column)| {
                    let (explicit, by) = column.split_at(counts[0]);
                    let is_zero = |x: &Term| matches!(x, Term::Number(number) if number.is_zero());
                    let (place, none) = (size(j), by.iter().all(is_zero));
                    let by = array(by);
                    let add = quote! { #private::add_product(&mut columns[#place], &through, &#by); };
                    (array(explicit), if none { TokenStream::new() } else { add })
                })
                .unzip();
            quote! {
                #doc
                #[inline(always)]
                fn #function(point: &Point<T>) -> [[T; #n]; #columns] {
                    #body
                    let through: [[T; #n]; #unknowns] = [#(#through),*];
                    let mut columns = [#(#explicit),*];
                    #(#products)*
                    columns
                }
            }
        });

    quote! {
        type __System = #system_name;

        const _: () = {
            use #private::{Linearized, Scalar};

            #of_point

            #[automatically_derived]
            impl<T: Scalar> Linearized<T, __System> for #kernel<T> {
                type Point = Point<T>;

                #at_doc
                #[inline(always)]
                fn point(
                    parameters: &[T; #all_parameters],
                    step: T,
                    state: &[T; #all_state],
                    time: T,
                    control: &[T; #all_controls],
                    unknown: &[T; #unknowns],
                ) -> Point<T> {
                    #at
                }

                #tangent_doc
                #[inline(always)]
                fn tangent(
                    point: &Point<T>,
                    state: &[T; #n],
                    control: &[T; #controls],
                    parameters: &[T; #parameters],
                ) -> [T; #n] {
                    #tangent_body #next
                }

                #adjoint_doc
                #[inline(always)]
                fn adjoint(
                    point: &Point<T>,
                    costate: &[T; #n],
                ) -> ([T; #n], [T; #controls], [T; #parameters]) {
                    #adjoint_body (#by_state, #by_control, #by_parameters)
                }

                #(#matrices)*
            }
        };
    }
}

/// `impl Differentiable for HeavyTop { … }`, and the places of all parts within changes.
pub(super) fn tangents(system: &System<'_>, names: &Names) -> TokenStream {
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
        places.push(quote! { #doc pub const #constant: #coadjoint::derivative::Part<#from, #length> = #coadjoint::derivative::Part; });
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
        place("changes of the state", &part.name, state, length);
        state += length;
    }
    let mut control = 0;
    for part in &system.controls {
        place("changes of the controls", &part.name, control, part.symbols.len());
        control += part.symbols.len();
    }
    let mut parameters = 0;
    for field in &system.parameters {
        place("changes of the parameters", &field.name, parameters, field.symbols.len());
        parameters += field.symbols.len();
    }
    let [state, control, parameters] = [state, control, parameters].map(size);
    let part = format_ident!("{name}Part");
    let docs = docs::lines([
        format!("Where the parts of a [`{name}`] are within changes of its state, controls and parameters."),
        String::new(),
        "A configuration changes by an element of the algebra, `g exp(δ)`.".to_owned(),
    ]);
    quote! {
        #docs
        #[derive(::core::clone::Clone, ::core::marker::Copy, ::core::fmt::Debug)]
        #visibility struct #part;

        #[allow(dead_code)]
        impl #part { #(#places)* }

        #[automatically_derived]
        impl #private::Differentiable for #name {
            type StateChange<V: #private::Entry> = [V; #state];
            type ControlChange<V: #private::Entry> = [V; #control];
            type ParameterChange<V: #private::Entry> = [V; #parameters];
            type StateVector = #private::nalgebra::SVector<#scalar, #state>;
            type ControlVector = #private::nalgebra::SVector<#scalar, #control>;
            type ParameterVector = #private::nalgebra::SVector<#scalar, #parameters>;
            type ByState = #private::nalgebra::SMatrix<#scalar, #state, #state>;
            type ByControl = #private::nalgebra::SMatrix<#scalar, #state, #control>;
            type ByParameters = #private::nalgebra::SMatrix<#scalar, #state, #parameters>;
        }
    }
}
