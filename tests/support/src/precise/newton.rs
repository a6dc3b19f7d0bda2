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
    /// `left − right` and its Jacobian by columns.
    equations: Vector<'a>,
}

impl<'s, 'a> Solver<'s, 'a> {
    /// Prepares the equation.
    pub fn new(step: &'s Step<'a>) -> Self {
        let unknown = step.unknown.symbols();
        let residual = &step.left - &step.right;
        let jacobian = residual.jacobian(&unknown);
        let mut equations = residual.0;
        equations.extend((0..unknown.len()).flat_map(|j| jacobian.column(j).0));
        Self { step, unknown, equations: Vector(equations) }
    }

    /// The point with its unknown solved for: parameters, step size and state are given.
    pub fn solve(&self, point: &Point) -> Point {
        self.solve_from(point, &point.vector(&self.step.start))
    }

    /// The same, with a first approximation of the unknown.
    pub fn solve_from(&self, point: &Point, start: &Column) -> Point {
        let n = self.unknown.len();
        let mut solved = point.with(&self.unknown, start);
        // what quadratic convergence leaves behind after a correction this small is below all digits
        let small = Real::ten_to(-40);
        for _ in 0..20 {
            let values = solved.vector(&self.equations);
            let columns: Vec<Column> = (0..n).map(|j| values.part(n + j * n, n)).collect();
            let correction = Matrix::from_columns(&columns).solve(&values.part(0, n));
            solved = solved.with(&self.unknown, &(&solved.get(&self.unknown) - &correction));
            if correction.norm() < small {
                return solved;
            }
        }
        panic!("Newton's method does not converge");
    }

    /// The state after the step from a solved point.
    pub fn next(&self, solved: &Point) -> Column {
        solved.vector(&self.step.next)
    }
}
