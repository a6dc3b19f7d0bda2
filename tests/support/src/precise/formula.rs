//! Symbolic formulas as functions of numbers.

use std::collections::HashMap;

use coadjoint_codegen::expr::{Arena, Expr, Function, Number, Stage, Symbol, Vector};

use crate::evaluate::{Evaluate as _, Value};

use super::matrix::{Column, Matrix};
use super::real::Real;

/// Numbers for symbols.
#[derive(Clone, Debug, Default)]
pub struct Point(HashMap<Symbol, Real>);

impl Point {
    /// Gives the symbols these values, in order.
    pub fn set(&mut self, symbols: &[Symbol], values: &Column) {
        assert_eq!(symbols.len(), values.len());
        self.0.extend(symbols.iter().copied().zip(values.0.iter().cloned()));
    }

    /// The same point with other values for these symbols.
    pub fn with(&self, symbols: &[Symbol], values: &Column) -> Self {
        let mut point = self.clone();
        point.set(symbols, values);
        point
    }

    /// The values of symbols.
    pub fn get(&self, symbols: &[Symbol]) -> Column {
        Column(symbols.iter().map(|&symbol| self.value(symbol)).collect())
    }

    /// The value of a symbol.
    pub fn value(&self, symbol: Symbol) -> Real {
        self.0.get(&symbol).cloned().expect("a formula names no symbol but those given")
    }

    /// The value of an expression.
    pub fn scalar(&self, expr: Expr<'_>) -> Real {
        expr.evaluate(&|symbol| self.value(symbol))
    }

    /// The values of a vector's components.
    pub fn vector(&self, vector: &Vector<'_>) -> Column {
        Column(vector.evaluate(&|symbol| self.value(symbol)))
    }
}

/// A vector of expressions of some vectors of symbols, to be evaluated many times.
pub struct Formula<'a> {
    arguments: Vec<Vec<Symbol>>,
    value: Vector<'a>,
}

impl<'a> Formula<'a> {
    /// `formula` of symbolic vectors of these dimensions.
    pub fn new<const N: usize>(
        arena: &'a Arena,
        dimensions: [usize; N],
        formula: impl FnOnce([Vector<'a>; N]) -> Vector<'a>,
    ) -> Self {
        let arguments = dimensions.map(|dimension| symbols(arena, "x", dimension, Stage::Step));
        let symbols = arguments.iter().map(Vector::symbols).collect();
        Self { arguments: symbols, value: formula(arguments) }
    }

    /// The value at numbers.
    pub fn at<const N: usize>(&self, arguments: [&Column; N]) -> Column {
        assert_eq!(self.arguments.len(), N);
        let mut point = Point::default();
        for (symbols, values) in self.arguments.iter().zip(arguments) {
            point.set(symbols, values);
        }
        point.vector(&self.value)
    }

    /// The matrix of a formula of two vectors that is linear in the second one. What depends on the first one alone is computed once.
    pub fn matrix(&self, x: &Column) -> Matrix {
        let [of_x, of_u] = &self.arguments[..] else { panic!("a formula of two vectors") };
        let given = of_x.iter().zip(&x.0).map(|(&symbol, value)| (symbol, Several::Same(value.clone())));
        let unit = |i| Several::Each(Column::unit(of_u.len(), i).0);
        let units = of_u.iter().enumerate().map(|(i, &symbol)| (symbol, unit(i)));
        let values: HashMap<Symbol, Several> = given.chain(units).collect();
        let rows = self.value.evaluate(&|symbol| values[&symbol].clone());
        Matrix::from_fn(rows.len(), of_u.len(), |i, j| rows[i].at(j).clone())
    }
}

/// The values that something has at several points.
#[derive(Clone)]
enum Several {
    Same(Real),
    Each(Vec<Real>),
}

impl Several {
    fn at(&self, j: usize) -> &Real {
        match self {
            Self::Same(value) => value,
            Self::Each(values) => &values[j],
        }
    }

    fn map(&self, f: impl Fn(&Real) -> Real) -> Self {
        match self {
            Self::Same(value) => Self::Same(f(value)),
            Self::Each(values) => Self::Each(values.iter().map(f).collect()),
        }
    }

    fn zip(&self, other: &Self, f: impl Fn(&Real, &Real) -> Real) -> Self {
        match (self, other) {
            (a, Self::Same(b)) => a.map(|a| f(a, b)),
            (Self::Same(a), b) => b.map(|b| f(a, b)),
            (Self::Each(a), Self::Each(b)) => Self::Each(a.iter().zip(b).map(|(a, b)| f(a, b)).collect()),
        }
    }
}

impl Value for Several {
    fn number(number: Number) -> Self {
        Self::Same(Real::number(number))
    }
    fn add(&self, other: &Self) -> Self {
        self.zip(other, Value::add)
    }
    fn mul(&self, other: &Self) -> Self {
        self.zip(other, Value::mul)
    }
    fn powi(&self, exponent: i32) -> Self {
        self.map(|x| x.powi(exponent))
    }
    fn apply(&self, function: Function) -> Self {
        self.map(|x| x.apply(function))
    }
    fn power(&self, exponent: &Self) -> Self {
        self.zip(exponent, Value::power)
    }
    fn atan2(&self, x: &Self) -> Self {
        self.zip(x, Value::atan2)
    }
    fn choose(&self, negative: &Self, otherwise: &Self) -> Self {
        let [zero, one] = [Number::ZERO, Number::ONE].map(Real::number);
        let [share, rest] = [(&one, &zero), (&zero, &one)].map(|(a, b)| self.map(|x| x.choose(a, b)));
        share.mul(negative).add(&rest.mul(otherwise))
    }
}

/// A vector of new symbols.
pub fn symbols<'a>(arena: &'a Arena, name: &str, dimension: usize, stage: Stage) -> Vector<'a> {
    Vector((0..dimension).map(|i| arena.symbol(format!("{name}{i}"), stage)).collect())
}
