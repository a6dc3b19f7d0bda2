//! Emission of programs as Rust: words for what was derived, which is not looked at again.

pub mod bytecode;
mod code;
mod derivative;
mod docs;
mod expressions;
mod geometry;
mod kernel;
mod schemes;
mod stand_in;
mod state;
mod system;
mod tangents;

pub(crate) use stand_in::stand_in;

use std::collections::BTreeMap;

use proc_macro2::{Ident, TokenStream};
use quote::{ToTokens, format_ident, quote};

use crate::derivatives::Derivatives;
use crate::diagnostics::list;
use crate::identifiers::plain;
use crate::model::System;
use crate::program::{Documentation, Input, Interface, Program, Quantity, Role, StepProgram};
use code::free_function;
use derivative::Lengths;

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
    /// Constants of the user's own code that stand behind the parameters.
    pub constants: Vec<TokenStream>,
    /// What the user calls parameters, parts of the state and controls, at the user's tokens.
    pub identifiers: BTreeMap<String, Ident>,
}

impl Names {
    /// The names for a struct; `coadjoint` is the path of the runtime crate if it is not `::coadjoint`.
    pub fn new(
        system: Ident,
        visibility: syn::Visibility,
        scalar: &str,
        coadjoint: Option<&syn::Path>,
        source: &System<'_>,
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
            constants: source.constants.iter().map(|constant| constant.tokens.to_token_stream()).collect(),
            identifiers: identifiers(source),
        }
    }

    /// What the user calls a parameter, a part of the state or a control; of an element of an array the array.
    fn of(&self, quantity: &Quantity) -> Ident {
        let known = self.identifiers.get(quantity.field()).cloned();
        known.unwrap_or_else(|| format_ident!("{}", quantity.field()))
    }

    /// Where it stands in its struct: `attitude`, `spins[0]`.
    fn place(&self, quantity: &Quantity) -> TokenStream {
        let field = self.of(quantity);
        match &quantity.element {
            None => quote! { #field },
            Some(element) => {
                let index = code::size(element.index);
                quote! { #field[#index] }
            }
        }
    }
}

/// The fields of a struct of quantities: each with the one that it is, or with the elements of the array that it is.
fn fields(quantities: &[Quantity]) -> Vec<Vec<&Quantity>> {
    let mut fields: Vec<Vec<&Quantity>> = Vec::new();
    for quantity in quantities {
        match fields.iter_mut().find(|field| field[0].field() == quantity.field()) {
            Some(field) => field.push(quantity),
            None => fields.push(vec![quantity]),
        }
    }
    fields
}

/// Several values in the place of a field: an array, or the one that there is.
fn whole(field: &[&Quantity], values: &[TokenStream]) -> TokenStream {
    match (&field[0].element, values) {
        (None, [value]) => value.clone(),
        _ => quote! { [#(#values),*] },
    }
}

fn identifiers(source: &System<'_>) -> BTreeMap<String, Ident> {
    let parameters = source.parameters.iter().map(|field| field.name.ident.clone());
    let parts = source.parts().into_iter().map(|part| part.name.ident);
    let controls = source.controls.iter().map(|part| part.name.ident.clone());
    parameters.chain(parts).chain(controls).map(|ident| (plain(&ident), ident)).collect()
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
        let Self { declaration, state, expressions, system, geometry, tangents, steps, schemes } = self;
        let steps = steps
            .into_iter()
            .map(|StepExpansion { tokens, derivative, .. }| block(&quote! { #tokens #derivative }));
        quote! { #declaration #state #expressions #system #geometry #tangents #(#steps)* #schemes }
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
    let derived = description(&program, names);
    let lengths = Lengths {
        state: interface.state_perturbation(),
        controls: interface.control_length(),
        parameters: interface.field_length(),
    };
    let step = |program: StepProgram| StepExpansion {
        tokens: kernel::kernel(names, &program),
        derivative: program
            .derivative
            .as_ref()
            .map(|module| derivative::derivative(names, program.scheme, module, &lengths)),
        program,
    };
    Expansion {
        declaration: declaration(item, &derived),
        state: state::state(&program, names),
        expressions: expressions::expressions(source, names),
        system: system::system(&program, names),
        geometry: geometry::geometry(&program, names),
        tangents: if derivatives.any() {
            tangents::tangents(interface, names, derivatives)
        } else {
            quote! {}
        },
        schemes: schemes::schemes(names, &program.steps),
        steps: program.steps.into_iter().map(step).collect(),
    }
}

/// The free function of a role, if there is one.
fn function(program: &Program, private: &TokenStream, role: Role, name: &str) -> TokenStream {
    let Some((module, function)) = program.function(role) else { return quote! {} };
    let doc = docs::line(&format!("{}.", function.operations()));
    let function = free_function(name, private, module, function);
    quote! { #doc #function }
}

/// A call of the free function of a role in a method of the system: what it is given are the variables of their names, `state`, `time`, `control`,
/// `by`; those here are other ones.
fn call(
    program: &Program,
    names: &Names,
    role: Role,
    name: &str,
    others: &[(Input, TokenStream)],
) -> TokenStream {
    let private = &names.private;
    let Some((_, function)) = program.function(role) else { return quote! {} };
    let usual = |input, length| match input {
        Input::Parameters => quote! { &#private::System::to_parameters(self) },
        Input::State => quote! { &#private::State::to_components(state) },
        Input::Control => quote! { &#private::Control::to_components(control) },
        Input::Velocity => {
            let length = code::size(length);
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
    let name = format_ident!("{name}");
    quote! { #name(#(#arguments),*) }
}

/// What belongs to one scheme, in a block of its own.
fn block(content: &TokenStream) -> TokenStream {
    quote! {
        #[allow(unreachable_pub, unused_variables, clippy::all, clippy::pedantic)]
        const _: () = {
            #content
        };
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
fn description(program: &Program, names: &Names) -> TokenStream {
    let Documentation { coordinates, equations, .. } = &program.interface.documentation;
    let mut lines = vec![
        String::new(),
        "# Derived".to_owned(),
        String::new(),
        format!("State: [`{}`]. Equations of motion, {}:", names.state, coordinates),
        String::new(),
        "```text".to_owned(),
    ];
    lines.extend(equations.iter().cloned());
    lines.push("```".to_owned());
    lines.push(String::new());
    lines.extend(invariants(&program.interface));
    lines.push("What a step computes, once and for each Newton iteration:".to_owned());
    lines.push(String::new());
    for step in &program.steps {
        let of = |role| step.module.operations(role);
        let once = of(Role::Begin) + of(Role::Finish);
        let evaluate = step.module.function(Role::Evaluate);
        let is_explicit = evaluate.is_none_or(|function| function.length(Input::Unknown) == 0);
        let (once, iteration) = match is_explicit {
            true => (once + of(Role::Evaluate), "it is explicit".to_owned()),
            false => (once, format!("each iteration {}", of(Role::Evaluate) + of(Role::Correction))),
        };
        lines.push(format!("* `{}`: {once}; {iteration}.", step.scheme.type_name()));
        for alias in &step.aliases {
            lines.push(format!("* `{}`: the same map.", alias.type_name()));
        }
    }
    docs::lines(lines)
}

/// What the motion keeps, as a paragraph; nothing if it keeps nothing that is known.
fn invariants(interface: &Interface) -> Vec<String> {
    let Interface { casimirs, missing_casimirs, is_autonomous, controls, .. } = interface;
    let mut invariants = Vec::new();
    if !casimirs.is_empty() {
        invariants.push(format!("{}, the Casimirs, up to accumulated rounding", list(casimirs)));
    }
    if *missing_casimirs > 0 {
        let more = if casimirs.is_empty() { "" } else { "more " };
        // one may be such a polynomial whose coefficients were too large to be told
        let which = match missing_casimirs {
            1 => "Casimir that is no polynomial",
            _ => "Casimirs that are no polynomials",
        };
        invariants.push(format!("{missing_casimirs} {more}{which} of a low degree with small coefficients"));
    }
    if *is_autonomous {
        let held = if controls.is_empty() { "" } else { " as long as the controls are the same" };
        invariants.push(format!("the energy{held}, up to a bounded error of the scheme's order in the step"));
    }
    match invariants.is_empty() {
        true => Vec::new(),
        false => vec![format!("Invariants: {}.", invariants.join("; ")), String::new()],
    }
}

/// `Quantity { name: "gamma", role: Role::Advected, components: &["x", "y", "z"], doc: "…" }`
fn quantity(names: &Names, quantity: &Quantity) -> TokenStream {
    let private = &names.private;
    let Quantity { name, role, components, doc, .. } = quantity;
    let role = format_ident!("{role:?}");
    quote! {
        #private::Quantity { name: #name, role: #private::Role::#role, components: &[#(#components),*], doc: #doc }
    }
}
