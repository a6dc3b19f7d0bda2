//! The derivative of one step as straight-line code: what it is made of, then the linear maps themselves.

use super::{Code, Homes, InputNames, Inputs, Outline, Results, record, returned};
use crate::expr::{Arena, Expr, Stage, Vector};
use crate::method::Step;
use crate::method::linearization::{Linearization, Matrices};
use crate::program::{DerivativeRole, Input, Module, RecordKind};
use crate::scheme::Derivatives;

/// The derivative of a step at one point as code: of the linear maps those that are wanted.
///
/// The matrices are `explicit + through · unknown`, column by column, for the product is better made by loops than
/// written out.
pub fn derivative<'a>(
    arena: &'a Arena,
    step: &Step<'a>,
    linearization: &Linearization<'a>,
    wanted: Derivatives,
    inputs: Inputs,
) -> Module<DerivativeRole> {
    let adjoint = wanted.adjoint.then(|| linearization.adjoint(arena));
    let costate = adjoint.as_ref().map_or_else(Vec::new, |adjoint| adjoint.next.symbols());
    let inputs = inputs
        .with(Input::StepSize, step.h.as_symbol().into_iter().collect())
        .with(Input::Unknown, step.unknown.symbols())
        .with(Input::StatePerturbation, linearization.state.symbols())
        .with(Input::ControlPerturbation, linearization.control.symbols())
        .with(Input::ParameterPerturbation, linearization.parameters.symbols())
        .with(Input::Costate, costate);

    let mut maps: Vec<(DerivativeRole, Vec<Vector<'a>>)> = Vec::new();
    maps.extend(wanted.tangent.then(|| (DerivativeRole::Tangent, vec![linearization.next.clone()])));
    maps.extend(
        adjoint.map(|adjoint| {
            (DerivativeRole::Adjoint, vec![adjoint.state, adjoint.control, adjoint.parameters])
        }),
    );
    let Matrices { through, columns } = linearization.matrices(arena, wanted);
    maps.extend(through.map(|columns| (DerivativeRole::Through, columns)));
    let both = |columns: Vec<(Vector<'a>, Vector<'a>)>| {
        columns.into_iter().flat_map(|(explicit, unknown)| [explicit, unknown]).collect()
    };
    let roles = [DerivativeRole::WrtState, DerivativeRole::WrtControl, DerivativeRole::WrtParameters];
    let matrices = roles.into_iter().zip(columns);
    maps.extend(matrices.filter_map(|(role, columns)| Some((role, both(columns?)))));

    let all: Vec<Expr<'a>> = maps.iter().flat_map(|(_, map)| map).flat_map(Vector::iter).collect();
    let mut code = Code::new(arena, inputs, all.into_iter());
    let planned = maps.iter().map(|(role, map)| {
        let results = map.iter().map(|vector| code.plan(vector)).collect();
        returned(*role, results)
    });
    let mut functions: Vec<Outline<DerivativeRole>> = planned.collect();
    code.names.adopt_roles(arena, &code.factoring, &code.dag);
    code.dag.eliminate_common_pairs();
    let placement = Homes::of_maps(&code.dag, &functions, Stage::Perturbation, RecordKind::Point);
    functions.insert(0, record(DerivativeRole::Point, RecordKind::Point));
    code.module(placement, functions)
}

impl Results for DerivativeRole {
    /// `gamma_x_by_momentum_y`
    fn result_names(self, names: &InputNames<'_>) -> Vec<String> {
        let plain = |name: &String| name.strip_prefix("d_").unwrap_or(name).to_owned();
        let names = |input: Input| -> Vec<String> { names(input, "").iter().map(plain).collect() };
        let (state, unknown) = (names(Input::StatePerturbation), names(Input::Unknown));
        let by = |rows: &[String], column: &str| -> Vec<String> {
            rows.iter().map(|row| format!("{row}_by_{column}")).collect()
        };
        let matrix = |columns: Vec<String>| -> Vec<String> {
            columns.iter().flat_map(|column| [by(&state, column), by(&unknown, column)].concat()).collect()
        };
        match self {
            Self::Point => Vec::new(),
            Self::Tangent => state.iter().map(|name| format!("d_{name}_next")).collect(),
            Self::Adjoint => {
                let inputs =
                    [Input::StatePerturbation, Input::ControlPerturbation, Input::ParameterPerturbation];
                inputs.into_iter().flat_map(names).map(|name| format!("by_{name}")).collect()
            }
            Self::Through => unknown.iter().flat_map(|column| by(&state, column)).collect(),
            Self::WrtState => matrix(state.clone()),
            Self::WrtControl => matrix(names(Input::ControlPerturbation)),
            Self::WrtParameters => matrix(names(Input::ParameterPerturbation)),
        }
    }
}
