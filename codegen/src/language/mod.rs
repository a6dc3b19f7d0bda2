//! The language of a user's expressions: ordinary Rust over scalars, vectors and matrices, given a symbolic meaning.
//!
//! The user's text is also emitted as a method of the struct, where rustc checks its types. What is said here is therefore
//! only what rustc cannot know: which constructs have a symbolic meaning, and which are not smooth. What rustc rejects in
//! better words, such as `2 * x` for a float `x`, is given its obvious meaning and left to rustc; nothing that rustc
//! accepts is given another meaning than rustc's.

mod access;
mod block;
mod construct;
mod literal;
mod lowering;
mod methods;
mod operators;
mod sanity;
mod scope;
mod value;

pub use scope::{Constant, Scope};
pub use value::{Element, Value};

use lowering::Lowering;

use crate::diagnostics::Diagnostics;
use crate::expr::{Arena, Expr, Vector};

/// The symbolic meaning of an expression. All problems in it are reported; `None` if there were any, or if it uses a name
/// that is in error itself.
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

/// The symbolic meaning of an expression that must be a scalar. `what` says in messages what it is for: `the potential`.
pub fn lower_scalar<'a>(
    what: &str,
    expr: &syn::Expr,
    scope: &mut Scope<'a>,
    arena: &'a Arena,
    diagnostics: &mut Diagnostics,
) -> Option<Expr<'a>> {
    let value = lower(expr, scope, arena, diagnostics)?;
    let scalar = value.as_scalar(arena);
    if scalar.is_none() {
        diagnostics.push(result(expr), format!("{what} must be a scalar, but this is {}", value.describe()));
    }
    scalar
}

/// The symbolic meaning of an expression that must be a vector of so many components, if that is known; a scalar stands for a
/// vector of one, which the answer says. `what` says in messages what it is for: `this force`.
pub fn lower_vector<'a>(
    what: &str,
    expr: &syn::Expr,
    dimension: Option<usize>,
    scope: &mut Scope<'a>,
    arena: &'a Arena,
    diagnostics: &mut Diagnostics,
) -> Option<(Vector<'a>, bool)> {
    let value = lower(expr, scope, arena, diagnostics)?;
    let scalar = value.as_scalar(arena).is_some();
    let vector = match &value {
        Value::Vector(vector) => Some(vector.clone()),
        _ => value.as_scalar(arena).map(|scalar| Vector(vec![scalar])),
    };
    let fits = vector.filter(|vector| dimension.is_none_or(|dimension| vector.len() == dimension));
    if fits.is_none() {
        let expected = match dimension {
            Some(1) => "a scalar or a vector of 1".to_owned(),
            Some(n) => format!("a vector of {n}"),
            None => "a vector".to_owned(),
        };
        let found = value.describe();
        diagnostics.push(result(expr), format!("{what} must be {expected}, but this is {found}"));
    }
    fits.map(|vector| (vector, scalar))
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
