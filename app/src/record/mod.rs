//! Observers of a run: what is kept of its samples for tables, pictures and pages.

mod conservation;
mod curves;
mod envelope;
mod events;
mod page;
mod rotations;
mod samples;
mod some_states;

use coadjoint::erased::System;
use serde::{Deserialize, Serialize};

pub use conservation::{ConservationReport, DriftStats};
pub(crate) use curves::{Curves, Part, PartKind, parts};
pub use envelope::Envelope;
pub use events::RecordedEvent;
pub(crate) use page::{PageRecorder, PageSamples};
pub(crate) use rotations::{Rotation, Rotations};
pub(crate) use samples::{RecordedSample, Samples};
pub(crate) use some_states::SomeStates;

use crate::catalogue::Entry;

/// One sample of a run: the initial state, or the state after a step.
pub struct Sample<'a> {
    /// Steps taken so far.
    pub index: u64,
    /// The time.
    pub time: f64,
    /// The state.
    pub state: &'a [f64],
    /// The state, behind it the controls of the step that starts here, and behind these the system's observables.
    pub numbers: &'a [f64],
    /// The energy, with the controls of the step that starts here.
    pub energy: f64,
    /// The Casimirs.
    pub casimirs: &'a [f64],
    /// Writes down what the stepper carries here: see [`Stepper::snapshot`](coadjoint::erased::Stepper::snapshot).
    pub snapshot: &'a dyn Fn() -> Vec<f64>,
}

impl<'a> Sample<'a> {
    /// A state at time 0 of which nothing else is known.
    #[cfg(test)]
    pub(crate) fn of_state(state: &'a [f64]) -> Self {
        Self { index: 0, time: 0.0, state, numbers: state, energy: 1.0, casimirs: &[], snapshot: &Vec::new }
    }

    /// Collects the numbers of a table's row.
    pub(crate) fn row(&self, entry: &Entry) -> Vec<f64> {
        let (before, own) = self.numbers.split_at(self.numbers.len().saturating_sub(entry.observables.len()));
        [&[self.time], before, &[self.energy], own].concat()
    }
}

/// All that is recorded of a run.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Recorders {
    /// The conservation of energy and Casimirs, from the first sample on.
    pub(crate) conservation: Option<ConservationReport>,
    /// How far the configuration was off its group, at most.
    pub(crate) off_group: f64,
    rotations: Rotations,
    pub(crate) curves: Option<Curves>,
    pub(crate) page: Option<PageRecorder>,
    /// The events that have come.
    pub(crate) events: Vec<RecordedEvent>,
    /// States that were written at times of their own.
    pub(crate) saved: u64,
    /// What is looked at once more when the run is over.
    pub(crate) some: SomeStates,
}

impl Recorders {
    /// Records a run that is about to start for its picture and its page.
    pub(crate) fn of(curves: Option<Curves>, page: Option<PageRecorder>) -> Self {
        Self { curves, page, ..Self::default() }
    }

    /// Adds a sample of the run.
    pub(crate) fn push(&mut self, entry: &Entry, system: &dyn System, sample: &Sample<'_>) {
        self.watch(system, sample);
        self.show(entry, system, sample);
    }

    /// Adds a sample to what is told of the run.
    pub(crate) fn watch(&mut self, system: &dyn System, sample: &Sample<'_>) {
        let Self { conservation, off_group, some, .. } = self;
        conservation.get_or_insert_with(|| ConservationReport::new(sample)).push(sample);
        *off_group = off_group.max(system.deviation(sample.state));
        some.push(sample);
    }

    /// Adds a sample to what is drawn of it.
    pub(crate) fn show(&mut self, entry: &Entry, system: &dyn System, sample: &Sample<'_>) {
        let Self { rotations, curves, page, .. } = self;
        if curves.is_none() && page.is_none() {
            return;
        }
        let rotations = rotations.follow(entry, system, sample);
        if let Some(curves) = curves {
            curves.push(entry, sample, rotations);
        }
        if let Some(page) = page {
            page.push(sample, rotations);
        }
    }
}
