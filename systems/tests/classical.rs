//! The classical integrators' own tests. They look inside, and the library itself is not built for tests: see `Cargo.toml`.

#[path = "../src/classical/mod.rs"]
#[allow(dead_code, unused_imports, unreachable_pub)]
mod classical;
