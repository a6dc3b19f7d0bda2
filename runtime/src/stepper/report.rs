//! How runs went.

use thiserror::Error;

use super::StepReport;
use crate::error::StepError;
use crate::method::StepsReport;
use crate::scalar::Real;

/// How a run went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RunReport {
    /// Steps taken.
    pub steps: u64,
    /// Whether an observer or an event ended the run, be it at its last step.
    pub stopped: bool,
    /// The event that ended the run, by its number in the order in which events were added, from 0.
    pub event: Option<usize>,
    /// Iterations of all steps together, fixed-point updates and Newton corrections alike.
    pub iterations: u64,
    /// The most iterations that one step took.
    pub max_iterations: u32,
    /// The largest residual left in a step's equation, relative to its terms.
    pub max_residual: f64,
}

impl RunReport {
    /// Iterations per step, on average; 0 if no step was taken.
    pub fn iterations_per_step(&self) -> f64 {
        if self.steps == 0 { 0.0 } else { self.iterations as f64 / self.steps as f64 }
    }

    #[inline(always)]
    pub(crate) fn count(&mut self, step: &StepReport) {
        self.add(&Self {
            steps: 1,
            stopped: false,
            event: None,
            iterations: u64::from(step.iterations),
            max_iterations: step.iterations,
            max_residual: step.residual,
        });
    }

    /// Counts steps that a method has taken, of one lane.
    #[inline(always)]
    pub(crate) fn add_steps<T: Real>(&mut self, more: &StepsReport<T>) {
        self.add(&Self {
            steps: more.steps,
            stopped: false,
            event: None,
            iterations: more.iterations.as_ref().iter().sum(),
            max_iterations: more.max_iterations.as_ref().iter().sum(),
            max_residual: more.max_residual.to_f64(),
        });
    }

    /// Counts the steps of another report, too.
    #[inline(always)]
    pub(crate) fn add(&mut self, more: &Self) {
        self.steps += more.steps;
        self.iterations += more.iterations;
        self.max_iterations = self.max_iterations.max(more.max_iterations);
        if more.max_residual > self.max_residual {
            self.max_residual = more.max_residual;
        }
    }
}

/// A run that ended at a step which could not be taken. The state is the last one that was reached.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("step {step}, from time {time}, could not be taken: {cause}")]
#[non_exhaustive]
pub struct RunError {
    /// The step that failed, counted from 1.
    pub step: u64,
    /// The time it started from: that of the state as it is now.
    pub time: f64,
    /// How the run went until then.
    pub report: RunReport,
    /// What went wrong.
    pub cause: StepError,
}

impl RunError {
    /// The error of a run of one's own making: the step that failed, counted from 1, the time it started from, how the run went until then, and
    /// what went wrong.
    pub fn new(step: u64, time: f64, report: RunReport, cause: StepError) -> Self {
        Self { step, time, report, cause }
    }
}
