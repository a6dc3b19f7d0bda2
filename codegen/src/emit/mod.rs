//! Emission of programs: words for what was derived, which is not looked at again.
//!
//! How to add a target, such as C:
//!
//! 1. A folder here, `emit/c99/`, with a function from [`Program`](crate::program::Program) to text. It uses `program`,
//!    `quantity` and `scheme` alone, and the numbers of `expr`.
//! 2. Terms: one function over [`Term`](crate::program::Term), with parentheses by how tightly operators bind. The
//!    compiler lists the cases. [`Term::MulAdd`](crate::program::Term::MulAdd) is one operation, `fma`.
//! 3. Statements: an assignment, and the Stumpff functions of one argument, whose series the target brings itself.
//! 4. Functions: arguments are arrays and records, of which a function names what it uses; results are arrays. The
//!    table in `program/roles.rs` says what each role is called, given and returns. Words that the target reserves get
//!    an underscore.
//! 5. Types: what each [`Kind`](crate::quantity::Kind) is stored as, and the scalar of the
//!    [`Interface`](crate::program::Interface).
//! 6. A test that compiles the text and runs it against the program, as `codegen/tests/all/oracle.rs` interprets it;
//!    and the solver of a step's equation, if the target has none.

pub mod bytes;
pub mod c99;
pub mod rust;

pub(crate) use rust::stand_in;
pub use rust::{Expansion, Names, StepExpansion};
