//! The tests of the systems and of the program, in one binary: it is linked once.

mod applications;
mod catalogue;
mod certificates;
mod cli;
mod ledger;
mod physics;

// The classical integrators' own tests. They look inside, and the library itself is not built for tests: see `Cargo.toml`.
#[path = "../../src/classical/mod.rs"]
#[allow(dead_code, unused_imports, unreachable_pub)]
mod classical;
