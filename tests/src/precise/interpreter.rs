//! Runs a kernel's straight-line code as emitted code would run, with what emitted code can see.

use std::collections::HashMap;

use coadjoint_codegen::expr::{Function, Number, Value};
use coadjoint_codegen::kernel::{Kernel, Section, Statement, Term};

use super::matrix::Column;
use super::real::Real;

/// Named values.
#[derive(Clone, Debug, Default)]
pub struct Scope(HashMap<String, Real>);

impl Scope {
    /// Adds names with their values, in order. No two values may have one name; `_` names nothing.
    pub fn define<'n>(&mut self, names: impl IntoIterator<Item = &'n String>, values: &Column) {
        let mut values = values.0.iter().cloned();
        for name in names {
            let value = values.next().expect("a value for every name");
            if name != "_" {
                let previous = self.0.insert(name.clone(), value);
                assert!(previous.is_none(), "`{name}` is defined twice");
            }
        }
        assert!(values.next().is_none(), "a name for every value");
    }

    fn get(&self, name: &str) -> Real {
        self.0.get(name).cloned().unwrap_or_else(|| panic!("`{name}` is not defined"))
    }

    /// All of both scopes.
    fn and(&self, other: &Self) -> Self {
        let mut union = self.clone();
        for (name, value) in &other.0 {
            let previous = union.0.insert(name.clone(), value.clone());
            assert!(previous.is_none(), "`{name}` is defined twice");
        }
        union
    }

    fn only(&self, names: &[String]) -> Self {
        Self(names.iter().map(|name| (name.clone(), self.get(name))).collect())
    }
}

/// What a section computes: its results, and everything it has named.
pub fn run(section: &Section, surroundings: &Scope) -> (Column, Scope) {
    // nothing but the declared inputs: emitted code unpacks no more
    let mut scope = surroundings.only(&section.inputs);
    for statement in &section.statements {
        match statement {
            Statement::Let { name, value } => {
                let value = evaluate(value, &scope);
                scope.define([name], &Column(vec![value]));
            }
            Statement::Stumpff { names, argument } => {
                let argument = evaluate(argument, &scope);
                for (k, name) in (0..).zip(names) {
                    let value = argument.apply(Function::Stumpff(k));
                    scope.define(name, &Column(name.iter().map(|_| value.clone()).collect()));
                }
            }
        }
    }
    let results = section.results.iter().map(|result| evaluate(result, &scope)).collect();
    (Column(results), scope)
}

/// The value of a term, operation by operation as written.
fn evaluate(term: &Term, scope: &Scope) -> Real {
    let of = |term: &Term| evaluate(term, scope);
    match term {
        Term::Number(number) => Real::number(*number),
        Term::Name(name) => scope.get(name),
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
        Term::Quotient(x, y) => of(x) / of(y),
        Term::Function(function, x) => {
            assert!(
                !matches!(function, Function::Stumpff(_)),
                "Stumpff functions have statements of their own"
            );
            of(x).apply(*function)
        }
        Term::Power(x, y) => of(x).power(&of(y)),
        Term::Atan2(y, x) => of(y).atan2(&of(x)),
    }
}

/// What one call of each of a kernel's functions gives, called in the order of a step.
pub struct Stages {
    /// The first approximation of the unknown.
    pub start: Column,
    /// `left − right`
    pub residual: Column,
    /// The equation's right side.
    pub right: Column,
    /// The Newton correction.
    pub correction: Column,
    /// The distance to the edge of the domain, if there is one.
    pub margin: Option<Real>,
    /// The next state.
    pub next: Column,
}

/// What a kernel's functions take.
pub struct Inputs {
    /// The parameters' names and values.
    pub parameters: (Vec<String>, Column),
    /// The step size.
    pub h: Real,
    /// The state's names and values.
    pub state: (Vec<String>, Column),
    /// The names and values of what only the beginning of a step is given: time and controls.
    pub given: (Vec<String>, Column),
    /// The values of the unknown, known by the kernel's own names.
    pub unknown: Column,
}

/// Calls all functions of a kernel; each sees what the signature of its counterpart in the runtime gives it.
pub fn stages(kernel: &Kernel, inputs: &Inputs) -> Stages {
    let scope = |names: &[String], values: &Column| {
        let mut scope = Scope::default();
        scope.define(names, values);
        scope
    };
    let mut parameters = scope(&inputs.parameters.0, &inputs.parameters.1);
    parameters.define(&kernel.h, &Column(kernel.h.iter().map(|_| inputs.h.clone()).collect()));
    let state = scope(&inputs.state.0, &inputs.state.1);
    let given = scope(&inputs.given.0, &inputs.given.1);
    let unknown = scope(&kernel.unknown, &inputs.unknown);

    let constants = run(&kernel.new, &parameters).1.only(&kernel.constants);
    let seen = constants.and(&state);
    let step = run(&kernel.begin, &seen.and(&given)).1.only(&kernel.step);
    let seen = seen.and(&step);
    let (start, _) = run(&kernel.start, &seen);

    let seen = seen.and(&unknown);
    let (evaluation, all) = run(&kernel.evaluate, &seen);
    let (residual, right) = (evaluation.part(0, start.len()), evaluation.part(start.len(), start.len()));
    let iterate = all.only(&kernel.iterate).and(&scope(&kernel.residual, &residual));

    let seen = seen.and(&iterate);
    let (correction, _) = run(&kernel.correction, &seen);
    let (next, _) = run(&kernel.finish, &seen);
    let (margin, _) = run(&kernel.domain, &seen);
    Stages { start, residual, right, correction, margin: margin.0.into_iter().next(), next }
}
