//! Calls of functions by path, and macros: constructors of vectors and matrices, and methods written as functions.

use quote::ToTokens;
use syn::parse::{Parse, ParseStream};
use syn::punctuated::Punctuated;
use syn::{Expr, ExprCall, FnArg, Ident, Macro, Token, Type};

use super::lowering::Lowering;
use super::value::Value;
use crate::diagnostics::{count, list, suggestion};
use crate::expr::{Expr as Symbolic, Matrix, Number, Vector};
use crate::parse::{OF_NUMBERS, OwnFunction, of_segment, of_type, scalar_named, seen_from, shape_named};
use crate::quantity::Shape;

/// The constructors of vectors and matrices.
pub const CONSTRUCTORS: &[&str] = &[
    "new",
    "zeros",
    "repeat",
    "from_element",
    "identity",
    "from_diagonal",
    "from_diagonal_element",
    "x",
    "y",
    "z",
    "w",
];

/// The constructors of points.
pub const POINTS: &[&str] = &["new", "from", "origin"];

/// What is said of a function that is not known.
const UNKNOWN: &str = "this function is not known here; known are functions of `f64`, constructors such as `Vector3::new`, and functions of \
                       your own with `#[expression]` above them";

/// The dimension of nalgebra's points of that name.
fn point(name: &str) -> Option<usize> {
    match name {
        "Point2" => Some(2),
        "Point3" => Some(3),
        _ => None,
    }
}

/// A function by its path, `owner::name`.
#[derive(Clone, Copy)]
struct Path<'p> {
    name: &'p Ident,
    owner: &'p str,
}

/// Arguments, with the expressions that they are the values of.
type Given<'v, 'a> = &'v [(Value<'a>, &'v Expr)];

/// The rows of `matrix![…]`, or the one row of `vector![…]`.
struct Rows(Vec<Punctuated<Expr, Token![,]>>);

impl Parse for Rows {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let mut rows = Vec::new();
        while !input.is_empty() {
            let mut row = Punctuated::new();
            while !input.is_empty() && !input.peek(Token![;]) {
                row.push_value(input.parse()?);
                if !input.is_empty() && !input.peek(Token![;]) {
                    row.push_punct(input.parse()?);
                }
            }
            rows.push(row);
            input.parse::<Option<Token![;]>>()?;
        }
        Ok(Self(rows))
    }
}

impl<'a> Lowering<'a, '_> {
    /// `Vector3::new(…)`, `f64::sin(…)`, `Vector3::dot(…)`
    pub(super) fn call(&mut self, call: &ExprCall) -> Option<Value<'a>> {
        let arguments = self.all(&call.args);
        let Expr::Path(function) = &*call.func else {
            return self.unsupported(&call.func, "calling this");
        };
        let own = seen_from(self.within.last(), &function.path);
        let own = self.scope.functions.iter().find(|known| known.path == own).cloned();
        if let Some(own) = own {
            return self.own_function(own, call, arguments?);
        }
        let mut segments = function.path.segments.iter().rev();
        let (Some(name), Some(owner)) = (segments.next(), segments.next()) else {
            let name = function.to_token_stream().to_string();
            return match OF_NUMBERS.contains(&&*name) {
                true => self.fail(
                    &call.func,
                    format!("`{name}` is a method of numbers, as in `x.sin()` or `x.powi(2)`"),
                ),
                false => self.fail(&call.func, UNKNOWN),
            };
        };
        let owner_name = owner.ident.to_string();
        let path = Path { name: &name.ident, owner: &owner_name };
        if let Some(n) = point(&owner_name).filter(|_| function.qself.is_none()) {
            let arguments: Vec<(Value<'a>, &Expr)> = arguments?.into_iter().zip(&call.args).collect();
            return self.point(path, n, &arguments);
        }
        let scalar = scalar_named(&owner_name).is_some();
        let shape = shape_named(&owner_name).or_else(|| of_segment(owner).map(|(shape, _)| shape));
        let (Some(shape), None) = (if scalar { Some(Shape::Scalar) } else { shape }, &function.qself) else {
            return self.fail(&call.func, UNKNOWN);
        };
        let arguments: Vec<(Value<'a>, &Expr)> = arguments?.into_iter().zip(&call.args).collect();
        match path.name.to_string().as_str() {
            "from" if scalar => self.converted(path.name, &arguments),
            constructor if !scalar && CONSTRUCTORS.contains(&constructor) => {
                self.constructor(path, shape, &arguments)
            }
            _ => self.function(path, shape, &arguments),
        }
    }

    /// `density(position.z)`: as if it was written out here.
    fn own_function(
        &mut self,
        function: OwnFunction,
        call: &ExprCall,
        arguments: Vec<Value<'a>>,
    ) -> Option<Value<'a>> {
        let OwnFunction { path, signature, body } = function;
        let name = &signature.ident;
        if arguments.len() != signature.inputs.len() {
            let takes = count(signature.inputs.len(), "argument");
            return self.fail(&call.func, format!("`{name}` takes {takes}, not {}", arguments.len()));
        }
        if self.within.contains(&path) {
            return self.fail(&call.func, format!("`{name}` calls itself, which has no end here"));
        }
        let outside = std::mem::take(&mut self.locals);
        self.within.push(path);
        for ((input, value), argument) in signature.inputs.iter().zip(arguments).zip(&call.args) {
            let FnArg::Typed(input) = input else { continue };
            let ty = match &*input.ty {
                Type::Reference(reference) => &reference.elem,
                ty => ty,
            };
            let shape = of_type(ty).map(|(shape, _)| shape);
            let fits = shape.is_none_or(|shape| value.shape() == Some(shape));
            if !fits {
                let (expected, found) = (shape.map(Shape::describe).unwrap_or_default(), value.describe());
                self.diagnostics
                    .push(argument, format!("`{name}` takes {expected} here, but this is {found}"));
            }
            self.bind(&input.pat, Some(value).filter(|_| fits));
        }
        let value = self.scoped_block(&body);
        self.within.pop();
        self.locals = outside;
        value
    }

    /// `f64::from(integer)`
    fn converted(&mut self, name: &Ident, arguments: Given<'_, 'a>) -> Option<Value<'a>> {
        match arguments {
            [(Value::Integer(integer), _)] => Some(Value::Scalar(self.arena.number(Number::from(*integer)))),
            [(_, expr)] => self.fail(expr, "only integers can be converted; this needs no conversion"),
            _ => self.fail(name, "`from` takes one integer"),
        }
    }

    /// A method written as a function, with the receiver in front.
    fn function(&mut self, path: Path<'_>, shape: Shape, arguments: Given<'_, 'a>) -> Option<Value<'a>> {
        let Path { name, owner } = path;
        let Some(((receiver, expr), rest)) = arguments.split_first() else {
            if shape == Shape::Scalar {
                return self.fail(name, format!("`{owner}::{name}` has no symbolic meaning here"));
            }
            let guess = suggestion(&name.to_string(), CONSTRUCTORS);
            return self.fail(name, format!("there is no `{owner}::{name}` here{guess}"));
        };
        if receiver.shape() != Some(shape) {
            let (expected, found) = (shape.describe(), receiver.describe());
            return self.fail(expr, format!("`{owner}::{name}` takes {expected} first, but this is {found}"));
        }
        // an integer in place of a float is left to rustc
        let receiver = match receiver.as_scalar(self.arena) {
            Some(scalar) => Value::Scalar(scalar),
            None => receiver.clone(),
        };
        self.method(name, &receiver, rest)
    }

    fn constructor(&mut self, path: Path<'_>, shape: Shape, arguments: Given<'_, 'a>) -> Option<Value<'a>> {
        let Path { name, owner } = path;
        let (rows, columns) = match shape {
            Shape::Matrix(rows, columns) => (rows, columns),
            _ => (shape.size(), 1),
        };
        let what = name.to_string();
        let expected = match what.as_str() {
            "new" => rows * columns,
            "repeat" | "from_element" | "from_diagonal" | "from_diagonal_element" => 1,
            _ => 0,
        };
        if arguments.len() != expected {
            let takes = count(expected, "argument");
            let message = format!("`{owner}::{what}` takes {takes}, not {}", arguments.len());
            return self.fail(name, message);
        }
        let (zero, one) = (self.arena.zero(), self.arena.one());
        let filled = |entry: &dyn Fn(usize, usize) -> Symbolic<'a>| {
            Some(Value::of_matrix(Matrix::from_fn(rows, columns, entry)))
        };
        let diagonal = |entry: Symbolic<'a>| filled(&|i, j| if i == j { entry } else { zero });
        match (what.as_str(), arguments) {
            ("new", _) => {
                let entries = self.scalars(arguments)?;
                Some(Value::of_matrix(Matrix::new(rows, columns, entries)))
            }
            ("zeros", _) => filled(&|_, _| zero),
            ("identity", _) => diagonal(one),
            ("from_diagonal", [(Value::Vector(vector), _)]) if rows == columns && vector.len() == rows => {
                Some(Value::of_matrix(Matrix::diagonal(vector)))
            }
            ("from_diagonal", [(other, expr)]) => {
                let (n, found) = (rows.min(columns), other.describe());
                self.fail(
                    expr,
                    format!("`{owner}::from_diagonal` takes a vector of {n}, but this is {found}"),
                )
            }
            ("from_diagonal_element", _) => diagonal(*self.scalars(arguments)?.first()?),
            ("repeat" | "from_element", _) => {
                let entry = *self.scalars(arguments)?.first()?;
                filled(&|_, _| entry)
            }
            // a unit vector along an axis
            (axis, _) => match ["x", "y", "z", "w"].iter().position(|known| *known == axis) {
                Some(k) if columns == 1 && k < rows => filled(&|i, _| if i == k { one } else { zero }),
                _ => {
                    let known = list(CONSTRUCTORS);
                    self.fail(name, format!("there is no `{owner}::{what}` here; known: {known}"))
                }
            },
        }
    }

    /// `Point3::from(v)`, `Point3::new(x, y, z)`, `Point3::origin()`
    fn point(&mut self, path: Path<'_>, n: usize, arguments: Given<'_, 'a>) -> Option<Value<'a>> {
        let Path { name, owner } = path;
        match (name.to_string().as_str(), arguments) {
            ("from", [(Value::Vector(vector), _)]) if vector.len() == n => Some(Value::Point(vector.clone())),
            ("from", [(other, expr)]) => {
                let found = other.describe();
                self.fail(expr, format!("`{owner}::from` takes a vector of {n}, but this is {found}"))
            }
            ("new", _) if arguments.len() == n => Some(Value::Point(Vector(self.scalars(arguments)?))),
            ("new", _) => {
                let takes = count(n, "argument");
                self.fail(name, format!("`{owner}::new` takes {takes}, not {}", arguments.len()))
            }
            ("origin", []) => Some(Value::Point(Vector::zeros(self.arena, n))),
            _ => {
                let guess = suggestion(&name.to_string(), POINTS);
                self.fail(name, format!("there is no `{owner}::{name}` here{guess}"))
            }
        }
    }

    /// `vector![…]`, `matrix![…]`
    pub(super) fn macro_call(&mut self, call: &Macro) -> Option<Value<'a>> {
        let name = call.path.segments.last().map(|segment| segment.ident.to_string()).unwrap_or_default();
        if name != "vector" && name != "matrix" {
            let message = "the only macros with a symbolic meaning are `vector!` and `matrix!`";
            return self.fail(&call.path, message);
        }
        let Rows(rows) = call.parse_body().map_err(|error| self.diagnostics.absorb(error)).ok()?;
        let columns = rows.first().map_or(0, Punctuated::len);
        if columns == 0 {
            return self.fail(&call.path, format!("this `{name}!` is empty"));
        }
        if let Some(odd) = rows.iter().find(|row| row.len() != columns) {
            let message =
                format!("this row has {}, but the first has {columns}", count(odd.len(), "component"));
            return if odd.is_empty() { self.fail(&call.path, message) } else { self.fail(odd, message) };
        }
        if name == "vector" && rows.len() > 1 {
            return self.fail(&rows[1], "a vector has one row of components; for rows there is `matrix!`");
        }
        let cells: Vec<&Expr> = rows.iter().flatten().collect();
        let values = self.all(cells.iter().copied())?;
        let entries = self.scalars(&values.into_iter().zip(cells).collect::<Vec<_>>())?;
        Some(match name.as_str() {
            "vector" => Value::Vector(Vector(entries)),
            _ => Value::of_matrix(Matrix::new(rows.len(), columns, entries)),
        })
    }

    /// Values that must all be scalars.
    fn scalars(&mut self, values: &[(Value<'a>, &Expr)]) -> Option<Vec<Symbolic<'a>>> {
        let scalar = |(value, expr): &(Value<'a>, &Expr)| {
            let message = || format!("this entry must be a scalar, but it is {}", value.describe());
            value.as_scalar(self.arena).or_else(|| self.fail(expr, message()))
        };
        let scalars: Vec<Option<Symbolic<'a>>> = values.iter().map(scalar).collect();
        scalars.into_iter().collect()
    }
}
