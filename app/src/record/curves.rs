//! Curves of one run over time: the state, and the errors of the conserved quantities.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use super::Sample;
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
    /// The angles of each rotation at the sample before, from which the next ones go on.
    angles: Vec<Option<[f64; 3]>>,
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
    pub(crate) fn units(&self) -> &[&'static str] {
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

/// Roll, pitch and yaw of a unit quaternion, about x, y and z: the rotation turns by the roll first.
fn roll_pitch_yaw(quaternion: &[f64]) -> [f64; 3] {
    let &[w, x, y, z] = quaternion else { return [f64::NAN; 3] };
    let roll = (2.0 * (w * x + y * z)).atan2(1.0 - 2.0 * (x * x + y * y));
    let pitch = (2.0 * (w * y - z * x)).clamp(-1.0, 1.0).asin();
    let yaw = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
    [roll, pitch, yaw]
}

/// The same rotation by the angles that are nearest to those before: they go on beyond half a turn, and the pitch
/// beyond a quarter.
fn continued(angles: [f64; 3], before: [f64; 3]) -> [f64; 3] {
    let [roll, pitch, yaw] = angles;
    let nearest = |angles: [f64; 3]| {
        let mut distance = 0.0;
        let mut turned = angles;
        for (angle, before) in turned.iter_mut().zip(before) {
            *angle += TAU * ((before - *angle) / TAU).round();
            distance += (*angle - before).abs();
        }
        (distance, turned)
    };
    let (direct, other) = (nearest(angles), nearest([roll + PI, PI - pitch, yaw + PI]));
    if other.0 < direct.0 { other.1 } else { direct.1 }
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
            angles: vec![None; parts(entry).count()],
            energy: envelope.clone(),
            casimirs: vec![envelope; entry.description.casimirs.len()],
        }
    }

    /// Adds a sample of the run.
    pub(crate) fn push(&mut self, entry: &Entry, sample: &Sample<'_>) {
        let (energy, casimirs) =
            self.reference.get_or_insert_with(|| (sample.energy, sample.casimirs.to_vec()));
        let mut curves = self.state.iter_mut();
        let state = entry.plotted.numbers(sample.state);
        for (part, angles) in parts(entry).zip(&mut self.angles) {
            let values = state.get(part.slots.clone()).unwrap_or(&[]);
            let now = match (part.kind, values) {
                (PartKind::Vector, _) => {
                    for (curve, value) in curves.by_ref().take(values.len()).zip(values) {
                        curve.push(sample.index, sample.time, *value);
                    }
                    continue;
                }
                (PartKind::Rotation, _) => roll_pitch_yaw(values),
                (PartKind::PlaneRotation, &[re, im]) => [im.atan2(re), 0.0, 0.0],
                (PartKind::PlaneRotation, _) => [f64::NAN; 3],
            };
            let now = angles.map_or(now, |before| continued(now, before));
            *angles = Some(now);
            for (curve, angle) in curves.by_ref().take(part.curves()).zip(now) {
                curve.push(sample.index, sample.time, angle.to_degrees());
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

#[cfg(test)]
mod tests {
    use coadjoint::prelude::*;

    use super::*;

    fn angles(attitude: &UnitQuaternion<f64>) -> [f64; 3] {
        roll_pitch_yaw(&[attitude.w, attitude.i, attitude.j, attitude.k])
    }

    #[test]
    fn roll_pitch_and_yaw_are_those_of_the_rotation() {
        let [roll, pitch, yaw] = angles(&UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1));
        assert!((roll - 0.3).abs() < 1e-14 && (pitch + 0.7).abs() < 1e-14 && (yaw - 1.1).abs() < 1e-14);
    }

    #[test]
    fn angles_go_on() {
        for axis in [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()] {
            let mut before = [0.0; 3];
            for k in 0..1000 {
                let turned = 0.01 * f64::from(k);
                before = continued(angles(&UnitQuaternion::from_axis_angle(&axis, turned)), before);
                let along = before.iter().zip(axis.iter()).map(|(angle, part)| angle * part).sum::<f64>();
                // the sine of the pitch is flat where it is a quarter turn
                assert!((along - turned).abs() < 1e-7, "{axis:?} {turned} {before:?}");
            }
        }
    }
}
