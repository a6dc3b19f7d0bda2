//! The user's expressions as methods: rustc checks their types, and tools find their way in them.

use proc_macro2::{Ident, Span, TokenStream, TokenTree};
use quote::{ToTokens, format_ident, quote};

use super::state::part_type;
use super::{Names, docs};
use crate::identifiers::{plain, velocity_name};
use crate::model::{StoredAs, System};

/// `impl HeavyTop { pub fn potential(&self, state: &HeavyTopState) -> f64 { … } }`
pub(super) fn expressions(system: &System<'_>, names: &Names) -> TokenStream {
    let scalar = &names.scalar;
    let mut methods = Vec::new();
    if let Some(potential) = &system.sources.potential {
        let doc = "The potential energy, as described.";
        methods.push(method(system, names, doc, "potential", potential, quote! { #scalar }, false));
    }
    if let Some(hamiltonian) = &system.sources.hamiltonian {
        let doc = "The Hamiltonian, as described.";
        methods.push(method(system, names, doc, "hamiltonian", hamiltonian, quote! { #scalar }, false));
    }
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
        let stored = StoredAs::Named(factor.algebra.group.momentum_type());
        let result = if force.scalar {
            quote! { #scalar }
        } else {
            part_type(stored, names)
        };
        methods.push(method(system, names, &doc, &name, &force.value, result, true));
    }
    if methods.is_empty() {
        return quote! {};
    }
    let name = &names.system;
    quote! { impl #name { #(#methods)* } }
}

/// One expression as a method of the state, the controls if it may use them, and the time if it does.
fn method(
    system: &System<'_>,
    names: &Names,
    doc: &str,
    name: &str,
    expression: &syn::Expr,
    result: TokenStream,
    force: bool,
) -> TokenStream {
    let Names { private, scalar, visibility, state: state_type, control: control_type, .. } = names;
    // names of the method's own, which no name of the user's can be
    let own = |name: &str| Ident::new(name, Span::mixed_site());
    let (state, control) = (own("state"), own("control"));
    let name = format_ident!("{name}");
    let doc = docs::line(doc);

    let parts = system.parts();
    let parts = parts.iter().map(|part| &part.name);
    let fields = system.parameters.iter().map(|field| &field.name);
    let controls: Vec<&Ident> = system.controls.iter().map(|part| &part.name).collect();
    let controlled = force && !controls.is_empty();
    let control_argument = controlled.then(|| quote! { #control: &#control_type, });
    let control_values = controlled.then(|| quote! { let #control_type { #(#controls,)* } = *#control; });
    let timed = mentions(expression.to_token_stream(), "t");
    let time_argument = timed.then(|| quote! { t: #scalar, });

    let mut velocities = TokenStream::new();
    let mut row = 0;
    for factor in system.factors.iter().filter(|_| force) {
        let velocity = velocity_name(&factor.momentum_name);
        let rows = factor.momentum.len();
        if mentions(expression.to_token_stream(), &velocity) {
            let velocity = format_ident!("{velocity}");
            let time = if timed {
                quote! { t }
            } else {
                quote! { 0.0 }
            };
            let (first, rows) = (super::code::size(row), super::code::size(rows));
            velocities.extend(quote! {
                let #velocity = #private::System::velocity_at(self, #state, #time)
                    .fixed_rows::<#rows>(#first)
                    .into_owned();
            });
        }
        row += rows;
    }
    // as a statement, so that syn puts parentheses around a block in front of an operator
    let value = syn::Stmt::Expr(expression.clone(), None);
    quote! {
        #doc
        #[allow(unused_variables, unused_parens, unused_braces, clippy::all)]
        #visibility fn #name(&self, #state: &#state_type, #control_argument #time_argument) -> #result {
            // the elementary functions of floats, where there is no std
            #[allow(unused_imports)]
            use #private::nalgebra::{ComplexField as _, RealField as _};
            #velocities
            let #state_type { #(#parts,)* } = *#state;
            #control_values
            let Self { #(#fields,)* } = *self;
            #value
        }
    }
}

/// Whether a name occurs.
fn mentions(tokens: TokenStream, name: &str) -> bool {
    tokens.into_iter().any(|token| match token {
        TokenTree::Ident(ident) => ident == name,
        TokenTree::Group(group) => mentions(group.stream(), name),
        _ => false,
    })
}
