//! What is done within the steps of a run: events that are watched, and states that are shown at times of their own.

use core::ops::ControlFlow;

use super::tracker::Tracker;
use super::{Event, Moment, Occurrence};
use crate::error::StepError;
use crate::interval::Dense;
use crate::observe::Observer;
use crate::system::Dynamics;
use crate::tick::Tick;

/// A function that is called at an event: [`Run::event`](crate::Run::event).
#[doc(hidden)]
pub trait Within<S: Dynamics + ?Sized> {
    /// Whether there is anything to be done.
    const IS_IDLE: bool = false;

    /// How many events are watched.
    fn events(&self) -> usize;
    /// All start from a state that no step led to.
    fn start(&mut self, state: &S::State, time: f64);
    /// Steps of another length begin.
    fn forget(&mut self);
    /// How many points within a step with this end have to be looked at.
    fn wanted(&mut self, state: &S::State, time: f64) -> u32;
    /// Sees a state within the step; or at its end, which was seen already.
    fn see(&mut self, share: f64, state: &S::State, time: f64);
    /// Sees the end.
    fn see_end(&mut self);
    /// Looks for the first zero of each; or for the next one of those that have come.
    ///
    /// # Errors
    /// If there is no state within the step.
    fn seek(
        &mut self,
        dense: &mut dyn Dense<S>,
        state: &mut S::State,
        is_first: bool,
    ) -> Result<(), StepError>;
    /// The first zero that comes, or the last one that comes no later than this.
    fn next(&self, until: Option<f64>) -> Option<f64>;
    /// Calls those that come no later than this, in the order in which they were added, and tells the first one that ends the run. Of this number on.
    fn call(&mut self, until: f64, first: usize, moment: &mut Moment<'_, S>) -> Option<usize>;
    /// The step has ended.
    fn end(&mut self);

    /// The next time that is to be shown, in the direction of the run.
    fn due(&mut self, from: f64, is_forward: bool) -> Option<f64>;
    /// Shows the state at a time that is due.
    fn show(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()>;
}

impl<S: Dynamics + ?Sized> Within<S> for () {
    const IS_IDLE: bool = true;

    fn events(&self) -> usize {
        0
    }
    fn start(&mut self, _: &S::State, _: f64) {}
    fn forget(&mut self) {}
    fn wanted(&mut self, _: &S::State, _: f64) -> u32 {
        0
    }
    fn see(&mut self, _: f64, _: &S::State, _: f64) {}
    fn see_end(&mut self) {}
    fn seek(&mut self, _: &mut dyn Dense<S>, _: &mut S::State, _: bool) -> Result<(), StepError> {
        Ok(())
    }
    fn next(&self, _: Option<f64>) -> Option<f64> {
        None
    }
    fn call(&mut self, _: f64, _: usize, _: &mut Moment<'_, S>) -> Option<usize> {
        None
    }
    fn end(&mut self) {}
    fn due(&mut self, _: f64, _: bool) -> Option<f64> {
        None
    }
    fn show(&mut self, _: &Tick<'_, S>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Of two, the first has come first.
impl<S: Dynamics + ?Sized, A: Within<S>, B: Within<S>> Within<S> for (A, B) {
    const IS_IDLE: bool = A::IS_IDLE && B::IS_IDLE;

    fn events(&self) -> usize {
        self.0.events() + self.1.events()
    }
    fn start(&mut self, state: &S::State, time: f64) {
        self.0.start(state, time);
        self.1.start(state, time);
    }
    fn forget(&mut self) {
        self.0.forget();
        self.1.forget();
    }
    fn wanted(&mut self, state: &S::State, time: f64) -> u32 {
        self.0.wanted(state, time).max(self.1.wanted(state, time))
    }
    fn see(&mut self, share: f64, state: &S::State, time: f64) {
        self.0.see(share, state, time);
        self.1.see(share, state, time);
    }
    fn see_end(&mut self) {
        self.0.see_end();
        self.1.see_end();
    }
    fn seek(
        &mut self,
        dense: &mut dyn Dense<S>,
        state: &mut S::State,
        is_first: bool,
    ) -> Result<(), StepError> {
        self.0.seek(dense, state, is_first)?;
        self.1.seek(dense, state, is_first)
    }
    fn next(&self, until: Option<f64>) -> Option<f64> {
        let both = [self.0.next(until), self.1.next(until)];
        let ordered = |a: f64, b: f64| if (a < b) == until.is_none() { a } else { b };
        both.into_iter().flatten().reduce(ordered)
    }
    fn call(&mut self, until: f64, first: usize, moment: &mut Moment<'_, S>) -> Option<usize> {
        let ends = self.0.call(until, first, moment);
        let other = self.1.call(until, first + self.0.events(), moment);
        ends.or(other)
    }
    fn end(&mut self) {
        self.0.end();
        self.1.end();
    }
    fn due(&mut self, from: f64, is_forward: bool) -> Option<f64> {
        let both = [self.0.due(from, is_forward), self.1.due(from, is_forward)];
        both.into_iter().flatten().reduce(|a, b| if (a < b) == is_forward { a } else { b })
    }
    fn show(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        let first = self.0.show(tick);
        let second = self.1.show(tick);
        if first.is_break() { first } else { second }
    }
}

/// An event that is watched: [`Run::event`](crate::Run::event).
#[doc(hidden)]
pub struct Watched<G, F> {
    tracker: Tracker,
    condition: G,
    action: F,
    /// The value at the end of the step.
    end: f64,
}

impl<G, F> Watched<G, F> {
    pub(crate) fn new(event: Event, condition: G, action: F) -> Self {
        Self { tracker: Tracker::new(event), condition, action, end: f64::NAN }
    }
}

impl<S, G, F> Within<S> for Watched<G, F>
where
    S: Dynamics + ?Sized,
    G: FnMut(&S::State, f64) -> f64,
    F: FnMut(&mut Occurrence<'_, S>),
{
    fn events(&self) -> usize {
        1
    }

    fn start(&mut self, state: &S::State, time: f64) {
        self.tracker.start((self.condition)(state, time));
    }

    fn forget(&mut self) {
        self.tracker.forget();
    }

    fn wanted(&mut self, state: &S::State, time: f64) -> u32 {
        self.end = (self.condition)(state, time);
        self.tracker.wanted(self.end)
    }

    fn see(&mut self, share: f64, state: &S::State, time: f64) {
        self.tracker.see(share, (self.condition)(state, time));
    }

    fn see_end(&mut self) {
        self.tracker.see(1.0, self.end);
    }

    fn seek(
        &mut self,
        dense: &mut dyn Dense<S>,
        state: &mut S::State,
        is_first: bool,
    ) -> Result<(), StepError> {
        if !is_first && self.tracker.next().is_some() {
            return Ok(());
        }
        let tolerance = dense.resolution();
        let mut value = |share: f64| {
            dense.at(share, state)?;
            Ok((self.condition)(state, dense.time(share)))
        };
        if is_first {
            self.tracker.settle(&mut value, tolerance)
        } else {
            self.tracker.seek(&mut value, tolerance)
        }
    }

    fn next(&self, until: Option<f64>) -> Option<f64> {
        let next = self.tracker.next().map(|zero| zero.at);
        next.filter(|next| until.is_none_or(|until| *next <= until))
    }

    fn call(&mut self, until: f64, first: usize, moment: &mut Moment<'_, S>) -> Option<usize> {
        let zero = self.tracker.next().filter(|zero| zero.at <= until)?;
        self.tracker.pass();
        let stops = self.tracker.event().is_terminal;
        let mut occurrence = Occurrence { crossing: zero.crossing, moment, stops };
        (self.action)(&mut occurrence);
        occurrence.stops.then_some(first)
    }

    fn end(&mut self) {
        self.tracker.end();
    }

    fn due(&mut self, _: f64, _: bool) -> Option<f64> {
        None
    }

    fn show(&mut self, _: &Tick<'_, S>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

#[cfg(feature = "std")]
impl<S: Dynamics + ?Sized, X: Within<S>> Within<S> for std::vec::Vec<X> {
    fn events(&self) -> usize {
        self.iter().map(X::events).sum()
    }
    fn start(&mut self, state: &S::State, time: f64) {
        self.iter_mut().for_each(|one| one.start(state, time));
    }
    fn forget(&mut self) {
        self.iter_mut().for_each(X::forget);
    }
    fn wanted(&mut self, state: &S::State, time: f64) -> u32 {
        self.iter_mut().map(|one| one.wanted(state, time)).max().unwrap_or(0)
    }
    fn see(&mut self, share: f64, state: &S::State, time: f64) {
        self.iter_mut().for_each(|one| one.see(share, state, time));
    }
    fn see_end(&mut self) {
        self.iter_mut().for_each(X::see_end);
    }
    fn seek(
        &mut self,
        dense: &mut dyn Dense<S>,
        state: &mut S::State,
        is_first: bool,
    ) -> Result<(), StepError> {
        self.iter_mut().try_for_each(|one| one.seek(dense, state, is_first))
    }
    fn next(&self, until: Option<f64>) -> Option<f64> {
        let all = self.iter().filter_map(|one| one.next(until));
        all.reduce(|a, b| if (a < b) == until.is_none() { a } else { b })
    }
    fn call(&mut self, until: f64, first: usize, moment: &mut Moment<'_, S>) -> Option<usize> {
        let (mut ends, mut number) = (None, first);
        for one in self {
            ends = ends.or(one.call(until, number, moment));
            number += one.events();
        }
        ends
    }
    fn end(&mut self) {
        self.iter_mut().for_each(X::end);
    }
    fn due(&mut self, from: f64, is_forward: bool) -> Option<f64> {
        let all = self.iter_mut().filter_map(|one| one.due(from, is_forward));
        all.reduce(|a, b| if (a < b) == is_forward { a } else { b })
    }
    fn show(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        self.iter_mut().try_for_each(|one| one.show(tick))
    }
}

/// Times at which states are shown to an observer: [`Run::save_at`](crate::Run::save_at).
#[doc(hidden)]
pub struct Samples<I, O> {
    times: I,
    due: Option<f64>,
    /// The time that was shown last.
    shown: Option<f64>,
    observer: O,
}

impl<I: Iterator<Item = f64>, O> Samples<I, O> {
    pub(crate) fn new(mut times: I, observer: O) -> Self {
        let due = times.next();
        Self { times, due, shown: None, observer }
    }
}

impl<S: Dynamics + ?Sized, I: Iterator<Item = f64>, O: Observer<S>> Within<S> for Samples<I, O> {
    fn events(&self) -> usize {
        0
    }
    fn start(&mut self, _: &S::State, _: f64) {}
    fn forget(&mut self) {}
    fn wanted(&mut self, _: &S::State, _: f64) -> u32 {
        0
    }
    fn see(&mut self, _: f64, _: &S::State, _: f64) {}
    fn see_end(&mut self) {}
    fn seek(&mut self, _: &mut dyn Dense<S>, _: &mut S::State, _: bool) -> Result<(), StepError> {
        Ok(())
    }
    fn next(&self, _: Option<f64>) -> Option<f64> {
        None
    }
    fn call(&mut self, _: f64, _: usize, _: &mut Moment<'_, S>) -> Option<usize> {
        None
    }
    fn end(&mut self) {}

    fn due(&mut self, from: f64, is_forward: bool) -> Option<f64> {
        // what lies behind is passed over, and so is what is no time
        let is_ahead = |time: f64| {
            let is_new = self.shown.is_none_or(|shown| if is_forward { time > shown } else { time < shown });
            is_new && if is_forward { time >= from } else { time <= from }
        };
        while self.due.is_some_and(|time| !is_ahead(time)) {
            self.due = self.times.next();
        }
        self.due
    }

    fn show(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        if self.due != Some(tick.time) {
            return ControlFlow::Continue(());
        }
        (self.shown, self.due) = (self.due, self.times.next());
        self.observer.observe(tick)
    }
}
