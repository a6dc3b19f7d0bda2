//! Long series, downsampled so that the plot keeps every peak.

use serde::{Deserialize, Serialize};

use super::{Color, Series};

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

    /// What a run did, in one colour: the area between the least values and the greatest, and its edges. Slow changes are a line, fast ones a
    /// light area.
    pub fn series(&self, label: &str, color: Color) -> Vec<Series> {
        let lower: Vec<_> = self.bins.iter().flatten().map(|bin| bin.least).collect();
        let upper = self.upper();
        vec![
            Series::band("", color, 0.18, lower.clone(), upper.clone()),
            Series::line("", color, lower),
            Series::line(label, color, upper),
        ]
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
        let [band, lower, upper] = &envelope.series("x", Color::X)[..] else {
            panic!("a band and its edges")
        };
        assert_eq!((lower.points.len(), upper.points.len(), band.points.len()), (50, 50, 100));
        for line in [lower, upper] {
            assert!(line.points.is_sorted_by(|a, b| a.0 < b.0));
            assert!(line.points.iter().all(|&(t, y)| y == value(t as u64)));
        }
        assert!(upper.points.contains(&(77_777.0, 9.0)));
        assert!(lower.points.iter().all(|point| point.1 < -0.99));
        assert_eq!(envelope.upper().len(), 50);
        assert!(envelope.upper().iter().all(|point| point.1 > 0.99));
    }

    #[test]
    fn short_series_stay_as_they_are() {
        let mut envelope = Envelope::new(3, 50);
        for i in 0..3 {
            envelope.push(i, i as f64, -(i as f64));
        }
        assert_eq!(envelope.upper(), [(0.0, 0.0), (1.0, -1.0), (2.0, -2.0)]);
    }
}
