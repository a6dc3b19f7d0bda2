//! Steps within which there is something to be done: events, and states at times of their own.

use core::ops::ControlFlow;

use super::{ControlLaw, Last, Run};
use crate::error::{ParameterError, StepError};
use crate::event::{Moment, SetParameters, Within};
use crate::interval::{Dense, Part};
use crate::observe::Observer;
use crate::stepper::report::{RunError, RunReport};
use crate::stepper::{StepReport, Stepping};
use crate::system::Dynamics;
use crate::tick::Tick;

/// Moments within a step at which there are events, at most.
const MOST_MOMENTS: u32 = 1_000;

/// A stepper for those who change its parameters alone.
struct Reached<'a, T: ?Sized>(&'a mut T);

impl<S: Dynamics + ?Sized, T: Stepping<System = S> + ?Sized> SetParameters<S> for Reached<'_, T> {
    fn system(&self) -> &S {
        self.0.system()
    }

    fn set_parameters(&mut self, parameters: &S::Parameters) -> Result<(), ParameterError> {
        self.0.set_parameters(parameters)
    }
}

/// A step that was taken, or the last part of one, from where an event has changed something.
struct Piece<X> {
    before: X,
    start: f64,
    length: f64,
}

/// How a step goes on.
enum Next {
    /// It has ended.
    Ended,
    /// The run has.
    Stopped,
}

impl<'a, S: Dynamics + ?Sized, T, O, C, W> Run<'a, T, O, C, W>
where
    T: Stepping<System = S> + ?Sized,
    O: Observer<S>,
    C: ControlLaw<S>,
    W: Within<S>,
{
    /// As [`walk`](Self::walk).
    pub(super) fn walk_within(
        &mut self,
        count: u64,
        after: Option<Last<S>>,
        report: &mut RunReport,
    ) -> Result<Last<S>, RunError> {
        if !self.within.is_there() {
            let cause = StepError::NoEvent { known: self.stepper.system().events() };
            return Err(RunError::new(self.stepper.steps_taken() + 1, self.stepper.time(), *report, cause));
        }
        let first = report.steps;
        let mut is_shown = after.is_some();
        let mut last = after.flatten();
        if is_shown {
            self.within.forget();
        } else {
            self.within.start();
        }
        // as long as there are steps, for what is before them, and what is within
        let mut piece = Piece { before: self.state.clone(), start: 0.0, length: 0.0 };
        let mut scratch = self.state.clone();
        loop {
            if !is_shown {
                let shown = self.show(last.as_ref());
                if shown.is_break() || self.show_here(last.as_ref()).is_break() {
                    report.stopped = true;
                    return Ok(last);
                }
            }
            is_shown = false;
            let taken = report.steps - first;
            if taken >= count || self.stepper.has_ended() {
                return Ok(last);
            }
            let index = self.stepper.steps_taken();
            // a step that is as long as a tolerance allows may be the last one
            let most = if self.stepper.is_adaptive() { 1 } else { count - taken };
            let mut unseen = self.observer.next(index).saturating_sub(index).clamp(1, most);
            while unseen > 0 {
                let together = self.idle_steps(unseen);
                let before = report.steps;
                if together > 1 {
                    last = Some(self.law.advance(self.stepper, self.state, together - 1, report)?);
                    unseen -= report.steps - before;
                    continue;
                }
                piece.before.clone_from(self.state);
                (piece.start, piece.length) = (self.stepper.time(), self.stepper.step_size());
                let (step, mut control) = self.law.advance(self.stepper, self.state, 1, report)?;
                if self.stepper.is_adaptive() {
                    piece.length = self.stepper.step_size();
                }
                let next = self.within_step(&mut piece, &mut scratch, &mut control, step, report);
                last = Some((step, control));
                match next? {
                    Next::Ended => unseen -= 1,
                    Next::Stopped => {
                        report.stopped = true;
                        // all that observe see where it ended
                        let _ = (self.show_here(last.as_ref()), self.show(last.as_ref()));
                        return Ok(last);
                    }
                }
            }
        }
    }

    /// How many of the next steps have nothing to be done in them, and one more.
    fn idle_steps(&mut self, most: u64) -> u64 {
        if self.within.events() > 0 {
            return 1;
        }
        let (now, step) = (self.stepper.time(), self.stepper.step_size());
        match self.within.due(now, step > 0.0) {
            None => most.saturating_add(1),
            // some units of roundoff early
            Some(due) => (((due - now) / step * (1.0 - 1e-12)).max(0.0) as u64).min(most).max(1),
        }
    }

    /// Shows what is due at the time itself.
    fn show_here(&mut self, last: Option<&(StepReport, S::Control)>) -> ControlFlow<()> {
        let (time, is_forward) = (self.stepper.time(), self.stepper.step_size() > 0.0);
        let stepper = &*self.stepper;
        let tick = Tick {
            report: last.map(|(report, _)| *report),
            control: last.map(|(_, control)| control),
            ..Tick::new(stepper.system(), stepper.steps_taken(), time, &*self.state)
        };
        while self.within.due(time, is_forward) == Some(time) {
            self.within.show(&tick)?;
        }
        ControlFlow::Continue(())
    }

    /// Does what is to be done in a step that was taken: the state is that at its end.
    fn within_step(
        &mut self,
        piece: &mut Piece<S::State>,
        scratch: &mut S::State,
        control: &mut S::Control,
        step: StepReport,
        report: &mut RunReport,
    ) -> Result<Next, RunError> {
        let mut moments = 0;
        let index = self.stepper.steps_taken();
        // of what is wrong within, the step is to blame
        let failed = |time: f64, cause| (time, cause);
        let outcome = loop {
            let mut is_first = true;
            let changed = loop {
                if self.within.events() > 0 {
                    let sought = self.seek(piece, scratch, control, is_first);
                    if let Err(cause) = sought {
                        break Err(failed(piece.start, cause));
                    }
                }
                is_first = false;
                let end = self.stepper.time();
                let Some(next) = self.within.next(None) else {
                    break self
                        .show_until(end, piece, scratch, control, step)
                        .map(|flow| (flow, None))
                        .map_err(|cause| failed(piece.start, cause));
                };
                moments += 1;
                // those that cannot be told apart come together
                let resolution = 4.0 * self.part(piece, control).resolution();
                let share = self.within.next(Some(next + resolution)).unwrap_or(next).min(1.0);
                let time = self.part(piece, control).time(share);
                match self.show_until(time, piece, scratch, control, step) {
                    Ok(ControlFlow::Continue(())) => {}
                    Ok(flow) => break Ok((flow, None)),
                    Err(cause) => break Err(failed(piece.start, cause)),
                }
                if moments > MOST_MOMENTS {
                    break Err(failed(piece.start, StepError::TooManyEvents { most: MOST_MOMENTS, time }));
                }
                if let Err(cause) = self.part(piece, control).at(share, scratch) {
                    break Err(failed(piece.start, cause));
                }
                let mut state = scratch.clone();
                let mut here = self.law.at(control, time);
                let mut moment = Moment {
                    time,
                    before: scratch,
                    state: &mut state,
                    control: &mut here,
                    is_held: C::IS_HELD,
                    stepper: &mut Reached(&mut *self.stepper),
                    is_changed: false,
                    is_control_changed: false,
                };
                let ends = self.within.call(share, 0, &mut moment);
                let (is_changed, is_control_changed) = (moment.is_changed, moment.is_control_changed);
                if is_control_changed {
                    control.clone_from(&here);
                    self.law.hold(control);
                }
                if ends.is_some() || is_changed {
                    break Ok((ControlFlow::Continue(()), Some((share, time, state, ends))));
                }
            };
            match changed {
                Err(failed) => break Err(failed),
                Ok((ControlFlow::Break(()), _)) => break Ok(Next::Stopped),
                Ok((_, None)) => {
                    self.within.end();
                    break Ok(Next::Ended);
                }
                Ok((_, Some((share, time, state, ends)))) => {
                    let end = self.stepper.time();
                    if ends.is_some() {
                        *self.state = state;
                        if share < 1.0 {
                            self.stepper.go_on_at(time, index);
                        }
                        report.event = ends;
                        break Ok(Next::Stopped);
                    }
                    self.within.start();
                    let rest = piece.length - share * piece.length;
                    *self.state = state;
                    if share >= 1.0 || time == end || rest == 0.0 {
                        break Ok(Next::Ended);
                    }
                    if self.stepper.is_adaptive() {
                        // a step of its own from here on, as long as the tolerance allows
                        self.stepper.go_on_at(time, index);
                        break Ok(Next::Ended);
                    }
                    piece.before.clone_from(self.state);
                    (piece.start, piece.length) = (time, rest);
                    let input = self.law.input(control);
                    if let Err(cause) = self.stepper.step_beside(self.state, (time, rest), input) {
                        break Err(failed(time, cause));
                    }
                }
            }
        };
        outcome.map_err(|(time, cause)| {
            // where it was before
            self.state.clone_from(&piece.before);
            self.stepper.go_on_at(time, index - 1);
            report.steps -= 1;
            RunError::new(index, time, *report, cause)
        })
    }

    fn part<'p>(&'p mut self, piece: &'p Piece<S::State>, control: &'p S::Control) -> Part<'p, T> {
        Part {
            input: self.law.input(control),
            before: &piece.before,
            after: self.state,
            start: piece.start,
            end: self.stepper.time(),
            length: piece.length,
            stepper: self.stepper,
        }
    }

    /// Looks for events.
    fn seek(
        &mut self,
        piece: &Piece<S::State>,
        scratch: &mut S::State,
        control: &S::Control,
        is_first: bool,
    ) -> Result<(), StepError> {
        let mut dense = Part {
            input: self.law.input(control),
            before: &piece.before,
            after: self.state,
            start: piece.start,
            end: self.stepper.time(),
            length: piece.length,
            stepper: self.stepper,
        };
        if is_first {
            let (after, end) = (dense.after, dense.end);
            let points = self.within.wanted(&mut dense, after, end);
            for k in 1..=points {
                let share = f64::from(k) / f64::from(points + 1);
                dense.at(share, scratch)?;
                self.within.see(share, &mut dense, scratch);
            }
            self.within.see_end();
        }
        self.within.seek(&mut dense, scratch, is_first)
    }

    /// Shows all that is due until a time within the step.
    fn show_until(
        &mut self,
        until: f64,
        piece: &Piece<S::State>,
        scratch: &mut S::State,
        control: &S::Control,
        step: StepReport,
    ) -> Result<ControlFlow<()>, StepError> {
        let (index, is_forward) = (self.stepper.steps_taken() - 1, piece.length > 0.0);
        while let Some(due) = self.within.due(piece.start, is_forward) {
            if due == self.stepper.time() || (due > until) == is_forward && due != until {
                break;
            }
            let mut part = self.part(piece, control);
            let share = part.share(due);
            part.at(share.clamp(0.0, 1.0), scratch)?;
            let control = self.law.at(control, due);
            let tick = Tick {
                report: Some(step),
                control: Some(&control),
                ..Tick::new(self.stepper.system(), index, due, scratch)
            };
            if self.within.show(&tick).is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use crate::composition::Order6;
    use crate::event::{Crossing, Event};
    use crate::observe::Record;
    use crate::retraction::Exponential;
    use crate::run::Run;
    use crate::system::System;
    use crate::tests::{Oscillator, OscillatorControl, OscillatorState};
    use std::vec::Vec;

    /// `q = cos t`, `p = −sin t`.
    const FREE: Oscillator = Oscillator { mass: 1.0, stiffness: 1.0, drive: 0.0 };
    const START: OscillatorState = OscillatorState::new(1.0, 0.0);
    const PI: f64 = core::f64::consts::PI;

    #[test]
    fn zeros_are_located_to_rounding() {
        for step in [0.01, 0.1, 0.3] {
            let mut found = Vec::new();
            let mut state = START;
            let mut stepper = FREE.stepper::<Order6<Exponential>>(step).expect("valid");
            let report = Run::new(&mut stepper, &mut state)
                .event(
                    Event::any(),
                    |state, _| state.position.x,
                    |event| found.push((event.time(), event.crossing())),
                )
                .to(20.0)
                .expect("explicit");
            assert_eq!(found.len(), 6, "{found:?}");
            assert_eq!((report.stopped, report.event), (false, None));
            for (k, (time, crossing)) in found.iter().enumerate() {
                let exact = PI * (k as f64 + 0.5);
                // of the scheme
                let error = 3.0 * step.powi(6);
                assert!((time - exact).abs() < error.max(1e-13), "{time} for {exact}");
                assert_eq!(*crossing, if k % 2 == 0 { Crossing::Falling } else { Crossing::Rising });
            }
            // the motion is as it would be without
            let mut other = START;
            let mut stepper = FREE.stepper::<Order6<Exponential>>(step).expect("valid");
            Run::new(&mut stepper, &mut other).to(20.0).expect("explicit");
            assert_eq!(state, other);
        }
    }

    #[test]
    fn directions_and_terminal_events() {
        for (event, expected) in [(Event::rising(), 1.5), (Event::falling(), 0.5), (Event::any(), 0.5)] {
            let mut state = START;
            let mut stepper = FREE.stepper::<Order6<Exponential>>(0.1).expect("valid");
            let mut ends = Vec::new();
            for k in 0..4 {
                let mut called = 0;
                let mut record = Record::every(1);
                let report = Run::new(&mut stepper, &mut state)
                    .observe(&mut record)
                    .event(event.terminal(), |state, _| state.position.x, |_| called += 1)
                    .to(100.0)
                    .expect("explicit");
                assert_eq!((report.stopped, report.event, called), (true, Some(0), 1), "{k}");
                assert!(state.position.x.abs() < 1e-14, "{state:?}");
                // the last tick is the event
                assert_eq!(record.times().last(), Some(&stepper.time()));
                assert_eq!(record.states().last(), Some(&state));
                assert_eq!(record.states().len() as u64, report.steps + 1);
                ends.push(stepper.time());
            }
            let every = if event == Event::any() { PI } else { 2.0 * PI };
            for (k, end) in ends.iter().enumerate() {
                let exact = PI * expected + k as f64 * every;
                assert!((end - exact).abs() < 1e-7, "{event:?}: {ends:?}");
            }
        }
    }

    #[test]
    fn a_condition_that_starts_at_zero_is_seen_when_it_comes_back() {
        // from zero upwards, and from zero downwards
        for momentum in [1.0, -1.0] {
            let mut found = Vec::new();
            let mut state = OscillatorState::new(0.0, momentum);
            let mut stepper = FREE.stepper::<Order6<Exponential>>(0.1).expect("valid");
            Run::new(&mut stepper, &mut state)
                .event(Event::any(), |state, _| state.position.x, |event| found.push(event.time()))
                .to(10.0)
                .expect("explicit");
            assert_eq!(found.len(), 3, "{found:?}");
            assert!(
                found.iter().zip(1..).all(|(time, k)| (time - PI * f64::from(k)).abs() < 1e-6),
                "{found:?}"
            );
        }
        // there and back within one step
        let mut found = Vec::new();
        let mut state = OscillatorState::new(0.0, 0.05);
        let constant = Oscillator { mass: 1.0, stiffness: 0.0, drive: 0.0 };
        let mut stepper = constant.stepper::<Exponential>(1.0).expect("valid");
        Run::new(&mut stepper, &mut state)
            .with_control(OscillatorControl::new(-1.0))
            .event(Event::falling(), |state, _| state.position.x, |event| found.push(event.time()))
            .steps(3)
            .expect("explicit");
        assert!(found.len() == 1 && (found[0] - 0.1).abs() < 1e-14, "{found:?}");
    }

    #[test]
    fn bounces_keep_the_grid() {
        let ball = Oscillator { mass: 1.0, stiffness: 0.0, drive: 0.0 };
        for event in [Event::falling(), Event::any()] {
            let mut found = Vec::new();
            let mut ticks = Vec::new();
            let mut state = OscillatorState::new(1.25, 0.0);
            let mut stepper = ball.stepper::<Exponential>(0.3).expect("valid");
            Run::new(&mut stepper, &mut state)
                .with_control(OscillatorControl::new(-10.0))
                .each(|tick| ticks.push(tick.time))
                .event(
                    event,
                    |state, _| state.position.x,
                    |bounce| {
                        assert_eq!(bounce.before(), bounce.state());
                        found.push(bounce.time());
                        bounce.state_mut().momentum *= -0.5;
                        assert_eq!(bounce.before().momentum, bounce.state().momentum * -2.0);
                    },
                )
                .steps(4)
                .expect("explicit");
            // in the air for 1, ½, ¼ … s: 4 of them in 1.2 s
            let expected = [0.5, 1.0];
            assert_eq!(found.len(), 2, "{found:?}");
            assert!(
                found.iter().zip(expected).all(|(time, exact)| (time - exact).abs() < 1e-14),
                "{found:?}"
            );
            assert_eq!(ticks, [0.0, 0.3, 0.6, 0.8999999999999999, 1.2]);
            assert_eq!(stepper.time(), 1.2);
        }
        // they come ever closer
        let mut state = OscillatorState::new(1.25, 0.0);
        let mut stepper = ball.stepper::<Exponential>(0.3).expect("valid");
        let mut bounces = 0;
        let outcome = Run::new(&mut stepper, &mut state)
            .with_control(OscillatorControl::new(-10.0))
            .event(
                Event::falling(),
                |state, _| state.position.x,
                |bounce| {
                    bounces += 1;
                    bounce.state_mut().momentum *= -0.5;
                },
            )
            .steps(20);
        std::println!("{bounces} {outcome:?} {state:?} {}", stepper.time());
    }
}
