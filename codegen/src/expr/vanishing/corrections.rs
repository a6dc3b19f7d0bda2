//! Terms of higher order of a step, where a root is zero that they are divided by.

use rustc_hash::FxHashMap;

use super::{Chosen, Vanishing, half};
use crate::expr::linear::Vector;
use crate::expr::node::{Function, Id, Node};
use crate::expr::number::Number;

/// A root that is less counts as zero. In double precision the tenth power of its reciprocal is a number, in single precision the fifth: of such there
/// are in steps of order 6, and in their derivatives.
const LEAST: [f64; 2] = [1e-30, 1e-7];

impl Vector<'_> {
    /// The same where all is regular. Where a root is zero that these terms are divided by, and the `first` terms are not, they are nothing: the energy
    /// is not smooth enough there for what they are made of, and the step has the order that it has without them.
    pub fn without_poles(&self, first: &[&Self], is_single: bool) -> Self {
        let Some(arena) = self.0.first().map(|expr| expr.arena) else { return self.clone() };
        let (mut ids, mut place): (Vec<Id>, _) = (self.iter().map(|expr| expr.id).collect(), 0);
        while let Some(base) = arena.radicand(place) {
            let vanishing = Vanishing::new(arena, base, Chosen::Nothing);
            let mut firsts = first.iter().flat_map(|terms| terms.iter());
            // of what may be less than zero roots are taken in a branch alone
            if arena.is_nonnegative(base)
                && ids.iter().any(|&id| vanishing.is_divided_in(id, true))
                && !firsts.any(|expr| vanishing.is_divided_in(expr.id, false))
            {
                ids = vanishing.smoothed(&ids, LEAST[usize::from(is_single)]);
            }
            place += 1;
        }
        Self(ids.into_iter().map(|id| arena.expr(id)).collect())
    }
}

impl Vanishing<'_> {
    /// Whether anything in it is divided by the base, or may be; or only what is infinite with it.
    fn is_divided_in(&self, root: Id, with_limits: bool) -> bool {
        let is_divided = |id: Id, e: i32| {
            let has_limit = matches!(self.arena.node(id), Node::Function(Function::RecipOrZero, _));
            let is_negative = self.rough_power(id, e).is_some_and(Number::is_negative);
            is_negative && (with_limits || !has_limit) || with_limits && self.uncertain_exponent(id).is_some()
        };
        self.arena.post_order([root], |_| false).into_iter().any(|id| match self.arena.node(id) {
            Node::Product(factors) => factors.iter().any(|&(factor, e)| is_divided(factor, e)),
            _ => is_divided(id, 1),
        })
    }

    /// The exponent of a factor that is a power of the base that is not smooth where that is zero.
    fn rough_power(&self, factor: Id, e: i32) -> Option<Number> {
        let exponent = self.exponent(factor)? * Number::from(i64::from(e));
        let is_smooth = !exponent.is_negative()
            && matches!(exponent.fraction(), Some((_, 1)))
            && matches!(self.arena.node(self.base), Node::Sum(_) | Node::Product(_));
        (!is_smooth).then_some(exponent)
    }

    /// These with powers of the base that are zero with it, if they are not smooth there.
    fn smoothed(&self, roots: &[Id], least: f64) -> Vec<Id> {
        let mut known: FxHashMap<Id, Id> = FxHashMap::default();
        for id in self.arena.post_order(roots.iter().copied(), |_| false) {
            let image = match (self.rough_power(id, 1), self.arena.node(id)) {
                (Some(exponent), _) => self.or_zero(self.power(exponent), least),
                // of an exponent that is no number
                (None, Node::Power(x, _)) if self.exponent(x).is_some() && self.exponent(id).is_none() => {
                    self.or_zero(id, least)
                }
                (None, Node::Product(factors)) => {
                    let factors = factors.iter().map(|&(factor, e)| match self.rough_power(factor, e) {
                        Some(exponent) => (self.or_zero(self.power(exponent), least), 1),
                        None => (known[&factor], e),
                    });
                    self.arena.product(Number::ONE, factors.collect::<Vec<_>>())
                }
                (None, _) => self.arena.rebuild(id, |operand| known[&operand]),
            };
            if image != id {
                self.arena.pass_role(id, image);
            }
            known.insert(id, image);
        }
        roots.iter().map(|id| known[id]).collect()
    }

    /// Whether it is zero where the base is.
    pub(super) fn is_guarded(&self, id: Id) -> bool {
        let Node::Choice([x, _, z]) = self.arena.node(id) else { return false };
        let Node::Sum(sum) = self.arena.node(x) else { return false };
        let is_less = |&(term, c): &(Id, Number)| c.is_negative() && self.exponent(term).is_some();
        self.is_zero(z)
            && !sum.constant.is_zero()
            && !sum.constant.is_negative()
            && sum.terms.iter().all(is_less)
    }

    /// A power of the base where that is not zero. It is a choice: of [`Function::RecipOrZero`] derivatives find anew whether it has a limit.
    fn or_zero(&self, power: Id, least: f64) -> Id {
        let root = self.arena.expr(self.power(half()));
        let least = self.arena.number(Number::Float(least));
        self.arena.choice([(least - root).id, power, self.arena.zero().id])
    }
}
