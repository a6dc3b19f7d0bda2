//! The samples of a run that its page shows, as many as its turning needs and memory bears.

use super::Sample;
use serde::{Deserialize, Serialize};

use super::{RecordedSample, Samples};
use crate::catalogue::Entry;

/// At most so many moments are kept: a page of some megabytes, drawn 60 times a second.
const MOST: usize = 8192;
/// More are not kept without need: more than a screen shows.
const ENOUGH: usize = 2000;
/// Need is a body that turns by more between two of them, rad.
const SEEN: f64 = 0.25;

/// Evenly spaced samples of a run. Once there are too many, every second one is dropped, so that memory stays bounded
/// without knowing beforehand how fast the run turns.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PageRecorder {
    /// Every so many steps are kept, and the last one.
    every: u64,
    last: u64,
    samples: Samples,
    /// How far the rotations turned before each sample, since the one before it, rad: in each step the fastest counts.
    turns: Vec<f64>,
    /// How far they turned since the last kept sample, rad.
    turned: f64,
    /// Where in the state the rotations are.
    rotations: Vec<Vec<usize>>,
    /// The sample before.
    before: (f64, Vec<f64>),
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
    pub(crate) fn new(entry: &Entry, steps: u64) -> Self {
        Self::of(entry.plotted.rotations().to_vec(), steps)
    }

    fn of(rotations: Vec<Vec<usize>>, last: u64) -> Self {
        let (samples, turns, before) = Default::default();
        Self { every: 1, last, samples, turns, turned: 0.0, rotations, before, rate: 0.0 }
    }

    /// Adds a sample of the run.
    pub(crate) fn push(&mut self, sample: &Sample<'_>) {
        self.turn(sample);
        if !sample.index.is_multiple_of(self.every) && sample.index != self.last {
            return;
        }
        self.turns.push(std::mem::take(&mut self.turned));
        self.samples.push(sample);
        if self.samples.0.len() > MOST {
            self.thin();
        }
    }

    /// Adds up how far the rotations turned since the sample before.
    fn turn(&mut self, sample: &Sample<'_>) {
        let (time, state) = &mut self.before;
        let angle = |slots: &Vec<usize>| {
            let of = |state: &[f64]| -> Option<Vec<f64>> {
                slots.iter().map(|slot| state.get(*slot).copied()).collect()
            };
            Some(angle_between(&of(state)?, &of(sample.state)?))
        };
        let angle = self.rotations.iter().filter_map(angle).fold(0.0, f64::max);
        self.turned += angle;
        if sample.time != *time {
            self.rate = self.rate.max(angle / (sample.time - *time).abs());
        }
        *time = sample.time;
        sample.state.clone_into(state);
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

/// The angle of the rotation between two unit quaternions, two matrices, or two unit complex numbers, rad.
fn angle_between(a: &[f64], b: &[f64]) -> f64 {
    // by the chord, which is exact for small angles too
    let chord = |sign: f64| a.iter().zip(b).map(|(a, b)| (a - sign * b).powi(2)).sum::<f64>().sqrt();
    match a.len() {
        4 => 4.0 * (chord(1.0).min(chord(-1.0)) / 2.0).min(1.0).asin(),
        9 => 2.0 * (chord(1.0) / 8.0_f64.sqrt()).min(1.0).asin(),
        _ => 2.0 * (chord(1.0) / 2.0).min(1.0).asin(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_between_rotations() {
        for angle in [1e-9, 0.3, 3.0_f64] {
            let (c, s) = ((angle / 2.0).cos(), (angle / 2.0).sin());
            let found = angle_between(&[1.0, 0.0, 0.0, 0.0], &[-c, 0.0, -s, 0.0]);
            assert!((found / angle - 1.0).abs() < 1e-9, "{found} {angle}");
            let found = angle_between(&[1.0, 0.0], &[angle.cos(), angle.sin()]);
            assert!((found / angle - 1.0).abs() < 1e-9, "{found} {angle}");
            let unit = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
            let (c, s) = (angle.cos(), angle.sin());
            let found = angle_between(&unit, &[c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0]);
            assert!((found / angle - 1.0).abs() < 1e-9, "{found} {angle}");
        }
    }

    /// A recorder of a run whose one rotation turns by so much in each step.
    fn recording(steps: u64, per_step: f64) -> PageRecorder {
        let mut recorder = PageRecorder::of(vec![vec![0, 1]], steps);
        for index in 0..=steps {
            let angle = index as f64 * per_step;
            let (time, state) = (index as f64, &[angle.cos(), angle.sin()]);
            recorder.push(&Sample { index, time, state, energy: 0.0, casimirs: &[], snapshot: &Vec::new });
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
    }
}
