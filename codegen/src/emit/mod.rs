//! Emission of programs: words for what was derived, which is not looked at again.
//!
//! How to add a target, as [C99](c99) is one:
//!
//! 1. A folder here with a function from [`Program`](crate::program::Program) to text. It uses `program`, `quantity` and `scheme` alone, and the
//!    numbers of `expr`.
//! 2. Terms: one function over [`Term`](crate::program::Term), with parentheses by how tightly operators bind. The
//!    compiler lists the cases. [`Term::MulAdd`](crate::program::Term::MulAdd) is one operation, `fma`.
//! 3. Statements: an assignment, and the Stumpff functions of one argument, whose numbers are in
//!    [`stumpff`](crate::program::stumpff).
//! 4. Functions: arguments are arrays and records, of which a function names what it uses; results are arrays. The
//!    table in `program/roles.rs` says what each role is called, given and returns. Words that the target reserves get
//!    an underscore.
//! 5. Types: what each [`Kind`](crate::quantity::Kind) is stored as, and the scalar of the
//!    [`Interface`](crate::program::Interface).
//! 6. What [callers do](mod@crate::program#what-callers-do), and the [solver](crate::program::solver) of a step's equation, if the target has none.
//! 7. A test that compiles the text and runs it, as `systems/tests/c99.rs`, which holds C against Rust to the last bit.

pub mod bytes;
pub mod c99;
pub mod rust;

pub(crate) use rust::stand_in;
pub use rust::{Expansion, Names, StepExpansion};
