//! Emission: tokens from models and kernels. No mathematics is done here.

mod docs;
mod kernel;
mod state;
mod system;

pub use kernel::Layout;

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use crate::diagnostics::list;
use crate::expr::Arena;
use crate::group::Retraction;
use crate::kernel::Kernel;
use crate::model::System;

/// The names and paths that all parts of an expansion share.
pub struct Names {
    /// The user's struct.
    pub system: Ident,
    /// Its state.
    pub state: Ident,
    /// Who may see the struct.
    pub visibility: syn::Visibility,
    /// `f64` or `f32`
    pub scalar: TokenStream,
    /// The path of the runtime crate.
    pub coadjoint: TokenStream,
    /// The path of what generated code needs of it.
    pub private: TokenStream,
}

impl Names {
    /// The names for a struct; `coadjoint` is the path of the runtime crate if it is not `::coadjoint`.
    pub fn new(
        system: Ident,
        visibility: syn::Visibility,
        scalar: &str,
        coadjoint: Option<&syn::Path>,
    ) -> Self {
        let coadjoint = coadjoint.map_or_else(|| quote! { ::coadjoint }, |path| quote! { #path });
        let scalar = format_ident!("{scalar}");
        Self {
            state: format_ident!("{system}State"),
            system,
            visibility,
            scalar: quote! { ::core::primitive::#scalar },
            private: quote! { #coadjoint::__private },
            coadjoint,
        }
    }

    /// The path to serde, as its derive macros want it.
    fn serde_path(&self) -> String {
        let path = &self.private;
        quote! { #path::serde }.to_string().replace(' ', "")
    }
}

/// What the macro puts in the place of the annotated struct, part by part.
pub struct Expansion {
    /// The user's struct, with documentation of what was derived.
    pub declaration: TokenStream,
    /// The state.
    pub state: TokenStream,
    /// The potential as a method.
    pub potential: TokenStream,
    /// The `System` implementation.
    pub system: TokenStream,
    /// The step with each retraction: its intermediate representation and its code.
    pub steps: Vec<StepExpansion>,
}

/// One step's part of an expansion.
pub struct StepExpansion {
    /// The retraction.
    pub retraction: Retraction,
    /// Its intermediate representation.
    pub kernel: Kernel,
    /// Its code.
    pub tokens: TokenStream,
}

impl Expansion {
    /// All of it.
    pub fn into_tokens(self) -> TokenStream {
        let Self { declaration, state, potential, system, steps } = self;
        let steps = steps.into_iter().map(|step| step.tokens);
        quote! { #declaration #state #potential #system #(#steps)* }
    }
}

/// Emits everything that was derived for a system.
pub fn expansion<'a>(
    arena: &'a Arena,
    system: &System<'a>,
    item: &syn::ItemStruct,
    names: &Names,
    kernels: Vec<(Retraction, Kernel)>,
) -> Expansion {
    let steps: Vec<StepExpansion> = kernels
        .into_iter()
        .map(|(retraction, kernel)| {
            let layout = Layout {
                parameters: system.parameter_symbols().iter().map(|&s| kernel.symbols.get(s)).collect(),
                state: system.state_symbols().iter().map(|&s| kernel.symbols.get(s)).collect(),
            };
            let tokens =
                kernel::kernel(&names.system, &names.private, &names.coadjoint, retraction, &kernel, &layout);
            StepExpansion { retraction, kernel, tokens }
        })
        .collect();
    let derived = description(system, names, &steps);
    Expansion {
        declaration: declaration(item, &derived, names),
        state: state::state(system, names),
        potential: system::potential(system, names),
        system: system::system(arena, system, names),
        steps,
    }
}

/// The user's struct with documentation of what was derived.
fn declaration(item: &syn::ItemStruct, derived: &TokenStream, names: &Names) -> TokenStream {
    let mut item = item.clone();
    let (docs, others): (Vec<_>, Vec<_>) =
        std::mem::take(&mut item.attrs).into_iter().partition(|attribute| attribute.path().is_ident("doc"));
    let serde = serde_crate(&others, names);
    quote! { #(#docs)* #derived #(#others)* #serde #item }
}

/// `#[serde(crate = "…")]` for a struct that derives serde's traits, so that their derive macros find serde through us and users
/// need not depend on it. Nothing if the user has said where serde is.
fn serde_crate(attributes: &[syn::Attribute], names: &Names) -> TokenStream {
    let derives =
        attributes.iter().filter(|attribute| attribute.path().is_ident("derive")).any(|attribute| {
            let mut serde = false;
            // what cannot be read here is for rustc to complain about
            let _ = attribute.parse_nested_meta(|meta| {
                serde |= meta
                    .path
                    .segments
                    .last()
                    .is_some_and(|last| last.ident == "Serialize" || last.ident == "Deserialize");
                Ok(())
            });
            serde
        });
    let mut serde = attributes.iter().filter(|attribute| attribute.path().is_ident("serde"));
    let says_where = serde.any(|attribute| {
        let syn::Meta::List(list) = &attribute.meta else { return false };
        // `crate` followed by `=`, whatever else stands there
        let tokens: Vec<String> = list.tokens.clone().into_iter().map(|token| token.to_string()).collect();
        tokens.windows(2).any(|pair| pair[0] == "crate" && pair[1] == "=")
    });
    if !derives || says_where {
        return quote! {};
    }
    let path = names.serde_path();
    quote! { #[serde(crate = #path)] }
}

/// Documentation for the user's struct: equations of motion, invariants, what a step costs.
fn description(system: &System<'_>, names: &Names, steps: &[StepExpansion]) -> TokenStream {
    let casimirs = system.casimirs();
    let casimirs = list(casimirs.iter().map(|(name, _)| name));
    let mut lines = vec![
        String::new(),
        "# Derived".to_owned(),
        String::new(),
        format!("State: [`{}`]. Equations of motion, in body coordinates:", names.state),
        String::new(),
        "```text".to_owned(),
    ];
    lines.extend(system.equations());
    lines.push("```".to_owned());
    lines.push(String::new());
    lines.push(format!(
        "Invariants: {casimirs}, the Casimirs, up to accumulated rounding; the energy, up to a bounded error of second order in \
         the step."
    ));
    lines.push(String::new());
    lines.push("What a step computes, once and for each Newton iteration:".to_owned());
    lines.push(String::new());
    for step in steps {
        let kernel = &step.kernel;
        lines.push(format!(
            "* [`{0}`]({1}::{0}): {2}; each iteration {3}.",
            step.retraction.name(),
            names.coadjoint.to_string().replace(' ', ""),
            kernel.begin.operations() + kernel.finish.operations(),
            kernel.evaluate.operations() + kernel.correction.operations(),
        ));
    }
    docs::lines(lines)
}

/// `Quantity { name: "gamma", components: &["x", "y", "z"], doc: "…" }`
fn quantity(names: &Names, name: &str, suffixes: &[impl AsRef<str>], doc: &str) -> TokenStream {
    let private = &names.private;
    let suffixes = suffixes.iter().map(AsRef::as_ref);
    quote! { #private::Quantity { name: #name, components: &[#(#suffixes),*], doc: #doc } }
}
