//! The hash-consed arena of expressions.
//!
//! Nodes are immutable, identified by small integers, and canonical by construction: sums are flat with like terms
//! collected, products are flat with like factors collected and carry no constant, constants are folded exactly.
//! Equal expressions built in any order are therefore the same node, and a subexpression that occurs twice is stored
//! once. Nothing is ever multiplied out.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::number::Number;

/// A node's place in its arena. Ids grow with creation, so their order depends on the input alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id(pub(crate) u32);

/// A symbol's place in its arena.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Symbol(pub(crate) u32);

/// The earliest stage at which a value is known. Later stages may use earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// When the stepper is built.
    Parameters,
    /// When the state is known.
    Step,
    /// When Newton's unknown is known.
    Iteration,
    /// When the perturbations are known that a derivative is applied to.
    Perturbation,
}

/// An elementary function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Function {
    /// `√x`
    Sqrt,
    /// `eˣ`
    Exp,
    /// The natural logarithm.
    Ln,
    /// The sine.
    Sin,
    /// The cosine.
    Cos,
    /// The tangent.
    Tan,
    /// The arc sine.
    Asin,
    /// The arc cosine.
    Acos,
    /// The arc tangent.
    Atan,
    /// The hyperbolic sine.
    Sinh,
    /// The hyperbolic cosine.
    Cosh,
    /// The hyperbolic tangent.
    Tanh,
    /// `c_k(z) = Σ_j (−z)^j / (k + 2j)!`
    Stumpff(u32),
}

/// A sum's constant and its terms with their coefficients, sorted by id; at least one term.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Sum {
    /// What is added to the terms.
    pub constant: Number,
    /// Terms with their coefficients, none of them zero.
    pub terms: Rc<[(Id, Number)]>,
}

/// One node.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A constant.
    Number(Number),
    /// A symbol.
    Symbol(Symbol),
    /// A sum.
    Sum(Sum),
    /// Factors with their exponents, sorted by id.
    Product(Rc<[(Id, i32)]>),
    /// A function of one argument.
    Function(Function, Id),
    /// `base^exponent` for an exponent that is not an integer.
    Power(Id, Id),
    /// `atan2(y, x)`
    Atan2(Id, Id),
    /// A value kept whole: the same number, but not merged into the sums and products around it.
    Held(Id),
}

impl Node {
    /// What the node is made of.
    pub fn operands(&self) -> Vec<Id> {
        match self {
            Self::Number(_) | Self::Symbol(_) => Vec::new(),
            Self::Sum(sum) => sum.terms.iter().map(|&(id, _)| id).collect(),
            Self::Product(factors) => factors.iter().map(|&(id, _)| id).collect(),
            Self::Function(_, argument) | Self::Held(argument) => vec![*argument],
            Self::Power(base, exponent) => vec![*base, *exponent],
            Self::Atan2(y, x) => vec![*y, *x],
        }
    }
}

impl Node {
    /// Whether its own constants are neither infinite nor not a number.
    fn is_finite(&self) -> bool {
        match self {
            Self::Number(number) => number.is_finite(),
            Self::Sum(sum) => sum.constant.is_finite() && sum.terms.iter().all(|(_, c)| c.is_finite()),
            _ => true,
        }
    }
}

/// A symbol's name and stage.
#[derive(Clone, Debug)]
pub struct SymbolInfo {
    /// What it is called in text and, if that is free, in code.
    pub name: String,
    /// When its value is known.
    pub stage: Stage,
}

#[derive(Default)]
struct Store {
    nodes: Vec<Node>,
    index: FxHashMap<Node, Id>,
    symbols: Vec<SymbolInfo>,
    /// Role names of nodes, and in which order they were given.
    roles: Vec<(Id, String)>,
    named: FxHashSet<Id>,
}

/// Where expressions live.
pub struct Arena {
    store: RefCell<Store>,
    /// How many operands the sums and products have that were made, whether they were new or not.
    work: Cell<usize>,
    limit: usize,
    /// Whether all constants are finite.
    finite: Cell<bool>,
}

impl Default for Arena {
    fn default() -> Self {
        Self::limited(usize::MAX)
    }
}

impl Arena {
    /// An empty arena.
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty arena in which the sums and products that are made may have so many operands. Once they have more, the arena is exhausted:
    /// everything made from then on is the constant 0, so that whatever goes on soon comes to its end.
    pub fn limited(limit: usize) -> Self {
        Self { store: RefCell::default(), work: Cell::new(0), limit, finite: Cell::new(true) }
    }

    /// How many operands the sums and products have that were made.
    pub fn work(&self) -> usize {
        self.work.get()
    }

    /// Whether more was made than the limit allows. What was made is of no use then.
    pub fn is_exhausted(&self) -> bool {
        self.work.get() > self.limit
    }

    /// Whether no constant that was made is infinite or not a number.
    pub fn is_finite(&self) -> bool {
        self.finite.get()
    }

    /// Takes note of work.
    pub(crate) fn charge(&self, operands: usize) {
        self.work.set(self.work.get().saturating_add(operands));
    }

    /// A node.
    pub fn node(&self, id: Id) -> Node {
        self.store.borrow().nodes[id.0 as usize].clone()
    }

    /// A symbol's name and stage.
    pub fn symbol_info(&self, symbol: Symbol) -> SymbolInfo {
        self.store.borrow().symbols[symbol.0 as usize].clone()
    }

    /// What is made in an exhausted arena.
    fn exhausted(&self) -> Id {
        self.intern(Node::Number(Number::ZERO))
    }

    fn intern(&self, node: Node) -> Id {
        let mut store = self.store.borrow_mut();
        if let Some(&id) = store.index.get(&node) {
            return id;
        }
        if !node.is_finite() {
            self.finite.set(false);
        }
        let id = Id(store.nodes.len() as u32);
        store.nodes.push(node.clone());
        store.index.insert(node, id);
        id
    }

    /// A new symbol, different from all others whatever its name.
    pub fn symbol(&self, name: impl Into<String>, stage: Stage) -> Expr<'_> {
        let symbol = {
            let mut store = self.store.borrow_mut();
            store.symbols.push(SymbolInfo { name: name.into(), stage });
            Symbol(store.symbols.len() as u32 - 1)
        };
        self.expr(self.intern(Node::Symbol(symbol)))
    }

    /// A node as an expression.
    pub fn expr(&self, id: Id) -> Expr<'_> {
        Expr { arena: self, id }
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

    /// `constant + Σ coefficient · term`, canonical.
    pub(crate) fn sum(&self, mut constant: Number, addends: impl IntoIterator<Item = (Id, Number)>) -> Id {
        let mut terms: Vec<(Id, Number)> = Vec::new();
        for (id, coefficient) in addends {
            self.charge(1);
            if self.is_exhausted() {
                return self.exhausted();
            }
            match self.node(id) {
                Node::Number(number) => constant = constant + coefficient * number,
                // a scaled term, or a sum added or subtracted as it is; a sum scaled otherwise stays factored
                Node::Sum(sum) if sum.is_scaled_term() || coefficient.abs().is_one() => {
                    self.charge(sum.terms.len());
                    constant = constant + coefficient * sum.constant;
                    terms.extend(sum.terms.iter().map(|&(id, c)| (id, coefficient * c)));
                }
                _ => terms.push((id, coefficient)),
            }
        }
        terms.sort_by_key(|&(id, _)| id);
        let mut collected: Vec<(Id, Number)> = Vec::with_capacity(terms.len());
        for (id, coefficient) in terms {
            match collected.last_mut() {
                Some((last, total)) if *last == id => *total = *total + coefficient,
                _ => collected.push((id, coefficient)),
            }
        }
        collected.retain(|(_, coefficient)| !coefficient.is_zero());
        match collected.as_slice() {
            [] => self.intern(Node::Number(constant)),
            [(id, coefficient)] if constant.is_zero() && coefficient.is_one() => *id,
            _ => self.intern(Node::Sum(Sum { constant, terms: collected.into() })),
        }
    }

    /// `coefficient · Π factor^exponent`, canonical.
    pub(crate) fn product(
        &self,
        mut coefficient: Number,
        factors: impl IntoIterator<Item = (Id, i32)>,
    ) -> Id {
        let mut collected: Vec<(Id, i32)> = Vec::new();
        let mut pending: Vec<(Id, i32)> = factors.into_iter().collect();
        while let Some((id, exponent)) = pending.pop() {
            self.charge(1);
            if self.is_exhausted() {
                return self.exhausted();
            }
            match self.node(id) {
                _ if exponent == 0 => {}
                Node::Number(number) => coefficient = coefficient * number.powi(exponent),
                Node::Product(inner) => {
                    pending.extend(inner.iter().map(|&(id, e)| (id, e.saturating_mul(exponent))))
                }
                Node::Sum(sum) => {
                    self.charge(sum.terms.len());
                    // scale and sign go outside, so that 2x, (a − b) and (b − a) are known for what they are
                    let content = sum.content();
                    if content.is_one() {
                        collected.push((id, exponent));
                    } else {
                        coefficient = coefficient * content.powi(exponent);
                        let rest = sum.terms.iter().map(|&(id, c)| (id, c.without(content)));
                        pending.push((self.sum(sum.constant.without(content), rest), exponent));
                    }
                }
                Node::Function(Function::Sqrt, radicand) if exponent % 2 == 0 => {
                    pending.push((radicand, exponent / 2));
                }
                _ => collected.push((id, exponent)),
            }
        }
        if coefficient.is_zero() {
            return self.intern(Node::Number(Number::ZERO));
        }
        collected.sort_by_key(|&(id, _)| id);
        let mut merged: Vec<(Id, i32)> = Vec::with_capacity(collected.len());
        for (id, exponent) in collected {
            match merged.last_mut() {
                Some((last, total)) if *last == id => *total = total.saturating_add(exponent),
                _ => merged.push((id, exponent)),
            }
        }
        merged.retain(|&(_, exponent)| exponent != 0);
        // merging can make a root's exponent even
        if merged
            .iter()
            .any(|&(id, e)| e % 2 == 0 && matches!(self.node(id), Node::Function(Function::Sqrt, _)))
        {
            return self.product(coefficient, merged);
        }
        let base = match merged.as_slice() {
            [] => return self.intern(Node::Number(coefficient)),
            [(id, 1)] => *id,
            _ => self.intern(Node::Product(merged.into())),
        };
        self.sum(Number::ZERO, [(base, coefficient)])
    }

    /// `function(argument)`, folded where the value is exactly known.
    pub(crate) fn function(&self, function: Function, argument: Id) -> Id {
        self.charge(1);
        if self.is_exhausted() {
            return self.exhausted();
        }
        if let Node::Number(number) = self.node(argument)
            && let Some(value) = function.exact(number)
        {
            return self.intern(Node::Number(value));
        }
        self.intern(Node::Function(function, argument))
    }

    pub(crate) fn power(&self, base: Id, exponent: Id) -> Id {
        match self.node(exponent) {
            Node::Number(Number::Rational(r)) if r.is_integer() && i32::try_from(*r.numer()).is_ok() => {
                self.product(Number::ONE, [(base, *r.numer() as i32)])
            }
            Node::Number(Number::Rational(r)) if *r.denom() == 2 && i32::try_from(*r.numer()).is_ok() => {
                let root = self.function(Function::Sqrt, base);
                self.product(Number::ONE, [(root, *r.numer() as i32)])
            }
            _ => self.intern(Node::Power(base, exponent)),
        }
    }

    /// The nodes that some are made of, and these themselves, in the order in which a walk along the operands is done with them: operands
    /// before what is made of them. What `skipped` admits is left out, with all that only it is made of.
    ///
    /// Whoever goes through a graph goes through this list: a graph may be deeper than any stack.
    pub fn post_order(&self, from: impl IntoIterator<Item = Id>, skipped: impl Fn(Id) -> bool) -> Vec<Id> {
        let store = self.store.borrow();
        let operands = |id: Id| store.nodes[id.0 as usize].operands().into_iter();
        let mut seen = FxHashSet::default();
        let mut order = Vec::new();
        let mut open: Vec<(Id, std::vec::IntoIter<Id>)> = Vec::new();
        for root in from {
            if !skipped(root) && seen.insert(root) {
                open.push((root, operands(root)));
            }
            while let Some((id, rest)) = open.last_mut() {
                match rest.next() {
                    Some(next) if !skipped(next) && seen.insert(next) => open.push((next, operands(next))),
                    Some(_) => {}
                    None => {
                        order.push(*id);
                        open.pop();
                    }
                }
            }
        }
        order
    }

    /// The role names that were given, in that order.
    pub fn roles(&self) -> Vec<(Id, String)> {
        self.store.borrow().roles.clone()
    }

    /// Gives the role of a node to the node that takes its place.
    pub(crate) fn pass_role(&self, from: Id, to: Id) {
        let role = {
            let store = self.store.borrow();
            if !store.named.contains(&from) {
                return;
            }
            store.roles.iter().find(|(id, _)| *id == from).map(|(_, name)| name.clone())
        };
        if let Some(role) = role {
            self.expr(to).named(role);
        }
    }

    /// The node made anew of the images of its operands.
    pub(crate) fn rebuild(&self, id: Id, mut image: impl FnMut(Id) -> Id) -> Id {
        match self.node(id) {
            Node::Number(_) | Node::Symbol(_) => id,
            Node::Sum(sum) => {
                let terms: Vec<_> = sum.terms.iter().map(|&(term, c)| (image(term), c)).collect();
                self.sum(sum.constant, terms)
            }
            Node::Product(factors) => {
                let factors: Vec<_> = factors.iter().map(|&(factor, e)| (image(factor), e)).collect();
                self.product(Number::ONE, factors)
            }
            Node::Function(function, argument) => self.function(function, image(argument)),
            Node::Power(base, exponent) => self.power(image(base), image(exponent)),
            Node::Atan2(y, x) => self.atan2(image(y), image(x)),
            Node::Held(inner) => self.held(image(inner)),
        }
    }

    /// The value kept whole; constants, symbols and what is whole already stay as they are.
    pub(crate) fn held(&self, id: Id) -> Id {
        match self.node(id) {
            Node::Sum(_) | Node::Product(_) => self.intern(Node::Held(id)),
            _ => id,
        }
    }

    pub(crate) fn atan2(&self, y: Id, x: Id) -> Id {
        self.intern(Node::Atan2(y, x))
    }
}

impl Sum {
    /// `c · x` and nothing else.
    pub fn is_scaled_term(&self) -> bool {
        self.terms.len() == 1 && self.constant.is_zero()
    }

    /// What to pull out of the sum where it is a factor: the common magnitude of its coefficients if they have one,
    /// and the sign of the first term.
    pub fn content(&self) -> Number {
        let first = self.terms[0].1;
        let magnitude = first.abs();
        let common = self.terms.iter().all(|(_, c)| c.abs() == magnitude)
            && (self.constant.is_zero() || self.constant.abs() == magnitude);
        match (common, first.is_negative()) {
            (true, _) => first,
            (false, true) => Number::MINUS_ONE,
            (false, false) => Number::ONE,
        }
    }
}

impl Function {
    /// The value at `argument` where it is an exactly known rational.
    fn exact(self, argument: Number) -> Option<Number> {
        if let Function::Sqrt = self {
            return argument.exact_sqrt();
        }
        if argument.is_zero() {
            match self {
                Self::Sin | Self::Tan | Self::Asin | Self::Atan | Self::Sinh | Self::Tanh => {
                    Some(Number::ZERO)
                }
                Self::Exp | Self::Cos | Self::Cosh => Some(Number::ONE),
                Self::Stumpff(k) => {
                    Some(Number::ratio(1, (1..=i128::from(k)).try_fold(1i128, |f, i| f.checked_mul(i))?))
                }
                Self::Sqrt | Self::Ln | Self::Acos => None,
            }
        } else if argument.is_one() {
            match self {
                Self::Ln | Self::Acos => Some(Number::ZERO),
                _ => None,
            }
        } else {
            None
        }
    }

    /// Its name in text and, but for Stumpff functions, in code.
    pub fn name(self) -> String {
        match self {
            Self::Sqrt => "sqrt",
            Self::Exp => "exp",
            Self::Ln => "ln",
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tan => "tan",
            Self::Asin => "asin",
            Self::Acos => "acos",
            Self::Atan => "atan",
            Self::Sinh => "sinh",
            Self::Cosh => "cosh",
            Self::Tanh => "tanh",
            Self::Stumpff(k) => return format!("c{k}"),
        }
        .to_owned()
    }
}

/// An expression: a node together with its arena, so that formulas can be written with operators.
#[derive(Clone, Copy)]
pub struct Expr<'a> {
    pub(crate) arena: &'a Arena,
    pub(crate) id: Id,
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

    /// The same value kept whole. Canonical sums and products merge with what surrounds them and move constants outward; where a
    /// formula's own grouping is the better one (the value has a meaning, or is used in several places), this keeps it.
    pub fn hold(self) -> Self {
        self.arena.expr(self.arena.held(self.id))
    }

    /// Gives the value a role name, which emitted code is read by. The first name stays; symbols and constants have names enough.
    pub fn named(self, name: impl Into<String>) -> Self {
        if self.as_symbol().is_none() && self.as_number().is_none() {
            let mut store = self.arena.store.borrow_mut();
            if store.named.insert(self.id) {
                store.roles.push((self.id, name.into()));
            }
        }
        self
    }

    /// The earliest stage at which its value is known.
    pub fn stage(self) -> Stage {
        let mut latest = Stage::Parameters;
        let mut seen = FxHashSet::default();
        let mut pending = vec![self.id];
        while let Some(id) = pending.pop() {
            if !seen.insert(id) {
                continue;
            }
            match self.arena.node(id) {
                Node::Symbol(symbol) => latest = latest.max(self.arena.symbol_info(symbol).stage),
                node => pending.extend(node.operands()),
            }
        }
        latest
    }

    /// Whether any of the symbols occurs.
    pub fn depends_on(self, symbols: &[Symbol]) -> bool {
        let mut seen = rustc_hash::FxHashSet::default();
        let mut pending = vec![self.id];
        while let Some(id) = pending.pop() {
            if seen.insert(id) {
                let node = self.arena.node(id);
                if matches!(node, Node::Symbol(symbol) if symbols.contains(&symbol)) {
                    return true;
                }
                pending.extend(node.operands());
            }
        }
        false
    }

    /// The angle of the point `(x, self)`.
    pub fn atan2(self, x: Self) -> Self {
        self.arena.expr(self.arena.atan2(self.id, x.id))
    }

    /// `self · numerator / denominator`
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

impl<'a> std::ops::Add for Expr<'a> {
    type Output = Expr<'a>;
    fn add(self, other: Self) -> Self {
        self.arena.expr(self.arena.sum(Number::ZERO, [(self.id, Number::ONE), (other.id, Number::ONE)]))
    }
}

impl<'a> std::ops::Sub for Expr<'a> {
    type Output = Expr<'a>;
    fn sub(self, other: Self) -> Self {
        self.arena.expr(self.arena.sum(Number::ZERO, [(self.id, Number::ONE), (other.id, Number::MINUS_ONE)]))
    }
}

impl<'a> std::ops::Mul for Expr<'a> {
    type Output = Expr<'a>;
    fn mul(self, other: Self) -> Self {
        self.arena.expr(self.arena.product(Number::ONE, [(self.id, 1), (other.id, 1)]))
    }
}

impl<'a> std::ops::Div for Expr<'a> {
    type Output = Expr<'a>;
    fn div(self, other: Self) -> Self {
        self.arena.expr(self.arena.product(Number::ONE, [(self.id, 1), (other.id, -1)]))
    }
}

impl<'a> std::ops::Neg for Expr<'a> {
    type Output = Expr<'a>;
    fn neg(self) -> Self {
        self.scale(Number::MINUS_ONE)
    }
}

impl<'a> std::ops::Add<i64> for Expr<'a> {
    type Output = Expr<'a>;
    fn add(self, other: i64) -> Self {
        self + self.arena.number(other)
    }
}

impl<'a> std::ops::Sub<i64> for Expr<'a> {
    type Output = Expr<'a>;
    fn sub(self, other: i64) -> Self {
        self - self.arena.number(other)
    }
}

impl<'a> std::ops::Mul<i64> for Expr<'a> {
    type Output = Expr<'a>;
    fn mul(self, other: i64) -> Self {
        self.scale(other)
    }
}

impl<'a> std::ops::Div<i64> for Expr<'a> {
    type Output = Expr<'a>;
    fn div(self, other: i64) -> Self {
        self / self.arena.number(other)
    }
}

impl std::fmt::Debug for Expr<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}
