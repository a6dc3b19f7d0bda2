//! To which order values vanish with the base of a root.

use super::Vanishing;
use super::powered;
use crate::expr::node::{Function, Id, Node, Sum};

impl Vanishing<'_> {
    /// A lower bound of the order to which a node vanishes with the base.
    pub(super) fn order(&mut self, root: Id) -> f64 {
        for id in self.arena.unknown(root, &self.orders) {
            let order = self.order_of_node(id);
            self.orders.insert(id, order);
        }
        self.orders[&root]
    }

    /// The same, when those of what it is made of are known.
    fn order_of_node(&mut self, id: Id) -> f64 {
        if let Some(exponent) = self.exponent(id) {
            return exponent.to_f64();
        }
        match self.arena.node(id) {
            Node::Number(number) if number.is_zero() => f64::INFINITY,
            Node::Number(_) | Node::Symbol(_) | Node::Atan2(..) => 0.0,
            Node::Held(inner) => self.orders[&inner],
            Node::Choice([_, y, z]) => self.orders[&y].min(self.orders[&z]),
            Node::Sum(sum) => self.order_of_sum(id, &sum),
            Node::Product(factors) => {
                let of = |&(factor, e): &(Id, i32)| match self.exponent(factor) {
                    Some(exponent) => exponent.to_f64() * f64::from(e),
                    None => powered(self.orders[&factor], f64::from(e)),
                };
                factors.iter().map(of).sum()
            }
            Node::Function(Function::Sqrt, x) => powered(self.orders[&x], 0.5),
            Node::Function(Function::RecipOrZero, x) => powered(self.orders[&x], -1.0),
            Node::Function(function, x) if function.is_odd() => self.orders[&x].max(0.0),
            Node::Function(Function::Ln, _) => self.change_from_zero(id),
            Node::Function(..) => 0.0,
            Node::Power(x, exponent) => match self.arena.node(exponent) {
                Node::Number(number) => powered(self.orders[&x], number.to_f64()),
                _ => 0.0,
            },
        }
    }

    /// The least order of the terms, or of the sums that vanish of which it is a combination, or of their changes from
    /// terms that add up to zero.
    fn order_of_sum(&mut self, id: Id, sum: &Sum) -> f64 {
        let constant = if sum.constant.is_zero() { f64::INFINITY } else { 0.0 };
        let least = sum.terms.iter().fold(constant, |least, (term, _)| least.min(self.orders[term]));
        if least != 0.0 {
            return least;
        }
        if sum.constant.is_zero() {
            let (rest, order) = self.reduced(sum.terms.iter().copied().collect(), f64::INFINITY);
            // of what was not in the sum there is no more to be known
            let order_of = |term: &Id| self.orders.get(term).copied().unwrap_or(0.0);
            let least = rest.keys().fold(order, |least, term| least.min(order_of(term)));
            if least != 0.0 {
                return least;
            }
        }
        self.change_from_zero(id)
    }

    /// The order of a node that is zero with the base.
    fn change_from_zero(&mut self, id: Id) -> f64 {
        match self.value(id) {
            (Some(value), change) if self.is_zero(value) => change,
            _ => 0.0,
        }
    }

    pub(super) fn is_zero(&self, id: Id) -> bool {
        matches!(self.arena.node(id), Node::Number(number) if number.is_zero())
    }

    fn is_number(&self, id: Option<Id>) -> bool {
        id.is_some_and(|id| matches!(self.arena.node(id), Node::Number(_)))
    }

    /// What a node is where the base is zero, if it is continuous there, and a lower bound of the order of what it is more.
    pub(super) fn value(&mut self, root: Id) -> (Option<Id>, f64) {
        for id in self.arena.unknown(root, &self.values) {
            let value = self.value_of_node(id);
            self.values.insert(id, value);
        }
        self.values[&root]
    }

    /// The same, when those of what it is made of are known.
    fn value_of_node(&self, id: Id) -> (Option<Id>, f64) {
        const UNKNOWN: (Option<Id>, f64) = (None, 0.0);
        let order = self.exponent(id).map(|exponent| exponent.to_f64());
        if let Some(order) = order.or_else(|| self.orders.get(&id).copied()).filter(|&order| order != 0.0) {
            return if order > 0.0 { (Some(self.arena.zero().id), order) } else { UNKNOWN };
        }
        let node = self.arena.node(id);
        if node.operands().all(|operand| self.values[&operand] == (Some(operand), f64::INFINITY)) {
            return (Some(id), f64::INFINITY);
        }
        let of = |operand: &Id| self.values[operand];
        let is_positive = |id: &Id| of(id).0.is_some_and(|value| self.arena.is_positive(value));
        if let Node::Choice([x, y, z]) = node
            && let Some(Node::Number(number)) = of(&x).0.map(|value| self.arena.node(value))
            && !number.is_zero()
        {
            // near to there it is the same branch
            return of(if number.is_negative() { &y } else { &z });
        }
        let change = match &node {
            Node::Number(_) | Node::Symbol(_) => f64::INFINITY,
            Node::Held(inner) => of(inner).1,
            Node::Sum(sum) => sum.terms.iter().fold(f64::INFINITY, |least, (term, _)| least.min(of(term).1)),
            Node::Product(factors) if factors.iter().all(|(factor, e)| *e > 0 || is_positive(factor)) => {
                factors.iter().fold(f64::INFINITY, |least, (factor, _)| least.min(of(factor).1))
            }
            Node::Function(Function::Cos | Function::Cosh, x) if of(x).0.is_some_and(|x| self.is_zero(x)) => {
                2.0 * of(x).1
            }
            Node::Function(
                Function::Exp
                | Function::Sin
                | Function::Cos
                | Function::Sinh
                | Function::Cosh
                | Function::Tanh
                | Function::Atan
                | Function::Stumpff(_),
                x,
            ) => of(x).1,
            // roots of numbers alone: others would be roots to be looked at, too
            Node::Function(Function::Ln, x) if is_positive(x) => of(x).1,
            Node::Function(Function::Sqrt, x) if is_positive(x) && self.is_number(of(x).0) => of(x).1,
            Node::Product(_) | Node::Function(..) | Node::Power(..) | Node::Atan2(..) | Node::Choice(_) => {
                return UNKNOWN;
            }
        };
        if !node.operands().all(|operand| of(&operand).0.is_some()) {
            return UNKNOWN;
        }
        let value = self.arena.rebuild(id, |operand| of(&operand).0.unwrap_or(operand));
        (Some(value), change)
    }
}
