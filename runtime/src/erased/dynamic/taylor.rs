//! Taylor steps of systems that are made at run time.

use std::boxed::Box;
use std::sync::Arc;
use std::vec::Vec;

use super::system::{DynamicSystem, Given};
use crate::erased::adaptive::TaylorSteps;
use crate::erased::system::Geometry as _;
use crate::error::{ParameterError, StepError};
use crate::scalar::Scalar;
use crate::stepper::{StepReport, check_deviation};
use crate::system::adaptive::order;
use crate::system::series::Terms;
use crate::taylor::{EXPLICIT, Pace, Wanted};

/// The recurrences of a motion's power series, on a frame that keeps what depends on the start of a step.
pub trait SeriesFunctions: Send + Sync + 'static {
    /// The lengths of the blocks of what has a series that have a unit in common.
    fn blocks(&self) -> &[usize];
    /// How many products of two series there are.
    fn lanes(&self) -> usize;
    /// Whether the start asks for the velocity.
    fn asks_for_velocity(&self) -> bool;
    /// A frame in which nothing is computed yet.
    fn frame(&self) -> Vec<f64>;
    /// The coefficients of order 0: of what has a series, and of its changes.
    fn leading(&self, frame: &mut [f64], given: &Given<'_>, start: &mut [f64], change: &mut [f64]);
    /// The coefficients of an order, from those of what has a series and the sums of products of lower ones: of the changes, and of both operands
    /// of all products.
    fn next(
        &self,
        frame: &mut [f64],
        given: (&[f64], &[f64], f64),
        change: &mut [f64],
        operands: [&mut [f64]; 2],
    );
    /// The state where what has a series has come to.
    fn finish(&self, frame: &mut [f64], end: &[f64]) -> Vec<f64>;
}

/// Takes Taylor steps: [`taylor::Adaptive`](crate::taylor::Adaptive) with its arithmetic behind functions.
pub(super) struct DynamicTaylor {
    system: DynamicSystem,
    pace: Pace,
    series: Series,
}

/// The power series of one step.
#[derive(Clone)]
struct Series {
    functions: Arc<dyn SeriesFunctions>,
    frame: Vec<f64>,
    /// Both operands of all products, order by order.
    operands: [Vec<Vec<f64>>; 2],
    coefficients: Vec<Vec<f64>>,
    order: usize,
}

impl Terms for Series {
    fn last(&self) -> usize {
        self.order
    }

    fn blocks(&self) -> &[usize] {
        self.functions.blocks()
    }

    fn largest(&self, order: usize, from: usize, length: usize) -> f64 {
        let larger = |largest: f64, x: &f64| if x.abs() > largest { x.abs() } else { largest };
        self.coefficients[order][from..from + length].iter().fold(0.0, larger)
    }
}

impl Series {
    fn new(functions: Arc<dyn SeriesFunctions>, order: usize) -> Self {
        let rows = std::vec![std::vec![0.0; functions.lanes()]; order];
        let coefficients = std::vec![std::vec![0.0; functions.blocks().iter().sum()]; order + 1];
        let (frame, operands) = (functions.frame(), [rows.clone(), rows]);
        Self { functions, frame, operands, coefficients, order }
    }

    /// Computes all coefficients of the motion from a state on.
    fn expand(&mut self, given: &Given<'_>) {
        let Self { functions, frame, operands: [left, right], coefficients, order } = self;
        if let [start, change, ..] = &mut coefficients[..] {
            functions.leading(frame, given, start, change);
        }
        let mut sums = std::vec![0.0; functions.lanes()];
        for k in 1..*order {
            sums.fill(0.0);
            for (a, b) in left[1..k].iter().zip(right[1..k].iter().rev()) {
                for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
                    *sum = Scalar::mul_add(*a, *b, *sum);
                }
            }
            let (known, next) = coefficients.split_at_mut(k + 1);
            let given = (&known[k][..], &sums[..], k as f64);
            functions.next(frame, given, &mut next[0], [&mut left[k], &mut right[k]]);
            let share = 1.0 / (k as f64 + 1.0);
            next[0].iter_mut().for_each(|x| *x *= share);
        }
    }

    /// The state a time `h` after the start.
    fn state(&self, h: f64) -> Vec<f64> {
        let mut sum = self.coefficients[self.order].clone();
        for coefficients in self.coefficients[..self.order].iter().rev() {
            for (x, c) in sum.iter_mut().zip(coefficients) {
                *x = Scalar::mul_add(*x, h, *c);
            }
        }
        self.functions.finish(&mut self.frame.clone(), &sum)
    }
}

impl DynamicTaylor {
    /// What takes the steps of a system to a tolerance.
    pub(super) fn boxed(
        system: &DynamicSystem,
        functions: Arc<dyn SeriesFunctions>,
        tolerance: f64,
    ) -> Result<Box<dyn TaylorSteps>, ParameterError> {
        system.validate()?;
        let series = Series::new(functions, order(tolerance, f64::EPSILON)?);
        Ok(Box::new(Self { system: system.clone(), pace: Pace::default(), series }))
    }

    fn advance(&mut self, state: &mut [f64], control: &[f64], wanted: Wanted) -> Result<f64, StepError> {
        check_deviation(self.system.deviation(state))?;
        let time = self.pace.time();
        let is_finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
        if !is_finite(state) || !is_finite(control) || !time.is_finite() {
            return Err(StepError::NotFinite);
        }
        let parameters = &self.system.parameters();
        let mut given = Given { parameters, state, time, control, ..Given::default() };
        let velocity;
        if self.series.functions.asks_for_velocity() {
            velocity = self.system.velocity(&given);
            given.velocity = &velocity;
        }
        let before = self.pace.begin();
        self.series.expand(&given);
        let step = self.series.step(before, wanted.length);
        let next = self.series.state(step);
        self.pace.took(step, is_finite(&next), wanted.end)?;
        crate::flat::copy(state, &next);
        Ok(step)
    }
}

impl TaylorSteps for DynamicTaylor {
    fn time(&self) -> f64 {
        self.pace.time()
    }

    fn set_time(&mut self, time: f64) {
        self.pace.set_time(time);
    }

    fn steps_taken(&self) -> u64 {
        self.pace.taken
    }

    fn order(&self) -> usize {
        self.series.order
    }

    fn step_size(&self) -> f64 {
        self.pace.step_size()
    }

    fn is_adaptive(&self) -> bool {
        self.pace.fixed.is_none()
    }

    fn set_step_size(&mut self, step: f64) -> Result<(), ParameterError> {
        self.pace.set_step_size(step)
    }

    fn set_end(&mut self, time: f64) {
        self.pace.end = time;
    }

    fn has_ended(&self) -> bool {
        self.pace.has_ended()
    }

    fn go_on_at(&mut self, time: f64, steps: u64) {
        self.pace.set_time(time);
        self.pace.taken = steps;
    }

    fn step_beside(
        &self,
        state: &mut [f64],
        (start, length): (f64, f64),
        control: &[f64],
    ) -> Result<StepReport, StepError> {
        if self.pace.covers(start, length) {
            // within the last step, whose series are there
            crate::flat::copy(state, &self.series.state(length));
            return Ok(EXPLICIT);
        }
        let mut beside = Self { system: self.system.clone(), pace: self.pace, series: self.series.clone() };
        beside.pace.set_time(start);
        while let Some(wanted) = beside.pace.toward(start + length)? {
            beside.advance(state, control, wanted)?;
        }
        Ok(EXPLICIT)
    }

    fn snapshot(&self) -> Vec<f64> {
        self.pace.snapshot().to_vec()
    }

    fn restore(&mut self, memory: &[f64]) -> Result<(), ParameterError> {
        self.pace.restore(memory)
    }

    fn step_with(&mut self, state: &mut [f64], control: &[f64]) -> Result<f64, StepError> {
        match self.pace.next()? {
            Some(wanted) => self.advance(state, control, wanted),
            None => Ok(0.0),
        }
    }

    fn at(&self, share: f64) -> Option<Vec<f64>> {
        Some(self.series.state(self.pace.share(share)?))
    }
}
