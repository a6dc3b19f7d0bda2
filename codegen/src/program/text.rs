//! Modules as text: the intermediate representation that people read and snapshots guard. Wherever a product is added
//! to something, that is one operation.

use std::fmt;

use super::{Function, FunctionRole, Module, RecordKind, Statement, Term, Values};
use crate::expr::sign;

impl RecordKind {
    /// The record's name in text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constants => "constants",
            Self::Step => "step",
            Self::Iterate => "iterate",
            Self::Point => "point",
        }
    }
}

impl<R: FunctionRole> Module<R> {
    /// The functions of these roles as text, those of them that there are.
    pub fn text(&self, roles: &[R]) -> String {
        let wanted = self.functions.iter().filter(|function| roles.contains(&function.role));
        wanted.map(|function| self.values.function_text(function)).collect()
    }
}

impl Values {
    fn function_text<R: FunctionRole>(&self, function: &Function<R>) -> String {
        let called = function.role.name();
        let mut lines = vec![format!("{called}: {}", function.operations())];
        lines.extend(function.statements.iter().map(|line| format!("    {}", self.statement_text(line))));
        for (place, array) in function.results.iter().enumerate() {
            let name = match function.role.signature().results.get(place) {
                Some(name) => (*name).to_owned(),
                None if function.results.len() == 1 => called.clone(),
                None => format!("{called}[{place}]"),
            };
            let component = |(k, term)| format!("    {name}[{k}] <- {}", self.term(term));
            lines.extend(array.iter().enumerate().map(component));
        }
        if let Some(kind) = function.record.filter(|&kind| !self.fields(kind).is_empty()) {
            let fields: Vec<&str> = self.fields(kind).iter().map(|&field| self.name(field)).collect();
            lines.push(format!("    {} <- {}", kind.name(), fields.join(", ")));
        }
        lines.iter().map(|line| format!("{line}\n")).collect()
    }

    fn statement_text(&self, statement: &Statement) -> String {
        match statement {
            Statement::Let { value, term } => format!("{} = {}", self.name(*value), self.term(term)),
            Statement::Stumpff { values, argument } => {
                let names: Vec<&str> =
                    values.iter().map(|value| value.map_or("_", |value| self.name(value))).collect();
                format!("[{}] = stumpff({})", names.join(", "), self.term(argument))
            }
        }
    }

    /// A term in the usual notation.
    pub fn term(&self, term: &Term) -> String {
        match term {
            Term::Number(number) => number.to_string(),
            Term::Value(value) => self.name(*value).to_owned(),
            Term::Negative(x) => format!("-{}", self.factor(x)),
            Term::Sum(addends) => {
                let mut text = String::new();
                for (place, (negative, addend)) in addends.iter().enumerate() {
                    text.push_str(sign(place, *negative));
                    text.push_str(&match addend {
                        // what comes first is added to from left to right
                        Term::MulAdd { .. } if place == 0 => self.term(addend),
                        Term::Sum(_) | Term::MulAdd { .. } | Term::Negative(_) => {
                            format!("({})", self.term(addend))
                        }
                        _ => self.term(addend),
                    });
                }
                text
            }
            Term::Product(factors) => {
                let factors: Vec<String> = factors.iter().map(|factor| self.factor(factor)).collect();
                factors.join(" ")
            }
            Term::MulAdd { negative, a, b, addend } => {
                let sign = if *negative { '-' } else { '+' };
                format!("{} {sign} {} {}", self.term(addend), self.factor(a), self.factor(b))
            }
            Term::Quotient(x, y) => format!("{} / {}", self.factor(x), self.factor(y)),
            Term::Function(function, x) => format!("{}({})", function.name(), self.term(x)),
            Term::Power(x, y) => format!("{}^{}", self.factor(x), self.factor(y)),
            Term::Atan2(y, x) => format!("atan2({}, {})", self.term(y), self.term(x)),
            Term::Choice([x, y, z]) => {
                format!("if({} < 0, {}, {})", self.term(x), self.term(y), self.term(z))
            }
        }
    }

    /// The term in parentheses, unless it is one thing.
    fn factor(&self, term: &Term) -> String {
        match term {
            Term::Number(_) | Term::Value(_) | Term::Function(..) | Term::Atan2(..) | Term::Power(..) => {
                self.term(term)
            }
            Term::Choice(_) => self.term(term),
            _ => format!("({})", self.term(term)),
        }
    }
}

impl<R: FunctionRole> fmt::Display for Module<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.functions.iter().try_for_each(|function| f.write_str(&self.values.function_text(function)))
    }
}
