//! Steps that turn farther than their retraction reaches.

use std::f64::consts::PI;

use coadjoint::StepError;
use coadjoint::erased;

use crate::catalogue::quantities::rotation;
use crate::error::RunError;
use crate::setup::{Job, Retraction};

/// Why a step could not be taken, where the reason is that it turns too far.
pub(super) fn explained(
    source: coadjoint::RunError,
    system: &dyn erased::System,
    state: &[f64],
    job: &Job,
) -> RunError {
    let is_equation = matches!(source.cause, StepError::NoConvergence { .. } | StepError::OutsideDomain);
    if !is_equation || job.retraction != Retraction::Exponential || job.method.classical().is_some() {
        return source.into();
    }
    let quantities = system.description().state;
    let rates = system.motion(state, source.time, &[]);
    let turns = quantities.iter().filter_map(|quantity| {
        // of the plane there is no such limit
        let (4, _) = rotation(quantity)? else { return None };
        let rates = &rates[quantity.tangent()][..3];
        Some(rates.iter().map(|rate| rate * rate).sum::<f64>().sqrt())
    });
    let rate = turns.fold(0.0, f64::max);
    let turn = rate * job.step.abs();
    // what is found by the velocity now is no more than the order of it
    if turn.is_finite() && turn > PI {
        RunError::TooFar { source, turn, step: PI / rate }
    } else {
        source.into()
    }
}
