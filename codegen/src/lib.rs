//! Derives structure-preserving Lie–Poisson steppers symbolically and emits them as Rust.

pub mod check;
pub mod diagnostics;
pub mod expr;
pub mod language;
pub mod parse;

use proc_macro2::TokenStream;

/// The whole of the attribute macro.
pub fn lie_poisson_system(_attribute: TokenStream, item: TokenStream) -> TokenStream {
    item
}
