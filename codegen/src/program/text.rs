//! Modules as text: the intermediate representation that people read and snapshots guard. Wherever a product is added to something, that is
//! one operation.

use std::fmt;

use super::{Function, Module, RecordKind, Role, Statement, Term};

impl Role {
    /// What the function is called in text.
    pub fn name(self) -> String {
        let name = match self {
            Self::New => "new",
            Self::Begin => "begin",
            Self::Start => "start",
            Self::Evaluate => "evaluate",
            Self::Correction => "correction",
            Self::FixedPointUpdate => "fixed_point_update",
            Self::Domain => "domain",
            Self::Finish => "finish",
            Self::Point => "point",
            Self::Tangent => "tangent",
            Self::Adjoint => "adjoint",
            Self::Through => "through",
            Self::WrtState => "wrt_state",
            Self::WrtControl => "wrt_control",
            Self::WrtParameters => "wrt_parameters",
            Self::Energy => "energy",
            Self::Velocity => "velocity",
            Self::VelocityNewton => "velocity_newton",
            Self::Momentum => "momentum",
            Self::MomentumNewton => "momentum_newton",
            Self::Casimirs => "casimirs",
            Self::SpatialMomentum => "spatial_momentum",
            Self::Deviation => "deviation",
            Self::Pivots(place) => return format!("pivots_{place}"),
            Self::ExponentialDisplacement => "exponential_displacement",
            Self::CayleyDisplacement => "cayley_displacement",
            Self::SecondKindDisplacement => "second_kind_displacement",
            Self::Differential => "differential",
            Self::HamiltonianVector => "hamiltonian_vector",
            Self::Force => "force",
            Self::Conserved => "conserved",
            Self::WithConserved => "with_conserved",
        };
        name.to_owned()
    }

    /// What the arrays are called in text that the function returns.
    fn results(self) -> &'static [&'static str] {
        match self {
            Self::Start => &["unknown"],
            Self::Evaluate => &["residual", "right"],
            Self::Correction => &["correction"],
            Self::FixedPointUpdate => &["unknown"],
            Self::Domain => &["margin"],
            Self::Finish => &["next"],
            Self::Adjoint => &["wrt_state", "wrt_control", "wrt_parameters"],
            _ => &[],
        }
    }
}

impl RecordKind {
    /// What the record is called in text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constants => "constants",
            Self::Step => "step",
            Self::Iterate => "iterate",
            Self::Point => "point",
        }
    }
}

impl Module {
    /// The functions of these roles as text, those of them that there are.
    pub fn text(&self, roles: &[Role]) -> String {
        let wanted = self.functions.iter().filter(|function| roles.contains(&function.role));
        wanted.map(|function| self.function_text(function)).collect()
    }

    fn function_text(&self, function: &Function) -> String {
        let mut lines = vec![format!("{}: {}", function.role.name(), function.operations())];
        lines.extend(function.statements.iter().map(|line| format!("    {}", self.statement_text(line))));
        for (place, array) in function.results.iter().enumerate() {
            let name = match function.role.results().get(place) {
                Some(name) => (*name).to_owned(),
                None if function.results.len() == 1 => function.role.name(),
                None => format!("{}[{place}]", function.role.name()),
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
                    text.push_str(match (place, negative) {
                        (0, false) => "",
                        (0, true) => "-",
                        (_, false) => " + ",
                        (_, true) => " - ",
                    });
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
        }
    }

    /// The term in parentheses, unless it is one thing.
    fn factor(&self, term: &Term) -> String {
        match term {
            Term::Number(_) | Term::Value(_) | Term::Function(..) | Term::Atan2(..) | Term::Power(..) => {
                self.term(term)
            }
            _ => format!("({})", self.term(term)),
        }
    }
}

impl fmt::Display for Module {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.functions.iter().try_for_each(|function| f.write_str(&self.function_text(function)))
    }
}
