//! The user's expressions as methods: rustc checks their types, and tools find their way in them.

use std::ops::Range;

use proc_macro2::{Ident, Span, TokenStream, TokenTree};
use quote::{ToTokens, format_ident, quote};

use super::code::size;
use super::state::part_type;
use super::{Names, docs};
use crate::identifiers::{plain, velocity_name};
use crate::model::{Factor, ForceForm, NamedPart, Source, StoredAs, System, parts};
use crate::parse::Shape;

/// `impl HeavyTop { pub fn potential(&self, state: &HeavyTopState) -> f64 { … } }`
pub(super) fn expressions(system: &System<'_>, names: &Names) -> TokenStream {
    let scalar = &names.scalar;
    let mut methods = Vec::new();
    let mut energy = |doc: &str, name: &str, source: &Option<Source>, has_velocity: bool| {
        if let Some(Source { value, has_meaning }) = source {
            let result = quote! { #scalar };
            let has_meaning = *has_meaning;
            let energy = Method { doc, name, value, result, has_meaning, has_velocity, has_controls: false };
            methods.push(method(system, names, energy));
        }
    };
    let sources = &system.sources;
    energy("The potential energy, as described.", "potential", &sources.potential, false);
    energy("The Hamiltonian, as described.", "hamiltonian", &sources.hamiltonian, false);
    energy(
        "The Lagrangian, as described, at the velocity that belongs to the momentum.",
        "lagrangian",
        &sources.lagrangian,
        true,
    );
    for force in &system.sources.forces {
        let factor = &system.factors[force.factor];
        let (name, doc) = match system.factors.len() {
            1 => ("force".to_owned(), "The body force on the momentum, as described.".to_owned()),
            _ => {
                let factor = plain(&factor.name);
                (
                    format!("force_{factor}"),
                    format!("The body force on the momentum of `{factor}`, as described."),
                )
            }
        };
        methods.push(method(
            system,
            names,
            Method {
                doc: &doc,
                name: &name,
                value: &force.value,
                result: force_type(factor, force.form, names),
                has_meaning: force.form.is_some(),
                has_velocity: true,
                has_controls: true,
            },
        ));
    }
    if methods.is_empty() {
        return quote! {};
    }
    let name = &names.system;
    quote! { impl #name { #(#methods)* } }
}

/// The type of a force as it is written.
fn force_type(factor: &Factor<'_>, form: Option<ForceForm>, names: &Names) -> TokenStream {
    let group = factor.algebra.group;
    match form {
        Some(ForceForm::Scalar) => names.scalar.clone(),
        Some(ForceForm::Parts) => {
            let parts = group.blocks().into_iter().map(|length| {
                let shape = if length == 1 { Shape::Scalar } else { Shape::Vector(length) };
                part_type(StoredAs::Shape(shape), names)
            });
            quote! { (#(#parts),*) }
        }
        Some(ForceForm::Vector) | None => part_type(group.momentum_type().into(), names),
    }
}

/// What is particular to one of the methods.
struct Method<'m> {
    doc: &'m str,
    name: &'m str,
    /// The expression.
    value: &'m syn::Expr,
    /// Its type.
    result: TokenStream,
    /// Whether it has a meaning; one that has none was reported and is not shown to rustc, but what calls the method finds it.
    has_meaning: bool,
    /// Whether it may use velocities.
    has_velocity: bool,
    /// Whether it may use controls.
    has_controls: bool,
}

/// One expression as a method of the state, the controls if it may use them, and the time if it does.
fn method(system: &System<'_>, names: &Names, method: Method<'_>) -> TokenStream {
    let Method { doc, name, value: expression, result, has_meaning, has_velocity, has_controls } = method;
    let Names { private, scalar, visibility, state: state_type, control: control_type, .. } = names;
    // names of the method's own, which no name of the user's can be
    let own = |name: &str| Ident::new(name, Span::mixed_site());
    let (state, control) = (own("state"), own("control"));
    let name = format_ident!("{name}");
    let doc = docs::line(doc);

    let state_parts = system.parts();
    let state_parts = state_parts.iter().map(|part| &part.name);
    let fields = system.parameters.iter().map(|field| &field.name);
    let controls: Vec<&Ident> = system.controls.iter().map(|part| &part.name).collect();
    let controlled = has_controls && !controls.is_empty();
    let control_argument = controlled.then(|| quote! { #control: &#control_type, });
    let control_values = controlled.then(|| quote! { let #control_type { #(#controls,)* } = *#control; });
    let timed = mentions(expression.to_token_stream(), "t");
    let time_argument = timed.then(|| quote! { t: #scalar, });

    let velocities = has_velocity.then(|| velocities(system, expression, timed, &state, private));
    let momentum_parts = momentum_parts(system, expression);
    // as a statement, so that syn puts parentheses around a block in front of an operator
    let value = syn::Stmt::Expr(expression.clone(), None);
    let value = if has_meaning {
        quote! { #value }
    } else {
        quote! { loop {} }
    };
    quote! {
        #doc
        #[allow(unused_variables, unused_parens, unused_braces, clippy::all)]
        #visibility fn #name(&self, #state: &#state_type, #control_argument #time_argument) -> #result {
            // the elementary functions of floats, where there is no std
            #[allow(unused_imports)]
            use #private::nalgebra::{ComplexField as _, RealField as _};
            #velocities
            let #state_type { #(#state_parts,)* } = *#state;
            #momentum_parts
            #control_values
            let Self { #(#fields,)* } = *self;
            #value
        }
    }
}

/// Variables for the velocities, and for their parts, that an expression names.
fn velocities(
    system: &System<'_>,
    expression: &syn::Expr,
    timed: bool,
    state: &Ident,
    private: &TokenStream,
) -> TokenStream {
    let time = if timed {
        quote! { t }
    } else {
        quote! { 0.0 }
    };
    let all = quote! { #private::System::velocity_at(self, #state, #time) };
    let (mut variables, mut row) = (TokenStream::new(), 0);
    for factor in &system.factors {
        let name = velocity_name(&factor.momentum_name);
        for NamedPart { velocity, rows, .. } in parts(factor.algebra.group, &factor.momentum_name) {
            variables.extend(binding(&velocity, &all, row + rows.start..row + rows.end, expression));
        }
        let rows = row..row + factor.momentum.len();
        row = rows.end;
        if mentions(expression.to_token_stream(), &name) {
            variables.extend(rows_of(&name, &all, rows));
        }
    }
    variables
}

/// Variables for the parts of momenta that an expression names.
fn momentum_parts(system: &System<'_>, expression: &syn::Expr) -> TokenStream {
    let of = |factor: &Factor<'_>| {
        let name = &factor.momentum_name;
        let whole = quote! { #name };
        let parts = parts(factor.algebra.group, name).into_iter();
        parts.filter_map(move |part| binding(&part.momentum, &whole, part.rows, expression))
    };
    system.factors.iter().flat_map(of).collect()
}

/// `let angular_momentum = …;` where the name is used: some rows of a vector, or its one component.
fn binding(
    name: &str,
    whole: &TokenStream,
    rows: Range<usize>,
    expression: &syn::Expr,
) -> Option<TokenStream> {
    if !mentions(expression.to_token_stream(), name) {
        return None;
    }
    if rows.len() > 1 {
        return Some(rows_of(name, whole, rows));
    }
    let (name, row) = (format_ident!("{name}"), size(rows.start));
    Some(quote! { let #name = #whole[#row]; })
}

fn rows_of(name: &str, whole: &TokenStream, rows: Range<usize>) -> TokenStream {
    let (name, first, count) = (format_ident!("{name}"), size(rows.start), size(rows.len()));
    quote! { let #name = #whole.fixed_rows::<#count>(#first).into_owned(); }
}

/// Whether a name occurs.
fn mentions(tokens: TokenStream, name: &str) -> bool {
    tokens.into_iter().any(|token| match token {
        TokenTree::Ident(ident) => ident == name,
        TokenTree::Group(group) => mentions(group.stream(), name),
        _ => false,
    })
}
