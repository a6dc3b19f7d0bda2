//! Derives structure-preserving Lie–Poisson steppers symbolically and emits them as Rust.

pub mod expr;
pub mod group;
pub mod kernel;
pub mod method;
pub mod model;

use proc_macro2::TokenStream;

/// The whole of the attribute macro.
pub fn lie_poisson_system(_attribute: TokenStream, item: TokenStream) -> TokenStream {
    item
}
