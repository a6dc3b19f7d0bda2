//! From a plan to sections: where each value is computed, what it is called, what is kept for later.

use std::collections::BTreeMap;

use rustc_hash::{FxHashMap, FxHashSet};

use super::factor::Factoring;
use super::plan::{Op, Operation, Plan, Signed};
use super::{Kernel, Section, Statement, SymbolNames, Term};
use crate::expr::{Arena, Function, Stage, Symbol};

/// Gives every value that needs one a unique name.
pub(super) struct Namer {
    /// Role names that the method gave.
    roles: FxHashMap<Op, String>,
    used: FxHashSet<String>,
}

/// Words that generated functions use for themselves, and the language's.
const RESERVED: &[&str] = &[
    "state",
    "step",
    "unknown",
    "evaluation",
    "parameters",
    "self",
    "super",
    "crate",
    "as",
    "async",
    "await",
    "break",
    "const",
    "continue",
    "dyn",
    "else",
    "enum",
    "extern",
    "false",
    "fn",
    "for",
    "if",
    "impl",
    "in",
    "let",
    "loop",
    "match",
    "mod",
    "move",
    "mut",
    "pub",
    "ref",
    "return",
    "static",
    "struct",
    "trait",
    "true",
    "type",
    "unsafe",
    "use",
    "where",
    "while",
    "yield",
    "abstract",
    "become",
    "box",
    "do",
    "final",
    "gen",
    "macro",
    "override",
    "priv",
    "try",
    "typeof",
    "unsized",
    "virtual",
];

impl Namer {
    pub(super) fn new() -> Self {
        Self { roles: FxHashMap::default(), used: RESERVED.iter().map(|&word| word.to_owned()).collect() }
    }

    /// Takes over role names for the nodes its expressions became.
    pub(super) fn carry_over<'a>(
        &mut self,
        arena: &'a Arena,
        factoring: &mut Factoring<'a>,
        plan: &Plan<'a>,
    ) {
        for (id, name) in arena.roles() {
            let factored = factoring.of(arena.expr(id));
            // the name is for the value, not for its negative
            if let Some(signed) = plan.planned(factored.id())
                && !signed.negative
                && !plan.operation(signed.op).is_leaf()
            {
                self.roles.entry(signed.op).or_insert(name);
            }
        }
    }

    fn claim(&mut self, mut name: String) -> String {
        while !self.used.insert(name.clone()) {
            name.push('_');
        }
        name
    }

    fn numbered(&mut self, prefix: &str) -> String {
        let mut n = 0;
        while self.used.contains(&format!("{prefix}{n}")) {
            n += 1;
        }
        self.claim(format!("{prefix}{n}"))
    }
}

/// What the sections of a step must produce.
pub(super) struct Outputs {
    pub start: Vec<Signed>,
    pub evaluation: Vec<Signed>,
    pub correction: Vec<Signed>,
    pub domain: Vec<Signed>,
    pub next: Vec<Signed>,
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
        Self { plan, namer, homes: FxHashMap::default(), symbols, kept: BTreeMap::new() }
    }

    /// One section for everything.
    pub(super) fn function(mut self, outputs: &[Signed]) -> (Section, SymbolNames) {
        (self.section(None, &[], outputs), SymbolNames(self.symbols))
    }

    pub(super) fn kernel(mut self, outputs: Outputs) -> Kernel {
        let ops = |signed: &[Signed]| signed.iter().map(|s| s.op).collect::<Vec<Op>>();
        let stepping = [&outputs.evaluation, &outputs.correction, &outputs.domain, &outputs.next];
        let stepping: Vec<Op> = stepping.into_iter().flat_map(|signed| ops(signed)).collect();
        let stepping = self.cone(&stepping);
        let evaluating = self.cone(&ops(&outputs.evaluation));
        let families: FxHashSet<Op> = evaluating.iter().filter_map(|&op| self.family(op)).collect();
        for op in self.plan.ops() {
            let home = match self.plan.stage(op) {
                Stage::Parameters => Home::New,
                Stage::Step if stepping.contains(&op) => Home::Begin,
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
            start: self.section(None, &[], &outputs.start),
            evaluate: self.section(Some(Home::Evaluate), &iterate_ops, &outputs.evaluation),
            correction: self.section(Some(Home::Local), &[], &outputs.correction),
            domain: self.section(Some(Home::Local), &[], &outputs.domain),
            finish: self.section(Some(Home::Local), &[], &outputs.next),
            unknown: Vec::new(),
            residual: Vec::new(),
            h: None,
            symbols: SymbolNames(self.symbols),
        }
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
            let at_hand =
                schedule.plan.operation(op).is_leaf() && schedule.plan.stage(op) != Stage::Parameters;
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
                    // the start is computed from the state, without the step's own values
                    if starting.contains(&op) && self.plan.stage(operand) == Stage::Parameters {
                        need(
                            self,
                            operand,
                            if self.plan.stage(op) == Stage::Parameters { Home::New } else { Home::Local },
                        );
                    }
                }
            }
        }
        for signed in &outputs.evaluation {
            need(self, signed.op, Home::Evaluate);
        }
        for signed in outputs.correction.iter().chain(&outputs.domain).chain(&outputs.next) {
            need(self, signed.op, Home::Local);
        }
        for signed in &outputs.start {
            if self.plan.stage(signed.op) == Stage::Parameters {
                need(self, signed.op, Home::Local);
            }
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
        if let Some(role) = self.namer.roles.get(&op) {
            let role = role.clone();
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
                .roles
                .get(&op)
                .cloned()
                .or_else(|| self.kept.get(&op).cloned().filter(|name| name.contains('_'))),
        };
        match self.plan.operation(op) {
            Operation::Reciprocal(x) => Some(format!("per_{}", leaf(*x)?)),
            Operation::Product(factors) if factors.len() <= 3 => {
                let mut words = Vec::new();
                let mut below = Vec::new();
                for &factor in factors {
                    match self.plan.operation(factor) {
                        Operation::Reciprocal(x) => below.push(format!("per_{}", leaf(*x)?)),
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

    /// Lays out one section: `home` is the section that owns its values (`None`: it owns all but constants in fields), `kept` are
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
            self.namer.used.remove(&name);
        }
        section
    }

    /// Whether a section finds the value rather than computing it.
    fn is_input(&self, home: Option<Home>, op: Op) -> bool {
        match self.plan.operation(op) {
            Operation::Symbol(_) | Operation::Number(_) => true,
            _ => match home {
                None => self.kept.contains_key(&op) && self.plan.stage(op) == Stage::Parameters,
                Some(home) => self.homes[&op] != home && self.kept.contains_key(&op),
            },
        }
    }
}

/// Writes one section.
struct Layout<'s, 'p, 'a> {
    schedule: &'s mut Schedule<'p, 'a>,
    home: Option<Home>,
    uses: FxHashMap<Op, u32>,
    keeping: FxHashSet<Op>,
    names: FxHashMap<Op, String>,
    section: Section,
    locals: Vec<String>,
}

/// Trees of more operations than this are cut by a named value.
const LARGEST_TERM: usize = 12;

impl Layout<'_, '_, '_> {
    fn signed(&mut self, signed: Signed) -> Term {
        match self.term(signed.op) {
            term if !signed.negative => term,
            // −(a − b) reads b − a
            Term::Sum(mut addends) if addends.len() == 2 && addends[1].0 => {
                addends.reverse();
                addends[0].0 = false;
                addends[1].0 = true;
                Term::Sum(addends)
            }
            term => Term::Negative(Box::new(term)),
        }
    }

    /// The value as a term: by name if it has or deserves one, written out otherwise.
    fn term(&mut self, op: Op) -> Term {
        let plan = self.schedule.plan;
        if let Operation::Number(number) = plan.operation(op) {
            return Term::Number(*number);
        }
        if let Operation::Symbol(symbol) = plan.operation(op) {
            let name = self.schedule.symbols[symbol].clone();
            self.section.inputs.push(name.clone());
            return Term::Name(name);
        }
        if self.schedule.is_input(self.home, op) {
            let name = self.schedule.kept[&op].clone();
            self.section.inputs.push(name.clone());
            return Term::Name(name);
        }
        if let Some(name) = self.names.get(&op) {
            return Term::Name(name.clone());
        }
        let named = self.schedule.namer.roles.contains_key(&op) && !self.is_reciprocal(op);
        let family = self.schedule.family(op).is_some();
        if family || named || self.uses[&op] > 1 || self.keeping.contains(&op) {
            return Term::Name(self.bind(op));
        }
        let term = self.write(op);
        if size(&term) > LARGEST_TERM { Term::Name(self.bind_term(op, term)) } else { term }
    }

    fn is_reciprocal(&self, op: Op) -> bool {
        matches!(self.schedule.plan.operation(op), Operation::Reciprocal(_))
    }

    /// Computes a value under a name.
    fn bind(&mut self, op: Op) -> String {
        if let Some(name) = self.names.get(&op) {
            return name.clone();
        }
        if self.schedule.family(op).is_some() {
            return self.bind_family(op);
        }
        if let Operation::Symbol(_) = self.schedule.plan.operation(op) {
            let name = self.schedule.name(op);
            self.section.inputs.push(name.clone());
            return name;
        }
        let term = self.write(op);
        self.bind_term(op, term)
    }

    fn bind_term(&mut self, op: Op, value: Term) -> String {
        let name = self.name(op);
        self.section.statements.push(Statement::Let { name: name.clone(), value });
        name
    }

    fn name(&mut self, op: Op) -> String {
        let name = match self.schedule.kept.get(&op) {
            Some(kept) if self.keeping.contains(&op) => kept.clone(),
            _ => {
                let role = self.schedule.namer.roles.get(&op).cloned();
                let stumpff = match self.schedule.plan.operation(op) {
                    Operation::Function(Function::Stumpff(k), _) => Some(format!("c{k}")),
                    _ => None,
                };
                let name = match role.or(stumpff) {
                    Some(name) => self.schedule.namer.claim(name),
                    None => self.schedule.namer.numbered("t"),
                };
                self.locals.push(name.clone());
                name
            }
        };
        self.names.insert(op, name.clone());
        name
    }

    /// Computes all Stumpff functions of one argument that this section owns.
    fn bind_family(&mut self, op: Op) -> String {
        let plan = self.schedule.plan;
        let Operation::Function(_, argument) = plan.operation(op) else { return self.schedule.name(op) };
        let argument = *argument;
        let mut names: Vec<Option<String>> = Vec::new();
        let members: Vec<(u32, Op)> = plan
            .ops()
            .filter(|op| self.uses.contains_key(op) && !self.schedule.is_input(self.home, *op))
            .filter_map(|op| match plan.operation(op) {
                Operation::Function(Function::Stumpff(k), z) if *z == argument => Some((*k, op)),
                _ => None,
            })
            .collect();
        for (k, member) in members {
            names.resize_with(names.len().max(k as usize + 1), || None);
            names[k as usize] = Some(self.name(member));
        }
        let argument = self.term(argument);
        self.section.statements.push(Statement::Stumpff { names, argument });
        self.names[&op].clone()
    }

    /// The operation written out.
    fn write(&mut self, op: Op) -> Term {
        let plan = self.schedule.plan;
        match plan.operation(op) {
            Operation::Number(_) | Operation::Symbol(_) => self.term(op),
            Operation::Sum(addends) => {
                let mut terms: Vec<(bool, Term)> =
                    addends.iter().map(|&(negative, addend)| (negative, self.term(addend))).collect();
                match terms.iter().position(|(negative, _)| !negative) {
                    Some(first) => {
                        // read `a − b`, not `−b + a`
                        let leading = terms.remove(first);
                        terms.insert(0, leading);
                        Term::Sum(terms)
                    }
                    None if terms.len() == 1 => Term::Negative(Box::new(terms.remove(0).1)),
                    None => {
                        terms.iter_mut().for_each(|(negative, _)| *negative = false);
                        Term::Negative(Box::new(Term::Sum(terms)))
                    }
                }
            }
            Operation::Product(factors) => {
                let mut above = Vec::new();
                let mut below = Vec::new();
                for &factor in factors {
                    match plan.operation(factor) {
                        // a reciprocal of its own rounds once more, and only pays where it is used again and time counts
                        Operation::Reciprocal(x)
                            if plan.stage(op) == Stage::Parameters
                                || (self.uses[&factor] == 1
                                    && !self.schedule.is_input(self.home, factor)) =>
                        {
                            below.push(self.term(*x));
                        }
                        Operation::Number(_) => above.insert(0, self.term(factor)),
                        _ => above.push(self.term(factor)),
                    }
                }
                let one = || Term::Number(1.into());
                let above = product(above).unwrap_or_else(one);
                match product(below) {
                    Some(below) => Term::Quotient(Box::new(above), Box::new(below)),
                    None => above,
                }
            }
            Operation::Reciprocal(x) => {
                Term::Quotient(Box::new(Term::Number(1.into())), Box::new(self.term(*x)))
            }
            Operation::Function(function, x) => Term::Function(*function, Box::new(self.term(*x))),
            Operation::Power(x, y) => Term::Power(Box::new(self.term(*x)), Box::new(self.term(*y))),
            Operation::Atan2(y, x) => Term::Atan2(Box::new(self.term(*y)), Box::new(self.term(*x))),
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

/// Operations in a term.
fn size(term: &Term) -> usize {
    match term {
        Term::Number(_) | Term::Name(_) => 0,
        Term::Negative(x) => size(x),
        Term::Sum(addends) => addends.len() - 1 + addends.iter().map(|(_, x)| size(x)).sum::<usize>(),
        Term::Product(factors) => factors.len() - 1 + factors.iter().map(size).sum::<usize>(),
        Term::Quotient(x, y) | Term::Power(x, y) | Term::Atan2(x, y) => 1 + size(x) + size(y),
        Term::Function(_, x) => 1 + size(x),
    }
}
