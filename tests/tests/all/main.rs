//! The tests of everything together. Those of systems described for them are another binary, which is compiled beside this one.

// `hygiene` writes `::renamed`, and such a path begins with what the root of the crate names
extern crate coadjoint as renamed;

mod composition;
mod errors;
mod expressions;
mod groups;
mod hamilton_jacobi;
// as reachable as the root: some lints that users deny ask for that
pub mod hygiene;
mod invariants;
mod kernels;
mod language;
mod lie_poisson;
mod linearization;
mod longrun;
mod reference;
mod structure;
mod stumpff;
mod surface;
mod trivializations;
mod warm;
