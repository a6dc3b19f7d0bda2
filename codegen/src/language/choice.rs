//! Comparisons, and choices by them.
//!
//! A truth is a number that is below zero where it is true. Differences are compared, so that there is one primitive:
//! [a choice](crate::expr::Node::Choice) by the sign of a number.

use quote::ToTokens;
use syn::{BinOp, ExprIf};

use super::lowering::Lowering;
use super::value::{Element, Value};
use crate::expr::{Arena, Expr, Vector};

/// The truth of what is known.
pub(super) fn known(arena: &Arena, truth: bool) -> Expr<'_> {
    arena.number(if truth { -1 } else { 1 })
}

/// Whether it is not so.
fn not(truth: Expr<'_>) -> Expr<'_> {
    let arena = truth.arena();
    truth.choose(known(arena, false), known(arena, true))
}

/// The lesser number.
pub(super) fn least<'a>(a: Expr<'a>, b: Expr<'a>) -> Expr<'a> {
    (b - a).choose(b, a)
}

/// The greater number.
pub(super) fn greatest<'a>(a: Expr<'a>, b: Expr<'a>) -> Expr<'a> {
    (a - b).choose(b, a)
}

impl<'a> Lowering<'a, '_> {
    /// `a < b`, `p && q`; `None` if it is another operator.
    pub(super) fn truth(
        &mut self,
        operator: &BinOp,
        left: &Option<Value<'a>>,
        right: &Option<Value<'a>>,
    ) -> Option<Option<Value<'a>>> {
        let (is_comparison, expected) = match operator {
            BinOp::Lt(_) | BinOp::Le(_) | BinOp::Gt(_) | BinOp::Ge(_) | BinOp::Eq(_) | BinOp::Ne(_) => {
                (true, "numbers are compared")
            }
            BinOp::And(_) | BinOp::Or(_) => (false, "this stands between conditions, such as `x < 1.0`"),
            _ => return None,
        };
        let (Some(left), Some(right)) = (left, right) else { return Some(None) };
        let operand = |value: &Value<'a>| match value {
            Value::Truth(truth) if !is_comparison => Some(*truth),
            value if is_comparison => value.as_scalar(self.arena),
            _ => None,
        };
        let (Some(a), Some(b)) = (operand(left), operand(right)) else {
            let (left, right) = (left.describe(), right.describe());
            return Some(self.fail(operator, format!("{expected}, but these are {left} and {right}")));
        };
        let both = |a: Expr<'a>, b: Expr<'a>| a.choose(b, known(self.arena, false));
        let equal = || both(not(a - b), not(b - a));
        Some(Some(Value::Truth(match operator {
            BinOp::Lt(_) => a - b,
            BinOp::Gt(_) => b - a,
            BinOp::Le(_) => not(b - a),
            BinOp::Ge(_) => not(a - b),
            BinOp::Eq(_) => equal(),
            BinOp::Ne(_) => not(equal()),
            BinOp::And(_) => both(a, b),
            _ => a.choose(known(self.arena, true), b),
        })))
    }

    /// `!p`
    pub(super) fn contrary(&mut self, value: Value<'a>, sign: impl ToTokens) -> Option<Value<'a>> {
        match value {
            Value::Truth(truth) => Some(Value::Truth(not(truth))),
            value => {
                let found = value.describe();
                self.fail(sign, format!("`!` is for conditions, such as `x < 1.0`; this is {found}"))
            }
        }
    }

    /// `if condition { … } else { … }`
    pub(super) fn choice(&mut self, choice: &ExprIf) -> Option<Value<'a>> {
        if let syn::Expr::Let(pattern) = &*choice.cond {
            return self.fail(pattern.let_token, "a condition compares numbers here, as in `if x < 1.0`");
        }
        let condition = self.lower(&choice.cond);
        let then = self.scoped_block(&choice.then_branch);
        let Some((_, otherwise)) = &choice.else_branch else {
            return self.fail(choice.if_token, "this `if` is a value, and needs an `else`");
        };
        let (condition, then, otherwise) = (condition?, then, self.lower(otherwise));
        let Value::Truth(condition) = condition else {
            let message = format!(
                "a condition compares numbers, as in `x < 1.0`, but this is {}",
                condition.describe()
            );
            return self.fail(&choice.cond, message);
        };
        let (then, otherwise) = (then?, otherwise?);
        chosen(condition, &then, &otherwise).or_else(|| {
            let (then, otherwise) = (then.describe(), otherwise.describe());
            self.fail(choice.if_token, format!("the values to choose from are {then} and {otherwise}"))
        })
    }
}

/// One value or the other, if they are of one kind.
fn chosen<'a>(condition: Expr<'a>, then: &Value<'a>, otherwise: &Value<'a>) -> Option<Value<'a>> {
    let arena = condition.arena();
    let entries = |a: &Vector<'a>, b: &Vector<'a>| {
        (a.len() == b.len()).then(|| a.zip(b, |a, b| condition.choose(a, b)))
    };
    let all = |a: &[Value<'a>], b: &[Value<'a>]| -> Option<Vec<Value<'a>>> {
        let values = a.iter().zip(b).map(|(a, b)| chosen(condition, a, b));
        (a.len() == b.len()).then(|| values.collect())?
    };
    Some(match (then, otherwise) {
        // of two integers one is known only where the condition is
        (Value::Integer(a), Value::Integer(b)) if a == b || condition.as_number().is_some() => {
            Value::Integer(if condition.as_number().is_some_and(|sign| sign.is_negative()) { *a } else { *b })
        }
        (Value::Truth(a), Value::Truth(b)) => Value::Truth(condition.choose(*a, *b)),
        (Value::Tuple(a), Value::Tuple(b)) => Value::Tuple(all(a, b)?),
        (Value::Array(a), Value::Array(b)) => Value::Array(all(a, b)?),
        (Value::Element(a), Value::Element(b)) if a.group.name() == b.group.name() => {
            Value::Element(Element { group: a.group, coordinates: entries(&a.coordinates, &b.coordinates)? })
        }
        (Value::Point(a), Value::Point(b)) => Value::Point(entries(a, b)?),
        (Value::Optional(a), Value::Optional(b)) => Value::Optional(Box::new(chosen(condition, a, b)?)),
        _ => match (then.as_scalar(arena), otherwise.as_scalar(arena)) {
            (Some(a), Some(b)) => Value::Scalar(condition.choose(a, b)),
            _ => {
                let (a, b) = (then.as_matrix()?, otherwise.as_matrix()?);
                let is_alike = (a.rows, a.columns) == (b.rows, b.columns);
                is_alike.then(|| Value::of_matrix(a.zip(&b, |a, b| condition.choose(a, b))))?
            }
        },
    })
}
