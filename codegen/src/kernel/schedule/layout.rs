//! One section's statements: which values get names, which are written out where they are used.

use rustc_hash::{FxHashMap, FxHashSet};

use super::{Home, Schedule};
use crate::expr::{Function, Stage};
use crate::kernel::plan::{Op, Operation, Signed};
use crate::kernel::{Section, Statement, Term};

/// Writes one section.
pub(super) struct Layout<'s, 'p, 'a> {
    pub(super) schedule: &'s mut Schedule<'p, 'a>,
    pub(super) home: Option<Home>,
    pub(super) uses: FxHashMap<Op, u32>,
    pub(super) keeping: FxHashSet<Op>,
    pub(super) names: FxHashMap<Op, String>,
    pub(super) section: Section,
    pub(super) locals: Vec<String>,
}

/// Trees of more operations than this are cut by a named value.
const LARGEST_TERM: usize = 12;

impl Layout<'_, '_, '_> {
    pub(super) fn signed(&mut self, signed: Signed) -> Term {
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
        let named = self.schedule.namer.role(op).is_some() && !self.is_reciprocal(op);
        let family = self.schedule.family(op).is_some();
        if family || named || self.uses[&op] > 1 || self.keeping.contains(&op) {
            return Term::Name(self.bind(op));
        }
        let term = self.write(op);
        if size(&term) > LARGEST_TERM { Term::Name(self.bind_term(op, term)) } else { term }
    }

    fn is_reciprocal(&self, op: Op) -> bool {
        matches!(self.schedule.plan.operation(op), Operation::Quotient(..))
    }

    /// Computes a value under a name.
    pub(super) fn bind(&mut self, op: Op) -> String {
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
                let role = self.schedule.namer.role(op).map(str::to_owned);
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
                let has_constant = terms.iter().any(|(_, term)| matches!(term, Term::Number(_)));
                if self.home == Some(Home::Evaluate) {
                    terms = if has_constant { balanced(terms) } else { flat(terms) };
                }
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
                        Operation::Quotient(number, x)
                            if number.is_one()
                                && !self.schedule.is_input(self.home, factor)
                                && (plan.stage(op) == Stage::Parameters || self.uses[&factor] == 1) =>
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
            Operation::Quotient(number, x) => {
                Term::Quotient(Box::new(Term::Number(*number)), Box::new(self.term(*x)))
            }
            Operation::Function(function, x) => Term::Function(*function, Box::new(self.term(*x))),
            Operation::Power(x, y) => Term::Power(Box::new(self.term(*x)), Box::new(self.term(*y))),
            Operation::Atan2(y, x) => Term::Atan2(Box::new(self.term(*y)), Box::new(self.term(*x))),
        }
    }
}

/// A sum of sums as one, in which every product can be added as it is formed. Its roundings are those of the largest addend, once for each
/// of the others: next to an unknown that is a small change itself they make no difference, in the state that it changes they would.
fn flat(addends: Vec<(bool, Term)>) -> Vec<(bool, Term)> {
    let mut flat = Vec::new();
    for (negative, addend) in addends {
        match addend {
            Term::Sum(inner) => flat.extend(inner.into_iter().map(|(sign, term)| (sign ^ negative, term))),
            other => flat.push((negative, other)),
        }
    }
    flat
}

/// A constant and more than two small numbers as two sums that do not wait for one another, which costs one rounding more; fewer keep together.
fn balanced(addends: Vec<(bool, Term)>) -> Vec<(bool, Term)> {
    let mut all = flat(addends.clone());
    if all.len() < 4 || all.iter().any(|(negative, _)| *negative) {
        return addends;
    }
    all.sort_by_key(|(_, term)| !matches!(term, Term::Number(_)));
    let rest = all.split_off(all.len() / 2);
    vec![(false, Term::Sum(all)), (false, Term::Sum(rest))]
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
