//! What values are called: by their role, by what they are made of if that is short, else after the values that they
//! are computed for, so that a change of one term changes the names that it concerns and no others. A value for several
//! has the words that they share.

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
    /// Names whose values are the negatives of these: `minus_jacobian_12`.
    negatives: FxHashMap<Op, String>,
    /// All of those, which no numbered value takes.
    reserved: FxHashSet<String>,
    /// For each value the words shared by the next ones with names that it is computed for.
    consumers: FxHashMap<Op, Rc<str>>,
    /// How many values have been numbered for each consumer, in all functions.
    numbered: FxHashMap<Rc<str>, usize>,
}

/// Products of more factors than this are not described by them.
const LONGEST_DESCRIPTION: usize = 3;

/// The names that are in use in one function beside the [shared](Names) ones.
pub(super) type Locals = FxHashSet<String>;

impl Names {
    /// Names the symbols of a dag, in the order of creation: users' names come first, so that ours give way.
    pub(super) fn name_symbols<'a>(&mut self, arena: &'a Arena, dag: &Dag<'a>) {
        let symbol = |op: Op| match dag.operation(op) {
            Operation::Symbol(symbol) => Some(*symbol),
            _ => None,
        };
        let mut all: Vec<Symbol> = dag.ops().filter_map(symbol).collect();
        all.sort();
        for symbol in all {
            let value = self.share(arena.symbol_info(symbol).name);
            self.symbols.insert(symbol, value);
        }
    }

    /// Takes over role names for the nodes that their expressions became.
    pub(super) fn adopt_roles<'a>(&mut self, arena: &'a Arena, factoring: &Factoring<'a>, dag: &Dag<'a>) {
        for (id, name) in arena.roles() {
            if let Some(signed) = dag.planned(factoring.known(id))
                && !dag.operation(signed.op).is_leaf()
            {
                self.reserved.insert(name.clone());
                match signed.negative {
                    false => self.roles.entry(signed.op).or_insert(name),
                    true => self.negatives.entry(signed.op).or_insert(format!("minus_{name}")),
                };
            }
        }
    }

    /// Notes for which values with names the others are computed, from the outputs, which are given with what they are
    /// called.
    pub(super) fn note_consumers(&mut self, dag: &Dag<'_>, outputs: impl IntoIterator<Item = (Op, String)>) {
        let mut pending: Vec<(Op, Rc<str>)> =
            outputs.into_iter().map(|(op, name)| (op, Rc::from(name))).collect();
        pending.reverse();
        while let Some((op, consumer)) = pending.pop() {
            let own = self.role(op).or(self.negatives.get(&op).map(String::as_str)).map(Rc::from);
            let consumer = own.unwrap_or(consumer);
            let consumer = match self.consumers.get(&op) {
                None => consumer,
                Some(known) => match shared(known, &consumer) {
                    // what it is made of has been told already
                    words if words == **known => continue,
                    words => words.into(),
                },
            };
            let operands = dag.operation(op).operands();
            pending.extend(operands.into_iter().rev().map(|operand| (operand, Rc::clone(&consumer))));
            self.consumers.insert(op, consumer);
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

    /// The value of a symbol of the dag.
    pub(super) fn of_plan(&self, symbol: Symbol) -> Value {
        self.symbols[&symbol]
    }

    /// The value of a node that was [stored](Self::store).
    pub(super) fn stored(&self, op: Op) -> Option<Value> {
        self.stored.get(&op).copied()
    }

    /// Names a value that a record stores.
    pub(super) fn store(&mut self, dag: &Dag<'_>, op: Op) {
        let value = match dag.operation(op) {
            Operation::Symbol(symbol) => self.symbols[symbol],
            _ => match self.own_name(dag, op) {
                Some(name) => self.share(name),
                None => {
                    let name = self.number(self.consumer(op), &Locals::default());
                    self.share(name)
                }
            },
        };
        self.stored.insert(op, value);
    }

    /// Names a value within one function.
    pub(super) fn local(&mut self, dag: &Dag<'_>, op: Op, locals: &mut Locals) -> Value {
        let name = match self.own_name(dag, op) {
            Some(mut name) => {
                while self.shared.contains(&name) || locals.contains(&name) {
                    name.push('_');
                }
                name
            }
            None => self.number(self.consumer(op), locals),
        };
        locals.insert(name.clone());
        self.value(name)
    }

    /// Names the beginning of a long sum.
    pub(super) fn part(&mut self, locals: &mut Locals) -> Value {
        let name = self.number("sum".into(), locals);
        locals.insert(name.clone());
        self.value(name)
    }

    /// The next free number behind a name, in all functions: one name is one value.
    fn number(&mut self, stem: Rc<str>, locals: &Locals) -> String {
        let count = self.numbered.entry(Rc::clone(&stem)).or_default();
        loop {
            *count += 1;
            let name = format!("{stem}_{count}");
            if ![&self.shared, locals, &self.reserved].iter().any(|taken| taken.contains(&name)) {
                return name;
            }
        }
    }

    /// All names, by value.
    pub(super) fn into_all(self) -> Vec<String> {
        self.all
    }

    /// The key that the name of a value sorts by: letters, then the number at its end.
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
    fn own_name(&self, dag: &Dag<'_>, op: Op) -> Option<String> {
        if let Some(name) = self.role(op).or(self.negatives.get(&op).map(String::as_str)) {
            return Some(name.to_owned());
        }
        match dag.operation(op) {
            Operation::Function(Function::Stumpff(k), _) => Some(format!("c{k}")),
            _ => self.describe(dag, op),
        }
    }

    /// `weight_chi_x`, `half_h_per_inertia_x`: short products of symbols in words.
    fn describe(&self, dag: &Dag<'_>, op: Op) -> Option<String> {
        match dag.operation(op) {
            Operation::Quotient(number, x) if number.is_one() => Some(format!("per_{}", self.word(dag, *x)?)),
            Operation::Product(factors) if factors.len() <= LONGEST_DESCRIPTION => {
                let (mut words, mut below) = (Vec::new(), Vec::new());
                for &factor in factors {
                    match dag.operation(factor) {
                        Operation::Quotient(number, x) if number.is_one() => {
                            below.push(format!("per_{}", self.word(dag, *x)?));
                        }
                        Operation::Number(_) => words.insert(0, self.word(dag, factor)?),
                        _ => words.push(self.word(dag, factor)?),
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
    fn word(&self, dag: &Dag<'_>, op: Op) -> Option<String> {
        match dag.operation(op) {
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
            Operation::Product(factors) if factors.len() == 2 && self.role(op).is_none() => {
                self.describe(dag, op).filter(|_| factors.iter().all(|&factor| is_simple(dag, factor)))
            }
            _ => self.role(op).map(str::to_owned),
        }
    }
}

/// Whether a factor is `x` or `1/x`, for a leaf `x`.
fn is_simple(dag: &Dag<'_>, factor: Op) -> bool {
    match dag.operation(factor) {
        Operation::Quotient(number, x) => number.is_one() && dag.operation(*x).is_leaf(),
        operation => operation.is_leaf(),
    }
}

/// What a value for two is called: by the words that their names share, but for axes; by the first name where these are
/// less than half of it, or not what it begins with.
fn shared(one: &str, other: &str) -> String {
    let others: Vec<&str> = other.split('_').collect();
    let own: Vec<&str> = one.split('_').filter(|word| word.len() > 1).collect();
    let common: Vec<&str> = own.iter().copied().filter(|word| others.contains(word)).collect();
    let is_alike = common.first().is_some_and(|first| one.starts_with(first) && other.starts_with(first));
    if one == other || !is_alike || 2 * common.len() < own.len() { one.to_owned() } else { common.join("_") }
}
