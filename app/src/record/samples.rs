//! Samples of a motion in memory.

use super::Sample;
use serde::{Deserialize, Serialize};

/// Samples of a motion, in the order of time.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Samples(pub(crate) Vec<RecordedSample>);

/// The system at one time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RecordedSample {
    /// The number of steps before.
    pub(crate) index: u64,
    pub(crate) time: f64,
    pub(crate) state: Vec<f64>,
    pub(crate) energy: f64,
    pub(crate) casimirs: Vec<f64>,
}

impl Samples {
    /// Adds a sample of a run.
    pub(crate) fn push(&mut self, sample: &Sample<'_>) {
        let &Sample { index, time, state, energy, casimirs, .. } = sample;
        let (state, casimirs) = (state.to_vec(), casimirs.to_vec());
        self.0.push(RecordedSample { index, time, state, energy, casimirs });
    }

    /// Shows all samples to an observer.
    pub(crate) fn replay(&self, mut observe: impl FnMut(&Sample<'_>)) {
        for RecordedSample { index, time, state, energy, casimirs } in &self.0 {
            let (index, time, energy) = (*index, *time, *energy);
            observe(&Sample { index, time, state, energy, casimirs, snapshot: &Vec::new });
        }
    }
}
