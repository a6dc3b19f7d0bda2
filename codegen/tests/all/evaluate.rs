//! Evaluation of expressions over any number type: the reference that generated code is tested against.

use std::collections::HashMap;

use coadjoint_codegen::expr::{Arena, Expr, Function, Id, Node, Number, Symbol, Vector};

/// A number to evaluate with: `f64`, or one of many digits.
pub trait Value: Clone {
    /// A constant.
    fn number(number: Number) -> Self;
    /// `self + other`
    fn add(&self, other: &Self) -> Self;
    /// `self · other`
    fn mul(&self, other: &Self) -> Self;
    /// `self^exponent`
    fn powi(&self, exponent: i32) -> Self;
    /// `function(self)`
    fn apply(&self, function: Function) -> Self;
    /// `self^exponent`
    fn power(&self, exponent: &Self) -> Self;
    /// `atan2(self, x)`
    fn atan2(&self, x: &Self) -> Self;
    /// `negative` where `self < 0`, `otherwise` elsewhere
    fn choose(&self, negative: &Self, otherwise: &Self) -> Self;
}

/// An expression, or several that share what they are made of.
pub trait Evaluate {
    /// The values: one, or one for each component.
    type Of<V>;
    /// The values, given those of the symbols; what they share is computed once.
    fn evaluate<V: Value>(&self, symbols: &dyn Fn(Symbol) -> V) -> Self::Of<V>;
}

impl Evaluate for Expr<'_> {
    type Of<V> = V;
    fn evaluate<V: Value>(&self, symbols: &dyn Fn(Symbol) -> V) -> V {
        let mut evaluation = Evaluation { symbols, known: HashMap::new() };
        evaluation.visit(self.arena(), &[self.id()]);
        evaluation.known[&self.id()].clone()
    }
}

impl Evaluate for Vector<'_> {
    type Of<V> = Vec<V>;
    fn evaluate<V: Value>(&self, symbols: &dyn Fn(Symbol) -> V) -> Vec<V> {
        let Some(first) = self.0.first() else { return Vec::new() };
        let mut evaluation = Evaluation { symbols, known: HashMap::new() };
        let ids: Vec<Id> = self.iter().map(Expr::id).collect();
        evaluation.visit(first.arena(), &ids);
        ids.iter().map(|id| evaluation.known[id].clone()).collect()
    }
}

struct Evaluation<'f, V> {
    symbols: &'f dyn Fn(Symbol) -> V,
    known: HashMap<Id, V>,
}

impl<V: Value> Evaluation<'_, V> {
    fn visit(&mut self, arena: &Arena, roots: &[Id]) {
        let order = arena.post_order(roots.iter().copied(), |_| false);
        self.known.reserve(order.len());
        for id in order {
            let value = self.value(&arena.node(id));
            self.known.insert(id, value);
        }
    }

    /// The value of a node, when those of its operands are known.
    fn value(&self, node: &Node) -> V {
        let known = |id: Id| &self.known[&id];
        match node {
            Node::Number(number) => V::number(*number),
            Node::Symbol(symbol) => (self.symbols)(*symbol),
            Node::Sum(sum) => {
                let constant = (!sum.constant.is_zero()).then(|| V::number(sum.constant));
                let terms = sum
                    .terms
                    .iter()
                    .map(|&(id, c)| if c.is_one() { known(id).clone() } else { V::number(c).mul(known(id)) });
                let total = constant.into_iter().chain(terms).reduce(|total, term| total.add(&term));
                total.unwrap_or_else(|| V::number(Number::ZERO))
            }
            Node::Product(factors) => {
                let powers = factors.iter().map(|&(id, e)| match e {
                    1 => known(id).clone(),
                    e => known(id).powi(e),
                });
                let product = powers.reduce(|product, power| product.mul(&power));
                product.unwrap_or_else(|| V::number(Number::ONE))
            }
            Node::Held(x) => known(*x).clone(),
            Node::Function(function, x) => known(*x).apply(*function),
            Node::Power(b, e) => known(*b).power(known(*e)),
            Node::Atan2(y, x) => known(*y).atan2(known(*x)),
            Node::Choice([x, y, z]) => known(*x).choose(known(*y), known(*z)),
        }
    }
}

impl Value for f64 {
    fn number(number: Number) -> Self {
        number.to_f64()
    }
    fn add(&self, other: &Self) -> Self {
        self + other
    }
    fn mul(&self, other: &Self) -> Self {
        self * other
    }
    fn powi(&self, exponent: i32) -> Self {
        f64::powi(*self, exponent)
    }
    fn apply(&self, function: Function) -> Self {
        match function {
            Function::Sqrt => self.sqrt(),
            Function::Exp => self.exp(),
            Function::Ln => self.ln(),
            Function::Sin => self.sin(),
            Function::Cos => self.cos(),
            Function::Tan => self.tan(),
            Function::Asin => self.asin(),
            Function::Acos => self.acos(),
            Function::Atan => self.atan(),
            Function::Sinh => self.sinh(),
            Function::Cosh => self.cosh(),
            Function::Tanh => self.tanh(),
            Function::Stumpff(k) => {
                // the definition; good for moderate arguments, which is all the reference is asked for
                let mut term = (1..=k).fold(1.0, |f, i| f / f64::from(i));
                let mut total = term;
                for j in 1..200u32 {
                    let m = f64::from(k + 2 * j);
                    term *= -self / (m * (m - 1.0));
                    total += term;
                }
                total
            }
            Function::RecipOrZero if self.abs() <= f64::MIN_POSITIVE.sqrt() => 0.0,
            Function::RecipOrZero => self.recip(),
            Function::AngleOverSine(k) if *self > 0.0 => {
                // the power series in 1 − cos θ
                let (n, z) = (f64::from(k), (1.0 - self) / 2.0);
                let mut term = (1..=k).map(f64::from).fold(1.0, |f, i| -f * i * i / (2.0 * i + 1.0));
                let mut total = term;
                for j in (0..200u32).map(f64::from) {
                    term *= (n + 1.0 + j).powi(2) * z / ((n + 1.5 + j) * (j + 1.0));
                    total += term;
                }
                total
            }
            Function::AngleOverSine(k) => {
                // (1 − c²) a⁽ⁿ⁺¹⁾ = (2n + 1) c a⁽ⁿ⁾ + n² a⁽ⁿ⁻¹⁾, and −1 in the place of the last term for n = 0
                let below = 1.0 - self * self;
                let (mut last, mut now) = (-1.0, self.acos() / below.sqrt());
                for n in (0..k).map(f64::from) {
                    let factor = if n == 0.0 { 1.0 } else { n * n };
                    (last, now) = (now, ((2.0 * n + 1.0) * self * now + factor * last) / below);
                }
                now
            }
        }
    }
    fn power(&self, exponent: &Self) -> Self {
        self.powf(*exponent)
    }
    fn atan2(&self, x: &Self) -> Self {
        f64::atan2(*self, *x)
    }
    fn choose(&self, negative: &Self, otherwise: &Self) -> Self {
        if *self < 0.0 { *negative } else { *otherwise }
    }
}
