//! Programs run on numbers of any kind: the reference for emitted code.

use std::collections::BTreeMap;
use std::fmt;

use coadjoint_codegen::expr::{Function as Elementary, Number};
use coadjoint_codegen::program::{
    Argument, FunctionRole, Input, Module, RecordKind, Statement, Term, Value, Values,
};

use crate::evaluate::Value as Numeric;

/// What functions are given: arrays, and records as the functions return them that compute them.
#[derive(Clone, Debug)]
pub struct Given<V>(BTreeMap<Input, Vec<V>>);

impl<V> Default for Given<V> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<V> Given<V> {
    /// These and one more.
    #[must_use]
    pub fn with(mut self, input: Input, values: impl IntoIterator<Item = V>) -> Self {
        self.0.insert(input, values.into_iter().collect());
        self
    }
}

/// What a function returns.
#[derive(Clone, Debug)]
pub struct Returned<V> {
    /// Its arrays.
    pub results: Vec<Vec<V>>,
    /// The fields of its record, if it returns one.
    pub record: Option<(RecordKind, Vec<V>)>,
}

/// Why a function could not be run: its caller's mistake, or a program's that cannot be emitted either.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CallError {
    /// There is no function of this role.
    NoFunction(String),
    /// An argument is missing, or has another length.
    NotGiven(Input),
    /// A value is used that is not computed before.
    NotComputed(String),
    /// Two values that the function sees have one name.
    NamedTwice(String),
}

impl fmt::Display for CallError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFunction(role) => write!(f, "there is no function {role}"),
            Self::NotGiven(input) => write!(f, "{input:?} is not given, or has another length"),
            Self::NotComputed(name) => write!(f, "`{name}` is used before it is computed"),
            Self::NamedTwice(name) => write!(f, "two values are called `{name}`"),
        }
    }
}

impl std::error::Error for CallError {}

/// A module whose functions can be called.
pub trait Call<R> {
    /// Calls the function of a role, which sees what its arguments give it and nothing else.
    ///
    /// # Errors
    /// If there is no such function, if it is not given what it needs, and if it is no function at all.
    fn call<V: Numeric>(&self, role: R, given: &Given<V>) -> Result<Returned<V>, CallError>;
}

impl<R: FunctionRole> Call<R> for Module<R> {
    fn call<V: Numeric>(&self, role: R, given: &Given<V>) -> Result<Returned<V>, CallError> {
        let function = self.function(role).ok_or_else(|| CallError::NoFunction(role.name()))?;
        let mut frame = Frame { module: &self.values, values: BTreeMap::new(), names: BTreeMap::new() };
        function.arguments.iter().try_for_each(|argument| frame.unpack(argument, given))?;
        function.statements.iter().try_for_each(|statement| frame.run(statement))?;
        let array = |array: &Vec<Term>| array.iter().map(|term| frame.evaluate(term)).collect();
        let results = function.results.iter().map(array).collect::<Result<_, _>>()?;
        let fields = |kind| -> Result<Vec<V>, CallError> {
            self.values.fields(kind).iter().map(|field| frame.value(*field)).collect()
        };
        let record = function.record.map(|kind| Ok((kind, fields(kind)?))).transpose()?;
        Ok(Returned { results, record })
    }
}

/// The values of one call.
struct Frame<'m, V> {
    module: &'m Values,
    values: BTreeMap<Value, V>,
    names: BTreeMap<&'m str, Value>,
}

impl<V: Numeric> Frame<'_, V> {
    /// Takes from an argument what the function uses of it.
    fn unpack(&mut self, argument: &Argument, given: &Given<V>) -> Result<(), CallError> {
        if argument.values.iter().all(Option::is_none) {
            return Ok(());
        }
        let given = given.0.get(&argument.input).filter(|given| given.len() == argument.values.len());
        let given = given.ok_or(CallError::NotGiven(argument.input))?;
        let mut used =
            argument.values.iter().zip(given).filter_map(|(value, number)| Some(((*value)?, number)));
        used.try_for_each(|(value, number)| self.define(value, number.clone()))
    }

    fn define(&mut self, value: Value, number: V) -> Result<(), CallError> {
        let name = self.module.name(value);
        if self.names.insert(name, value).is_some() {
            return Err(CallError::NamedTwice(name.to_owned()));
        }
        self.values.insert(value, number);
        Ok(())
    }

    fn value(&self, value: Value) -> Result<V, CallError> {
        let known = self.values.get(&value).cloned();
        known.ok_or_else(|| CallError::NotComputed(self.module.name(value).to_owned()))
    }

    fn run(&mut self, statement: &Statement) -> Result<(), CallError> {
        match statement {
            Statement::Let { value, term } => self.define(*value, self.evaluate(term)?),
            Statement::Stumpff { values, argument } => {
                let argument = self.evaluate(argument)?;
                let mut used = (0..).zip(values).filter_map(|(k, value)| Some((k, (*value)?)));
                used.try_for_each(|(k, value)| self.define(value, argument.apply(Elementary::Stumpff(k))))
            }
        }
    }

    /// The value of a term, operation by operation as written.
    fn evaluate(&self, term: &Term) -> Result<V, CallError> {
        let of = |term: &Term| self.evaluate(term);
        let signed = |negative: bool, x: V| if negative { V::number(Number::MINUS_ONE).mul(&x) } else { x };
        Ok(match term {
            Term::Number(number) => V::number(*number),
            Term::Value(value) => self.value(*value)?,
            Term::Negative(x) => signed(true, of(x)?),
            Term::Sum(addends) => {
                addends.iter().try_fold(V::number(Number::ZERO), |sum, (negative, addend)| {
                    Ok(sum.add(&signed(*negative, of(addend)?)))
                })?
            }
            Term::Product(factors) => {
                let one = V::number(Number::ONE);
                factors.iter().try_fold(one, |product, factor| Ok(product.mul(&of(factor)?)))?
            }
            Term::MulAdd { negative, a, b, addend } => {
                of(addend)?.add(&signed(*negative, of(a)?.mul(&of(b)?)))
            }
            Term::Quotient(x, y) => of(x)?.mul(&of(y)?.powi(-1)),
            Term::Function(function, x) => of(x)?.apply(*function),
            Term::Power(x, y) => of(x)?.power(&of(y)?),
            Term::Atan2(y, x) => of(y)?.atan2(&of(x)?),
            Term::Choice([x, y, z]) => of(x)?.choose(&of(y)?, &of(z)?),
        })
    }
}
