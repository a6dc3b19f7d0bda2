//! Methods: one table for each kind of value, which is also what messages list.

mod element;
mod scalar;
mod tensor;

use syn::{AngleBracketedGenericArguments, Expr, ExprLit, ExprMethodCall, GenericArgument, Ident, Lit};

use super::lowering::Lowering;
use super::value::Value;
use crate::diagnostics::{Diagnostics, count, list, nearest};
use crate::expr::{Arena, Expr as Symbolic, Matrix};

/// A method that has a symbolic meaning.
pub(super) struct Method {
    name: &'static str,
    /// The arguments that it takes beside the receiver, as a reader would call them.
    arguments: &'static [&'static str],
    apply: for<'a> fn(&mut Call<'_, 'a>) -> Option<Value<'a>>,
}

/// A row of a table.
const fn method(
    name: &'static str,
    arguments: &'static [&'static str],
    apply: for<'a> fn(&mut Call<'_, 'a>) -> Option<Value<'a>>,
) -> Method {
    Method { name, arguments, apply }
}

/// A method call whose operands are known.
struct Call<'c, 'a> {
    arena: &'a Arena,
    diagnostics: &'c mut Diagnostics,
    method: &'c Ident,
    receiver: &'c Value<'a>,
    arguments: &'c [(Value<'a>, &'c Expr)],
}

impl Method {
    /// As it is called: `dot(&other)`.
    fn call(&self) -> String {
        format!("{}({})", self.name, self.arguments.join(", "))
    }
}

/// The methods of each kind of value as they are called, for documentation.
pub fn methods() -> [(&'static str, Vec<String>); 4] {
    let all = [
        ("numbers", scalar::METHODS),
        ("vectors", tensor::VECTOR_METHODS),
        ("matrices", tensor::MATRIX_METHODS),
        ("configurations", element::METHODS),
    ];
    all.map(|(what, methods)| (what, methods.iter().map(Method::call).collect()))
}

/// The methods of numbers, or of vectors or matrices of them.
fn methods_of(receiver: &Value<'_>) -> &'static [Method] {
    match receiver {
        Value::Scalar(_) => scalar::METHODS,
        Value::Vector(_) => tensor::VECTOR_METHODS,
        Value::Matrix(_) => tensor::MATRIX_METHODS,
        _ => &[],
    }
}

/// Whether a value has a method of this name.
pub(super) fn has_method(receiver: &Value<'_>, name: &str) -> bool {
    methods_of(receiver).iter().any(|known| known.name == name)
}

impl<'a> Lowering<'a, '_> {
    /// `receiver.method(arguments)`
    pub(super) fn method_call(&mut self, call: &ExprMethodCall) -> Option<Value<'a>> {
        let receiver = self.lower(&call.receiver);
        if let Some(Value::Optional(value)) = receiver {
            return self.unwrapped(call, *value);
        }
        if let Some(Value::Array(_) | Value::Iterator(_)) = receiver {
            return self.sequence_method(call, &receiver?);
        }
        // a closure has a meaning for each element of something alone
        let is_closure = |argument: &&Expr| matches!(argument, Expr::Closure(_));
        let arguments = self.all(call.args.iter().filter(|argument| !is_closure(argument)));
        if call.args.iter().any(|argument| is_closure(&argument)) {
            let what = receiver?.describe();
            let message = format!("{what} has no method `{}` here that takes a closure", call.method);
            return self.fail(&call.method, message);
        }
        if let Some(turbofish) = &call.turbofish {
            return self.block_of_matrix(&call.method, turbofish, &receiver?, &arguments?);
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
        let owned = matches!(receiver, Value::Vector(_) | Value::Matrix(_))
            && (name == "into_owned" || name == "clone_owned");
        if (name == "clone" || owned) && arguments.is_empty() {
            return Some(receiver.clone());
        }
        let methods: &[Method] = match receiver {
            Value::Scalar(_) | Value::Vector(_) | Value::Matrix(_) => methods_of(receiver),
            Value::Integer(_) => {
                let message = "methods of integers are not supported; write the number as a float, `2.0`";
                return self.fail(method, message);
            }
            Value::Element(element) => {
                if let (Some(value), []) = (element.component(&name, true), arguments) {
                    return Some(value);
                }
                element::METHODS
            }
            _ => {
                return self.fail(method, format!("{} has no methods", receiver.describe()));
            }
        };
        let Some(known) = methods.iter().find(|known| known.name == name) else {
            return self.unknown(method, receiver, methods);
        };
        if arguments.len() != known.arguments.len() {
            let takes = count(known.arguments.len(), "argument");
            let message = format!("`{name}` takes {takes}, not {}", arguments.len());
            return self.fail(method, message);
        }
        let (arena, diagnostics) = (self.arena, &mut *self.diagnostics);
        (known.apply)(&mut Call { arena, diagnostics, method, receiver, arguments })
    }

    /// `.unwrap()` and `.expect("…")`: what is not there is a number that is not finite, which a step refuses.
    fn unwrapped(&mut self, call: &ExprMethodCall, value: Value<'a>) -> Option<Value<'a>> {
        let (method, arguments) = (&call.method, call.args.len());
        match (method.to_string().as_str(), arguments) {
            ("unwrap", 0) | ("expect", 1) => Some(value),
            (known @ ("unwrap" | "expect"), _) => {
                let takes = if known == "unwrap" { "no argument" } else { "a message" };
                self.fail(method, format!("`{method}` takes {takes}"))
            }
            _ => {
                let what = value.describe();
                self.fail(
                    method,
                    format!("an option of {what} is taken with `.unwrap()` or `.expect(\"…\")`"),
                )
            }
        }
    }

    /// `.fixed_rows::<R>(i)`, `.fixed_columns::<C>(j)`, `.fixed_view::<R, C>(i, j)`
    fn block_of_matrix(
        &mut self,
        method: &Ident,
        turbofish: &AngleBracketedGenericArguments,
        receiver: &Value<'a>,
        arguments: &[Value<'a>],
    ) -> Option<Value<'a>> {
        let sizes: Option<Vec<i64>> = turbofish.args.iter().map(size).collect();
        let Some(matrix) = receiver.as_matrix() else { return self.fail(turbofish, "leave out the types") };
        let (whole_rows, whole_columns) = (matrix.rows as i64, matrix.columns as i64);
        let (rows, columns) = match (method.to_string().as_str(), sizes.as_deref(), arguments) {
            ("fixed_rows", Some(&[rows]), &[Value::Integer(i)]) => ((i, rows), (0, whole_columns)),
            ("fixed_columns", Some(&[columns]), &[Value::Integer(j)]) => ((0, whole_rows), (j, columns)),
            ("fixed_view", Some(&[rows, columns]), &[Value::Integer(i), Value::Integer(j)]) => {
                ((i, rows), (j, columns))
            }
            ("fixed_rows" | "fixed_columns" | "fixed_view", _, _) => {
                let message = "write `fixed_rows::<R>(i)`, `fixed_columns::<C>(j)` or `fixed_view::<R, C>(i, j)`, with integers";
                return self.fail(method, message);
            }
            _ => return self.fail(turbofish, "leave out the types"),
        };
        let within = |(start, length): (i64, i64), bound: i64| {
            let end = start.checked_add(length)?;
            (start >= 0 && length > 0 && end <= bound).then_some(start as usize..end as usize)
        };
        let (Some(rows), Some(columns)) = (within(rows, whole_rows), within(columns, whole_columns)) else {
            return self.fail(method, format!("this goes beyond {}", receiver.describe()));
        };
        let entries =
            rows.clone().flat_map(|i| columns.clone().map(move |j| (i, j))).map(|(i, j)| matrix.at(i, j));
        Some(Value::of_matrix(Matrix::new(rows.len(), columns.len(), entries.collect())))
    }

    fn unknown(&mut self, method: &Ident, receiver: &Value<'a>, methods: &[Method]) -> Option<Value<'a>> {
        let name = method.to_string();
        if STEPS.contains(&name.as_str()) {
            return self.steps(method, &format!("`{name}`"));
        }
        let mut names: Vec<&str> = methods.iter().map(|known| known.name).collect();
        if let Value::Element(element) = receiver {
            let components = element.group.names().components.iter();
            names.extend(components.filter(|component| component.called).map(|component| component.name));
        }
        let what = receiver.describe();
        // `cos_angle` of what has no `cos`
        let longer =
            names.iter().find(|known| known.strip_prefix(&*name).is_some_and(|rest| rest.starts_with('_')));
        let near = longer.copied().or_else(|| nearest(&name, &names));
        let of_numbers = scalar::METHODS.iter().find(|known| known.name == name);
        let rest = match (near, receiver, of_numbers) {
            (Some(near), ..) => format!("; did you mean `{near}`?"),
            (None, Value::Vector(_), Some(known)) => {
                format!("; it is one of numbers, such as the component `.x`: write `.x.{}`", known.call())
            }
            (None, Value::Vector(_) | Value::Matrix(_), _) if name.starts_with("fixed_") => {
                "; write `fixed_rows::<3>(0)` for three rows from the first on".to_owned()
            }
            _ => format!(". Its methods are {}", list(names)),
        };
        self.fail(method, format!("{what} has no method `{name}` here{rest}"))
    }
}

/// The integer in a generic argument.
fn size(argument: &GenericArgument) -> Option<i64> {
    match argument {
        GenericArgument::Const(Expr::Lit(ExprLit { lit: Lit::Int(size), .. })) => size.base10_parse().ok(),
        _ => None,
    }
}

/// Methods of Rust whose values jump at whole numbers.
pub const STEPS: &[&str] = &["ceil", "div_euclid", "floor", "fract", "rem_euclid", "round", "trunc"];

impl<'a> Call<'_, 'a> {
    fn fail<T>(&mut self, tokens: impl quote::ToTokens, message: impl std::fmt::Display) -> Option<T> {
        self.diagnostics.fail(tokens, message)
    }

    /// An argument that must be a scalar.
    fn scalar(&mut self, index: usize) -> Option<Symbolic<'a>> {
        let (value, expr) = &self.arguments[index];
        let message = || format!("`{}` takes a scalar here, but this is {}", self.method, value.describe());
        value.as_scalar(self.arena).or_else(|| self.diagnostics.fail(expr, message()))
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
        let (method, expected, found) = (self.method, self.receiver.describe(), value.describe());
        self.fail(expr, format!("`{method}` takes {expected} here, as its receiver is, but this is {found}"))
    }
}
