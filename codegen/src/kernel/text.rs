//! Kernels as text: the intermediate representation that people read and snapshots guard.

use std::fmt;

use super::{Kernel, Section, Statement, Term};

impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let factor = |f: &mut fmt::Formatter<'_>, term: &Term| match term {
            Term::Number(_) | Term::Name(_) | Term::Function(..) | Term::Atan2(..) | Term::Power(..) => {
                write!(f, "{term}")
            }
            _ => write!(f, "({term})"),
        };
        match self {
            Term::Number(number) => write!(f, "{number}"),
            Term::Name(name) => f.write_str(name),
            Term::Negative(x) => {
                f.write_str("-")?;
                factor(f, x)
            }
            Term::Sum(addends) => {
                for (i, (negative, addend)) in addends.iter().enumerate() {
                    match (i, negative) {
                        (0, _) => {}
                        (_, false) => f.write_str(" + ")?,
                        (_, true) => f.write_str(" - ")?,
                    }
                    match addend {
                        Term::Sum(_) | Term::Negative(_) => write!(f, "({addend})")?,
                        _ => write!(f, "{addend}")?,
                    }
                }
                Ok(())
            }
            Term::Product(factors) => {
                for (i, x) in factors.iter().enumerate() {
                    if i > 0 {
                        f.write_str(" ")?;
                    }
                    factor(f, x)?;
                }
                Ok(())
            }
            Term::Quotient(x, y) => {
                factor(f, x)?;
                f.write_str(" / ")?;
                factor(f, y)
            }
            Term::Function(function, x) => write!(f, "{}({x})", function.name()),
            Term::Power(x, y) => {
                factor(f, x)?;
                f.write_str("^")?;
                factor(f, y)
            }
            Term::Atan2(y, x) => write!(f, "atan2({y}, {x})"),
        }
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Statement::Let { name, value } => write!(f, "{name} = {value}"),
            Statement::Stumpff { names, argument } => {
                let names: Vec<&str> = names.iter().map(|name| name.as_deref().unwrap_or("_")).collect();
                write!(f, "[{}] = stumpff({argument})", names.join(", "))
            }
        }
    }
}

impl Section {
    fn text(
        &self,
        f: &mut fmt::Formatter<'_>,
        title: &str,
        keeps: &[String],
        results: &[String],
    ) -> fmt::Result {
        writeln!(f, "{title}: {}", self.operations())?;
        for statement in &self.statements {
            writeln!(f, "    {statement}")?;
        }
        for (name, result) in results.iter().zip(&self.results) {
            writeln!(f, "    {name} <- {result}")?;
        }
        if keeps.is_empty() { Ok(()) } else { writeln!(f, "    keep {}", keeps.join(", ")) }
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbered = |name: &str, n: usize| (0..n).map(|i| format!("{name}[{i}]")).collect::<Vec<_>>();
        let n = self.unknown.len();
        let evaluated = [numbered("residual", n), numbered("right", n)].concat();
        self.new.text(f, "new", &self.constants, &[])?;
        self.begin.text(f, "begin", &self.step, &[])?;
        self.start.text(f, "start", &[], &self.unknown)?;
        self.evaluate.text(f, "evaluate", &self.iterate, &evaluated)?;
        self.correction.text(f, "correction", &[], &numbered("correction", n))?;
        self.sweep.text(f, "sweep", &[], &self.unknown)?;
        self.domain.text(f, "domain", &[], &numbered("margin", self.domain.results.len()))?;
        self.finish.text(f, "finish", &[], &numbered("next", self.finish.results.len()))
    }
}
