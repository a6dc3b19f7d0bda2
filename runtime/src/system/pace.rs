//! How Taylor steps follow each other in time.

use super::length::{Length, SHORTEST};
use crate::error::{ParameterError, StepError};
use crate::snapshot::count;

/// The time of a trajectory, and what is asked of the length of its steps.
#[doc(hidden)]
#[cfg_attr(
    not(feature = "std"),
    allow(unreachable_pub, reason = "without std there are no systems whose types are erased")
)]
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// A step that is always the same, if it is.
    pub(crate) fixed: Option<f64>,
    /// No step is longer.
    pub(crate) most: f64,
    /// No step goes past this time, if it is one.
    pub(crate) end: f64,
    pub(crate) taken: u64,
    /// The last step: how long it was.
    pub(crate) last: Option<f64>,
    /// The time in two numbers.
    time: [f64; 2],
    /// When the last step started; not a number where the series are not those of it.
    from: f64,
    /// How many of the last steps were cut down to the least ones.
    cut: u32,
    /// How many of the last steps were made shorter, and when the first of them started.
    shorter: (u32, f64),
}

/// The step that is wanted next.
#[derive(Clone, Copy)]
pub(crate) struct Wanted {
    pub(crate) length: Length,
    /// The way that is left, and the time at its end, if there is one.
    pub(crate) end: Option<(f64, f64)>,
}

impl From<Length> for Wanted {
    fn from(length: Length) -> Self {
        Self { length, end: None }
    }
}

/// So many least steps in a row lead across any jump; more are taken where what moves jumps back.
const MOST_CUT: u32 = 16;

/// So many shorter steps in a row are to lead a share of the way that is left.
const SHORTER: u32 = 4096;
/// The least share: some million steps, then, would be left.
const SHARE: f64 = 1.0 / 256.0;

impl Default for Pace {
    fn default() -> Self {
        Self {
            fixed: None,
            most: f64::INFINITY,
            end: f64::INFINITY,
            taken: 0,
            last: None,
            time: [0.0; 2],
            from: f64::NAN,
            cut: 0,
            shorter: (0, 0.0),
        }
    }
}

impl Pace {
    /// How many numbers are remembered.
    pub(crate) const MEMORY: usize = 4;

    pub(crate) fn time(&self) -> f64 {
        self.time[0]
    }

    /// Bounds the length of the steps; an infinite or negative bound is none.
    pub(crate) fn bound(&mut self, step: f64) {
        self.most = if step > 0.0 { step } else { f64::INFINITY };
    }

    pub(crate) fn set_time(&mut self, time: f64) {
        (self.time, self.from) = ([time, 0.0], f64::NAN);
    }

    /// Leaves the last step: what lies within it is not to be had any more.
    pub(crate) fn leave(&mut self) {
        self.from = f64::NAN;
    }

    pub(crate) fn has_ended(&self) -> bool {
        self.end == self.time()
    }

    /// The length of the last step, with the sign of the way to the end that is set; before the first that way.
    pub(crate) fn step_size(&self) -> f64 {
        let way = self.end - self.time();
        match self.last {
            _ if self.fixed.is_some() => self.fixed.unwrap_or(way),
            None => way,
            Some(last) if way == 0.0 || !way.is_finite() => last,
            Some(last) => last.abs().copysign(way),
        }
    }

    /// The next step, if there is one before the end.
    pub(crate) fn next(&self) -> Result<Option<Wanted>, StepError> {
        if self.end.is_finite() {
            return self.toward(self.end);
        }
        Ok(Some(self.fixed.map_or(Length::AtMost(self.most), Length::Exactly).into()))
    }

    /// The next step toward a time, if it is not that time.
    pub(crate) fn toward(&self, time: f64) -> Result<Option<Wanted>, StepError> {
        let way = (time - self.time[0]) - self.time[1];
        if !way.is_finite() {
            return Err(StepError::OutOfReach { time });
        }
        if way == 0.0 {
            return Ok(None);
        }
        let longest = self.fixed.map_or(self.most, f64::abs);
        let length = match self.fixed {
            Some(_) => Length::Exactly(if longest < way.abs() { longest.copysign(way) } else { way }),
            None => Length::AtMost(way.abs().min(longest).copysign(way)),
        };
        Ok(Some(Wanted { length, end: Some((way, time)) }))
    }

    /// Begins a step. Returns the length of the one before, if there was one.
    pub(crate) fn begin(&mut self) -> Option<f64> {
        self.leave();
        self.last
    }

    /// Goes on in time by a step, if it leads anywhere.
    pub(crate) fn took(
        &mut self,
        (step, share): (f64, f64),
        is_finite: bool,
        end: Option<(f64, f64)>,
    ) -> Result<(), StepError> {
        let [high, low] = self.time;
        let is_last = end.is_some_and(|(way, _)| step == way);
        if step == 0.0 || (step.abs() < SHORTEST * high.abs() && !is_last) {
            self.last = None;
            return Err(StepError::NoProgress { step });
        }
        if !step.is_finite() || !is_finite {
            self.last = None;
            return Err(if step.is_finite() { StepError::NotFinite } else { StepError::NoEnd });
        }
        let cut = if share < 4.0 { self.cut + 1 } else { 0 };
        if cut > MOST_CUT {
            self.last = None;
            return Err(StepError::Jumps { step });
        }
        self.cut = cut;
        if !self.gets_on(share < f64::INFINITY, end.map(|(way, _)| way)) {
            self.last = None;
            return Err(StepError::Jumps { step });
        }
        // both numbers of the time, and the step
        let sum = high + step;
        let part = sum - high;
        let rest = ((high - (sum - part)) + (step - part)) + low;
        self.time = match end {
            Some((way, time)) if step == way => [time, 0.0],
            _ => [sum + rest, rest - ((sum + rest) - sum)],
        };
        (self.from, self.last) = (high, Some(step));
        self.taken += 1;
        Ok(())
    }

    /// Counts one more step. Whether many shorter ones in a row have led on: they may not where what rounding leaves of terms that cancel is
    /// all that moves a system, which jumps.
    fn gets_on(&mut self, is_shorter: bool, way: Option<f64>) -> bool {
        let now = self.time[0];
        let (count, since) = self.shorter;
        self.shorter = match is_shorter {
            false => (0, now),
            true if count == 0 || count == SHORTER => (1, now),
            true => (count + 1, since),
        };
        count < SHORTER || way.is_none_or(|way| (now - since).abs() > SHARE * way.abs())
    }

    /// How far within the last step this share of it is.
    pub(crate) fn share(&self, share: f64) -> Option<f64> {
        self.last.filter(|_| !self.from.is_nan() && (0.0..=1.0).contains(&share)).map(|last| share * last)
    }

    /// Whether a step of this length from there is the last one.
    pub(crate) fn is_last(&self, start: f64, length: f64) -> bool {
        start == self.from && self.last == Some(length)
    }

    /// Goes back to what there was before a step that is not to count.
    pub(crate) fn undo(&mut self, before: Self) {
        *self = Self { last: None, from: f64::NAN, ..before };
    }

    /// Whether a step of this length from there is within the last one.
    pub(crate) fn covers(&self, start: f64, length: f64) -> bool {
        start == self.from && self.last.is_some_and(|last| (0.0..=1.0).contains(&(length / last)))
    }

    /// All that is carried from one step to the next, with the largest that each number of an input has been.
    #[cfg(feature = "std")]
    pub(crate) fn snapshot(&self, sizes: &[f64]) -> std::vec::Vec<f64> {
        let own = [self.time[0], self.time[1], self.taken as f64, self.last.unwrap_or(0.0)];
        own.into_iter().chain(sizes.iter().copied()).collect()
    }

    /// Takes that back.
    pub(crate) fn restore(&mut self, sizes: &mut [f64], memory: &[f64]) -> Result<(), ParameterError> {
        let expected = Self::MEMORY + sizes.len();
        let [high, low, taken, last, known @ ..] = memory else {
            return Err(ParameterError::Snapshot { expected, got: memory.len() });
        };
        if memory.len() != expected {
            return Err(ParameterError::Snapshot { expected, got: memory.len() });
        }
        sizes.copy_from_slice(known);
        (self.time, self.taken, self.from) = ([*high, *low], count(*taken), f64::NAN);
        self.last = Some(*last).filter(|last| *last != 0.0);
        (self.cut, self.shorter) = (0, (0, 0.0));
        Ok(())
    }
}
