//! The stepper of any system and scheme, and its runs.

use core::fmt;
use core::ops::ControlFlow;
use std::boxed::Box;
use std::vec::Vec;

use thiserror::Error;

use super::scheme::Scheme;
use super::system::{System, check_length, length};
use crate::error::{ParameterError, StepError};
use crate::flat::{Method, NotGenerated, of_only_lane};
use crate::method::{Clock, Counted};
use crate::snapshot::{self, visit_flag};
use crate::stepper::report::{RunError, RunReport};
use crate::stepper::{StepReport, check_deviation, check_step};

/// Takes steps of one size through the motion of one system, with one scheme: [`Stepper`](crate::Stepper) with its types erased.
pub struct Stepper<'s> {
    system: &'s dyn System,
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
        let method = scheme.of(system, step)?;
        Ok(Self::assembled(system, method, step))
    }

    /// A stepper that takes its steps by this method, which is of the same system and step.
    ///
    /// # Errors
    /// If the parameters are not valid, or the step is zero or not finite.
    #[doc(hidden)]
    pub fn with_method(
        system: &'s dyn System,
        method: Box<dyn Method<f64>>,
        step: f64,
    ) -> Result<Self, ParameterError> {
        system.validate()?;
        check_step(step)?;
        Ok(Self::assembled(system, method, step))
    }

    fn assembled(system: &'s dyn System, method: Box<dyn Method<f64>>, step: f64) -> Self {
        let nothing = std::vec![0.0; length(system.description().state)];
        let (left, next) = (nothing.clone(), nothing);
        Self { system, method, step, start: 0.0, taken: 0, has_left: false, left, next }
    }

    /// The system.
    pub fn system(&self) -> &'s dyn System {
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

    /// What is carried from one step to the next: see [`Stepper::snapshot`](crate::Stepper::snapshot).
    pub fn snapshot(&mut self) -> Vec<f64> {
        snapshot::written(self.start, [self.taken, 0], &mut |visit| {
            show(&mut self.has_left, &mut self.left, &mut *self.method, visit);
        })
    }

    /// Takes back what [`snapshot`](Self::snapshot) gave, of a stepper for the same system, scheme and step.
    ///
    /// # Errors
    /// If it has not as many numbers as the memory of this stepper.
    pub fn restore(&mut self, memory: &[f64]) -> Result<(), ParameterError> {
        let (start, [taken, before]) = snapshot::read(memory, &mut |visit| {
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
        let report = if self.is_left_at(state) {
            self.follow(control)?
        } else {
            self.check(state)?;
            self.start(state, control)?
        };
        state.copy_from_slice(&self.left);
        Ok(report)
    }

    /// Whether steps can start from a state from elsewhere.
    fn check(&self, state: &[f64]) -> Result<(), StepError> {
        check_length(state, self.left.len())?;
        check_deviation(self.system.deviation(state))
    }

    /// Takes a step from a state from elsewhere.
    fn start(&mut self, state: &[f64], control: &[f64]) -> Result<StepReport, StepError> {
        let time = self.time();
        let outcome = self.method.advance(state, &mut self.next, time, control, false);
        self.arrive(outcome)
    }

    /// Takes a step from where the last one led to.
    #[inline]
    fn follow(&mut self, control: &[f64]) -> Result<StepReport, StepError> {
        let time = self.time();
        let outcome = self.method.advance(&self.left, &mut self.next, time, control, true);
        self.arrive(outcome)
    }

    #[inline]
    fn arrive(&mut self, outcome: Counted<f64>) -> Result<StepReport, StepError> {
        let (iterations, residual) = outcome.map_err(of_only_lane)?;
        core::mem::swap(&mut self.left, &mut self.next);
        self.has_left = true;
        self.taken += 1;
        // of the only lane
        Ok(StepReport { iterations: iterations.iter().sum(), residual })
    }

    /// Takes `count` steps with `control` held all the time: see [`Stepper::steps_with`](crate::Stepper::steps_with).
    ///
    /// # Errors
    /// If a step cannot be taken; state and time are then the last ones that were reached.
    pub fn steps(&mut self, state: &mut [f64], control: &[f64], count: u64) -> Result<RunReport, RunError> {
        self.go(state, &mut Acting::Held(control), count)
    }

    /// Takes `count` steps. What would happen once a step for the caller's sake, happens once: until the last one, states are where the stepper
    /// has them.
    fn go(&mut self, state: &mut [f64], acting: &mut Acting<'_>, count: u64) -> Result<RunReport, RunError> {
        let mut report = RunReport::default();
        let mut known = self.is_left_at(state);
        // not every method takes steps together
        let mut batches = true;
        let outcome = loop {
            if report.steps == count {
                break Ok(());
            }
            if known
                && batches
                && let Acting::Held(control) = acting
            {
                let clock = self.clock();
                let advanced = self.method.advance_n(&mut self.left, clock, control, count - report.steps);
                batches = advanced.steps > 0;
                self.taken += advanced.steps;
                report.add(&RunReport {
                    steps: advanced.steps,
                    stopped: false,
                    // of the only lane
                    iterations: advanced.iterations.iter().sum(),
                    max_iterations: advanced.max_iterations.iter().sum(),
                    max_residual: advanced.max_residual,
                });
                if report.steps == count {
                    break Ok(());
                }
            }
            if !known && let Err(source) = self.check(state) {
                break Err(source);
            }
            let now = if known { &self.left[..] } else { &*state };
            let control = acting.control(now, self.clock().after(0));
            let step = if known { self.follow(control) } else { self.start(state, control) };
            match step {
                Ok(step) => report.count(&step),
                Err(source) => break Err(source),
            }
            known = true;
        };
        // else it is where it was
        if report.steps > 0 {
            state.copy_from_slice(&self.left);
        }
        match outcome {
            Ok(()) => Ok(report),
            Err(cause) => Err(RunError { step: self.taken + 1, time: self.time(), report, cause }),
        }
    }

    fn clock(&self) -> Clock {
        Clock { start: self.start, step: self.step, taken: self.taken }
    }

    fn is_left_at(&self, state: &[f64]) -> bool {
        let differences = self.left.iter().zip(state).map(|(a, b)| a.to_bits() ^ b.to_bits());
        self.has_left && state.len() == self.left.len() && differences.fold(0, |all, bits| all | bits) == 0
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

/// One sample of a run: the initial state, or the state after a step.
pub struct Sample<'a> {
    /// Steps taken so far.
    pub index: u64,
    /// The time.
    pub time: f64,
    /// The state.
    pub state: &'a [f64],
    /// The energy, with the controls of the step that starts here.
    pub energy: f64,
    /// The Casimirs.
    pub casimirs: &'a [f64],
    memory: core::cell::RefCell<&'a mut dyn FnMut() -> Vec<f64>>,
}

impl<'a> Sample<'a> {
    /// A moment of a motion; what carries it on gives its numbers by the function.
    pub fn new(
        (index, time): (u64, f64),
        state: &'a [f64],
        energy: f64,
        casimirs: &'a [f64],
        memory: &'a mut dyn FnMut() -> Vec<f64>,
    ) -> Self {
        Self { index, time, state, energy, casimirs, memory: core::cell::RefCell::new(memory) }
    }

    /// What the stepper carries here: see [`Stepper::snapshot`].
    pub fn snapshot(&self) -> Vec<f64> {
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

/// Writes the control to be held over the step from a state at a time to numbers that are zero.
pub type Law<'a> = dyn Fn(&[f64], f64, &mut [f64]) + 'a;

/// What acts on the system from outside.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub enum Controls<'a> {
    /// Always the same; what is missing is zero. Steps that no observer needs are taken together.
    Held(&'a [f64]),
    /// Chosen anew before each step.
    Chosen(&'a Law<'a>),
}

impl fmt::Debug for Controls<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Held(control) => f.debug_tuple("Held").field(control).finish(),
            Self::Chosen(_) => f.debug_tuple("Chosen").finish_non_exhaustive(),
        }
    }
}

/// [`Controls`] with a place for what is chosen.
enum Acting<'a> {
    Held(&'a [f64]),
    Chosen(&'a Law<'a>, Vec<f64>),
}

impl Acting<'_> {
    /// What acts over the step from this state at this time.
    #[inline]
    fn control(&mut self, state: &[f64], time: f64) -> &[f64] {
        match self {
            Self::Held(control) => control,
            Self::Chosen(law, control) => {
                control.fill(0.0);
                law(state, time, control);
                control
            }
        }
    }
}

/// The options of a [`run`].
pub struct RunOptions<'a> {
    /// How many steps to take.
    pub steps: u64,
    /// What acts from outside; `Controls::Held(&[])` where there are no controls.
    pub controls: Controls<'a>,
    /// The index of the next sample after an index that the observer needs.
    pub next: &'a dyn Fn(u64) -> u64,
}

/// Goes on from where the stepper is, and shows the state it starts from, every sample that is needed, and the last. The report tells of
/// the new steps only.
///
/// # Errors
/// If a step cannot be taken; state and stepper's time are then the last ones that were reached.
pub fn run(
    stepper: &mut Stepper<'_>,
    state: &mut [f64],
    run: &RunOptions<'_>,
    observer: &mut dyn FnMut(&Sample<'_>) -> ControlFlow<()>,
) -> Result<RunReport, RunError> {
    let mut report = RunReport::default();
    // no law is asked about a state of another system
    if let Err(cause) = check_length(state, stepper.left.len()) {
        return Err(RunError { step: stepper.taken + 1, time: stepper.time(), report, cause });
    }
    let mut acting = match run.controls {
        Controls::Held(control) => Acting::Held(control),
        Controls::Chosen(law) => {
            Acting::Chosen(law, std::vec![0.0; length(stepper.system.description().controls)])
        }
    };
    loop {
        let (index, time) = (stepper.taken, stepper.time());
        let system = stepper.system;
        let mut memory = || stepper.snapshot();
        report.stopped = observer(&Sample {
            index,
            time,
            energy: system.energy(state, time, acting.control(state, time)),
            casimirs: &system.casimirs(state),
            state,
            memory: core::cell::RefCell::new(&mut memory),
        })
        .is_break();
        if report.stopped || report.steps >= run.steps {
            return Ok(report);
        }
        let until_needed = (run.next)(index).saturating_sub(index).clamp(1, run.steps - report.steps);
        match stepper.go(state, &mut acting, until_needed) {
            Ok(steps) => report.add(&steps),
            Err(error) => {
                report.add(&error.report);
                return Err(RunError { report, ..error });
            }
        }
    }
}
