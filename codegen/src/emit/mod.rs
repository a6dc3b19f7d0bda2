//! Emission: tokens from models and kernels. No mathematics is done here.

mod derivative;
mod docs;
mod expressions;
mod geometry;
mod kernel;
mod state;
mod system;

pub use kernel::Layout;

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use crate::diagnostics::list;
use crate::expr::Arena;
use crate::kernel::{Derivative, Kernel};
use crate::method::Scheme;
use crate::method::linearization::Derivatives;
use crate::model::{Role, System};

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
            control: format_ident!("{system}Control"),
            system,
            visibility,
            scalar: quote! { ::core::primitive::#scalar },
            private: quote! { #coadjoint::__private },
            coadjoint,
        }
    }
}

/// What the macro puts in the place of the annotated struct, part by part.
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
    /// Each step: its intermediate representation and its code.
    pub steps: Vec<StepExpansion>,
    /// The `Schemes` implementation: all steps, to be chosen from while a program runs.
    pub schemes: TokenStream,
}

/// One step as derived, to be emitted.
pub struct DerivedStep {
    /// The scheme.
    pub scheme: Scheme,
    /// Other schemes that are the same map.
    pub aliases: Vec<Scheme>,
    /// Its code.
    pub kernel: Kernel,
    /// That of its derivative, if any is asked for.
    pub derivative: Option<Derivative>,
}

/// One step's part of an expansion.
pub struct StepExpansion {
    /// The scheme.
    pub scheme: Scheme,
    /// Other schemes that are the same map.
    pub aliases: Vec<Scheme>,
    /// Its intermediate representation.
    pub kernel: Kernel,
    /// Its code.
    pub tokens: TokenStream,
    /// Its derivative, if derivatives are asked for: the intermediate representation and the code.
    pub derivative: Option<(Derivative, TokenStream)>,
}

impl Expansion {
    /// All of it.
    pub fn into_tokens(self) -> TokenStream {
        let Self { declaration, state, expressions, system, geometry, tangents, steps, schemes } = self;
        let steps = steps.into_iter().map(|StepExpansion { tokens, derivative, .. }| {
            let derivative = derivative.map(|(_, tokens)| tokens);
            kernel::block(&quote! { #tokens #derivative })
        });
        quote! { #declaration #state #expressions #system #geometry #tangents #(#steps)* #schemes }
    }
}

/// Emits everything that was derived for a system.
pub fn expansion<'a>(
    arena: &'a Arena,
    system: &System<'a>,
    item: &syn::ItemStruct,
    names: &Names,
    kernels: Vec<DerivedStep>,
    derivatives: Derivatives,
) -> Expansion {
    let steps: Vec<StepExpansion> = kernels
        .into_iter()
        .map(|DerivedStep { scheme, aliases, kernel, derivative }| {
            let layout = Layout::new(system, &kernel.symbols);
            let tokens = kernel::kernel(names, scheme, &aliases, &kernel, &layout);
            let derivative = derivative.map(|derivative| {
                let tokens = derivative::derivative(system, names, scheme, &derivative);
                (derivative, tokens)
            });
            StepExpansion { scheme, aliases, kernel, tokens, derivative }
        })
        .collect();
    let derived = description(system, names, &steps);
    Expansion {
        declaration: declaration(item, &derived),
        state: state::state(system, names),
        expressions: expressions::expressions(system, names),
        system: system::system(arena, system, names),
        geometry: geometry::geometry(arena, system, names),
        tangents: if derivatives.any() {
            derivative::tangents(system, names, derivatives)
        } else {
            quote! {}
        },
        schemes: kernel::schemes(names, &steps),
        steps,
    }
}

/// The user's struct with documentation of what was derived.
fn declaration(item: &syn::ItemStruct, derived: &TokenStream) -> TokenStream {
    let mut item = item.clone();
    let (docs, others): (Vec<_>, Vec<_>) =
        std::mem::take(&mut item.attrs).into_iter().partition(|attribute| attribute.path().is_ident("doc"));
    quote! { #(#docs)* #derived #(#others)* #item }
}

/// Documentation for the user's struct: equations of motion, invariants, what a step costs.
fn description(system: &System<'_>, names: &Names, steps: &[StepExpansion]) -> TokenStream {
    let casimirs = system.casimirs();
    let casimirs =
        if casimirs.is_empty() { String::new() } else { list(casimirs.iter().map(|(name, _)| name)) };
    let mut lines = vec![
        String::new(),
        "# Derived".to_owned(),
        String::new(),
        format!("State: [`{}`]. Equations of motion, {}:", names.state, system.side.coordinates()),
        String::new(),
        "```text".to_owned(),
    ];
    lines.extend(system.equations());
    lines.push("```".to_owned());
    lines.push(String::new());
    let mut invariants = Vec::new();
    if !casimirs.is_empty() {
        invariants.push(format!("{casimirs}, the Casimirs, up to accumulated rounding"));
    }
    if system.is_autonomous() {
        invariants.push("the energy, up to a bounded error of the order of the step".to_owned());
    }
    if !invariants.is_empty() {
        lines.push(format!("Invariants: {}.", invariants.join("; ")));
        lines.push(String::new());
    }
    lines.push("What a step computes, once and for each Newton iteration:".to_owned());
    lines.push(String::new());
    for step in steps {
        let kernel = &step.kernel;
        let once = kernel.begin.operations() + kernel.finish.operations();
        let iteration = match kernel.unknown.len() {
            0 => "it is explicit".to_owned(),
            _ => format!("each iteration {}", kernel.evaluate.operations() + kernel.correction.operations()),
        };
        let once = if kernel.unknown.is_empty() { once + kernel.evaluate.operations() } else { once };
        lines.push(format!("* `{}`: {once}; {iteration}.", step.scheme.type_name()));
        for alias in &step.aliases {
            lines.push(format!("* `{}`: the same map.", alias.type_name()));
        }
    }
    docs::lines(lines)
}

/// `Quantity { name: "gamma", role: Role::Advected, components: &["x", "y", "z"], doc: "…" }`
fn quantity(names: &Names, name: &str, role: Role, suffixes: &[impl AsRef<str>], doc: &str) -> TokenStream {
    let private = &names.private;
    let role = format_ident!("{role:?}");
    let suffixes = suffixes.iter().map(AsRef::as_ref);
    quote! {
        #private::Quantity { name: #name, role: #private::Role::#role, components: &[#(#suffixes),*], doc: #doc }
    }
}
