//! Observers of a run: what is kept of its samples for tables, pictures and pages.

mod conservation;
mod curves;
mod envelope;
mod page;
mod samples;

use coadjoint::erased::System;
use serde::{Deserialize, Serialize};

pub use conservation::{ConservationReport, DriftStats};
pub(crate) use curves::{Curves, Part, PartKind, parts};
pub use envelope::Envelope;
pub(crate) use page::{PageRecorder, PageSamples};
pub(crate) use samples::{RecordedSample, Samples};

use crate::catalogue::Entry;

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
    /// Writes down what the stepper carries here: see [`Stepper::snapshot`](coadjoint::erased::Stepper::snapshot).
    pub snapshot: &'a dyn Fn() -> Vec<f64>,
}

/// All that is recorded of a run.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Recorders {
    /// The conservation of energy and Casimirs, from the first sample on.
    pub(crate) conservation: Option<ConservationReport>,
    /// How far the configuration was off its group, at most.
    pub(crate) off_group: f64,
    pub(crate) curves: Option<Curves>,
    pub(crate) page: Option<PageRecorder>,
}

impl Recorders {
    /// Adds a sample of the run.
    pub(crate) fn push(&mut self, entry: &Entry, system: &dyn System, sample: &Sample<'_>) {
        let Self { conservation, off_group, curves, page } = self;
        conservation.get_or_insert_with(|| ConservationReport::new(sample)).push(sample);
        *off_group = off_group.max(system.deviation(sample.state));
        if let Some(curves) = curves {
            curves.push(entry, sample);
        }
        if let Some(page) = page {
            page.push(sample);
        }
    }
}
