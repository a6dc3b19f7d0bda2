//! The samples of a run that its page shows, as many as its turning needs and memory bears.

use serde::{Deserialize, Serialize};

use super::{RecordedSample, Rotation, Sample, Samples};

/// At most so many moments are kept: a page of some megabytes, drawn 60 times a second.
const MOST: usize = 8192;
/// More are not kept without need: more than a screen shows.
const ENOUGH: usize = 2000;
/// Need is a body that turns by more between two of them, rad.
const SEEN: f64 = 0.25;

/// Evenly spaced samples of a run. Once there are too many, every second one is dropped, so that memory stays bounded
/// without knowing beforehand how fast the run turns.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct PageRecorder {
    /// Every so many steps are kept, and the last one.
    every: u64,
    last: u64,
    samples: Samples,
    /// How far the rotations turned before each sample, since the one before it, rad: in each step the fastest counts.
    turns: Vec<f64>,
    /// How far they turned since the last kept sample, rad.
    turned: f64,
    /// The time of the sample before.
    before: f64,
    /// The fastest turning, rad/s.
    rate: f64,
}

/// The samples of a page.
pub(crate) struct PageSamples<'a> {
    pub(crate) kept: Vec<&'a RecordedSample>,
    /// The most that a body turns between two of them, rad.
    pub(crate) turn: f64,
    /// The fastest turning, rad/s.
    pub(crate) rate: f64,
}

impl PageRecorder {
    /// Prepares for a run of this length.
    pub(crate) fn new(steps: u64) -> Self {
        Self { every: 1, last: steps, ..Self::default() }
    }

    /// Adds a sample of the run, with the rotations at it.
    pub(crate) fn push(&mut self, sample: &Sample<'_>, rotations: &[Rotation]) {
        let turned = rotations.iter().map(|rotation| rotation.turned).fold(0.0, f64::max);
        self.turned += turned;
        if turned > 0.0 {
            self.rate = self.rate.max(turned / (sample.time - self.before).abs());
        }
        self.before = sample.time;
        if !sample.index.is_multiple_of(self.every) && sample.index != self.last {
            return;
        }
        self.turns.push(std::mem::take(&mut self.turned));
        self.samples.push(sample, rotations);
        if self.samples.0.len() > MOST {
            self.thin();
        }
    }

    /// Keeps every second sample.
    fn thin(&mut self) {
        self.every = self.every.saturating_mul(2);
        let (mut carried, mut turns) = (0.0, Vec::new());
        for (sample, turned) in self.samples.0.iter().zip(&self.turns) {
            carried += turned;
            if sample.index.is_multiple_of(self.every) {
                turns.push(std::mem::take(&mut carried));
            }
        }
        self.samples.0.retain(|sample| sample.index.is_multiple_of(self.every));
        self.turns = turns;
        self.turned += carried;
    }

    /// Chooses those that the page needs: so many that none of them are far apart, but not many more than a screen
    /// shows.
    pub(crate) fn samples(&self) -> PageSamples<'_> {
        let samples = &self.samples.0;
        let mut stride = 1;
        while samples.len() / (2 * stride) >= ENOUGH && self.most_turned(2 * stride) <= SEEN {
            stride *= 2;
        }
        let end = samples.len().saturating_sub(1);
        let kept = |(k, sample)| (k % stride == 0 || k == end).then_some(sample);
        let kept = samples.iter().enumerate().filter_map(kept).collect();
        PageSamples { kept, turn: self.most_turned(stride), rate: self.rate }
    }

    /// Finds the most that the rotations turn over a stride of samples.
    fn most_turned(&self, stride: usize) -> f64 {
        let rest = self.turns.get(1..).unwrap_or_default();
        rest.chunks(stride).map(|part| part.iter().sum()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A recorder of a run whose one rotation turns by so much in each step.
    fn recording(steps: u64, per_step: f64) -> PageRecorder {
        let mut recorder = PageRecorder::new(steps);
        for index in 0..=steps {
            let turned = if index == 0 { 0.0 } else { per_step };
            let rotation =
                Rotation { angles: [index as f64 * per_step, 0.0, 0.0], turned, ..Rotation::default() };
            recorder.push(&Sample { index, time: index as f64, ..Sample::of_state(&[]) }, &[rotation]);
        }
        recorder
    }

    #[test]
    fn memory_is_bounded_and_no_turning_is_lost() {
        let recorder = recording(100_000, 0.015);
        assert!(recorder.turns.len() <= MOST, "{}", recorder.turns.len());
        assert_eq!(recorder.turns.len(), recorder.samples.0.len());
        let total: f64 = recorder.turns.iter().sum();
        assert!((total - 1500.0).abs() < 1e-6, "{total}");
        let samples = recorder.samples();
        assert_eq!(samples.kept.last().map(|sample| sample.index), Some(100_000));
        assert!(samples.turn <= SEEN, "{}", samples.turn);
        // slower needs fewer, faster cannot be shown
        assert!(recording(100_000, 1e-4).samples().kept.len() < samples.kept.len());
        assert!(recording(100_000, 0.2).samples().turn > 1.0);
        // also more than half a turn in each step
        let spun = recording(1000, 30.0);
        let samples = spun.samples();
        assert_eq!((samples.turn, samples.rate, samples.kept[1000].angles[0]), (30.0, 30.0, 30_000.0));
    }
}
