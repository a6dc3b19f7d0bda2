//! Counting operations.

use super::{Function, Statement, Term};
use crate::expr::Function as Elementary;

/// How many operations of each kind some code takes. A product that is added in one operation counts as a
/// multiplication and an addition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Additions and subtractions.
    pub additions: usize,
    /// Multiplications.
    pub multiplications: usize,
    /// Divisions.
    pub divisions: usize,
    /// Square roots.
    pub roots: usize,
    /// Evaluations of Stumpff functions, all those of one argument together.
    pub stumpff: usize,
    /// Calls of other functions.
    pub functions: usize,
}

impl<R> Function<R> {
    /// How many operations it takes.
    pub fn operations(&self) -> Operations {
        let mut count = Operations::default();
        for statement in &self.statements {
            match statement {
                Statement::Let { term, .. } => count.add(term),
                Statement::Stumpff { argument, .. } => {
                    count.stumpff += 1;
                    count.add(argument);
                }
            }
        }
        self.results.iter().flatten().for_each(|result| count.add(result));
        count
    }
}

impl Term {
    /// How many operations it takes.
    pub fn operations(&self) -> Operations {
        let mut count = Operations::default();
        count.add(self);
        count
    }
}

impl Operations {
    /// All of them, whatever their kind.
    pub fn total(self) -> usize {
        let Self { additions, multiplications, divisions, roots, stumpff, functions } = self;
        additions + multiplications + divisions + roots + stumpff + functions
    }

    fn add(&mut self, term: &Term) {
        match term {
            Term::Number(_) | Term::Value(_) => {}
            Term::Negative(x) => self.add(x),
            Term::Sum(addends) => {
                self.additions += addends.len() - 1;
                addends.iter().for_each(|(_, addend)| self.add(addend));
            }
            Term::Product(factors) => {
                self.multiplications += factors.len() - 1;
                factors.iter().for_each(|factor| self.add(factor));
            }
            Term::MulAdd { a, b, addend, .. } => {
                self.additions += 1;
                self.multiplications += 1;
                [a, b, addend].into_iter().for_each(|part| self.add(part));
            }
            Term::Quotient(x, y) => {
                self.divisions += 1;
                self.add(x);
                self.add(y);
            }
            Term::Function(function, x) => {
                *match function {
                    Elementary::Sqrt => &mut self.roots,
                    Elementary::RecipOrZero => &mut self.divisions,
                    _ => &mut self.functions,
                } += 1;
                self.add(x);
            }
            Term::Power(x, y) | Term::Atan2(x, y) => {
                self.functions += 1;
                self.add(x);
                self.add(y);
            }
        }
    }
}

impl std::ops::Add for Operations {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            additions: self.additions + other.additions,
            multiplications: self.multiplications + other.multiplications,
            divisions: self.divisions + other.divisions,
            roots: self.roots + other.roots,
            stumpff: self.stumpff + other.stumpff,
            functions: self.functions + other.functions,
        }
    }
}

impl std::fmt::Display for Operations {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kinds = [
            (self.additions, "addition", "additions"),
            (self.multiplications, "multiplication", "multiplications"),
            (self.divisions, "division", "divisions"),
            (self.roots, "square root", "square roots"),
            (self.stumpff, "evaluation of Stumpff functions", "evaluations of Stumpff functions"),
            (self.functions, "function call", "function calls"),
        ];
        let present: Vec<String> = kinds
            .into_iter()
            .filter(|&(count, ..)| count > 0)
            .map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many }))
            .collect();
        f.write_str(&if present.is_empty() { "no operation".to_owned() } else { present.join(", ") })
    }
}
