//! Warm steps: every step is a map, whatever the stepper remembers of earlier ones.
//!
//! A stepper is kept as users keep it, and its steps are held against the same steps from equations that are solved in
//! twice the digits.

use super::frame::{larger, worst};
use super::measure::{Figure, MeasureError, STEP, Sample};
use super::probe::{End, Solver, as_solver, by_all_ways};
use crate::erased::{At, Method, units};
use crate::method::Clock;
use crate::retraction::RetractionKind;
use crate::stepper::check_step;
use crate::system::Quantity;

/// Steps of ordinary motion: so many that the solver looks three times, ever more rarely, at how it predicts and when
/// it may stop, and then goes on for as long as it ever does without looking.
const ORDINARY: usize = 2_500;
/// Of them, the first are all compared; later every so many, and those that take another number of iterations than the
/// one before.
const FIRST: usize = 40;
const EVERY: usize = 47;
/// But not more of these than one in so many.
const SELDOM: usize = 17;
/// Steps after something new: more than are remembered.
const AFTER: usize = 20;
/// New states, and how far away they are, in what changes the motion entirely.
const RESTARTS: usize = 3;
const AWAY: f64 = 0.3;
/// How far controls jump, in units of what they are.
const JUMPS: [f64; 3] = [1e-9, 1e-3, 1.0];
/// The longest steps, in units of the ordinary one. Beyond, an equation may have several solutions.
const LONGEST: f64 = 10.0;

/// A number between −1 and 1 that has nothing to do with its neighbours.
pub(super) fn noise(k: usize) -> f64 {
    let x = (k as f64 + 1.0) * 12.9898;
    2.0 * (x.sin() * 43_758.547).rem_euclid(1.0) - 1.0
}

/// A stepper that is kept.
struct Warm<'a, 'b> {
    sample: &'a Sample<'b>,
    blocks: Vec<Vec<usize>>,
    method: Box<dyn Method<f64>>,
    clock: Clock,
    /// Where the last step has led to.
    state: Vec<f64>,
    next: Vec<f64>,
    is_known: bool,
    iterations: u32,
    /// Steps since the last that was compared.
    since: usize,
    /// The largest error so far, if there was something to compare with.
    worst: Option<f64>,
}

impl<'a, 'b> Warm<'a, 'b> {
    fn new(sample: &'a Sample<'b>, step: f64) -> Result<Self, MeasureError> {
        check_step(step).map_err(MeasureError::Parameter)?;
        let state = sample.state.to_vec();
        Ok(Self {
            sample,
            blocks: sample.frame.blocks(),
            method: (sample.scheme.method)(step).map_err(MeasureError::NotGenerated)?,
            clock: Clock { start: sample.time, step, taken: 0 },
            next: state.clone(),
            state,
            is_known: false,
            iterations: 0,
            since: 0,
            worst: None,
        })
    }

    /// Takes a step, and compares it, always or if it took other iterations than the last one. `false` if it cannot be
    /// taken, not even by a stepper that remembers nothing.
    fn step(&mut self, control: &[f64], always: bool) -> Result<bool, MeasureError> {
        let time = self.clock.after(0);
        let outcome = self.method.advance(&self.state, &mut self.next, time, control, self.is_known);
        self.is_known = outcome.is_ok();
        match outcome {
            Ok(advanced) => {
                let iterations = advanced.iterations.iter().sum();
                self.since += 1;
                if always || iterations != self.iterations && self.since >= SELDOM {
                    self.compare(time, control);
                    self.since = 0;
                }
                self.iterations = iterations;
            }
            // what is remembered saves time, and nothing else: what a new stepper solves, this one has to solve
            Err(_) => {
                let mut new =
                    (self.sample.scheme.method)(self.clock.step).map_err(MeasureError::NotGenerated)?;
                if new.advance(&self.state, &mut self.next, time, control, false).is_err() {
                    return Ok(false);
                }
                self.worst = Some(f64::INFINITY);
            }
        }
        core::mem::swap(&mut self.state, &mut self.next);
        self.clock.taken += 1;
        Ok(true)
    }

    /// Holds the step from `state` to `next` against the converged one.
    fn compare(&mut self, time: f64, control: &[f64]) {
        let Some((end, allowed)) = self.converged(time, control, as_solver) else { return };
        let error = units(&self.next, &end, &allowed, &self.blocks).of_rounding;
        self.worst = Some(self.worst.map_or(error, |worst| larger(worst, error)));
    }

    /// Where the step from `state` leads to in twice the digits.
    fn converged(&self, time: f64, control: &[f64], solver: Solver) -> Option<End> {
        let at = At { step: self.clock.step, state: &self.state, time, control };
        self.sample.scheme.end(&self.sample.system.parameters(), &at, solver)
    }

    /// Takes so many steps, all of them compared; whether all could be taken.
    fn all(&mut self, control: &[f64], steps: usize) -> Result<bool, MeasureError> {
        for _ in 0..steps {
            if !self.step(control, true)? {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

impl Sample<'_> {
    /// Of the ordinary motion.
    pub(super) fn warm_steps(&self) -> Figure {
        let mut warm = Warm::new(self, self.step)?;
        for step in 0..ORDINARY {
            if !warm.step(self.control, step < FIRST || step % EVERY == 0)? {
                break;
            }
        }
        Ok(warm.worst)
    }

    /// From other states than the last one that a step has led to.
    pub(super) fn restarts(&self) -> Figure {
        let mut warm = Warm::new(self, self.step)?;
        for restart in 0..RESTARTS {
            warm.all(self.control, AFTER)?;
            let n = self.frame.dimension();
            let by: Vec<f64> = (0..n).map(|i| AWAY * self.frame.scale[i] * noise(n * restart + i)).collect();
            warm.state = self.frame.displace(self.state, RetractionKind::Exponential, &by);
            warm.is_known = false;
        }
        warm.all(self.control, AFTER)?;
        Ok(warm.worst)
    }

    /// From the state with each momentum and each advected parameter zero in turn, and with all momenta zero, where the
    /// motion is finite there: steps of new steppers.
    pub(super) fn zeros(&self) -> Figure {
        let linear = &self.frame.linear;
        let momenta = self.frame.configuration.len();
        worst((0..=linear.len()).map(|zero| {
            let mut warm = Warm::new(self, self.step)?;
            let places = if zero < linear.len() { zero..zero + 1 } else { 0..momenta };
            linear[places].iter().for_each(|linear| warm.state[linear.component] = 0.0);
            let rate = self.frame.rate_at(&warm.state, self.control, self.time);
            if !(rate * self.step.abs() <= LONGEST * STEP) {
                return Ok(None);
            }
            let time = warm.clock.after(0);
            let is_taken = warm.step(self.control, true)?;
            // a step that is there has to be found
            if !is_taken && warm.converged(time, self.control, by_all_ways).is_some() {
                return Ok(Some(f64::INFINITY));
            }
            Ok(warm.worst)
        }))
    }

    /// With controls that jump at every step, and that stay and then jump.
    pub(super) fn control_jumps(&self) -> Figure {
        worst(JUMPS.into_iter().map(|jump| {
            let mut warm = Warm::new(self, self.step)?;
            for step in 0..4 * AFTER {
                let jumps = step / AFTER % 2 == 1 || step % AFTER == 0;
                let control: Vec<f64> = (0..self.control.len())
                    .map(|i| {
                        let by = if jumps { jump * noise(self.control.len() * step + i) } else { 0.0 };
                        self.control[i] + by * self.control_scale(i)
                    })
                    .collect();
                if !warm.step(&control, true)? {
                    break;
                }
            }
            Ok(warm.worst)
        }))
    }

    /// With steps ever twice as long, until they are too long for how fast the motion has become or cannot be taken.
    pub(super) fn long_steps(&self) -> Figure {
        worst([2.0, 4.0, 8.0].into_iter().map(|longer| {
            let mut warm = Warm::new(self, longer * self.step)?;
            for _ in 0..AFTER {
                let rate = self.frame.rate_at(&warm.state, self.control, warm.clock.after(0));
                let covers = rate * warm.clock.step.abs();
                if covers > LONGEST * STEP || !warm.step(self.control, true)? {
                    break;
                }
            }
            Ok(warm.worst)
        }))
    }

    /// What a control is large next to: what all those of its kind are, or else what moves the system as much as it
    /// moves by itself.
    fn control_scale(&self, index: usize) -> f64 {
        for (_, places) in Quantity::with_ranges(self.description.controls) {
            if places.contains(&index) {
                let size = self.control[places].iter().fold(0.0, |size, x| larger(size, x.abs()));
                if size > 0.0 {
                    return size;
                }
            }
        }
        let mut other = self.control.to_vec();
        other[index] += 1.0;
        let [with, without] = [&other[..], self.control].map(|c| self.frame.motion(self.state, self.time, c));
        let strongest =
            (with - without).iter().zip(&self.frame.scale).fold(0.0, |strongest, (force, scale)| {
                larger(strongest, (force / (scale * self.frame.rate)).abs())
            });
        let scale = 1.0 / strongest;
        if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
    }
}
