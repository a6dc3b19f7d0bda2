//! From expressions to straight-line code: common factors are pulled out, what occurs twice is computed once, and every
//! value in the earliest function that can; values that later functions need again are stored in records.

mod cse;
mod dag;
mod derivative;
mod factor;
mod fixed_point;
mod hoist;
mod latency;
mod names;
mod reassociate;
mod statements;
mod taylor;

pub use derivative::derivative;
pub use taylor::taylor;

use crate::expr::{Arena, Expr, Matrix, Stage, Symbol, Vector};
use crate::method::{Iteration, Step};
use crate::model::System;
use crate::program::{
    Argument, Function, FunctionRole, Input, Module, Record, RecordKind, StepRole, SystemRole, Value, Values,
};
use dag::{Dag, Signed};
use factor::Factoring;
use hoist::{Homes, Outline};
use names::Names;
use statements::Writer;

/// Which symbols stand for the components of what functions are given.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    arrays: Vec<(Input, Vec<Symbol>)>,
}

impl Inputs {
    /// The inputs of a system: parameters, state, time and controls.
    pub fn of(system: &System<'_>) -> Self {
        Self::default()
            .with(Input::Parameters, system.parameter_symbols())
            .with(Input::State, system.state_symbols())
            .with(Input::Time, system.time_symbol())
            .with(Input::Control, system.control_symbols())
    }

    /// These and one more.
    #[must_use]
    pub fn with(mut self, input: Input, symbols: Vec<Symbol>) -> Self {
        self.arrays.push((input, symbols));
        self
    }

    /// Whether it is one of them, or a record, which is computed.
    fn has(&self, input: Input) -> bool {
        matches!(input, Input::Record(_)) || self.arrays.iter().any(|(known, _)| *known == input)
    }

    /// The symbols of one of them.
    pub fn symbols(&self, input: Input) -> &[Symbol] {
        self.arrays.iter().find(|(known, _)| *known == input).map_or(&[], |(_, symbols)| symbols)
    }
}

/// The code of one step: Newton's correction for its equation, the update of the fixed-point iteration if there is one,
/// and all the rest.
pub fn step<'a>(arena: &'a Arena, step: &Step<'a>, inputs: Inputs) -> Module<StepRole> {
    let unknown = step.unknown.symbols();
    let numbered = |name: &str| {
        let symbol = |i: usize| arena.symbol(format!("{name}_{i}"), Stage::Iteration);
        Vector((1..=unknown.len()).map(symbol).collect::<Vec<_>>())
    };
    let (residual, right) = (numbered("residual"), numbered("right"));
    let correction = correction(step, &residual);
    let update = match &step.iteration {
        // less the correction
        Iteration::TrueNewton => Vector(Vec::new()),
        Iteration::FixedPoint if unknown.is_empty() => Vector(Vec::new()),
        Iteration::FixedPoint => fixed_point::update(step, &right),
        Iteration::Chord(matrix) | Iteration::Newton(matrix) => {
            fixed_point::simplified_newton(step, matrix, &right)
        }
    };
    let inputs = inputs
        .with(Input::StepSize, step.h.as_symbol().into_iter().collect())
        .with(Input::Unknown, unknown.clone())
        .with(Input::Residual, residual.symbols())
        .with(Input::Right, right.symbols());

    let domain = Vector(step.domain.clone());
    let slow = match &step.iteration {
        Iteration::Chord(_) => step.slow.clone(),
        Iteration::FixedPoint | Iteration::Newton(_) | Iteration::TrueNewton => Vector(Vec::new()),
    };
    let all = [&step.start, &step.left, &step.right, &correction, &update, &domain, &step.next, &slow];
    let mut code = Code::new(arena, inputs, all.into_iter().flat_map(Vector::iter));
    let [start, left, right, correction, update, domain, next, slow] = all.map(|vector| code.plan(vector));
    code.names.adopt_roles(arena, &code.factoring, &code.dag);
    let residual: Vec<Signed> = left.iter().zip(&right).map(|(&l, &r)| code.dag.difference(l, r)).collect();
    code.dag.eliminate_common_pairs();
    let equation = residual.iter().chain(&right).map(|signed| signed.op).collect();
    let equation = code.dag.reachable_from(equation);
    code.dag.shorten_divisions(&equation);

    let mut functions = vec![
        record(StepRole::New, RecordKind::Constants),
        record(StepRole::Begin, RecordKind::Step),
        returned(StepRole::Start, vec![start]),
        Outline { results: vec![residual, right], ..record(StepRole::Evaluate, RecordKind::Iterate) },
        returned(StepRole::Correction, vec![correction]),
    ];
    functions.extend((!update.is_empty()).then(|| returned(StepRole::FixedPointUpdate, vec![update])));
    functions.extend((!domain.is_empty()).then(|| returned(StepRole::Domain, vec![domain])));
    functions.push(Outline {
        is_apart: step.iteration != Iteration::FixedPoint,
        ..returned(StepRole::Finish, vec![next])
    });
    let slow = slow.iter().map(|signed| signed.op).collect();
    let placement = Homes::of_step(&code.dag, &functions, &step.given, &slow);
    code.module(placement, functions)
}

/// The solution of the linearized equation.
fn correction<'a>(step: &Step<'a>, residual: &Vector<'a>) -> Vector<'a> {
    if step.unknown.is_empty() {
        return residual.clone();
    }
    let n = step.matrix.columns;
    let named =
        |(k, entry): (usize, &Expr<'a>)| entry.hold().named(format!("jacobian_{}{}", k / n + 1, k % n + 1));
    let entries = step.matrix.entries.iter().enumerate().map(named).collect();
    let matrix = Matrix::new(n, n, entries);
    match step.iteration {
        Iteration::FixedPoint | Iteration::TrueNewton => matrix.solve(residual),
        Iteration::Chord(_) | Iteration::Newton(_) => matrix.solve_apart(residual),
    }
}

/// The code of a function that stands alone: of parameters and state, and whatever else is given.
pub fn function<'a>(
    arena: &'a Arena,
    role: SystemRole,
    outputs: &Vector<'a>,
    inputs: Inputs,
) -> Module<SystemRole> {
    let mut code = Code::new(arena, inputs, outputs.iter());
    let outputs = code.plan(outputs);
    code.names.adopt_roles(arena, &code.factoring, &code.dag);
    code.dag.eliminate_common_pairs();
    let mut module = code.module(Homes::alone(), vec![returned(role, vec![outputs])]);
    // the runtime does not know these functions: they are given what they use
    let is_used = |argument: &Argument| argument.values.iter().any(Option::is_some);
    module.functions.iter_mut().for_each(|function| function.arguments.retain(is_used));
    module
}

fn returned<R>(role: R, results: Vec<Vec<Signed>>) -> Outline<R> {
    Outline { role, record: None, is_apart: false, results }
}

fn record<R>(role: R, kind: RecordKind) -> Outline<R> {
    Outline { role, record: Some(kind), is_apart: false, results: Vec::new() }
}

/// A module in the making.
struct Code<'a> {
    arena: &'a Arena,
    inputs: Inputs,
    factoring: Factoring<'a>,
    dag: Dag<'a>,
    names: Names,
}

impl<'a> Code<'a> {
    fn new(arena: &'a Arena, inputs: Inputs, outputs: impl Iterator<Item = Expr<'a>>) -> Self {
        let (factoring, dag) = (Factoring::new(arena, outputs), Dag::new(arena));
        Self { arena, inputs, factoring, dag, names: Names::default() }
    }

    fn plan(&mut self, outputs: &Vector<'a>) -> Vec<Signed> {
        outputs.iter().map(|expr| self.dag.plan(self.factoring.of(expr))).collect()
    }

    /// Writes the functions, whose values stand in these places.
    fn module<R: Results>(mut self, placement: Homes, functions: Vec<Outline<R>>) -> Module<R> {
        self.names.name_symbols(self.arena, &self.dag);
        for function in &functions {
            let named = function.results().zip(self.result_names(function));
            let named: Vec<_> = named.map(|(signed, name)| (signed.op, name)).collect();
            self.names.note_consumers(&self.dag, named);
        }
        placement.stored().for_each(|op| self.names.store(&self.dag, op));
        let kinds = functions.iter().filter_map(|function| function.record);
        let records: Vec<Record> =
            kinds.map(|kind| Record { kind, fields: self.fields(&placement, kind) }).collect();
        let functions = functions.iter().map(|returned| {
            let storing = returned.record.map_or_else(Vec::new, |kind| placement.stored_in(kind));
            let apart = returned.is_apart.then(|| placement.apart());
            let found = apart.as_ref().unwrap_or(&placement);
            let (statements, results) = Writer::body(&self.dag, found, &mut self.names, returned, &storing);
            let inputs = returned.role.signature().inputs.iter().filter(|input| self.inputs.has(**input));
            let arguments = inputs.map(|&input| Argument { input, values: self.components(&records, input) });
            let (arguments, role, record) = (arguments.collect(), returned.role, returned.record);
            let mut function = Function { role, arguments, statements, record, results };
            function.keep_used_arguments(&records);
            function
        });
        let functions = functions.collect();
        Module { values: Values { names: self.names.into_all(), records }, functions }
    }

    /// The fields of a record: symbols first, as they were declared, then the others by their names.
    fn fields(&self, placement: &Homes, kind: RecordKind) -> Vec<Value> {
        let (symbols, others): (Vec<_>, Vec<_>) =
            placement.stored_in(kind).into_iter().partition(|&op| self.dag.operation(op).is_leaf());
        let value = |op| self.names.stored(op);
        let mut symbols: Vec<Value> = symbols.into_iter().filter_map(value).collect();
        // values are numbered by symbols in the order of creation
        symbols.sort();
        let mut others: Vec<Value> = others.into_iter().filter_map(value).collect();
        others.sort_by_cached_key(|&value| self.names.sort_key(value));
        [symbols, others].concat()
    }

    /// The components of an input, where they have values.
    fn components(&self, records: &[Record], input: Input) -> Vec<Option<Value>> {
        match input {
            Input::Record(kind) => {
                let record = records.iter().find(|record| record.kind == kind);
                record.map_or_else(Vec::new, |record| record.fields.iter().copied().map(Some).collect())
            }
            _ => self.inputs.symbols(input).iter().map(|&symbol| self.names.symbol(symbol)).collect(),
        }
    }

    /// What a function's results are called, for the names of what they are computed from.
    fn result_names<R: Results>(&self, function: &Outline<R>) -> Vec<String> {
        let role = function.role;
        let count = function.results().count();
        let named = role.result_names(&|input, suffix| {
            let name = |symbol: &Symbol| format!("{}{suffix}", self.arena.symbol_info(*symbol).name);
            self.inputs.symbols(input).iter().map(name).collect()
        });
        let numbered = |i: usize| if count == 1 { role.name() } else { format!("{}_{}", role.name(), i + 1) };
        if named.len() == count { named } else { (0..count).map(numbered).collect() }
    }
}

/// The names of an input's components, each with this suffix.
type InputNames<'n> = dyn Fn(Input, &str) -> Vec<String> + 'n;

/// Functions whose results have names, for those of what they are computed from.
trait Results: FunctionRole {
    /// The results' names; none where numbers will do.
    fn result_names(self, _names: &InputNames<'_>) -> Vec<String> {
        Vec::new()
    }
}

impl Results for SystemRole {}

impl Results for StepRole {
    fn result_names(self, names: &InputNames<'_>) -> Vec<String> {
        match self {
            Self::Start | Self::FixedPointUpdate => names(Input::Unknown, ""),
            Self::Evaluate => [names(Input::Residual, ""), names(Input::Right, "")].concat(),
            Self::Finish => names(Input::State, "_next"),
            Self::New | Self::Begin | Self::Correction | Self::Domain => Vec::new(),
        }
    }
}
