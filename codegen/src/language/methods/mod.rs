//! Methods: one table for each kind of value, which is also what messages list.

mod element;
mod scalar;
mod tensor;

use syn::{Expr, ExprMethodCall, Ident};

use super::lowering::Lowering;
use super::value::Value;
use crate::diagnostics::{Diagnostics, count, list, nearest};
use crate::expr::{Arena, Expr as Symbolic, Matrix};

/// A method that has a symbolic meaning.
pub(super) struct Method {
    name: &'static str,
    /// How many arguments it takes beside the receiver.
    arguments: usize,
    apply: for<'a> fn(&mut Call<'_, 'a>) -> Option<Value<'a>>,
}

/// A method call whose operands are known.
struct Call<'c, 'a> {
    arena: &'a Arena,
    diagnostics: &'c mut Diagnostics,
    method: &'c Ident,
    receiver: &'c Value<'a>,
    arguments: &'c [(Value<'a>, &'c Expr)],
}

impl<'a> Lowering<'a, '_> {
    /// `receiver.method(arguments)`
    pub(super) fn method_call(&mut self, call: &ExprMethodCall) -> Option<Value<'a>> {
        let receiver = self.lower(&call.receiver);
        let arguments = self.all(&call.args);
        if let Some(turbofish) = &call.turbofish {
            return self.fail(turbofish, "leave out the types");
        }
        let arguments: Vec<(Value<'a>, &Expr)> = arguments?.into_iter().zip(&call.args).collect();
        self.method(&call.method, &receiver?, &arguments)
    }

    /// Applies the method of that name to a receiver.
    pub(super) fn method(
        &mut self,
        method: &Ident,
        receiver: &Value<'a>,
        arguments: &[(Value<'a>, &Expr)],
    ) -> Option<Value<'a>> {
        let name = method.to_string();
        if name == "clone" && arguments.is_empty() {
            return Some(receiver.clone());
        }
        let methods: &[Method] = match receiver {
            Value::Scalar(_) => scalar::METHODS,
            Value::Vector(_) => tensor::VECTOR_METHODS,
            Value::Matrix(_) => tensor::MATRIX_METHODS,
            Value::Integer(_) => {
                return self.fail(
                    method,
                    "methods of integers are not supported; write the number as a float, `2.0`",
                );
            }
            Value::Element(element) => {
                if let (Some(value), []) = (element.component(&name, true), arguments) {
                    return Some(value);
                }
                element::METHODS
            }
            Value::Tuple(_) => return self.fail(method, format!("{} has no methods", receiver.describe())),
        };
        let Some(known) = methods.iter().find(|known| known.name == name) else {
            return self.unknown(method, receiver, methods);
        };
        if arguments.len() != known.arguments {
            let takes = count(known.arguments, "argument");
            let message = format!("`{name}` takes {takes}, not {}", arguments.len());
            return self.fail(method, message);
        }
        let (arena, diagnostics) = (self.arena, &mut *self.diagnostics);
        (known.apply)(&mut Call { arena, diagnostics, method, receiver, arguments })
    }

    fn unknown(&mut self, method: &Ident, receiver: &Value<'a>, methods: &[Method]) -> Option<Value<'a>> {
        let name = method.to_string();
        if NOT_SMOOTH.contains(&name.as_str()) {
            return self.not_smooth(method, &format!("`{name}`"));
        }
        let mut names: Vec<&str> = methods.iter().map(|known| known.name).collect();
        if let Value::Element(element) = receiver {
            let components = element.group.components().iter();
            names.extend(components.filter(|component| component.called).map(|component| component.name));
        }
        let guess = match nearest(&name, &names) {
            Some(near) => format!("; did you mean `{near}`?"),
            None => ".".to_owned(),
        };
        let (what, known) = (receiver.describe(), list(names));
        let message = format!("{what} has no method `{name}` here{guess} Its methods are {known}");
        self.fail(method, message)
    }
}

/// Methods that Rust or nalgebra have and whose derivatives jump.
const NOT_SMOOTH: &[&str] = &[
    "abs",
    "amax",
    "amin",
    "ceil",
    "clamp",
    "copysign",
    "div_euclid",
    "floor",
    "fract",
    "iamax",
    "icamax",
    "imax",
    "imin",
    "inf",
    "lp_norm",
    "max",
    "min",
    "rem_euclid",
    "round",
    "signum",
    "sup",
    "trunc",
];

impl<'a> Call<'_, 'a> {
    fn fail<T>(&mut self, tokens: impl quote::ToTokens, message: String) -> Option<T> {
        self.diagnostics.push(tokens, message);
        None
    }

    /// An argument that must be a scalar.
    fn scalar(&mut self, index: usize) -> Option<Symbolic<'a>> {
        let (value, expr) = &self.arguments[index];
        let scalar = value.as_scalar(self.arena);
        match scalar {
            Some(scalar) => Some(scalar),
            None => self.fail(
                expr,
                format!("`{}` takes a scalar here, but this is {}", self.method, value.describe()),
            ),
        }
    }

    /// An argument that must be an integer known now.
    fn integer(&mut self, index: usize, otherwise: &str) -> Option<i64> {
        match &self.arguments[index] {
            (Value::Integer(integer), _) => Some(*integer),
            (_, expr) => self.fail(expr, format!("`{}` takes an integer literal{otherwise}", self.method)),
        }
    }

    /// An argument that must be of the receiver's shape.
    fn like_receiver(&mut self, index: usize) -> Option<Matrix<'a>> {
        let (value, expr) = &self.arguments[index];
        if value.shape() == self.receiver.shape() {
            return value.as_matrix();
        }
        let (expected, found) = (self.receiver.describe(), value.describe());
        self.fail(
            expr,
            format!("`{}` takes {expected} here, as its receiver is, but this is {found}", self.method),
        )
    }
}
