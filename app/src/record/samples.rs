//! Samples of a motion in memory.

use super::{Rotation, Sample};
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
    /// The state, and what goes with it.
    pub(crate) numbers: Vec<f64>,
    pub(crate) energy: f64,
    pub(crate) casimirs: Vec<f64>,
    /// Of each rotation the angle in the plane, which goes on beyond a turn, rad.
    pub(crate) angles: Vec<f64>,
}

impl Samples {
    /// Adds a sample of a run, with the rotations at it.
    pub(crate) fn push(&mut self, sample: &Sample<'_>, rotations: &[Rotation]) {
        let &Sample { index, time, energy, casimirs, numbers, .. } = sample;
        let (numbers, casimirs) = (numbers.to_vec(), casimirs.to_vec());
        let angles = rotations.iter().map(|rotation| rotation.angles[0]).collect();
        self.0.push(RecordedSample { index, time, numbers, energy, casimirs, angles });
    }

    /// Shows all samples to an observer; so many of their numbers are the state.
    pub(crate) fn replay(&self, state: usize, mut observe: impl FnMut(&Sample<'_>)) {
        for RecordedSample { index, time, numbers, energy, casimirs, .. } in &self.0 {
            let (index, time, energy, state) = (*index, *time, *energy, &numbers[..state.min(numbers.len())]);
            observe(&Sample { index, time, state, numbers, energy, casimirs, snapshot: &Vec::new });
        }
    }
}
