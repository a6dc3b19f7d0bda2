//! What is done within the steps of a run: events that are watched, and states that are shown at times of their own.

use core::ops::ControlFlow;

use super::roots::are_clear;
use super::tracker::Tracker;
use super::{Event, Moment, Occurrence};
use crate::error::StepError;
use crate::interval::Dense;
use crate::observe::Observer;
use crate::system::Dynamics;
use crate::system::series::Coefficients;
use crate::tick::Tick;

/// A function that is called at an event: [`Run::event`](crate::Run::event).
#[doc(hidden)]
pub trait Within<S: Dynamics + ?Sized> {
    /// Whether there is anything to be done.
    const IS_IDLE: bool = false;

    /// How many events are watched.
    fn events(&self) -> usize {
        0
    }
    /// Whether the description has them all, as far as they are to be its own.
    fn is_there(&self) -> bool {
        true
    }
    /// The next step starts from a state that no step led to.
    fn start(&mut self) {}
    /// Steps of another length begin.
    fn forget(&mut self) {}
    /// How many points within a step with this end have to be looked at.
    fn wanted(&mut self, _dense: &mut dyn Dense<S>, _state: &S::State, _time: f64) -> u32 {
        0
    }
    /// Sees a state within the step; or at its end, which was seen already.
    fn see(&mut self, _share: f64, _dense: &mut dyn Dense<S>, _state: &S::State) {}
    /// Sees the end.
    fn see_end(&mut self) {}
    /// Looks for the first zero of each; or for the next one of those that have come.
    ///
    /// # Errors
    /// If there is no state within the step.
    fn seek(
        &mut self,
        _dense: &mut dyn Dense<S>,
        _state: &mut S::State,
        _is_first: bool,
    ) -> Result<(), StepError> {
        Ok(())
    }
    /// The first zero that comes, or the last one that comes no later than this.
    fn next(&self, _until: Option<f64>) -> Option<f64> {
        None
    }
    /// Calls those that come no later than this, in the order in which they were added, and tells the first one that ends the run. Of this number on.
    fn call(&mut self, _until: f64, _first: usize, _moment: &mut Moment<'_, S>) -> Option<usize> {
        None
    }
    /// The step has ended.
    fn end(&mut self) {}

    /// The next time that is to be shown, in the direction of the run.
    fn due(&mut self, _from: f64, _is_forward: bool) -> Option<f64> {
        None
    }
    /// Shows the state at a time that is due.
    fn show(&mut self, _tick: &Tick<'_, S>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<S: Dynamics + ?Sized> Within<S> for () {
    const IS_IDLE: bool = true;
}

/// Of two, the first has come first.
impl<S: Dynamics + ?Sized, A: Within<S>, B: Within<S>> Within<S> for (A, B) {
    const IS_IDLE: bool = A::IS_IDLE && B::IS_IDLE;

    fn events(&self) -> usize {
        self.0.events() + self.1.events()
    }
    fn is_there(&self) -> bool {
        self.0.is_there() && self.1.is_there()
    }
    fn start(&mut self) {
        self.0.start();
        self.1.start();
    }
    fn forget(&mut self) {
        self.0.forget();
        self.1.forget();
    }
    fn wanted(&mut self, dense: &mut dyn Dense<S>, state: &S::State, time: f64) -> u32 {
        self.0.wanted(dense, state, time).max(self.1.wanted(dense, state, time))
    }
    fn see(&mut self, share: f64, dense: &mut dyn Dense<S>, state: &S::State) {
        self.0.see(share, dense, state);
        self.1.see(share, dense, state);
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

/// What is watched: a quantity that is zero at an event.
#[doc(hidden)]
pub trait Condition<S: Dynamics + ?Sized> {
    /// Its value in a state within a step.
    fn value(&mut self, dense: &mut dyn Dense<S>, state: &S::State, time: f64) -> f64;
    /// Writes its power series within a part of the step from a share on, as [`Dense::series`] does.
    fn series(
        &mut self,
        _dense: &mut dyn Dense<S>,
        _from: f64,
        _coefficients: &mut Coefficients,
    ) -> Option<(usize, f64)> {
        None
    }
    /// Whether it may jump where a step ends.
    const JUMPS: bool;
    /// Whether there is one.
    fn is_there(&self) -> bool {
        true
    }
}

impl<S: Dynamics + ?Sized, G: FnMut(&S::State, f64) -> f64> Condition<S> for G {
    fn value(&mut self, _: &mut dyn Dense<S>, state: &S::State, time: f64) -> f64 {
        self(state, time)
    }

    const JUMPS: bool = false;
}

/// An event of the description, by its place, if there is one: [`Run::on`](crate::Run::on).
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Described(pub(crate) Option<usize>);

impl<S: Dynamics + ?Sized> Condition<S> for Described {
    fn value(&mut self, dense: &mut dyn Dense<S>, state: &S::State, time: f64) -> f64 {
        self.0.map_or(f64::NAN, |event| dense.event(event, state, time))
    }

    fn series(
        &mut self,
        dense: &mut dyn Dense<S>,
        from: f64,
        coefficients: &mut Coefficients,
    ) -> Option<(usize, f64)> {
        dense.series(self.0?, from, coefficients)
    }

    // with the controls
    const JUMPS: bool = true;

    fn is_there(&self) -> bool {
        self.0.is_some()
    }
}

/// A step has no more parts, each with a power series.
const MOST_PARTS: u32 = 128;

/// An event that is watched: [`Run::event`](crate::Run::event).
#[doc(hidden)]
pub struct Watched<G, F> {
    tracker: Tracker,
    condition: G,
    action: F,
    /// Whether the step that comes starts from a state that no step led to.
    is_fresh: bool,
    /// The value at the end of the step.
    end: f64,
    /// The series of the condition within a part of the step, if it is known: how many coefficients there are, and where the part ends.
    series: Coefficients,
    known: Option<(usize, f64)>,
}

impl<G, F> Watched<G, F> {
    pub(crate) fn new(event: Event, condition: G, action: F) -> Self {
        let (tracker, series) = (Tracker::new(event), [0.0; 33]);
        Self { tracker, condition, action, is_fresh: true, end: f64::NAN, series, known: None }
    }
}

impl<S, G, F> Within<S> for Watched<G, F>
where
    S: Dynamics + ?Sized,
    G: Condition<S>,
    F: FnMut(&mut Occurrence<'_, S>),
{
    fn events(&self) -> usize {
        1
    }

    fn is_there(&self) -> bool {
        self.condition.is_there()
    }

    fn start(&mut self) {
        self.is_fresh = true;
    }

    fn forget(&mut self) {
        self.tracker.forget();
    }

    fn wanted(&mut self, dense: &mut dyn Dense<S>, state: &S::State, time: f64) -> u32 {
        if self.is_fresh || G::JUMPS {
            let (before, start) = (dense.before().clone(), dense.time(0.0));
            let value = self.condition.value(dense, &before, start);
            match core::mem::take(&mut self.is_fresh) {
                true => self.tracker.start(value),
                false => self.tracker.jump(value),
            }
        }
        self.end = self.condition.value(dense, state, time);
        self.known = self.condition.series(dense, 0.0, &mut self.series);
        if self.known.is_some() { 0 } else { self.tracker.wanted(self.end) }
    }

    fn see(&mut self, share: f64, dense: &mut dyn Dense<S>, state: &S::State) {
        if self.known.is_some() {
            return;
        }
        let time = dense.time(share);
        let value = self.condition.value(dense, state, time);
        self.tracker.see(share, value);
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
        let Self { tracker, condition, series, known, .. } = self;
        let value = |share: f64, state: &mut S::State, dense: &mut dyn Dense<S>, condition: &mut G| {
            dense.at(share, state)?;
            let time = dense.time(share);
            Ok(condition.value(dense, state, time))
        };
        if !is_first {
            return tracker.seek(&mut |share| value(share, state, dense, condition), tolerance);
        }
        let (mut from, mut part) = (0.0, *known);
        for _ in 0..MOST_PARTS {
            let Some((length, mut to)) = part else { break };
            let coefficients = series.get_mut(..length).unwrap_or_default();
            // zeros that lie close together are told by a series that starts near them
            let least = (to - from) / 128.0;
            while to - from > least && !are_clear(coefficients) {
                to = from + 0.5 * (to - from);
                let mut power = 1.0;
                for x in coefficients.iter_mut() {
                    *x *= power;
                    power *= 0.5;
                }
            }
            tracker
                .see_series(coefficients, (from, to), &mut |share| value(share, state, dense, condition))?;
            part = if to < 1.0 {
                condition.series(dense, to, series).filter(|(_, end)| *end > to)
            } else {
                None
            };
            from = to;
        }
        if from > 0.0 && from < 1.0 {
            // the rest is seen as that of a closure
            tracker.see_series(&[], (from, 1.0), &mut |share| value(share, state, dense, condition))?;
        }
        let has_series = from >= 1.0;
        tracker.settle(&mut |share| value(share, state, dense, condition), tolerance, has_series)
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
}

#[cfg(feature = "std")]
impl<S: Dynamics + ?Sized, X: Within<S>> Within<S> for std::vec::Vec<X> {
    fn events(&self) -> usize {
        self.iter().map(X::events).sum()
    }
    fn is_there(&self) -> bool {
        self.iter().all(X::is_there)
    }
    fn start(&mut self) {
        self.iter_mut().for_each(X::start);
    }
    fn forget(&mut self) {
        self.iter_mut().for_each(X::forget);
    }
    fn wanted(&mut self, dense: &mut dyn Dense<S>, state: &S::State, time: f64) -> u32 {
        self.iter_mut().map(|one| one.wanted(dense, state, time)).max().unwrap_or(0)
    }
    fn see(&mut self, share: f64, dense: &mut dyn Dense<S>, state: &S::State) {
        self.iter_mut().for_each(|one| one.see(share, dense, state));
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

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::error::ParameterError;
    use crate::event::{Crossing, SetParameters};
    use crate::tests::{Oscillator, OscillatorControl, OscillatorState};
    use std::vec::Vec;

    /// A motion whose position is a polynomial of the share of the step, and the same polynomial as the series of each event.
    struct Polynomial<'a> {
        coefficients: &'a [f64],
        looks: u32,
        before: OscillatorState,
    }

    impl Polynomial<'_> {
        fn value(&self, share: f64) -> f64 {
            self.coefficients.iter().rev().fold(0.0, |sum, x| sum * share + x)
        }
    }

    impl Dense<Oscillator> for Polynomial<'_> {
        fn time(&self, share: f64) -> f64 {
            7.0 + share
        }
        fn resolution(&self) -> f64 {
            4e-16
        }
        fn at(&mut self, share: f64, state: &mut OscillatorState) -> Result<(), StepError> {
            self.looks += 1;
            *state = OscillatorState::new(self.value(share), 0.0);
            Ok(())
        }
        fn before(&self) -> &OscillatorState {
            &self.before
        }
        fn event(&mut self, _: usize, state: &OscillatorState, _: f64) -> f64 {
            state.position.x
        }
        fn series(&mut self, _: usize, from: f64, coefficients: &mut Coefficients) -> Option<(usize, f64)> {
            // Horner's rule over and over leads to the coefficients there
            let mut moved = self.coefficients.to_vec();
            for done in 0..moved.len() {
                let mut sum = 0.0;
                for x in moved.iter_mut().skip(done).rev() {
                    sum = sum * from + *x;
                    *x = sum;
                }
            }
            let mut power = 1.0;
            for (to, x) in coefficients.iter_mut().zip(moved) {
                *to = x * power;
                power *= 1.0 - from;
            }
            Some((self.coefficients.len(), 1.0))
        }
    }

    struct Nothing(Oscillator);

    impl SetParameters<Oscillator> for Nothing {
        fn system(&self) -> &Oscillator {
            &self.0
        }
        fn set_parameters(&mut self, _: &Oscillator) -> Result<(), ParameterError> {
            Ok(())
        }
    }

    /// What an event finds in one step with this series, and how many states it looks at.
    fn found(event: Event, coefficients: &[f64]) -> (Vec<(f64, Crossing)>, u32) {
        let mut all = Vec::new();
        let action =
            |event: &mut Occurrence<'_, Oscillator>| all.push((event.time() - 7.0, event.crossing()));
        let mut within = Watched::new(event, Described(Some(0)), action);
        let value = |share| Polynomial { coefficients, looks: 0, before: OscillatorState::REST }.value(share);
        let [start, end] = [0.0, 1.0].map(|share| OscillatorState::new(value(share), 0.0));
        let mut dense = Polynomial { coefficients, looks: 0, before: start };
        let mut scratch = start;
        Within::<Oscillator>::start(&mut within);
        assert_eq!(within.wanted(&mut dense, &end, 8.0), 0);
        Within::<Oscillator>::see_end(&mut within);
        within.seek(&mut dense, &mut scratch, true).expect("polynomials have values");
        while let Some(next) = Within::<Oscillator>::next(&within, None) {
            let (mut state, mut control) = (scratch, OscillatorControl::new(0.0));
            let mut moment = Moment {
                time: dense.time(next),
                before: &scratch,
                state: &mut state,
                control: &mut control,
                is_held: true,
                stepper: &mut Nothing(Oscillator { mass: 1.0, stiffness: 1.0, drive: 0.0 }),
                is_changed: false,
                is_control_changed: false,
            };
            within.call(next, 0, &mut moment);
            within.seek(&mut dense, &mut scratch, false).expect("polynomials have values");
        }
        (all, dense.looks)
    }

    #[test]
    fn a_series_tells_all_zeros_of_a_step() {
        use Crossing::{Falling, Rising, Touch};
        // Chebyshev's polynomial of degree 8, from 0 to 1
        let chebyshev = [1.0, -128.0, 2688.0, -21504.0, 84480.0, -180224.0, 212992.0, -131072.0, 32768.0];
        let (all, _) = found(Event::any(), &chebyshev);
        assert_eq!(all.len(), 8, "{all:?}");
        for (k, (share, crossing)) in all.iter().enumerate() {
            let exact = 0.5 - 0.5 * ((2 * k + 1) as f64 * core::f64::consts::PI / 16.0).cos();
            assert!((share - exact).abs() < 1e-12, "{share} for {exact}");
            assert_eq!(*crossing, if k % 2 == 0 { Falling } else { Rising });
        }
        assert_eq!(found(Event::rising(), &chebyshev).0.len(), 4);
        // from zero, a touch, and a zero at the end
        let (all, _) = found(Event::any(), &[0.0, 1.0, -3.0, 2.0]);
        assert_eq!(all, [(0.5, Falling), (1.0, Rising)]);
        let (all, _) = found(Event::any(), &[0.25, -1.0, 1.0]);
        assert_eq!(all, [(0.5, Touch)]);
        assert_eq!(found(Event::falling(), &[0.25, -1.0, 1.0]).0, []);
        // what has no zero takes no look
        assert_eq!(found(Event::any(), &[1.0, 0.5, 0.1]), (Vec::new(), 0));
        assert_eq!(found(Event::any(), &[0.0]).0, []);
    }
}
