//! Arrays and iterators, unrolled: what is said of each element is lowered for each.

use syn::{
    AngleBracketedGenericArguments, Expr, ExprClosure, ExprMethodCall, ExprRange, GenericArgument, Ident,
    RangeLimits, Type,
};

use super::lowering::Lowering;
use super::operators::Operation;
use super::value::Value;
use crate::diagnostics::suggestion;
use crate::expr::{Matrix, Vector};
use crate::limits;
use crate::parse::of_segment;
use crate::quantity::Shape;

/// The methods of arrays, as they are called.
pub const ARRAY_METHODS: [&str; 6] =
    ["len()", "iter()", "into_iter()", "windows(n)", "map(|x| …)", "spline(from, to, x)"];

/// Those of iterators.
pub const ITERATOR_METHODS: [&str; 9] = [
    "map(|x| …)",
    "sum::<f64>()",
    "zip(other)",
    "enumerate()",
    "rev()",
    "skip(n)",
    "take(n)",
    "copied()",
    "cloned()",
];

impl<'a> Lowering<'a, '_> {
    /// `0..3`, `0..=2`: the integers that it goes through.
    pub(super) fn range(&mut self, range: &ExprRange) -> Option<Value<'a>> {
        let (Some(start), Some(end)) = (&range.start, &range.end) else {
            return self.fail(range, "a range needs both its ends here, as in `0..3`");
        };
        let values = (self.lower(start), self.lower(end));
        let (Value::Integer(from), Value::Integer(to)) = (values.0?, values.1?) else {
            return self.fail(range, "the ends of a range are integers that are known now, as in `0..3`");
        };
        let to = match range.limits {
            RangeLimits::HalfOpen(_) => Some(to),
            RangeLimits::Closed(_) => to.checked_add(1),
        };
        let length = to.and_then(|to| to.checked_sub(from)).unwrap_or(i64::MAX).max(0);
        if length > limits::RANGE {
            return self.fail(range, format!("a range has {} integers at most here", limits::RANGE));
        }
        Some(Value::Iterator((0..length).map(|k| Value::Integer(from + k)).collect()))
    }

    /// A method of an array or an iterator.
    pub(super) fn sequence_method(
        &mut self,
        call: &ExprMethodCall,
        receiver: &Value<'a>,
    ) -> Option<Value<'a>> {
        let (Value::Array(values) | Value::Iterator(values)) = receiver else { return None };
        let name = call.method.to_string();
        if let Some(turbofish) = call.turbofish.as_ref().filter(|_| name != "sum") {
            return self.fail(turbofish, "leave out the types");
        }
        let arguments: Vec<&Expr> = call.args.iter().collect();
        let values: Vec<Value<'a>> = match (receiver, name.as_str(), arguments.as_slice()) {
            (Value::Array(_), "map", [Expr::Closure(closure)]) => {
                return self.mapped(values, closure).map(Value::Array);
            }
            (_, "map", [Expr::Closure(closure)]) => self.mapped(values, closure)?,
            (_, "map", [other]) => {
                return self.fail(other, "`map` takes a closure here, as in `map(|x| …)`");
            }
            (_, "clone", []) => return Some(receiver.clone()),
            (_, "len", []) => return Some(Value::Integer(values.len() as i64)),
            (_, "into_iter", [])
            | (Value::Array(_), "iter", [])
            | (Value::Iterator(_), "copied" | "cloned", []) => values.clone(),
            (Value::Array(_), "windows", [length]) => match self.count(length)? {
                0 => return self.fail(length, "a window has one element or more"),
                length => values.windows(length).map(|window| Value::Array(window.to_vec())).collect(),
            },
            (Value::Array(_), "spline", &[from, to, x]) => {
                return self.spline(values, [from, to, x], &call.method);
            }
            (Value::Iterator(_), "sum", []) => return self.sum(values, call),
            (Value::Iterator(_), "rev", []) => values.iter().rev().cloned().collect(),
            (Value::Iterator(_), "skip", [count]) => {
                values.iter().skip(self.count(count)?).cloned().collect()
            }
            (Value::Iterator(_), "take", [count]) => {
                values.iter().take(self.count(count)?).cloned().collect()
            }
            (Value::Iterator(_), "enumerate", []) => {
                let pair = |(k, value): (usize, &Value<'a>)| {
                    Value::Tuple(vec![Value::Integer(k as i64), value.clone()])
                };
                values.iter().enumerate().map(pair).collect()
            }
            (Value::Iterator(_), "zip", [other]) => match self.lower(other)? {
                Value::Array(others) | Value::Iterator(others) => {
                    let pairs = values.iter().cloned().zip(others);
                    pairs.map(|(value, other)| Value::Tuple(vec![value, other])).collect()
                }
                found => {
                    let found = found.describe();
                    let message = format!("`zip` takes an iterator or an array, but this is {found}");
                    return self.fail(other, message);
                }
            },
            _ => return self.no_such_method(&call.method, receiver),
        };
        Some(Value::Iterator(values))
    }

    /// An argument that is a number of elements.
    fn count(&mut self, argument: &Expr) -> Option<usize> {
        match self.lower(argument)? {
            Value::Integer(count) if count >= 0 => Some(count as usize),
            _ => self.fail(argument, "this is a number of elements, an integer that is known now"),
        }
    }

    /// What a closure makes of each value. A problem in it is said once.
    fn mapped(&mut self, values: &[Value<'a>], closure: &ExprClosure) -> Option<Vec<Value<'a>>> {
        let [pattern] = closure.inputs.iter().collect::<Vec<_>>()[..] else {
            return self.fail(closure, "this closure takes one argument; several in one are `|(a, b)| …`");
        };
        if let Some(attribute) = closure.attrs.first() {
            return self.fail(attribute, "attributes are not supported in expressions");
        }
        if let Some(asyncness) = &closure.asyncness {
            return self.unsupported(asyncness, "this closure");
        }
        let mut images = Vec::with_capacity(values.len());
        self.iterations += 1;
        let mapped = values.iter().try_for_each(|value| {
            let (outside, before) = (self.locals.len(), self.diagnostics.len());
            self.bind(pattern, Some(value.clone()));
            let image = self.lower(&closure.body);
            self.locals.truncate(outside);
            images.push(image.filter(|_| self.diagnostics.len() == before)?);
            Some(())
        });
        self.iterations -= 1;
        mapped.map(|()| images)
    }

    /// The sum of numbers, vectors or matrices. Of nothing it is zero where it is one of many, as in `(0..i).map(…)`
    /// for several `i`.
    fn sum(&mut self, values: &[Value<'a>], call: &ExprMethodCall) -> Option<Value<'a>> {
        let method = &call.method;
        let Some((first, rest)) = values.split_first() else {
            let zero = call.turbofish.as_ref().and_then(|types| self.zero(types));
            let zero = zero.filter(|_| self.iterations > 0);
            return zero.or_else(|| self.fail(method, "there is nothing to sum: this has no elements"));
        };
        if first.shape().is_none() {
            return self.fail(method, format!("{} cannot be added to another", first.describe()));
        }
        let mut sum = first.clone();
        for value in rest {
            sum = self.operate(Operation::Add, sum, value.clone(), method)?;
            sum = self.checked(sum, method)?;
        }
        Some(sum)
    }

    /// The zero of a type, if that is known.
    fn zero(&self, types: &AngleBracketedGenericArguments) -> Option<Value<'a>> {
        let Some(GenericArgument::Type(Type::Path(path))) = types.args.first() else { return None };
        let segment = path.path.segments.last()?;
        if segment.ident == "usize" || segment.ident == "i32" {
            return Some(Value::Integer(0));
        }
        let zero = self.arena.zero();
        Some(match of_segment(segment)?.0 {
            Shape::Scalar => Value::Scalar(zero),
            Shape::Vector(n) => Value::Vector(Vector::zeros(self.arena, n)),
            Shape::Matrix(rows, columns) => {
                Value::of_matrix(Matrix::new(rows, columns, vec![zero; rows * columns]))
            }
        })
    }

    fn no_such_method(&mut self, method: &Ident, receiver: &Value<'a>) -> Option<Value<'a>> {
        let known = match receiver {
            Value::Array(_) => &ARRAY_METHODS[..],
            _ => &ITERATOR_METHODS[..],
        };
        let (name, what) = (method.to_string(), receiver.describe());
        let plain = |call: &&'static str| call.split(['(', ':']).next().unwrap_or_default();
        if let Some(call) = known.iter().find(|call| plain(call) == name) {
            return self.fail(method, format!("write `{call}`"));
        }
        let of_iterators = ITERATOR_METHODS.iter().find(|call| plain(call) == name);
        if let (Value::Array(_), Some(call)) = (receiver, of_iterators) {
            return self.fail(method, format!("{what} has no method `{name}`; write `.iter().{call}`"));
        }
        let names: Vec<&str> = known.iter().map(plain).collect();
        self.fail(method, format!("{what} has no method `{name}` here{}", suggestion(&name, &names)))
    }
}
