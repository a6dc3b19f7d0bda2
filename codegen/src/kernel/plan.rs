//! From canonical expressions to operations: which partial sums and products exist, and at which stage.
//!
//! Canonical sums and products are flat, whatever the stages of their operands. Here each is split so that what can be computed
//! earlier is one operand of its own, and pairs of operands that occur in several places become shared nodes.

use std::collections::{BTreeMap, BTreeSet};

use rustc_hash::FxHashMap;

use crate::expr::{Arena, Expr, Function, Id, Node, Number, Stage, Symbol};

/// A node of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Op(u32);

/// What a node computes.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Operation {
    /// A positive constant.
    Number(Number),
    Symbol(Symbol),
    /// Addends, `true` for those subtracted.
    Sum(Vec<(bool, Op)>),
    Product(Vec<Op>),
    /// A positive constant by a value.
    Quotient(Number, Op),
    Function(Function, Op),
    Power(Op, Op),
    Atan2(Op, Op),
}

impl Operation {
    pub(super) fn operands(&self) -> Vec<Op> {
        match self {
            Self::Number(_) | Self::Symbol(_) => Vec::new(),
            Self::Sum(addends) => addends.iter().map(|&(_, op)| op).collect(),
            Self::Product(factors) => factors.clone(),
            Self::Quotient(_, x) | Self::Function(_, x) => vec![*x],
            Self::Power(x, y) | Self::Atan2(x, y) => vec![*x, *y],
        }
    }

    pub(super) fn is_leaf(&self) -> bool {
        matches!(self, Self::Number(_) | Self::Symbol(_))
    }
}

/// A value: a node or its negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Signed {
    pub negative: bool,
    pub op: Op,
}

impl Signed {
    fn flip(self, flip: bool) -> Self {
        Self { negative: self.negative ^ flip, op: self.op }
    }
}

/// All operations of a kernel.
pub(super) struct Plan<'a> {
    arena: &'a Arena,
    operations: Vec<Operation>,
    stages: Vec<Stage>,
    index: FxHashMap<Operation, Op>,
    known: FxHashMap<Id, Signed>,
}

impl<'a> Plan<'a> {
    pub(super) fn new(arena: &'a Arena) -> Self {
        Self {
            arena,
            operations: Vec::new(),
            stages: Vec::new(),
            index: FxHashMap::default(),
            known: FxHashMap::default(),
        }
    }

    pub(super) fn operation(&self, op: Op) -> &Operation {
        &self.operations[op.0 as usize]
    }

    pub(super) fn stage(&self, op: Op) -> Stage {
        self.stages[op.0 as usize]
    }

    pub(super) fn ops(&self) -> impl Iterator<Item = Op> {
        (0..self.operations.len() as u32).map(Op)
    }

    /// The node planned for an expression, if it has been planned.
    pub(super) fn planned(&self, id: Id) -> Option<Signed> {
        self.known.get(&id).copied()
    }

    fn intern(&mut self, operation: Operation) -> Op {
        if let Some(&op) = self.index.get(&operation) {
            return op;
        }
        let stage = match &operation {
            Operation::Number(_) => Stage::Parameters,
            Operation::Symbol(symbol) => self.arena.symbol_info(*symbol).stage,
            other => other.operands().into_iter().map(|op| self.stage(op)).max().unwrap_or(Stage::Parameters),
        };
        let op = Op(self.operations.len() as u32);
        self.operations.push(operation.clone());
        self.stages.push(stage);
        self.index.insert(operation, op);
        op
    }

    /// Plans an expression.
    pub(super) fn plan(&mut self, expr: Expr<'a>) -> Signed {
        self.visit(expr.id())
    }

    /// `a − b`, kept as that difference.
    pub(super) fn difference(&mut self, a: Signed, b: Signed) -> Signed {
        self.sum(vec![a, b.flip(true)])
    }

    fn visit(&mut self, id: Id) -> Signed {
        if let Some(&known) = self.known.get(&id) {
            return known;
        }
        let signed = match self.arena.node(id) {
            Node::Number(number) => self.number(number),
            Node::Symbol(symbol) => positive(self.intern(Operation::Symbol(symbol))),
            Node::Sum(sum) => {
                let mut addends: Vec<Signed> = sum
                    .terms
                    .iter()
                    .map(|&(term, coefficient)| match self.arena.node(term) {
                        _ if coefficient.abs().is_one() => self.visit(term).flip(coefficient.is_negative()),
                        Node::Product(factors) => self.product(coefficient, &factors),
                        _ => self.product(coefficient, &[(term, 1)]),
                    })
                    .collect();
                if !sum.constant.is_zero() {
                    addends.push(self.number(sum.constant));
                }
                self.staged_sum(addends)
            }
            Node::Product(factors) => self.product(Number::ONE, &factors),
            Node::Held(inner) => self.visit(inner),
            Node::Function(function, argument) => {
                let argument = self.value(argument);
                positive(self.intern(Operation::Function(function, argument)))
            }
            Node::Power(base, exponent) => {
                let (base, exponent) = (self.value(base), self.value(exponent));
                positive(self.intern(Operation::Power(base, exponent)))
            }
            Node::Atan2(y, x) => {
                let (y, x) = (self.value(y), self.value(x));
                positive(self.intern(Operation::Atan2(y, x)))
            }
        };
        self.known.insert(id, signed);
        signed
    }

    /// A node with the value itself, not its negative.
    fn value(&mut self, id: Id) -> Op {
        let signed = self.visit(id);
        if signed.negative { self.intern(Operation::Sum(vec![(true, signed.op)])) } else { signed.op }
    }

    fn number(&mut self, number: Number) -> Signed {
        Signed { negative: number.is_negative(), op: self.intern(Operation::Number(number.abs())) }
    }

    /// A sum of the partial sums of each stage: earlier parts are computed earlier, and small late changes are summed before they
    /// are added to what they change.
    fn staged_sum(&mut self, addends: Vec<Signed>) -> Signed {
        let mut by_stage: BTreeMap<Stage, Vec<Signed>> = BTreeMap::new();
        for addend in addends {
            by_stage.entry(self.stage(addend.op)).or_default().push(addend);
        }
        let mut parts: Vec<Signed> = by_stage.into_values().map(|part| self.sum(part)).collect();
        let first = parts.remove(0);
        parts.into_iter().fold(first, |earlier, part| self.sum(vec![earlier, part]))
    }

    /// The sum in this order; the sign of a constant goes outside, else that of the first addend, so that `a − b` and `b − a` are one node.
    fn sum(&mut self, mut addends: Vec<Signed>) -> Signed {
        if let [one] = addends.as_slice() {
            return *one;
        }
        addends.sort_by_key(|addend| addend.op);
        let is_constant = |addend: &&Signed| matches!(self.operation(addend.op), Operation::Number(_));
        let flip = addends.iter().find(is_constant).unwrap_or(&addends[0]).negative;
        let addends = addends.into_iter().map(|addend| (addend.negative ^ flip, addend.op)).collect();
        Signed { negative: flip, op: self.intern(Operation::Sum(addends)) }
    }

    /// `coefficient · Π factor^exponent` as a product of the partial products of each stage.
    fn product(&mut self, coefficient: Number, factors: &[(Id, i32)]) -> Signed {
        let mut negative = coefficient.is_negative();
        let mut by_stage: BTreeMap<Stage, Vec<Op>> = BTreeMap::new();
        for &(id, exponent) in factors {
            let base = self.visit(id);
            negative ^= base.negative && exponent % 2 != 0;
            let factor =
                if exponent < 0 { self.intern(Operation::Quotient(Number::ONE, base.op)) } else { base.op };
            let part = by_stage.entry(self.stage(factor)).or_default();
            part.extend(std::iter::repeat_n(factor, exponent.unsigned_abs() as usize));
        }
        let magnitude = coefficient.abs();
        if !magnitude.is_one() {
            // the constant belongs where it costs least: to the earliest part
            let number = self.intern(Operation::Number(magnitude));
            match by_stage.values_mut().next() {
                Some(earliest) => earliest.push(number),
                None => return Signed { negative, op: number },
            }
        }
        // what comes last is multiplied by the product of all before in one product, so that any two of its factors can be shared
        let mut parts = by_stage.into_values().peekable();
        let mut earlier: Option<Op> = None;
        while let Some(mut part) = parts.next() {
            if parts.peek().is_some() {
                part = vec![self.multiply(part)];
            }
            part.extend(earlier);
            earlier = Some(self.multiply(part));
        }
        let op = earlier.unwrap_or_else(|| self.intern(Operation::Number(Number::ONE)));
        Signed { negative, op }
    }

    fn multiply(&mut self, mut factors: Vec<Op>) -> Op {
        if let [one] = factors.as_slice() {
            return *one;
        }
        factors.sort(); // a product is the same in any order
        self.intern(Operation::Product(factors))
    }

    /// Shortens the chains of operations that wait for one another at a division `1/x`, of all operations the one that takes longest.
    pub(super) fn shorten_divisions(&mut self) {
        let late: Vec<Op> = self.ops().filter(|op| self.stage(*op) == Stage::Iteration).collect();
        for op in late {
            if let &Operation::Quotient(one, x) = self.operation(op)
                && one.is_one()
            {
                self.take_root_beside(op, x);
                self.divide_multiple(op, x);
            }
        }
    }

    /// `√(1/x) = √x · 1/x`: the root does not wait for the quotient.
    fn take_root_beside(&mut self, reciprocal: Op, x: Op) {
        let root = Operation::Function(Function::Sqrt, reciprocal);
        if let Some(&root) = self.index.get(&root) {
            let of_x = self.intern(Operation::Function(Function::Sqrt, x));
            self.operations[root.0 as usize] = Operation::Product(vec![reciprocal, of_x]);
        }
    }

    /// Where `2 · 1/x` is asked for, beside `1/x`, the quotient is `2/x` and `1/x` the half of it: their digits are the same, and the step's
    /// equation waits for the multiple.
    fn divide_multiple(&mut self, reciprocal: Op, x: Op) {
        let users: Vec<Op> =
            self.ops().filter(|op| self.operation(*op).operands().contains(&reciprocal)).collect();
        let multiple = users.iter().find_map(|&op| match self.operation(op) {
            Operation::Product(factors) if factors.len() == 2 => {
                factors.iter().find_map(|&factor| match self.operation(factor) {
                    Operation::Number(number) if number.scales_exactly() => Some((op, *number)),
                    _ => None,
                })
            }
            _ => None,
        });
        if let Some((multiple, number)) = multiple
            && users.len() > 1
        {
            let back = self.intern(Operation::Number(number.powi(-1)));
            self.operations[multiple.0 as usize] = Operation::Quotient(number, x);
            self.operations[reciprocal.0 as usize] = Operation::Product(vec![back, multiple]);
        }
    }

    /// Makes pairs of operands that occur in several sums or products nodes of their own, the most frequent first.
    pub(super) fn share_pairs(&mut self) {
        let mut census = Census::default();
        for (index, operation) in self.operations.iter().enumerate() {
            census.count(index, operation);
        }
        while let Some(pair) = census.most_frequent() {
            let before = self.operations.len();
            let shared = match pair {
                Pair::Factors(a, b) => self.intern(Operation::Product(vec![a, b])),
                Pair::Addends(a, b, opposed) => self.intern(Operation::Sum(vec![(false, a), (opposed, b)])),
            };
            if self.operations.len() > before {
                census.count(before, &self.operations[before]);
            }
            for index in census.holders(&pair) {
                if index != shared.0 as usize {
                    census.forget(index, &self.operations[index]);
                    while pair.replace(&mut self.operations[index], shared) {}
                    census.count(index, &self.operations[index]);
                }
            }
        }
    }
}

/// Which pairs occur in which operations.
#[derive(Default)]
struct Census {
    /// The operations a pair occurs in, `true` for those of more than two operands, which it would shorten.
    holders: FxHashMap<Pair, BTreeMap<usize, bool>>,
    /// The pairs worth a node: those that occur twice and would shorten something, by how often they occur, the oldest last.
    worthy: BTreeSet<(usize, std::cmp::Reverse<Pair>)>,
}

impl Census {
    fn count(&mut self, index: usize, operation: &Operation) {
        let long = operation.operands().len() > 2;
        for pair in Pair::all(operation) {
            self.change(pair, |holders| {
                holders.insert(index, long);
            });
        }
    }

    fn forget(&mut self, index: usize, operation: &Operation) {
        for pair in Pair::all(operation) {
            self.change(pair, |holders| {
                holders.remove(&index);
            });
        }
    }

    fn change(&mut self, pair: Pair, change: impl FnOnce(&mut BTreeMap<usize, bool>)) {
        let holders = self.holders.entry(pair).or_default();
        self.worthy.remove(&(holders.len(), std::cmp::Reverse(pair)));
        change(holders);
        if holders.len() >= 2 && holders.values().any(|&long| long) {
            self.worthy.insert((holders.len(), std::cmp::Reverse(pair)));
        }
    }

    fn most_frequent(&self) -> Option<Pair> {
        self.worthy.last().map(|&(_, std::cmp::Reverse(pair))| pair)
    }

    fn holders(&self, pair: &Pair) -> Vec<usize> {
        self.holders.get(pair).map(|holders| holders.keys().copied().collect()).unwrap_or_default()
    }
}

fn positive(op: Op) -> Signed {
    Signed { negative: false, op }
}

/// Two operands that occur together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Pair {
    Factors(Op, Op),
    /// `true` if the signs differ.
    Addends(Op, Op, bool),
}

impl Pair {
    fn of_addends((m, a): (bool, Op), (n, b): (bool, Op)) -> Self {
        Self::Addends(a.min(b), a.max(b), m != n)
    }

    /// The pairs of an operation's operands, each once. A node of two operands is the pair itself: it counts as an occurrence of it.
    fn all(operation: &Operation) -> Vec<Self> {
        let mut pairs: Vec<Self> = Vec::new();
        match operation {
            Operation::Product(factors) => {
                for (i, &a) in factors.iter().enumerate() {
                    pairs.extend(factors[i + 1..].iter().map(|&b| Self::Factors(a.min(b), a.max(b))));
                }
            }
            Operation::Sum(addends) => {
                for (i, &a) in addends.iter().enumerate() {
                    pairs.extend(addends[i + 1..].iter().map(|&b| Self::of_addends(a, b)));
                }
            }
            _ => {}
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// Where two addends make the pair. An operand may occur more than once, so places count, not operands.
    fn places(&self, addends: &[(bool, Op)]) -> Option<(usize, usize)> {
        let mut places = (0..addends.len()).flat_map(|i| (i + 1..addends.len()).map(move |j| (i, j)));
        places.find(|&(i, j)| Self::of_addends(addends[i], addends[j]) == *self)
    }

    fn occurs(&self, operation: &Operation) -> bool {
        match (self, operation) {
            (Self::Factors(a, b), Operation::Product(factors)) => {
                let count = |op: &Op| factors.iter().filter(|factor| *factor == op).count();
                if a == b { count(a) >= 2 } else { count(a) >= 1 && count(b) >= 1 }
            }
            (Self::Addends(..), Operation::Sum(addends)) => self.places(addends).is_some(),
            _ => false,
        }
    }

    /// Puts `shared` in the place of one occurrence, if there is one.
    fn replace(&self, operation: &mut Operation, shared: Op) -> bool {
        if operation.operands().len() <= 2 || !self.occurs(operation) {
            return false;
        }
        match (self, operation) {
            (Self::Factors(a, b), Operation::Product(factors)) => {
                for op in [a, b] {
                    if let Some(at) = factors.iter().position(|factor| factor == op) {
                        factors.remove(at);
                    }
                }
                factors.push(shared);
                factors.sort();
            }
            (Self::Addends(first, ..), Operation::Sum(addends)) => {
                let Some((i, j)) = self.places(addends) else { return false };
                let later = addends.remove(j);
                let earlier = addends.remove(i);
                // the pair has the sign of its first operand
                let sign = if earlier.1 == *first { earlier.0 } else { later.0 };
                addends.push((sign, shared));
                addends.sort_by_key(|&(_, op)| op);
            }
            _ => return false,
        }
        true
    }
}
