//! What the tests share: systems to test on, deterministic random numbers, measures of what comes out.

pub mod dual;
pub mod measure;
pub mod precise;
pub mod random;
pub mod systems;

use proc_macro2::TokenStream;

/// Items as people read them. Tokens that are not items fail here, before anything is compared.
///
/// # Panics
/// If the tokens cannot be parsed.
#[track_caller]
pub fn pretty(tokens: TokenStream) -> String {
    match syn::parse2::<syn::File>(tokens.clone()) {
        Ok(file) => prettyplease::unparse(&file),
        Err(error) => panic!("generated code cannot be parsed: {error}\n{tokens}"),
    }
}

/// The README's worked example, which is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;
