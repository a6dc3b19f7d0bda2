//! Components by name and by index.

use syn::{ExprField, ExprIndex, Member};

use super::lowering::Lowering;
use super::value::{COMPONENTS, Value};
use crate::diagnostics::list;

impl<'a> Lowering<'a, '_> {
    /// `v.x`, `m.m12`, `pair.0`
    pub(super) fn field(&mut self, field: &ExprField) -> Option<Value<'a>> {
        if is_self(&field.base) {
            let message = "parameters are known by their names alone; leave out `self.`";
            return self.fail(field, message);
        }
        let base = self.lower(&field.base)?;
        match &field.member {
            Member::Named(name) => {
                let written = name.to_string();
                if let Value::Element(element) = &base {
                    let component = element.component(&written, false);
                    return component.or_else(|| self.fail(name, element.no_component(&written)));
                }
                let base = match (base, written.as_str()) {
                    (Value::Point(point), "coords") => return Some(Value::Vector(point)),
                    // nalgebra's translations are vectors with a name for it
                    (Value::Vector(vector), "vector") => return Some(Value::Vector(vector)),
                    (base, _) => base,
                };
                let names = names(&base);
                if let Some((_, place)) = names.iter().find(|(known, _)| *known == written) {
                    return at(&base, *place);
                }
                let what = base.describe();
                if names.is_empty() {
                    return self.fail(name, format!("{what} has no components"));
                }
                let known: Vec<&str> = names.iter().map(|(known, _)| known.as_str()).collect();
                let message = format!("{what} has no component `{written}`, but {}", list(known));
                self.fail(name, message)
            }
            Member::Unnamed(index) => match &base {
                Value::Tuple(values) => {
                    let value = values.get(index.index as usize).cloned();
                    value.or_else(|| self.fail(index, format!("{} ends before this", base.describe())))
                }
                Value::Vector(_) => {
                    self.fail(index, format!("write `[{}]` for a component by number", index.index))
                }
                _ => self.fail(index, format!("{} has no fields", base.describe())),
            },
        }
    }

    /// `v[i]`, `m[(i, j)]`
    pub(super) fn index(&mut self, index: &ExprIndex) -> Option<Value<'a>> {
        let base = self.lower(&index.expr);
        let place = self.lower(&index.index);
        let (base, place) = (base?, place?);
        let within = |i: i64, bound: usize| usize::try_from(i).ok().filter(|&i| i < bound);
        if let Value::Array(values) = &base {
            let Value::Integer(k) = place else {
                return self.fail(&index.index, "the index of an array is an integer that is known now");
            };
            let (n, last) = (values.len(), values.len().saturating_sub(1));
            let message = || format!("this index is out of range: an array of {n} has 0 to {last}");
            return within(k, n).map(|k| values[k].clone()).or_else(|| self.fail(&index.index, message()));
        }
        let Some(matrix) = base.as_matrix() else {
            return self.fail(index, format!("{} cannot be indexed", base.describe()));
        };
        let (rows, columns) = (matrix.rows, matrix.columns);
        let pair = match &place {
            Value::Tuple(pair) => pair.as_slice(),
            _ => &[],
        };
        let (place, range) = match (&place, pair) {
            // nalgebra counts the entries of a matrix by columns
            (Value::Integer(k), _) => {
                let place = within(*k, rows * columns).map(|k| (k % rows, k / rows));
                (place, format!("0 to {}", rows * columns - 1))
            }
            (_, [Value::Integer(i), Value::Integer(j)]) => {
                let place = within(*i, rows).zip(within(*j, columns));
                (place, format!("(0, 0) to ({}, {})", rows - 1, columns - 1))
            }
            _ => {
                let message = "an index is an integer, `v[0]`, or a pair of integers, `m[(0, 1)]`";
                return self.fail(&index.index, message);
            }
        };
        let message = || format!("this index is out of range: {} has {range}", base.describe());
        let entry = place.map(|(i, j)| Value::Scalar(matrix.at(i, j)));
        entry.or_else(|| self.fail(&index.index, message()))
    }
}

fn is_self(expr: &syn::Expr) -> bool {
    matches!(expr, syn::Expr::Path(path) if path.path.is_ident("self"))
}

/// The names of a value's components, with their places.
fn names(value: &Value<'_>) -> Vec<(String, (usize, usize))> {
    let named = |n: usize, place: fn(usize) -> (usize, usize)| {
        COMPONENTS.iter().take(n).enumerate().map(|(i, name)| ((*name).to_owned(), place(i))).collect()
    };
    match value {
        Value::Vector(vector) | Value::Point(vector) => named(vector.len(), |i| (i, 0)),
        Value::Matrix(matrix) if matrix.rows == 1 => named(matrix.columns, |j| (0, j)),
        Value::Matrix(matrix) if matrix.rows.max(matrix.columns) <= COMPONENTS.len() => {
            let places = (0..matrix.rows * matrix.columns).map(|k| (k / matrix.columns, k % matrix.columns));
            places.map(|(i, j)| (format!("m{}{}", i + 1, j + 1), (i, j))).collect()
        }
        _ => Vec::new(),
    }
}

fn at<'a>(value: &Value<'a>, (i, j): (usize, usize)) -> Option<Value<'a>> {
    match value {
        Value::Point(point) => Some(Value::Scalar(point.0[i])),
        _ => value.as_matrix().map(|matrix| Value::Scalar(matrix.at(i, j))),
    }
}
