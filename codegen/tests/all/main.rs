//! The tests of the generator from outside, in one binary: it is linked once.

mod alone;
mod bounds;
mod bytes;
mod c99;
mod calculus;
mod casimirs;
mod catalogue;
mod common;
mod description;
#[expect(unreachable_pub, reason = "another crate includes it")]
mod evaluate;
mod explicit;
mod fuzz;
mod groups;
#[expect(unreachable_pub, reason = "another crate includes it")]
mod interpret;
mod linear;
mod macro_calls;
mod meaning;
mod modules;
mod numbers;
mod oracle;
mod problems;
mod program;
mod prose;
mod reference;
mod snapshots;
mod steps;
mod vanishing;

/// For [`alone`].
#[allow(dead_code, unreachable_pub)]
#[path = "../../src/quantity.rs"]
mod quantity;

/// For [`alone`].
#[allow(dead_code, unreachable_pub)]
#[path = "../../src/expr/entries.rs"]
mod entries;

/// For [`alone`].
#[allow(dead_code, unreachable_pub)]
#[path = "../../src/expr/rational.rs"]
mod rational;

/// For [`alone`].
mod expr {
    pub(crate) use crate::entries::Entries;
    pub(crate) use crate::rational::Rational;
}
