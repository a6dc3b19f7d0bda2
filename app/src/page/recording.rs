//! The moments of a run that its page shows, as many as its turning needs and memory bears.

use serde::{Deserialize, Serialize};

use crate::entry::Entry;
use crate::simulation::{Job, Sample};

/// At most so many moments are kept: a page of some megabytes, drawn 60 times a second.
pub(super) const MOST: usize = 8192;
/// More are not kept without need: more than a screen shows.
const ENOUGH: usize = 2000;
/// Need is a body that turns by more between two of them, rad.
const SEEN: f64 = 0.25;

/// Evenly spaced moments of a run. Once there are too many, every second one is dropped, so that memory stays bounded without knowing beforehand
/// how fast the run turns.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct HtmlPlayer {
    /// Every so many steps are kept, and the last one.
    every: u64,
    last: u64,
    moments: Vec<Moment>,
    /// Where in the state the rotations are, and how far each turned since the last kept moment, rad.
    rotations: Vec<Vec<usize>>,
    turned: Vec<f64>,
    /// The sample before.
    before: (f64, Vec<f64>),
    /// The fastest turning, rad/s.
    rate: f64,
}

/// A kept moment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Moment {
    index: u64,
    pub(super) time: f64,
    pub(super) state: Vec<f64>,
    pub(super) energy: f64,
    pub(super) casimirs: Vec<f64>,
    /// How far each rotation turned since the moment before, rad.
    turned: Vec<f64>,
}

/// The moments of a page.
pub(super) struct Moments<'a> {
    pub(super) kept: Vec<&'a Moment>,
    /// The most that a body turns between two of them, rad.
    pub(super) turn: f64,
    /// The fastest turning, rad/s.
    pub(super) rate: f64,
}

impl HtmlPlayer {
    /// For a run that is about to start.
    pub(crate) fn new(entry: &Entry, job: &Job) -> Self {
        let rotations = entry.shown.rotations().to_vec();
        let turned = vec![0.0; rotations.len()];
        let (moments, before) = Default::default();
        Self { every: 1, last: job.steps, moments, rotations, turned, before, rate: 0.0 }
    }

    /// Whether it fits this system.
    pub(crate) fn is_of(&self, entry: &Entry) -> bool {
        let (numbers, casimirs) = (entry.example.state.len(), entry.description.casimirs.len());
        let rotations = self.rotations.len();
        self.every > 0
            && self.turned.len() == rotations
            && self.rotations.iter().flatten().all(|slot| *slot < numbers)
            && self.moments.iter().all(|moment| {
                moment.state.len() == numbers
                    && moment.casimirs.len() == casimirs
                    && moment.turned.len() == rotations
            })
    }

    /// Adds a sample of the run.
    pub(crate) fn push(&mut self, sample: &Sample<'_>) {
        self.turn(sample);
        if !sample.index.is_multiple_of(self.every) && sample.index != self.last {
            return;
        }
        let none = vec![0.0; self.turned.len()];
        let turned = std::mem::replace(&mut self.turned, none);
        let (state, casimirs) = (sample.state.to_vec(), sample.casimirs.to_vec());
        let Sample { index, time, energy, .. } = *sample;
        self.moments.push(Moment { index, time, state, energy, casimirs, turned });
        if self.moments.len() > MOST {
            self.thin();
        }
    }

    /// Adds up how far each rotation turned since the sample before.
    fn turn(&mut self, sample: &Sample<'_>) {
        let (time, state) = &mut self.before;
        let elapsed = (sample.time - *time).abs();
        for (slots, turned) in self.rotations.iter().zip(&mut self.turned) {
            let of = |state: &[f64]| -> Option<Vec<f64>> {
                slots.iter().map(|slot| state.get(*slot).copied()).collect()
            };
            let (Some(before), Some(now)) = (of(state), of(sample.state)) else { continue };
            let angle = angle_between(&before, &now);
            *turned += angle;
            if elapsed > 0.0 {
                self.rate = self.rate.max(angle / elapsed);
            }
        }
        *time = sample.time;
        sample.state.clone_into(state);
    }

    /// Keeps every second moment.
    fn thin(&mut self) {
        self.every = self.every.saturating_mul(2);
        let mut carried = vec![0.0; self.turned.len()];
        let every = self.every;
        self.moments.retain_mut(|moment| {
            let kept = moment.index.is_multiple_of(every);
            carried.iter_mut().zip(&mut moment.turned).for_each(|(carried, turned)| {
                *carried += *turned;
                if kept {
                    *turned = std::mem::take(carried);
                }
            });
            kept
        });
        self.turned.iter_mut().zip(carried).for_each(|(turned, carried)| *turned += carried);
    }

    /// Those that the page needs: so many that none of them are far apart, but not many more than a screen shows.
    pub(super) fn moments(&self) -> Moments<'_> {
        let mut stride = 1;
        while self.moments.len() / (2 * stride) >= ENOUGH && self.most_turned(2 * stride) <= SEEN {
            stride *= 2;
        }
        let end = self.moments.len().saturating_sub(1);
        let kept = |(k, moment)| (k % stride == 0 || k == end).then_some(moment);
        let kept = self.moments.iter().enumerate().filter_map(kept).collect();
        Moments { kept, turn: self.most_turned(stride), rate: self.rate }
    }

    /// The most that a rotation turns over so many moments.
    fn most_turned(&self, stride: usize) -> f64 {
        let sum =
            |part: &[Moment], k: usize| part.iter().filter_map(|moment| moment.turned.get(k)).sum::<f64>();
        let rest = self.moments.get(1..).unwrap_or_default();
        let sums = rest.chunks(stride).flat_map(|part| (0..self.turned.len()).map(move |k| sum(part, k)));
        sums.fold(0.0, f64::max)
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

    fn recording(steps: u64, per_step: f64) -> HtmlPlayer {
        let moment = |index: u64| Moment {
            index,
            time: index as f64,
            state: Vec::new(),
            energy: 0.0,
            casimirs: Vec::new(),
            turned: vec![if index == 0 { 0.0 } else { per_step }],
        };
        let mut player = HtmlPlayer {
            every: 1,
            last: steps,
            moments: Vec::new(),
            rotations: vec![vec![0, 1, 2, 3]],
            turned: vec![0.0],
            before: Default::default(),
            rate: 0.0,
        };
        for index in 0..=steps {
            if index.is_multiple_of(player.every) || index == steps {
                let turned = std::mem::take(&mut player.turned[0]) + moment(index).turned[0];
                player.moments.push(Moment { turned: vec![turned], ..moment(index) });
            } else {
                player.turned[0] += per_step;
            }
            if player.moments.len() > MOST {
                player.thin();
            }
        }
        player
    }

    #[test]
    fn memory_is_bounded_and_no_turning_is_lost() {
        let player = recording(100_000, 0.015);
        assert!(player.moments.len() <= MOST, "{}", player.moments.len());
        let total: f64 = player.moments.iter().map(|moment| moment.turned[0]).sum();
        assert!((total - 1500.0).abs() < 1e-6, "{total}");
        let moments = player.moments();
        assert_eq!(moments.kept.last().map(|moment| moment.index), Some(100_000));
        assert!(moments.turn <= SEEN, "{}", moments.turn);
        // slower needs fewer, faster cannot be shown
        assert!(recording(100_000, 1e-4).moments().kept.len() < moments.kept.len());
        assert!(recording(100_000, 0.2).moments().turn > 1.0);
    }
}
