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

/// The kinds of terms. `runtime/src/bytecode.rs` has this module too, to the letter.
mod kind {
    pub(super) const NUMBER: u8 = 0;
    pub(super) const VALUE: u8 = 1;
    pub(super) const NEGATIVE: u8 = 2;
    pub(super) const SUM: u8 = 3;
    pub(super) const PRODUCT: u8 = 4;
    pub(super) const MUL_ADD: u8 = 5;
    pub(super) const NEG_MUL_ADD: u8 = 6;
    pub(super) const QUOTIENT: u8 = 7;
    pub(super) const POWER: u8 = 8;
    pub(super) const ATAN2: u8 = 9;
    pub(super) const SQRT: u8 = 10;
    pub(super) const EXP: u8 = 11;
    pub(super) const LN: u8 = 12;
    pub(super) const SIN: u8 = 13;
    pub(super) const COS: u8 = 14;
    pub(super) const TAN: u8 = 15;
    pub(super) const ASIN: u8 = 16;
    pub(super) const ACOS: u8 = 17;
    pub(super) const ATAN: u8 = 18;
    pub(super) const SINH: u8 = 19;
    pub(super) const COSH: u8 = 20;
    pub(super) const TANH: u8 = 21;
    pub(super) const RECIP_OR_ZERO: u8 = 22;
    pub(super) const ANGLE_OVER_SINE: u8 = 23;
    pub(super) const CHOICE: u8 = 24;
}

/// The functions that lead from one state to the next, each in bytes.
pub fn functions(module: &Module<StepRole>) -> impl Iterator<Item = Vec<u8>> {
    ROLES.iter().map(|role| module.function(*role).map(function).unwrap_or_default())
}

fn function(function: &Function<StepRole>) -> Vec<u8> {
    let mut code = Code::default();
    let given: Vec<(usize, &Argument)> = function
        .arguments
        .iter()
        .filter(|argument| function.role == StepRole::Evaluate || !matches!(argument.input, Input::Record(_)))
        .filter_map(|argument| Some((INPUTS.iter().position(|input| *input == argument.input)?, argument)))
        .filter(|(_, argument)| argument.values.iter().any(Option::is_some))
        .collect();
    code.count(given.len());
    for (kind, argument) in given {
        code.count(kind);
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
                self.0.push(kind::NUMBER);
                self.0.extend(number.as_emitted().to_le_bytes());
            }
            Term::Value(value) => {
                self.0.push(kind::VALUE);
                self.place(Some(*value));
            }
            Term::Negative(x) => self.operation(kind::NEGATIVE, [x]),
            Term::Sum(addends) => {
                self.0.push(kind::SUM);
                self.count(addends.len());
                for (negative, addend) in addends {
                    self.0.push(u8::from(*negative));
                    self.term(addend);
                }
            }
            Term::Product(factors) => {
                self.0.push(kind::PRODUCT);
                self.count(factors.len());
                factors.iter().for_each(|factor| self.term(factor));
            }
            Term::MulAdd { negative, a, b, addend } => {
                let kind = if *negative { kind::NEG_MUL_ADD } else { kind::MUL_ADD };
                self.operation(kind, [a, b, addend])
            }
            Term::Quotient(x, y) => self.operation(kind::QUOTIENT, [x, y]),
            Term::Power(x, y) => self.operation(kind::POWER, [x, y]),
            Term::Atan2(y, x) => self.operation(kind::ATAN2, [y, x]),
            Term::Choice([x, y, z]) => self.operation(kind::CHOICE, [x, y, z]),
            Term::Function(function, x) => {
                self.function(*function);
                self.term(x);
            }
        }
    }

    /// The kind of a function, and which of a family it is.
    fn function(&mut self, function: Elementary) {
        self.0.push(match function {
            Elementary::Sqrt => kind::SQRT,
            Elementary::Exp => kind::EXP,
            Elementary::Ln => kind::LN,
            Elementary::Sin => kind::SIN,
            Elementary::Cos => kind::COS,
            Elementary::Tan => kind::TAN,
            Elementary::Asin => kind::ASIN,
            Elementary::Acos => kind::ACOS,
            Elementary::Atan => kind::ATAN,
            Elementary::Sinh => kind::SINH,
            Elementary::Cosh => kind::COSH,
            Elementary::Tanh => kind::TANH,
            Elementary::RecipOrZero => kind::RECIP_OR_ZERO,
            // a statement has all of one argument
            Elementary::Stumpff(_) => unreachable!("Stumpff functions are no terms"),
            Elementary::AngleOverSine(order) => {
                self.0.push(kind::ANGLE_OVER_SINE);
                return self.count(order as usize);
            }
        });
    }

    fn operation<const N: usize>(&mut self, kind: u8, operands: [&Term; N]) {
        self.0.push(kind);
        operands.into_iter().for_each(|operand| self.term(operand));
    }
}
