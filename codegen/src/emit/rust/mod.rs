//! Programs as Rust.

mod code;
mod derivative;
mod docs;
mod documentation;
mod expressions;
mod functions;
mod geometry;
mod kernel;
mod names;
mod schemes;
mod stand_in;
mod state;
mod system;
mod tangents;
mod taylor;

pub use names::Names;
pub(crate) use stand_in::stand_in;

use proc_macro2::TokenStream;
use quote::quote;

use crate::model::System;
use crate::program::{Program, StepProgram};
use crate::scheme::Derivatives;
use functions::block;

/// The macro's expansion, part by part.
pub struct Expansion {
    /// The user's struct, with documentation of what was derived.
    pub declaration: TokenStream,
    /// The state, and the controls if there are any.
    pub state: TokenStream,
    /// The user's expressions as methods.
    pub expressions: TokenStream,
    /// The `System` implementation.
    pub system: TokenStream,
    /// The `Geometry` implementation.
    pub geometry: TokenStream,
    /// The `Differentiable` implementation, if derivatives are asked for.
    pub tangents: TokenStream,
    /// The `PowerSeries` implementation, if Taylor steps are asked for.
    pub taylor: TokenStream,
    /// Each step: its intermediate representation and its code.
    pub steps: Vec<StepExpansion>,
    /// The `Schemes` implementation: all steps, to be chosen from while a program runs.
    pub schemes: TokenStream,
}

/// One step's part of an expansion.
pub struct StepExpansion {
    /// Its intermediate representation.
    pub program: StepProgram,
    /// Its code.
    pub tokens: TokenStream,
    /// The code of its derivative, if derivatives are asked for.
    pub derivative: Option<TokenStream>,
}

impl Expansion {
    /// All of it.
    pub fn into_tokens(self) -> TokenStream {
        let Self { declaration, state, expressions, system, geometry, tangents, taylor, steps, schemes } =
            self;
        let steps = steps
            .into_iter()
            .map(|StepExpansion { tokens, derivative, .. }| block(&quote! { #tokens #derivative }));
        quote! { #declaration #state #expressions #system #geometry #tangents #taylor #(#steps)* #schemes }
    }
}

/// Emits everything that was derived for a system.
pub fn expansion(
    program: Program,
    source: &System<'_>,
    item: &syn::ItemStruct,
    names: &Names,
    derivatives: Derivatives,
) -> Expansion {
    let interface = &program.interface;
    let derived = documentation::description(&program, names);
    let step = |program: StepProgram| StepExpansion {
        tokens: kernel::kernel(names, &program),
        derivative: program
            .derivative
            .as_ref()
            .map(|module| derivative::derivative(names, program.scheme, module, interface)),
        program,
    };
    Expansion {
        declaration: declaration(item, &derived),
        state: state::state(&program, names),
        expressions: expressions::expressions(source, interface, names),
        system: system::system(&program, names),
        geometry: geometry::geometry(&program, names),
        tangents: if derivatives.any() {
            tangents::tangents(interface, names, derivatives)
        } else {
            quote! {}
        },
        taylor: program
            .taylor
            .as_ref()
            .map(|series| taylor::taylor(names, interface, series))
            .unwrap_or_default(),
        schemes: schemes::schemes(names, &program.steps),
        steps: program.steps.into_iter().map(step).collect(),
    }
}

/// The user's struct with documentation of what was derived.
fn declaration(item: &syn::ItemStruct, derived: &TokenStream) -> TokenStream {
    let mut item = item.clone();
    let (docs, others): (Vec<_>, Vec<_>) =
        std::mem::take(&mut item.attrs).into_iter().partition(|attribute| attribute.path().is_ident("doc"));
    quote! { #(#docs)* #derived #(#others)* #item }
}
