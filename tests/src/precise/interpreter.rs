//! Runs programs as emitted code would run: every function with what its arguments give it, and nothing else.

use std::collections::HashMap;

use coadjoint_codegen::expr::{Function as Elementary, Number, Value as _};
use coadjoint_codegen::program::{
    Argument, Function, Input, Module, RecordKind, Role, Statement, Term, Value,
};

use super::matrix::Column;
use super::real::Real;

/// What functions are given: arrays, and records as the functions return them that compute them.
#[derive(Clone, Debug, Default)]
pub struct Given(HashMap<Input, Column>);

impl Given {
    /// These and one more.
    #[must_use]
    pub fn with(mut self, input: Input, values: Column) -> Self {
        self.0.insert(input, values);
        self
    }

    fn get(&self, input: Input) -> &Column {
        self.0.get(&input).unwrap_or_else(|| panic!("{input:?} is given"))
    }
}

/// What a function returns.
#[derive(Clone, Debug)]
pub struct Returned {
    /// Its arrays.
    pub results: Vec<Column>,
    /// The fields of its record, if it returns one.
    pub record: Option<(RecordKind, Column)>,
}

/// The values of one function.
struct Frame<'m> {
    module: &'m Module,
    values: HashMap<Value, Real>,
    names: HashMap<String, Value>,
}

/// Calls the function of a role, if there is one.
pub fn call(module: &Module, role: Role, given: &Given) -> Option<Returned> {
    let function = module.function(role)?;
    let mut frame = Frame { module, values: HashMap::new(), names: HashMap::new() };
    for argument in &function.arguments {
        frame.unpack(argument, given);
    }
    function.statements.iter().for_each(|statement| frame.run(statement));
    let results = function.results.iter();
    let results = results.map(|array| Column(array.iter().map(|term| frame.evaluate(term)).collect()));
    let record = function.record.map(|kind| {
        let fields = module.fields(kind).iter().map(|field| frame.value(*field));
        (kind, Column(fields.collect()))
    });
    Some(Returned { results: results.collect(), record })
}

impl Frame<'_> {
    /// Takes from an argument what the function uses of it.
    fn unpack(&mut self, argument: &Argument, given: &Given) {
        if argument.values.iter().all(Option::is_none) {
            return;
        }
        let given = given.get(argument.input);
        assert_eq!(argument.values.len(), given.len(), "{:?}", argument.input);
        for (value, number) in argument.values.iter().zip(&given.0) {
            if let Some(value) = value {
                self.define(*value, number.clone());
            }
        }
    }

    /// Gives a value its number. No two values of a function may have one name.
    fn define(&mut self, value: Value, number: Real) {
        let name = self.module.name(value);
        assert!(self.names.insert(name.to_owned(), value).is_none(), "two values are called `{name}`");
        self.values.insert(value, number);
    }

    fn value(&self, value: Value) -> Real {
        let name = self.module.name(value);
        self.values
            .get(&value)
            .cloned()
            .unwrap_or_else(|| panic!("`{name}` is not computed before it is used"))
    }

    fn run(&mut self, statement: &Statement) {
        match statement {
            Statement::Let { value, term } => {
                let number = self.evaluate(term);
                self.define(*value, number);
            }
            Statement::Stumpff { values, argument } => {
                let argument = self.evaluate(argument);
                for (k, value) in (0..).zip(values) {
                    if let Some(value) = value {
                        self.define(*value, argument.apply(Elementary::Stumpff(k)));
                    }
                }
            }
        }
    }

    /// The value of a term, operation by operation as written.
    fn evaluate(&self, term: &Term) -> Real {
        let of = |term: &Term| self.evaluate(term);
        match term {
            Term::Number(number) => Real::number(*number),
            Term::Value(value) => self.value(*value),
            Term::Negative(x) => -of(x),
            Term::Sum(addends) => {
                assert!(!addends[0].0, "the first addend of a sum is not subtracted");
                addends[1..].iter().fold(of(&addends[0].1), |sum, (negative, addend)| {
                    if *negative { sum - of(addend) } else { sum + of(addend) }
                })
            }
            Term::Product(factors) => {
                factors.iter().fold(Real::number(Number::ONE), |product, factor| product * of(factor))
            }
            Term::MulAdd { negative, a, b, addend } => {
                let product = of(a) * of(b);
                if *negative { of(addend) - product } else { of(addend) + product }
            }
            Term::Quotient(x, y) => of(x) / of(y),
            Term::Function(function, x) => {
                let is_stumpff = matches!(function, Elementary::Stumpff(_));
                assert!(!is_stumpff, "Stumpff functions have statements of their own");
                of(x).apply(*function)
            }
            Term::Power(x, y) => of(x).power(&of(y)),
            Term::Atan2(y, x) => of(y).atan2(&of(x)),
        }
    }
}

/// What one call of each of a step's functions gives, called in the order of a step.
pub struct Stages {
    /// The first approximation of the unknown.
    pub start: Column,
    /// `left − right`
    pub residual: Column,
    /// The equation's right side.
    pub right: Column,
    /// The Newton correction.
    pub correction: Column,
    /// The solution of `left(x) = right`, where there is an update of the fixed-point iteration.
    pub update: Option<Column>,
    /// The distances to the edges of the domain.
    pub margins: Column,
    /// The next state.
    pub next: Column,
}

/// Calls all functions of a step. `given` holds parameters, step size, state, time, controls and unknown.
pub fn stages(module: &Module, given: &Given) -> Stages {
    let mut given = given.clone();
    for role in [Role::New, Role::Begin] {
        let returned = call(module, role, &given).expect("every step has it");
        let (kind, fields) = returned.record.expect("a record");
        given = given.with(Input::Record(kind), fields);
    }
    let one = |role, given: &Given| {
        call(module, role, given).map(|returned| {
            assert_eq!(returned.results.len(), 1);
            returned.results[0].clone()
        })
    };
    let start = one(Role::Start, &given).expect("every step has it");
    let evaluation = call(module, Role::Evaluate, &given).expect("every step has it");
    let [residual, right] = &evaluation.results[..] else { panic!("residual and right side") };
    let (kind, fields) = evaluation.record.expect("a record");
    let given = given
        .with(Input::Record(kind), fields)
        .with(Input::Residual, residual.clone())
        .with(Input::Right, right.clone());
    Stages {
        start,
        residual: residual.clone(),
        right: right.clone(),
        correction: one(Role::Correction, &given).expect("every step has it"),
        update: one(Role::FixedPointUpdate, &given),
        margins: one(Role::Domain, &given).unwrap_or_else(|| Column(Vec::new())),
        next: one(Role::Finish, &given).expect("every step has it"),
    }
}

/// The derivative of a step by its functions: `tangent`, `adjoint` and the matrices, called at one point.
pub fn linear_maps(module: &Module, given: &Given) -> HashMap<Role, Vec<Column>> {
    let point = call(module, Role::Point, given).expect("every derivative has it");
    let (kind, fields) = point.record.expect("a record");
    let given = given.clone().with(Input::Record(kind), fields);
    let maps = module.functions.iter().map(|function: &Function| function.role);
    let maps = maps.filter(|role| *role != Role::Point);
    maps.map(|role| (role, call(module, role, &given).expect("it is there").results)).collect()
}
