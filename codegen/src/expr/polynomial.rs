//! Polynomials in expressions, multiplied out.
//!
//! A derivation in many steps leaves sums of products of sums, most of which cancel or come together once they are
//! multiplied out. What is left is written by Horner's scheme.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use super::arena::Arena;
use super::expression::Expr;
use super::node::{Id, Node, Stage};
use super::number::Number;

/// Exponents of the variables, so many bits each.
type Monomial = u128;
const BITS: usize = 6;

/// The highest bit of each exponent: no exponent has it, so that two of them add up to one that has room.
const HIGHEST: Monomial = {
    let (mut bits, mut place) = (0, 0);
    while place < VARIABLES {
        bits |= 1 << (BITS * place + BITS - 1);
        place += 1;
    }
    bits
};

/// How many variables there may be, constants included.
const VARIABLES: usize = 128 / BITS;

/// The terms of a polynomial, each with its coefficient.
type Terms = BTreeMap<Monomial, Number>;

/// How many terms any polynomial may have that occurs on the way, and how many products of terms may be made.
const TERMS: usize = 10_000;
const PRODUCTS: usize = 700_000;

impl<'a> Expr<'a> {
    /// The same function, multiplied out and written by Horner's scheme, if it is a polynomial of few terms in what is
    /// not known before a step begins.
    pub fn multiplied_out(self) -> Option<Self> {
        let mut expansion = Expansion { arena: self.arena, variables: Vec::new(), products: 0 };
        let terms = expansion.of(self)?;
        Some(expansion.horner(terms))
    }
}

struct Expansion<'a> {
    arena: &'a Arena,
    /// Variables, and constants behind them in the order in which they are met.
    variables: Vec<Id>,
    products: usize,
}

impl<'a> Expansion<'a> {
    fn of(&mut self, root: Expr<'a>) -> Option<Terms> {
        let arena = self.arena;
        let is_constant = |id: Id| arena.expr(id).stage() == Stage::Parameters;
        let mut known: FxHashMap<Id, Terms> = FxHashMap::default();
        for id in arena.post_order([root.id], |_| false) {
            let of = |operand: &Id| known.get(operand);
            let terms = match arena.node(id) {
                Node::Number(number) => constant(number),
                Node::Symbol(_) => self.variable(id)?,
                Node::Held(_) if is_constant(id) => self.variable(id)?,
                Node::Held(inner) => of(&inner)?.clone(),
                Node::Sum(sum) => {
                    let mut total = constant(sum.constant);
                    for (term, c) in sum.terms.iter() {
                        for (&monomial, &coefficient) in of(term)? {
                            add(&mut total, monomial, *c * coefficient);
                        }
                    }
                    total
                }
                Node::Product(factors) => {
                    let mut product = constant(Number::ONE);
                    for &(factor, exponent) in factors.iter() {
                        let (terms, times) = match exponent {
                            0.. => (of(&factor)?.clone(), exponent),
                            _ if is_constant(factor) => {
                                (self.variable(arena.expr(factor).recip().id)?, -exponent)
                            }
                            _ => return None,
                        };
                        for _ in 0..times {
                            product = self.times(&product, &terms)?;
                        }
                    }
                    product
                }
                _ if is_constant(id) => self.variable(id)?,
                _ => return None,
            };
            if terms.len() > TERMS {
                return None;
            }
            known.insert(id, terms);
        }
        known.remove(&root.id)
    }

    /// A variable by itself, if there is room for it.
    fn variable(&mut self, id: Id) -> Option<Terms> {
        let place = self.variables.iter().position(|&known| known == id).unwrap_or(self.variables.len());
        if place == self.variables.len() {
            self.variables.push(id);
        }
        (place < VARIABLES).then(|| Terms::from([(1 << (BITS * place), Number::ONE)]))
    }

    fn times(&mut self, one: &Terms, other: &Terms) -> Option<Terms> {
        self.products += one.len() * other.len();
        if self.products > PRODUCTS {
            return None;
        }
        let products = one.iter().flat_map(|(&x, &a)| other.iter().map(move |(&y, &b)| (x + y, a * b)));
        let mut products: Vec<(Monomial, Number)> = products.collect();
        if products.iter().any(|(monomial, _)| monomial & HIGHEST != 0) {
            return None;
        }
        products.sort_unstable_by_key(|&(monomial, _)| monomial);
        let mut product: Vec<(Monomial, Number)> = Vec::new();
        for (monomial, c) in products {
            match product.last_mut() {
                Some((last, sum)) if *last == monomial => *sum = *sum + c,
                _ => product.push((monomial, c)),
            }
        }
        Some(product.into_iter().filter(|(_, c)| !c.is_zero()).collect())
    }

    /// Horner's scheme: in the variables of the step first, so that constants stand together.
    fn horner(&self, terms: Terms) -> Expr<'a> {
        let arena = self.arena;
        let stage = |place: usize| arena.expr(self.variables[place]).stage();
        let counts = |wanted: bool| {
            let places =
                (0..self.variables.len()).filter(|&place| (stage(place) > Stage::Parameters) == wanted);
            let count = |place: usize| terms.keys().filter(|&&term| exponent(term, place) > 0).count();
            places
                .map(|place| (count(place), place))
                .filter(|(count, _)| *count > 0)
                .max_by_key(|&(count, place)| (count, std::cmp::Reverse(place)))
        };
        let Some((_, place)) = counts(true).or_else(|| counts(false)) else {
            return terms.into_values().map(|c| arena.number(c)).fold(arena.zero(), |sum, c| sum + c);
        };
        let (with, without): (Terms, Terms) = terms
            .iter()
            .map(|(&monomial, &c)| (monomial, c))
            .partition(|&(monomial, _)| exponent(monomial, place) > 0);
        // the lowest power that occurs: that of an even function is a square
        let lowest = with.keys().map(|&monomial| exponent(monomial, place)).min().unwrap_or(1);
        let rest = with.into_iter().map(|(monomial, c)| (monomial - ((lowest as u128) << (BITS * place)), c));
        let rest = self.horner(rest.collect());
        let power = arena.expr(self.variables[place]).powi(lowest as i32);
        let power = if lowest > 1 { power.hold() } else { power };
        let product = rest.hold() * power;
        if without.is_empty() { product } else { product + self.horner(without) }
    }
}

fn constant(number: Number) -> Terms {
    if number.is_zero() { Terms::new() } else { Terms::from([(0, number)]) }
}

fn add(terms: &mut Terms, monomial: Monomial, coefficient: Number) {
    let entry = terms.entry(monomial).or_insert(Number::ZERO);
    *entry = *entry + coefficient;
    if entry.is_zero() {
        terms.remove(&monomial);
    }
}

fn exponent(monomial: Monomial, place: usize) -> u32 {
    (monomial >> (BITS * place)) as u32 & ((1 << BITS) - 1)
}
