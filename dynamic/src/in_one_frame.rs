//! The functions of a module, interpreted in one frame.

use std::ops::Range;

use coadjoint_codegen::program::{Function, FunctionRole, Input, Module, RecordKind, Value};

use crate::assembler::{Frame, Places, assembled};
use crate::interpreter::Code;

/// The functions of a module. Each finds in the frame what it is given and what others have handed on, and leaves its results there.
pub(crate) struct InOneFrame<R> {
    /// The frame before anything is computed.
    numbers: Vec<f64>,
    inputs: Vec<(Input, Range<usize>)>,
    functions: Vec<(R, Code, Vec<Range<usize>>)>,
}

struct In<'a> {
    inputs: &'a [(Input, Range<usize>)],
    /// What is handed on.
    record: Option<(&'a [Value], Input)>,
    results: &'a [Range<usize>],
}

impl Places for In<'_> {
    fn input(&self, input: Input) -> usize {
        place(self.inputs, input).start
    }

    fn record(&self) -> (&[Value], usize) {
        self.record.map_or((&[], 0), |(fields, input)| (fields, self.input(input)))
    }

    fn result(&self, array: usize) -> usize {
        self.results[array].start
    }
}

/// The place of an input; an empty one of what no function asks for.
fn place(inputs: &[(Input, Range<usize>)], input: Input) -> Range<usize> {
    inputs.iter().find(|(known, _)| *known == input).map_or(0..0, |(_, range)| range.clone())
}

impl<R: FunctionRole> InOneFrame<R> {
    /// The functions of a module, of which those that return a record return one of this kind.
    pub(crate) fn new(module: &Module<R>, record: RecordKind) -> Self {
        let handed_on = Input::Record(record);
        let fields = module.values.fields(record);
        let mut end = 0;
        let mut take = |length: usize| {
            end += length;
            end - length..end
        };
        let mut inputs = vec![(handed_on, take(fields.len()))];
        for argument in module.functions.iter().flat_map(|function| &function.arguments) {
            if inputs.iter().all(|(known, _)| *known != argument.input) {
                inputs.push((argument.input, take(argument.values.len())));
            }
        }
        let results: Vec<Vec<Range<usize>>> = module
            .functions
            .iter()
            .map(|function| function.results.iter().map(|array| take(array.len())).collect())
            .collect();
        let mut frame = Frame::new(end);
        let code = |(function, results): (&Function<R>, Vec<Range<usize>>)| {
            let record = function.record.map(|_| (fields, handed_on));
            let code = assembled(function, &In { inputs: &inputs, record, results: &results }, &mut frame);
            (function.role, code, results)
        };
        let functions = module.functions.iter().zip(results).map(code).collect();
        Self { numbers: frame.numbers(), inputs, functions }
    }

    /// A frame in which nothing is computed yet.
    pub(crate) fn frame(&self) -> Vec<f64> {
        self.numbers.clone()
    }

    /// How many numbers an input has, if any function asks for it.
    pub(crate) fn length(&self, input: Input) -> usize {
        place(&self.inputs, input).len()
    }

    /// Writes what a function is given; what is missing stays as it is.
    pub(crate) fn give(&self, frame: &mut [f64], input: Input, numbers: &[f64]) {
        frame[place(&self.inputs, input)].iter_mut().zip(numbers).for_each(|(to, number)| *to = *number);
    }

    /// Computes a function. Returns where its results are; nothing if there is no such function.
    pub(crate) fn call(&self, frame: &mut [f64], role: R) -> &[Range<usize>] {
        let Some((_, code, results)) = self.functions.iter().find(|(known, ..)| *known == role) else {
            return &[];
        };
        code.run::<1>(frame.as_chunks_mut().0);
        results
    }
}
