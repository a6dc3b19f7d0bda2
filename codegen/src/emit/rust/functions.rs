//! The functions of a system as free functions, and calls of them.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::code::{free_function, size};
use super::docs;
use super::names::Names;
use crate::program::{FunctionRole as _, Input, Program, SystemRole};

/// What the free function of a role is called.
fn function_name(role: SystemRole) -> String {
    match role {
        SystemRole::Displacement(retraction) => retraction.row().snake_name.to_owned(),
        SystemRole::HamiltonianVector => "vector".to_owned(),
        SystemRole::Deviation => "off".to_owned(),
        role => role.name(),
    }
}

/// The free function of a role, if there is one.
pub(super) fn function(program: &Program, names: &Names, role: SystemRole) -> TokenStream {
    let Some((module, function)) = program.function(role) else { return quote! {} };
    let doc = docs::line(&format!("{}: {}.", role.signature().purpose, function.operations()));
    let function = free_function(&function_name(role), &names.private, &module.values, function);
    quote! { #doc #function }
}

/// A call of the free function of a role in a method of the system: what it is given are the variables of their names,
/// `state`, `time`, `control`, `by`; those here are other ones.
pub(super) fn call(
    program: &Program,
    names: &Names,
    role: SystemRole,
    others: &[(Input, TokenStream)],
) -> TokenStream {
    let private = &names.private;
    let Some((_, function)) = program.function(role) else { return quote! {} };
    let usual = |input, length| match input {
        Input::Parameters => quote! { &#private::System::to_parameters(self) },
        Input::State => quote! { &#private::State::to_components(state) },
        Input::Control => quote! { &#private::Control::to_components(control) },
        Input::Velocity => {
            let length = size(length);
            quote! {
                &#private::Stored::<_, #length>::to_array(&#private::System::velocity_at(self, state, time, control))
            }
        }
        Input::Time => quote! { time },
        _ => quote! { by },
    };
    let arguments = function.arguments.iter().map(|argument| {
        let other = others.iter().find(|(input, _)| *input == argument.input);
        other.map_or_else(|| usual(argument.input, argument.values.len()), |(_, other)| other.clone())
    });
    let name = format_ident!("{}", function_name(role));
    quote! { #name(#(#arguments),*) }
}

/// Puts the code of one scheme into a block of its own.
pub(super) fn block(content: &TokenStream) -> TokenStream {
    quote! {
        #[allow(unreachable_pub, unused_variables, clippy::all, clippy::pedantic)]
        const _: () = {
            #content
        };
    }
}
