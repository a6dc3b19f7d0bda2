//! Derivatives of steps as Rust.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};
use syn::ext::IdentExt;

use super::kernel::{
    Layout, fields, keep, kernel_name, local, size, statement, term, unpack_array, unpack_fields, unpack_time,
};
use super::{Names, docs};
use crate::kernel::{Derivative, Section, Term};
use crate::method::Scheme;
use crate::method::linearization::Derivatives;
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
    let point_name = format_ident!("Point");
    let of_point = fields(&point_name, "What the derivative is made of at one point.", &derivative.fields);
    let maps = Maps { derivative, sizes: Sizes::new(system, &layout, derivative) };
    let (point, products, matrices) =
        (maps.point(&layout, &point_name), maps.products(), maps.matrices(names));
    let through_type = maps.through_type();

    quote! {
        type __System = #system_name;

        const _: () = {
            use #private::{Linearized, Scalar};

            #of_point

            #[automatically_derived]
            impl<T: Scalar> Linearized<T, __System> for #kernel<T> {
                type Point = Point<T>;
                type Through = #through_type;

                #point
                #products
                #matrices
            }
        };
    }
}

/// How long perturbations and arrays are.
struct Sizes {
    /// Of the perturbations of state, controls and parameters.
    perturbations: [Literal; 3],
    /// Of the arrays of state, controls and parameters.
    arrays: [Literal; 3],
    unknown: Literal,
}

impl Sizes {
    fn new(system: &System<'_>, layout: &Layout, derivative: &Derivative) -> Self {
        let perturbations =
            [derivative.perturbations[0].len(), system.control_symbols().len(), system.field_symbols().len()];
        let arrays = [layout.state.len(), layout.control.len(), layout.parameters.len()];
        Self {
            perturbations: perturbations.map(size),
            arrays: arrays.map(size),
            unknown: size(derivative.unknown.len()),
        }
    }
}

/// The functions of one derivative.
struct Maps<'d> {
    derivative: &'d Derivative,
    sizes: Sizes,
}

impl Maps<'_> {
    /// `fn point(…) -> Point<T> { … }`
    fn point(&self, layout: &Layout, name: &Ident) -> TokenStream {
        let Derivative { fields, point, unknown, h, .. } = self.derivative;
        let Sizes { arrays: [state, control, parameters], unknown: unknowns, .. } = &self.sizes;
        let unpack = [
            unpack_array("parameters", &layout.parameters, point),
            unpack_array("state", &layout.state, point),
            unpack_array("control", &layout.control, point),
            unpack_array("unknown", unknown, point),
            unpack_time(&layout.time, point),
        ];
        let step = h.iter().filter(|h| point.inputs.contains(h)).map(|h| local(h));
        let statements = point.statements.iter().map(statement);
        let kept = keep(name, fields);
        let doc = docs::line(&format!("What the derivative is made of: {}.", point.operations()));
        quote! {
            #doc
            #[inline(always)]
            fn point(
                parameters: &[T; #parameters],
                step: T,
                state: &[T; #state],
                time: T,
                control: &[T; #control],
                unknown: &[T; #unknowns],
            ) -> Point<T> {
                #(#unpack)* #(let #step = step;)* #(#statements)* #kept
            }
        }
    }

    /// The products with a perturbation and with a costate, as far as they are selected.
    fn products(&self) -> TokenStream {
        let Derivative { tangent, adjoint, perturbations, costate, .. } = self.derivative;
        let Sizes { perturbations: [n, controls, parameters], .. } = &self.sizes;
        let [state_perturbations, control_perturbations, parameter_perturbations] = perturbations;
        let tangent = tangent.as_ref().map(|tangent| {
            let doc = docs::line(&format!("The perturbation of the next state: {}.", tangent.operations()));
            let arrays = [
                ("state", state_perturbations),
                ("control", control_perturbations),
                ("parameters", parameter_perturbations),
            ];
            let (body, next) = (self.body(tangent, &arrays), array(&tangent.results));
            quote! {
                #doc
                #[inline(always)]
                fn tangent(
                    point: &Point<T>,
                    state: &[T; #n],
                    control: &[T; #controls],
                    parameters: &[T; #parameters],
                ) -> [T; #n] {
                    #body #next
                }
            }
        });
        let adjoint = adjoint.as_ref().map(|adjoint| {
            let doc = docs::line(&format!("The transpose: {}.", adjoint.operations()));
            let body = self.body(adjoint, &[("costate", costate)]);
            let (wrt_state, others) = adjoint.results.split_at(state_perturbations.len());
            let (wrt_control, wrt_parameters) = others.split_at(control_perturbations.len());
            let [wrt_state, wrt_control, wrt_parameters] =
                [wrt_state, wrt_control, wrt_parameters].map(array);
            quote! {
                #doc
                #[inline(always)]
                fn adjoint(
                    point: &Point<T>,
                    costate: &[T; #n],
                ) -> ([T; #n], [T; #controls], [T; #parameters]) {
                    #body (#wrt_state, #wrt_control, #wrt_parameters)
                }
            }
        });
        quote! { #tangent #adjoint }
    }

    /// The matrices that are wanted, and what all of them make use of.
    fn matrices(&self, names: &Names) -> TokenStream {
        let Names { private, .. } = names;
        let Sizes { perturbations, .. } = &self.sizes;
        let n = &perturbations[0];
        let rows = self.derivative.perturbations[0].len();
        let through_type = self.through_type();
        let through = match &self.derivative.through {
            Some(section) => {
                let doc = docs::line(&format!(
                    "The derivative with respect to the unknown: {}.",
                    section.operations()
                ));
                let (body, columns) =
                    (self.body(section, &[]), section.results.chunks(rows.max(1)).map(array));
                quote! {
                    #doc
                    #[inline(always)]
                    fn through(point: &Point<T>) -> #through_type {
                        #body [#(#columns),*]
                    }
                }
            }
            None => quote! {
                #[inline(always)]
                fn through(_: &Point<T>) -> #through_type {
                    []
                }
            },
        };
        let wanted = ["wrt_state", "wrt_control", "wrt_parameters"].into_iter().zip(perturbations);
        let matrices = wanted.zip(&self.derivative.matrices).filter_map(|((name, columns), section)| {
            let section = section.as_ref()?;
            let function = format_ident!("{name}");
            let doc = docs::line(&format!(
                "The derivative {}: {}.",
                name.replace("wrt_", "with respect to "),
                section.operations()
            ));
            let body = self.body(section, &[]);
            let length = (rows + self.derivative.unknown.len()).max(1);
            let (explicit, products): (Vec<TokenStream>, Vec<TokenStream>) = section
                .results
                .chunks(length)
                .enumerate()
                .map(|(j, column)| {
                    let (explicit, by) = column.split_at(rows);
                    let is_zero = |x: &Term| matches!(x, Term::Number(number) if number.is_zero());
                    let (place, none) = (size(j), by.iter().all(is_zero));
                    let by = array(by);
                    let add = quote! { #private::add_product(&mut columns[#place], through, &#by); };
                    (array(explicit), if none { TokenStream::new() } else { add })
                })
                .unzip();
            Some(quote! {
                #doc
                #[inline(always)]
                fn #function(point: &Point<T>, through: &#through_type) -> [[T; #n]; #columns] {
                    #body
                    let mut columns = [#(#explicit),*];
                    #(#products)*
                    columns
                }
            })
        });
        quote! { #through #(#matrices)* }
    }

    /// The columns of the derivative with respect to the unknown; none where no matrix needs them.
    fn through_type(&self) -> TokenStream {
        let Sizes { perturbations: [n, ..], unknown, .. } = &self.sizes;
        match self.derivative.through {
            Some(_) => quote! { [[T; #n]; #unknown] },
            None => quote! { [[T; #n]; 0] },
        }
    }

    /// What a map needs of the point and of its arguments, and what it computes.
    fn body(&self, section: &Section, arrays: &[(&str, &Vec<String>)]) -> TokenStream {
        let values = unpack_fields(&quote! { Point }, &self.derivative.fields, section, &quote! { *point });
        let arrays = arrays.iter().map(|(array, names)| unpack_array(array, names, section));
        let statements = section.statements.iter().map(statement);
        quote! { #values #(#arrays)* #(#statements)* }
    }
}

/// `[x, y, …]`
fn array(results: &[Term]) -> TokenStream {
    let results = results.iter().map(term);
    quote! { [#(#results),*] }
}

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
