//! Derives structure-preserving Lie–Poisson steppers symbolically and emits them as Rust.
//!
//! ```text
//! attribute + struct ──parse──▶ description ──check──▶ System          spans kept; every problem reported at once
//! System × group × retraction × method ──derive──▶ expression graph     gradient, residual, Jacobian, update
//! graph ──factor, share, stage──▶ Program                               functions and records, no word of any language
//! Program ──emit──▶ tokens
//! ```
//!
//! The output is a function of the input tokens: nothing here does input or output, reads a clock, the environment or a
//! global, and no order of a hash map reaches the output.

pub mod check;
pub mod derive;
pub mod diagnostics;
pub mod emit;
pub mod expr;
mod feasible;
pub mod group;
mod identifiers;
pub mod kernel;
pub mod language;
pub mod library;
mod lie_group;
mod limits;
pub mod method;
pub mod model;
pub mod parse;
pub mod program;
pub mod quantity;
pub mod scheme;
pub mod source;

use std::collections::BTreeSet;

use proc_macro2::TokenStream;
use quote::quote;

use diagnostics::Diagnostics;
use emit::{Expansion, Names};
use expr::Arena;
use group::Retraction;
pub use lie_group::{expression, lie_group};
use model::System;
use parse::{Attribute, Item};
use program::Program;
use scheme::{Derivatives, Parameter, Rule, Scheme};

/// The whole of the attribute macro: what takes the place of the annotated item. Problems become compile errors at the
/// user's tokens, beside as much of the expansion as can be made, or beside something that has all its names, so that
/// one mistake does not bring others with it.
pub fn lie_poisson_system(attribute: TokenStream, item: TokenStream) -> TokenStream {
    expand_with(attribute, item, Default::default(), &TokenStream::new())
}

/// The whole of what the macro of a user's own group or function calls, with the definition that it hands back.
pub fn lie_poisson_system_with(input: TokenStream) -> TokenStream {
    match lie_group::answer(input) {
        Ok((definitions, [known, attribute, item])) => expand_with(attribute, item, definitions, &known),
        Err(error) => error.into_compile_error(),
    }
}

/// The same with the definitions of groups and functions of the user's own, as far as they are known.
fn expand_with(
    tokens: TokenStream,
    item: TokenStream,
    definitions: lie_group::Definitions,
    known: &TokenStream,
) -> TokenStream {
    let mut diagnostics = Diagnostics::new();
    let mut attribute = Attribute::parse(tokens.clone(), &method::known(), &mut diagnostics);
    (attribute.definitions, attribute.functions) = definitions;
    if let Some(question) = lie_group::request_definition(&attribute, known, &tokens, &item) {
        return question;
    }
    match compile(&attribute, item.clone(), &mut diagnostics, emit_rust) {
        Some(expansion) => {
            let (expansion, messages) = (expansion.into_tokens(), diagnostics.into_tokens());
            quote! { #expansion #messages }
        }
        None => emit::stand_in(item, &attribute, diagnostics),
    }
}

/// The expansion of a description without problems, part by part.
///
/// # Errors
/// All problems of the description, each at its tokens.
pub fn expand(attribute: TokenStream, item: TokenStream) -> syn::Result<Expansion> {
    compiled(attribute, item, emit_rust)
}

/// The program of a description without problems: the start of an emitter.
///
/// # Errors
/// All problems of the description, each at its tokens.
pub fn program(attribute: TokenStream, item: TokenStream) -> syn::Result<Program> {
    compiled(attribute, item, |program, _, _, _| program)
}

/// What is derived of a description in a text.
#[derive(Debug)]
pub struct Derived {
    /// Its program.
    pub program: Program,
    /// The values of the [constants](program::Interface::constants).
    pub constants: Vec<f64>,
    /// What is no error, each with its place.
    pub warnings: Vec<(proc_macro2::Span, String)>,
}

/// The program of a description in a text, with the groups, functions and constants that stand beside it.
///
/// # Errors
/// All problems of the description, each at its tokens; or if none, or none of this name, is there.
pub fn derived(source: &source::Source, name: Option<&str>) -> syn::Result<Derived> {
    let mut unknown = Vec::new();
    let made = in_text(source, name, |program, system, _, _| {
        let constants = system.constants.iter().map(|constant| {
            source.constant(&constant.tokens).unwrap_or_else(|error| {
                unknown.push(error);
                f64::NAN
            })
        });
        (program, constants.collect())
    });
    // where the description is in error too, both are told
    let ((program, constants), warnings) = match (made, unknown.into_iter().reduce(combined)) {
        (Ok(made), None) => made,
        (Err(error), None) | (Ok(_), Some(error)) => return Err(error),
        (Err(first), Some(then)) => return Err(combined(first, then)),
    };
    Ok(Derived { program, constants, warnings })
}

/// The expansion of a description in a text, with the groups and functions that stand beside it.
///
/// # Errors
/// As of [`derived`], but for constants, which only a compiler has to know.
pub fn expand_in(source: &source::Source, name: Option<&str>) -> syn::Result<Expansion> {
    in_text(source, name, emit_rust).map(|(expansion, _)| expansion)
}

fn combined(mut all: syn::Error, then: syn::Error) -> syn::Error {
    all.combine(then);
    all
}

/// What is made of the program of a description in a text, and what is no error.
fn in_text<R>(
    source: &source::Source,
    name: Option<&str>,
    emit: impl FnOnce(Program, &System<'_>, &Attribute, &Item) -> R,
) -> syn::Result<(R, Vec<(proc_macro2::Span, String)>)> {
    let description = source.description(name)?;
    let mut diagnostics = Diagnostics::new();
    let mut attribute = Attribute::parse(description.attribute.clone(), &method::known(), &mut diagnostics);
    if source.has_derivatives() {
        attribute.derivatives = scheme::Derivatives::ALL;
    }
    match source.definitions() {
        Ok(definitions) => (attribute.definitions, attribute.functions) = definitions,
        Err(error) => diagnostics.absorb(error),
    }
    let made = compile(&attribute, description.item.clone(), &mut diagnostics, emit);
    let warnings = diagnostics.warned();
    diagnostics.finish()?;
    let made =
        made.ok_or_else(|| syn::Error::new(proc_macro2::Span::call_site(), "there is nothing to derive"))?;
    Ok((made, warnings))
}

/// A C99 header of a description without problems, for some of its steps: one file that needs nothing but `math.h`.
///
/// # Errors
/// All problems of the description, each at its tokens; or a step that it does not ask for, or constants of the user's own code.
pub fn c99(attribute: TokenStream, item: TokenStream, options: &emit::c99::Options) -> syn::Result<String> {
    let header = compiled(attribute, item, |program, _, _, _| emit::c99::header(&program, options))?;
    header.map_err(|error| syn::Error::new(proc_macro2::Span::call_site(), error))
}

/// What is made of the program of a description without problems.
fn compiled<R>(
    attribute: TokenStream,
    item: TokenStream,
    emit: impl FnOnce(Program, &System<'_>, &Attribute, &Item) -> R,
) -> syn::Result<R> {
    let mut diagnostics = Diagnostics::new();
    let attribute = Attribute::parse(attribute, &method::known(), &mut diagnostics);
    let made = compile(&attribute, item, &mut diagnostics, emit);
    diagnostics.finish()?;
    made.ok_or_else(|| syn::Error::new(proc_macro2::Span::call_site(), "there is nothing to expand"))
}

/// A program as Rust.
fn emit_rust(program: Program, system: &System<'_>, attribute: &Attribute, item: &Item) -> Expansion {
    let names = Names::new(&program.interface, item, attribute.krate.as_ref(), system);
    emit::rust::expansion(program, system, &item.declaration, &names, attribute.derivatives)
}

/// From tokens to what is made of a program, by the stages named above.
fn compile<R>(
    attribute: &Attribute,
    item: TokenStream,
    diagnostics: &mut Diagnostics,
    emit: impl FnOnce(Program, &System<'_>, &Attribute, &Item) -> R,
) -> Option<R> {
    let item = Item::parse(item, diagnostics)?;
    let description = check::resolve(attribute, &item, diagnostics);
    feasible::sizes(&description, diagnostics)?;
    feasible::retractions(attribute, &item, diagnostics)?;
    let arena = Arena::limited(limits::DERIVATION);
    // expressions are looked at even if they cannot be used, for the sake of their problems
    let system = System::build(&arena, &description, diagnostics)?;
    feasible::legendre(&system, attribute, diagnostics)?;
    let schemes = schemes(&system, attribute);
    let mut program = derive::program(&arena, &system, &displacing(&schemes));
    feasible::derived(&arena, attribute, &item, || None, diagnostics)?;
    let wanted = attribute.derivatives;
    let mut work = arena.work();
    let begun = work;
    for (scheme, aliases) in &schemes {
        // each from a system of its own: what else is asked for has no part in it
        let arena = Arena::limited(limits::DERIVATION - work);
        let system = System::build(&arena, &description, &mut Diagnostics::new())?;
        program.steps.extend(derive::step(&arena, &system, *scheme, aliases.clone(), wanted));
        let lower = || fitting_order(&description, &schemes, scheme.rule, wanted, begun);
        feasible::derived(&arena, attribute, &item, lower, diagnostics)?;
        work += arena.work();
    }
    if attribute.taylor {
        let arena = Arena::limited(limits::DERIVATION - work);
        let system = System::build_series(&arena, &description)?;
        program.taylor = derive::series(&arena, &system);
        feasible::derived(&arena, attribute, &item, || None, diagnostics)?;
        feasible::has_series(program.taylor.is_some(), attribute, &item, diagnostics)?;
    }
    Some(emit(program, &system, attribute, &item))
}

/// The rule of the highest lower order with which, in place of this one, all steps can be derived after so much work.
fn fitting_order(
    description: &check::Description<'_>,
    schemes: &[(Scheme, Vec<Scheme>)],
    rule: Rule,
    wanted: Derivatives,
    begun: usize,
) -> Option<String> {
    let Parameter::Order(order) = rule.parameter else { return None };
    let method = rule.method;
    let fits = |&lower: &u32| {
        let lower = method.of_order(lower);
        let others =
            schemes.iter().map(|(scheme, _)| *scheme).filter(|scheme| ![rule, lower].contains(&scheme.rule));
        let lowered = schemes.iter().map(|(scheme, _)| *scheme).filter(|scheme| scheme.rule == rule);
        let mut work = begun;
        others.chain(lowered.map(|scheme| Scheme { rule: lower, ..scheme })).all(|scheme| {
            let arena = Arena::limited(limits::DERIVATION - work);
            let system = System::build(&arena, description, &mut Diagnostics::new());
            let step = system.and_then(|system| derive::step(&arena, &system, scheme, Vec::new(), wanted));
            work += arena.work();
            step.is_some() && !arena.is_exhausted()
        })
    };
    let mut lower = method.orders.iter().copied().rev().filter(|&lower| lower < order);
    lower.find(fits).map(|order| format!("{}({order})", method.name))
}

/// The retractions to generate steps with: those that are named, or the usual ones that the groups have. Of these a
/// series, whose code is long, only where there is nothing else.
fn retractions(system: &System<'_>, named: &[Retraction]) -> Vec<Retraction> {
    if !named.is_empty() {
        return named.to_vec();
    }
    let there = Retraction::defaults().filter(|&retraction| system.group.has(retraction));
    let (summed, closed): (Vec<_>, Vec<_>) =
        there.partition(|&retraction| system.group.is_summed(retraction));
    if closed.is_empty() { summed } else { closed }
}

/// The retractions that states are displaced along: the exponential, which certificates define the others by, and those
/// of the schemes.
fn displacing(schemes: &[(Scheme, Vec<Scheme>)]) -> Vec<Retraction> {
    let mut retractions = BTreeSet::from([Retraction::Exponential]);
    retractions.extend(schemes.iter().map(|(scheme, _)| scheme.retraction));
    retractions.into_iter().collect()
}

/// The schemes to generate: the members of the family that the bare retractions stand for, and what is asked for; each
/// map once, with all its names.
fn schemes(system: &System<'_>, attribute: &Attribute) -> Vec<(Scheme, Vec<Scheme>)> {
    let mut rules = method::STANDARD.to_vec();
    rules.extend(&attribute.methods);
    rules.sort_unstable();
    rules.dedup();
    let retractions = retractions(system, &attribute.retractions);
    let of = |&retraction: &Retraction| rules.iter().map(move |&rule| Scheme { retraction, rule });
    let is_made = |scheme: &Scheme| scheme.retraction.is_equivariant() || !scheme.rule.is_of_order();
    let all: Vec<Scheme> = retractions.iter().flat_map(of).filter(is_made).collect();
    let original = |scheme: &Scheme| scheme.original(system, retractions[0]);
    let (originals, aliases): (Vec<Scheme>, Vec<Scheme>) =
        all.into_iter().partition(|scheme| original(scheme) == *scheme);
    let with_aliases = |scheme: Scheme| {
        (scheme, aliases.iter().copied().filter(|alias| original(alias) == scheme).collect())
    };
    originals.into_iter().map(with_aliases).collect()
}
