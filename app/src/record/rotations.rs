//! Rotations followed from sample to sample, with the turns between two of them that samples alone do not show.

use std::f64::consts::{PI, TAU};

use coadjoint::erased::System;
use coadjoint::prelude::*;
use serde::{Deserialize, Serialize};

use super::Sample;
use crate::catalogue::Entry;

/// Angles are continued along a motion in parts of at most this, rad.
const PART: f64 = 0.4;

/// The rotations of a run at the last sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Rotations {
    time: f64,
    followed: Vec<Rotation>,
}

/// A rotation at a sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Rotation {
    /// Its unit quaternion, or its unit complex number.
    pub(super) numbers: Vec<f64>,
    /// Its angular velocity in body axes, of one in the plane the first component, rad/s.
    pub(super) rate: [f64; 3],
    /// Roll, pitch and yaw, or the angle of one in the plane, which go on beyond a turn, rad.
    pub(crate) angles: [f64; 3],
    /// The angle that it turned by since the sample before, rad.
    pub(crate) turned: f64,
}

impl Rotations {
    /// Follows them to a sample of the run.
    pub(crate) fn follow(&mut self, entry: &Entry, system: &dyn System, sample: &Sample<'_>) -> &[Rotation] {
        let numbers = entry.plotted.numbers(sample.numbers);
        let controls = &sample.numbers[sample.state.len()..];
        let rates = entry.plotted.rates(system, (sample.state, sample.time, controls));
        let rotating = entry.plotted.all().iter().filter(|quantity| quantity.rotation > 0);
        let duration = sample.time - self.time;
        let mut before = std::mem::take(&mut self.followed).into_iter();
        let followed = rotating.zip(rates).map(|(quantity, rate)| {
            let numbers = &numbers[quantity.slots.start..quantity.slots.start + quantity.rotation];
            Rotation::at(numbers, rate, before.next().as_ref(), duration)
        });
        self.followed = followed.collect();
        self.time = sample.time;
        &self.followed
    }
}

impl Rotation {
    /// A rotation so long after another sample.
    fn at(numbers: &[f64], rate: [f64; 3], before: Option<&Self>, duration: f64) -> Self {
        let mut now = Self { numbers: numbers.to_vec(), rate, angles: [0.0; 3], turned: 0.0 };
        // by the trapezoidal rule; a velocity that is not known turns nothing
        let mean = |before: &Self, k: usize| 0.5 * duration * (before.rate[k] + rate[k]);
        let expected = |before: &Self, k| Some(mean(before, k)).filter(|x| x.is_finite()).unwrap_or(0.0);
        match (now.quaternion(), before) {
            (None, before) => {
                let [re, im] = [0, 1].map(|k| numbers.get(k).copied().unwrap_or(f64::NAN));
                let (angle, at) = (im.atan2(re), before.map_or(0.0, |before| before.angles[0]));
                let expected = before.map_or(0.0, |before| at + expected(before, 0));
                now.angles[0] = angle + TAU * ((expected - angle) / TAU).round();
                now.turned = before.map_or(0.0, |_| (now.angles[0] - at).abs());
            }
            (Some(to), None) => now.angles = roll_pitch_yaw(&to),
            (Some(to), Some(before)) => {
                let from = before.quaternion().unwrap_or(to);
                let expected = Vector3::from_fn(|k, _| expected(before, k));
                (now.angles, now.turned) = turned(before.angles, (from, to), expected);
            }
        }
        now
    }

    fn quaternion(&self) -> Option<UnitQuaternion<f64>> {
        let &[w, i, j, k] = &self.numbers[..] else { return None };
        Some(UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)))
    }
}

/// The angles at the end of a motion from these angles on, and how far it turned: about as expected, in body axes, rad.
fn turned(
    mut angles: [f64; 3],
    (from, to): (UnitQuaternion<f64>, UnitQuaternion<f64>),
    expected: Vector3<f64>,
) -> ([f64; 3], f64) {
    let go_on = |mut angles: [f64; 3], by: Vector3<f64>, missing: Vector3<f64>| {
        let parts = ((by + missing).norm() / PART).ceil().max(1.0) as u32;
        for part in (1..=parts).map(|k| f64::from(k) / f64::from(parts)) {
            let at = from * UnitQuaternion::new(by * part) * UnitQuaternion::new(missing * part);
            angles = continued(roll_pitch_yaw(&at), angles);
        }
        angles
    };
    // what the expectation misses is small, also beside many turns
    let missing = ((from * UnitQuaternion::new(expected)).inverse() * to).scaled_axis();
    let (turns, mut rest) = ((expected.norm() / TAU).trunc(), expected);
    if turns > 0.0 {
        // each whole turn about one axis changes the angles by as much
        let turn = expected.normalize() * TAU;
        let once = go_on(angles, turn, Vector3::zeros());
        for (angle, after) in angles.iter_mut().zip(once) {
            *angle += turns * TAU * ((after - *angle) / TAU).round();
        }
        rest -= turns * turn;
    }
    (go_on(angles, rest, missing), (expected + missing).norm())
}

/// Roll, pitch and yaw of a rotation, about x, y and z: it turns by the roll first.
fn roll_pitch_yaw(rotation: &UnitQuaternion<f64>) -> [f64; 3] {
    let [x, y, z, w]: [f64; 4] = rotation.coords.into();
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Follows a rotation whose numbers and angular velocity are known, and tells its angles and how far it turned.
    fn followed(
        step: f64,
        steps: u32,
        rate: impl Fn(f64) -> [f64; 3],
        numbers: impl Fn(f64) -> Vec<f64>,
    ) -> ([f64; 3], f64) {
        let mut before: Option<Rotation> = None;
        let mut total = 0.0;
        for time in (0..=steps).map(|k| f64::from(k) * step) {
            let now = Rotation::at(&numbers(time), rate(time), before.as_ref(), step);
            total += now.turned;
            before = Some(now);
        }
        (before.expect("a rotation").angles, total)
    }

    fn quaternion(rotation: UnitQuaternion<f64>) -> Vec<f64> {
        vec![rotation.w, rotation.i, rotation.j, rotation.k]
    }

    #[test]
    fn roll_pitch_and_yaw_are_those_of_the_rotation() {
        let [roll, pitch, yaw] = roll_pitch_yaw(&UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1));
        assert!((roll - 0.3).abs() < 1e-14 && (pitch + 0.7).abs() < 1e-14 && (yaw - 1.1).abs() < 1e-14);
    }

    #[test]
    fn angles_go_on_whatever_the_step() {
        // slow, near half a turn, whole turns, many of them, and backwards in time
        for step in [0.01, 0.8, 3.13, PI, TAU, 20.0, -20.0, 1000.5] {
            for (k, axis) in [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()].into_iter().enumerate()
            {
                let turning = |time: f64| quaternion(UnitQuaternion::from_axis_angle(&axis, time));
                let (angles, total) = followed(step, 100, |_| axis.into_inner().into(), turning);
                // the sine of the pitch is flat where it is a quarter turn
                let expected = [0, 1, 2].map(|j| if j == k { 100.0 * step } else { 0.0 });
                let error = (0..3).map(|j| (angles[j] - expected[j]).abs()).fold(0.0, f64::max);
                assert!(error < 1e-6, "{axis:?} by {step}: {angles:?}");
                assert!((total - 100.0 * step.abs()).abs() < 1e-6, "{axis:?} by {step}: {total}");
            }
            let turning = |time: f64| vec![(1.5 - time).cos(), (1.5 - time).sin()];
            let (angles, total) = followed(step, 100, |_| [-1.0, 0.0, 0.0], turning);
            assert!((angles[0] - 1.5 + 100.0 * step).abs() < 1e-7, "by {step}: {angles:?}");
            assert!((total - 100.0 * step.abs()).abs() < 1e-6, "by {step}: {total}");
        }
    }

    #[test]
    fn what_speeds_up_is_followed() {
        // θ = t³/6, up to 3 turns a step: the trapezoidal rule misses (0.5³/12) s³ of it
        let angle = |time: f64| time.powi(3) / 6.0;
        let rate = |time: f64| [time * time / 2.0, 0.0, 0.0];
        let (angles, total) = followed(0.5, 18, rate, |time| vec![angle(time).cos(), angle(time).sin()]);
        assert!((angles[0] - 121.5).abs() < 1e-9 && (total - 121.5).abs() < 1e-9, "{angles:?}");
        let turning = |time| quaternion(UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle(time)));
        let (angles, total) = followed(0.5, 18, |time| [0.0, 0.0, rate(time)[0]], turning);
        assert!((angles[2] - 121.5).abs() < 1e-9 && (total - 121.5).abs() < 1e-9, "{angles:?}");
    }

    #[test]
    fn without_a_velocity_the_nearest_angle_is_taken() {
        let turning = |time: f64| vec![time.cos(), time.sin()];
        assert!((followed(0.5, 40, |_| [f64::NAN; 3], turning).0[0] - 20.0).abs() < 1e-12);
    }
}
