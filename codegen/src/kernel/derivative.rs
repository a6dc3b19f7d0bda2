//! The derivative of one step as straight-line code: what it is made of, then the linear maps themselves.

use super::factor::Factoring;
use super::plan::{Plan, Signed};
use super::schedule::{Maps, Namer, Schedule};
use super::{Section, SymbolNames};
use crate::expr::{Arena, Expr, Vector};
use crate::method::Step;
use crate::method::linearization::{Derivatives, Linearization, Matrices};

/// The derivative of a step at one point as code: of the linear maps those that are wanted.
///
/// The matrices are `explicit + through · unknown`, column by column, for the product is better made by loops than written out.
#[derive(Clone, Debug)]
pub struct Derivative {
    /// Names of the values that depend on the point alone, and that the maps are made of.
    pub fields: Vec<String>,
    /// Computes them from parameters, step size, state, time, controls and the solution of the step's equation.
    pub point: Section,
    /// The change of the next state, from those of state, controls and parameters.
    pub tangent: Option<Section>,
    /// The derivatives by state, controls and parameters, one after the other, of a function of the next state, from its own there.
    pub adjoint: Option<Section>,
    /// The columns of the derivative of the next state by the unknown, of which all matrices make use.
    pub through: Option<Section>,
    /// The derivatives by state, controls and parameters as matrices: for each column the derivative of the next state with the unknown as
    /// it is, and that of the unknown. None for those that are not wanted or have no columns.
    pub matrices: [Option<Section>; 3],
    /// The components of the unknown.
    pub unknown: Vec<String>,
    /// The components of the perturbations of state, controls and parameters.
    pub perturbations: [Vec<String>; 3],
    /// The components of the function's derivative by the next state.
    pub costate: Vec<String>,
    /// What the step size is called.
    pub h: Vec<String>,
    /// What all other symbols are called.
    pub symbols: SymbolNames,
}

impl Derivative {
    /// Lays out the derivative of a step, as far as it is wanted.
    pub fn new<'a>(
        arena: &'a Arena,
        step: &Step<'a>,
        linearization: &Linearization<'a>,
        wanted: Derivatives,
    ) -> Self {
        let of = |columns: Vec<(Vector<'a>, Vector<'a>)>| -> Vec<Expr<'a>> {
            columns
                .into_iter()
                .flat_map(|(next, unknown)| [next, unknown])
                .flat_map(|column| column.0)
                .collect()
        };
        let adjoint = wanted.adjoint.then(|| linearization.adjoint(arena));
        let Matrices { through, columns: [state, control, parameters] } =
            linearization.matrices(arena, wanted);
        let maps: [Option<Vec<Expr<'a>>>; 6] = [
            wanted.tangent.then(|| linearization.next.0.clone()),
            adjoint.as_ref().map(|adjoint| {
                let by = [&adjoint.state, &adjoint.control, &adjoint.parameters];
                by.into_iter().flat_map(Vector::iter).collect()
            }),
            through.map(|columns| columns.into_iter().flat_map(|column| column.0).collect()),
            state.map(of),
            control.map(of),
            parameters.map(of),
        ];
        let mut factoring = Factoring::new(arena, maps.iter().flatten().flatten().copied());
        let mut plan = Plan::new(arena);
        let mut names = Namer::new();
        let mut signed = |map: &Vec<Expr<'a>>| -> Vec<Signed> {
            map.iter().map(|&expr| plan.plan(factoring.of(expr))).collect()
        };
        let outputs: Vec<Vec<Signed>> = maps.iter().flatten().map(&mut signed).collect();
        names.carry_over(arena, &factoring, &plan);
        plan.share_pairs();
        let laid_out = Schedule::new(arena, &plan, names).maps(&outputs);
        let Maps { fields, point, maps: sections, symbols } = laid_out;
        let mut sections = sections.into_iter();
        let [tangent, adjoint_map, through, state, control, parameters] =
            maps.map(|map| map.and_then(|_| sections.next()));
        Self {
            fields,
            point,
            tangent,
            adjoint: adjoint_map,
            through,
            matrices: [state, control, parameters],
            unknown: symbols.of(&step.unknown),
            perturbations: [&linearization.state, &linearization.control, &linearization.parameters]
                .map(|change| symbols.of(change)),
            costate: adjoint.map_or_else(Vec::new, |adjoint| symbols.of(&adjoint.next)),
            h: symbols.of(&Vector(vec![step.h])),
            symbols,
        }
    }
}
