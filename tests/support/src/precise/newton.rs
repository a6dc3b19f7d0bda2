//! Steps solved to the last of 71 digits, straight from a method's equations.

use coadjoint_codegen::expr::{Symbol, Vector};
use coadjoint_codegen::method::Step;

use super::formula::Point;
use super::matrix::{Column, Matrix};
use super::real::Real;

/// Newton's method for a step's equation.
pub struct Solver<'s, 'a> {
    step: &'s Step<'a>,
    unknown: Vec<Symbol>,
    /// `left − right`
    residual: Vector<'a>,
    /// The same, and its Jacobian by columns.
    equations: Vector<'a>,
}

impl<'s, 'a> Solver<'s, 'a> {
    /// Prepares the equation.
    pub fn new(step: &'s Step<'a>) -> Self {
        let unknown = step.unknown.symbols();
        let residual = &step.left - &step.right;
        let jacobian = residual.jacobian(&unknown);
        let mut equations = residual.0.clone();
        equations.extend((0..unknown.len()).flat_map(|j| jacobian.column(j).0));
        Self { step, unknown, residual, equations: Vector(equations) }
    }

    /// The point with its unknown solved for: parameters, step size and state are given.
    pub fn solve(&self, point: &Point) -> Point {
        self.solve_from(point, &point.vector(&self.step.start))
    }

    /// The same, with a first approximation of the unknown.
    pub fn solve_from(&self, point: &Point, start: &Column) -> Point {
        let n = self.unknown.len();
        let mut solved = point.with(&self.unknown, start);
        // A Jacobian serves on once corrections are small: it is off by as much as the first of them, and so leaves that times the next one.
        let (near, roundoff) = (Real::ten_to(-20), Real::ten_to(-71));
        let mut jacobian = None;
        for _ in 0..20 {
            let (residual, kept) = match jacobian.take() {
                Some(kept) => (solved.vector(&self.residual), Some(kept)),
                None => (solved.vector(&self.equations), None),
            };
            let (matrix, off) = kept.unwrap_or_else(|| {
                let columns: Vec<Column> = (0..n).map(|j| residual.part(n + j * n, n)).collect();
                (Matrix::from_columns(&columns), None)
            });
            let correction = matrix.solve(&residual.part(0, n));
            solved = solved.with(&self.unknown, &(&solved.get(&self.unknown) - &correction));
            let size = correction.norm();
            let off = off.unwrap_or_else(|| size.clone());
            if &size * &off < roundoff {
                return solved;
            }
            jacobian = (off < near).then_some((matrix, Some(off)));
        }
        panic!("Newton's method does not converge");
    }

    /// The state after the step from a solved point.
    pub fn next(&self, solved: &Point) -> Column {
        solved.vector(&self.step.next)
    }
}
