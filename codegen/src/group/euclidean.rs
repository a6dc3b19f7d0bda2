//! R(n), translations of Euclidean space.
//!
//! * Algebra: `Rⁿ` itself; bracket and `ad*` zero.
//! * Storage: the vector; `g' = ξ`.
//! * Exponential and Cayley map are the identity, their logarithmic derivatives too.

use super::{EquationNames, Equations, Group, MatrixFunction, Representation};
use crate::expr::{Expr, Vector};
use crate::quantity::Kind;

/// Translations of the Euclidean space of this dimension, 1 to 6.
pub struct R(pub usize);

/// The group's name for each dimension.
const NAMES: [&str; 6] = ["R1", "R2", "R3", "R4", "R5", "R6"];

/// nalgebra's names of components.
const AXES: &[&str] = &["x", "y", "z", "w", "a", "b"];

impl Group for R {
    fn name(&self) -> &'static str {
        NAMES[self.0 - 1]
    }

    fn conventions(&self) -> &'static str {
        "position and momentum in fixed Cartesian coordinates"
    }

    fn configuration_name(&self) -> &'static str {
        "position"
    }

    fn configuration_kind(&self) -> Kind {
        Kind::Vector(self.0)
    }

    fn coordinates(&self) -> &'static [&'static str] {
        &AXES[..self.0]
    }

    fn equations(&self, names: &EquationNames<'_>) -> Equations {
        Equations { configuration: names.velocity.to_owned(), momentum: Vec::new(), advected: Vec::new() }
    }

    fn dimension(&self) -> usize {
        self.0
    }

    fn axes(&self) -> &'static [&'static str] {
        &AXES[..self.0]
    }

    fn bracket<'a>(&self, x: &Vector<'a>, _: &Vector<'a>) -> Vector<'a> {
        Vector::zeros(x.0[0].arena(), self.0)
    }

    fn closed_form<'a>(&self, _: MatrixFunction, x: &Vector<'a>) -> Vector<'a> {
        x.clone()
    }

    fn closed_d_right_dual<'a>(&self, _: MatrixFunction, _: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        m.clone()
    }

    fn closed_domain<'a>(&self, _: MatrixFunction, _: &Vector<'a>) -> Vec<Expr<'a>> {
        Vec::new()
    }

    fn compose<'a>(&self, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a> {
        g + h
    }

    fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        -g
    }

    fn normalize<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        g.clone()
    }

    fn to_space<'a>(&self, _: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        m.clone()
    }

    fn representations(&self) -> &[&'static dyn Representation] {
        &[]
    }

    fn is_linear(&self) -> bool {
        true
    }
}
