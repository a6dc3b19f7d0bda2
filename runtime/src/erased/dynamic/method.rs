//! What takes a step that is made at run time, and its equation.

use std::boxed::Box;
use std::sync::Arc;
use std::vec::Vec;

use super::kernel::{DynamicKernel, Frame, Handled, OfKernel, of_kernel};
use super::step::{Called, Step, StepFunction};
use crate::erased::equation::{Equation, Program};
use crate::erased::system::At;
use crate::error::StepError;
use crate::flat::Method;
use crate::kernel::{AtState, Equation as _};
use crate::method::{Advanced, Clock, Counted, Failure, Method as _, StepsReport};
use crate::scalar::Mask;
use crate::scalar::simd::frame::Joined;
use crate::scalar::simd::march::{March, Marched};
use crate::solve::{self, step::OneStep};

/// What takes the step with these parameters and this length.
pub(super) fn method<T: Called>(step: &Arc<Step>, parameters: &[T], length: T) -> Box<dyn Method<T>> {
    of_kernel(step, OfMethod { parameters, length })
}

struct OfMethod<'a, T> {
    parameters: &'a [T],
    length: T,
}

impl<T: Called> OfKernel<T> for OfMethod<'_, T> {
    type Made = Box<dyn Method<T>>;

    fn made<const U: usize>(self, step: &Arc<Step>) -> Box<dyn Method<T>> {
        Box::new(DynamicMethod::<T, U>::new(step, self.parameters, self.length))
    }
}

pub(super) struct DynamicMethod<T: Called, const U: usize> {
    pub(super) step: Arc<Step>,
    /// What takes many steps at a time, once it was asked for.
    march: Option<Option<March>>,
    pub(super) joined: Joined<Frame<T>, Step, OneStep<T, DynamicKernel<T, U>>>,
}

impl<T: Called, const U: usize> DynamicMethod<T, U> {
    pub(super) fn new(step: &Arc<Step>, parameters: &[T], length: T) -> Self {
        let frame = Frame::new(step, parameters, length);
        let joined = Joined::new(frame, step, |handle| OneStep::of(DynamicKernel::<T, U>(handle)));
        Self { step: step.clone(), march: None, joined }
    }

    /// Writes where a step starts to the frame.
    pub(super) fn give(&mut self, state: &[T], control: &[T]) {
        let (frame, layout) = (self.joined.frame(), &self.step.layout);
        frame.write(layout.state.clone(), state);
        frame.write(layout.control.clone(), control);
    }

    /// Takes steps by machine code, if there is any, from the state in the frame on, to which the last step has led.
    fn march(&mut self, clock: Clock, most: u64) -> Option<Marched> {
        if !T::has_march(&*self.step.functions) {
            return None;
        }
        let method = self.joined.user();
        let most = most.min(method.ready_for());
        if most == 0 {
            return None;
        }
        let march = self.march.get_or_insert_with(|| T::march(&*self.step.functions, None)).as_ref()?;
        let [marched] =
            method.kernel().0.with(|frame| march.take([method.lent(&mut frame.rows, clock, most)]));
        method.marched(&marched, marched.steps);
        Some(marched)
    }

    /// Takes a step from what is in the frame on, of which machine code may have made a first iteration.
    pub(super) fn rest(&mut self, has_first: bool, time: T, known: bool, next: &mut [T]) -> Counted<T> {
        let Self { step, joined, .. } = self;
        let layout = &step.layout;
        let outcome = if has_first {
            let first = joined.frame().array(layout.out.clone());
            joined.user().advance_farther::<true>(&[], time, &[], known, Some(first))
        } else {
            joined.user().advance(&[], time, &[], known)
        };
        let frame = joined.frame();
        next.iter_mut().zip(frame.read(layout.next.clone())).for_each(|(to, number)| *to = number);
        outcome.map(|advanced| advanced.with(())).map_err(|failure| {
            let advanced = failure.advanced.with(());
            let errors = T::each(|lane| {
                let error = failure.errors.as_ref()[lane]?;
                Some(seen(step, frame, time, lane, error))
            });
            Failure { errors, advanced }
        })
    }
}

impl<T: Called, const U: usize> Method<T> for DynamicMethod<T, U> {
    fn rebuild(&mut self, parameters: &[T], step: T) {
        self.joined.frame().rebuild(&self.step, parameters, step);
    }

    fn advance(&mut self, state: &[T], next: &mut [T], time: T, control: &[T], known: bool) -> Counted<T> {
        self.give(state, control);
        let mut has_first = false;
        if known && let Some(marched) = self.march(Clock::at(time), 1) {
            if marched.steps == 1 {
                let now = self.joined.frame().read(self.step.layout.state.clone());
                next.iter_mut().zip(now).for_each(|(to, number)| *to = number);
                let (mut iterations, residual) = self.joined.user().on_fast_path();
                let more = marched.more.1;
                iterations.as_mut().iter_mut().for_each(|all| *all = all.wrapping_add(more));
                return Ok(Advanced { state: (), iterations, residual });
            }
            has_first = marched.has_first;
        }
        self.rest(has_first, time, known, next)
    }

    fn advance_n(
        &mut self,
        state: &mut [T],
        next: &mut [T],
        clock: Clock,
        control: &[T],
        most: u64,
    ) -> (StepsReport<T>, Option<Failure<T, ()>>) {
        let mut report = StepsReport::default();
        if !T::has_march(&*self.step.functions) {
            return (report, None);
        }
        self.give(state, control);
        while report.steps < most {
            let ahead = Clock { taken: clock.taken + report.steps, ..clock };
            let mut has_first = false;
            if let Some(marched) = self.march(ahead, most - report.steps) {
                let (iterations, residual) = self.joined.user().on_fast_path();
                report.count(marched.steps, &iterations, residual, marched.more);
                report.steps += marched.steps;
                has_first = marched.has_first;
            }
            // in lanes a step that fails counts where it does not: `advance` is asked, which says so
            if report.steps == most || T::LANES > 1 {
                break;
            }
            let time = T::of(clock.after(report.steps));
            let Ok(advanced) = self.rest(has_first, time, true, next) else { break };
            let layout = &self.step.layout;
            self.joined.frame().rows.copy_within(layout.next.clone(), layout.state.start);
            report.steps += 1;
            report.count(1, &advanced.iterations, advanced.residual, (0, 0));
        }
        let now = self.joined.frame().read(self.step.layout.state.clone());
        state.iter_mut().zip(now).for_each(|(to, number)| *to = number);
        (report, None)
    }

    /// The numbers that the typed stepper has: not those that fill up an unknown.
    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        let unknowns = self.step.layout.unknown.len();
        self.joined.user().memory(&mut |piece| {
            // no other piece is as long as an unknown
            let own = if piece.len() == U && U > 2 { unknowns } else { piece.len() };
            visit(&mut piece[..own]);
        });
    }
}

/// The error of a step as it is where the solver sees the state: what is not finite is nothing else.
fn seen<T: Called>(step: &Step, frame: &Frame<T>, time: T, lane: usize, error: StepError) -> StepError {
    let layout = &step.layout;
    let is_finite =
        |range: &core::ops::Range<usize>| frame.read(range.clone()).all(|x| x.is_finite().lane(lane));
    let is_given = is_finite(&layout.state) && is_finite(&layout.control) && time.is_finite().lane(lane);
    let margin = frame.read(layout.margin..layout.margin + 1).all(|margin| T::of(0.0).lt(margin).lane(lane));
    match error {
        _ if !is_given => StepError::NotFinite,
        StepError::OutsideDomain if !step.has_domain || margin => StepError::NotFinite,
        error => error,
    }
}

/// The equation of a step at a state.
pub(super) fn equation(step: &Arc<Step>, parameters: &[f64], at: &At<'_>) -> Box<dyn Equation> {
    of_kernel(step, OfEquation { parameters, at })
}

struct OfEquation<'a> {
    parameters: &'a [f64],
    at: &'a At<'a>,
}

impl OfKernel<f64> for OfEquation<'_> {
    type Made = Box<dyn Equation>;

    fn made<const U: usize>(self, step: &Arc<Step>) -> Box<dyn Equation> {
        let At { step: length, state, time, control } = *self.at;
        let mut frame = Frame::new(step, self.parameters, length);
        frame.write(step.layout.state.clone(), state);
        frame.write(step.layout.control.clone(), control);
        frame.rows[step.layout.time] = time;
        frame.call(step, StepFunction::Begin);
        let joined = Joined::new(frame, step, |handle: Handled<f64>| DynamicKernel::<f64, U>(handle));
        Box::new(DynamicEquation { step: step.clone(), joined: joined.into() })
    }
}

struct DynamicEquation<const U: usize> {
    step: Arc<Step>,
    /// Asked through `&self`, so that one caller has to wait for the other.
    joined: std::sync::Mutex<Joined<Frame<f64>, Step, DynamicKernel<f64, U>>>,
}

impl<const U: usize> DynamicEquation<U> {
    fn with<R>(&self, f: impl FnOnce(&AtState<'_, f64, DynamicKernel<f64, U>>) -> R) -> R {
        let mut joined = self.joined.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        f(&AtState { kernel: joined.user(), state: &[], step: &[] })
    }

    /// As many numbers as there are unknowns.
    fn own(&self, numbers: &[f64; U]) -> Vec<f64> {
        numbers[..self.step.layout.unknown.len()].to_vec()
    }
}

fn padded<const U: usize>(numbers: &[f64]) -> [f64; U] {
    crate::flat::array(numbers)
}

impl<const U: usize> Equation for DynamicEquation<U> {
    fn start(&self) -> Vec<f64> {
        self.own(&self.with(|equation| equation.start()))
    }

    fn blocks(&self) -> &[usize] {
        &self.step.blocks
    }

    fn correction(&self, unknown: &[f64], residual: Option<&[f64]>) -> [Vec<f64>; 2] {
        let (unknown, residual) = (padded(unknown), residual.map(padded));
        let corrected = self.with(|equation| equation.corrected(&unknown, residual.as_ref()));
        [self.own(&corrected.residual), self.own(&corrected.iterate)]
    }

    fn solution(&self) -> Option<Vec<f64>> {
        self.with(solve::cold).ok().map(|unknown| self.own(&unknown))
    }

    fn is_inside(&self, unknown: &[f64]) -> bool {
        let layout = &self.step.layout;
        let mut joined = self.joined.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let frame = joined.frame();
        frame.write(layout.unknown.clone(), &padded::<U>(unknown));
        frame.call(&self.step, StepFunction::Evaluate);
        if self.step.has_domain {
            frame.call(&self.step, StepFunction::Domain);
        }
        !self.step.has_domain || frame.rows[layout.margin] > 0.0
    }

    fn program(&self) -> (Program<'_>, usize) {
        (self.step.program.each_ref().map(Vec::as_slice), self.step.places)
    }
}
