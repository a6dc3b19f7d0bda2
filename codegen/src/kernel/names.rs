//! What values are called: by their role, by what they are made of if that is short, else after the value that they are computed for, so
//! that a change of one term changes the names that it concerns and no others.

use std::rc::Rc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::dag::{Dag, Op, Operation};
use super::factor::Factoring;
use crate::expr::{Arena, Function, Symbol};
use crate::program::Value;

/// The names of a module.
#[derive(Default)]
pub(super) struct Names {
    /// By value.
    all: Vec<String>,
    /// Those that every function may see: symbols and stored values.
    shared: FxHashSet<String>,
    symbols: FxHashMap<Symbol, Value>,
    stored: FxHashMap<Op, Value>,
    /// Names that the method gave.
    roles: FxHashMap<Op, String>,
    /// What the method named is the negative of these: `minus_jacobian_12`.
    negatives: FxHashMap<Op, String>,
    /// For each value the next one with a name that it is computed for.
    consumers: FxHashMap<Op, Rc<str>>,
}

/// Products of more factors than this are not described by them.
const LONGEST_DESCRIPTION: usize = 3;

/// The names that are in use in one function beside the [shared](Names) ones.
#[derive(Default)]
pub(super) struct Locals {
    used: FxHashSet<String>,
    /// How many values have been numbered for each consumer.
    numbered: FxHashMap<Rc<str>, usize>,
}

impl Names {
    /// Names the symbols of a plan, in the order of creation: users' names come first, so that ours give way.
    pub(super) fn name_symbols<'a>(&mut self, arena: &'a Arena, plan: &Dag<'a>) {
        let symbol = |op: Op| match plan.operation(op) {
            Operation::Symbol(symbol) => Some(*symbol),
            _ => None,
        };
        let mut all: Vec<Symbol> = plan.ops().filter_map(symbol).collect();
        all.sort();
        for symbol in all {
            let value = self.share(arena.symbol_info(symbol).name);
            self.symbols.insert(symbol, value);
        }
    }

    /// Takes over role names for the nodes that their expressions became.
    pub(super) fn adopt_roles<'a>(&mut self, arena: &'a Arena, factoring: &Factoring<'a>, plan: &Dag<'a>) {
        for (id, name) in arena.roles() {
            if let Some(signed) = plan.planned(factoring.known(id))
                && !plan.operation(signed.op).is_leaf()
            {
                match signed.negative {
                    false => self.roles.entry(signed.op).or_insert(name),
                    true => self.negatives.entry(signed.op).or_insert(format!("minus_{name}")),
                };
            }
        }
    }

    /// Notes for which values with names the others are computed: of several, for the first that is met from the outputs, which are given
    /// with what they are called.
    pub(super) fn note_consumers(&mut self, plan: &Dag<'_>, outputs: impl IntoIterator<Item = (Op, String)>) {
        for (op, name) in outputs {
            let mut pending: Vec<(Op, Rc<str>)> = vec![(op, name.into())];
            while let Some((op, consumer)) = pending.pop() {
                if self.consumers.contains_key(&op) {
                    continue;
                }
                let own = self.role(op).or(self.negatives.get(&op).map(String::as_str)).map(Rc::from);
                let consumer = own.unwrap_or(consumer);
                let operands = plan.operation(op).operands();
                pending.extend(operands.into_iter().rev().map(|operand| (operand, Rc::clone(&consumer))));
                self.consumers.insert(op, consumer);
            }
        }
    }

    /// The role name of a node, if it has one.
    pub(super) fn role(&self, op: Op) -> Option<&str> {
        self.roles.get(&op).map(String::as_str)
    }

    /// Whether the negative of a node has a role.
    pub(super) fn is_negative_of_role(&self, op: Op) -> bool {
        self.negatives.contains_key(&op)
    }

    /// The value of a symbol, if it is used.
    pub(super) fn symbol(&self, symbol: Symbol) -> Option<Value> {
        self.symbols.get(&symbol).copied()
    }

    /// The value of a symbol of the plan.
    pub(super) fn of_plan(&self, symbol: Symbol) -> Value {
        self.symbols[&symbol]
    }

    /// The value of a node that was [stored](Self::store).
    pub(super) fn stored(&self, op: Op) -> Option<Value> {
        self.stored.get(&op).copied()
    }

    /// Names a value that a record stores.
    pub(super) fn store(&mut self, plan: &Dag<'_>, op: Op) {
        let value = match plan.operation(op) {
            Operation::Symbol(symbol) => self.symbols[symbol],
            _ => match self.own_name(plan, op) {
                Some(name) => self.share(name),
                None => {
                    let consumer = self.consumer(op);
                    let mut place = 1;
                    while self.shared.contains(&format!("{consumer}_{place}")) {
                        place += 1;
                    }
                    self.share(format!("{consumer}_{place}"))
                }
            },
        };
        self.stored.insert(op, value);
    }

    /// Names a value within one function.
    pub(super) fn local(&mut self, plan: &Dag<'_>, op: Op, locals: &mut Locals) -> Value {
        let name = match self.own_name(plan, op) {
            Some(mut name) => {
                while self.shared.contains(&name) || locals.used.contains(&name) {
                    name.push('_');
                }
                name
            }
            None => self.numbered(self.consumer(op), locals),
        };
        locals.used.insert(name.clone());
        self.value(name)
    }

    /// Names the beginning of a long sum.
    pub(super) fn part(&mut self, locals: &mut Locals) -> Value {
        let name = self.numbered("sum".into(), locals);
        locals.used.insert(name.clone());
        self.value(name)
    }

    /// The next free number behind a name.
    fn numbered(&self, stem: Rc<str>, locals: &mut Locals) -> String {
        let count = locals.numbered.entry(Rc::clone(&stem)).or_default();
        loop {
            *count += 1;
            let name = format!("{stem}_{count}");
            if !(self.shared.contains(&name) || locals.used.contains(&name)) {
                return name;
            }
        }
    }

    /// All names, by value.
    pub(super) fn into_all(self) -> Vec<String> {
        self.all
    }

    /// What the name of a value sorts by: letters, then the number at its end.
    pub(super) fn sort_key(&self, value: Value) -> (String, usize) {
        let name = &self.all[value.0];
        match name.rsplit_once('_').map(|(stem, number)| (stem, number.parse())) {
            Some((stem, Ok(number))) => (stem.to_owned(), number),
            _ => (name.clone(), 0),
        }
    }

    fn value(&mut self, name: String) -> Value {
        self.all.push(name);
        Value(self.all.len() - 1)
    }

    fn share(&mut self, mut name: String) -> Value {
        while !self.shared.insert(name.clone()) {
            name.push('_');
        }
        self.value(name)
    }

    fn consumer(&self, op: Op) -> Rc<str> {
        self.consumers.get(&op).cloned().unwrap_or_else(|| "value".into())
    }

    /// A name that says what a value is: its role, or `c2`, or what it is made of.
    fn own_name(&self, plan: &Dag<'_>, op: Op) -> Option<String> {
        if let Some(name) = self.role(op).or(self.negatives.get(&op).map(String::as_str)) {
            return Some(name.to_owned());
        }
        match plan.operation(op) {
            Operation::Function(Function::Stumpff(k), _) => Some(format!("c{k}")),
            _ => self.describe(plan, op),
        }
    }

    /// `weight_chi_x`, `half_h_per_inertia_x`: short products of symbols in words.
    fn describe(&self, plan: &Dag<'_>, op: Op) -> Option<String> {
        match plan.operation(op) {
            Operation::Quotient(number, x) if number.is_one() => {
                Some(format!("per_{}", self.word(plan, *x)?))
            }
            Operation::Product(factors) if factors.len() <= LONGEST_DESCRIPTION => {
                let (mut words, mut below) = (Vec::new(), Vec::new());
                for &factor in factors {
                    match plan.operation(factor) {
                        Operation::Quotient(number, x) if number.is_one() => {
                            below.push(format!("per_{}", self.word(plan, *x)?));
                        }
                        Operation::Number(_) => words.insert(0, self.word(plan, factor)?),
                        _ => words.push(self.word(plan, factor)?),
                    }
                }
                words.extend(below);
                match words.as_slice() {
                    [x, same] if x == same => Some(format!("{x}_squared")),
                    _ => Some(words.join("_")),
                }
            }
            _ => None,
        }
    }

    /// A factor of a description.
    fn word(&self, plan: &Dag<'_>, op: Op) -> Option<String> {
        match plan.operation(op) {
            Operation::Symbol(symbol) => {
                Some(self.all[self.symbols[symbol].0].trim_end_matches('_').to_owned())
            }
            Operation::Number(number) => match number.to_string().as_str() {
                "1/2" => Some("half".to_owned()),
                "1/4" => Some("quarter".to_owned()),
                "2" => Some("two".to_owned()),
                "4" => Some("four".to_owned()),
                _ => None,
            },
            Operation::Product(factors) if factors.len() == 2 && self.role(op).is_none() => self
                .describe(plan, op)
                .filter(|_| factors.iter().all(|&factor| plan.operation(factor).is_leaf())),
            _ => self.role(op).map(str::to_owned),
        }
    }
}
