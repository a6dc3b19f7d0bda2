//! R(n), translations of Euclidean space.
//!
//! * Algebra: `Rⁿ` itself; bracket and `ad*` zero.
//! * Storage: the vector; `g' = ξ`.
//! * Exponential and Cayley map are the identity, their logarithmic derivatives too.

use super::{EquationNames, Equations, Group, GroupNames, MatrixFunction, Representation};
use crate::expr::{Expr, Vector};
use crate::quantity::Kind;

/// Translations of the Euclidean space of this dimension, 1 to 6.
pub struct R(pub usize);

/// nalgebra's names of components.
const AXES: &[&str] = &["x", "y", "z", "w", "a", "b"];

/// Those of each dimension.
static NAMES: [GroupNames; 6] =
    [names("R1", 1), names("R2", 2), names("R3", 3), names("R4", 4), names("R5", 5), names("R6", 6)];

const fn names(name: &'static str, n: usize) -> GroupNames {
    let axes = AXES.split_at(n).0;
    GroupNames {
        name,
        conventions: "position and momentum in fixed Cartesian coordinates",
        configuration: "position",
        kind: Kind::Vector(n),
        coordinates: axes,
        unit_coordinates: 0,
        axes,
        blocks: &[],
        parts: &[],
        components: &[],
    }
}

impl Group for R {
    fn names(&self) -> &GroupNames {
        &NAMES[self.0 - 1]
    }

    fn equations(&self, names: &EquationNames<'_>) -> Equations {
        let (configuration, by_energy) = (names.velocity.to_owned(), Vec::new());
        Equations { configuration, bracket: None, by_energy, advected: Vec::new() }
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
