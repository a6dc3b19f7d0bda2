//! A step that is half a step of a method and then half a step of its adjoint, where machine code takes both at a time.

use std::boxed::Box;
use std::sync::Arc;
use std::vec::Vec;

use super::kernel::{DynamicKernel, OfKernel, have_the_same_room, of_kernel};
use super::method::DynamicMethod;
use super::step::{Called, Step};
use crate::flat::Method;
use crate::method::{Advanced, Clock, Counted, Failure, Method as _, StageAccumulator, StepsReport};
use crate::scalar::simd::march::{March, Marched};
use crate::snapshot::visit_flag;
use crate::solve::step::OneStep;

/// What takes such steps of this length, if there is machine code for it: of two steps, the second of which is in this place among all.
pub(super) fn pair<T: Called>(
    first: &Arc<Step>,
    (second, place): (&Arc<Step>, usize),
    parameters: &[T],
    step: T,
) -> Option<Box<dyn Method<T>>> {
    let steps = [first, second];
    if !steps.iter().all(|step| T::has_march(&*step.functions)) {
        return None;
    }
    if !have_the_same_room(first.layout.unknown.len(), second.layout.unknown.len()) {
        return None;
    }
    of_kernel(first, OfPair { steps, place, parameters, step })
}

struct OfPair<'a, T> {
    steps: [&'a Arc<Step>; 2],
    place: usize,
    parameters: &'a [T],
    step: T,
}

impl<T: Called> OfKernel<T> for OfPair<'_, T> {
    type Made = Option<Box<dyn Method<T>>>;

    fn made<const U: usize>(self, _: &Arc<Step>) -> Self::Made {
        let half = T::of(0.5) * self.step;
        let stages = self.steps.map(|step| DynamicMethod::<T, U>::new(step, self.parameters, half));
        let Self { place, step, .. } = self;
        Some(Box::new(Pair { stages, place, march: None, step, between: Vec::new(), whole: false }))
    }
}

struct Pair<T: Called, const U: usize> {
    stages: [DynamicMethod<T, U>; 2],
    /// Which of the system's steps the second stage is.
    place: usize,
    /// What takes both stages at a time, once it was asked for.
    march: Option<Option<March>>,
    /// The whole step.
    step: T,
    /// The state between the stages.
    between: Vec<T>,
    /// Whether both stages remember solutions of one and the same step.
    whole: bool,
}

impl<T: Called, const U: usize> Pair<T, U> {
    /// Takes steps by machine code, from the state in the first frame on, to which the last step has led.
    fn march(&mut self, clock: Clock, most: u64) -> Option<[Marched; 2]> {
        let [first, second] = &mut self.stages;
        let [one, other]: [&mut OneStep<T, DynamicKernel<T, U>>; 2] =
            [first.joined.user(), second.joined.user()];
        let most = most.min(one.ready_for()).min(other.ready_for());
        if most == 0 {
            return None;
        }
        let of = || T::march(&*first.step.functions, Some(self.place));
        let march = self.march.get_or_insert_with(of).as_ref()?;
        let marched = one.kernel().0.with(|frame| {
            other.kernel().0.with(|other_frame| {
                let frames = [&mut frame.rows, &mut other_frame.rows];
                let [frame, other_frame] = frames;
                march.take([one.lent(frame, clock, most), other.lent(other_frame, clock, most)])
            })
        });
        let [of_first, of_second] = &marched;
        one.marched(of_first, of_first.steps + of_first.halted as u64);
        other.marched(of_second, of_second.steps);
        Some(marched)
    }

    /// Takes a step from the state in the first frame on, or from where machine code left it.
    fn rest(
        &mut self,
        marched: Option<[Marched; 2]>,
        time: T,
        control: &[T],
        known: bool,
        next: &mut [T],
    ) -> Counted<T> {
        let mut accumulator = StageAccumulator::<T>::new();
        let halted = marched.map_or(0, |marched| marched[0].halted);
        let [first, second] = &mut self.stages;
        self.between.resize(next.len(), T::of(0.0));
        if halted == 0 {
            let has_first = marched.is_some_and(|marched| marched[0].has_first);
            accumulator.count(first.rest(has_first, time, known, &mut self.between))?;
        } else {
            let (iterations, residual) = first.joined.user().on_fast_path();
            accumulator.count(Ok(Advanced { state: (), iterations, residual }))?;
            let layout = &second.step.layout;
            let middle = second.joined.frame().read(layout.state.clone());
            self.between.iter_mut().zip(middle).for_each(|(to, number)| *to = number);
        }
        let start = time + T::of(0.5) * self.step;
        let outcome = if halted == 1 {
            let has_first = marched.is_some_and(|marched| marched[1].has_first);
            second.rest(has_first, start, known, next)
        } else {
            second.advance(&self.between, next, start, control, known)
        };
        accumulator.count(outcome)?;
        self.whole = true;
        accumulator.end(())
    }

    /// A step of both stages on the fast path, with so many iterations more than the fewest of each.
    fn on_fast_path(&mut self, more: [u32; 2]) -> Counted<T> {
        let mut accumulator = StageAccumulator::<T>::new();
        for (stage, more) in self.stages.iter_mut().zip(more) {
            let (mut iterations, residual) = stage.joined.user().on_fast_path();
            iterations.as_mut().iter_mut().for_each(|all| *all = all.wrapping_add(more));
            accumulator.count(Ok(Advanced { state: (), iterations, residual }))?;
        }
        accumulator.end(())
    }

    fn give(&mut self, state: &[T], control: &[T]) {
        self.stages.iter_mut().for_each(|stage| stage.give(state, control));
    }
}

impl<T: Called, const U: usize> Method<T> for Pair<T, U> {
    fn rebuild(&mut self, parameters: &[T], step: T) {
        self.step = step;
        self.stages.iter_mut().for_each(|stage| stage.rebuild(parameters, T::of(0.5) * step));
    }

    fn advance(&mut self, state: &[T], next: &mut [T], time: T, control: &[T], known: bool) -> Counted<T> {
        let known = known && self.whole;
        // until both are through
        self.whole = false;
        self.give(state, control);
        let clock = Clock { step: self.step.lane(0), ..Clock::at(time) };
        let marched = if known { self.march(clock, 1) } else { None };
        match marched {
            Some(marched) if marched[0].steps == 1 => {
                self.whole = true;
                let advanced = self.on_fast_path(marched.map(|marched| marched.more.1));
                let [first, _] = &mut self.stages;
                let now = first.joined.frame().read(first.step.layout.state.clone());
                next.iter_mut().zip(now).for_each(|(to, number)| *to = number);
                advanced
            }
            marched => {
                // those of a first stage whose second one needs more
                let more = marched.map_or(0, |marched| marched[0].more.1);
                let mut advanced = self.rest(marched, time, control, known, next)?;
                advanced.iterations.as_mut().iter_mut().for_each(|all| *all = all.wrapping_add(more));
                Ok(advanced)
            }
        }
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
        if !self.whole {
            return (report, None);
        }
        self.give(state, control);
        while report.steps < most {
            let ahead = Clock { taken: clock.taken + report.steps, ..clock };
            let marched = self.march(ahead, most - report.steps);
            if let Some(marched) = &marched
                && let Ok(each) = self.on_fast_path([0; 2])
            {
                let [a, b] = marched.map(|marched| marched.more);
                let more = (a.0.wrapping_add(b.0), a.1.wrapping_add(b.1));
                report.count(marched[0].steps, &each.iterations, each.residual, more);
                report.steps += marched[0].steps;
                if marched[0].steps == 0 {
                    // those of a first stage whose second one needs more
                    report.iterations.as_mut().iter_mut().for_each(|all| *all = all.wrapping_add(more.0));
                }
            }
            let stage = &mut self.stages[0];
            let now = stage.joined.frame().read(stage.step.layout.state.clone());
            state.iter_mut().zip(now).for_each(|(to, number)| *to = number);
            // as of one stage
            if report.steps == most || T::LANES > 1 {
                break;
            }
            self.whole = false;
            let time = T::of(clock.after(report.steps));
            let advanced = match self.rest(marched, time, control, true, next) {
                Ok(advanced) => advanced,
                Err(failure) => return (report, Some(failure)),
            };
            state.copy_from_slice(next);
            self.give(state, control);
            report.steps += 1;
            report.count(1, &advanced.iterations, advanced.residual, (0, 0));
        }
        (report, None)
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        visit_flag(&mut self.whole, visit);
        self.stages.iter_mut().for_each(|stage| stage.memory(visit));
    }
}
