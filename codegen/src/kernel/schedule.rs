//! From a plan to sections: where each value is computed, what it is called, what is kept for later.

mod layout;
mod namer;

use std::collections::BTreeMap;

use rustc_hash::{FxHashMap, FxHashSet};

use super::plan::{Op, Operation, Plan, Signed};
use super::{Kernel, Section, SymbolNames};
use crate::expr::{Arena, Function, Stage, Symbol};
use layout::Layout;
pub(super) use namer::Namer;

/// What the sections of a step must produce.
pub(super) struct Outputs {
    pub start: Vec<Signed>,
    pub evaluation: Vec<Signed>,
    pub correction: Vec<Signed>,
    pub sweep: Vec<Signed>,
    pub domain: Vec<Signed>,
    pub next: Vec<Signed>,
}

/// What linear maps are made of, and the maps.
pub(super) struct Maps {
    pub fields: Vec<String>,
    pub point: Section,
    pub maps: Vec<Section>,
    pub symbols: SymbolNames,
}

/// Where a value is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Home {
    New,
    Begin,
    Evaluate,
    /// In each section that uses it.
    Local,
}

pub(super) struct Schedule<'p, 'a> {
    plan: &'p Plan<'a>,
    namer: Namer,
    homes: FxHashMap<Op, Home>,
    symbols: FxHashMap<Symbol, String>,
    /// Names of values kept in fields.
    kept: BTreeMap<Op, String>,
    /// Symbols of stage *step* that only the beginning of a step is given.
    given: FxHashSet<Symbol>,
}

impl<'p, 'a> Schedule<'p, 'a> {
    pub(super) fn new(arena: &'a Arena, plan: &'p Plan<'a>, mut namer: Namer) -> Self {
        // in the order of creation: users' names come first, so that ours give way
        let mut all: Vec<Symbol> = plan
            .ops()
            .filter_map(|op| match plan.operation(op) {
                Operation::Symbol(symbol) => Some(*symbol),
                _ => None,
            })
            .collect();
        all.sort();
        let symbols =
            all.into_iter().map(|symbol| (symbol, namer.claim(arena.symbol_info(symbol).name))).collect();
        Self {
            plan,
            namer,
            homes: FxHashMap::default(),
            symbols,
            kept: BTreeMap::new(),
            given: FxHashSet::default(),
        }
    }

    /// One section for everything.
    pub(super) fn function(mut self, outputs: &[Signed]) -> (Section, SymbolNames) {
        (self.section(None, &[], outputs), SymbolNames(self.symbols))
    }

    pub(super) fn kernel(mut self, outputs: Outputs, given: &[Symbol]) -> Kernel {
        self.given = given.iter().copied().collect();
        let ops = |signed: &[Signed]| signed.iter().map(|s| s.op).collect::<Vec<Op>>();
        let stepping =
            [&outputs.evaluation, &outputs.correction, &outputs.sweep, &outputs.domain, &outputs.next];
        let stepping: Vec<Op> = stepping.into_iter().flat_map(|signed| ops(signed)).collect();
        let stepping = self.cone(&stepping);
        let evaluating = self.cone(&ops(&outputs.evaluation));
        let solving = [&outputs.evaluation, &outputs.correction, &outputs.sweep, &outputs.domain];
        let solving: Vec<Op> = solving.into_iter().flat_map(|signed| ops(signed)).collect();
        let solving = self.cone(&solving);
        let families: FxHashSet<Op> = evaluating.iter().filter_map(|&op| self.family(op)).collect();
        for op in self.plan.ops() {
            let home = match self.plan.stage(op) {
                Stage::Parameters => Home::New,
                Stage::Perturbation => Home::Local,
                // What only the next state is made of is computed there, once a step too: the solution is not to wait behind it.
                Stage::Step if solving.contains(&op) || self.is_given(op) => Home::Begin,
                Stage::Iteration if evaluating.contains(&op) => Home::Evaluate,
                // Stumpff functions of one argument are computed together
                Stage::Iteration if self.family(op).is_some_and(|z| families.contains(&z)) => Home::Evaluate,
                _ => Home::Local,
            };
            self.homes.insert(op, home);
        }
        self.keep_what_crosses(&outputs, &stepping);

        let constants = self.fields(Home::New);
        let step = self.fields(Home::Begin);
        let iterate = self.fields(Home::Evaluate);
        let kept = |schedule: &Self, home| -> Vec<Op> {
            schedule.kept.keys().copied().filter(|op| schedule.homes.get(op) == Some(&home)).collect()
        };
        let (new_ops, begin_ops, iterate_ops) =
            (kept(&self, Home::New), kept(&self, Home::Begin), kept(&self, Home::Evaluate));
        Kernel {
            constants,
            step,
            iterate,
            new: self.section(Some(Home::New), &new_ops, &[]),
            begin: self.section(Some(Home::Begin), &begin_ops, &[]),
            start: self.section(Some(Home::Local), &[], &outputs.start),
            evaluate: self.section(Some(Home::Evaluate), &iterate_ops, &outputs.evaluation),
            correction: self.section(Some(Home::Local), &[], &outputs.correction),
            sweep: self.section(Some(Home::Local), &[], &outputs.sweep),
            domain: self.section(Some(Home::Local), &[], &outputs.domain),
            finish: self.section(Some(Home::Local), &[], &outputs.next),
            bounded: Vec::new(),
            unknown: Vec::new(),
            blocks: Vec::new(),
            residual: Vec::new(),
            right: Vec::new(),
            h: None,
            symbols: SymbolNames(self.symbols),
        }
    }

    /// One section for all that linear maps of perturbations are made of, and one for each of them, which finds all that there.
    pub(super) fn maps(mut self, outputs: &[Vec<Signed>]) -> Maps {
        let results: Vec<Op> = outputs.iter().flatten().map(|signed| signed.op).collect();
        let all = self.cone(&results);
        let linear = |op: &Op| self.plan.stage(*op) == Stage::Perturbation;
        let operands: Vec<Op> =
            all.iter().filter(|op| linear(op)).flat_map(|&op| self.plan.operation(op).operands()).collect();
        let point = self.cone(&operands.into_iter().filter(|op| !linear(op)).collect::<Vec<_>>());
        for op in self.plan.ops() {
            let symbol = matches!(self.plan.operation(op), Operation::Symbol(_));
            let home = if linear(&op) || !(symbol || point.contains(&op)) { Home::Local } else { Home::New };
            self.homes.insert(op, home);
        }
        let mut used: Vec<Op> = results.clone();
        for op in all {
            if self.homes[&op] == Home::Local {
                used.extend(self.plan.operation(op).operands());
            }
        }
        used.retain(|op| {
            self.homes[op] == Home::New && !matches!(self.plan.operation(*op), Operation::Number(_))
        });
        used.sort_unstable();
        used.dedup();
        for &op in &used {
            let name = self.name(op);
            self.kept.insert(op, name);
        }
        Maps {
            fields: self.fields(Home::New),
            point: self.section(Some(Home::New), &used, &[]),
            maps: outputs.iter().map(|results| self.section(Some(Home::Local), &[], results)).collect(),
            symbols: SymbolNames(self.symbols),
        }
    }

    /// Whether a node is a symbol that only the beginning of a step is given.
    fn is_given(&self, op: Op) -> bool {
        matches!(self.plan.operation(op), Operation::Symbol(symbol) if self.given.contains(symbol))
    }

    /// The nodes needed for `outputs`.
    fn cone(&self, outputs: &[Op]) -> FxHashSet<Op> {
        let mut seen = FxHashSet::default();
        let mut pending = outputs.to_vec();
        while let Some(op) = pending.pop() {
            if seen.insert(op) {
                pending.extend(self.plan.operation(op).operands());
            }
        }
        seen
    }

    /// The argument, if the node is a Stumpff function.
    fn family(&self, op: Op) -> Option<Op> {
        match self.plan.operation(op) {
            Operation::Function(Function::Stumpff(_), argument) => Some(*argument),
            _ => None,
        }
    }

    /// Names the values that are computed in one section and used in another.
    fn keep_what_crosses(&mut self, outputs: &Outputs, stepping: &FxHashSet<Op>) {
        let mut crossing: BTreeMap<Op, ()> = BTreeMap::new();
        let mut need = |schedule: &Self, op: Op, user: Home| {
            let home = schedule.homes[&op];
            let constant = matches!(schedule.plan.operation(op), Operation::Number(_));
            // symbols of the state and the unknown are at hand everywhere
            let at_hand = schedule.plan.operation(op).is_leaf()
                && schedule.plan.stage(op) != Stage::Parameters
                && !schedule.is_given(op);
            if home != Home::Local && home != user && !constant && !at_hand {
                crossing.insert(op, ());
            }
        };
        let starting = self.cone(&outputs.start.iter().map(|s| s.op).collect::<Vec<_>>());
        for op in self.plan.ops() {
            let in_use =
                stepping.contains(&op) || starting.contains(&op) || self.homes[&op] == Home::Evaluate;
            if in_use {
                for operand in self.plan.operation(op).operands() {
                    need(self, operand, self.homes[&op]);
                }
            }
        }
        for signed in &outputs.evaluation {
            need(self, signed.op, Home::Evaluate);
        }
        let local = [&outputs.start, &outputs.correction, &outputs.sweep, &outputs.domain, &outputs.next];
        for signed in local.into_iter().flatten() {
            need(self, signed.op, Home::Local);
        }
        for op in crossing.into_keys() {
            let name = self.name(op);
            self.kept.insert(op, name);
        }
    }

    /// The names of the values that `home` keeps: symbols first, as they were declared, then the others.
    fn fields(&self, home: Home) -> Vec<String> {
        let mut kept: Vec<(Option<Symbol>, Op, &String)> = self
            .kept
            .iter()
            .filter(|(op, _)| self.homes.get(op) == Some(&home))
            .map(|(&op, name)| match self.plan.operation(op) {
                Operation::Symbol(symbol) => (Some(*symbol), op, name),
                _ => (None, op, name),
            })
            .collect();
        kept.sort_by_key(|&(symbol, op, _)| (symbol.is_none(), symbol, op));
        kept.into_iter().map(|(_, _, name)| name.clone()).collect()
    }

    /// A name for a node: its role if it has one, what it is made of if that is short, else a letter and a number.
    fn name(&mut self, op: Op) -> String {
        if let Operation::Symbol(symbol) = self.plan.operation(op) {
            return self.symbols[symbol].clone();
        }
        if let Some(role) = self.namer.role(op) {
            let role = role.to_owned();
            return self.namer.claim(role);
        }
        if let Operation::Function(Function::Stumpff(k), _) = self.plan.operation(op) {
            return self.namer.claim(format!("c{k}"));
        }
        if let Some(description) = self.describe(op) {
            return self.namer.claim(description);
        }
        let prefix = match self.plan.stage(op) {
            Stage::Parameters => "p",
            Stage::Step => "s",
            Stage::Iteration => "i",
            Stage::Perturbation => "d",
        };
        self.namer.numbered(prefix)
    }

    /// `weight_chi_x`, `half_step`, `inertia_x_per_step`: short products of symbols in words.
    fn describe(&self, op: Op) -> Option<String> {
        let leaf = |op: Op| match self.plan.operation(op) {
            Operation::Symbol(symbol) => Some(self.symbols[symbol].trim_end_matches('_').to_owned()),
            Operation::Number(number) => match number.to_string().as_str() {
                "1/2" => Some("half".to_owned()),
                "1/4" => Some("quarter".to_owned()),
                "2" => Some("two".to_owned()),
                _ => None,
            },
            _ => self
                .namer
                .role(op)
                .map(str::to_owned)
                .or_else(|| self.kept.get(&op).cloned().filter(|name| name.contains('_'))),
        };
        match self.plan.operation(op) {
            Operation::Quotient(number, x) if number.is_one() => Some(format!("per_{}", leaf(*x)?)),
            Operation::Product(factors) if factors.len() <= 3 => {
                let mut words = Vec::new();
                let mut below = Vec::new();
                for &factor in factors {
                    match self.plan.operation(factor) {
                        Operation::Quotient(number, x) if number.is_one() => {
                            below.push(format!("per_{}", leaf(*x)?))
                        }
                        Operation::Number(_) => words.insert(0, leaf(factor)?),
                        _ => words.push(leaf(factor)?),
                    }
                }
                words.extend(below);
                Some(words.join("_"))
            }
            _ => None,
        }
    }

    /// Lays out one section: `home` is the section that owns its values (`None`: it owns all), `kept` are
    /// the values to keep in fields, `results` what it returns.
    fn section(&mut self, home: Option<Home>, kept: &[Op], results: &[Signed]) -> Section {
        let roots: Vec<Op> = kept.iter().copied().chain(results.iter().map(|signed| signed.op)).collect();
        let mut uses: FxHashMap<Op, u32> = FxHashMap::default();
        let mut pending = roots.clone();
        while let Some(op) = pending.pop() {
            let count = uses.entry(op).or_default();
            *count += 1;
            if *count == 1 && !self.is_input(home, op) {
                pending.extend(self.plan.operation(op).operands());
            }
        }
        let keeping = kept.iter().copied().collect();
        let mut layout = Layout {
            schedule: self,
            home,
            uses,
            keeping,
            names: FxHashMap::default(),
            section: Section::default(),
            locals: Vec::new(),
        };
        for &op in kept {
            layout.bind(op);
        }
        let results = results.iter().map(|&signed| layout.signed(signed)).collect();
        let Layout { mut section, locals, .. } = layout;
        section.results = results;
        section.inputs.sort();
        section.inputs.dedup();
        // temporaries are counted anew in every section
        for name in locals {
            self.namer.release(&name);
        }
        section
    }

    /// Whether a section finds the value rather than computing it.
    fn is_input(&self, home: Option<Home>, op: Op) -> bool {
        match self.plan.operation(op) {
            Operation::Symbol(_) | Operation::Number(_) => true,
            _ => match home {
                None => false,
                Some(home) => self.homes[&op] != home && self.kept.contains_key(&op),
            },
        }
    }
}
