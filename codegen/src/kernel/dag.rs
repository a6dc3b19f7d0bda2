//! From canonical expressions to operations: which partial sums and products exist, and at which stage.
//!
//! Canonical sums and products are flat, whatever the stages of their operands. Here each is split so that what can be
//! computed earlier is one operand of its own.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use crate::expr::{Arena, Expr, Function, Id, Node, Number, Stage, Symbol};

/// A node of a dag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Op(pub(super) u32);

/// The operation of a node.
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
    Choice([Op; 3]),
}

impl Operation {
    pub(super) fn operands(&self) -> Vec<Op> {
        match self {
            Self::Number(_) | Self::Symbol(_) => Vec::new(),
            Self::Sum(addends) => addends.iter().map(|&(_, op)| op).collect(),
            Self::Product(factors) => factors.clone(),
            Self::Quotient(_, x) | Self::Function(_, x) => vec![*x],
            Self::Power(x, y) | Self::Atan2(x, y) => vec![*x, *y],
            Self::Choice(operands) => operands.to_vec(),
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
pub(super) struct Dag<'a> {
    arena: &'a Arena,
    operations: Vec<Operation>,
    stages: Vec<Stage>,
    index: FxHashMap<Operation, Op>,
    known: FxHashMap<Id, Signed>,
}

impl<'a> Dag<'a> {
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

    pub(super) fn ops(&self) -> impl ExactSizeIterator<Item = Op> + use<> {
        (0..self.operations.len() as u32).map(Op)
    }

    /// The node that was made for an operation, if there is one.
    pub(super) fn find(&self, operation: &Operation) -> Option<Op> {
        self.index.get(operation).copied()
    }

    /// Computes a node in another way, which has to come to the same. Nodes are in no topological order then, and are
    /// found by what they were made for.
    pub(super) fn replace(&mut self, op: Op, operation: Operation) {
        self.operations[op.0 as usize] = operation;
    }

    /// The node planned for an expression, if it has been planned.
    pub(super) fn planned(&self, id: Id) -> Option<Signed> {
        self.known.get(&id).copied()
    }

    pub(super) fn intern(&mut self, operation: Operation) -> Op {
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

    /// Plans a node after all that it is made of, with a stack of its own: a graph may be deeper than any other.
    ///
    /// An operation is planned as soon as its operands are, so that operations are numbered as they come. A node that
    /// lacks an operand is tried again behind it; the addends that a sum has so far are kept.
    fn visit(&mut self, root: Id) -> Signed {
        let mut open: Vec<(Id, Vec<Signed>)> = vec![(root, Vec::new())];
        while let Some((id, addends)) = open.last_mut() {
            match self.node(*id, addends) {
                Ok(signed) => {
                    self.known.insert(*id, signed);
                    open.pop();
                }
                Err(operand) => open.push((operand, Vec::new())),
            }
        }
        self.known[&root]
    }

    /// A node whose operands are planned.
    ///
    /// # Errors
    /// The first operand that is not.
    fn node(&mut self, id: Id, addends: &mut Vec<Signed>) -> Result<Signed, Id> {
        if let Some(&known) = self.known.get(&id) {
            return Ok(known);
        }
        Ok(match self.arena.node(id) {
            Node::Number(number) => self.number(number),
            Node::Symbol(symbol) => positive(self.intern(Operation::Symbol(symbol))),
            Node::Sum(sum) => {
                for &(term, coefficient) in &sum.terms[addends.len()..] {
                    addends.push(match self.arena.node(term) {
                        _ if coefficient.abs().is_one() => {
                            self.operand(term)?.flip(coefficient.is_negative())
                        }
                        Node::Product(factors) => self.product(coefficient, &factors)?,
                        _ => self.product(coefficient, &[(term, 1)])?,
                    });
                }
                if !sum.constant.is_zero() {
                    addends.push(self.number(sum.constant));
                }
                self.staged_sum(std::mem::take(addends))
            }
            Node::Product(factors) => self.product(Number::ONE, &factors)?,
            Node::Held(inner) => self.operand(inner)?,
            Node::Function(function, argument) => {
                let argument = self.value(argument)?;
                positive(self.intern(Operation::Function(function, argument)))
            }
            Node::Power(base, exponent) => {
                let (base, exponent) = (self.value(base)?, self.value(exponent)?);
                positive(self.intern(Operation::Power(base, exponent)))
            }
            Node::Atan2(y, x) => {
                let (y, x) = (self.value(y)?, self.value(x)?);
                positive(self.intern(Operation::Atan2(y, x)))
            }
            Node::Choice([x, y, z]) => {
                let operands = [self.value(x)?, self.value(y)?, self.value(z)?];
                positive(self.intern(Operation::Choice(operands)))
            }
        })
    }

    /// An operand, or its node where it is not planned.
    fn operand(&self, id: Id) -> Result<Signed, Id> {
        self.planned(id).ok_or(id)
    }

    /// A node with the value itself, not its negative.
    fn value(&mut self, id: Id) -> Result<Op, Id> {
        let signed = self.operand(id)?;
        Ok(if signed.negative { self.intern(Operation::Sum(vec![(true, signed.op)])) } else { signed.op })
    }

    fn number(&mut self, number: Number) -> Signed {
        Signed { negative: number.is_negative(), op: self.intern(Operation::Number(number.abs())) }
    }

    /// A sum of the partial sums of each stage: earlier parts are computed earlier, and small late changes are summed
    /// before they are added to what they change.
    fn staged_sum(&mut self, addends: Vec<Signed>) -> Signed {
        let mut by_stage: BTreeMap<Stage, Vec<Signed>> = BTreeMap::new();
        for addend in addends {
            by_stage.entry(self.stage(addend.op)).or_default().push(addend);
        }
        let mut parts: Vec<Signed> = by_stage.into_values().map(|part| self.sum(part)).collect();
        let first = parts.remove(0);
        parts.into_iter().fold(first, |earlier, part| self.sum(vec![earlier, part]))
    }

    /// The sum in this order; the sign of a constant goes outside, else that of the first addend, so that `a − b` and
    /// `b − a` are one node.
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
    fn product(&mut self, coefficient: Number, factors: &[(Id, i32)]) -> Result<Signed, Id> {
        let mut negative = coefficient.is_negative();
        let mut by_stage: BTreeMap<Stage, Vec<Op>> = BTreeMap::new();
        for &(id, exponent) in factors {
            let base = self.operand(id)?;
            negative ^= base.negative && exponent % 2 != 0;
            let factor =
                if exponent < 0 { self.intern(Operation::Quotient(Number::ONE, base.op)) } else { base.op };
            let power = self.power(factor, exponent.unsigned_abs());
            by_stage.entry(self.stage(factor)).or_default().extend(power);
        }
        let magnitude = coefficient.abs();
        if !magnitude.is_one() {
            // the constant belongs where it costs least: to the earliest part
            let number = self.intern(Operation::Number(magnitude));
            match by_stage.values_mut().next() {
                Some(earliest) => earliest.push(number),
                None => return Ok(Signed { negative, op: number }),
            }
        }
        // what comes last is multiplied by the product of all before in one product, so that any two of its factors can
        // be shared
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
        Ok(Signed { negative, op })
    }

    /// The factors whose product is `base^exponent`: by squaring, where that saves a multiplication.
    fn power(&mut self, base: Op, mut exponent: u32) -> Vec<Op> {
        if exponent < 4 {
            return vec![base; exponent as usize];
        }
        let (mut square, mut factors) = (base, Vec::new());
        loop {
            if exponent % 2 == 1 {
                factors.push(square);
            }
            exponent /= 2;
            if exponent == 0 {
                return factors;
            }
            square = self.multiply(vec![square, square]);
        }
    }

    fn multiply(&mut self, mut factors: Vec<Op>) -> Op {
        if let [one] = factors.as_slice() {
            return *one;
        }
        factors.sort(); // a product is the same in any order
        self.intern(Operation::Product(factors))
    }
}

fn positive(op: Op) -> Signed {
    Signed { negative: false, op }
}
