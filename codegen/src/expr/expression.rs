//! Expressions as formulas are written with them.

use super::arena::Arena;
use super::node::{Function, Id, Node, Stage, Sum, Symbol, SymbolInfo};
use super::number::Number;

/// An expression: a node together with its arena, so that formulas can be written with operators.
#[derive(Clone, Copy)]
pub struct Expr<'a> {
    pub(crate) arena: &'a Arena,
    pub(crate) id: Id,
}

impl Arena {
    /// A node as an expression.
    pub fn expr(&self, id: Id) -> Expr<'_> {
        Expr { arena: self, id }
    }

    /// A new symbol, different from all others whatever its name.
    pub fn symbol(&self, name: impl Into<String>, stage: Stage) -> Expr<'_> {
        self.expr(self.new_symbol(SymbolInfo { name: name.into(), stage }))
    }

    /// A symbol that there is.
    pub fn of_symbol(&self, symbol: Symbol) -> Expr<'_> {
        self.expr(self.intern(Node::Symbol(symbol)))
    }

    /// A constant.
    pub fn number(&self, number: impl Into<Number>) -> Expr<'_> {
        self.expr(self.intern(Node::Number(number.into())))
    }

    /// The constant 0.
    pub fn zero(&self) -> Expr<'_> {
        self.number(Number::ZERO)
    }

    /// The constant 1.
    pub fn one(&self) -> Expr<'_> {
        self.number(Number::ONE)
    }
}

impl<'a> Expr<'a> {
    /// The node.
    pub fn id(self) -> Id {
        self.id
    }

    /// The arena.
    pub fn arena(self) -> &'a Arena {
        self.arena
    }

    /// Whether it is the constant 0. Canonical form makes many zeros evident, not all.
    pub fn is_zero(self) -> bool {
        matches!(self.arena.node(self.id), Node::Number(number) if number.is_zero())
    }

    /// The symbol, if the expression is one.
    pub fn as_symbol(self) -> Option<Symbol> {
        match self.arena.node(self.id) {
            Node::Symbol(symbol) => Some(symbol),
            _ => None,
        }
    }

    /// The constant, if the expression is one.
    pub fn as_number(self) -> Option<Number> {
        match self.arena.node(self.id) {
            Node::Number(number) => Some(number),
            _ => None,
        }
    }

    /// `(c, x)` with `self = c x`, where `c` is the number that it is a multiple by.
    pub fn split_number(self) -> (Number, Self) {
        match self.arena.node(self.id) {
            Node::Sum(Sum { terms, constant }) if constant.is_zero() && terms.len() == 1 => {
                (terms[0].1, self.arena.expr(terms[0].0))
            }
            _ => (Number::ONE, self),
        }
    }

    /// `self^exponent`
    pub fn powi(self, exponent: i32) -> Self {
        self.arena.expr(self.arena.product(Number::ONE, [(self.id, exponent)]))
    }

    /// `self^exponent`; integers and halves become products and roots.
    pub fn pow(self, exponent: Self) -> Self {
        self.arena.expr(self.arena.power(self.id, exponent.id))
    }

    /// `1 / self`
    pub fn recip(self) -> Self {
        self.powi(-1)
    }

    /// `√self`
    pub fn sqrt(self) -> Self {
        self.apply(Function::Sqrt)
    }

    /// `function(self)`
    pub fn apply(self, function: Function) -> Self {
        self.arena.expr(self.arena.function(function, self.id))
    }

    /// `c_k(self)`
    pub fn stumpff(self, k: u32) -> Self {
        self.apply(Function::Stumpff(k))
    }

    /// The same value kept whole. Canonical sums and products merge with what surrounds them and move constants
    /// outward; where a formula's own grouping is the better one (the value has a meaning, or is used in several
    /// places), this keeps it.
    pub fn hold(self) -> Self {
        self.arena.expr(self.arena.held(self.id))
    }

    /// Gives the value a role name, which emitted code is read by. The first name stays; symbols and constants have
    /// names enough.
    pub fn named(self, name: impl Into<String>) -> Self {
        self.arena.name(self.id, name.into());
        self
    }

    /// The earliest stage at which its value is known.
    pub fn stage(self) -> Stage {
        self.arena.stage(self.id)
    }

    /// Whether any of the symbols occurs.
    pub fn depends_on(self, symbols: &[Symbol]) -> bool {
        self.arena.any_symbol([self.id], |symbol| symbols.contains(&symbol))
    }

    /// The angle of the point `(x, self)`.
    pub fn atan2(self, x: Self) -> Self {
        self.arena.expr(self.arena.atan2(self.id, x.id))
    }

    /// `negative` where the value is below zero, `otherwise` elsewhere.
    pub fn choose(self, negative: Self, otherwise: Self) -> Self {
        self.arena.expr(self.arena.choice([self.id, negative.id, otherwise.id]))
    }

    /// `number · self`
    pub fn scale(self, number: impl Into<Number>) -> Self {
        self.arena.expr(self.arena.sum(Number::ZERO, [(self.id, number.into())]))
    }
}

impl PartialEq for Expr<'_> {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.arena, other.arena) && self.id == other.id
    }
}

impl Eq for Expr<'_> {}

/// An operator by what it makes of its operands.
macro_rules! operator {
    ($operator:ident $method:ident $other:ty: |$left:ident, $right:ident| $value:expr) => {
        impl<'a> std::ops::$operator<$other> for Expr<'a> {
            type Output = Expr<'a>;
            fn $method(self, other: $other) -> Self {
                let ($left, $right) = (self, other);
                $value
            }
        }
    };
}

operator!(Add add Expr<'a>: |x, y| {
    x.arena.expr(x.arena.sum(Number::ZERO, [(x.id, Number::ONE), (y.id, Number::ONE)]))
});
operator!(Sub sub Expr<'a>: |x, y| {
    x.arena.expr(x.arena.sum(Number::ZERO, [(x.id, Number::ONE), (y.id, Number::MINUS_ONE)]))
});
operator!(Mul mul Expr<'a>: |x, y| x.arena.expr(x.arena.product(Number::ONE, [(x.id, 1), (y.id, 1)])));
operator!(Div div Expr<'a>: |x, y| x.arena.expr(x.arena.product(Number::ONE, [(x.id, 1), (y.id, -1)])));
operator!(Add add i64: |x, number| x + x.arena.number(number));
operator!(Sub sub i64: |x, number| x - x.arena.number(number));
operator!(Mul mul i64: |x, number| x.scale(number));
operator!(Div div i64: |x, number| x / x.arena.number(number));

impl<'a> std::ops::Neg for Expr<'a> {
    type Output = Expr<'a>;
    fn neg(self) -> Self {
        self.scale(Number::MINUS_ONE)
    }
}

impl std::fmt::Debug for Expr<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}
