//! Taylor steps of any system that has them, from one end of a step to the next.

use std::sync::{Arc, Mutex, PoisonError};

use coadjoint::erased::{self, At, StepperError};
use coadjoint::stepper::Stepping;
use coadjoint::{Run, StepError};

use super::RunError;
use crate::error::SetupError;
use crate::setup::Tolerance;

/// Builds a stepper whose steps are as many Taylor steps to a tolerance as there need be.
///
/// # Errors
/// If parameters or step are not valid, there are no power series of the system, or an input drives it.
pub(super) fn stepper(
    system: Arc<dyn erased::System>,
    tolerance: Tolerance,
    is_driven: bool,
    step: f64,
) -> Result<erased::Stepper, RunError> {
    if is_driven {
        let reason =
            "Taylor steps hold their controls: leave out `--input`, or take another method".to_owned();
        return Err(SetupError::new(reason).into());
    }
    let series = Mutex::new(erased::Adaptive::new(system.clone(), tolerance.value())?);
    let stepper = erased::Stepper::from_fn(system, step, move |_, at: &At<'_>, next| {
        // what is left behind by one that failed is set anew
        let mut series = series.lock().unwrap_or_else(PoisonError::into_inner);
        Stepping::set_time(&mut *series, at.time);
        let mut state = at.state.to_vec();
        let run = Run::new(&mut *series, &mut state).with_control(at.control.to_vec());
        let report = run.to(at.time + at.step).map_err(|error| error.cause)?;
        next.copy_from_slice(&state);
        Ok::<u32, StepError>(report.steps.try_into().unwrap_or(u32::MAX))
    });
    Ok(stepper.map_err(StepperError::from)?)
}
