//! The states of a run, one by one.

use coadjoint::erased::Stepper;
use coadjoint::prelude::*;
use coadjoint::{RunReport, State};
use coadjoint_app::error::RunError;
use coadjoint_app::setup::{Method, Order, Retraction};
use coadjoint_app::simulate::scheme;
use coadjoint_app::{Error, Example};
use coadjoint_systems::catalogue::CATALOGUE;

/// Takes so many steps of one of the catalogue's systems with its own control law from the time 0, and shows the initial state and the state
/// after each step, with its index and time.
///
/// # Errors
/// If parameters or step are not valid, or a step cannot be taken.
pub(super) fn each_step<S: Example>(
    system: &S,
    start: &S::State,
    (method, retraction, order): (Method, Retraction, Order),
    (step, steps): (f64, u64),
    mut observe: impl FnMut(u64, f64, &S::State),
) -> Result<(), Error> {
    let erased = CATALOGUE.erased(system)?;
    let mut stepper =
        Stepper::new(erased, &scheme(method, retraction, order)?, step).map_err(RunError::from)?;
    let mut components = start.to_components();
    for index in 0..=steps {
        let (state, time) = (S::State::from_components(&components), stepper.time());
        observe(index, time, &state);
        if index < steps {
            let control = system.control(&state, time).to_components();
            let step = |cause| coadjoint::RunError::new(index + 1, time, RunReport::default(), cause);
            stepper.step(components.as_mut(), control.as_ref()).map_err(step)?;
        }
    }
    Ok(())
}
