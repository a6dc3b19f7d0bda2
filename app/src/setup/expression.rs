//! Expressions of a user's own, in the language of descriptions: ordinary Rust over numbers, vectors and matrices, by the
//! names of a system's quantities.

use std::borrow::Cow;
use std::ops::Range;

use coadjoint::erased::System;
use coadjoint::system::{Kind, Quantity, Role};
use nalgebra::{DMatrix, Quaternion, UnitQuaternion};
use syn::punctuated::Punctuated;
use syn::{BinOp, Expr, Lit, Member, Token, UnOp};

use super::names::velocity;
use crate::catalogue::quantities::{component_name, component_unit, components};
use crate::catalogue::suggest::did_you_mean;
use crate::catalogue::{Entry, Observable, unit};
use crate::error::SetupError;

/// A number, a vector of one column, or a matrix.
type Value = DMatrix<f64>;
/// What an expression is evaluated at.
struct At<'a> {
    system: &'a dyn System,
    state: &'a [f64],
    time: f64,
    control: &'a [f64],
}
type Evaluated = Result<Value, String>;
type Compiled = Box<dyn Fn(&At<'_>) -> Evaluated + Send + Sync>;

type Unary = fn(f64) -> f64;
type Binary = fn(f64, f64) -> f64;

/// Functions of one number, and of two.
const UNARY: &[(&str, Unary)] = &[
    ("abs", f64::abs),
    ("acos", f64::acos),
    ("asin", f64::asin),
    ("atan", f64::atan),
    ("cbrt", f64::cbrt),
    ("ceil", f64::ceil),
    ("cos", f64::cos),
    ("cosh", f64::cosh),
    ("exp", f64::exp),
    ("floor", f64::floor),
    ("ln", f64::ln),
    ("log10", f64::log10),
    ("recip", f64::recip),
    ("round", f64::round),
    ("signum", f64::signum),
    ("sin", f64::sin),
    ("sinh", f64::sinh),
    ("sqrt", f64::sqrt),
    ("tan", f64::tan),
    ("tanh", f64::tanh),
    ("to_degrees", f64::to_degrees),
    ("to_radians", f64::to_radians),
];
const BINARY: &[(&str, Binary)] = &[
    ("atan2", f64::atan2),
    ("hypot", f64::hypot),
    ("max", f64::max),
    ("min", f64::min),
    ("powf", f64::powf),
    ("powi", f64::powf),
];
/// Functions of vectors and matrices, and how many arguments they take besides.
const LINEAR: [(&str, usize); 14] = [
    ("angle", 0),
    ("component_div", 1),
    ("component_mul", 1),
    ("cos_angle", 0),
    ("cross", 1),
    ("determinant", 0),
    ("dot", 1),
    ("inverse", 0),
    ("norm", 0),
    ("norm_squared", 0),
    ("normalize", 0),
    ("sin_angle", 0),
    ("trace", 0),
    ("transpose", 0),
];

/// With more brackets and operators an expression could be nested too deeply for a stack.
const MOST_SIGNS: usize = 60;

/// Reads a quantity of a user's own: `EXPRESSION`, `NAME = EXPRESSION` or `NAME, UNIT = EXPRESSION`.
///
/// # Errors
/// If it is no expression, has names or functions that are not known, or is no number.
pub(crate) fn observable(entry: &Entry, text: &str) -> Result<Observable, SetupError> {
    let wrong = |reason: String| SetupError::new(format!("`{text}`: {reason}"));
    let is_sign = |at: usize| !text[at + 1..].starts_with('=') && !text[..at].ends_with(['<', '>', '!', '=']);
    let sign = text.match_indices('=').map(|(at, _)| at).find(|&at| is_sign(at));
    let (name, body) = sign.map_or((text, text), |at| (&text[..at], &text[at + 1..]));
    let (name, own_unit) = match sign.and(name.split_once(',')) {
        Some((name, unit)) => (name.trim(), Some(unit.trim().to_owned())),
        None => (name.trim(), None),
    };
    if name.is_empty() {
        return Err(wrong("a name stands before `=`".to_owned()));
    }
    if sign.is_some() && name.contains(char::is_whitespace) {
        return Err(wrong(
            "a name is one word, and behind it may stand a comma and a unit: `height, m = …`".to_owned(),
        ));
    }
    if body.matches(|letter| "([{-+*/!&|<>.".contains(letter)).count() > MOST_SIGNS {
        return Err(wrong(format!("an expression has at most {MOST_SIGNS} brackets and operators")));
    }
    let expression: Expr = syn::parse_str(body).map_err(|error| match error.to_string() {
        reason if reason.starts_with("cannot parse") => {
            wrong("a bracket or a sign has no counterpart".to_owned())
        }
        reason => wrong(reason),
    })?;
    let compiled = compiled(entry, &expression).map_err(wrong)?;
    // shapes are the same in every state
    let example = &entry.example;
    let system = entry.system(&example.parameters);
    let control = vec![0.0; example.controls.len()];
    let number = move |system: &dyn System, state: &[f64], time: f64, control: &[f64]| {
        let value = compiled(&At { system, state, time, control })?;
        match value.shape() {
            (1, 1) => Ok(value[0]),
            (rows, 1) => {
                Err(format!("a number is asked for, and this is a vector of {rows}: take `.norm()`, or `.x`"))
            }
            (rows, columns) => {
                Err(format!("a number is asked for, and this is a matrix of {rows} × {columns}"))
            }
        }
    };
    number(&*system, &example.state, 0.0, &control).map_err(wrong)?;
    let unit = own_unit.unwrap_or_else(|| unit_of(entry, &expression).unwrap_or_default());
    // a component of the state alone is read, in no time
    let components_of = |quantities| components(quantities).filter(|own| own.name == body.trim());
    let others = [entry.description.parameters, entry.description.controls];
    let is_state = others.iter().all(|others| components_of(others).next().is_none());
    if let Some(own) = components_of(entry.description.state).next().filter(|_| is_state) {
        let slot = own.slot;
        return Ok(Observable::new(name, unit, move |_, state, _, _| state[slot]));
    }
    let of = move |system: &dyn System, state: &[f64], time: f64, control: &[f64]| {
        number(system, state, time, control).unwrap_or(f64::NAN)
    };
    Ok(Observable::new(name, unit, of))
}

/// Reads quantities of a user's own, each of another name.
///
/// # Errors
/// As [`observable`], or if two have one name.
pub(crate) fn observables(entry: &Entry, texts: &[String]) -> Result<Vec<Observable>, SetupError> {
    let own = texts.iter().map(|text| observable(entry, text)).collect::<Result<Vec<_>, _>>()?;
    let is_second = |&k: &usize| own[..k].iter().any(|before| before.name == own[k].name);
    match (0..own.len()).find(is_second) {
        Some(k) => Err(SetupError::new(format!("there are two quantities `{}`", own[k].name))),
        None => Ok(own),
    }
}

/// Reads a condition: a quantity that is 1 where it holds and 0 elsewhere.
///
/// # Errors
/// As [`observable`], or if it is no comparison.
pub(crate) fn condition(entry: &Entry, text: &str) -> Result<Observable, SetupError> {
    let own = observable(entry, text)?;
    match own.name == text.trim() && syn::parse_str(text).is_ok_and(|of| is_truth(&of)) {
        true => Ok(own),
        false => Err(SetupError::new(format!(
            "`{text}` is no condition: write a comparison, as in `energy < 0.5`"
        ))),
    }
}

/// Reads how far a condition is from its contrary: a quantity that is positive where it holds, negative where it does not, and
/// continuous where what is compared is.
///
/// # Errors
/// As [`condition`].
pub(crate) fn margin(entry: &Entry, text: &str) -> Result<Observable, SetupError> {
    condition(entry, text)?;
    let wrong = |reason: String| SetupError::new(format!("`{text}`: {reason}"));
    let expression: Expr = syn::parse_str(text).map_err(|error| wrong(error.to_string()))?;
    let margin = distance(entry, &expression).map_err(wrong)?;
    let of = move |system: &dyn System, state: &[f64], time: f64, control: &[f64]| {
        margin(&At { system, state, time, control }).map_or(f64::NAN, |value| value[0])
    };
    Ok(Observable::new(text, String::new(), of))
}

/// How far a condition is from its contrary.
fn distance(entry: &Entry, expression: &Expr) -> Result<Compiled, String> {
    let both = |left: &Expr, right: &Expr, of: Binary| -> Result<Compiled, String> {
        let (left, right) = (distance(entry, left)?, distance(entry, right)?);
        Ok(Box::new(move |at| numbers("`&&`", &left(at)?, &right(at)?, of)))
    };
    let difference = |large: &Expr, small: &Expr| -> Result<Compiled, String> {
        let (large, small) = (compiled(entry, large)?, compiled(entry, small)?);
        Ok(Box::new(move |at| sum(large(at)?, -small(at)?)))
    };
    match expression {
        Expr::Paren(inner) => distance(entry, &inner.expr),
        Expr::Unary(inner) => {
            let of = distance(entry, &inner.expr)?;
            Ok(Box::new(move |at| Ok(-of(at)?)))
        }
        Expr::Binary(binary) => match binary.op {
            BinOp::And(_) => both(&binary.left, &binary.right, f64::min),
            BinOp::Or(_) => both(&binary.left, &binary.right, f64::max),
            BinOp::Lt(_) | BinOp::Le(_) => difference(&binary.right, &binary.left),
            _ => difference(&binary.left, &binary.right),
        },
        _ => compiled(entry, expression),
    }
}

/// Whether an expression says that something holds.
fn is_truth(expression: &Expr) -> bool {
    match expression {
        Expr::Paren(inner) => is_truth(&inner.expr),
        Expr::Unary(unary) => matches!(unary.op, UnOp::Not(_)) && is_truth(&unary.expr),
        Expr::Binary(binary) => match binary.op {
            BinOp::And(_) | BinOp::Or(_) => is_truth(&binary.left) && is_truth(&binary.right),
            operator => matches!(operator, BinOp::Lt(_) | BinOp::Le(_) | BinOp::Gt(_) | BinOp::Ge(_)),
        },
        _ => false,
    }
}

/// The unit of an expression, where it is that of a quantity in it.
fn unit_of(entry: &Entry, expression: &Expr) -> Option<String> {
    let quantities = || [entry.description.parameters, entry.description.state, entry.description.controls];
    match expression {
        Expr::Path(path) => {
            let name = path.path.get_ident()?.to_string();
            let whole = quantities().into_iter().flatten().find(|quantity| quantity.name == name).map(unit);
            let all = || quantities().into_iter().flat_map(components);
            let component = || all().find(|component| component.name == name).map(|component| component.unit);
            let own = || Some(entry.observables.iter().find(|own| own.name == name)?.unit.as_str());
            let energy = (name == "energy").then_some(entry.energy_unit);
            energy.or(whole).or_else(component).or_else(own).map(str::to_owned)
        }
        Expr::Paren(inner) => unit_of(entry, &inner.expr),
        Expr::Unary(inner) => unit_of(entry, &inner.expr),
        Expr::Reference(inner) => unit_of(entry, &inner.expr),
        Expr::Field(field) => match (&*field.base, &field.member) {
            (Expr::Path(path), Member::Named(component)) => {
                let name = path.path.get_ident()?.to_string();
                let quantity = quantities().into_iter().flatten().find(|quantity| quantity.name == name)?;
                let place = quantity.components.iter().position(|known| component == known)?;
                Some(component_unit(quantity, place).to_owned())
            }
            _ => None,
        },
        Expr::MethodCall(call) if call.method == "norm" || call.method == "abs" => {
            unit_of(entry, &call.receiver)
        }
        Expr::Binary(both) if matches!(both.op, BinOp::Add(_) | BinOp::Sub(_)) => {
            let unit = unit_of(entry, &both.left);
            unit.filter(|unit| unit_of(entry, &both.right).as_ref() == Some(unit))
        }
        _ => None,
    }
}

fn number(value: f64) -> Value {
    Value::from_element(1, 1, value)
}

fn compiled(entry: &Entry, expression: &Expr) -> Result<Compiled, String> {
    let compiled = |expression: &Expr| compiled(entry, expression);
    match expression {
        Expr::Paren(inner) => compiled(&inner.expr),
        Expr::Group(inner) => compiled(&inner.expr),
        Expr::Reference(inner) if !matches!(*inner.expr, Expr::Reference(_)) => compiled(&inner.expr),
        Expr::Lit(literal) => {
            let value: f64 = match &literal.lit {
                Lit::Float(value) => value.base10_parse(),
                Lit::Int(value) => value.base10_parse(),
                _ => return Err("expressions are of numbers".to_owned()),
            }
            .map_err(|error| error.to_string())?;
            Ok(Box::new(move |_| Ok(number(value))))
        }
        Expr::Path(path) => match (path.path.get_ident(), path.path.segments.last()) {
            (None, Some(last)) if constant(&last.ident.to_string()).is_none() => {
                Err(format!("there is no constant `{}`", last.ident))
            }
            (_, last) => named(entry, &last.map(|last| last.ident.to_string()).unwrap_or_default()),
        },
        Expr::Unary(unary) => {
            let of = compiled(&unary.expr)?;
            match unary.op {
                UnOp::Neg(_) => Ok(Box::new(move |at| Ok(-of(at)?))),
                UnOp::Not(_) => {
                    Ok(Box::new(move |at| numbers("`!`", &of(at)?, &number(0.0), |a, b| f64::from(a == b))))
                }
                _ => Err("`*` stands between two factors; a power is `.powi(2)`".to_owned()),
            }
        }
        Expr::Binary(binary) => {
            let (left, right) = (compiled(&binary.left)?, compiled(&binary.right)?);
            type Logical = fn(f64, f64) -> bool;
            let logical: Logical = match binary.op {
                BinOp::Lt(_) => |a, b| a < b,
                BinOp::Le(_) => |a, b| a <= b,
                BinOp::Gt(_) => |a, b| a > b,
                BinOp::Ge(_) => |a, b| a >= b,
                BinOp::And(_) => |a, b| a != 0.0 && b != 0.0,
                BinOp::Or(_) => |a, b| a != 0.0 || b != 0.0,
                BinOp::Add(_) => return Ok(Box::new(move |at| sum(left(at)?, right(at)?))),
                BinOp::Sub(_) => return Ok(Box::new(move |at| sum(left(at)?, -right(at)?))),
                BinOp::Mul(_) => return Ok(Box::new(move |at| product(left(at)?, right(at)?))),
                BinOp::Div(_) => return Ok(Box::new(move |at| quotient(left(at)?, right(at)?))),
                BinOp::BitXor(_) => return Err("a power is `.powi(2)`".to_owned()),
                _ => return Err("operators are + - * / and, of numbers, < <= > >= && ||".to_owned()),
            };
            Ok(Box::new(move |at| {
                numbers("comparison", &left(at)?, &right(at)?, |a, b| f64::from(logical(a, b)))
            }))
        }
        Expr::Field(field) => {
            let Member::Named(component) = &field.member else {
                return Err("a component has a name, or stands in brackets: `v[0]`".to_owned());
            };
            let component = component.to_string();
            let place = ["x", "y", "z", "w", "a", "b"].iter().position(|known| *known == component);
            element(entry, &field.base, component, place.map(|place| (place, None)))
        }
        Expr::Index(index) => {
            let place = match &*index.index {
                Expr::Tuple(both) if both.elems.len() == 2 => {
                    whole(&both.elems[0]).zip(whole(&both.elems[1]).map(Some))
                }
                one => whole(one).map(|place| (place, None)),
            };
            let (row, column) = place.ok_or("an index is a whole number, or two of a matrix: `m[(0, 1)]`")?;
            let name = column.map_or(row.to_string(), |column| format!("{row}, {column}"));
            element(entry, &index.expr, name, place)
        }
        Expr::MethodCall(call) => {
            let arguments = std::iter::once(&*call.receiver).chain(&call.args);
            called(&call.method.to_string(), arguments.map(compiled).collect::<Result<_, _>>()?)
        }
        Expr::Call(call) => match &*call.func {
            Expr::Path(path) => {
                let name = path.path.segments.last().map(|last| last.ident.to_string()).unwrap_or_default();
                called(&name, call.args.iter().map(compiled).collect::<Result<_, _>>()?)
            }
            _ => Err("only functions can be called".to_owned()),
        },
        Expr::Macro(call) if call.mac.path.is_ident("vector") => {
            let parser = Punctuated::<Expr, Token![,]>::parse_terminated;
            let entries = call.mac.parse_body_with(parser).map_err(|error| error.to_string())?;
            let entries = entries.iter().map(compiled).collect::<Result<Vec<_>, _>>()?;
            Ok(Box::new(move |at| {
                let entries = entries.iter().map(|entry| entry(at)).collect::<Result<Vec<_>, String>>()?;
                match entries.is_empty() || entries.iter().any(|entry| entry.len() != 1) {
                    true => Err("`vector![…]` is made of numbers".to_owned()),
                    false => Ok(Value::from_iterator(entries.len(), 1, entries.iter().map(|entry| entry[0]))),
                }
            }))
        }
        _ => {
            Err("expressions are made of names, numbers, + - * /, functions, `.x` and `vector![…]`"
                .to_owned())
        }
    }
}

/// The whole number that is written there.
fn whole(expression: &Expr) -> Option<usize> {
    match expression {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Int(value) => value.base10_parse().ok(),
            _ => None,
        },
        _ => None,
    }
}

/// An element of a quantity, by the names of tables, or of any vector or matrix by its row, and of a matrix its column.
fn element(
    entry: &Entry,
    of: &Expr,
    component: String,
    place: Option<(usize, Option<usize>)>,
) -> Result<Compiled, String> {
    let own = match of {
        Expr::Path(path) => path.path.get_ident().map(|name| format!("{name}_{component}")),
        _ => None,
    };
    if let Some(of) = own.and_then(|name| named(entry, &name).ok()) {
        return Ok(of);
    }
    let of = compiled(entry, of)?;
    Ok(Box::new(move |at| {
        let value = of(at)?;
        let is_there = |&(_, column): &(usize, Option<usize>)| column.is_some() || value.ncols() == 1;
        let known = place.filter(is_there).and_then(|(row, column)| value.get((row, column.unwrap_or(0))));
        known.copied().map(number).ok_or_else(|| format!("there is no component `{component}`"))
    }))
}

/// The value of a constant.
fn constant(name: &str) -> Option<f64> {
    let constants =
        [("PI", std::f64::consts::PI), ("TAU", std::f64::consts::TAU), ("E", std::f64::consts::E)];
    constants.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

/// Finds what a name stands for.
fn named(entry: &Entry, name: &str) -> Result<Compiled, String> {
    type List = for<'a> fn(&At<'a>) -> Cow<'a, [f64]>;
    if let Some(value) = constant(name) {
        return Ok(Box::new(move |_| Ok(number(value))));
    }
    match name {
        "t" => return Ok(Box::new(|at| Ok(number(at.time)))),
        "energy" => return Ok(Box::new(|at| Ok(number(at.system.energy(at.state, at.time, at.control))))),
        _ => {}
    }
    if let Some(own) = entry.observables.iter().find(|own| own.name == name) {
        let own = own.clone();
        return Ok(Box::new(move |at| Ok(number(own.value(at.system, at.state, at.time, at.control)))));
    }
    let description = &entry.description;
    let lists: [(&'static [Quantity], List); 3] = [
        (description.parameters, |at| at.system.parameters().into()),
        (description.state, |at| at.state.into()),
        (description.controls, |at| at.control.into()),
    ];
    for (quantities, list) in lists {
        if let Some((quantity, slots)) =
            Quantity::with_ranges(quantities).find(|(known, _)| known.name == name)
        {
            let kind = quantity.kind;
            if matches!(kind, Kind::RigidMotion2 | Kind::RigidMotion3) {
                let parts: Vec<_> =
                    quantity.components.iter().map(|part| component_name(quantity, part)).collect();
                return Err(format!("take the components of `{name}`: {}", parts.join(", ")));
            }
            return Ok(Box::new(move |at| Ok(matrix(kind, &part(&list(at), slots.clone())))));
        }
        if let Some(component) = components(quantities).find(|component| component.name == name) {
            let slot = component.slot;
            return Ok(Box::new(move |at| Ok(number(list(at).get(slot).copied().unwrap_or(0.0)))));
        }
    }
    let momenta = || description.state.iter().filter(|quantity| quantity.role == Role::Momentum);
    for quantity in momenta() {
        let mut slots = quantity.tangent();
        let is_it = |part: &&str| velocity(&component_name(quantity, part)) == name;
        if let Some(part) = quantity.components.iter().position(is_it) {
            slots = slots.start + part..slots.start + part + 1;
        } else if velocity(quantity.name) != name {
            continue;
        }
        return Ok(Box::new(move |at| {
            let velocities = at.system.differential(at.state, at.time, at.control);
            Ok(Value::from_column_slice(slots.len(), 1, &part(&velocities, slots.clone())))
        }));
    }
    let velocities: Vec<String> = momenta().map(|quantity| velocity(quantity.name)).collect();
    let whole = lists.into_iter().flat_map(|(quantities, _)| quantities).map(|quantity| quantity.name);
    let own = entry.observables.iter().map(|own| own.name.as_str());
    let velocities = velocities.iter().map(String::as_str);
    let known: Vec<&str> = ["t", "energy"].into_iter().chain(whole).chain(velocities).chain(own).collect();
    let parts =
        lists.into_iter().flat_map(|(quantities, _)| components(quantities).map(|component| component.name));
    let parts: Vec<String> = parts.collect();
    let hint = did_you_mean(name, known.iter().copied().chain(parts.iter().map(String::as_str)));
    Err(format!(
        "there is no quantity `{name}` of `{}`{hint} ({}, and their components)",
        entry.name,
        known.join(", ")
    ))
}

/// A part of some numbers; what is missing counts as zero.
fn part(numbers: &[f64], slots: Range<usize>) -> Vec<f64> {
    slots.map(|slot| numbers.get(slot).copied().unwrap_or(0.0)).collect()
}

/// The numbers of a quantity, of a rotation its matrix.
fn matrix(kind: Kind, numbers: &[f64]) -> Value {
    match (kind, numbers) {
        (Kind::UnitQuaternion, &[w, x, y, z]) => {
            let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)).to_rotation_matrix();
            Value::from_column_slice(3, 3, rotation.matrix().as_slice())
        }
        (Kind::UnitComplex, &[re, im]) => Value::from_row_slice(2, 2, &[re, -im, im, re]),
        (Kind::SymmetricMatrix(rows), _) => Value::from_row_slice(rows, rows, numbers),
        (Kind::Matrix(rows, columns), _) => Value::from_row_slice(rows, columns, numbers),
        _ => Value::from_column_slice(numbers.len(), 1, numbers),
    }
}

/// Says that something is not defined.
fn shapes(what: &str, a: &Value, b: &Value) -> String {
    let words = |value: &Value| match value.shape() {
        (1, 1) => "a number".to_owned(),
        (rows, 1) => format!("a vector of {rows}"),
        (rows, columns) => format!("a matrix of {rows} × {columns}"),
    };
    // of rotations
    let is_rotation = |value: &Value| [(2, 2), (3, 3)].contains(&value.shape());
    let hint = if is_rotation(a) || is_rotation(b) { "; the angle of a rotation is `.angle()`" } else { "" };
    format!("there is no {what} of {} and {}{hint}", words(a), words(b))
}

fn numbers(what: &str, a: &Value, b: &Value, of: impl Fn(f64, f64) -> f64) -> Evaluated {
    if (a.len(), b.len()) == (1, 1) { Ok(number(of(a[0], b[0]))) } else { Err(shapes(what, a, b)) }
}

fn sum(a: Value, b: Value) -> Evaluated {
    if a.shape() == b.shape() { Ok(a + b) } else { Err(shapes("sum", &a, &b)) }
}

fn product(a: Value, b: Value) -> Evaluated {
    match (a.len(), b.len()) {
        (1, _) => Ok(b * a[0]),
        (_, 1) => Ok(a * b[0]),
        _ if a.ncols() == b.nrows() => Ok(a * b),
        _ => Err(shapes("product", &a, &b)),
    }
}

fn quotient(a: Value, b: Value) -> Evaluated {
    if b.len() == 1 { Ok(a / b[0]) } else { Err(shapes("quotient", &a, &b)) }
}

/// Calls a function with its arguments, the first of which may stand before it.
fn called(name: &str, arguments: Vec<Compiled>) -> Result<Compiled, String> {
    if let Some(&(name, of)) = UNARY.iter().find(|(known, _)| *known == name) {
        let [argument] = exactly(name, arguments)?;
        return Ok(Box::new(move |at| match argument(at)? {
            value if value.len() == 1 => Ok(number(of(value[0]))),
            _ => Err(format!("`{name}` is a function of a number")),
        }));
    }
    if let Some(&(name, of)) = BINARY.iter().find(|(known, _)| *known == name) {
        let [first, second] = exactly(name, arguments)?;
        return Ok(Box::new(move |at| match (first(at)?, second(at)?) {
            (_, power) if name == "powi" && power.len() == 1 && power[0].fract() != 0.0 => {
                Err("`powi` takes a whole number; `powf` takes any".to_owned())
            }
            (first, second) => numbers(&format!("`{name}`"), &first, &second, of),
        }));
    }
    let Some(&(name, count)) = LINEAR.iter().find(|(known, _)| *known == name) else {
        let all = UNARY
            .iter()
            .map(|of| of.0)
            .chain(BINARY.iter().map(|of| of.0))
            .chain(LINEAR.iter().map(|of| of.0));
        let all: Vec<&str> = all.collect();
        let hint = did_you_mean(name, all.iter().copied());
        return Err(format!("there is no function `{name}`{hint} ({})", all.join(", ")));
    };
    if count == 1 {
        let [first, second] = exactly(name, arguments)?;
        return Ok(Box::new(move |at| of_two(name, &first(at)?, &second(at)?)));
    }
    let [argument] = exactly(name, arguments)?;
    Ok(Box::new(move |at| of_one(name, argument(at)?)))
}

fn exactly<const N: usize>(name: &str, arguments: Vec<Compiled>) -> Result<[Compiled; N], String> {
    let count = arguments.len();
    arguments
        .try_into()
        .map_err(|_| format!("`{name}` takes {N} arguments with what it is called on, not {count}"))
}

fn of_two(name: &str, a: &Value, b: &Value) -> Evaluated {
    let alike = a.shape() == b.shape();
    match name {
        "dot" if alike => Ok(number(a.dot(b))),
        "cross" if alike && a.shape() == (3, 1) => Ok(a.cross(b)),
        "component_mul" if alike => Ok(a.component_mul(b)),
        "component_div" if alike => Ok(a.component_div(b)),
        _ => Err(shapes(&format!("`{name}`"), a, b)),
    }
}

fn of_one(name: &str, of: Value) -> Evaluated {
    let is_square = of.is_square();
    // of a rotation in the plane, or in space
    let sine_and_cosine = || match of.shape() {
        (2, 2) => Ok((of[(1, 0)], of[(0, 0)])),
        (3, 3) => {
            let axis = [of[(2, 1)] - of[(1, 2)], of[(0, 2)] - of[(2, 0)], of[(1, 0)] - of[(0, 1)]];
            Ok((axis.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0, (of.trace() - 1.0) / 2.0))
        }
        _ => Err(format!("`{name}` is a function of a rotation")),
    };
    match name {
        "norm" => Ok(number(of.norm())),
        "norm_squared" => Ok(number(of.norm_squared())),
        "normalize" => Ok(of.normalize()),
        "transpose" => Ok(of.transpose()),
        "trace" if is_square => Ok(number(of.trace())),
        "determinant" if is_square => Ok(number(of.determinant())),
        "inverse" if is_square => of.try_inverse().ok_or_else(|| "a matrix has no inverse".to_owned()),
        "angle" => sine_and_cosine().map(|(sine, cosine)| number(sine.atan2(cosine))),
        "sin_angle" => sine_and_cosine().map(|(sine, _)| number(sine)),
        "cos_angle" => sine_and_cosine().map(|(_, cosine)| number(cosine)),
        _ => Err(format!("`{name}` is a function of a square matrix")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::catalogue;

    fn value(system: &str, text: &str) -> Result<f64, String> {
        let entry = catalogue().system(system).expect("it is there");
        let own = observable(entry, text).map_err(|error| error.to_string())?;
        // attitude about z by a right angle, momentum (1, 2, 3), gamma (0, 0.6, 0.8); or an angle and a momentum
        let half = 0.5_f64.sqrt();
        let state: &[f64] = match system {
            "heavy_top" => &[half, 0.0, 0.0, half, 1.0, 2.0, 3.0, 0.0, 0.6, 0.8],
            _ => &[0.6, 0.8, -0.25],
        };
        Ok(own.value(&*entry.system(&entry.example.parameters), state, 2.5, &[7.0]))
    }

    #[test]
    fn expressions_are_evaluated_as_descriptions_are() {
        for (text, expected) in [
            ("momentum.norm()", 14_f64.sqrt()),
            ("L = momentum.norm_squared()", 14.0),
            ("norm(momentum) / 2", 14_f64.sqrt() / 2.0),
            ("momentum_z - momentum.x * 2.0 + gamma.y.powi(2)", 1.36),
            ("momentum.dot(&gamma)", 3.6),
            ("momentum.cross(&gamma).x", 2.0 * 0.8 - 3.0 * 0.6),
            ("(attitude * momentum).x", -2.0),
            ("(attitude.inverse() * vector![0, 1, 0]).x", 1.0),
            ("attitude.angle().to_degrees()", 90.0),
            ("attitude.w + attitude_z", 2_f64.sqrt()),
            ("weight * gamma.dot(&chi)", 0.8),
            ("energy - 0.5 * (1.0 + 4.0 / 10.0 + 9.0 / 100.0)", 0.8),
            ("momentum.component_div(&inertia).dot(&momentum)", 1.0 + 0.4 + 0.09),
            ("2.0 * PI * t - -3.0", 5.0 * std::f64::consts::PI + 3.0),
            ("atan2(momentum_y, momentum_x) + momentum_x.max(1.5)", 2_f64.atan() + 1.5),
            ("gamma[2] + attitude[(0, 1)]", -0.2),
            ("velocity.z + velocity_y + velocity[0]", 1.0 + 0.2 + 0.03),
            ("late, s = t * (t >= 2.5 && !(gamma_z > 0.9))", 2.5),
        ] {
            let found = value("heavy_top", text).expect(text);
            assert!((found - expected).abs() < 1e-14 * expected.abs().max(1.0), "{text}: {found}");
        }
        assert_eq!(value("planar_pendulum", "angle.sin_angle() + torque"), Ok(7.8));
        assert_eq!(value("planar_pendulum", "angle.angle()"), Ok(0.8_f64.atan2(0.6)));
        assert_eq!(value("planar_pendulum", "angle.re * momentum"), Ok(-0.15));
    }

    #[test]
    fn names_and_units_are_read() {
        let entry = catalogue().system("heavy_top").expect("it is there");
        for (text, name, unit) in [
            ("momentum.norm()", "momentum.norm()", "kg m²/s"),
            ("momentum_x", "momentum_x", "kg m²/s"),
            ("L=momentum.x - momentum_y", "L", "kg m²/s"),
            ("height, m = gamma.dot(&chi)", "height", "m"),
            ("energy", "energy", "J"),
            ("E = -energy", "E", "J"),
            ("momentum_x * momentum_y", "momentum_x * momentum_y", ""),
            ("momentum_x >= 1", "momentum_x >= 1", ""),
        ] {
            let own = observable(entry, text).expect(text);
            assert_eq!((own.name.as_str(), own.unit.as_str()), (name, unit));
        }
    }

    #[test]
    fn mistakes_are_explained() {
        for (text, reason) in [
            (
                "momentm.norm()",
                "there is no quantity `momentm` of `heavy_top`; did you mean `momentum`? (t, energy, inertia",
            ),
            ("momentum.nrm()", "there is no function `nrm`; did you mean `norm`? (abs,"),
            ("momentum", "a number is asked for, and this is a vector of 3"),
            ("attitude", "a matrix of 3 × 3"),
            ("momentum + 1.0", "there is no sum of a vector of 3 and a number"),
            ("momentum.dot(&attitude)", "no `dot` of a vector of 3 and a matrix of 3 × 3"),
            ("attitude < 0", "of a matrix of 3 × 3 and a number; the angle of a rotation is `.angle()`"),
            ("momentum.q", "there is no component `q`"),
            ("momentum.norm(1.0)", "`norm` takes 1 arguments"),
            ("momentum.sin()", "`sin` is a function of a number"),
            ("= t", "a name stands before `=`"),
            ("x = ", "unexpected end"),
            ("momentum.norm(", "a bracket or a sign has no counterpart"),
            ("if t > 1.0 { 1.0 } else { 0.0 }", "expressions are made of"),
            ("\"t\"", "expressions are of numbers"),
            ("vector![]", "is made of numbers"),
            ("t % 2", "operators are"),
            ("gamma_z**2", "`*` stands between two factors; a power is `.powi(2)`"),
            ("gamma_z^2", "a power is `.powi(2)`"),
            ("t > 1 && &&t", "expressions are made of"),
            ("t.powi(2.5)", "`powi` takes a whole number; `powf` takes any"),
            ("!gamma", "there is no `!` of a vector of 3 and a number"),
            ("nowhere::gamma_z", "there is no constant `gamma_z`"),
            ("gamma[3]", "there is no component `3`"),
            ("gamma[t]", "an index is a whole number"),
            ("attitude[0]", "there is no component `0`"),
            ("height m = gamma.z", "a name is one word"),
        ] {
            let error = value("heavy_top", text).expect_err(text);
            assert!(error.contains(reason), "{text}: {error}");
        }
        let top = catalogue().system("heavy_top").expect("it is there");
        for (text, is_one) in [
            ("gamma_z < 0", true),
            ("!(t > 1 && (gamma_z <= 0 || energy >= 2))", true),
            ("gamma_z", false),
            ("gamma_z = 0", false),
            ("late = t > 1", false),
            ("t > 1 && gamma_z", false),
            ("1 - (t > 1)", false),
        ] {
            assert_eq!(condition(top, text).is_ok(), is_one, "{text}");
        }
        let twice = ["L = t".to_owned(), "L = 2 * t".to_owned()];
        let error = observables(top, &twice).map(|_| ()).expect_err("two of one name").to_string();
        assert_eq!(error, "there are two quantities `L`");
        let error = value("rigid_body_in_space", "pose").expect_err("a motion");
        assert!(error.contains("take the components of `pose`: pose_w, pose_x"), "{error}");
        // however deep
        for (deep, reason) in [(MOST_SIGNS, ""), (100_000, "at most 60 brackets")] {
            for text in [
                "(".repeat(deep) + "t" + &")".repeat(deep),
                "-".repeat(deep) + "t",
                "t+".repeat(deep) + "t",
                "t".to_owned() + &".abs ".repeat(deep),
            ] {
                let found = value("heavy_top", &text);
                assert!(found.as_ref().err().map_or("", String::as_str).contains(reason), "{found:?}");
            }
        }
    }
}
