//! `+ - * /` and the sign, typed as Rust and nalgebra type them.

use quote::ToTokens;
use syn::{BinOp, Expr, ExprBinary, ExprUnary, UnOp};

use super::lowering::{Lowering, NO_REFERENCE};
use super::value::Value;
use crate::expr::Expr as Symbolic;

/// An operation that has a symbolic meaning.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Operation {
    Add,
    Subtract,
    Multiply,
    Divide,
}

impl Operation {
    fn of(operator: &BinOp) -> Option<Self> {
        match operator {
            BinOp::Add(_) => Some(Self::Add),
            BinOp::Sub(_) => Some(Self::Subtract),
            BinOp::Mul(_) => Some(Self::Multiply),
            BinOp::Div(_) => Some(Self::Divide),
            _ => None,
        }
    }

    fn scalars<'a>(self, left: Symbolic<'a>, right: Symbolic<'a>) -> Symbolic<'a> {
        match self {
            Self::Add => left + right,
            Self::Subtract => left - right,
            Self::Multiply => left * right,
            Self::Divide => left / right,
        }
    }

    /// Says that the operands do not go together.
    fn mismatch(self, left: &Value<'_>, right: &Value<'_>) -> String {
        let (left, right) = (left.describe(), right.describe());
        match self {
            Self::Add => format!("{right} cannot be added to {left}"),
            Self::Subtract => format!("{right} cannot be subtracted from {left}"),
            Self::Multiply => format!("{left} cannot be multiplied by {right}"),
            Self::Divide => format!("{left} cannot be divided by {right}"),
        }
    }
}

impl<'a> Lowering<'a, '_> {
    /// A chain of operators. Chains lean to the left and may be long, so that side is walked without recursion.
    pub(super) fn binary(&mut self, outermost: &ExprBinary) -> Option<Value<'a>> {
        let mut innermost = outermost;
        let mut chain = vec![outermost];
        while let Expr::Binary(inner) = &*innermost.left {
            innermost = inner;
            chain.push(inner);
        }
        let mut value = self.lower(&innermost.left);
        for link in chain.into_iter().rev() {
            let right = match is_power(link) {
                true => self.fail(link.op, NO_REFERENCE),
                false => self.lower(&link.right),
            };
            let Some(operation) = Operation::of(&link.op) else {
                value = match (&link.op, &value, &right) {
                    // as places in a ring of elements are told: `(i + 1) % 4`
                    (BinOp::Rem(sign), Some(Value::Integer(left)), Some(Value::Integer(right))) => {
                        let remainder = left.checked_rem(*right).map(Value::Integer);
                        remainder.or_else(|| self.fail(sign, "this divides by zero"))
                    }
                    _ => match self.truth(&link.op, &value, &right) {
                        Some(truth) => truth,
                        None => self.no_arithmetic(&link.op),
                    },
                };
                value = value.and_then(|value| self.checked(value, link));
                continue;
            };
            value = match (value, right) {
                (Some(left), Some(right)) => self.operate(operation, left, right, &link.op),
                _ => None,
            };
            value = value.and_then(|value| self.checked(value, link));
        }
        value
    }

    fn no_arithmetic(&mut self, operator: &BinOp) -> Option<Value<'a>> {
        match operator {
            BinOp::Rem(_) => self.steps(operator, "a remainder"),
            BinOp::BitXor(_) => {
                self.fail(operator, "`^` is not a power in Rust; write `x.powi(2)` or `x.powf(y)`")
            }
            BinOp::AddAssign(_) | BinOp::SubAssign(_) | BinOp::MulAssign(_) | BinOp::DivAssign(_) => {
                self.fail(operator, "assignments are not supported; give each value a name with `let`")
            }
            _ => self.unsupported(operator, "this operator"),
        }
    }

    /// What an operator, or a method in its place, makes of its operands.
    pub(super) fn operate(
        &mut self,
        operation: Operation,
        left: Value<'a>,
        right: Value<'a>,
        operator: &dyn ToTokens,
    ) -> Option<Value<'a>> {
        if let (Value::Integer(left), Value::Integer(right)) = (&left, &right) {
            return self.integers(operation, *left, *right, operator);
        }
        let divisor = right.as_scalar(self.arena).filter(|_| operation == Operation::Divide);
        if divisor.is_some_and(Symbolic::is_zero) {
            return self.fail(operator, "this divides by zero");
        }
        if let (Some(left), Some(right)) = (left.as_scalar(self.arena), right.as_scalar(self.arena)) {
            return Some(Value::Scalar(operation.scalars(left, right)));
        }
        let result = match operation {
            Operation::Add | Operation::Subtract => entrywise(operation, &left, &right),
            Operation::Multiply => self.product(&left, &right),
            Operation::Divide => divisor.and_then(|divisor| scaled(&left, divisor.recip())),
        };
        if let (Operation::Multiply, Value::Element(pose), Value::Vector(vector)) = (operation, &left, &right)
            && pose.moves_points()
        {
            return self.fail(operator, only_rotates(vector.len()));
        }
        if result.is_none() {
            let message = operation.mismatch(&left, &right) + &hint(operation, &left, &right);
            return self.fail(operator, message);
        }
        result
    }

    /// Integers are computed with as rustc does, so that exponents and indices mean what they say.
    fn integers(
        &mut self,
        operation: Operation,
        left: i64,
        right: i64,
        operator: &dyn ToTokens,
    ) -> Option<Value<'a>> {
        let result = match operation {
            Operation::Add => left.checked_add(right),
            Operation::Subtract => left.checked_sub(right),
            Operation::Multiply => left.checked_mul(right),
            Operation::Divide => {
                let message = format!(
                    "a division of integers drops the remainder; write `{left}.0 / {right}.0`, or the whole number"
                );
                return self.fail(operator, message);
            }
        };
        result.map(Value::Integer).or_else(|| self.fail(operator, "this integer is too large"))
    }

    fn product(&self, left: &Value<'a>, right: &Value<'a>) -> Option<Value<'a>> {
        if let Some(factor) = left.as_scalar(self.arena) {
            return scaled(right, factor);
        }
        if let Some(factor) = right.as_scalar(self.arena) {
            return scaled(left, factor);
        }
        if let Value::Element(element) = left {
            return element.times(right);
        }
        let (left, right) = (left.as_matrix()?, right.as_matrix()?);
        (left.columns == right.rows).then(|| Value::of_matrix(left.times_matrix(&right)))
    }

    pub(super) fn negated(&mut self, value: Value<'a>, sign: impl ToTokens) -> Option<Value<'a>> {
        match value {
            Value::Integer(integer) => {
                let negative = integer.checked_neg().map(Value::Integer);
                negative.or_else(|| self.fail(sign, "this integer is too large"))
            }
            Value::Scalar(scalar) => Some(Value::Scalar(-scalar)),
            Value::Vector(vector) => Some(Value::Vector(-&vector)),
            Value::Matrix(matrix) => Some(Value::Matrix(matrix.map(|entry| -entry))),
            value => self.fail(sign, format!("{} has no negative", value.describe())),
        }
    }
}

/// A vector or matrix times a scalar.
pub(super) fn scaled<'a>(value: &Value<'a>, factor: Symbolic<'a>) -> Option<Value<'a>> {
    match value {
        Value::Vector(vector) => Some(Value::Vector(vector.scale(factor))),
        Value::Matrix(matrix) => Some(Value::Matrix(matrix.scale(factor))),
        _ => None,
    }
}

/// A sum or difference of vectors or matrices of the same shape.
/// Whether `x ** y` is written, which is a product with what `y` refers to.
fn is_power(product: &ExprBinary) -> bool {
    let (BinOp::Mul(star), Expr::Unary(ExprUnary { op: UnOp::Deref(next), .. })) =
        (&product.op, &*product.right)
    else {
        return false;
    };
    let [star, next] = [star.spans[0].byte_range(), next.spans[0].byte_range()];
    !star.is_empty() && star.end == next.start
}

fn entrywise<'a>(operation: Operation, left: &Value<'a>, right: &Value<'a>) -> Option<Value<'a>> {
    match (left, right) {
        (Value::Vector(left), Value::Vector(right)) if left.len() == right.len() => {
            Some(Value::Vector(left.zip(right, |a, b| operation.scalars(a, b))))
        }
        (Value::Matrix(left), Value::Matrix(right))
            if (left.rows, left.columns) == (right.rows, right.columns) =>
        {
            Some(Value::Matrix(left.zip(right, |a, b| operation.scalars(a, b))))
        }
        (Value::Point(point), Value::Vector(vector)) if point.len() == vector.len() => {
            Some(Value::Point(point.zip(vector, |a, b| operation.scalars(a, b))))
        }
        (Value::Point(left), Value::Point(right))
            if left.len() == right.len() && operation == Operation::Subtract =>
        {
            Some(Value::Vector(left - right))
        }
        _ => None,
    }
}

/// The message on a rigid motion times a vector: nalgebra takes it for a direction, which is turned and not moved.
fn only_rotates(dimension: usize) -> String {
    format!(
        "`*` only turns a vector, as in nalgebra; write `pose.transform_vector(&v)` if that is meant, or \
         `pose.transform_point(&Point{dimension}::from(v))` for the place of a point of the body"
    )
}

/// What may have been meant instead.
fn hint(operation: Operation, left: &Value<'_>, right: &Value<'_>) -> String {
    match (operation, left, right) {
        (Operation::Multiply, Value::Vector(a), Value::Vector(b)) if a.len() == b.len() => match a.len() {
            3 => "; write `a.dot(&b)`, `a.cross(&b)` or `a.component_mul(&b)`".to_owned(),
            _ => "; write `a.dot(&b)` or `a.component_mul(&b)`".to_owned(),
        },
        (Operation::Multiply, Value::Vector(_), Value::Matrix(_)) => {
            "; a vector is a column and stands to the right of a matrix: `m * v`, or `m.tr_mul(&v)`"
                .to_owned()
        }
        (Operation::Divide, Value::Vector(a), Value::Vector(b)) if a.len() == b.len() => {
            "; write `a.component_div(&b)`".to_owned()
        }
        (Operation::Add | Operation::Subtract, Value::Scalar(_) | Value::Integer(_), Value::Vector(v))
        | (Operation::Add | Operation::Subtract, Value::Vector(v), Value::Scalar(_) | Value::Integer(_)) => {
            format!("; a vector with the scalar in every component is `Vector{}::repeat(s)`", v.len())
        }
        _ => String::new(),
    }
}
