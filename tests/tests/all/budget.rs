//! What the catalogue costs to compile, as far as that can be counted: a change that costs more is to be meant.
//!
//! The generator runs unoptimised while users' crates compile, and what it emits is compiled once for each kind of number that steps are
//! taken with. `.ci/build-cost` measures the seconds.

use coadjoint_codegen::expand;
use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;

/// The attribute's arguments and the struct of a system's file.
fn description(source: &str) -> Option<(TokenStream, TokenStream)> {
    let file = syn::parse_file(source).expect("a source file");
    file.items.into_iter().find_map(|item| {
        let syn::Item::Struct(mut item) = item else { return None };
        let ours = item.attrs.iter().position(|attribute| attribute.path().is_ident("lie_poisson_system"))?;
        let arguments = item.attrs.remove(ours).meta.require_list().ok()?.tokens.clone();
        Some((arguments, item.into_token_stream()))
    })
}

/// How many tokens there are, those within parentheses included.
fn tokens(stream: TokenStream) -> usize {
    let count = |tree: TokenTree| match tree {
        TokenTree::Group(group) => 2 + tokens(group.stream()),
        _ => 1,
    };
    stream.into_iter().map(count).sum()
}

/// The descriptions of the catalogue: one in each file that has any.
fn descriptions() -> Vec<(TokenStream, TokenStream)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../systems/src");
    let files = std::fs::read_dir(folder).expect("the systems").map(|file| file.expect("a file").path());
    let sources =
        files.filter(|path| path.is_file()).map(|path| std::fs::read_to_string(path).expect("text"));
    let descriptions: Vec<_> = sources.filter_map(|source| description(&source)).collect();
    assert_eq!(descriptions.len(), 26);
    descriptions
}

#[test]
fn the_catalogue_keeps_to_its_budget() {
    let (mut kernels, mut emitted) = (0, 0);
    for (attribute, item) in descriptions() {
        let expansion = expand(attribute, item).expect("a valid description");
        kernels += expansion.steps.len();
        emitted += tokens(expansion.into_tokens());
    }
    println!("{kernels} kernels, {emitted} tokens");
    // counted: 120 and 752,220
    assert!(kernels <= 120, "{kernels} kernels");
    assert!(emitted <= 754_000, "{emitted} tokens");
}

/// What nobody asked for is not there.
#[test]
fn an_expansion_has_what_was_asked_for() {
    let size = |asked: &str| {
        let attribute: TokenStream = asked.parse().expect("tokens");
        let item = "struct Body { #[inertia] inertia: Vector3<f64>, mass: f64 }".parse().expect("tokens");
        let expansion = expand(attribute, item).expect("a valid description");
        (expansion.steps.len(), tokens(expansion.into_tokens()))
    };
    let (both, all) = size("group = SO3");
    let (one, half) = size("group = SO3, retractions(Cayley)");
    assert_eq!((both, one), (2, 1));
    assert!(half < all);
    // each map of the derivative adds to the expansion, and all of them are the most
    let (_, every) = size("group = SO3, derivatives");
    for map in ["state", "parameters", "tangent", "adjoint"] {
        let (_, some) = size(&format!("group = SO3, derivatives({map})"));
        assert!(all < some && some < every, "{map}: {all} < {some} < {every}");
    }
    // where there are no controls, nothing is generated for them but the word that it was
    let (_, wrt_state) = size("group = SO3, derivatives(state)");
    let (_, with_controls) = size("group = SO3, derivatives(state, controls)");
    assert!(with_controls <= wrt_state + 32, "{wrt_state} and {with_controls}");
}
