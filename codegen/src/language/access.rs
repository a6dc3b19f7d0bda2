//! Components by name and by index.

use proc_macro2::{Delimiter, Group, Literal, TokenStream, TokenTree};
use quote::ToTokens;
use syn::{Expr, ExprField, ExprIndex, Member};

use super::lowering::Lowering;
use super::methods::has_method;
use super::value::{COMPONENTS, Element, Value};
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
                if has_method(&base, &written) {
                    return self.fail(name, format!("`{written}` is a method: write `.{written}(…)`"));
                }
                if let (Value::Integer(_), Expr::Lit(number)) = (&base, &*field.base) {
                    let number = number.to_token_stream();
                    return self.fail(
                        field,
                        format!("a number has a digit behind its point: `{number}.0{written}`"),
                    );
                }
                let by_number =
                    if let Value::Vector(_) = base { "; a component by its number is `[0]`" } else { "" };
                if names.is_empty() {
                    return self.fail(name, format!("{what} has no components of a name{by_number}"));
                }
                let known: Vec<&str> = names.iter().map(|(known, _)| known.as_str()).collect();
                let message = format!("{what} has no component `{written}`, but {}{by_number}", list(known));
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
            let of_axis = |element: &Element<'a>| {
                let n = element.group.representations().first()?.coordinates().len();
                Some(format!("; a column of its matrix is the image of an axis, as `g * Vector{n}::x()`"))
            };
            let hint = if let Value::Element(element) = &base { of_axis(element) } else { None };
            let message = format!("{} cannot be indexed{}", base.describe(), hint.unwrap_or_default());
            return self.fail(index, message);
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

/// The expression with coordinates that are taken by their own names, `momentum.r12`, taken by their numbers, as rustc
/// knows them: `momentum[0]`. `vectors` are given as they are written; names that nalgebra has for their components stay.
pub fn by_index(expr: &syn::Expr, vectors: &[(String, &[&str])]) -> syn::Expr {
    let mut is_changed = false;
    let tokens = with_indices(expr.to_token_stream(), vectors, &mut is_changed);
    let changed = is_changed.then(|| syn::parse2(tokens).ok()).flatten();
    changed.unwrap_or_else(|| expr.clone())
}

/// The same of tokens, as those of `vector![…]` are no expression yet.
fn with_indices(tokens: TokenStream, vectors: &[(String, &[&str])], is_changed: &mut bool) -> TokenStream {
    let mut done: Vec<TokenTree> = Vec::new();
    for token in tokens {
        let token = match token {
            TokenTree::Group(group) => {
                let inner = with_indices(group.stream(), vectors, is_changed);
                let mut copy = Group::new(group.delimiter(), inner);
                copy.set_span(group.span());
                TokenTree::Group(copy)
            }
            other => other,
        };
        let place = match (&token, done.as_slice()) {
            (TokenTree::Ident(name), [before @ .., TokenTree::Punct(dot)]) if dot.as_char() == '.' => {
                coordinate(before, &name.to_string(), vectors)
            }
            _ => None,
        };
        match place {
            Some(place) => {
                let mut index = Literal::usize_unsuffixed(place);
                index.set_span(token.span());
                let mut brackets = Group::new(Delimiter::Bracket, TokenTree::Literal(index).into());
                brackets.set_span(token.span());
                done.pop();
                done.push(TokenTree::Group(brackets));
                *is_changed = true;
            }
            None => done.push(token),
        }
    }
    done.into_iter().collect()
}

/// The number of the coordinate of this name, of the vector that these tokens end with.
fn coordinate(before: &[TokenTree], name: &str, vectors: &[(String, &[&str])]) -> Option<usize> {
    let is_dot = |token: &TokenTree| matches!(token, TokenTree::Punct(dot) if dot.as_char() == '.');
    let start = before.iter().rposition(|token| matches!(token, TokenTree::Ident(_)))?;
    let written: String = before[start..].iter().map(ToString::to_string).collect();
    let is_whole = start.checked_sub(1).is_none_or(|last| !is_dot(&before[last]));
    let (_, names) = vectors.iter().find(|(vector, _)| is_whole && *vector == written)?;
    let place = names.iter().position(|known| *known == name)?;
    (!component_names(names.len()).contains(&name)).then_some(place)
}

/// The names that nalgebra has for the components of a vector of this length.
fn component_names(length: usize) -> &'static [&'static str] {
    COMPONENTS.get(..length).unwrap_or(&[])
}

fn is_self(expr: &syn::Expr) -> bool {
    matches!(expr, syn::Expr::Path(path) if path.path.is_ident("self"))
}

/// The names of a value's components, with their places.
fn names(value: &Value<'_>) -> Vec<(String, (usize, usize))> {
    let named = |n: usize, place: fn(usize) -> (usize, usize)| {
        component_names(n).iter().enumerate().map(|(i, name)| ((*name).to_owned(), place(i))).collect()
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
