//! What a method does to quantities that should be constant, over a long run.

use crate::plot::{Axis, Envelope, Panel, Series, Style};
use coadjoint_systems::ledger::Kept;

/// The picture shows the largest error in each of this many parts of the run.
const PARTS: usize = 450;

/// One quantity with one method.
#[derive(Clone, Debug)]
pub(crate) struct Course {
    /// How well it was kept.
    pub(crate) kept: Kept,
    envelope: Envelope,
}

impl Course {
    /// Of a run with so many ticks, of a quantity that starts with this value.
    pub(crate) fn new(initial: f64, ticks: u64) -> Self {
        Self { kept: Kept::new(initial), envelope: Envelope::new(ticks, PARTS) }
    }

    /// Takes in the value at a tick.
    pub(crate) fn push(&mut self, index: u64, time: f64, value: f64) {
        self.kept.push(time, value);
        self.envelope.push(index, time, (value - self.kept.initial).abs());
    }

    /// The largest error of each part of the run.
    pub(crate) fn upper(&self) -> Vec<(f64, f64)> {
        self.envelope.upper()
    }
}

/// The quantities that one method should keep.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    /// The method's name.
    pub(crate) method: String,
    /// The quantities, in the same order for every method.
    pub(crate) courses: Vec<Course>,
    ticks: u64,
}

impl Track {
    /// Of a run of so many steps.
    pub(crate) fn new(method: impl Into<String>, steps: u64) -> Self {
        Self { method: method.into(), courses: Vec::new(), ticks: steps + 1 }
    }

    /// Takes in all quantities at a tick.
    pub(crate) fn push<const N: usize>(&mut self, index: u64, time: f64, values: [f64; N]) {
        if self.courses.is_empty() {
            self.courses = values.iter().map(|&value| Course::new(value, self.ticks)).collect();
        }
        for (course, value) in self.courses.iter_mut().zip(values) {
            course.push(index, time, value);
        }
    }
}

/// A panel with the errors of one quantity by all methods.
pub(super) fn panel(tracks: &[Track], quantity: usize, time: &str, label: &str) -> Panel {
    let series = tracks.iter().filter_map(|track| {
        let points = track.courses.get(quantity)?.upper();
        let label = track.method.clone();
        // the two methods of order 4 do the same to everything but the attitude: one as marks upon the other
        Some(if label == "RKMK4" {
            Series { label, points: points.into_iter().step_by(15).collect(), style: Style::Marks }
        } else {
            Series::line(label, points)
        })
    });
    let series = series.collect();
    Panel::new(Axis::linear(time), Axis::logarithmic(label), series)
}
