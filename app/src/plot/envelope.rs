//! Long series, downsampled so that the plot keeps every peak.

use serde::{Deserialize, Serialize};

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

    /// Both extremes of every bin, in the order of time.
    pub fn both(&self) -> Vec<(f64, f64)> {
        let mut points = Vec::new();
        for bin in self.bins.iter().flatten() {
            let (first, second) = if bin.least.0 <= bin.greatest.0 {
                (bin.least, bin.greatest)
            } else {
                (bin.greatest, bin.least)
            };
            points.push(first);
            if second.0 != first.0 {
                points.push(second);
            }
        }
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
    fn extremes_survive_in_order() {
        let mut envelope = Envelope::new(100_000, 50);
        let value = |i: u64| if i == 77_777 { 9.0 } else { (i as f64 * 0.37).sin() };
        for i in 0..100_000 {
            envelope.push(i, i as f64, value(i));
        }
        let points = envelope.both();
        assert_eq!(points.len(), 100);
        assert!(points.is_sorted_by(|a, b| a.0 < b.0));
        assert!(points.contains(&(77_777.0, 9.0)));
        assert!(points.iter().all(|&(t, y)| y == value(t as u64)));
        assert_eq!(envelope.upper().len(), 50);
        assert!(envelope.upper().iter().all(|point| point.1 > 0.99));
    }

    #[test]
    fn short_series_stay_as_they_are() {
        let mut envelope = Envelope::new(3, 50);
        for i in 0..3 {
            envelope.push(i, i as f64, -(i as f64));
        }
        assert_eq!(envelope.both(), [(0.0, 0.0), (1.0, -1.0), (2.0, -2.0)]);
        assert_eq!(envelope.upper(), envelope.both());
    }
}
