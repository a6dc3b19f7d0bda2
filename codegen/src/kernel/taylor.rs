//! Power series as straight-line code: what is known at the start of a step, then what is computed once an order.

use super::{Code, Homes, InputNames, Inputs, Outline, Results, returned};
use crate::expr::{Arena, Expr, Stage};
use crate::method::taylor::Taylor;
use crate::program::{Input, RecordKind, TaylorProgram, TaylorRole};

/// The code of a system's power series.
pub fn taylor<'a>(arena: &'a Arena, taylor: &Taylor<'a>, inputs: Inputs) -> TaylorProgram {
    let recurrences = &taylor.recurrences;
    let inputs = inputs
        .with(Input::Coefficients, recurrences.coefficients.symbols())
        .with(Input::Sums, recurrences.sums.symbols())
        .with(Input::Order, recurrences.order.as_symbol().into_iter().collect())
        .with(Input::End, taylor.end.symbols());
    let ([first, next], [left, right]) = (&recurrences.change, &recurrences.operands);
    let [event, next_event] = &recurrences.outputs;
    let maps = [
        (TaylorRole::Leading, vec![&taylor.start, first, event]),
        (TaylorRole::Next, vec![next, left, right, next_event]),
        (TaylorRole::Rate, vec![&taylor.rate]),
        (TaylorRole::Finish, vec![&taylor.next]),
    ];
    let all: Vec<Expr<'a>> = maps.iter().flat_map(|(_, map)| map).flat_map(|vector| vector.iter()).collect();
    let mut code = Code::new(arena, inputs, all.into_iter());
    let planned = maps.iter().map(|(role, map)| {
        let results = map.iter().map(|vector| code.plan(vector)).collect();
        returned(*role, results)
    });
    let mut functions: Vec<Outline<TaylorRole>> = planned.collect();
    code.names.adopt_roles(arena, &code.factoring, &code.dag);
    code.dag.eliminate_common_pairs();
    let placement = Homes::of_maps(&code.dag, &functions[1..], Stage::Iteration, RecordKind::Step);
    functions[0].record = Some(RecordKind::Step);
    let (blocks, events) = (taylor.blocks.clone(), taylor.events.clone());
    let Taylor { controls, rates, .. } = *taylor;
    TaylorProgram { blocks, controls, rates, events, module: code.module(placement, functions) }
}

impl Results for TaylorRole {
    fn result_names(self, names: &InputNames<'_>) -> Vec<String> {
        match self {
            Self::Leading => {
                [names(Input::Coefficients, "_start"), names(Input::Coefficients, "_rate")].concat()
            }
            Self::Next => {
                let suffixes = ["_left", "_right"].map(|suffix| names(Input::Sums, suffix));
                [&[names(Input::Coefficients, "_rate")], &suffixes[..]].concat().concat()
            }
            Self::Rate => names(Input::Coefficients, "_there"),
            Self::Finish => names(Input::State, "_next"),
        }
    }
}
