//! What a computed value may look like, whatever construct it comes from.

use crate::expr::{Expr, Node, Number};
use crate::limits::EXPONENT;

/// The problem of a value, if there is one.
///
/// The symbolic core folds constants and collects exponents, so that a division by zero or an absurd power shows in the
/// outermost node.
pub(super) fn problem(scalar: Expr<'_>) -> Option<String> {
    let arena = scalar.arena();
    match arena.node(scalar.id()) {
        Node::Number(number) => not_finite(number),
        Node::Product(factors) => too_high(&factors),
        Node::Sum(sum) => {
            let terms = sum.terms.iter().find_map(|&(term, coefficient)| match arena.node(term) {
                Node::Product(factors) => not_finite(coefficient).or_else(|| too_high(&factors)),
                _ => not_finite(coefficient),
            });
            not_finite(sum.constant).or(terms)
        }
        _ => None,
    }
}

fn not_finite(number: Number) -> Option<String> {
    (!number.is_finite()).then(|| "this constant is too large or not a number".to_owned())
}

fn too_high<Factor>(factors: &[(Factor, i32)]) -> Option<String> {
    let highest = factors.iter().map(|(_, exponent)| exponent.unsigned_abs()).max()?;
    (highest > EXPONENT).then(|| format!("this holds a power of {highest}; the highest is {EXPONENT}"))
}
