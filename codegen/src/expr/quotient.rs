//! Expressions as quotients.

use rustc_hash::FxHashMap;

use super::expression::Expr;
use super::node::{Id, Node, Symbol};
use super::number::Number;

/// What is known of a node.
#[derive(Clone, Copy)]
enum Form {
    /// It holds no quotient by what depends on the symbols.
    Whole,
    /// `numerator / denominator`
    Quotient(Id, Id),
    /// Anything else with a quotient in it.
    Other,
}

impl<'a> Expr<'a> {
    /// Numerator and denominator of a quotient by what depends on these symbols, or by 1 if there is no such quotient in
    /// it. None if there are several, or one that is no factor of all.
    pub fn as_quotient(self, symbols: &[Symbol]) -> Option<(Self, Self)> {
        let arena = self.arena;
        let mut forms: FxHashMap<Id, (Form, bool)> = FxHashMap::default();
        for id in arena.post_order([self.id], |_| false) {
            let node = arena.node(id);
            let depends = match node {
                Node::Symbol(symbol) => symbols.contains(&symbol),
                _ => node.operands().any(|operand| forms[&operand].1),
            };
            let form = form(self, &node, &forms);
            forms.insert(id, (form, depends));
        }
        match forms[&self.id].0 {
            Form::Whole => Some((self, arena.one())),
            Form::Quotient(numerator, denominator) => Some((arena.expr(numerator), arena.expr(denominator))),
            Form::Other => None,
        }
    }
}

/// What a node is, made of what its operands are; true of these is whether they depend on the symbols.
fn form(of: Expr<'_>, node: &Node, forms: &FxHashMap<Id, (Form, bool)>) -> Form {
    let arena = of.arena;
    match node {
        Node::Held(inner) => match forms[inner].0 {
            Form::Quotient(numerator, denominator) => {
                let (number, numerator) = arena.expr(numerator).split_number();
                Form::Quotient(numerator.hold().scale(number).id, denominator)
            }
            form => form,
        },
        Node::Sum(sum) => {
            let mut terms = Vec::new();
            let mut common = None;
            for &(term, coefficient) in sum.terms.iter() {
                match forms[&term].0 {
                    Form::Quotient(numerator, denominator)
                        if *common.get_or_insert(denominator) == denominator =>
                    {
                        terms.push((numerator, coefficient));
                    }
                    Form::Whole => {}
                    _ => return Form::Other,
                }
            }
            match common {
                None => Form::Whole,
                Some(denominator) if terms.len() == sum.terms.len() && sum.constant.is_zero() => {
                    Form::Quotient(arena.sum(Number::ZERO, terms), denominator)
                }
                Some(_) => Form::Other,
            }
        }
        Node::Product(all) => {
            let mut factors = Vec::new();
            let mut denominator = None;
            for &(factor, exponent) in all.iter() {
                let (form, depends) = forms[&factor];
                match form {
                    Form::Whole if exponent == -1 && depends && denominator.is_none() => {
                        denominator = Some(factor)
                    }
                    Form::Whole if exponent > 0 || !depends => factors.push((factor, exponent)),
                    Form::Quotient(numerator, by) if exponent == 1 && denominator.is_none() => {
                        denominator = Some(by);
                        factors.push((numerator, 1));
                    }
                    _ => return Form::Other,
                }
            }
            match denominator {
                None => Form::Whole,
                Some(denominator) => Form::Quotient(arena.product(Number::ONE, factors), denominator),
            }
        }
        _ if node.operands().all(|operand| matches!(forms[&operand].0, Form::Whole)) => Form::Whole,
        _ => Form::Other,
    }
}
