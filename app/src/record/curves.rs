//! Curves of one run over time: the state, and the errors of the conserved quantities.

use std::ops::Range;

use super::{Rotation, Sample};
use serde::{Deserialize, Serialize};

use super::Envelope;
use crate::catalogue::Entry;
use crate::catalogue::plotted::PlottedQuantity;

/// The plot shows the extremes in each of this many bins of the run.
const BINS: usize = 450;

/// Records the series of a run for its plot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Curves {
    pub(crate) span: (f64, f64),
    /// Energy and Casimirs at the start.
    reference: Option<(f64, Vec<f64>)>,
    /// The curves of each part of the state.
    pub(crate) state: Vec<Envelope>,
    pub(crate) energy: Envelope,
    pub(crate) casimirs: Vec<Envelope>,
}

/// A part of the state with a panel of its own: a rotation, or components that are drawn as they are.
pub(crate) struct Part<'e> {
    pub(crate) quantity: &'e PlottedQuantity,
    pub(crate) slots: Range<usize>,
    pub(crate) kind: PartKind,
    /// Whether the quantity has another part.
    pub(crate) is_half: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum PartKind {
    /// A unit quaternion: roll, pitch and yaw.
    Rotation,
    /// A unit complex number: its angle.
    PlaneRotation,
    /// Components.
    Vector,
}

/// Lists the parts of a system's state.
pub(crate) fn parts(entry: &Entry) -> impl Iterator<Item = Part<'_>> {
    entry.plotted.all().iter().flat_map(|quantity| {
        let slots = quantity.slots.clone();
        let middle = slots.start + quantity.rotation;
        let kind = if quantity.rotation == 4 { PartKind::Rotation } else { PartKind::PlaneRotation };
        let is_half = quantity.rotation > 0 && middle < slots.end;
        let parts = [(slots.start..middle, kind), (middle..slots.end, PartKind::Vector)];
        let parts = parts.into_iter().filter(|(slots, _)| !slots.is_empty());
        parts.map(move |(slots, kind)| Part { quantity, slots, kind, is_half })
    })
}

impl Part<'_> {
    /// Lists the names of its curves.
    pub(crate) fn names(&self) -> Vec<&str> {
        let components = &self.quantity.components;
        match self.kind {
            PartKind::Rotation => vec!["roll", "pitch", "yaw"],
            PartKind::PlaneRotation => vec!["angle"],
            PartKind::Vector => {
                components[components.len() - self.slots.len()..].iter().map(String::as_str).collect()
            }
        }
    }

    /// Lists the units of its components.
    pub(crate) fn units(&self) -> &[String] {
        let units = &self.quantity.units;
        &units[units.len() - self.slots.len()..]
    }

    /// Counts its curves.
    fn curves(&self) -> usize {
        match self.kind {
            PartKind::Rotation => 3,
            PartKind::PlaneRotation => 1,
            PartKind::Vector => self.slots.len(),
        }
    }
}

impl Curves {
    /// For a run that is about to start.
    pub(crate) fn new(entry: &Entry, (step, steps): (f64, u64)) -> Self {
        let envelope = Envelope::new(steps + 1, BINS);
        let curves = parts(entry).map(|part| part.curves()).sum();
        let end = steps as f64 * step;
        Self {
            span: (end.min(0.0), end.max(0.0)),
            reference: None,
            state: vec![envelope.clone(); curves],
            energy: envelope.clone(),
            casimirs: vec![envelope; entry.description.casimirs.len()],
        }
    }

    /// Adds a sample of the run, with the rotations at it.
    pub(crate) fn push(&mut self, entry: &Entry, sample: &Sample<'_>, rotations: &[Rotation]) {
        let (energy, casimirs) =
            self.reference.get_or_insert_with(|| (sample.energy, sample.casimirs.to_vec()));
        let (mut curves, mut rotations) = (self.state.iter_mut(), rotations.iter());
        let mut push = |value| curves.next().map(|curve| curve.push(sample.index, sample.time, value));
        let state = entry.plotted.numbers(sample.numbers);
        for part in parts(entry) {
            match part.kind {
                PartKind::Vector => state[part.slots].iter().for_each(|value| _ = push(*value)),
                _ => {
                    let angles = rotations.next().map_or([f64::NAN; 3], |rotation| rotation.angles);
                    angles[..part.curves()].iter().for_each(|angle| _ = push(angle.to_degrees()));
                }
            }
        }
        // where energy is not conserved, its value is shown
        let shown = if entry.conserves_energy() { (sample.energy - *energy).abs() } else { sample.energy };
        self.energy.push(sample.index, sample.time, shown);
        for ((envelope, now), initially) in self.casimirs.iter_mut().zip(sample.casimirs).zip(casimirs) {
            envelope.push(sample.index, sample.time, (now - *initially).abs());
        }
    }
}
