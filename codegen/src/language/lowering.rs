//! The walk over an expression: one case for each construct of Rust.

use quote::ToTokens;
use syn::ext::IdentExt;
use syn::{Expr, ExprPath, UnOp};

use super::scope::Scope;
use super::value::Value;
use crate::diagnostics::{Diagnostics, suggestion};
use crate::expr::{Arena, Expr as Symbolic, Node, Number};
use crate::limits;
use crate::parse::seen_from;

/// The state of a lowering.
pub(super) struct Lowering<'a, 's> {
    pub(super) arena: &'a Arena,
    pub(super) diagnostics: &'s mut Diagnostics,
    pub(super) scope: &'s mut Scope<'a>,
    /// The variables of the blocks around, innermost last; `None` for one whose value was in error.
    pub(super) locals: Vec<(String, Option<Value<'a>>)>,
    /// The functions of the user's own that this is in, innermost last.
    pub(super) within: Vec<syn::Path>,
    /// How many closures this is in, each of which is lowered for every element of something.
    pub(super) iterations: usize,
    /// Whether it was said that there is too much to compute.
    exhausted: bool,
}

impl<'a, 's> Lowering<'a, 's> {
    pub(super) fn new(scope: &'s mut Scope<'a>, arena: &'a Arena, diagnostics: &'s mut Diagnostics) -> Self {
        Self {
            arena,
            diagnostics,
            scope,
            locals: Vec::new(),
            within: Vec::new(),
            iterations: 0,
            exhausted: false,
        }
    }

    /// The value of an expression. `None` if there is a problem in it, which was reported.
    pub(super) fn lower(&mut self, expr: &Expr) -> Option<Value<'a>> {
        if self.exhausted || self.diagnostics.len() >= limits::PROBLEMS {
            return None;
        }
        let value = self.construct(expr)?;
        self.checked(value, expr)
    }

    /// The value unless it is beyond reason.
    pub(super) fn checked(&mut self, value: Value<'a>, tokens: impl ToTokens) -> Option<Value<'a>> {
        let scalars = value.scalars();
        self.arena.charge(value.size());
        if self.arena.work() > limits::READING {
            if self.exhausted {
                return None;
            }
            self.exhausted = true;
            let message = format!(
                "up to here, expressions make sums and products of more than {} operands, and derivatives make \
                 many more of them; simplify them, or give numbers that do not change as parameters",
                limits::READING
            );
            return self.fail(tokens, message);
        }
        match scalars.into_iter().find_map(problem) {
            Some(problem) => self.fail(tokens, problem),
            None => Some(value),
        }
    }

    /// Reports a problem.
    pub(super) fn fail<T>(&mut self, tokens: impl ToTokens, message: impl std::fmt::Display) -> Option<T> {
        self.diagnostics.fail(tokens, message)
    }

    fn construct(&mut self, expr: &Expr) -> Option<Value<'a>> {
        match expr {
            Expr::Lit(literal) => self.literal(&literal.lit),
            Expr::Path(path) => self.path(path),
            Expr::Paren(inner) => self.lower(&inner.expr),
            Expr::Group(inner) => self.lower(&inner.expr),
            // values and references to them are the same to mathematics
            Expr::Reference(inner) => self.lower(&inner.expr),
            Expr::Unary(unary) => match unary.op {
                UnOp::Deref(star) => self.dereferenced(star, &unary.expr),
                UnOp::Neg(sign) => {
                    let value = self.lower(&unary.expr)?;
                    self.negated(value, sign)
                }
                UnOp::Not(sign) => {
                    let value = self.lower(&unary.expr)?;
                    self.contrary(value, sign)
                }
                _ => self.unsupported(unary.op, "this operator"),
            },
            Expr::Binary(binary) => self.binary(binary),
            Expr::Cast(cast) => self.cast(cast),
            Expr::Field(field) => self.field(field),
            Expr::Index(index) => self.index(index),
            Expr::MethodCall(call) => self.method_call(call),
            Expr::Call(call) => self.call(call),
            Expr::Macro(call) => self.macro_call(&call.mac),
            Expr::Block(block) => self.block_expression(block),
            Expr::If(choice) => self.choice(choice),
            Expr::Tuple(tuple) => self.all(&tuple.elems).map(Value::Tuple),
            Expr::Range(range) => self.range(range),
            Expr::Array(array) if array.elems.is_empty() => self.fail(array, "this array is empty"),
            Expr::Array(array) => self.all(&array.elems).map(Value::Array),
            _ => self.other(expr),
        }
    }

    /// The values of several expressions. All are looked at, even after a problem in one.
    pub(super) fn all<'e>(&mut self, exprs: impl IntoIterator<Item = &'e Expr>) -> Option<Vec<Value<'a>>> {
        let values: Vec<Option<Value<'a>>> = exprs.into_iter().map(|expr| self.lower(expr)).collect();
        values.into_iter().collect()
    }

    fn path(&mut self, path: &ExprPath) -> Option<Value<'a>> {
        let Some(ident) = path.path.get_ident().filter(|_| path.qself.is_none()) else {
            return Some(self.constant(path));
        };
        let name = ident.unraw().to_string();
        let local = self.locals.iter().rev().find(|(local, _)| *local == name).map(|(_, value)| value);
        if let Some(value) = local {
            return value.clone();
        }
        // a function knows its arguments alone
        let is_inside = !self.within.is_empty();
        if !is_inside {
            self.scope.mark_used(&name);
            if let Some(message) = self.scope.forbidden(&name) {
                let message = message.to_owned();
                return self.fail(ident, message);
            }
            if let Some(value) = self.scope.get(&name) {
                return value.clone();
            }
        }
        if is_constant(&name) {
            return Some(self.constant(path));
        }
        if name == "self" {
            return self.fail(ident, "parameters are known by their names alone; leave out `self.`");
        }
        let names = self.scope.names().filter(|_| !is_inside);
        let known: Vec<&str> = names.chain(self.locals.iter().map(|(name, _)| name.as_str())).collect();
        let message = format!("there is no `{name}` here{}", suggestion(&name, &known));
        self.fail(ident, message)
    }

    /// A constant of the user's own.
    fn constant(&mut self, path: &ExprPath) -> Value<'a> {
        let path = ExprPath { path: seen_from(self.within.last(), &path.path), ..path.clone() };
        Value::Scalar(self.scope.constant(path, self.arena))
    }

    /// What a name refers to that is an argument or a variable: of all others a compiler says that they are no references.
    fn dereferenced(&mut self, star: syn::Token![*], of: &Expr) -> Option<Value<'a>> {
        let mut inner = of;
        while let Expr::Paren(syn::ExprParen { expr, .. }) | Expr::Group(syn::ExprGroup { expr, .. }) = inner
        {
            inner = expr;
        }
        let is_local = |path: &ExprPath| {
            let name = path.path.get_ident().map(|ident| ident.unraw().to_string());
            name.is_some_and(|name| self.locals.iter().any(|(local, _)| *local == name))
        };
        let is_reference = match inner {
            Expr::Lit(_) | Expr::Field(_) => false,
            Expr::Unary(unary) => matches!(unary.op, UnOp::Deref(_)),
            Expr::Path(path) => is_local(path),
            _ => true,
        };
        if is_reference { self.lower(of) } else { self.fail(star, NO_REFERENCE) }
    }

    /// Constructs without a symbolic meaning.
    fn other(&mut self, expr: &Expr) -> Option<Value<'a>> {
        match expr {
            Expr::Match(choice) => {
                self.fail(choice.match_token, "write `if … else …` in the place of `match`")
            }
            Expr::Assign(assignment) => {
                let message = "assignments are not supported; give each value a name with `let`";
                self.fail(assignment.eq_token, message)
            }
            Expr::ForLoop(looped) => self.unsupported(looped.for_token, "a loop"),
            Expr::While(looped) => self.unsupported(looped.while_token, "a loop"),
            Expr::Loop(looped) => self.unsupported(looped.loop_token, "a loop"),
            Expr::Closure(_) => {
                self.fail(expr, "a closure is not supported here; it is an argument of `map`, `map(|x| …)`")
            }
            Expr::Repeat(_) => self.fail(expr, "write out the elements, as in `[a, b]`, or `vector![…]`"),
            Expr::Struct(_) => self.unsupported(expr, "a struct"),
            Expr::Try(propagated) => self.unsupported(propagated.question_token, "`?`"),
            Expr::Return(returned) => {
                self.fail(returned.return_token, "leave out `return`: the last expression is the value")
            }
            _ => self.unsupported(expr, "this"),
        }
    }

    /// Reports a construct that has no symbolic meaning.
    pub(super) fn unsupported<T>(&mut self, tokens: impl ToTokens, what: &str) -> Option<T> {
        let message = format!(
            "{what} is not supported here; an expression is made of numbers, names, `+ - * /`, components, methods, \
             constructors such as `Vector3::new` or `vector![…]`, blocks with `let`, and `if … else …`"
        );
        self.fail(tokens, message)
    }

    /// Reports a construct whose value jumps at each whole number.
    pub(super) fn steps<T>(&mut self, tokens: impl ToTokens, what: &str) -> Option<T> {
        let message = format!(
            "{what} jumps again and again, which no step resolves; give such a value as a control, which is held over \
             each step, or write the few cases that there are with `if`"
        );
        self.fail(tokens, message)
    }
}

/// What is said where `*` stands before what is no reference.
pub(super) const NO_REFERENCE: &str =
    "`*` stands between two factors; a power is `x.powi(2)`, or `x.powf(y)`";

/// Whether a name is written as Rust writes constants.
fn is_constant(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_uppercase())
        && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
}

/// The problem of a value, if there is one.
///
/// The symbolic core folds constants and collects exponents, so that a division by zero or an absurd power shows in the
/// outermost node.
fn problem(scalar: Symbolic<'_>) -> Option<String> {
    let arena = scalar.arena();
    match arena.node(scalar.id()) {
        Node::Number(number) => not_finite(number),
        Node::Product(factors) => too_high(&factors),
        Node::Sum(sum) => {
            let terms = sum.terms.iter().find_map(|&(term, coefficient)| match arena.node(term) {
                Node::Product(factors) => not_finite(coefficient).or_else(|| too_high(&factors)),
                _ => not_finite(coefficient),
            });
            not_finite(sum.constant).or(terms)
        }
        _ => None,
    }
}

fn not_finite(number: Number) -> Option<String> {
    (!number.is_finite()).then(|| "this constant is too large or not a number".to_owned())
}

fn too_high<Factor>(factors: &[(Factor, i32)]) -> Option<String> {
    let highest = factors.iter().map(|(_, exponent)| exponent.unsigned_abs()).max()?;
    (highest > limits::EXPONENT)
        .then(|| format!("this holds a power of {highest}; the highest is {}", limits::EXPONENT))
}
