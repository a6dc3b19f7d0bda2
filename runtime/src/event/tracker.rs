//! What is remembered of a quantity that is watched, and where it is zero within a step.
//!
//! The quantity has a side, the sign that it had last, or none where it starts from zero. A zero is where it comes to the other side, or to zero from
//! one: to start from zero is no event, to come back is.

use core::cell::Cell;

use super::roots::{Answer, roots};
use super::search::{Function, Point, crossing, dip};
use super::{Crossing, Event};
use crate::crossing::MOST_POINTS;
use crate::error::StepError;
use crate::scalar::Scalar;

/// Points that are looked at within a step, with those that are found to be needed.
const MOST: usize = MOST_POINTS as usize + 192;
/// Points within a step where there may be a zero, unless the caller says how many.
const USUAL: u32 = 4;

/// A zero that comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Zero {
    /// The share of the step.
    pub(super) at: f64,
    pub(super) crossing: Crossing,
    /// How large the quantity is there, for want of more digits.
    noise: f64,
}

/// Points within a step that are to be looked at, in order, and whether each is an extremum.
#[derive(Clone, Copy)]
struct Places {
    all: [(f64, bool); MOST],
    count: usize,
    /// The last zero, or extremum near zero.
    before: f64,
}

impl Places {
    fn put(&mut self, at: f64, is_extremum: bool) {
        if let Some(slot) = self.all.get_mut(self.count) {
            *slot = (at, is_extremum);
            self.count += 1;
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Tracker {
    event: Event,
    /// Whether the quantity is positive; none if it is zero, or no number.
    side: Option<bool>,
    /// Values where the last steps started, the one before the last first.
    history: [f64; 2],
    /// How many of them are known.
    known: u32,
    points: [Point; MOST],
    count: usize,
    /// How many of them were passed.
    passed: usize,
    /// What is no more than this is zero, but for the start.
    rounding: f64,
    /// What is no more than this at the start is zero.
    noise: f64,
    next: Option<Zero>,
}

impl Tracker {
    pub(super) fn new(event: Event) -> Self {
        let points = [Point { at: 0.0, value: f64::NAN }; MOST];
        Self {
            event,
            side: None,
            history: [0.0; 2],
            known: 0,
            points,
            count: 0,
            passed: 0,
            rounding: 0.0,
            noise: 0.0,
            next: None,
        }
    }

    pub(super) fn event(&self) -> &Event {
        &self.event
    }

    pub(super) fn next(&self) -> Option<Zero> {
        self.next
    }

    /// Starts from a value, that of a state that no step led to. If it has just been zero, it is so still where it is as small.
    pub(super) fn start(&mut self, value: f64) {
        let noise = core::mem::take(&mut self.noise);
        (self.known, self.next, self.count) = (0, None, 0);
        self.side = side(value, noise);
        self.push(Point { at: 0.0, value: if self.side.is_none() && !value.is_nan() { 0.0 } else { value } });
    }

    /// Goes on from another value than the one before, at the same moment: what has jumped from one sign to the other has its zero there.
    pub(super) fn jump(&mut self, value: f64) {
        if self
            .points()
            .last()
            .is_some_and(|last| last.value != value && !(self.side.is_none() && last.value == 0.0))
        {
            self.push(Point { at: 0.0, value });
        }
    }

    /// Steps of another length begin.
    pub(super) fn forget(&mut self) {
        self.known = 0;
    }

    fn push(&mut self, point: Point) {
        if let Some(slot) = self.points.get_mut(self.count) {
            *slot = point;
            self.count += 1;
        }
    }

    fn insert(&mut self, place: usize, point: Point) {
        if self.count < MOST && place <= self.count {
            self.points.copy_within(place..self.count, place + 1);
            self.points[place] = point;
            self.count += 1;
        }
    }

    fn points(&self) -> &[Point] {
        self.points.get(..self.count).unwrap_or_default()
    }

    /// How many points within the step have to be looked at, at whose end there is this value.
    pub(super) fn wanted(&self, end: f64) -> u32 {
        let start = self.points().first().map_or(f64::NAN, |first| first.value);
        if let Some(points) = self.event.points {
            return points;
        }
        // the parabola through the last three values, and what a fourth one changes of it
        let [before, last] = self.history;
        let (second, third) = (end - 2.0 * start + last, end - 3.0 * start + 3.0 * last - before);
        let is_far = start.abs().min(end.abs()) > 0.125 * second.abs() + 0.25 * third.abs();
        let is_same_side = self.side == side(end, 0.0);
        // all values are between those at the ends: one zero, or none
        let is_monotone = (end - start).abs() > second.abs() + third.abs();
        let is_known = self.known >= 2 && self.side.is_some();
        if is_known && (is_monotone || is_far && is_same_side) { 0 } else { USUAL }
    }

    /// Sees a value within the step, or at its end.
    pub(super) fn see(&mut self, at: f64, value: f64) {
        self.push(Point { at, value });
    }

    /// Looks at the points within a part of a step that tell its zeros, where the quantity has this series: those between them, extrema that are
    /// near zero, and where it ends. Nothing of the series counts but where they are: values are those of the states. Of a part
    /// whose series says nothing, looks at some points.
    pub(super) fn see_series(
        &mut self,
        coefficients: &[f64],
        (from, to): (f64, f64),
        function: &mut Function<'_, StepError>,
    ) -> Result<(), StepError> {
        let places = Cell::new(Places { all: [(0.0, false); MOST], count: 0, before: 0.0 });
        let meet = |at: f64, is_extremum: bool| {
            let mut these = places.get();
            these.put(0.5 * (these.before + at), false);
            if is_extremum {
                these.put(at, true);
            }
            these.before = at;
            places.set(these);
        };
        let answer = roots(
            coefficients,
            &mut |root| meet(root.at, root.crossing == Crossing::Touch),
            &mut |extremum| meet(extremum, true),
        );
        let mut places = places.get();
        match answer {
            Answer::All if places.before == 0.0 => {}
            Answer::All => places.put(0.5 * (places.before + 1.0), false),
            Answer::Zero | Answer::Unknown | Answer::Unresolved => {
                places.count = 0;
                (1..=USUAL).for_each(|k| places.put(f64::from(k) / f64::from(USUAL + 1), false));
            }
        }
        places.put(1.0, false);
        let mut last = from;
        for &(at, is_extremum) in places.all.get(..places.count).unwrap_or_default() {
            let at = if at < 1.0 { from + at * (to - from) } else { to };
            if at > last && at < 1.0 {
                let mut point = Point { at, value: function(at)? };
                let largest =
                    self.points().iter().fold(0.0_f64, |largest, other| largest.max(other.value.abs()));
                if is_extremum && point.value.abs() < 1e-9 * largest {
                    let by = 1e-3 * (to - from).min(at - last).min(1.0 - at);
                    point = touched(function, point, by, 4.0 * f64::EPSILON * largest)?;
                }
                self.insert(self.count.saturating_sub(1), point);
                last = at;
            }
        }
        Ok(())
    }

    /// Looks for the first zero, once all values are known; with those between them, unless a series tells them.
    pub(super) fn settle(
        &mut self,
        function: &mut Function<'_, StepError>,
        tolerance: f64,
        has_series: bool,
    ) -> Result<(), StepError> {
        let largest = self.points().iter().fold(0.0_f64, |largest, point| largest.max(point.value.abs()));
        self.rounding = rounding(largest);
        self.passed = 0;
        if self.side.is_none() {
            self.leave_zero(function)?;
        }
        if self.count > 2 && !has_series {
            self.refine(function, largest)?;
            self.leave_out();
        }
        self.seek(function, tolerance)
    }

    /// Leaves out what lies within the step where the quantity changes its sign once, or not at all: the zero is sought between the ends then, as
    /// where nothing within was to be looked at. A run that goes on from where it was saved, and knows no values before, finds it at the same bits.
    fn leave_out(&mut self) {
        let points = self.points();
        let [first, .., last] = *points else { return };
        let are_sure = points.iter().all(|point| point.value.abs() > self.rounding);
        let changes = points.windows(2).filter(|pair| (pair[0].value > 0.0) != (pair[1].value > 0.0)).count();
        if are_sure && changes <= 1 {
            self.rounding = rounding(first.value.abs().max(last.value.abs()));
            (self.points[1], self.count) = (last, 2);
        }
    }

    /// To which side it goes that starts from zero, be it that it comes back before the next point.
    fn leave_zero(&mut self, function: &mut Function<'_, StepError>) -> Result<(), StepError> {
        let [first, second, ..] = self.points() else { return Ok(()) };
        let (from, width, is_zero) = (first.at, second.at - first.at, first.value == 0.0);
        if !is_zero {
            return Ok(());
        }
        for (place, digits) in [30, 20, 10].into_iter().enumerate() {
            let at = from + width / f64::from(1_u32 << digits);
            let value = function(at)?;
            let is_zero = value.abs() <= self.rounding;
            self.insert(1 + place, Point { at, value: if is_zero { 0.0 } else { value } });
        }
        Ok(())
    }

    /// Looks for zeros between points of one sign, where it comes closest to zero.
    fn refine(&mut self, function: &mut Function<'_, StepError>, largest: f64) -> Result<(), StepError> {
        let is_one_sided = |points: &[Point]| {
            let is_positive = points.iter().all(|point| point.value > 0.0);
            is_positive || points.iter().all(|point| point.value < 0.0)
        };
        // towards the ends, if it comes closer to zero there than where it is known
        for is_end in [false, true] {
            let count = self.count;
            let (end, beside, place) = if is_end { (count - 1, count - 2, count - 1) } else { (0, 1, 1) };
            let [end, beside] = [self.points[end], self.points[beside]];
            let cell = (beside.at - end.at).abs();
            // a dip there is as deep as a parabola with the other values is high
            let share = cell / (1.0 - cell).max(cell);
            let is_near = end.value.abs() < largest * (1.5 * share * share).min(1.0);
            if is_one_sided(&[end, beside]) && end.value.abs() < beside.value.abs() && is_near {
                let by = 0.5 * (beside.at - end.at) * Scalar::sqrt(end.value.abs() / largest);
                let at = end.at + by;
                if at != end.at && at != beside.at {
                    let value = function(at)?;
                    if value.abs() < end.value.abs() {
                        self.insert(place, Point { at, value });
                    }
                }
            }
        }
        let mut place = 1;
        while place + 1 < self.count {
            let [left, middle, right] = [place - 1, place, place + 1].map(|k| self.points[k]);
            let is_dip = middle.value.abs() <= left.value.abs().min(right.value.abs());
            if is_dip
                && is_one_sided(&[left, middle, right])
                && middle.value.abs() < left.value.abs().max(right.value.abs())
            {
                let sign = middle.value.signum();
                let positive = |point: Point| Point { value: sign * point.value, ..point };
                let found = dip(
                    &mut |at| function(at).map(|value| sign * value),
                    positive(left),
                    positive(middle),
                    positive(right),
                )?;
                if let Some(least) = found {
                    let noise = self.rounding + 2.0 * spread(function, least.at, left.at, right.at)?;
                    let is_zero = least.value.abs() <= noise;
                    let value = if is_zero { 0.0 } else { sign * least.value };
                    if least.value <= 0.0 || is_zero {
                        if least.at == middle.at {
                            self.points[place].value = value;
                        } else {
                            let place = if least.at < middle.at { place } else { place + 1 };
                            self.insert(place, Point { at: least.at, value });
                        }
                        place += 1;
                    }
                }
            }
            place += 1;
        }
        Ok(())
    }

    /// Looks for the next zero that counts.
    pub(super) fn seek(
        &mut self,
        function: &mut Function<'_, StepError>,
        tolerance: f64,
    ) -> Result<(), StepError> {
        self.next = None;
        while self.passed + 1 < self.count {
            let (near, far) = (self.points[self.passed], self.points[self.passed + 1]);
            self.passed += 1;
            let before = self.side;
            // compared with where it comes from
            let rounding = if near.value.is_finite() { 4.0 * f64::EPSILON * near.value.abs() } else { 0.0 };
            self.side = side(far.value, rounding);
            let Some(was_positive) = before else { continue };
            let crossing = if was_positive { Crossing::Falling } else { Crossing::Rising };
            match self.side {
                _ if far.value.is_nan() => {}
                // it comes to zero
                None => {
                    let rest = self.points().iter().skip(self.passed + 1);
                    let then = rest.filter_map(|point| side(point.value, rounding)).next();
                    let is_end = self.passed + 1 == self.count;
                    let is_touch = then == before || is_end && is_even(function, near.at, far.at)?;
                    let crossing = if is_touch { Crossing::Touch } else { crossing };
                    if self.event.counts(crossing) {
                        self.next = Some(Zero { at: far.at, crossing, noise: far.value.abs().max(rounding) });
                        return Ok(());
                    }
                }
                Some(is_positive) if is_positive == was_positive => {}
                Some(_) if !self.event.counts(crossing) => {}
                Some(_) => {
                    let (near, far) = self::crossing(function, near, far, tolerance)?;
                    let noise = near.value.abs().max(far.value.abs());
                    let noise = if noise.is_finite() { noise } else { 0.0 };
                    self.next = Some(Zero { at: far.at, crossing, noise });
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// The next zero has come.
    pub(super) fn pass(&mut self) {
        if let Some(zero) = self.next.take() {
            self.noise = 2.0 * zero.noise + self.rounding;
        }
    }

    /// The step has ended, and the next one starts where it did.
    pub(super) fn end(&mut self) {
        let [.., last] = self.points() else { return };
        let (first, last) = (self.points[0], *last);
        self.history = [self.history[1], first.value];
        self.known += 1;
        (self.count, self.next, self.noise) = (0, None, 0.0);
        let value = if self.side.is_none() && !last.value.is_nan() { 0.0 } else { last.value };
        self.push(Point { at: 0.0, value });
    }
}

/// What no value is told from zero by, where the largest one is this.
fn rounding(largest: f64) -> f64 {
    if largest.is_finite() { 4.0 * f64::EPSILON * largest } else { 0.0 }
}

/// Whether a number is positive; none if it is zero, but for rounding, or no number.
fn side(value: f64, rounding: f64) -> Option<bool> {
    (value.abs() > rounding).then_some(value > 0.0)
}

/// Whether a zero at the end of a step is double, as far as can be told from what comes before it.
fn is_even(function: &mut Function<'_, StepError>, near: f64, far: f64) -> Result<bool, StepError> {
    let by = (far - near) / 1024.0;
    let (twice, once) = (function(far - by)?, function(far - 0.5 * by)?);
    // of a simple one it is 2, of a double one 4, of a triple one 8
    Ok((2.83..5.66).contains(&(twice / once)))
}

/// An extremum that is near zero: the same, or one that is closer to it, as far as its place is not known so well; with the value 0 where that is
/// zero but for rounding.
fn touched(
    function: &mut Function<'_, StepError>,
    extremum: Point,
    by: f64,
    rounding: f64,
) -> Result<Point, StepError> {
    if extremum.value == 0.0 {
        return Ok(extremum);
    }
    let sign = extremum.value.signum();
    let [left, right] = [extremum.at - by, extremum.at + by];
    let [left, right] = [(left, function(left)?), (right, function(right)?)]
        .map(|(at, value)| Point { at, value: sign * value });
    let middle = Point { value: sign * extremum.value, ..extremum };
    // where it is farthest from zero, between two zeros that lie close together, it does not touch it
    if left.value <= middle.value || right.value <= middle.value {
        return Ok(extremum);
    }
    let noise = rounding + 2.0 * spread(function, extremum.at, left.at, right.at)?;
    if middle.value <= noise {
        return Ok(Point { value: 0.0, ..extremum });
    }
    let least = dip(&mut |at| function(at).map(|value| sign * value), left, middle, right)?;
    Ok(least.map_or(extremum, |least| match least.value.abs() <= noise {
        true => Point { value: 0.0, ..least },
        false => Point { value: sign * least.value, ..least },
    }))
}

/// How much values differ that are so close to each other that only their rounding differs.
fn spread(function: &mut Function<'_, StepError>, at: f64, left: f64, right: f64) -> Result<f64, StepError> {
    let by = 1e-9 * (right - left);
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in -2_i32..=2 {
        let value = function((at + f64::from(k) * by).clamp(left, right))?;
        (least, most) = (least.min(value), most.max(value));
    }
    Ok(most - least)
}
