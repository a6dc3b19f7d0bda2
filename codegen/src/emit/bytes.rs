//! Programs of steps as bytes, for those who take a step in other numbers than it is compiled for: data cost nothing to
//! compile.
//!
//! ```text
//! function   inputs, statements, results: each a count and as many
//! input      its kind, a count, as many places; place 0 where a component is not used
//! statement  0, place, term · 1, a count of Stumpff functions from c₀ on, as many places, term
//! result     an array: a count and as many terms
//! term       its kind and its operands; before these stands their count where that may differ,
//!            or which of a family of functions it is
//! ```
//!
//! Counts and places are integers of seven bits in each byte, the low ones first. All functions of a step share the
//! places, so that records are not handed on; but `evaluate` is also run by itself, and says where it finds them.
//! `coadjoint::bytecode` runs it.

use crate::program::{
    Argument, Elementary, Function, Input, Module, RecordKind, Statement, StepRole, Term, Value,
};

/// The functions of a step that lead from one state to the next, if the solution of its equation is known.
const ROLES: [StepRole; 4] = [StepRole::New, StepRole::Begin, StepRole::Evaluate, StepRole::Finish];

/// Inputs, in the order of their kinds.
const INPUTS: [Input; 10] = [
    Input::Parameters,
    Input::StepSize,
    Input::State,
    Input::Time,
    Input::Control,
    Input::Unknown,
    Input::Residual,
    Input::Right,
    Input::Record(RecordKind::Constants),
    Input::Record(RecordKind::Step),
];

/// Elementary functions, in the order of their kinds.
const FUNCTIONS: [Elementary; 13] = [
    Elementary::Sqrt,
    Elementary::Exp,
    Elementary::Ln,
    Elementary::Sin,
    Elementary::Cos,
    Elementary::Tan,
    Elementary::Asin,
    Elementary::Acos,
    Elementary::Atan,
    Elementary::Sinh,
    Elementary::Cosh,
    Elementary::Tanh,
    Elementary::RecipOrZero,
];

/// The functions that lead from one state to the next, each in bytes.
pub fn functions(module: &Module<StepRole>) -> impl Iterator<Item = Vec<u8>> {
    ROLES.iter().map(|role| module.function(*role).map(function).unwrap_or_default())
}

fn function(function: &Function<StepRole>) -> Vec<u8> {
    let mut code = Code::default();
    let given: Vec<(u8, &Argument)> = function
        .arguments
        .iter()
        .filter(|argument| function.role == StepRole::Evaluate || !matches!(argument.input, Input::Record(_)))
        .filter_map(|argument| Some((place(&INPUTS, &argument.input)?, argument)))
        .filter(|(_, argument)| argument.values.iter().any(Option::is_some))
        .collect();
    code.count(given.len());
    for (kind, argument) in given {
        code.0.push(kind);
        code.places(&argument.values);
    }
    code.count(function.statements.len());
    for statement in &function.statements {
        code.statement(statement);
    }
    code.count(function.results.len());
    for result in &function.results {
        code.count(result.len());
        result.iter().for_each(|term| code.term(term));
    }
    code.0
}

fn place<T: PartialEq>(among: &[T], one: &T) -> Option<u8> {
    let place = among.iter().position(|other| other == one)?;
    u8::try_from(place).ok()
}

#[derive(Default)]
struct Code(Vec<u8>);

impl Code {
    fn count(&mut self, mut count: usize) {
        while count >= 128 {
            self.0.push((count % 128) as u8 | 128);
            count /= 128;
        }
        self.0.push(count as u8);
    }

    /// Place 0 is nobody's.
    fn place(&mut self, value: Option<Value>) {
        self.count(value.map_or(0, |value| value.number() + 1));
    }

    fn places(&mut self, values: &[Option<Value>]) {
        self.count(values.len());
        values.iter().for_each(|value| self.place(*value));
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Let { value, term } => {
                self.0.push(0);
                self.place(Some(*value));
                self.term(term);
            }
            Statement::Stumpff { values, argument } => {
                self.0.push(1);
                self.places(values);
                self.term(argument);
            }
        }
    }

    fn term(&mut self, term: &Term) {
        match term {
            Term::Number(number) => {
                self.0.push(0);
                self.0.extend(number.as_emitted().to_le_bytes());
            }
            Term::Value(value) => {
                self.0.push(1);
                self.place(Some(*value));
            }
            Term::Negative(x) => self.operation(2, [x]),
            Term::Sum(addends) => {
                self.0.push(3);
                self.count(addends.len());
                for (negative, addend) in addends {
                    self.0.push(u8::from(*negative));
                    self.term(addend);
                }
            }
            Term::Product(factors) => {
                self.0.push(4);
                self.count(factors.len());
                factors.iter().for_each(|factor| self.term(factor));
            }
            Term::MulAdd { negative, a, b, addend } => {
                self.operation(5 + u8::from(*negative), [a, b, addend])
            }
            Term::Quotient(x, y) => self.operation(7, [x, y]),
            Term::Power(x, y) => self.operation(8, [x, y]),
            Term::Atan2(y, x) => self.operation(9, [y, x]),
            Term::Function(Elementary::AngleOverSine(k), x) => {
                self.0.push(23);
                self.count(*k as usize);
                self.term(x);
            }
            Term::Function(function, x) => {
                self.operation(10 + place(&FUNCTIONS, function).unwrap_or_default(), [x]);
            }
        }
    }

    fn operation<const N: usize>(&mut self, kind: u8, operands: [&Term; N]) {
        self.0.push(kind);
        operands.into_iter().for_each(|operand| self.term(operand));
    }
}
