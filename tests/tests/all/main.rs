//! The tests of everything together, in one binary: it is linked once, and what two of them need is compiled once.

// `hygiene` writes `::renamed`, and such a path begins with what the root of the crate names
extern crate coadjoint as renamed;

mod arrays;
mod bases;
mod budget;
mod composition;
mod derivatives;
mod errors;
mod expressions;
mod families;
mod generic;
mod groups;
// as reachable as the root: some lints that users deny ask for that
pub mod hygiene;
mod invariants;
mod kernels;
mod lagrangian;
mod language;
mod lie_poisson;
mod linearization;
mod longrun;
mod numbered;
mod paper;
mod reference;
mod structure;
mod stumpff;
mod surface;
mod tangent_lifts;
mod trivializations;
mod warm;
