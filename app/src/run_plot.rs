//! The plot of one run: the state, and the errors of the conserved quantities.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use coadjoint::system::Quantity;
use serde::{Deserialize, Serialize};

use crate::casimir;
use crate::entry::{Entry, component_name};
use crate::plot::{Axis, Color, Envelope, Figure, Key, Panel, Series};
use crate::report::with_unit;
use crate::setting::{laid_out, rotation};
use crate::shown::Shown;
use crate::simulation::{Job, Sample};

/// The plot shows the extremes in each of this many bins of the run.
const BINS: usize = 450;
const TIME: &str = "time, s";

/// Records the series of a run for its plot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RunPlot {
    span: (f64, f64),
    /// Energy and Casimirs at the start.
    reference: Option<(f64, Vec<f64>)>,
    /// Of the curves of each part of the state.
    state: Vec<Envelope>,
    /// The angles of each rotation at the sample before, from which the next ones go on.
    angles: Vec<Option<[f64; 3]>>,
    energy: Envelope,
    casimirs: Vec<Envelope>,
}

/// A part of the state with a panel of its own: a rotation, or components that are drawn as they are.
struct Part {
    quantity: &'static Quantity,
    slots: Range<usize>,
    kind: Kind,
    /// Whether the quantity has another part.
    is_half: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A unit quaternion: roll, pitch and yaw.
    Rotation,
    /// A unit complex number: its angle.
    PlaneRotation,
    /// Components.
    Vector,
}

fn parts(entry: &Entry) -> impl Iterator<Item = Part> {
    laid_out(entry.shown.plotted()).flat_map(|(quantity, slots)| {
        let count = rotation(quantity).map_or(0, |(count, _)| count);
        let middle = slots.start + count;
        let kind = if count == 4 { Kind::Rotation } else { Kind::PlaneRotation };
        let is_half = count > 0 && middle < slots.end;
        let parts = [(slots.start..middle, kind), (middle..slots.end, Kind::Vector)];
        let parts = parts.into_iter().filter(|(slots, _)| !slots.is_empty());
        parts.map(move |(slots, kind)| Part { quantity, slots, kind, is_half })
    })
}

impl Part {
    /// Of its curves.
    fn names(&self) -> &'static [&'static str] {
        let components = self.quantity.components;
        match self.kind {
            Kind::Rotation => &["roll", "pitch", "yaw"],
            Kind::PlaneRotation => &["angle"],
            Kind::Vector => components.get(components.len() - self.slots.len()..).unwrap_or(&[]),
        }
    }

    /// The quantity, in words.
    fn label(&self) -> String {
        let name = Shown::name(self.quantity);
        match (self.is_half, self.kind) {
            (true, Kind::Vector) => format!("{name}, translation"),
            (true, _) => format!("{name}, rotation"),
            (false, _) => name,
        }
    }

    /// The unit of a curve, and how many of it the recorded values' unit is: angles that go round many times are counted in turns.
    fn unit(&self, entry: &Entry, name: &str, curve: &Envelope) -> (&'static str, f64) {
        let (low, high) = curve.range();
        match self.kind {
            Kind::Vector => (entry.unit(&component_name(self.quantity, name)), 1.0),
            _ if high - low > 720.0 => ("turns", 1.0 / 360.0),
            _ => ("degrees", 1.0),
        }
    }

    /// Panels with these curves, one for each unit.
    fn panels(&self, entry: &Entry, curves: &[Envelope]) -> Vec<Panel> {
        let mut panels: Vec<(&str, Vec<Series>)> = Vec::new();
        for (k, (name, curve)) in self.names().iter().zip(curves).enumerate() {
            let (unit, scale) = self.unit(entry, name, curve);
            let mut series = curve.series(&name.replace('_', " "), Color::component(k), scale);
            if k >= Color::COMPONENTS {
                // its colour is taken
                series.iter_mut().for_each(|series| series.style = series.style.dashed());
            }
            match panels.iter_mut().find(|(known, _)| *known == unit) {
                Some((_, panel)) => panel.extend(series),
                None => panels.push((unit, series)),
            }
        }
        // alone, a curve needs a name only if others of its quantity are elsewhere
        let count = panels.len();
        let panel = |(unit, series): (&str, Vec<Series>)| {
            let names: Vec<&str> =
                series.iter().map(|series| series.label.as_str()).filter(|label| !label.is_empty()).collect();
            let label = match names[..] {
                [name] if count > 1 => with_unit(&format!("{}: {name}", self.label()), unit),
                _ => with_unit(&self.label(), unit),
            };
            Panel::new(Axis::linear(TIME), Axis::linear(label), series)
        };
        panels.into_iter().map(panel).collect()
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

/// The same rotation by the angles that are nearest to those before: they go on beyond half a turn, and the pitch beyond a quarter.
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

impl RunPlot {
    /// For a run that is about to start.
    pub(crate) fn new(entry: &Entry, job: &Job) -> Self {
        let envelope = Envelope::new(job.steps + 1, BINS);
        let curves = parts(entry).map(|part| part.names().len()).sum();
        let end = job.steps as f64 * job.step;
        Self {
            span: (end.min(0.0), end.max(0.0)),
            reference: None,
            state: vec![envelope.clone(); curves],
            angles: vec![None; parts(entry).count()],
            energy: envelope.clone(),
            casimirs: vec![envelope; entry.description.casimirs.len()],
        }
    }

    /// Whether it fits this system.
    pub(crate) fn is_of(&self, entry: &Entry) -> bool {
        self.state.len() == parts(entry).map(|part| part.names().len()).sum::<usize>()
            && self.angles.len() == parts(entry).count()
    }

    /// Adds a sample of the run.
    pub(crate) fn push(&mut self, entry: &Entry, sample: &Sample<'_>) {
        let (energy, casimirs) =
            self.reference.get_or_insert_with(|| (sample.energy, sample.casimirs.to_vec()));
        let mut curves = self.state.iter_mut();
        let state = entry.shown.numbers(sample.state);
        for (part, angles) in parts(entry).zip(&mut self.angles) {
            let values = state.get(part.slots.clone()).unwrap_or(&[]);
            let now = match (part.kind, values) {
                (Kind::Vector, _) => {
                    for (curve, value) in curves.by_ref().take(values.len()).zip(values) {
                        curve.push(sample.index, sample.time, *value);
                    }
                    continue;
                }
                (Kind::Rotation, _) => roll_pitch_yaw(values),
                (Kind::PlaneRotation, &[re, im]) => [im.atan2(re), 0.0, 0.0],
                (Kind::PlaneRotation, _) => [f64::NAN; 3],
            };
            let now = match (part.kind, *angles) {
                (_, None) => now,
                (Kind::Rotation, Some(before)) => continued(now, before),
                (_, Some([before, ..])) => [now[0] + TAU * ((before - now[0]) / TAU).round(), 0.0, 0.0],
            };
            *angles = Some(now);
            for (curve, angle) in curves.by_ref().take(part.names().len()).zip(now) {
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

    /// A panel for each part of the state, one for energy, and one for each Casimir.
    pub(crate) fn figure(&self, entry: &Entry, title: String) -> Figure {
        let mut panels = Vec::new();
        let mut curves = self.state.as_slice();
        for part in parts(entry) {
            let (own, others) = curves.split_at(part.names().len().min(curves.len()));
            panels.extend(part.panels(entry, own));
            curves = others;
        }
        let mut add = |axis: Axis, series| panels.push(Panel::new(Axis::linear(TIME), axis, series));
        let energy = entry.unit("energy");
        if entry.conserves_energy() {
            let line = Series::line("", Color::X, self.energy.upper());
            add(Axis::logarithmic(with_unit("energy error", energy)), vec![line]);
        } else {
            add(Axis::linear(with_unit("energy", energy)), self.energy.series("", Color::X, 1.0));
        }
        for ((name, unit), envelope) in casimir::symbols_of(entry).zip(&self.casimirs) {
            let label = with_unit(&format!("{name} error"), unit);
            add(Axis::logarithmic(label), vec![Series::line("", Color::X, envelope.upper())]);
        }
        Figure::over_time(title, TIME, self.span, Key::Each, panels)
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
