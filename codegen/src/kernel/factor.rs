//! Pulls common factors out of sums: `x a + x b` becomes `x (a + b)`.
//!
//! Derivatives come out as sums of products in which whole groups of factors repeat. Factoring them shortens the sums,
//! and the sums left in parentheses are often the same in several places, where hash-consing then shares them.

use rustc_hash::FxHashMap;

use crate::expr::{Arena, Expr, Id, Node, Number, Sum};

/// Rewrites expressions together, so that what they share stays shared.
pub(super) struct Factoring<'a> {
    arena: &'a Arena,
    /// How often each node is an operand or an output: a product used elsewhere is not worth taking apart.
    uses: FxHashMap<Id, u32>,
    known: FxHashMap<Id, Id>,
}

impl<'a> Factoring<'a> {
    pub(super) fn new(arena: &'a Arena, outputs: impl IntoIterator<Item = Expr<'a>>) -> Self {
        let mut uses: FxHashMap<Id, u32> = FxHashMap::default();
        let mut pending: Vec<Id> = outputs.into_iter().map(Expr::id).collect();
        while let Some(id) = pending.pop() {
            let count = uses.entry(id).or_default();
            *count += 1;
            if *count == 1 {
                pending.extend(arena.node(id).operands());
            }
        }
        Self { arena, uses, known: FxHashMap::default() }
    }

    pub(super) fn of(&mut self, expr: Expr<'a>) -> Expr<'a> {
        let arena = self.arena;
        for id in arena.unknown(expr.id(), &self.known) {
            let result = match arena.node(id) {
                Node::Sum(sum) => self.sum(&sum),
                _ => arena.rebuild(id, |operand| self.known(operand)),
            };
            self.known.insert(id, result);
        }
        arena.expr(self.known(expr.id()))
    }

    /// The image of a node; itself, if it was not met.
    pub(super) fn known(&self, id: Id) -> Id {
        self.known.get(&id).copied().unwrap_or(id)
    }

    fn sum(&self, sum: &Sum) -> Id {
        let mut loose = Vec::new();
        let mut fixed = Vec::new();
        for &(id, coefficient) in sum.terms.iter() {
            let visited = self.known(id);
            match self.arena.node(visited) {
                Node::Product(factors) if self.uses.get(&id).is_none_or(|&uses| uses <= 1) => {
                    loose.push(Monomial { coefficient, factors: factors.to_vec() });
                }
                Node::Sum(inner) if inner.is_scaled_term() => {
                    let (base, scale) = inner.terms[0];
                    fixed.push((base, coefficient * scale));
                }
                _ => fixed.push((visited, coefficient)),
            }
        }
        fixed.extend(self.collect_factors(loose).into_iter().map(|id| (id, Number::ONE)));
        self.arena.sum(sum.constant, fixed)
    }

    /// The sum of the terms, as addends with the most frequent factors pulled out.
    fn collect_factors(&self, mut terms: Vec<Monomial>) -> Vec<Id> {
        let arena = self.arena;
        let mut addends = Vec::new();
        while let Some(common) = most_frequent(&terms) {
            let (with, without): (Vec<Monomial>, Vec<Monomial>) =
                terms.into_iter().partition(|term| term.factors.iter().any(|&factor| pulls(factor, common)));
            let inner = self.collect_factors(with.into_iter().map(|term| term.without(common)).collect());
            let sums = inner.iter().filter(|&&id| matches!(arena.node(id), Node::Sum(_))).count();
            let mut inner = arena.sum(Number::ZERO, inner.into_iter().map(|id| (id, Number::ONE)));
            // sums that were factored each by itself may have more in common
            if sums > 1
                && let Node::Sum(sum) = arena.node(inner)
            {
                inner = self.sum(&sum);
            }
            addends.push(arena.product(Number::ONE, [(inner, 1), common]));
            terms = without;
        }
        addends.extend(terms.into_iter().map(|term| arena.product(term.coefficient, term.factors)));
        addends
    }
}

/// `coefficient · Π factor^exponent`
#[derive(Clone)]
struct Monomial {
    coefficient: Number,
    factors: Vec<(Id, i32)>,
}

impl Monomial {
    /// The term over `common`, which it contains.
    fn without(mut self, common: (Id, i32)) -> Self {
        for (id, exponent) in &mut self.factors {
            if *id == common.0 {
                *exponent -= common.1;
            }
        }
        self.factors.retain(|&(_, exponent)| exponent != 0);
        self
    }
}

/// `factor` contains `common`, which is `x` or `1/x`.
fn pulls(factor: (Id, i32), common: (Id, i32)) -> bool {
    factor.0 == common.0 && factor.1.signum() == common.1
}

/// The factor, `x` or `1/x`, that occurs in most terms, if it occurs in two; of equals the oldest.
fn most_frequent(terms: &[Monomial]) -> Option<(Id, i32)> {
    let mut counts: FxHashMap<(Id, i32), u32> = FxHashMap::default();
    for term in terms {
        for &(id, exponent) in &term.factors {
            *counts.entry((id, exponent.signum())).or_default() += 1;
        }
    }
    // a maximum over unique keys does not depend on the order of the map
    let best = counts.into_iter().filter(|&(_, count)| count >= 2);
    best.max_by_key(|&(factor, count)| (count, std::cmp::Reverse(factor))).map(|(factor, _)| factor)
}
