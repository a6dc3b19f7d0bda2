//! Taylor steps of any system that has them, from one end of a step to the next.

use std::sync::{Arc, Mutex, PoisonError};

use coadjoint::erased::{self, At, StepperError};
use coadjoint::stepper::Stepping;
use coadjoint::{Run, StepError};

use super::RunError;
use crate::catalogue::Input;
use crate::setup::Tolerance;

/// Builds a stepper whose steps are as many Taylor steps to a tolerance as there need be.
///
/// # Errors
/// If parameters or step are not valid, or there are no power series of the system.
pub(super) fn stepper(
    system: Arc<dyn erased::System>,
    tolerance: Tolerance,
    input: Option<Arc<Input>>,
    step: f64,
) -> Result<erased::Stepper, RunError> {
    let new = || erased::Adaptive::new(system.clone(), tolerance.value());
    let (series, of_events) = (new()?, new()?);
    let nothing = series.snapshot();
    let series = Mutex::new(series);
    let stepper = erased::Stepper::from_fn(system.clone(), step, move |_, at: &At<'_>, next| {
        // Nothing is remembered of the step before, and of one that failed: where a run goes on from a checkpoint, or looks within a step,
        // it goes on to the same bytes.
        let mut series = series.lock().unwrap_or_else(PoisonError::into_inner);
        series.restore(&nothing).map_err(|_| StepError::NotFinite)?;
        Stepping::set_time(&mut *series, at.time);
        let mut state = at.state.to_vec();
        let (run, end) = (Run::new(&mut *series, &mut state), at.time + at.step);
        let report = match &input {
            None => run.with_control(at.control.to_vec()).to(end),
            Some(input) => {
                let driven = |time: f64| {
                    let mut control = at.control.to_vec();
                    input.write(time, &mut control);
                    control
                };
                run.driven_by(driven).to(end)
            }
        };
        let report = report.map_err(|error| error.cause)?;
        next.copy_from_slice(&state);
        Ok::<u32, StepError>(report.steps.try_into().unwrap_or(u32::MAX))
    });
    Ok(stepper.map_err(StepperError::from)?.with_series(of_events))
}
