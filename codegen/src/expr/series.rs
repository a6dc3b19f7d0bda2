//! Truncated power series of expressions.
//!
//! Quantities along a motion are series in the time `τ` and a parameter `u` of weight 2, the square of a step. Where the
//! motion is seen from the middle of the step, odd powers of the step alone do not occur, so that the part of weight `w`
//! of a quantity is a polynomial `Σ_j c_j τ^{w−2j} u^j`. A series in one variable is one whose parts have one
//! coefficient.
//!
//! The parts of a function's value follow from those of its arguments by the derivation `D` that multiplies each part by
//! its weight: `D f(x) = Σ ∂f/∂x_i D x_i`, where the parts of `∂f/∂x_i` that occur are of lower weight. So every function
//! with a symbolic derivative has its series.

use rustc_hash::FxHashMap;

use super::arena::Arena;
use super::expression::Expr;
use super::node::{Function, Id, Node};
use super::number::Number;

/// The part of one weight: its coefficients `c_0, c_1, …`; those left out are zero.
pub type Part<'a> = Vec<Expr<'a>>;

/// Series of expressions in symbols whose series are known, part by part.
pub struct Series<'a> {
    arena: &'a Arena,
    /// The parts known so far of nodes that change; of the others nothing.
    known: FxHashMap<Id, Option<Vec<Part<'a>>>>,
}

impl<'a> Series<'a> {
    /// Series in symbols, each with the parts of weight 0, 1, … that are known of it.
    pub fn new(arena: &'a Arena) -> Self {
        Self { arena, known: FxHashMap::default() }
    }

    /// Takes this as the next part of a symbol's series.
    pub fn push(&mut self, symbol: Expr<'a>, part: Part<'a>) {
        let parts = self.known.entry(symbol.id).or_default();
        parts.get_or_insert_with(Vec::new).push(part);
    }

    /// Forgets all parts of this weight and above.
    pub fn truncate(&mut self, weight: usize) {
        self.known.values_mut().flatten().for_each(|parts| parts.truncate(weight));
    }

    /// The part of this weight. Those of all symbols that change are known up to it.
    pub fn part(&mut self, expr: Expr<'a>, weight: usize) -> Part<'a> {
        let order = self.arena.post_order([expr.id], |id| match self.known.get(&id) {
            Some(parts) => parts.as_ref().is_none_or(|parts| parts.len() > weight),
            None => false,
        });
        for id in order {
            self.extend(id, weight);
        }
        self.known_part(expr.id, weight)
    }

    /// The part of this weight of a node of which it is known.
    fn known_part(&self, id: Id, weight: usize) -> Part<'a> {
        match self.known.get(&id) {
            Some(Some(parts)) => parts.get(weight).cloned().unwrap_or_default(),
            _ if weight == 0 => vec![self.arena.expr(id)],
            _ => Vec::new(),
        }
    }

    fn changes(&self, id: Id) -> bool {
        matches!(self.known.get(&id), Some(Some(_)))
    }

    /// Works out the parts of a node up to this weight, whose operands have theirs.
    fn extend(&mut self, id: Id, weight: usize) {
        let node = self.arena.node(id);
        if !node.operands().any(|operand| self.changes(operand)) {
            // a symbol with a series has it already
            self.known.entry(id).or_insert(None);
            return;
        }
        let from = self.known.get(&id).and_then(Option::as_ref).map_or(0, Vec::len);
        for weight in from..=weight {
            let part = match weight {
                0 => vec![self.arena.expr(self.arena.rebuild(id, |operand| self.at_zero(operand)))],
                _ => self.next(&node, id, weight),
            };
            // a zero at the end says nothing
            let length = part.iter().rposition(|c| !c.is_zero()).map_or(0, |last| last + 1);
            let part = part[..length].to_vec();
            self.known.entry(id).or_insert(None).get_or_insert_with(Vec::new).push(part);
        }
    }

    /// The value of a node whose part of weight 0 is known.
    fn at_zero(&self, id: Id) -> Id {
        let zero = self.arena.zero();
        self.known_part(id, 0).first().copied().unwrap_or(zero).id
    }

    /// The part of a node of a weight above 0.
    fn next(&mut self, node: &Node, id: Id, weight: usize) -> Part<'a> {
        let arena = self.arena;
        match node {
            Node::Number(_) | Node::Symbol(_) => Vec::new(),
            Node::Held(inner) => self.known_part(*inner, weight).into_iter().map(Expr::hold).collect(),
            Node::Sum(sum) => {
                let parts = sum.terms.iter().map(|&(term, c)| (self.known_part(term, weight), c));
                self.combined(parts.collect())
            }
            Node::Product(factors) => self.product(factors, weight),
            Node::Choice([x, y, z]) => {
                let (x, zero) = (arena.expr(self.at_zero(*x)), arena.zero());
                let [y, z] = [*y, *z].map(|branch| self.known_part(branch, weight));
                let at = |part: &Part<'a>, j: usize| part.get(j).copied().unwrap_or(zero);
                (0..y.len().max(z.len())).map(|j| x.choose(at(&y, j), at(&z, j))).collect()
            }
            // S² = f, where only S is divided by
            Node::Function(Function::Sqrt, x) => {
                let inner =
                    (1..weight).map(|b| (id, b, id, weight - b, Number::MINUS_ONE)).collect::<Vec<_>>();
                let mut rest = self.convolved(&inner);
                rest = self.combined(vec![(self.known_part(*x, weight), Number::ONE), (rest, Number::ONE)]);
                let half =
                    arena.expr(self.at_zero(id)).apply(Function::RecipOrZero).scale(Number::ratio(1, 2));
                rest.into_iter().map(|c| c * half).collect()
            }
            Node::Function(Function::RecipOrZero, x) => self.reciprocal(*x, id, weight),
            Node::Function(..) | Node::Power(..) | Node::Atan2(..) => self.by_derivative(id, weight),
        }
    }

    /// `D f = Σ ∂f/∂x D x`
    fn by_derivative(&mut self, id: Id, weight: usize) -> Part<'a> {
        let mut products = Vec::new();
        for (operand, slope) in self.arena.expr(id).partial_derivatives() {
            self.part(slope, weight - 1);
            let share = |b: usize| Number::ratio(b as i128, weight as i128);
            products.extend((1..=weight).map(|b| (operand, b, slope.id, weight - b, share(b))));
        }
        self.convolved(&products)
    }

    /// `R_w = −R_0 Σ_{b≥1} x_b R_{w−b}`
    fn reciprocal(&mut self, x: Id, id: Id, weight: usize) -> Part<'a> {
        let products: Vec<_> = (1..=weight).map(|b| (x, b, id, weight - b, Number::MINUS_ONE)).collect();
        let sum = self.convolved(&products);
        let first = self.arena.expr(self.at_zero(id));
        sum.into_iter().map(|c| c * first).collect()
    }

    /// A product: constant factors, then one factor after the other.
    fn product(&mut self, factors: &[(Id, i32)], weight: usize) -> Part<'a> {
        let arena = self.arena;
        let (changing, constant): (Vec<_>, Vec<_>) =
            factors.iter().copied().partition(|&(factor, _)| self.changes(factor));
        let whole = |factors: &[(Id, i32)]| arena.expr(arena.product(Number::ONE, factors.iter().copied()));
        if !constant.is_empty() {
            let constant = whole(&constant);
            return self.part(whole(&changing), weight).into_iter().map(|c| constant * c).collect();
        }
        match *changing {
            [(x, -1)] => {
                let id = whole(&changing).id;
                self.reciprocal(x, id, weight)
            }
            [(x, exponent)] if exponent < 0 => {
                let root = arena.expr(x).recip();
                self.powers(root, exponent.unsigned_abs(), weight)
            }
            [(x, exponent)] => self.powers(arena.expr(x), exponent.unsigned_abs(), weight),
            _ => {
                let (first, rest) = (whole(&changing[..1]), whole(&changing[1..]));
                self.times(first, rest, weight)
            }
        }
    }

    /// `x^n`, of a square each product of two different parts once.
    fn powers(&mut self, x: Expr<'a>, n: u32, weight: usize) -> Part<'a> {
        if n != 2 {
            let rest = x.powi(n.saturating_sub(1).try_into().unwrap_or(i32::MAX));
            return self.times(x, rest, weight);
        }
        self.part(x, weight);
        let twice = |b: usize| if 2 * b == weight { Number::ONE } else { Number::from(2) };
        let products: Vec<_> = (0..=weight / 2).map(|b| (x.id, b, x.id, weight - b, twice(b))).collect();
        self.convolved(&products)
    }

    fn times(&mut self, x: Expr<'a>, y: Expr<'a>, weight: usize) -> Part<'a> {
        self.part(x, weight);
        self.part(y, weight);
        let products: Vec<_> = (0..=weight).map(|b| (x.id, b, y.id, weight - b, Number::ONE)).collect();
        self.convolved(&products)
    }

    /// The sum of these products of parts, each with its coefficient.
    fn convolved(&self, products: &[(Id, usize, Id, usize, Number)]) -> Part<'a> {
        let mut sums: Vec<Vec<(Id, Number)>> = Vec::new();
        for &(x, a, y, b, coefficient) in products {
            let (x, y) = (self.known_part(x, a), self.known_part(y, b));
            for (i, &x) in x.iter().enumerate() {
                for (j, &y) in y.iter().enumerate() {
                    if x.is_zero() || y.is_zero() {
                        continue;
                    }
                    sums.resize_with(sums.len().max(i + j + 1), Vec::new);
                    sums[i + j].push(((x * y).id, coefficient));
                }
            }
        }
        let sum = |terms| self.arena.expr(self.arena.sum(Number::ZERO, terms));
        sums.into_iter().map(sum).collect()
    }

    /// The sum of these parts, each with its coefficient.
    fn combined(&self, parts: Vec<(Part<'a>, Number)>) -> Part<'a> {
        let length = parts.iter().map(|(part, _)| part.len()).max().unwrap_or(0);
        let at = |j: usize| {
            let terms = parts.iter().filter_map(|(part, c)| Some((part.get(j)?.id, *c)));
            self.arena.expr(self.arena.sum(Number::ZERO, terms.collect::<Vec<_>>()))
        };
        (0..length).map(at).collect()
    }
}
