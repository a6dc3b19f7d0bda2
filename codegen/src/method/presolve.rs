//! Presolving: which unknowns of a step's equations need no iteration.
//!
//! An equation `left(x) = right(x)` whose right side does not depend on its own unknown is solved by what it says: the
//! step is explicit in that unknown. One that is linear in it is solved by elimination, in closed form. What is found
//! is put into the other equations, which may then be explicit, too.

use crate::expr::{Expr, Symbol, Vector};
use crate::group::Product;

/// One of a step's equations, for a block of unknowns.
pub struct Equation<'a> {
    /// The unknowns, symbols.
    pub unknown: Vector<'a>,
    /// The lengths of the blocks of unknowns that have a unit in common.
    pub blocks: Vec<usize>,
    /// `left`, a function of the unknowns.
    pub left: Vector<'a>,
    /// `right`, a function of all unknowns of the step.
    pub right: Vector<'a>,
    /// The unknowns for which `left` is `right`, if there is a closed form of them.
    pub solved: Option<Vector<'a>>,
    /// A first approximation of the unknowns from the state.
    pub start: Vector<'a>,
    /// The names of the unknowns, given to their values where they are explicit.
    pub names: Vec<String>,
}

impl<'a> Equation<'a> {
    /// Apart, for each of these sets of a group's factors.
    pub fn apart(&self, group: &Product, sets: &[Vec<usize>]) -> Vec<Self> {
        let places = group.places();
        let of_set = |set: &Vec<usize>| {
            let rows: Vec<usize> = set.iter().flat_map(|&factor| places[factor].algebra.clone()).collect();
            let part = |whole: &Vector<'a>| Vector(rows.iter().map(|&row| whole.0[row]).collect());
            Self {
                unknown: part(&self.unknown),
                blocks: set.iter().flat_map(|&factor| group.factors[factor].group.blocks()).collect(),
                left: part(&self.left),
                right: part(&self.right),
                solved: self.solved.as_ref().map(part),
                start: part(&self.start),
                names: rows.iter().map(|&row| self.names[row].clone()).collect(),
            }
        };
        sets.iter().map(of_set).collect()
    }
}

/// The equations left to iterate on, and the unknowns found.
pub struct Presolved<'a> {
    /// The equations left.
    pub equations: Vec<Equation<'a>>,
    /// Values of the unknowns found, as functions of those left.
    pub found: Vec<(Symbol, Expr<'a>)>,
}

/// Solves for what can be solved for without iteration.
pub fn presolve(equations: Vec<Equation<'_>>) -> Presolved<'_> {
    presolve_only(equations, None)
}

/// The same; these unknowns are left, if it is said which.
pub fn presolve_only<'a>(mut equations: Vec<Equation<'a>>, left: Option<&[String]>) -> Presolved<'a> {
    let is_left = |equation: &Equation<'a>| left.is_some_and(|left| left.contains(&equation.names[0]));
    let mut found: Vec<(Symbol, Expr<'_>)> = Vec::new();
    loop {
        let all: Vec<Symbol> = equations.iter().flat_map(|equation| equation.unknown.symbols()).collect();
        let mut others = equations.iter().enumerate().filter(|(_, equation)| !is_left(equation));
        let solution = others.clone().find_map(|(i, equation)| Some((i, equation.explicit()?)));
        let solution =
            solution.or_else(|| others.find_map(|(i, equation)| Some((i, equation.linear(&all)?))));
        let Some((i, values)) = solution else { return Presolved { equations, found } };
        let equation = equations.remove(i);
        let values =
            values.0.iter().zip(&equation.names).map(|(value, name)| value.hold().named(name.clone()));
        let new: Vec<_> = equation.unknown.symbols().into_iter().zip(values).collect();
        for (_, value) in &mut found {
            *value = value.substitute(&new);
        }
        for other in &mut equations {
            for side in [&mut other.left, &mut other.right].into_iter().chain(&mut other.solved) {
                *side = side.substitute(&new);
            }
        }
        found.extend(new);
    }
}

impl<'a> Equation<'a> {
    /// The unknowns, if the right side does not depend on them.
    fn explicit(&self) -> Option<Vector<'a>> {
        let own = self.unknown.symbols();
        self.solved.clone().filter(|_| !self.right.depends_on(&own))
    }

    /// The unknowns, if the equation is linear in them, with coefficients that depend on no unknown.
    fn linear(&self, all: &[Symbol]) -> Option<Vector<'a>> {
        let own = self.unknown.symbols();
        let difference = &self.left - &self.right;
        let jacobian = difference.jacobian(&own);
        if Vector(jacobian.entries.clone()).depends_on(all) {
            return None;
        }
        difference.affine_root(&jacobian.map(Expr::hold), &own)
    }
}
