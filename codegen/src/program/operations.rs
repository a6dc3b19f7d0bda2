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
    /// Choices between two values.
    pub choices: usize,
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
        self.counts().into_iter().sum()
    }

    /// In the order in which they are listed.
    fn counts(self) -> [usize; 7] {
        let Self { additions, multiplications, divisions, roots, stumpff, functions, choices } = self;
        [additions, multiplications, divisions, roots, stumpff, functions, choices]
    }

    fn add(&mut self, term: &Term) {
        match term {
            Term::Number(_) | Term::Value(_) | Term::Negative(_) => {}
            Term::Sum(addends) => self.additions += addends.len() - 1,
            Term::Product(factors) => self.multiplications += factors.len() - 1,
            Term::MulAdd { .. } => {
                self.additions += 1;
                self.multiplications += 1;
            }
            Term::Quotient(..) | Term::Function(Elementary::RecipOrZero, _) => self.divisions += 1,
            Term::Function(Elementary::Sqrt, _) => self.roots += 1,
            Term::Function(..) | Term::Power(..) | Term::Atan2(..) => self.functions += 1,
            Term::Choice(_) => self.choices += 1,
        }
        term.operands().into_iter().for_each(|operand| self.add(operand));
    }
}

impl std::ops::Add for Operations {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let [additions, multiplications, divisions, roots, stumpff, functions, choices] =
            std::array::from_fn(|kind| self.counts()[kind] + other.counts()[kind]);
        Self { additions, multiplications, divisions, roots, stumpff, functions, choices }
    }
}

impl std::fmt::Display for Operations {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kinds = [
            ("addition", "additions"),
            ("multiplication", "multiplications"),
            ("division", "divisions"),
            ("square root", "square roots"),
            ("evaluation of Stumpff functions", "evaluations of Stumpff functions"),
            ("function call", "function calls"),
            ("choice", "choices"),
        ];
        let present = self.counts().into_iter().zip(kinds).filter(|&(count, _)| count > 0);
        let present: Vec<String> = present
            .map(|(count, (one, many))| format!("{count} {}", if count == 1 { one } else { many }))
            .collect();
        f.write_str(&if present.is_empty() { "no operation".to_owned() } else { present.join(", ") })
    }
}
