//! Taylor steps of systems that are made at run time.

use std::boxed::Box;
use std::sync::Arc;
use std::vec::Vec;

use super::system::{DynamicSystem, Given};
use crate::erased::adaptive::TaylorSteps;
use crate::erased::system::{Geometry as _, System, length};
use crate::error::{ParameterError, StepError};
use crate::scalar::Scalar;
use crate::stepper::{EventSeries, Inputs, StepReport, check_deviation};
use crate::system::adaptive::{LEAST_ORDER, order};
use crate::system::input::{Polynomial, driven, fitted};
use crate::system::length::{Checked, Length, Look, Rule, Terms, defect, noise, perturb, size};
use crate::system::pace::{Pace, Wanted};
use crate::system::series::{Coefficients, MOST_COEFFICIENTS};
use crate::taylor::EXPLICIT;

/// The recurrences of a motion's power series, on a frame that keeps what depends on the start of a step.
pub trait SeriesFunctions: Send + Sync + 'static {
    /// The lengths of the blocks of what has a series that have a unit in common.
    fn blocks(&self) -> &[usize];
    /// How many products of two series there are.
    fn lanes(&self) -> usize;
    /// Where the controls stand among what has a series; none where they have no part in the motion.
    fn controls(&self) -> Option<usize>;
    /// Where the rates stand at which they change, if the velocity depends on them; these are the last numbers of its start.
    fn rates(&self) -> Option<usize>;
    /// The places of the events that have a series among those of the description.
    fn events(&self) -> &[usize];
    /// Whether the start asks for the velocity.
    fn asks_for_velocity(&self) -> bool;
    /// A frame in which nothing is computed yet.
    fn frame(&self) -> Vec<f64>;
    /// The coefficients of order 0: of what has a series, of its changes, and of the events.
    fn leading(&self, frame: &mut [f64], given: &Given<'_>, to: [&mut [f64]; 3]);
    /// The coefficients of an order, from those of what has a series and the sums of products of lower ones: of the changes, of both operands of all
    /// products, and of the events.
    fn next(&self, frame: &mut [f64], given: (&[f64], &[f64], f64), to: [&mut [f64]; 4]);
    /// The changes where what has a series has come to.
    fn rate(&self, frame: &mut [f64], end: &[f64], to: &mut [f64]);
    /// The state where what has a series has come to.
    fn finish(&self, frame: &mut [f64], end: &[f64]) -> Vec<f64>;
}

/// Takes Taylor steps: [`taylor::Adaptive`](crate::taylor::Adaptive) with its arithmetic behind functions.
pub(super) struct DynamicTaylor {
    system: DynamicSystem,
    tolerance: f64,
    pace: Pace,
    series: Series,
    /// The largest that an input has been.
    sizes: Vec<f64>,
}

/// The power series of one step.
#[derive(Clone)]
struct Series {
    functions: Arc<dyn SeriesFunctions>,
    frame: Vec<f64>,
    /// That of a start that is rounded otherwise, and the length of the state there.
    perturbed: Option<(Vec<f64>, usize)>,
    /// Both operands of all products, order by order.
    operands: [Vec<Vec<f64>>; 2],
    coefficients: Vec<Vec<f64>>,
    events: Vec<Vec<f64>>,
    order: usize,
    rule: Rule,
    /// Whether the controls are held.
    is_held: bool,
}

impl Terms for Series {
    type Each<X: Copy + Send + Sync> = [X; 1];

    fn each(value: f64) -> [f64; 1] {
        [value]
    }

    fn last(&self) -> usize {
        self.order
    }

    fn blocks(&self) -> &[usize] {
        self.functions.blocks()
    }

    fn held(&self) -> usize {
        let from = if self.is_held { self.functions.controls() } else { self.functions.rates() };
        from.unwrap_or(usize::MAX)
    }

    fn largest(&self, order: usize, from: usize, length: usize) -> [f64; 1] {
        let larger = |largest: f64, x: &f64| if x.abs() > largest { x.abs() } else { largest };
        [self.coefficients[order][from..from + length].iter().fold(0.0, larger)]
    }

    fn rule(&self) -> Rule {
        self.rule
    }

    fn defect(&mut self, at: &[f64; 1], step: &[f64; 1]) -> [f64; 1] {
        let [end, slope] = self.sum_and_slope(at[0]);
        let mut perturbed = None;
        if let Some((frame, length)) = &mut self.perturbed {
            let (mut end, mut rate) = (end.clone(), end.clone());
            perturb(&mut end, *length + 1);
            self.functions.rate(frame, &end, &mut rate);
            perturbed = Some(rate);
        }
        [self.defect_at(&end, &slope, perturbed.as_deref(), step[0])]
    }
}

impl Series {
    fn new(functions: Arc<dyn SeriesFunctions>, order: usize) -> Self {
        let rows = std::vec![std::vec![0.0; functions.lanes()]; order];
        let coefficients = std::vec![std::vec![0.0; functions.blocks().iter().sum()]; order + 1];
        let events = std::vec![std::vec![0.0; functions.events().len()]; order];
        let (frame, operands) = (functions.frame(), [rows.clone(), rows]);
        let rule = Rule::new(order, f64::EPSILON);
        Self { functions, frame, perturbed: None, operands, coefficients, events, order, rule, is_held: true }
    }

    /// Computes all coefficients of the motion from a state on, with an input in the place of controls that are held.
    fn expand(&mut self, given: &Given<'_>, input: Option<&Polynomial<Vec<f64>>>) {
        (self.is_held, self.perturbed) = (input.is_none(), None);
        let Self { functions, frame, operands: [left, right], coefficients, events, order, .. } = self;
        let places = [functions.controls(), functions.rates()];
        let drive = |coefficients: &mut [f64], order: usize| {
            let Some(input) = input else { return };
            for (place, order, factor) in driven(order, places) {
                let numbers = input.order(order).map_or(&[][..], Vec::as_slice);
                coefficients
                    .iter_mut()
                    .skip(place)
                    .zip(numbers)
                    .for_each(|(to, number)| *to = factor * *number);
            }
        };
        if let ([start, change, ..], [events, ..]) = (&mut coefficients[..], &mut events[..]) {
            functions.leading(frame, given, [start, change, events]);
            drive(change, 1);
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
            let next = &mut next[0];
            let given = (&known[k][..], &sums[..], k as f64);
            functions.next(frame, given, [next, &mut left[k], &mut right[k], &mut events[k]]);
            let share = 1.0 / (k as f64 + 1.0);
            next.iter_mut().for_each(|x| *x *= share);
            drive(next, k + 1);
        }
    }

    /// Writes the series of an event in shares of a step of this length: see [`EventSeries`].
    fn event(&self, event: usize, step: f64, coefficients: &mut Coefficients) -> Option<usize> {
        let place = self.functions.events().iter().position(|known| *known == event)?;
        let mut power = 1.0;
        for (coefficient, events) in coefficients.iter_mut().zip(&self.events) {
            *coefficient = events.get(place)? * power;
            power *= step;
        }
        Some(self.order)
    }

    /// Keeps what a start is that rounding has left elsewhere.
    fn perturb(&mut self, given: Given<'_>) {
        let (mut state, mut time, mut frame) = (given.state.to_vec(), [given.time], self.frame.clone());
        perturb(&mut state, 0);
        perturb(&mut time, given.state.len());
        let given = Given { state: &state, time: time[0], ..given };
        let [mut start, mut change] = [0, 1].map(|order: usize| self.coefficients[order].clone());
        let mut events = std::vec![0.0; self.functions.events().len()];
        self.functions.leading(&mut frame, &given, [&mut start, &mut change, &mut events]);
        self.perturbed = Some((frame, given.state.len()));
    }

    /// What the series come to a time `h` after the start, and their derivatives there.
    fn sum_and_slope(&self, h: f64) -> [Vec<f64>; 2] {
        let mut sum = self.coefficients[self.order].clone();
        let mut slope = std::vec![0.0; sum.len()];
        for coefficients in self.coefficients[..self.order].iter().rev() {
            for ((x, slope), c) in sum.iter_mut().zip(&mut slope).zip(coefficients) {
                *slope = Scalar::mul_add(*slope, h, *x);
                *x = Scalar::mul_add(*x, h, *c);
            }
        }
        [sum, slope]
    }

    /// How far the series miss their equation where they have come to, in a step of this length: see [`defect`].
    fn defect_at(&mut self, end: &[f64], slope: &[f64], perturbed: Option<&[f64]>, step: f64) -> f64 {
        let mut rate = end.to_vec();
        self.functions.rate(&mut self.frame, end, &mut rate);
        let (mut sizes, mut misses) = (self.coefficients[0].clone(), slope.to_vec());
        for ((x, first), end) in sizes.iter_mut().zip(&self.coefficients[1]).zip(end) {
            *x = size(*x, *first, *end, step);
        }
        for (x, rate) in misses.iter_mut().zip(&rate) {
            *x = (*x - *rate).abs();
        }
        if let Some(perturbed) = perturbed {
            for ((x, rate), perturbed) in misses.iter_mut().zip(&rate).zip(perturbed) {
                *x -= noise(*rate, *perturbed);
            }
        }
        defect(self.blocks(), self.functions.controls(), [&sizes, &misses], step, self.rule.allowed)
    }

    /// The state a time `h` after the start.
    fn state(&self, h: f64) -> Vec<f64> {
        let [end, _] = self.sum_and_slope(h);
        self.functions.finish(&mut self.frame.clone(), &end)
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
        let sizes = std::vec![0.0; length(system.description().controls)];
        Ok(Box::new(Self { system: system.clone(), tolerance, pace: Pace::default(), series, sizes }))
    }

    /// The same at another time.
    fn beside(&self, time: f64) -> Self {
        let (system, series, sizes) = (self.system.clone(), self.series.clone(), self.sizes.clone());
        let mut beside = Self { system, series, sizes, ..*self };
        beside.pace.set_time(time);
        beside.pace.end = f64::INFINITY;
        beside
    }

    fn advance(
        &mut self,
        state: &mut [f64],
        input: Inputs<'_, Vec<f64>>,
        wanted: Wanted,
    ) -> Result<f64, StepError> {
        match input {
            Inputs::Held(control) => self.advance_with(state, control, None, wanted),
            Inputs::Driven(input) => {
                let mut ask = |time: f64| {
                    let mut numbers = self.sizes.clone();
                    numbers.fill(0.0);
                    crate::flat::copy(&mut numbers, &input(time));
                    numbers
                };
                let (mut sizes, mut first) = (self.sizes.clone(), 0.0);
                if self.pace.last.is_none() && self.pace.fixed.is_none() {
                    let mut trial = self.beside(self.pace.time());
                    first = trial.advance_with(&mut state.to_vec(), &ask(self.pace.time()), None, wanted)?;
                }
                let accuracy = (self.series.order, self.tolerance);
                let (polynomial, wanted) =
                    fitted((&self.pace, wanted, first), accuracy, &mut sizes, &mut ask);
                self.sizes = sizes;
                let control = polynomial.order(0).cloned().unwrap_or_default();
                self.advance_with(state, &control, Some(&polynomial), wanted)
            }
        }
    }

    fn advance_with(
        &mut self,
        state: &mut [f64],
        control: &[f64],
        input: Option<&Polynomial<Vec<f64>>>,
        wanted: Wanted,
    ) -> Result<f64, StepError> {
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
            let mut start = self.system.velocity(&given);
            if self.series.functions.rates().is_some() {
                let rates = input.and_then(|input| input.order(1)).cloned();
                start.extend(rates.unwrap_or_else(|| std::vec![0.0; control.len()]));
            }
            velocity = start;
            given.velocity = &velocity;
        }
        let before = self.pace.begin();
        self.series.expand(&given, input);
        let [[mut step], [natural]] = self.series.step(&[before], &[wanted.length]);
        let [mut end, slope] = self.series.sum_and_slope(step);
        let missed = self.series.defect_at(&end, &slope, None, step);
        let (look, mut share) = (Look::at(wanted.length, [step, natural], missed), f64::INFINITY);
        if look != Look::No {
            self.series.perturb(given);
            let Checked { steps, shares } = self.series.shorten(&[step], &[look], &[time]);
            ([step], [share]) = (steps, shares);
            [end, _] = self.series.sum_and_slope(step);
        }
        let next = self.series.functions.finish(&mut self.series.frame, &end);
        self.pace.took((step, share), is_finite(&next), wanted.end)?;
        crate::flat::copy(state, &next);
        Ok(step)
    }
}

impl EventSeries<dyn System> for DynamicTaylor {
    fn expand(
        &self,
        event: usize,
        state: &Vec<f64>,
        (start, length): (f64, f64),
        input: Inputs<'_, Vec<f64>>,
        coefficients: &mut Coefficients,
    ) -> Option<(usize, f64)> {
        if self.pace.is_last(start, length) {
            return Some((self.series.event(event, length, coefficients)?, 1.0));
        }
        if !self.series.functions.events().contains(&event) {
            return None;
        }
        let (mut beside, mut state) = (self.beside(start), state.clone());
        let known = match input {
            Inputs::Held(control) => {
                // be it that the state at its end is none: the series tells by itself how far it goes
                let _ = beside.advance_with(&mut state, control, None, Length::Exactly(length).into());
                length
            }
            driven @ Inputs::Driven(_) => {
                // as far as a polynomial is close to it
                beside.pace.last = Some(length);
                beside.advance(&mut state, driven, Length::AtMost(length).into()).ok()?
            }
        };
        Some((beside.series.event(event, known, coefficients)?, known / length))
    }
}

impl TaylorSteps for DynamicTaylor {
    fn carried(&self) -> (&Pace, &[f64]) {
        (&self.pace, &self.sizes)
    }

    fn carried_mut(&mut self) -> (&mut Pace, &mut [f64]) {
        (&mut self.pace, &mut self.sizes)
    }

    fn order(&self) -> usize {
        self.series.order
    }

    fn set_order(&mut self, order: usize) {
        let order = order.clamp(LEAST_ORDER, MOST_COEFFICIENTS);
        self.series = Series::new(self.series.functions.clone(), order);
        self.pace.leave();
    }

    fn step_beside(
        &self,
        state: &mut [f64],
        (start, length): (f64, f64),
        mut input: Inputs<'_, Vec<f64>>,
    ) -> Result<StepReport, StepError> {
        if self.pace.covers(start, length) {
            // within the last step, whose series are there
            crate::flat::copy(state, &self.series.state(length));
            return Ok(EXPLICIT);
        }
        let mut beside = self.beside(start);
        while let Some(wanted) = beside.pace.toward(start + length)? {
            beside.advance(state, input.again(), wanted)?;
        }
        Ok(EXPLICIT)
    }

    fn step_driven(
        &mut self,
        state: &mut [f64],
        input: &mut dyn FnMut(f64) -> Vec<f64>,
    ) -> Result<StepReport, StepError> {
        if let Some(wanted) = self.pace.next()? {
            self.advance(state, Inputs::Driven(input), wanted)?;
        }
        Ok(EXPLICIT)
    }

    fn step_with(&mut self, state: &mut [f64], control: &[f64]) -> Result<f64, StepError> {
        match self.pace.next()? {
            Some(wanted) => self.advance_with(state, control, None, wanted),
            None => Ok(0.0),
        }
    }

    fn at(&self, share: f64) -> Option<Vec<f64>> {
        Some(self.series.state(self.pace.share(share)?))
    }
}
