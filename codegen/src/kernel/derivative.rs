//! The derivative of one step as straight-line code: what it is made of, then the linear maps themselves.

use super::factor::Factoring;
use super::plan::{Plan, Signed};
use super::schedule::{Maps, Namer, Schedule};
use super::{Section, SymbolNames};
use crate::expr::{Arena, Expr, Vector};
use crate::method::Step;
use crate::method::linearization::{Linearization, Matrices};

/// The derivative of a step at one point, and its transpose, as code.
///
/// The matrices are `explicit + through · unknown`, column by column, for the product is better made by loops than written out.
#[derive(Clone, Debug)]
pub struct Derivative {
    /// Names of the values that depend on the point alone, and that the maps are made of.
    pub fields: Vec<String>,
    /// Computes them from parameters, step size, state, time, controls and the solution of the step's equation.
    pub point: Section,
    /// The change of the next state, from those of state, controls and parameters.
    pub tangent: Section,
    /// The derivatives by state, controls and parameters, one after the other, of a function of the next state, from its own there.
    pub adjoint: Section,
    /// The derivatives by state, controls and parameters as matrices. Each starts with the columns of the derivative by the unknown; then
    /// come, for each of its own columns, the derivative of the next state with the unknown as it is, and that of the unknown.
    pub matrices: [Section; 3],
    /// The components of the unknown.
    pub unknown: Vec<String>,
    /// The components of the changes of state, controls and parameters.
    pub changes: [Vec<String>; 3],
    /// The components of the function's derivative by the next state.
    pub costate: Vec<String>,
    /// What the step size is called.
    pub h: Vec<String>,
    /// What all other symbols are called.
    pub symbols: SymbolNames,
}

impl Derivative {
    /// Lays out the derivative of a step.
    pub fn new<'a>(arena: &'a Arena, step: &Step<'a>, linearization: &Linearization<'a>) -> Self {
        let adjoint = linearization.adjoint(arena);
        let by = [&adjoint.state, &adjoint.control, &adjoint.parameters];
        let mut maps: Vec<Vec<Expr<'a>>> =
            vec![linearization.next.0.clone(), by.into_iter().flat_map(Vector::iter).collect()];
        let Matrices { through, columns } = linearization.matrices(arena);
        maps.extend(columns.map(|columns| {
            let columns = columns.into_iter().flat_map(|(next, unknown)| [next, unknown]);
            through.iter().cloned().chain(columns).flat_map(|column| column.0).collect()
        }));
        let mut factoring = Factoring::new(arena, maps.iter().flatten().copied());
        let mut plan = Plan::new(arena);
        let mut names = Namer::new();
        let outputs: Vec<Vec<Signed>> =
            maps.iter().map(|map| map.iter().map(|&expr| plan.plan(factoring.of(expr))).collect()).collect();
        names.carry_over(arena, &factoring, &plan);
        plan.share_pairs();
        let Maps { fields, point, maps, symbols } = Schedule::new(arena, &plan, names).maps(&outputs);
        let mut maps = maps.into_iter();
        let mut next = || maps.next().unwrap_or_default();
        Self {
            fields,
            point,
            tangent: next(),
            adjoint: next(),
            matrices: [next(), next(), next()],
            unknown: symbols.of(&step.unknown),
            changes: [&linearization.state, &linearization.control, &linearization.parameters]
                .map(|change| symbols.of(change)),
            costate: symbols.of(&adjoint.next),
            h: symbols.of(&Vector(vec![step.h])),
            symbols,
        }
    }
}
