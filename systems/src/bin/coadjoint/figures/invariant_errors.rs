//! The errors of invariants over a long run, with one method.

use coadjoint_app::picture::{Axis, Panel};
use coadjoint_app::record::DriftStats;
use coadjoint_app::record::Envelope;

use super::methods::{RKMK4, line, marked};

/// The plot shows the largest error in each of this many bins of the run.
pub(super) const BINS: usize = 450;

/// The error of one invariant with one method.
#[derive(Clone, Debug)]
pub(crate) struct ErrorSeries {
    /// Its drift.
    pub(crate) stats: DriftStats,
    envelope: Envelope,
}

impl ErrorSeries {
    /// For a run with so many ticks, of a quantity with this initial value.
    pub(crate) fn new(initial: f64, ticks: u64) -> Self {
        Self { stats: DriftStats::new(initial), envelope: Envelope::new(ticks, BINS) }
    }

    /// Adds the value at a tick.
    pub(crate) fn push(&mut self, index: u64, time: f64, value: f64) {
        self.stats.push(time, value);
        self.envelope.push(index, time, (value - self.stats.initial).abs());
    }

    /// The largest error of each bin of the run.
    pub(crate) fn upper(&self) -> Vec<(f64, f64)> {
        self.envelope.upper()
    }
}

/// The errors of all invariants with one method.
#[derive(Clone, Debug)]
pub(crate) struct InvariantErrors {
    /// The method's name.
    pub(crate) method: &'static str,
    /// The quantities, in the same order for every method.
    pub(crate) invariants: Vec<ErrorSeries>,
    ticks: u64,
}

impl InvariantErrors {
    /// For a run of so many steps.
    pub(crate) fn new(method: &'static str, steps: u64) -> Self {
        Self { method, invariants: Vec::new(), ticks: steps + 1 }
    }

    /// Adds the values of all quantities at a tick.
    pub(crate) fn push<const N: usize>(&mut self, index: u64, time: f64, values: [f64; N]) {
        if self.invariants.is_empty() {
            self.invariants = values.iter().map(|&value| ErrorSeries::new(value, self.ticks)).collect();
        }
        for (series, value) in self.invariants.iter_mut().zip(values) {
            series.push(index, time, value);
        }
    }
}

/// A panel with the errors of one quantity by all methods.
pub(super) fn panel(runs: &[InvariantErrors], quantity: usize, time: &str, label: &str) -> Panel {
    let series = runs.iter().filter_map(|run| {
        let points = run.invariants.get(quantity)?.upper();
        // the two methods of order 4 do the same to everything but the attitude: one as rings around the other
        Some(if run.method == RKMK4 {
            marked(run.method, points.into_iter().step_by(15).collect())
        } else {
            line(run.method, points)
        })
    });
    Panel::new(Axis::linear(time), Axis::logarithmic(label), series.collect())
}
