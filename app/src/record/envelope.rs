//! Long series, downsampled so that the plot keeps every peak.

use serde::{Deserialize, Serialize};

use crate::units::range;

type Points = Vec<(f64, f64)>;

/// The smallest and largest value in each of a fixed number of equal bins of a run, gathered as it goes: a picture of
/// a million steps is as small as one of a thousand, and shows the same extremes.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Envelope {
    ticks: u64,
    bins: Vec<Option<Bin>>,
}

/// Each extreme with its time.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Bin {
    least: (f64, f64),
    greatest: (f64, f64),
}

impl Envelope {
    /// For a run with this many ticks, downsampled to at most this many bins.
    pub fn new(ticks: u64, bins: usize) -> Self {
        Self { ticks, bins: vec![None; bins.max(1)] }
    }

    /// Adds the value of one tick.
    pub fn push(&mut self, index: u64, time: f64, value: f64) {
        let bin = u128::from(index) * self.bins.len() as u128 / u128::from(self.ticks.max(1));
        let Some(bin) = self.bins.get_mut(bin as usize) else { return };
        match bin {
            None => *bin = Some(Bin { least: (time, value), greatest: (time, value) }),
            Some(bin) => {
                if value < bin.least.1 {
                    bin.least = (time, value);
                }
                if value > bin.greatest.1 {
                    bin.greatest = (time, value);
                }
            }
        }
    }

    /// The least value and the greatest of all.
    pub fn range(&self) -> (f64, f64) {
        range(self.bins.iter().flatten().flat_map(|bin| [bin.least.1, bin.greatest.1]))
    }

    /// Tells whether a bin has, on average, more than a third of the range in which nine tenths of the bins are.
    pub(crate) fn is_fast(&self) -> bool {
        let sorted = |of: fn(&Bin) -> f64| {
            let mut values: Vec<f64> = self.bins.iter().flatten().map(of).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let (least, greatest) = (sorted(|bin| bin.least.1), sorted(|bin| bin.greatest.1));
        let tenth = least.len() / 10;
        let (Some(low), Some(high)) = (least.get(tenth), greatest.iter().rev().nth(tenth)) else {
            return false;
        };
        let sum: f64 = greatest.iter().sum::<f64>() - least.iter().sum::<f64>();
        sum > 0.35 * least.len() as f64 * (high - low)
    }

    /// The least and the greatest values of some bins each: what goes up and down once in a few bins has smooth edges.
    pub(crate) fn smoothed(&self) -> (Points, Points) {
        const BESIDE: usize = 5;
        let bins: Vec<Bin> = self.bins.iter().flatten().copied().collect();
        let edge = |pick: fn(&Bin) -> (f64, f64), of: fn(f64, f64) -> f64| {
            let near = |k: usize| bins[k.saturating_sub(BESIDE)..(k + BESIDE + 1).min(bins.len())].iter();
            let value = |k: usize| near(k).map(|bin| pick(bin).1).fold(pick(&bins[k]).1, of);
            (0..bins.len()).map(|k| (pick(&bins[k]).0, value(k))).collect()
        };
        (edge(|bin| bin.least, f64::min), edge(|bin| bin.greatest, f64::max))
    }

    /// Both extremes of every bin, in the order of time.
    pub(crate) fn both(&self) -> Points {
        let in_time = |bin: &Bin| {
            let mut ends = [bin.least, bin.greatest];
            ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            ends
        };
        let mut points: Points = self.bins.iter().flatten().flat_map(in_time).collect();
        points.dedup_by_key(|point| point.0);
        points
    }

    /// The greatest value of every bin: of a magnitude, the line it stays below.
    pub fn upper(&self) -> Vec<(f64, f64)> {
        self.bins.iter().flatten().map(|bin| bin.greatest).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_series_stay_as_they_are() {
        let mut envelope = Envelope::new(3, 50);
        for i in 0..3 {
            envelope.push(i, i as f64, -(i as f64));
        }
        assert_eq!(envelope.upper(), [(0.0, 0.0), (1.0, -1.0), (2.0, -2.0)]);
        assert_eq!(envelope.both(), envelope.upper());
    }
}
