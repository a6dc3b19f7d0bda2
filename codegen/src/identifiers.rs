//! Identifiers as text, and those that follow from others.

use proc_macro2::Ident;
use syn::ext::IdentExt;

/// An identifier's text without the mark of a raw one.
pub(crate) fn plain(ident: &Ident) -> String {
    ident.unraw().to_string()
}

/// What the velocity is called that belongs to a momentum of this name: `attitude_velocity` for `attitude_momentum`.
pub(crate) fn velocity_name(momentum: &Ident) -> String {
    let name = plain(momentum);
    format!("{}velocity", name.strip_suffix("momentum").unwrap_or_default())
}
