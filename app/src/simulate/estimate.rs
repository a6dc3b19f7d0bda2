//! How far a trajectory is from the exact one: by a second run with half the step.

use std::ops::ControlFlow;

use coadjoint::system::Quantity;
use serde::Serialize;

use super::simulate;
use crate::catalogue::quantities::rotation;
use crate::catalogue::{Entry, Setup};
use crate::error::RunError;
use crate::setup::{Job, Method, Tolerance};
use crate::units::{magnitude, rounded};

/// The distance between two states: that of the quantity which differs most.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Distance {
    /// The quantity.
    pub quantity: &'static str,
    /// Of a rotation the angle between both, rad; of other numbers relative to their size.
    pub distance: f64,
    /// Whether it is an angle.
    pub is_angle: bool,
}

impl Distance {
    /// Measures the distance of two states; numbers are as large as there or at the start of their motion.
    pub(crate) fn between(entry: &Entry, states: [&[f64]; 2], start: &[f64]) -> Self {
        let norm = |numbers: &mut dyn Iterator<Item = f64>| numbers.fold(0.0, |sum: f64, x| sum.hypot(x));
        let mut largest = Self { quantity: "", distance: 0.0, is_angle: false };
        for (quantity, slots) in Quantity::with_ranges(entry.description.state) {
            let turning = rotation(quantity).map_or(0, |(count, _)| count);
            let [a, b] = states.map(|state| &state[slots.clone()]);
            let apart = |sign: f64, from: usize, to: usize| {
                norm(&mut a[from..to].iter().zip(&b[from..to]).map(|(a, b)| a - sign * b))
            };
            // both signs of a quaternion are one rotation
            let chord =
                if turning == 4 { apart(1.0, 0, 4).min(apart(-1.0, 0, 4)) } else { apart(1.0, 0, turning) };
            let angle = turning as f64 * (0.5 * chord).min(1.0).asin();
            let size = [a, b, &start[slots.clone()]].map(|of| norm(&mut of[turning..].iter().copied()));
            let (size, rest) = (size.into_iter().fold(0.0, f64::max), apart(1.0, turning, a.len()));
            let relative = if rest == 0.0 { 0.0 } else { rest / size };
            for (distance, is_angle) in [(angle, true), (relative, false)] {
                if distance > largest.distance || distance.is_nan() {
                    largest = Self { quantity: quantity.name, distance, is_angle };
                }
            }
        }
        largest
    }

    /// Names what it is measured in: `rad of attitude`, or the size of a quantity, `|position|`; nothing where there is none.
    pub(crate) fn unit(&self) -> String {
        if self.quantity.is_empty() {
            return String::new();
        }
        if self.is_angle { format!("rad of {}", self.quantity) } else { format!("|{}|", self.quantity) }
    }

    /// Writes it with its unit: `2.3e-6 rad of attitude`, `1.1e-5 |position|`.
    pub(crate) fn words(&self) -> String {
        format!("{} {}", magnitude(self.distance), self.unit())
    }
}

/// An estimate of a trajectory's error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ErrorEstimate {
    /// The time for which it holds, s: the beginning of the run.
    pub time: f64,
    /// What the second run has: half the step.
    #[serde(skip)]
    pub by: &'static str,
    /// The distance of the state there from the exact one, as that from the second run's tells it.
    #[serde(flatten)]
    pub distance: Distance,
}

impl ErrorEstimate {
    /// Says it in a sentence.
    pub fn words(&self) -> String {
        let time = rounded(self.time.abs());
        if self.distance.distance == 0.0 {
            return format!("trajectory: {} leads to the same state after {time} s", self.by);
        }
        let error = self.distance.words();
        format!(
            "trajectory: error of about {error} after {time} s, by a second run with {} up to there",
            self.by
        )
    }
}

/// Estimates the error of a run's trajectory by its beginning, a tenth of it or a thousand steps: that is run
/// with its step, and with half of it. None of a run without steps, where half the step leads nowhere, and where it is to `stop`.
///
/// # Errors
/// If a step of the run cannot be taken.
pub fn error_estimate(
    entry: &Entry,
    setup: &Setup,
    job: &Job,
    stop: &dyn Fn() -> bool,
) -> Result<Option<ErrorEstimate>, RunError> {
    let steps = (job.steps / 10).clamp(LEAST.min(job.steps), MOST);
    let end = |job: &Job| -> Result<Vec<f64>, RunError> {
        let mut end = Vec::new();
        simulate(entry, setup, job, None, &|index| index + STOPS, &mut |sample| {
            end = sample.state.to_vec();
            if stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        Ok(end)
    };
    if steps == 0 {
        return Ok(None);
    }
    let here = end(&Job { steps, rest: 0.0, ..*job })?;
    let (better, by) = match job.method {
        Method::Taylor(tolerance) => {
            let smaller = Tolerance::new(tolerance.value() / 100.0).unwrap_or(tolerance);
            (
                Job { method: Method::Taylor(smaller), steps, rest: 0.0, ..*job },
                "a hundredth of the tolerance",
            )
        }
        _ => (Job { step: 0.5 * job.step, steps: 2 * steps, rest: 0.0, ..*job }, "half the step"),
    };
    Ok(end(&better).ok().filter(|_| !stop()).map(|there| {
        let mut distance = Distance::between(entry, [&here, &there], &setup.state);
        if !matches!(job.method, Method::Taylor(_)) {
            // the second run has an error, too: of order p, one 2^p-th of that of the first
            let power = 0.5_f64.powi(job.order_of_step(entry) as i32);
            distance.distance /= 1.0 - power;
        }
        ErrorEstimate { time: steps as f64 * job.step, by, distance }
    }))
}

/// As many steps are compared of any run that has them.
const LEAST: u64 = 1000;
/// After so many it may stop.
const STOPS: u64 = 64;
/// No more are compared.
const MOST: u64 = 100_000;
