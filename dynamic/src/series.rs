//! The power series of a motion, interpreted.

use std::sync::Arc;

use coadjoint::erased::dynamic::{Given, SeriesFunctions};
use coadjoint_codegen::program::{Input, RecordKind, TaylorProgram, TaylorRole};

use crate::in_one_frame::InOneFrame;

/// The functions of a motion's power series.
pub(crate) struct InterpretedSeries {
    blocks: Vec<usize>,
    controls: Option<usize>,
    rates: Option<usize>,
    events: Vec<usize>,
    functions: InOneFrame<TaylorRole>,
}

impl InterpretedSeries {
    /// Those of a program.
    pub(crate) fn shared(program: &TaylorProgram) -> Arc<dyn SeriesFunctions> {
        let TaylorProgram { blocks, controls, rates, events, module } = program;
        let functions = InOneFrame::new(module, RecordKind::Step);
        let (blocks, events) = (blocks.clone(), events.clone());
        Arc::new(Self { blocks, controls: *controls, rates: *rates, events, functions })
    }

    /// Computes a function, and writes its results.
    fn results<const N: usize>(&self, frame: &mut [f64], role: TaylorRole, to: [&mut [f64]; N]) {
        let places = self.functions.call(frame, role);
        for (to, place) in to.into_iter().zip(places) {
            to.iter_mut().zip(&frame[place.clone()]).for_each(|(to, number)| *to = *number);
        }
    }
}

impl SeriesFunctions for InterpretedSeries {
    fn blocks(&self) -> &[usize] {
        &self.blocks
    }

    fn lanes(&self) -> usize {
        self.functions.length(Input::Sums)
    }

    fn controls(&self) -> Option<usize> {
        self.controls
    }

    fn rates(&self) -> Option<usize> {
        self.rates
    }

    fn events(&self) -> &[usize] {
        &self.events
    }

    fn asks_for_velocity(&self) -> bool {
        self.functions.length(Input::Velocity) > 0
    }

    fn frame(&self) -> Vec<f64> {
        self.functions.frame()
    }

    fn leading(&self, frame: &mut [f64], given: &Given<'_>, to: [&mut [f64]; 3]) {
        let inputs = [
            (Input::Parameters, given.parameters),
            (Input::State, given.state),
            (Input::Time, &[given.time]),
            (Input::Control, given.control),
            (Input::Velocity, given.velocity),
        ];
        inputs.into_iter().for_each(|(input, numbers)| self.functions.give(frame, input, numbers));
        self.results(frame, TaylorRole::Leading, to);
    }

    fn next(
        &self,
        frame: &mut [f64],
        (coefficients, sums, order): (&[f64], &[f64], f64),
        to: [&mut [f64]; 4],
    ) {
        let inputs = [(Input::Coefficients, coefficients), (Input::Sums, sums), (Input::Order, &[order])];
        inputs.into_iter().for_each(|(input, numbers)| self.functions.give(frame, input, numbers));
        self.results(frame, TaylorRole::Next, to);
    }

    fn rate(&self, frame: &mut [f64], end: &[f64], to: &mut [f64]) {
        self.functions.give(frame, Input::End, end);
        self.results(frame, TaylorRole::Rate, [to]);
    }

    fn finish(&self, frame: &mut [f64], end: &[f64]) -> Vec<f64> {
        self.functions.give(frame, Input::End, end);
        let places = self.functions.call(frame, TaylorRole::Finish);
        places.first().map_or_else(Vec::new, |place| frame[place.clone()].to_vec())
    }
}
