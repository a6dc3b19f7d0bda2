//! Differentiation and substitution: both walk the graph once, remembering what they have seen.

use rustc_hash::FxHashMap;

use super::arena::{Arena, Expr, Function, Id, Node, Symbol};
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

/// Differentiates many expressions with respect to one symbol, sharing the work.
pub struct Derivative<'a> {
    arena: &'a Arena,
    symbol: Symbol,
    known: FxHashMap<Id, Id>,
}

impl<'a> Derivative<'a> {
    pub fn new(arena: &'a Arena, symbol: Symbol) -> Self {
        Self { arena, symbol, known: FxHashMap::default() }
    }

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
            Node::Symbol(symbol) => {
                if symbol == self.symbol {
                    arena.one().id
                } else {
                    zero
                }
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

/// Replaces symbols in many expressions, sharing the work.
pub struct Substitution<'a> {
    arena: &'a Arena,
    replacements: FxHashMap<Symbol, Id>,
    known: FxHashMap<Id, Id>,
}

impl<'a> Substitution<'a> {
    pub fn new(arena: &'a Arena, replacements: &[(Symbol, Expr<'a>)]) -> Self {
        let replacements = replacements.iter().map(|&(symbol, expr)| (symbol, expr.id)).collect();
        Self { arena, replacements, known: FxHashMap::default() }
    }

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
            Node::Number(_) => id,
            Node::Symbol(symbol) => self.replacements.get(&symbol).copied().unwrap_or(id),
            Node::Sum(sum) => {
                let terms: Vec<_> = sum.terms.iter().map(|&(term, c)| (self.visit(term), c)).collect();
                arena.sum(sum.constant, terms)
            }
            Node::Product(factors) => {
                let factors: Vec<_> = factors.iter().map(|&(factor, e)| (self.visit(factor), e)).collect();
                arena.product(Number::ONE, factors)
            }
            Node::Function(function, argument) => arena.function(function, self.visit(argument)),
            Node::Power(base, exponent) => arena.power(self.visit(base), self.visit(exponent)),
            Node::Atan2(y, x) => arena.atan2(self.visit(y), self.visit(x)),
        };
        self.known.insert(id, result);
        result
    }
}
