//! What stands by itself in the generator, with the tests beside it: the whole library would have to be compiled once more for these.
#![allow(dead_code, unreachable_pub)]

#[path = "../../src/diagnostics.rs"]
mod diagnostics;
#[path = "../../src/group/exact.rs"]
mod exact;
#[path = "../../src/parse/shape.rs"]
mod shape;
