//! Sums whose terms have no limits, and what they are together: multiplied out, or put together where they cancel.

use std::collections::BTreeMap;

use super::{FEW, Factors, Monomial, POSITIVE, Vanishing, powered};
use crate::expr::node::{Function, Id, Node, Sum};
use crate::expr::number::Number;

/// The terms of a sum that is looked through for some that cancel, at most.
const SHORT: usize = 3;

impl Vanishing<'_> {
    /// A product with a sum of few terms among its factors as a sum of products, if each of these has a limit.
    pub(super) fn multiplied_out(&mut self, rest: &[(Id, i32)], power: Number, around: f64) -> Option<Id> {
        let (place, sum) = rest.iter().enumerate().find_map(|(place, &(factor, e))| {
            let sum = self.addends(factor).filter(|_| e == 1)?;
            (sum.constant.is_zero() && sum.terms.len() <= FEW).then_some((place, sum))
        })?;
        let mut terms = Vec::new();
        for &(term, c) in sum.terms.iter() {
            let mut factors = rest.to_vec();
            factors[place].0 = term;
            let Monomial { power, rest, .. } =
                self.simplified(&[factors, vec![(self.power(power), 1)]].concat());
            let total = rest.iter().fold(around + power.to_f64(), |total, &(factor, e)| {
                total + powered(self.order(factor), f64::from(e))
            });
            let has_limit = !power.is_negative() || total > POSITIVE;
            if !has_limit && (total <= -POSITIVE || self.zero_with(&rest).is_none()) {
                return None;
            }
            let factors = [rest, vec![(self.power(power), 1)]].concat();
            terms.push((self.limit_of_product(&factors, around), c));
        }
        Some(self.arena.sum(Number::ZERO, terms))
    }

    /// Terms that have no limit each, with functions that are one at zero, are put together where they differ in factors that do not vanish, and cancel:
    /// `x e⁻ʳ/r − x (1 + r) e⁻ʳ/r = −x e⁻ʳ`.
    pub(super) fn together(&mut self, terms: &[(Id, Number)], around: f64) -> Vec<(Id, Number)> {
        let is_one_at_zero = |&(factor, e): &(Id, i32)| {
            use Function::{Cos, Cosh, Exp};
            let node = self.arena.node(factor);
            matches!(node, Node::Function(Exp | Cos | Cosh, _)) || e < 0 && matches!(node, Node::Sum(_))
        };
        let may_cancel = |&(term, _): &(Id, Number)| match self.arena.node(term) {
            Node::Product(factors) => factors.iter().any(is_one_at_zero),
            _ => false,
        };
        // derivatives of higher order have many terms: there it costs more than it finds
        if terms.len() > SHORT || !terms.iter().any(may_cancel) {
            return terms.to_vec();
        }
        // by the power of the base and the factors that vanish: of which terms, with which other factors
        let mut alike: BTreeMap<(u64, Factors), Vec<(usize, Factors)>> = BTreeMap::new();
        for (place, &(term, _)) in terms.iter().enumerate() {
            let Node::Product(factors) = self.arena.node(term) else { continue };
            if !self.is_divided(term) {
                continue;
            }
            let Monomial { power, rest, .. } = self.monomial(&factors);
            let (mut small, mut regular, mut total) = (Vec::new(), Vec::new(), around + power.to_f64());
            for (factor, e) in rest {
                let order = self.order(factor);
                total += powered(order, f64::from(e));
                if order > 0.0 { small.push((factor, e)) } else { regular.push((factor, e)) }
            }
            if power.is_negative() && total <= POSITIVE && total > -POSITIVE {
                small.sort_unstable();
                alike.entry((power.to_f64().to_bits(), small)).or_default().push((place, regular));
            }
        }
        let mut all = terms.to_vec();
        for ((_, mut small), group) in alike.into_iter().filter(|(_, group)| group.len() > 1) {
            let regular = |(place, factors): &(usize, Factors)| {
                let regular = self.arena.product(Number::ONE, factors.clone());
                (regular, terms[*place].1, regular)
            };
            let Some(spread) = self.spread(&group.iter().map(regular).collect::<Vec<_>>()) else { continue };
            let sum = self.arena.sum(Number::ZERO, spread);
            if self.order(sum) <= POSITIVE {
                continue;
            }
            let Node::Product(factors) = self.arena.node(terms[group[0].0].0) else { continue };
            small.extend([(self.power(self.monomial(&factors).power), 1), (sum, 1)]);
            all.push((self.arena.product(Number::ONE, small), Number::ONE));
            let put_together: Vec<Id> = group.iter().map(|(place, _)| terms[*place].0).collect();
            all.retain(|(term, _)| !put_together.contains(term));
        }
        all
    }

    /// The place of a sum among factors that is made of terms that cancel, and what it is multiplied out.
    pub(super) fn cancelled(&mut self, rest: &[(Id, i32)]) -> Option<(usize, Id)> {
        rest.iter().enumerate().filter(|(_, (_, e))| *e == 1).find_map(|(place, &(factor, _))| {
            let Some(&known) = self.cancelled.get(&factor) else {
                let found = self.without_cancelling(factor);
                self.cancelled.insert(factor, found);
                return Some((place, found?));
            };
            Some((place, known?))
        })
    }

    /// A sum that vanishes though its terms do not, multiplied out to terms that do.
    fn without_cancelling(&mut self, id: Id) -> Option<Id> {
        let sum = self.addends(id)?;
        if self.order(id) <= POSITIVE || self.all_vanish(&sum) {
            return None;
        }
        let of_constant = (!sum.constant.is_zero()).then(|| (self.arena.one().id, sum.constant));
        let group = sum.terms.iter().copied().chain(of_constant).map(|(term, c)| (term, c, term));
        let spread = self.arena.sum(Number::ZERO, self.spread(&group.collect::<Vec<_>>())?);
        let is_small = match self.arena.node(spread) {
            Node::Sum(sum) => self.all_vanish(&sum),
            _ => self.order(spread) > POSITIVE,
        };
        is_small.then_some(spread)
    }

    /// Whether each term of a sum vanishes with the base.
    fn all_vanish(&mut self, sum: &Sum) -> bool {
        sum.constant.is_zero() && sum.terms.iter().all(|&(term, _)| self.order(term) > POSITIVE)
    }

    /// The sum of what is regular in terms, with sums among its factors multiplied out, if that makes few terms.
    fn spread(&self, group: &[(Id, Number, Id)]) -> Option<Vec<(Id, Number)>> {
        let mut all = Vec::new();
        for &(_, c, regular) in group {
            let mut terms = vec![(self.arena.one().id, c)];
            let factors = match self.arena.node(regular) {
                Node::Product(factors) => factors.to_vec(),
                _ => vec![(regular, 1)],
            };
            for (factor, e) in factors {
                let sum = self.addends(factor).filter(|_| e == 1);
                let addends = match sum {
                    Some(Sum { constant, terms }) => {
                        let constant = (!constant.is_zero()).then_some((self.arena.one().id, constant));
                        terms.iter().copied().chain(constant).collect()
                    }
                    None => vec![(self.arena.product(Number::ONE, [(factor, e)]), Number::ONE)],
                };
                let products = terms.iter().flat_map(|&(x, a)| {
                    let of = move |&(y, b): &(Id, Number)| {
                        (self.arena.product(Number::ONE, [(x, 1), (y, 1)]), a * b)
                    };
                    addends.iter().map(of).collect::<Vec<_>>()
                });
                terms = products.collect();
                if terms.len() > FEW * FEW {
                    return None;
                }
            }
            all.extend(terms);
        }
        Some(all)
    }

    /// A sum, kept whole or not.
    pub(super) fn addends(&self, id: Id) -> Option<Sum> {
        match self.arena.node(id) {
            Node::Sum(sum) => Some(sum),
            Node::Held(inner) => self.addends(inner),
            _ => None,
        }
    }
}
