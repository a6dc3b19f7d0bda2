//! The language of a user's expressions: ordinary Rust over scalars, vectors and matrices, given a symbolic meaning.
//!
//! The user's text is also emitted as a method of the struct, where rustc checks its types. What is said here is
//! therefore only what rustc cannot know: which constructs have a symbolic meaning. What
//! rustc rejects in better words, such as `2 * x` for a float `x`, is given its obvious meaning and left to rustc;
//! nothing that rustc accepts is given another meaning than rustc's.

mod access;
mod block;
mod choice;
mod construct;
mod literal;
mod lowering;
mod methods;
mod operators;
mod scope;
mod sequence;
mod spline;
mod value;

pub use access::by_index;
pub use scope::{Constant, Scope};
pub(crate) use value::COMPONENTS;
pub use value::{Element, Value};

/// The words of the language, for its documentation.
pub mod words {
    pub use super::construct::{CONSTRUCTORS, POINTS};
    pub use super::methods::{STEPS, methods};
    pub use super::sequence::{ARRAY_METHODS, ITERATOR_METHODS};
    pub use crate::limits::RANGE;
}

use lowering::Lowering;

use crate::diagnostics::Diagnostics;
use crate::expr::{Arena, Expr, Vector};
use crate::group::Group;

/// The symbolic meaning of an expression. All problems in it are reported; `None` if there were any, or if it uses a
/// name that is in error itself.
///
/// Constants of the user's own are recorded in the scope as they are met.
pub fn lower<'a>(
    expr: &syn::Expr,
    scope: &mut Scope<'a>,
    arena: &'a Arena,
    diagnostics: &mut Diagnostics,
) -> Option<Value<'a>> {
    let before = diagnostics.len();
    let value = Lowering::new(scope, arena, diagnostics).lower(expr);
    // a problem in a part that the value does not depend on is a problem all the same
    value.filter(|_| diagnostics.len() == before)
}

/// The symbolic meaning of an expression that must be a scalar. `what` says in messages what it is for:
/// `the potential`.
pub fn lower_scalar<'a>(
    what: &str,
    expr: &syn::Expr,
    scope: &mut Scope<'a>,
    arena: &'a Arena,
    diagnostics: &mut Diagnostics,
) -> Option<Expr<'a>> {
    let value = lower(expr, scope, arena, diagnostics)?;
    let message = || format!("{what} must be a scalar, but this is {}", value.describe());
    value.as_scalar(arena).or_else(|| diagnostics.fail(result(expr), message()))
}

/// How a user writes a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceForm {
    /// A vector.
    Vector,
    /// A number, which stands for a vector of one component.
    Scalar,
    /// A tuple of its parts, such as `(moment, push)` for a rigid body.
    Parts,
}

/// The symbolic meaning of a force on a factor with this group, if that is known, or of those on an array of so many,
/// and how each is written.
pub fn lower_forces<'a>(
    expr: &syn::Expr,
    (group, length): (Option<&dyn Group>, Option<usize>),
    scope: &mut Scope<'a>,
    arena: &'a Arena,
    diagnostics: &mut Diagnostics,
) -> Option<(Vec<Vector<'a>>, ForceForm)> {
    let value = lower(expr, scope, arena, diagnostics)?;
    let values = match (length, &value) {
        (None, one) => std::slice::from_ref(one),
        (Some(length), Value::Array(values)) if values.len() == length => values,
        (Some(_), _) => &[],
    };
    let forces: Option<Vec<_>> = values.iter().map(|value| force(value, group, arena)).collect();
    if let Some(forces) = forces
        && let Some(&(_, form)) = forces.first()
    {
        return Some((forces.into_iter().map(|(force, _)| force).collect(), form));
    }
    let (expected, found) = (expected_force(group), value.describe());
    let message = match length {
        // on what is not known an array may act too
        None if group.is_none() && matches!(value, Value::Array(_)) => return None,
        None => format!("this force must be {expected}, but this is {found}"),
        Some(length) => format!(
            "these forces must be an array of {length}, one for each factor, each {expected}, but this is {found}"
        ),
    };
    diagnostics.fail(result(expr), message)
}

/// A value as a force on a factor with this group, if it can be one.
fn force<'a>(
    value: &Value<'a>,
    group: Option<&dyn Group>,
    arena: &'a Arena,
) -> Option<(Vector<'a>, ForceForm)> {
    let (components, form) = match value {
        Value::Vector(vector) => (Some(vector.0.clone()), ForceForm::Vector),
        Value::Tuple(values) => (group.and_then(|group| parts(values, group, arena)), ForceForm::Parts),
        _ => (value.as_scalar(arena).map(|scalar| vec![scalar]), ForceForm::Scalar),
    };
    let fits =
        components.filter(|components| group.is_none_or(|group| components.len() == group.dimension()));
    fits.map(|components| (Vector(components), form))
}

/// What a force on a factor with this group can be.
fn expected_force(group: Option<&dyn Group>) -> String {
    match group.map(|group| (group.dimension(), group.names().parts)) {
        Some((1, _)) => "a scalar or a vector of 1".to_owned(),
        Some((n, [])) => format!("a vector of {n}"),
        Some((n, parts)) => {
            let forms = group.into_iter().flat_map(Group::blocks).map(|length| match length {
                1 => "a scalar".to_owned(),
                length => format!("a vector of {length}"),
            });
            let forms = forms.collect::<Vec<_>>().join(" and ");
            format!("a vector of {n}, or its parts `({})`, {forms}", parts.join(", "))
        }
        None => "a vector".to_owned(),
    }
}

/// The components of a force written as its parts, if these fit.
fn parts<'a>(values: &[Value<'a>], group: &dyn Group, arena: &'a Arena) -> Option<Vec<Expr<'a>>> {
    let blocks = group.blocks();
    if group.names().parts.len() != values.len() {
        return None;
    }
    let mut components = Vec::new();
    for (value, length) in values.iter().zip(blocks) {
        match value {
            Value::Vector(vector) if vector.len() == length && length > 1 => components.extend(vector.iter()),
            _ if length == 1 => components.push(value.as_scalar(arena)?),
            _ => return None,
        }
    }
    Some(components)
}

/// The part of an expression that gives it its type.
fn result(expr: &syn::Expr) -> &syn::Expr {
    match expr {
        syn::Expr::Block(block) => match block.block.stmts.last() {
            Some(syn::Stmt::Expr(last, None)) => result(last),
            _ => expr,
        },
        _ => expr,
    }
}
