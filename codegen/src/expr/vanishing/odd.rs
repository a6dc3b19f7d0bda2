//! Odd functions of a root, and what they are over that root: smooth functions of what it is taken of.

use super::{Chosen, Vanishing, half};
use crate::expr::expression::Expr;
use crate::expr::node::{Function, Id, Node, Sum};
use crate::expr::number::Number;

impl<'a> Vanishing<'a> {
    /// Whether it is an odd function of the root, times what depends on its square alone; or `1 − eʸ` of one, times what is continuous.
    pub(super) fn is_odd(&mut self, root: Id) -> bool {
        for id in self.arena.unknown(root, &self.odd) {
            let is_odd = match (self.exponent(id), self.arena.node(id)) {
                (Some(exponent), _) => exponent >= half(),
                (None, Node::Held(inner)) => self.odd[&inner],
                (None, Node::Sum(sum)) => match self.of_exponential(&sum) {
                    Some(y) => self.odd[&y],
                    None => sum.constant.is_zero() && sum.terms.iter().all(|(term, _)| self.odd[term]),
                },
                (None, Node::Product(factors)) => {
                    factors.iter().any(|(factor, e)| *e > 0 && self.odd[factor])
                }
                (None, Node::Function(Function::Acos, x)) => {
                    // what the root is taken of in the derivative
                    (self.arena.one() - self.arena.expr(x).powi(2)).id == self.base
                }
                (None, Node::Function(Function::Tanh, _)) if self.has_series() => false,
                (None, Node::Function(function, x)) => function.is_odd() && self.odd[&x],
                (None, Node::Atan2(y, _)) => self.odd[&y],
                (None, Node::Number(_) | Node::Symbol(_) | Node::Power(..) | Node::Choice(_)) => false,
            };
            self.odd.insert(id, is_odd);
        }
        self.odd[&root]
    }

    /// The `y` of a multiple of `1 − eʸ`, in forces and in derivatives that are not taken again.
    fn of_exponential(&self, sum: &Sum) -> Option<Id> {
        match (&sum.terms[..], sum.constant) {
            _ if self.chosen == Chosen::Nothing || self.has_series() => None,
            (&[(term, c)], constant) if !constant.is_zero() && c == -constant => {
                match self.arena.node(term) {
                    Node::Function(Function::Exp, y) => Some(y),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// Whether what comes of it is to have a power series: Stumpff functions have none by a recurrence.
    fn has_series(&self) -> bool {
        self.chosen == Chosen::Parameters { series: true }
    }

    /// The quotient of what is odd by the root.
    pub(super) fn over_root(&mut self, id: Id) -> Id {
        if let Some(exponent) = self.exponent(id) {
            return self.power(exponent + -half());
        }
        let expr = |id: Id| self.arena.expr(id);
        let one = self.arena.one();
        // θ/sin θ over ρ, at cos θ = w/ρ: the angle over y, where y = ρ sin θ
        let angle = |w: Expr<'_>, squared: Id| {
            let rho = expr(squared).sqrt();
            self.arena.function(Function::AngleOverSine(0), (expr(w.id) / rho).id)
        };
        match self.arena.node(id) {
            Node::Held(inner) => self.over_root(inner),
            Node::Sum(sum) => {
                if let Some(y) = self.of_exponential(&sum) {
                    // 1 − eʸ = −tanh(y/2) (1 + eʸ), where nothing cancels
                    let tanh = expr(y).scale(half()).apply(Function::Tanh).id;
                    let quotient = expr(self.over_root(tanh)) * (one + expr(y).apply(Function::Exp));
                    return quotient.scale(-sum.constant).id;
                }
                let terms: Vec<_> = sum.terms.iter().map(|&(x, c)| (self.over_root(x), c)).collect();
                self.arena.sum(Number::ZERO, terms)
            }
            Node::Product(factors) => {
                let mut factors = factors.to_vec();
                let place = factors.iter().position(|&(factor, e)| e > 0 && self.is_odd(factor));
                if let Some(place) = place {
                    factors[place].1 -= 1;
                    let quotient = self.over_root(factors[place].0);
                    factors.push((quotient, 1));
                }
                self.arena.product(Number::ONE, factors)
            }
            Node::Function(Function::Acos, x) => self.arena.function(Function::AngleOverSine(0), x),
            Node::Function(function, x) => {
                let z = expr(x).powi(2);
                let smooth = match function {
                    Function::Sin => z.stumpff(1),
                    Function::Sinh => (-z).stumpff(1),
                    Function::Tan => z.stumpff(1) / z.stumpff(0),
                    Function::Tanh => {
                        // from 20 on it is 1, to the last digit, and hyperbolic functions overflow
                        let beyond = z - self.arena.number(400);
                        let large = self.arena.number(400) + beyond.choose(self.arena.zero(), beyond);
                        beyond.choose((-z).stumpff(1) / (-z).stumpff(0), one / large.sqrt())
                    }
                    Function::Asin => (one - z).sqrt().apply(Function::AngleOverSine(0)),
                    _ => expr(angle(one, (one + z).id)) / (one + z).sqrt(),
                };
                (smooth * expr(self.over_root(x))).id
            }
            Node::Atan2(y, x) => {
                let squared = expr(y).powi(2) + expr(x).powi(2);
                (expr(angle(expr(x), squared.id)) / squared.sqrt() * expr(self.over_root(y))).id
            }
            _ => id,
        }
    }
}
