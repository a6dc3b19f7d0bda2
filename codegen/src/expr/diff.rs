//! Differentiation and substitution: both walk the graph once, remembering what they have seen.

use rustc_hash::FxHashMap;

use super::arena::{Arena, Expr, Function, Id, Node, Symbol};
use super::linear::Vector;
use super::number::Number;

impl<'a> Expr<'a> {
    /// The partial derivative with respect to a symbol.
    pub fn derivative(self, symbol: Symbol) -> Expr<'a> {
        Derivative::new(self.arena, symbol).of(self)
    }

    /// The expression with symbols replaced.
    pub fn substitute(self, replacements: &[(Symbol, Expr<'a>)]) -> Expr<'a> {
        Substitution::new(self.arena, replacements).of(self)
    }
}

/// Differentiates many expressions in one direction, sharing the work.
pub struct Derivative<'a> {
    arena: &'a Arena,
    direction: FxHashMap<Symbol, Id>,
    known: FxHashMap<Id, Id>,
}

impl<'a> Derivative<'a> {
    /// By one symbol.
    pub fn new(arena: &'a Arena, symbol: Symbol) -> Self {
        Self::along(arena, &[(symbol, arena.one())])
    }

    /// Along a direction: `Σ ∂/∂symbol · component`.
    pub fn along(arena: &'a Arena, direction: &[(Symbol, Expr<'a>)]) -> Self {
        let direction = direction.iter().map(|&(symbol, component)| (symbol, component.id)).collect();
        Self { arena, direction, known: FxHashMap::default() }
    }

    /// Takes the derivative of one expression as known, wherever it occurs.
    pub fn know(&mut self, expr: Expr<'a>, derivative: Expr<'a>) {
        self.known.insert(expr.id, derivative.id);
    }

    /// Of one expression.
    pub fn of(&mut self, expr: Expr<'a>) -> Expr<'a> {
        let id = self.visit(expr.id);
        self.arena.expr(id)
    }

    fn visit(&mut self, id: Id) -> Id {
        if let Some(&known) = self.known.get(&id) {
            return known;
        }
        let arena = self.arena;
        let zero = arena.zero().id;
        let derivative = match arena.node(id) {
            Node::Number(_) => zero,
            Node::Symbol(symbol) => self.direction.get(&symbol).copied().unwrap_or(zero),
            Node::Held(inner) => {
                let derivative = match quotient(arena.expr(inner)) {
                    // (c/u)' = −(c/u)² u'/c, which needs no other quotient
                    Some((number, divisor)) => {
                        let slope = arena.expr(self.visit(divisor.id)).scale(-number.powi(-1));
                        (slope * arena.expr(id).powi(2)).id
                    }
                    None => self.visit(inner),
                };
                arena.held(derivative)
            }
            Node::Sum(sum) => {
                let terms: Vec<_> = sum.terms.iter().map(|&(term, c)| (self.visit(term), c)).collect();
                arena.sum(Number::ZERO, terms)
            }
            Node::Product(factors) => {
                let mut terms = Vec::new();
                for (i, &(factor, exponent)) in factors.iter().enumerate() {
                    let inner = self.visit(factor);
                    if inner == zero {
                        continue;
                    }
                    let mut rest = factors.to_vec();
                    rest[i].1 -= 1;
                    rest.push((inner, 1));
                    terms.push((arena.product(Number::from(i64::from(exponent)), rest), Number::ONE));
                }
                arena.sum(Number::ZERO, terms)
            }
            Node::Function(function, argument) => {
                let inner = self.visit(argument);
                if inner == zero {
                    zero
                } else {
                    (function.derivative(arena.expr(argument)) * arena.expr(inner)).id
                }
            }
            Node::Power(base, exponent) => {
                // d(b^e) = e b^(e−1) db + ln(b) b^e de
                let (b, e) = (arena.expr(base), arena.expr(exponent));
                let (db, de) = (arena.expr(self.visit(base)), arena.expr(self.visit(exponent)));
                let mut total = e * b.pow(e - 1) * db;
                if !de.is_zero() {
                    total = total + b.apply(Function::Ln) * arena.expr(id) * de;
                }
                total.id
            }
            Node::Atan2(y, x) => {
                let (dy, dx) = (arena.expr(self.visit(y)), arena.expr(self.visit(x)));
                let (y, x) = (arena.expr(y), arena.expr(x));
                ((x * dy - y * dx) / (x * x + y * y)).id
            }
        };
        self.known.insert(id, derivative);
        derivative
    }
}

/// `(c, u)` with `expr = c/u`, for a number `c`.
fn quotient(expr: Expr<'_>) -> Option<(Number, Expr<'_>)> {
    let (number, rest) = expr.split_number();
    match rest.arena.node(rest.id) {
        Node::Product(factors) => match *factors {
            [(divisor, -1)] => Some((number, rest.arena.expr(divisor))),
            _ => None,
        },
        _ => None,
    }
}

impl Function {
    /// The derivative, at `x`.
    fn derivative<'a>(self, x: Expr<'a>) -> Expr<'a> {
        let one = x.arena.one();
        match self {
            Self::Sqrt => (x.sqrt() * 2).recip(),
            Self::Exp => x.apply(Self::Exp),
            Self::Ln => x.recip(),
            Self::Sin => x.apply(Self::Cos),
            Self::Cos => -x.apply(Self::Sin),
            Self::Tan => one + x.apply(Self::Tan).powi(2),
            Self::Asin => (one - x * x).sqrt().recip(),
            Self::Acos => -(one - x * x).sqrt().recip(),
            Self::Atan => (one + x * x).recip(),
            Self::Sinh => x.apply(Self::Cosh),
            Self::Cosh => x.apply(Self::Sinh),
            Self::Tanh => one - x.apply(Self::Tanh).powi(2),
            // c_k' = (k c_{k+2} − c_{k+1}) / 2
            Self::Stumpff(k) => (x.stumpff(k + 2) * i64::from(k) - x.stumpff(k + 1)) / 2,
        }
    }
}

/// `∂expr / ∂symbol_j` for many symbols at once.
///
/// The reverse mode: one sweep from the expression down to its symbols. It keeps the structure of transposed formulas — the
/// gradient of `a · x × (x × u)` by `u` comes out as two cross products, not as a matrix — where differentiating by one symbol
/// after the other would multiply it out.
pub fn gradient<'a>(expr: Expr<'a>, symbols: &[Symbol]) -> Vector<'a> {
    let arena = expr.arena;
    let mut adjoints: FxHashMap<Id, Vec<Id>> = FxHashMap::default();
    let mut found: FxHashMap<Symbol, Id> = FxHashMap::default();
    adjoints.insert(expr.id, vec![arena.one().id]);
    // operands are older than what is made of them: going from young to old, every adjoint is complete when it is used
    for id in reachable(expr) {
        let Some(parts) = adjoints.remove(&id) else { continue };
        let adjoint = arena.sum(Number::ZERO, parts.into_iter().map(|part| (part, Number::ONE)));
        let of = |rest: Expr<'a>| (rest * arena.expr(adjoint)).id;
        let mut give = |operand: Id, part: Id| adjoints.entry(operand).or_default().push(part);
        match arena.node(id) {
            Node::Number(_) => {}
            Node::Symbol(symbol) => {
                found.insert(symbol, adjoint);
            }
            Node::Sum(sum) => {
                for &(term, coefficient) in sum.terms.iter() {
                    give(term, arena.expr(adjoint).scale(coefficient).id);
                }
            }
            Node::Product(factors) => {
                for (i, &(factor, exponent)) in factors.iter().enumerate() {
                    let mut rest = factors.to_vec();
                    rest[i].1 -= 1;
                    let rest = arena.product(Number::from(i64::from(exponent)), rest);
                    give(factor, of(arena.expr(rest)));
                }
            }
            Node::Held(inner) => give(inner, adjoint),
            Node::Function(function, argument) => {
                give(argument, of(function.derivative(arena.expr(argument))));
            }
            Node::Power(base, exponent) => {
                let (b, e) = (arena.expr(base), arena.expr(exponent));
                give(base, of(e * b.pow(e - 1)));
                if e.as_number().is_none() {
                    give(exponent, of(b.apply(Function::Ln) * arena.expr(id)));
                }
            }
            Node::Atan2(y, x) => {
                let (u, v) = (arena.expr(y), arena.expr(x));
                let squared = u * u + v * v;
                give(y, of(v / squared));
                give(x, of(-u / squared));
            }
        }
    }
    let of = |symbol| found.get(symbol).map_or_else(|| arena.zero(), |&id| arena.expr(id));
    Vector(symbols.iter().map(of).collect())
}

/// The nodes an expression is made of, youngest first.
fn reachable(expr: Expr<'_>) -> Vec<Id> {
    let mut seen = rustc_hash::FxHashSet::default();
    let mut pending = vec![expr.id];
    let mut nodes = Vec::new();
    while let Some(id) = pending.pop() {
        if seen.insert(id) {
            nodes.push(id);
            pending.extend(expr.arena.node(id).operands());
        }
    }
    nodes.sort_by_key(|&id| std::cmp::Reverse(id));
    nodes
}

/// Replaces symbols in many expressions, sharing the work.
pub struct Substitution<'a> {
    arena: &'a Arena,
    replacements: FxHashMap<Symbol, Id>,
    known: FxHashMap<Id, Id>,
}

impl<'a> Substitution<'a> {
    /// Replaces each symbol by the expression beside it.
    pub fn new(arena: &'a Arena, replacements: &[(Symbol, Expr<'a>)]) -> Self {
        let replacements = replacements.iter().map(|&(symbol, expr)| (symbol, expr.id)).collect();
        Self { arena, replacements, known: FxHashMap::default() }
    }

    /// Of one expression.
    pub fn of(&mut self, expr: Expr<'a>) -> Expr<'a> {
        let id = self.visit(expr.id);
        self.arena.expr(id)
    }

    fn visit(&mut self, id: Id) -> Id {
        if let Some(&known) = self.known.get(&id) {
            return known;
        }
        let arena = self.arena;
        let result = match arena.node(id) {
            Node::Symbol(symbol) => self.replacements.get(&symbol).copied().unwrap_or(id),
            _ => arena.rebuild(id, |operand| self.visit(operand)),
        };
        if result != id {
            arena.pass_role(id, result);
        }
        self.known.insert(id, result);
        result
    }
}
