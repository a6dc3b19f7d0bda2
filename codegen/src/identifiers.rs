//! What things are called, and names that follow from others.

use proc_macro2::Ident;
use syn::ext::IdentExt;

/// An identifier's text without the mark of a raw one.
pub(crate) fn plain(ident: &Ident) -> String {
    ident.unraw().to_string()
}

/// The name of a quantity: one of its own, or its place in an array that has one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// The name that the user gives, to the quantity or to the whole array.
    pub ident: Ident,
    /// The place in the array, if it is one.
    pub place: Option<Place>,
}

/// A place in an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The index.
    pub index: usize,
    /// How long the array is.
    pub length: usize,
}

impl Name {
    /// Names of the elements of an array, or of the one thing that is no array.
    pub(crate) fn all(ident: &Ident, length: Option<usize>) -> Vec<Self> {
        let name = |place| Self { ident: ident.clone(), place };
        match length {
            None => vec![name(None)],
            Some(length) => (0..length).map(|index| name(Some(Place { index, length }))).collect(),
        }
    }

    /// In one word, as in tables and generated names: `attitude`, `spins_0`.
    pub(crate) fn plain(&self) -> String {
        self.with(&plain(&self.ident))
    }

    /// In one word, with another word for the whole.
    pub(crate) fn with(&self, whole: &str) -> String {
        match self.place {
            None => whole.to_owned(),
            Some(Place { index, .. }) => format!("{whole}_{index}"),
        }
    }

    /// As Rust writes it: `attitude`, `spins[0]`.
    pub(crate) fn written(&self) -> String {
        self.in_brackets(&self.ident.to_string())
    }

    /// As Rust writes it, with another word for the whole.
    pub(crate) fn in_brackets(&self, whole: &str) -> String {
        match self.place {
            None => whole.to_owned(),
            Some(Place { index, .. }) => format!("{whole}[{index}]"),
        }
    }

    /// Whether it is the first element of an array, or none.
    pub(crate) fn is_first(&self) -> bool {
        self.place.is_none_or(|place| place.index == 0)
    }
}

/// The velocity's name for a momentum of this name: `attitude_velocity` for `attitude_momentum`.
pub(crate) fn velocity_name(momentum: &Ident) -> String {
    let name = plain(momentum);
    format!("{}velocity", name.strip_suffix("momentum").unwrap_or_default())
}
