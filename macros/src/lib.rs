//! The attribute macro of `coadjoint`: one call into `coadjoint-codegen`.

use proc_macro::TokenStream;

/// Derives a structure-preserving stepper from the description of a mechanical system.
#[proc_macro_attribute]
pub fn lie_poisson_system(attribute: TokenStream, item: TokenStream) -> TokenStream {
    coadjoint_codegen::lie_poisson_system(attribute.into(), item.into()).into()
}
