//! Symbolic formulas as functions of numbers.

use std::collections::HashMap;

use coadjoint_codegen::expr::{Arena, Expr, Stage, Symbol, Vector};

use super::matrix::Column;
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
}

/// A vector of new symbols.
pub fn symbols<'a>(arena: &'a Arena, name: &str, dimension: usize, stage: Stage) -> Vector<'a> {
    Vector((0..dimension).map(|i| arena.symbol(format!("{name}{i}"), stage)).collect())
}
