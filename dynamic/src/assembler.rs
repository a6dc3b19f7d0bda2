//! From the functions of a program to lists of operations.

use std::collections::HashMap;

use coadjoint_codegen::program::{self, Argument, Function, Input, Statement, Term, Value};

use crate::interpreter::{Code, Elementary, Line, Operation};

/// The places of a frame, as functions come to need them.
#[derive(Debug)]
pub(crate) struct Frame {
    /// What is in them before anything is computed.
    numbers: Vec<f64>,
    /// Those of constants, by their bits.
    constants: HashMap<u64, u32>,
    /// Those that functions write to and nobody else reads.
    scratch: Vec<u32>,
}

impl Frame {
    /// A frame whose first places are taken.
    pub(crate) fn new(taken: usize) -> Self {
        Self { numbers: vec![0.0; taken], constants: HashMap::new(), scratch: Vec::new() }
    }

    /// The frame as it is before anything is computed.
    pub(crate) fn numbers(self) -> Vec<f64> {
        self.numbers
    }

    fn fresh(&mut self, number: f64) -> u32 {
        self.numbers.push(number);
        (self.numbers.len() - 1) as u32
    }

    fn constant(&mut self, number: f64) -> u32 {
        if let Some(place) = self.constants.get(&number.to_bits()) {
            return *place;
        }
        let place = self.fresh(number);
        self.constants.insert(number.to_bits(), place);
        place
    }
}

/// Where arguments, records and results of a function are.
pub(crate) trait Places {
    /// The first place of an input.
    fn input(&self, input: Input) -> usize;
    /// The fields of the record that is returned, and the first of their places.
    fn record(&self) -> (&[Value], usize);
    /// The first place of each array that is returned.
    fn result(&self, array: usize) -> usize;
    /// Whether of all numbers that are returned the least is wanted.
    fn is_least(&self) -> bool {
        false
    }
}

/// The code of a function.
pub(crate) fn assembled<R>(function: &Function<R>, places: &impl Places, frame: &mut Frame) -> Code {
    let free = frame.scratch.clone();
    let mut assembler = Assembler {
        frame,
        free,
        places: HashMap::new(),
        own: HashMap::new(),
        uses: uses(function),
        code: Code::default(),
    };
    assembler.arguments(&function.arguments, places);
    let (fields, first) = places.record();
    for (field, place) in fields.iter().zip(first..) {
        assembler.own.insert(*field, place as u32);
    }
    function.statements.iter().for_each(|statement| assembler.statement(statement));
    assembler.results(&function.results, places);
    // what is returned as it was given
    for (field, place) in fields.iter().zip(first..) {
        if let Some(from) = assembler.places.get(field).copied().filter(|from| *from as usize != place) {
            assembler.put(Operation::Copy, Some(place as u32), [from, 0, 0]);
        }
    }
    assembler.code
}

/// How often each value is named.
fn uses<R>(function: &Function<R>) -> HashMap<Value, usize> {
    let mut uses = HashMap::new();
    let terms = function.statements.iter().map(|statement| match statement {
        Statement::Let { term, .. } | Statement::Stumpff { argument: term, .. } => term,
    });
    for term in terms.chain(function.results.iter().flatten()) {
        term.values(&mut |value| *uses.entry(value).or_insert(0) += 1);
    }
    uses
}

struct Assembler<'a> {
    frame: &'a mut Frame,
    /// The places of the frame that can be written to.
    free: Vec<u32>,
    places: HashMap<Value, u32>,
    /// Those of values that are handed on.
    own: HashMap<Value, u32>,
    /// How often each value will be named.
    uses: HashMap<Value, usize>,
    code: Code,
}

/// A place with a number.
#[derive(Clone, Copy)]
enum Operand {
    /// That of a value.
    Named(Value, u32),
    /// One that is free after it was read.
    Temporary(u32),
    /// One that stays.
    Lasting(u32),
}

impl Operand {
    fn place(self) -> u32 {
        let (Self::Named(_, place) | Self::Temporary(place) | Self::Lasting(place)) = self;
        place
    }
}

impl Assembler<'_> {
    fn arguments(&mut self, arguments: &[Argument], places: &impl Places) {
        for argument in arguments {
            let first = places.input(argument.input);
            for (value, place) in argument.values.iter().zip(first..) {
                if let Some(value) = value {
                    self.places.insert(*value, place as u32);
                    // it stays
                    self.uses.insert(*value, usize::MAX);
                }
            }
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Let { value, term } => {
                let to = self.own.get(value).copied();
                let place = match self.term(term, to) {
                    Operand::Temporary(place) => place,
                    operand if to == Some(operand.place()) => operand.place(),
                    // another name for what is there already
                    operand => self.put_over(Operation::Copy, to, &[operand]),
                };
                self.name(*value, place);
            }
            Statement::Stumpff { values, argument } => {
                let argument = self.term(argument, None);
                self.release(argument);
                let places = values.iter().map(|value| {
                    value.map(|value| match self.own.get(&value) {
                        Some(place) => *place,
                        None => self.take(),
                    })
                });
                let places: Vec<Option<u32>> = places.collect();
                self.code.families.push(places.clone());
                let family = self.code.families.len() as u32 - 1;
                self.code.lines.push(Line {
                    operation: Operation::Stumpff,
                    to: 0,
                    a: argument.place(),
                    b: family,
                    c: 0,
                });
                for (value, place) in values.iter().zip(places) {
                    if let (Some(value), Some(place)) = (value, place) {
                        self.name(*value, place);
                    }
                }
            }
        }
    }

    fn results(&mut self, results: &[Vec<Term>], places: &impl Places) {
        if places.is_least() {
            let mut least: Option<Operand> = None;
            for term in results.iter().flatten() {
                let next = self.term(term, None);
                least = Some(match least {
                    Some(least) => Operand::Temporary(self.put_over(Operation::Least, None, &[least, next])),
                    None => next,
                });
            }
            if let Some(least) = least {
                self.put_over(Operation::Copy, Some(places.result(0) as u32), &[least]);
            }
            return;
        }
        for (array, terms) in results.iter().enumerate() {
            for (term, place) in terms.iter().zip(places.result(array)..) {
                let place = place as u32;
                let operand = self.term(term, Some(place));
                if operand.place() != place {
                    self.put_over(Operation::Copy, Some(place), &[operand]);
                }
            }
        }
    }

    /// Gives a value its place, which is free at once if nobody names it.
    fn name(&mut self, value: Value, place: u32) {
        self.places.insert(value, place);
        if self.own.contains_key(&value) {
            self.uses.insert(value, usize::MAX);
        } else if self.uses.get(&value).is_none_or(|uses| *uses == 0) {
            self.free.push(place);
        }
    }

    /// A place that is free.
    fn take(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            let place = self.frame.fresh(0.0);
            self.frame.scratch.push(place);
            place
        })
    }

    /// After an operand was read.
    fn release(&mut self, operand: Operand) {
        match operand {
            Operand::Temporary(place) => self.free.push(place),
            Operand::Lasting(_) => {}
            Operand::Named(value, place) => {
                if let Some(uses) = self.uses.get_mut(&value)
                    && *uses != usize::MAX
                {
                    *uses -= 1;
                    if *uses == 0 {
                        self.free.push(place);
                    }
                }
            }
        }
    }

    /// An operation, with its result where it is wanted, or in any place.
    fn put(&mut self, operation: Operation, to: Option<u32>, [a, b, c]: [u32; 3]) -> u32 {
        let to = to.unwrap_or_else(|| self.take());
        self.code.lines.push(Line { operation, to, a, b, c });
        to
    }

    /// The same of operands, which are read then.
    fn put_over(&mut self, operation: Operation, to: Option<u32>, operands: &[Operand]) -> u32 {
        let mut places = [0; 3];
        places.iter_mut().zip(operands).for_each(|(place, operand)| *place = operand.place());
        operands.iter().for_each(|operand| self.release(*operand));
        self.put(operation, to, places)
    }

    /// The value of an operation.
    fn made(&mut self, to: Option<u32>, operation: Operation, operands: &[&Term]) -> Operand {
        let operands: Vec<Operand> = operands.iter().map(|term| self.term(term, None)).collect();
        temporary(self.put_over(operation, to, &operands), to)
    }

    /// The value of a term; if it takes an operation, there where it is wanted.
    fn term(&mut self, term: &Term, to: Option<u32>) -> Operand {
        match term {
            Term::Number(number) => Operand::Lasting(self.frame.constant(number.as_emitted())),
            Term::Value(value) => Operand::Named(*value, self.places[value]),
            Term::Negative(x) => self.made(to, Operation::Negative, &[x]),
            Term::Sum(addends) => {
                let mut sum: Option<Operand> = None;
                for (place, (negative, addend)) in addends.iter().enumerate() {
                    let addend = self.term(addend, None);
                    let to = to.filter(|_| place + 1 == addends.len());
                    sum = Some(match sum {
                        None => addend,
                        Some(sum) => {
                            let operation = if *negative { Operation::Subtract } else { Operation::Add };
                            temporary(self.put_over(operation, to, &[sum, addend]), to)
                        }
                    });
                }
                sum.unwrap_or_else(|| Operand::Lasting(self.frame.constant(0.0)))
            }
            Term::Product(factors) => {
                let mut product: Option<Operand> = None;
                for (place, factor) in factors.iter().enumerate() {
                    let factor = self.term(factor, None);
                    let to = to.filter(|_| place + 1 == factors.len());
                    product = Some(match product {
                        None => factor,
                        Some(product) => {
                            temporary(self.put_over(Operation::Multiply, to, &[product, factor]), to)
                        }
                    });
                }
                product.unwrap_or_else(|| Operand::Lasting(self.frame.constant(1.0)))
            }
            Term::MulAdd { negative, a, b, addend } => {
                let operation = if *negative { Operation::NegMulAdd } else { Operation::MulAdd };
                self.made(to, operation, &[a, b, addend])
            }
            Term::Quotient(x, y) => self.made(to, Operation::Divide, &[x, y]),
            Term::Power(x, y) => self.made(to, Operation::Power, &[x, y]),
            Term::Atan2(y, x) => self.made(to, Operation::Atan2, &[y, x]),
            Term::Choice([x, y, z]) => self.made(to, Operation::Choice, &[x, y, z]),
            Term::Function(program::Elementary::AngleOverSine(order), x) => {
                let x = self.term(x, None);
                self.release(x);
                let place = self.put(Operation::AngleOverSine, to, [x.place(), *order, 0]);
                temporary(place, to)
            }
            Term::Function(function, x) => self.made(to, elementary(*function), &[x]),
        }
    }
}

/// The operand that an operation has made.
fn temporary(place: u32, to: Option<u32>) -> Operand {
    if to == Some(place) { Operand::Lasting(place) } else { Operand::Temporary(place) }
}

fn elementary(function: program::Elementary) -> Operation {
    use program::Elementary as Of;
    Operation::Elementary(match function {
        Of::Sqrt => return Operation::Sqrt,
        Of::RecipOrZero => return Operation::RecipOrZero,
        // the caller looks for the first, and a statement has all of the second of one argument
        Of::AngleOverSine(_) | Of::Stumpff(_) => unreachable!("they are operations of their own"),
        Of::Exp => Elementary::Exp,
        Of::Ln => Elementary::Ln,
        Of::Sin => Elementary::Sin,
        Of::Cos => Elementary::Cos,
        Of::Tan => Elementary::Tan,
        Of::Asin => Elementary::Asin,
        Of::Acos => Elementary::Acos,
        Of::Atan => Elementary::Atan,
        Of::Sinh => Elementary::Sinh,
        Of::Cosh => Elementary::Cosh,
        Of::Tanh => Elementary::Tanh,
    })
}
