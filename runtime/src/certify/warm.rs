//! Warm steps: every step is a map, whatever the stepper remembers of earlier ones.
//!
//! A stepper is kept as users keep it, and its steps are held against the same steps from equations that are solved in twice the digits.

use super::frame::larger;
use super::measure::{Figure, STEP, Sample, Trouble};
use super::probe::Probe;
use crate::erased::Method;
use crate::method::Clock;
use crate::retraction::Map;
use crate::stepper::check_step;

/// Steps of ordinary motion: so many that the solver looks three times, ever more rarely, at how it predicts and when it may stop, and then
/// goes on for as long as it ever does without looking.
const ORDINARY: usize = 2_500;
/// Of them, the first are all compared; later every so many, and those that take another number of iterations than the one before.
const FIRST: usize = 40;
const EVERY: usize = 47;
/// But not more of these than one in so many.
const SELDOM: usize = 17;
/// Steps after something new: more than are remembered.
const AFTER: usize = 20;
/// Errors of so few units in the last place need no explanation.
const FEW: f64 = 8.0;
/// New states, and how far away they are, in what changes the motion entirely.
const RESTARTS: usize = 3;
const AWAY: f64 = 0.3;
/// How far controls jump, in units of what they are.
const JUMPS: [f64; 3] = [1e-9, 1e-3, 1.0];
/// The longest steps, in units of the ordinary one. Beyond, an equation may have several solutions.
const LONGEST: f64 = 10.0;

/// A number between −1 and 1 that has nothing to do with its neighbours.
fn noise(k: usize) -> f64 {
    let x = (k as f64 + 1.0) * 12.9898;
    2.0 * (x.sin() * 43_758.547).rem_euclid(1.0) - 1.0
}

/// The size of the numbers in these places.
fn size(numbers: &[f64], places: &[usize]) -> f64 {
    // what is smaller has not its full precision
    places.iter().fold(f64::MIN_POSITIVE / f64::EPSILON, |size, &i| larger(size, numbers[i].abs()))
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
    fn new(sample: &'a Sample<'b>, step: f64) -> Result<Self, Trouble> {
        check_step(step).map_err(Trouble::Parameter)?;
        let state = sample.state.to_vec();
        Ok(Self {
            sample,
            blocks: sample.frame.blocks(&state),
            method: (sample.scheme.method)(step).map_err(Trouble::NotGenerated)?,
            clock: Clock { start: sample.time, step, taken: 0 },
            next: state.clone(),
            state,
            is_known: false,
            iterations: 0,
            since: 0,
            worst: None,
        })
    }

    /// Takes a step, and compares it, always or if it took other iterations than the last one. `false` if it cannot be taken, not even by a
    /// stepper that remembers nothing.
    fn step(&mut self, control: &[f64], always: bool) -> Result<bool, Trouble> {
        let time = self.clock.after(0);
        let outcome = self.method.advance(&self.state, &mut self.next, time, control, self.is_known);
        self.is_known = outcome.is_ok();
        match outcome {
            Ok((iterations, _)) => {
                let iterations = iterations.iter().sum();
                self.since += 1;
                if always || iterations != self.iterations && self.since >= SELDOM {
                    self.compare(time, control);
                    self.since = 0;
                }
                self.iterations = iterations;
            }
            // what is remembered saves time, and nothing else: what a new stepper solves, this one has to solve
            Err(_) => {
                let mut new = (self.sample.scheme.method)(self.clock.step).map_err(Trouble::NotGenerated)?;
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
        let (parameters, step) = (self.sample.system.parameters(), self.clock.step);
        let given = Given { parameters: &parameters, state: &self.state, step, time, control };
        let Some(end) = self.sample.converged(&given) else { return };
        let mut worst = self.worst.unwrap_or(0.0);
        let mut responses: Option<Vec<f64>> = None;
        for (b, block) in self.blocks.iter().enumerate() {
            let error = block.iter().fold(0.0, |error, &i| larger(error, (self.next[i] - end[0][i]).abs()));
            let unit = f64::EPSILON * size(&end[0], block);
            if error <= larger(worst, FEW) * unit {
                worst = larger(worst, error / unit);
                continue;
            }
            // what is a difference of large numbers has not more digits than they leave it
            let responses =
                responses.get_or_insert_with(|| self.sample.responses(&given, &end, &self.blocks));
            worst = larger(worst, error / larger(unit, responses[b]));
        }
        self.worst = Some(worst);
    }

    /// Takes so many steps, all of them compared; whether all could be taken.
    fn all(&mut self, control: &[f64], steps: usize) -> Result<bool, Trouble> {
        for _ in 0..steps {
            if !self.step(control, true)? {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// What a step is a function of.
#[derive(Clone, Copy)]
struct Given<'a> {
    parameters: &'a [f64],
    state: &'a [f64],
    step: f64,
    time: f64,
    control: &'a [f64],
}

impl Sample<'_> {
    /// The state that a step leads to, and what its numbers leave out, from equations solved in twice the digits.
    fn converged(&self, given: &Given<'_>) -> Option<[Vec<f64>; 2]> {
        let Given { parameters, state, step, time, control } = *given;
        Probe::end(parameters, (state, time, control), |probe| (self.scheme.kernels)(probe, step))
    }

    /// How much each block of the state that a step leads to changes with a unit in the last place of each of the numbers that the step is a
    /// function of; all of them together as if by chance.
    fn responses(&self, given: &Given<'_>, end: &[Vec<f64>; 2], blocks: &[Vec<usize>]) -> Vec<f64> {
        let mut responses = vec![0.0_f64; blocks.len()];
        let mut respond = |other: &Given<'_>| {
            let other = self.converged(other);
            for (response, block) in responses.iter_mut().zip(blocks) {
                // at the limit of what can be solved
                let change = other.as_ref().map_or(f64::INFINITY, |other| {
                    let change = |i: usize| (other[0][i] - end[0][i]) + (other[1][i] - end[1][i]);
                    block.iter().fold(0.0, |size, &i| larger(size, change(i).abs()))
                });
                *response = response.hypot(change);
            }
        };
        let more = 1.0 + f64::EPSILON;
        let changed = |numbers: &[f64], i: usize, by: f64| {
            let mut numbers = numbers.to_vec();
            numbers[i] += by;
            numbers
        };
        for block in blocks {
            let unit = f64::EPSILON * size(given.state, block);
            for &i in block {
                respond(&Given { state: &changed(given.state, i, unit), ..*given });
            }
        }
        for (i, parameter) in given.parameters.iter().enumerate() {
            let parameters = &changed(given.parameters, i, f64::EPSILON * parameter);
            respond(&Given { parameters, ..*given });
        }
        for (i, control) in given.control.iter().enumerate() {
            respond(&Given { control: &changed(given.control, i, f64::EPSILON * control), ..*given });
        }
        respond(&Given { time: more * given.time, ..*given });
        respond(&Given { step: more * given.step, ..*given });
        responses
    }

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
            warm.state = self.frame.displace(self.state, Map::Exponential, &by);
            warm.is_known = false;
        }
        warm.all(self.control, AFTER)?;
        Ok(warm.worst)
    }

    /// With controls that jump at every step, and that stay and then jump.
    pub(super) fn control_jumps(&self) -> Figure {
        let mut worst: Option<f64> = None;
        for jump in JUMPS {
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
            worst = worst.map_or(warm.worst, |worst| Some(larger(worst, warm.worst.unwrap_or(0.0))));
        }
        Ok(worst)
    }

    /// With steps ever twice as long, until they are too long for how fast the motion has become or cannot be taken.
    pub(super) fn long_steps(&self) -> Figure {
        let mut worst: Option<f64> = None;
        let mut longer = 2.0;
        while longer <= LONGEST {
            let mut warm = Warm::new(self, longer * self.step)?;
            for _ in 0..AFTER {
                let rate = self.frame.rate_at(&warm.state, self.control, warm.clock.after(0));
                let covers = rate * warm.clock.step.abs();
                if covers > LONGEST * STEP || !warm.step(self.control, true)? {
                    break;
                }
            }
            worst = warm.worst.map_or(worst, |error| Some(larger(error, worst.unwrap_or(0.0))));
            longer *= 2.0;
        }
        Ok(worst)
    }

    /// What a control is large next to: what all those of its kind are, or else what moves the system as much as it moves by itself.
    fn control_scale(&self, index: usize) -> f64 {
        let mut offset = 0;
        for quantity in self.description.controls {
            let places = offset..offset + quantity.components.len();
            offset = places.end;
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
