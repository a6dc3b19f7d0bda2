//! Divisions, of all operations those that take longest: what can be done beside them does not wait for them.

use rustc_hash::{FxHashMap, FxHashSet};

use super::dag::{Dag, Op, Operation};
use crate::expr::{Function, Stage};

impl Dag<'_> {
    /// Shortens the chains of operations that wait for one another at a division `1/x`, of all operations the one that
    /// takes longest. `equation` is what the step's equation is made of.
    pub(super) fn shorten_divisions(&mut self, equation: &FxHashSet<Op>) {
        let reciprocals: Vec<(Op, Op)> = self
            .ops()
            .filter(|&op| self.stage(op) == Stage::Iteration)
            .filter_map(|op| match self.operation(op) {
                Operation::Quotient(one, x) if one.is_one() => Some((op, *x)),
                _ => None,
            })
            .collect();
        let mut users: FxHashMap<Op, Vec<Op>> = reciprocals.iter().map(|&(op, _)| (op, Vec::new())).collect();
        for op in self.ops() {
            for operand in self.operation(op).operands() {
                if let Some(users) = users.get_mut(&operand).filter(|users| users.last() != Some(&op)) {
                    users.push(op);
                }
            }
        }
        for (op, x) in reciprocals {
            self.take_root_beside(op, x);
            self.divide_multiple(op, x, &users[&op], equation);
        }
    }

    /// `√(1/x) = √x · 1/x`: the root does not wait for the quotient.
    fn take_root_beside(&mut self, reciprocal: Op, x: Op) {
        let root = Operation::Function(Function::Sqrt, reciprocal);
        if let Some(root) = self.find(&root) {
            let of_x = self.intern(Operation::Function(Function::Sqrt, x));
            self.replace(root, Operation::Product(vec![reciprocal, of_x]));
        }
    }

    /// Where the equation asks for `2 · 1/x`, the quotient is `2/x` and `1/x` the half of it: their digits are the
    /// same, and the equation waits for the multiple.
    fn divide_multiple(&mut self, reciprocal: Op, x: Op, users: &[Op], equation: &FxHashSet<Op>) {
        let multiple =
            users.iter().filter(|op| equation.contains(op)).find_map(|&op| match self.operation(op) {
                Operation::Product(factors) if factors.len() == 2 => {
                    factors.iter().find_map(|&factor| match self.operation(factor) {
                        Operation::Number(number) if number.scales_exactly() => Some((op, *number)),
                        _ => None,
                    })
                }
                _ => None,
            });
        if let Some((multiple, number)) = multiple {
            let back = self.intern(Operation::Number(number.powi(-1)));
            self.replace(multiple, Operation::Quotient(number, x));
            self.replace(reciprocal, Operation::Product(vec![back, multiple]));
        }
    }
}
