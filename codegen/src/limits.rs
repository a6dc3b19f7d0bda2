//! Bounds on what a description may ask for. Within them the generator answers in seconds, compiled without
//! optimisation and on a stack of 2 MB; beyond them it says so at the user's tokens. They count tokens, nodes and
//! operations, never time, so that the answer is the same everywhere. Each is far from what a mechanical system needs.

/// How many tokens the attribute may have, and how many the item. The largest description of the catalogue has 300.
pub(crate) const TOKENS: usize = 10_000;

/// How long a name or a number may be, in bytes. rustc takes seconds for a number of 40,000 digits; `f64` holds 17.
pub(crate) const TOKEN_LENGTH: usize = 1_000;

/// How deeply anything may nest: brackets, signs before an operand, and what extends to the end of a statement. syn
/// takes up to 50 kB of stack for a level.
pub(crate) const NESTING: usize = 32;

/// How many operators, methods, fields and indices may stand between an expression and its innermost operand, all
/// levels together. A chain such as `a + b + c` is a tree that leans to the left; syn takes up to 4 kB of stack to copy
/// a level of it.
pub(crate) const LINKS: usize = 256;

/// How many problems of expressions are reported. Each takes a search for similar names.
pub(crate) const PROBLEMS: usize = 32;

/// How many methods may be asked for. Each is two kernels, and tenths of a second.
pub(crate) const METHODS: usize = 16;

/// How many groups may be defined at a time. Each is looked at when it is defined, which takes tenths of a second.
pub(crate) const GROUPS: usize = 32;

/// The largest dimension of a configuration: that of 32 rotations. A step solves as many equations, and what is derived
/// grows with the cube of it, where all are coupled.
pub(crate) const DIMENSION: usize = 96;

/// How many numbers fields and controls may have together. Each has a name in generated code.
pub(crate) const COMPONENTS: usize = 10_000;

/// The largest exponent that anything may be raised to. `f64` has no room for larger powers of 2.
pub(crate) const EXPONENT: u32 = 1024;

/// The largest matrix whose determinant is written out: it has `n!` terms.
pub(crate) const DETERMINANT: usize = 4;

/// How many integers a range may go through. Each is a copy of what is said of it.
pub const RANGE: i64 = 256;

/// How many operands the sums and products may have that are made while expressions are read. A derivation makes ten to
/// a hundred times as many of them.
pub(crate) const READING: usize = 200_000;

/// How many operands the sums and products may have that are made for a whole system.
pub(crate) const DERIVATION: usize = 5_000_000;

/// How many bytes of formulas documentation has. Longer ones help no reader, and take time and place in every build.
pub(crate) const FORMULAS: usize = 5_000;
