//! Conserved quantities: their errors and their drift.

use super::Sample;
use serde::{Deserialize, Serialize};

/// Statistics of the error of a conserved quantity: its initial value, the range of its error, and its linear trend.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DriftStats {
    /// Its initial value.
    pub initial: f64,
    /// The least and the greatest distance from it, with their signs.
    pub range: (f64, f64),
    /// The largest distance, without a sign; not-a-number once the quantity was.
    pub error: f64,
    line: Line,
}

impl DriftStats {
    /// For a quantity with this initial value.
    pub fn new(initial: f64) -> Self {
        Self { initial, range: (0.0, 0.0), error: 0.0, line: Line::default() }
    }

    /// Adds the value at a time.
    pub fn push(&mut self, time: f64, value: f64) {
        let error = value - self.initial;
        self.range = (self.range.0.min(error), self.range.1.max(error));
        // a comparison with not-a-number is false: once there, it stays
        if error.is_nan() || error.abs() > self.error {
            self.error = error.abs();
        }
        self.line.push(time, error);
    }

    /// The slope of the straight line that is closest to the errors, per second.
    pub fn slope(&self) -> f64 {
        self.line.slope()
    }

    /// Measures how much of the errors' range is that straight line's rise from the start to the end: near 1 for a
    /// drift, small for an oscillation.
    pub fn drift(&self) -> f64 {
        let range = self.range.1 - self.range.0;
        if range == 0.0 { 0.0 } else { (self.slope() * self.line.duration).abs() / range }
    }
}

/// The straight line closest to points that come one after the other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Line {
    count: f64,
    /// Between the first point and the last.
    duration: f64,
    start: f64,
    /// The means of time and value.
    mean: (f64, f64),
    /// The sum of squared times, about the mean.
    spread: f64,
    /// The sum of the products of time and value, about the means.
    product: f64,
}

impl Line {
    fn push(&mut self, time: f64, value: f64) {
        if self.count == 0.0 {
            self.start = time;
        }
        self.duration = time - self.start;
        self.count += 1.0;
        // Welford's algorithm: no difference of large sums
        let before = time - self.mean.0;
        self.mean.0 += before / self.count;
        self.mean.1 += (value - self.mean.1) / self.count;
        self.spread += before * (time - self.mean.0);
        self.product += before * (value - self.mean.1);
    }

    fn slope(&self) -> f64 {
        if self.spread == 0.0 { 0.0 } else { self.product / self.spread }
    }
}

/// The conservation of energy and Casimirs over a run, relative to its start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConservationReport {
    /// The energy; it is conserved only where the system is autonomous.
    pub energy: DriftStats,
    /// The Casimirs.
    pub casimirs: Vec<DriftStats>,
    /// The last step that was recorded.
    pub steps: u64,
    /// Its time, s.
    pub time: f64,
}

impl ConservationReport {
    /// Starts with the initial sample.
    pub fn new(start: &Sample<'_>) -> Self {
        Self::at(start.time, start.energy, start.casimirs)
    }

    /// Starts at a time with these values.
    pub(crate) fn at(time: f64, energy: f64, casimirs: &[f64]) -> Self {
        let casimirs = casimirs.iter().map(|&casimir| DriftStats::new(casimir)).collect();
        Self { energy: DriftStats::new(energy), casimirs, steps: 0, time }
    }

    /// Adds a sample of the run.
    pub fn push(&mut self, sample: &Sample<'_>) {
        self.energy.push(sample.time, sample.energy);
        for (stats, &casimir) in self.casimirs.iter_mut().zip(sample.casimirs) {
            stats.push(sample.time, casimir);
        }
        (self.steps, self.time) = (sample.index, sample.time);
    }
}
