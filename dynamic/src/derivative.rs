//! The derivative of a step, interpreted.

use std::ops::Range;

use coadjoint::__private::Scalar;
use coadjoint::erased::Jacobian;
use coadjoint::erased::dynamic::{Solution, StepDerivative};
use coadjoint::nalgebra::DMatrix;
use coadjoint_codegen::program::{
    DerivativeRole, Function, Input, Interface, Module, RecordKind, Term, Value,
};

use crate::assembler::{Frame, Places, assembled};
use crate::interpreter::Code;

/// The functions of a derivative, in one frame.
pub(crate) struct Derivative {
    /// The frame before anything is computed.
    numbers: Vec<f64>,
    inputs: Vec<(Input, Range<usize>)>,
    /// What the matrices are made of.
    point: Code,
    /// The derivative with respect to the unknown.
    through: Matrix,
    /// Those with respect to state, controls and parameters.
    matrices: [Matrix; 3],
}

/// A matrix, column by column.
#[derive(Default)]
struct Matrix {
    code: Code,
    columns: Vec<Column>,
    /// How many columns it has where none was asked for.
    width: usize,
}

/// The numbers of a column: `explicit + through · unknown`.
struct Column {
    explicit: Range<usize>,
    unknown: Option<Range<usize>>,
}

struct InDerivative<'a> {
    inputs: &'a [(Input, Range<usize>)],
    fields: &'a [Value],
    results: &'a [Range<usize>],
}

impl Places for InDerivative<'_> {
    fn input(&self, input: Input) -> usize {
        self.inputs.iter().find(|(known, _)| *known == input).map_or(0, |(_, range)| range.start)
    }

    fn record(&self) -> (&[Value], usize) {
        (self.fields, self.input(POINT))
    }

    fn result(&self, array: usize) -> usize {
        self.results[array].start
    }
}

const POINT: Input = Input::Record(RecordKind::Point);

impl Derivative {
    /// The derivative that a module has.
    pub(crate) fn boxed(module: &Module<DerivativeRole>, interface: &Interface) -> Box<dyn StepDerivative> {
        let point = module.function(DerivativeRole::Point);
        let mut end = 0;
        let mut take = |length: usize| {
            end += length;
            end - length..end
        };
        let arguments = point.into_iter().flat_map(|function| &function.arguments);
        let mut inputs: Vec<_> =
            arguments.map(|argument| (argument.input, take(argument.values.len()))).collect();
        let fields = module.values.fields(RecordKind::Point);
        inputs.push((POINT, take(fields.len())));
        let mut results = |function: &Function<DerivativeRole>| -> Vec<Range<usize>> {
            function.results.iter().map(|array| take(array.len())).collect()
        };
        let widths = [interface.state_perturbation(), interface.control_length(), interface.field_length()];
        let roles = [DerivativeRole::WrtState, DerivativeRole::WrtControl, DerivativeRole::WrtParameters];
        let all = std::iter::once((DerivativeRole::Through, 0)).chain(roles.into_iter().zip(widths));
        let places: Vec<_> = all
            .map(|(role, width)| {
                let function = module.function(role);
                (function, function.map_or_else(Vec::new, &mut results), width)
            })
            .collect();

        let mut frame = Frame::new(end);
        let mut code = |function: Option<&Function<DerivativeRole>>, fields: &[Value], results: &[_]| {
            let places = InDerivative { inputs: &inputs, fields, results };
            function.map_or_else(Code::default, |function| assembled(function, &places, &mut frame))
        };
        let point = code(point, fields, &[]);
        let mut matrices = places.into_iter().map(|(function, results, width)| Matrix {
            code: code(function, &[], &results),
            columns: function.map_or_else(Vec::new, |function| columns(function, &results)),
            width,
        });
        let mut next = || matrices.next().unwrap_or_default();
        let (through, matrices) = (next(), [next(), next(), next()]);
        Box::new(Self { numbers: frame.numbers(), inputs, point, through, matrices })
    }
}

/// Where the columns of a function's matrix are.
fn columns(function: &Function<DerivativeRole>, results: &[Range<usize>]) -> Vec<Column> {
    if function.role == DerivativeRole::Through {
        return results.iter().map(|explicit| Column { explicit: explicit.clone(), unknown: None }).collect();
    }
    let is_zero = |term: &Term| matches!(term, Term::Number(number) if number.is_zero());
    let pairs = results.chunks_exact(2).zip(function.results.chunks_exact(2));
    pairs
        .map(|(places, terms)| Column {
            explicit: places[0].clone(),
            // what is zero by its form adds nothing, not even where the other factor is infinite
            unknown: (!terms[1].iter().all(is_zero)).then(|| places[1].clone()),
        })
        .collect()
}

impl StepDerivative for Derivative {
    fn jacobian(&self, at: &Solution<'_>) -> Jacobian {
        let mut frame = self.numbers.clone();
        for (input, range) in &self.inputs {
            let numbers = match input {
                Input::Parameters => at.parameters,
                Input::StepSize => std::slice::from_ref(&at.step_size),
                Input::State => at.state,
                Input::Time => std::slice::from_ref(&at.time),
                Input::Control => at.control,
                Input::Unknown => at.unknown,
                _ => &[],
            };
            frame[range.clone()].iter_mut().zip(numbers).for_each(|(to, number)| *to = *number);
        }
        self.point.run::<1>(frame.as_chunks_mut().0);
        self.through.code.run::<1>(frame.as_chunks_mut().0);
        let rows = self.matrices[0].width;
        let [state, control, parameters] = self.matrices.each_ref().map(|matrix| {
            matrix.code.run::<1>(frame.as_chunks_mut().0);
            let mut dense = DMatrix::zeros(rows, matrix.width);
            for (column, mut to) in matrix.columns.iter().zip(dense.column_iter_mut()) {
                to.copy_from_slice(&frame[column.explicit.clone()]);
                let Some(unknown) = &column.unknown else { continue };
                for (through, by) in self.through.columns.iter().zip(&frame[unknown.clone()]) {
                    for (to, entry) in to.iter_mut().zip(&frame[through.explicit.clone()]) {
                        *to = Scalar::mul_add(*entry, *by, *to);
                    }
                }
            }
            dense
        });
        Jacobian { state, control, parameters }
    }
}
