//! The stepper of any system and scheme, and its runs.

use core::fmt;
use core::ops::ControlFlow;
use std::boxed::Box;
use std::vec::Vec;

use thiserror::Error;

use super::method::Method;
use super::scheme::{NotGenerated, Scheme};
use super::system::{Geometry, System, check_length, length};
use crate::error::{ParameterError, StepError};
use crate::memory::{self, visit_flag};
use crate::method::Clock;
use crate::run::{RunError, RunReport};
use crate::stepper::{StepReport, check_deviation, check_step, is_same};

/// Takes steps of one size through the motion of one system, with one scheme: [`Stepper`](crate::Stepper) with its types erased.
pub struct Stepper<'s> {
    system: &'s dyn Geometry,
    method: Box<dyn Method<f64>>,
    step: f64,
    /// The time before the steps counted by `taken`.
    start: f64,
    /// Steps since `start`.
    taken: u64,
    /// Whether there was a step, and the state that the last one led to.
    has_left: bool,
    left: Vec<f64>,
    /// Where the next step leads to, until it is known to succeed.
    next: Vec<f64>,
}

/// A stepper that cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StepperError {
    /// The parameters, or the step, are not valid.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A step that the scheme is made of was not generated.
    #[error(transparent)]
    NotGenerated(#[from] NotGenerated),
}

impl<'s> Stepper<'s> {
    /// A stepper with the given step; negative steps go back in time.
    ///
    /// # Errors
    /// If the parameters are not valid, the step is zero or not finite, or the scheme's steps were not generated.
    pub fn new(system: &'s dyn System, scheme: &Scheme, step: f64) -> Result<Self, StepperError> {
        system.validate()?;
        check_step(step)?;
        Ok(Self::of(system, scheme.of(system, step)?, step))
    }

    /// The stepper with a method of this step.
    pub(crate) fn of(system: &'s dyn Geometry, method: Box<dyn Method<f64>>, step: f64) -> Self {
        let nothing = Vec::from_iter(core::iter::repeat_n(0.0, length(system.description().state)));
        Self {
            system,
            method,
            step,
            start: 0.0,
            taken: 0,
            has_left: false,
            left: nothing.clone(),
            next: nothing,
        }
    }

    /// The system.
    pub fn system(&self) -> &'s dyn Geometry {
        self.system
    }

    /// The time, at which the next step starts: see [`Stepper::time`](crate::Stepper::time).
    pub fn time(&self) -> f64 {
        self.clock().after(0)
    }

    /// Sets the time: the next step starts at `time`.
    pub fn set_time(&mut self, time: f64) {
        (self.start, self.taken) = (time, 0);
        // at no time in particular the next step is not one like the last
        self.has_left &= time.is_finite();
    }

    /// The steps taken since the start, or since the time was set.
    pub fn steps_taken(&self) -> u64 {
        self.taken
    }

    /// What is carried from one step to the next: see [`Stepper::memory`](crate::Stepper::memory).
    pub fn memory(&mut self) -> Vec<f64> {
        memory::written(self.start, [self.taken, 0], &mut |visit| {
            show(&mut self.has_left, &mut self.left, &mut *self.method, visit);
        })
    }

    /// Takes back what [`memory`](Self::memory) gave, of a stepper for the same system, scheme and step.
    ///
    /// # Errors
    /// If it has not as many numbers as the memory of this stepper.
    pub fn recall(&mut self, memory: &[f64]) -> Result<(), ParameterError> {
        let (start, [taken, before]) = memory::read(memory, &mut |visit| {
            show(&mut self.has_left, &mut self.left, &mut *self.method, visit);
        })?;
        // here all steps are of one size
        (self.start, self.taken) = (start - before as f64 * self.clock().step, taken + before);
        self.has_left &= self.start.is_finite();
        Ok(())
    }

    /// Takes one step: see [`Stepper::step_with`](crate::Stepper::step_with).
    ///
    /// # Errors
    /// As there, or if the state has not as many numbers as the system's; state and time are then as before the call.
    pub fn step(&mut self, state: &mut [f64], control: &[f64]) -> Result<StepReport, StepError> {
        check_length(state, self.left.len())?;
        let known = self.is_left_at(state);
        if !known {
            check_deviation(self.system.deviation(state))?;
        }
        let time = self.time();
        match self.method.advance(state, &mut self.next, time, control, known) {
            Ok((iterations, residual)) => {
                state.copy_from_slice(&self.next);
                self.left.copy_from_slice(&self.next);
                self.has_left = true;
                self.taken += 1;
                // of the only lane
                Ok(StepReport { iterations: iterations.iter().sum(), residual })
            }
            // of the only lane, which has failed
            Err(errors) => Err(errors.into_iter().flatten().next().unwrap_or(StepError::NotFinite)),
        }
    }

    /// Takes `count` steps with `control` held all the time: see [`Stepper::steps_with`](crate::Stepper::steps_with).
    ///
    /// # Errors
    /// If a step cannot be taken; state and time are then the last ones that were reached.
    pub fn steps(&mut self, state: &mut [f64], control: &[f64], count: u64) -> Result<RunReport, RunError> {
        let mut report = RunReport::default();
        while report.steps < count {
            if self.is_left_at(state) {
                let most = count - report.steps;
                let marched = self.method.march(state, self.clock(), control, most);
                self.left.copy_from_slice(state);
                self.taken += marched.steps;
                report.add(&RunReport {
                    steps: marched.steps,
                    stopped: false,
                    // of the only lane
                    iterations: marched.iterations.iter().sum(),
                    max_iterations: marched.max_iterations.iter().sum(),
                    max_residual: marched.max_residual,
                });
                if report.steps == count {
                    break;
                }
            }
            match self.step(state, control) {
                Ok(step) => report.count(&step),
                Err(source) => {
                    return Err(RunError { step: self.taken + 1, time: self.time(), report, cause: source });
                }
            }
        }
        Ok(report)
    }

    fn clock(&self) -> Clock {
        Clock { start: self.start, step: self.step, taken: self.taken }
    }

    fn is_left_at(&self, state: &[f64]) -> bool {
        self.has_left && state.len() == self.left.len() && is_same(&self.left, state)
    }
}

/// Shows all numbers that are carried, besides the time: in the order in which the typed stepper does.
fn show(
    has_left: &mut bool,
    left: &mut [f64],
    method: &mut dyn Method<f64>,
    visit: &mut dyn FnMut(&mut [f64]),
) {
    visit_flag(has_left, visit);
    visit(left);
    method.memory(visit);
}

impl fmt::Debug for Stepper<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stepper")
            .field("system", &self.system.description().name)
            .field("step", &self.step)
            .field("time", &self.time())
            .finish_non_exhaustive()
    }
}

/// One moment of a run: the initial state, or the state after a step.
pub struct Sample<'a> {
    /// Steps taken so far.
    pub index: u64,
    /// The time.
    pub time: f64,
    /// The state.
    pub state: &'a [f64],
    /// The energy.
    pub energy: f64,
    /// The Casimirs.
    pub casimirs: &'a [f64],
    memory: core::cell::RefCell<&'a mut dyn FnMut() -> Vec<f64>>,
}

impl Sample<'_> {
    /// What the stepper carries at this moment: see [`Stepper::memory`].
    pub fn memory(&self) -> Vec<f64> {
        (self.memory.borrow_mut())()
    }
}

impl fmt::Debug for Sample<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { index, time, state, .. } = self;
        f.debug_struct("Sample")
            .field("index", index)
            .field("time", time)
            .field("state", state)
            .finish_non_exhaustive()
    }
}

/// Chooses the control to be held over the step from a state at a time.
pub type Control<'a> = dyn Fn(&[f64], f64) -> Vec<f64> + 'a;

/// What a run is besides its stepper and its state.
pub struct Watched<'a> {
    /// How many steps to take.
    pub steps: u64,
    /// The control to be held over the step that starts from a state at a time; none where there are no controls: steps that nobody has to see
    /// are then taken together.
    pub control: Option<&'a Control<'a>>,
    /// The index of the next sample after an index that somebody has to see.
    pub next: &'a dyn Fn(u64) -> u64,
}

/// Goes on from where the stepper is, and shows the state it starts from, every sample that has to be seen, and the last. The report tells of
/// the new steps only.
///
/// # Errors
/// If a step cannot be taken; state and stepper's time are then the last ones that were reached.
pub fn run(
    stepper: &mut Stepper<'_>,
    state: &mut [f64],
    run: &Watched<'_>,
    watch: &mut dyn FnMut(&Sample<'_>) -> ControlFlow<()>,
) -> Result<RunReport, RunError> {
    let mut report = RunReport::default();
    loop {
        let (index, time) = (stepper.taken, stepper.time());
        let system = stepper.system;
        let mut memory = || stepper.memory();
        report.stopped = watch(&Sample {
            index,
            time,
            energy: system.energy(state, time),
            casimirs: &system.casimirs(state),
            state,
            memory: core::cell::RefCell::new(&mut memory),
        })
        .is_break();
        if report.stopped || report.steps >= run.steps {
            return Ok(report);
        }
        let until_seen = (run.next)(index).saturating_sub(index).clamp(1, run.steps - report.steps);
        let mut left = until_seen;
        while left > 0 {
            let (control, count) = match run.control {
                Some(control) => (control(state, stepper.time()), 1),
                None => (Vec::new(), left),
            };
            match stepper.steps(state, &control, count) {
                Ok(steps) => report.add(&steps),
                Err(error) => {
                    report.add(&error.report);
                    return Err(RunError { report, ..error });
                }
            }
            left -= count;
        }
    }
}
