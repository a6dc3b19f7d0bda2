//! One function's statements: which values get names, which are written out where they are used.

use rustc_hash::{FxHashMap, FxHashSet};

use super::dag::{Dag, Op, Operation, Signed};
use super::hoist::{Homes, Outline};
use super::names::{Locals, Names};
use super::reassociate::reassociated;
use crate::expr::{Function, Stage};
use crate::program::{RecordKind, Statement, Term, Value};

/// Trees of more operations than this are cut by a named value: longer lines cannot be read.
const LARGEST_TERM: usize = 12;

/// Writes one function.
pub(super) struct Writer<'l, 'a> {
    dag: &'l Dag<'a>,
    placement: &'l Homes,
    names: &'l mut Names,
    locals: Locals,
    record: Option<RecordKind>,
    /// How often each value is used.
    uses: FxHashMap<Op, u32>,
    /// Those of them that something uses whole, not as a divisor alone: `1/x` where a product divides by `x` is none.
    used_undivided: FxHashSet<Op>,
    /// The values that the function stores.
    storing: FxHashSet<Op>,
    values: FxHashMap<Op, Value>,
    /// Values without names, to be written where they are used.
    terms: FxHashMap<Op, Term>,
    statements: Vec<Statement>,
}

/// A function's body: statements and results.
type Body = (Vec<Statement>, Vec<Vec<Term>>);

impl<'l, 'a> Writer<'l, 'a> {
    /// The body of a function that stores these values.
    pub(super) fn body<R>(
        dag: &'l Dag<'a>,
        placement: &'l Homes,
        names: &'l mut Names,
        returned: &Outline<R>,
        storing: &[Op],
    ) -> Body {
        let mut layout = Self {
            dag,
            placement,
            names,
            locals: Locals::default(),
            record: returned.record,
            uses: FxHashMap::default(),
            used_undivided: FxHashSet::default(),
            storing: storing.iter().copied().collect(),
            values: FxHashMap::default(),
            terms: FxHashMap::default(),
            statements: Vec::new(),
        };
        let roots = storing.iter().copied().chain(returned.results().map(|signed| signed.op));
        layout.count_uses(roots.collect());
        storing.iter().for_each(|&op| layout.visit(op));
        let mut written = |signed: &Signed| {
            layout.visit(signed.op);
            let term = layout.term(signed.op);
            if signed.negative { Term::Negative(Box::new(term)) } else { term }
        };
        let results: Vec<Vec<Term>> =
            returned.results.iter().map(|array| array.iter().map(&mut written).collect()).collect();
        layout.lines(results, returned.record == Some(RecordKind::Iterate))
    }

    /// The statements and results with sums in their last order, and the longest of them in several lines.
    fn lines(mut self, results: Vec<Vec<Term>>, associate: bool) -> Body {
        let mut statements = Vec::new();
        for statement in std::mem::take(&mut self.statements) {
            let mut last = |term| self.line(term, associate, &mut statements);
            let statement = match statement {
                Statement::Let { value, term } => Statement::Let { value, term: last(term) },
                Statement::Stumpff { values, argument } => {
                    Statement::Stumpff { values, argument: last(argument) }
                }
            };
            statements.push(statement);
        }
        let mut last = |term| self.line(term, associate, &mut statements);
        let results = results.into_iter().map(|array| array.into_iter().map(&mut last).collect());
        let results = results.collect();
        (statements, results)
    }

    /// A term in its last order, after lines for the beginnings of long sums.
    fn line(&mut self, term: Term, associate: bool, statements: &mut Vec<Statement>) -> Term {
        reassociated(term, associate, &mut |sum| {
            let value = self.names.part(&mut self.locals);
            statements.push(Statement::Let { value, term: sum });
            Term::Value(value)
        })
    }

    fn count_uses(&mut self, roots: Vec<Op>) {
        // a root is used as it is, whatever else makes use of it
        self.used_undivided.extend(roots.iter().copied());
        let mut pending = roots;
        let mut visited = Vec::new();
        while let Some(op) = pending.pop() {
            let count = self.uses.entry(op).or_default();
            *count += 1;
            if *count == 1 && !self.is_given(op) {
                visited.push(op);
                pending.extend(self.dag.operation(op).operands());
            }
        }
        for op in visited {
            for operand in self.dag.operation(op).operands() {
                if self.denominator(op, operand).is_none() {
                    self.used_undivided.insert(operand);
                }
            }
        }
    }

    fn is_given(&self, op: Op) -> bool {
        self.placement.is_given(self.dag, self.record, op)
    }

    /// `x`, if a product divides by it in the place of multiplying by its factor `1/x`. A reciprocal of its own rounds
    /// once more, and only pays where it is used again and time counts.
    fn denominator(&self, product: Op, factor: Op) -> Option<Op> {
        match (self.dag.operation(product), self.dag.operation(factor)) {
            (Operation::Product(_), Operation::Quotient(number, x))
                if number.is_one()
                    && !self.is_given(factor)
                    && (self.dag.stage(product) == Stage::Parameters || self.uses[&factor] == 1) =>
            {
                Some(*x)
            }
            _ => None,
        }
    }

    /// Writes a value, after all that it is made of.
    fn visit(&mut self, root: Op) {
        let mut pending = vec![(root, false)];
        while let Some((op, ready)) = pending.pop() {
            if self.is_given(op) || self.values.contains_key(&op) || self.terms.contains_key(&op) {
                continue;
            }
            if ready {
                self.finish(op);
                continue;
            }
            pending.push((op, true));
            pending.extend(self.dag.operation(op).operands().into_iter().rev().map(|x| (x, false)));
        }
    }

    /// Names a value whose operands are written, or leaves it to be written where it is used.
    fn finish(&mut self, op: Op) {
        if self.dag.stumpff_argument(op).is_some() {
            return self.name_stumpff(op);
        }
        let is_quotient = matches!(self.dag.operation(op), Operation::Quotient(..));
        let term = self.write(op);
        if is_quotient && !self.used_undivided.contains(&op) {
            self.terms.insert(op, term);
            return;
        }
        let has_role = match self.record {
            // what is not named is summed together with what it is added to
            Some(RecordKind::Iterate) => self.names.role(op).is_some(),
            _ => self.names.role(op).is_some() || self.names.is_negative_of_role(op),
        };
        let named = (has_role && !is_quotient) || self.uses[&op] > 1 || self.storing.contains(&op);
        if named || term.operations().total() > LARGEST_TERM {
            let value = self.value(op);
            self.statements.push(Statement::Let { value, term });
        } else {
            self.terms.insert(op, term);
        }
    }

    /// A named value or one that is written out here.
    fn term(&self, op: Op) -> Term {
        match self.dag.operation(op) {
            Operation::Number(number) => return Term::Number(*number),
            Operation::Symbol(symbol) => return Term::Value(self.names.of_plan(*symbol)),
            _ => {}
        }
        if let Some(value) = self.values.get(&op) {
            return Term::Value(*value);
        }
        if self.is_given(op)
            && let Some(value) = self.names.stored(op)
        {
            return Term::Value(value);
        }
        self.terms[&op].clone()
    }

    fn value(&mut self, op: Op) -> Value {
        let stored = self.names.stored(op).filter(|_| self.storing.contains(&op));
        let value = match stored {
            Some(value) => value,
            None => self.names.local(self.dag, op, &mut self.locals),
        };
        self.values.insert(op, value);
        value
    }

    /// Computes all Stumpff functions of one argument that this function owns.
    fn name_stumpff(&mut self, op: Op) {
        let Some(argument) = self.dag.stumpff_argument(op) else { return };
        let member = |other: Op| match self.dag.operation(other) {
            Operation::Function(Function::Stumpff(k), z)
                if *z == argument && self.uses.contains_key(&other) && !self.is_given(other) =>
            {
                Some((*k as usize, other))
            }
            _ => None,
        };
        let members: Vec<(usize, Op)> = self.dag.ops().filter_map(member).collect();
        let mut values: Vec<Option<Value>> = Vec::new();
        for (k, member) in members {
            values.resize(values.len().max(k + 1), None);
            values[k] = Some(self.value(member));
        }
        let argument = self.term(argument);
        self.statements.push(Statement::Stumpff { values, argument });
    }

    /// The operation written out.
    fn write(&self, op: Op) -> Term {
        let boxed = |op: Op| Box::new(self.term(op));
        match self.dag.operation(op) {
            Operation::Number(_) | Operation::Symbol(_) => self.term(op),
            Operation::Sum(addends) => {
                Term::Sum(addends.iter().map(|&(negative, addend)| (negative, self.term(addend))).collect())
            }
            Operation::Product(factors) => {
                let (mut above, mut below) = (Vec::new(), Vec::new());
                for &factor in factors {
                    match (self.denominator(op, factor), self.dag.operation(factor)) {
                        (Some(x), _) => below.push(self.term(x)),
                        (None, Operation::Number(_)) => above.insert(0, self.term(factor)),
                        (None, _) => above.push(self.term(factor)),
                    }
                }
                let above = product(above).unwrap_or_else(|| Term::Number(1.into()));
                match product(below) {
                    Some(below) => Term::Quotient(Box::new(above), Box::new(below)),
                    None => above,
                }
            }
            Operation::Quotient(number, x) => Term::Quotient(Box::new(Term::Number(*number)), boxed(*x)),
            Operation::Function(function, x) => Term::Function(*function, boxed(*x)),
            Operation::Power(x, y) => Term::Power(boxed(*x), boxed(*y)),
            Operation::Atan2(y, x) => Term::Atan2(boxed(*y), boxed(*x)),
            Operation::Choice(operands) => Term::Choice(operands.map(boxed)),
        }
    }
}

fn product(mut factors: Vec<Term>) -> Option<Term> {
    match factors.len() {
        0 => None,
        1 => factors.pop(),
        _ => Some(Term::Product(factors)),
    }
}
