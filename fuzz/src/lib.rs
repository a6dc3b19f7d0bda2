//! What the fuzz targets share: how input is read, and how it is mutated as tokens.

mod description;
mod mutation;

pub use description::{Description, descriptions};
pub use mutation::{cross, mutate};

/// The description that an input is, if it is one. What was read before is forgotten: source text is kept for its spans otherwise, of every input.
pub fn input(data: &[u8]) -> Option<Description> {
    proc_macro2::extra::invalidate_current_thread_spans();
    descriptions(std::str::from_utf8(data).ok()?).into_iter().next()
}
