//! Power series of a motion: what is generated, and how their coefficients are computed.

use core::fmt;

use super::System;
use super::input::{Polynomial, driven};
use super::length::{Checked, Length, Look, Rule, Terms, defect, noise, perturb, size};
use crate::kernel::Blocks;
use crate::scalar::simd::lanes::Processor;
use crate::scalar::{Batch, Components, LongWork, Real, Scalar, Work};

/// The highest order of a Taylor step: more than doubles have digits for.
pub(crate) const MOST_COEFFICIENTS: usize = 32;

/// Of a polynomial in time.
pub(crate) type Coefficients = [f64; MOST_COEFFICIENTS + 1];

/// The power series of a system's motion, by recurrences. Implemented by descriptions with the key `taylor`.
///
/// What has a series are the element of the group by which a step moves the configuration, its translations of the spaces of advected parameters, and what the
/// motion is made of. Each product of two series is a *lane*; all lanes are summed side by side.
#[diagnostic::on_unimplemented(
    message = "there are no power series of the motion of `{Self}`",
    note = "they are generated with the key `taylor` in the description"
)]
pub trait PowerSeries: System {
    /// What depends on state, time and control at the start of a step.
    type Kept<T: Scalar>: Components<T>;
    /// A number for everything that has a series.
    type Coefficients<T: Scalar>: Components<T>;
    /// A number for each lane, and some that are nobody's: so many that they fill registers.
    type Lanes<T: Scalar>: Components<T>;
    /// A number for each different operand of the lanes.
    type Operands<T: Scalar>: Components<T>;
    /// The velocity at the start, where it has a series, and the rates of the controls, where these have; else nothing.
    type Velocity<T: Scalar>: Components<T>;
    /// A number for each event of the description that has a series.
    type Events<T: Scalar>: Components<T>;

    /// The lengths of the blocks of what has a series that have a unit in common.
    const BLOCKS: Blocks;
    /// Where the controls stand among what has a series; none where they have no part in the motion.
    const CONTROLS: Option<usize> = None;
    /// Where the rates stand at which the controls change, if the velocity depends on them; these are the last numbers of its start.
    const RATES: Option<usize> = None;
    /// The places of the events that have a series among those of the description.
    const EVENTS_WITH_SERIES: &'static [usize] = &[];

    /// The velocity at the start of a step, if it has a series, with controls that are held.
    fn start_velocity(
        &self,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
    ) -> Self::Velocity<Self::Scalar>;
    /// The coefficients of order 0.
    fn leading<T: Scalar>(
        parameters: &Self::Parameters<T>,
        state: &Self::StateComponents<T>,
        time: T,
        control: &Self::ControlComponents<T>,
        velocity: &Self::Velocity<T>,
    ) -> Leading<Self, T>;
    /// The coefficients of one order, from those of what has a series and the lanes' sums of lower ones.
    fn next<T: Scalar>(
        kept: &Self::Kept<T>,
        coefficients: &Self::Coefficients<T>,
        sums: &Self::Lanes<T>,
        order: T,
    ) -> Next<Self, T>;
    /// Both operands of each lane.
    fn lanes<T: Scalar>(operands: &Self::Operands<T>) -> [Self::Lanes<T>; 2];
    /// The sums of the products of all lanes, from one pair of orders to the next.
    fn sums<'s, T: Scalar>(
        terms: impl Iterator<Item = (&'s Self::Operands<T>, &'s Self::Operands<T>)> + Clone,
    ) -> Self::Lanes<T>;
    /// The changes of what has a series, where it has come to.
    fn rate<T: Scalar>(kept: &Self::Kept<T>, end: &Self::Coefficients<T>) -> Self::Coefficients<T>;
    /// The state where the step has come to.
    fn finish<T: Scalar>(kept: &Self::Kept<T>, end: &Self::Coefficients<T>) -> Self::StateComponents<T>;
}

/// What looks at a system's power series, where there are any.
pub trait SeriesVisitor<S> {
    /// What it makes of them.
    type Output;
    /// Makes it.
    fn visit(self) -> Self::Output
    where
        S: PowerSeries;
}

/// The coefficients of order 0 of a motion.
pub struct Leading<S: PowerSeries, T: Scalar> {
    /// What later orders need again.
    pub kept: S::Kept<T>,
    /// What has a series.
    pub start: S::Coefficients<T>,
    /// Its change.
    pub change: S::Coefficients<T>,
    /// The events.
    pub events: S::Events<T>,
}

/// The coefficients of one order of a motion.
pub struct Next<S: PowerSeries, T: Scalar> {
    /// Of the changes of what has a series.
    pub change: S::Coefficients<T>,
    /// Of the operands of the lanes.
    pub operands: S::Operands<T>,
    /// Of the events.
    pub events: S::Events<T>,
}

impl<S: PowerSeries, T: Scalar> fmt::Debug for Next<S, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Next").field("change", &self.change).finish_non_exhaustive()
    }
}

impl<S: PowerSeries, T: Scalar> fmt::Debug for Leading<S, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Leading")
            .field("start", &self.start)
            .field("change", &self.change)
            .finish_non_exhaustive()
    }
}

/// The operands of all lanes of one order, as wide registers like them.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Row<L>(L);

/// Where there is room for all orders.
pub(crate) trait Room {
    /// Something for each order.
    type Orders<X: Copy + Send + Sync>: AsRef<[X]> + AsMut<[X]> + Clone + Send + Sync;
    /// What is multiplied.
    type Factors<S: PowerSeries, T: Batch>: Factors<S, T>;
    /// The same for each order.
    fn all<X: Copy + Send + Sync>(value: X) -> Self::Orders<X>;
}

/// The operands of all lanes, order by order.
pub(crate) trait Factors<S: PowerSeries, T: Batch>: Clone + Send + Sync {
    fn new() -> Self;
    /// Puts those of an order in their place.
    fn put(&mut self, order: usize, operands: &S::Operands<T>);
    /// `Σ_j a_j b_{k−j}` from 1 to `k − 1` of all lanes, in this order.
    fn sums<P: Processor>(&self, k: usize) -> S::Lanes<T>;
}

/// Room within the series, for numbers alone.
pub(crate) struct Within;

impl Room for Within {
    type Orders<X: Copy + Send + Sync> = [X; MOST_COEFFICIENTS + 1];
    type Factors<S: PowerSeries, T: Batch> = Rows<S, T>;

    #[inline(always)]
    fn all<X: Copy + Send + Sync>(value: X) -> Self::Orders<X> {
        [value; MOST_COEFFICIENTS + 1]
    }
}

/// Both operands of all lanes, whose sums are side by side in registers.
pub(crate) struct Rows<S: PowerSeries, T: Batch> {
    left: [Row<S::Lanes<T>>; MOST_COEFFICIENTS],
    right: [Row<S::Lanes<T>>; MOST_COEFFICIENTS],
}

impl<S: PowerSeries, T: Batch> Clone for Rows<S, T> {
    fn clone(&self) -> Self {
        Self { left: self.left, right: self.right }
    }
}

impl<S: PowerSeries, T: Batch> Factors<S, T> for Rows<S, T> {
    fn new() -> Self {
        let rows = [Row(S::Lanes::splat(T::of(0.0))); MOST_COEFFICIENTS];
        Self { left: rows, right: rows }
    }

    #[inline(always)]
    fn put(&mut self, order: usize, operands: &S::Operands<T>) {
        [self.left[order].0, self.right[order].0] = S::lanes(operands);
    }

    #[inline(always)]
    fn sums<P: Processor>(&self, k: usize) -> S::Lanes<T> {
        let mut sums = S::Lanes::splat(T::of(0.0));
        match P::DOUBLES {
            8 if T::PAIRS => self.multiply_by::<P, 8>(k, &mut sums),
            4 if T::PAIRS => self.multiply_by::<P, 4>(k, &mut sums),
            2 if T::PAIRS => self.multiply_by::<P, 2>(k, &mut sums),
            _ => {
                for (lane, sum) in sums.as_mut().iter_mut().enumerate() {
                    self.terms(k, |a, b| *sum = a.as_ref()[lane].mul_add(b.as_ref()[lane], *sum));
                }
            }
        }
        sums
    }
}

impl<S: PowerSeries, T: Batch> Rows<S, T> {
    #[inline(always)]
    fn multiply_by<P: Processor, const W: usize>(&self, k: usize, sums: &mut S::Lanes<T>) {
        let mut at = 0;
        while at + 4 * W <= S::Lanes::<T>::LENGTH {
            self.multiply_registers::<P, W, 4>(k, at, sums);
            at += 4 * W;
        }
        while at + 2 * W <= S::Lanes::<T>::LENGTH {
            self.multiply_registers::<P, W, 2>(k, at, sums);
            at += 2 * W;
        }
        while at + W <= S::Lanes::<T>::LENGTH {
            self.multiply_registers::<P, W, 1>(k, at, sums);
            at += W;
        }
    }

    #[inline(always)]
    fn multiply_registers<P: Processor, const W: usize, const N: usize>(
        &self,
        k: usize,
        at: usize,
        sums: &mut S::Lanes<T>,
    ) {
        let load = |lanes: &S::Lanes<T>, n: usize| {
            let mut numbers = [T::Number::of(0.0); W];
            for (number, x) in numbers.iter_mut().zip(&lanes.as_ref()[at + n * W..][..W]) {
                *number = x.lane(0);
            }
            numbers
        };
        let mut sum = [[T::Number::of(0.0); W]; N];
        self.terms(k, |a, b| {
            for (n, sum) in sum.iter_mut().enumerate() {
                *sum = P::mul_add(&load(a, n), &load(b, n), sum);
            }
        });
        for (n, numbers) in sum.into_iter().enumerate() {
            for (sum, number) in sums.as_mut()[at + n * W..][..W].iter_mut().zip(numbers) {
                sum.set_lane(0, number);
            }
        }
    }

    /// The pairs `a_j`, `b_{k−j}`.
    #[inline(always)]
    fn terms(&self, k: usize, mut term: impl FnMut(&S::Lanes<T>, &S::Lanes<T>)) {
        for (a, b) in self.left[1..k].iter().zip(self.right[1..k].iter().rev()) {
            term(&a.0, &b.0);
        }
    }
}

/// Room on the heap, for numbers side by side, which may be too many for a stack.
#[cfg(all(feature = "std", target_arch = "x86_64"))]
pub(crate) struct Heap;

#[cfg(all(feature = "std", target_arch = "x86_64"))]
impl Room for Heap {
    type Orders<X: Copy + Send + Sync> = std::vec::Vec<X>;
    type Factors<S: PowerSeries, T: Batch> = Columns<S, T>;

    fn all<X: Copy + Send + Sync>(value: X) -> Self::Orders<X> {
        std::vec![value; MOST_COEFFICIENTS + 1]
    }
}

/// Each operand once: so they fit the fastest memory, and one that is loaded is multiplied by several others.
#[cfg(all(feature = "std", target_arch = "x86_64"))]
pub(crate) struct Columns<S: PowerSeries, T: Batch>(std::vec::Vec<S::Operands<T>>);

#[cfg(all(feature = "std", target_arch = "x86_64"))]
impl<S: PowerSeries, T: Batch> Clone for Columns<S, T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
impl<S: PowerSeries, T: Batch> Factors<S, T> for Columns<S, T> {
    fn new() -> Self {
        Self(Heap::all(S::Operands::splat(T::of(0.0))))
    }

    #[inline(always)]
    fn put(&mut self, order: usize, operands: &S::Operands<T>) {
        self.0[order] = *operands;
    }

    #[inline(always)]
    fn sums<P: Processor>(&self, k: usize) -> S::Lanes<T> {
        S::sums(self.0[1..k].iter().zip(self.0[1..k].iter().rev()))
    }
}

/// The power series of one step, and room for what they are made of.
pub(crate) struct Series<S: PowerSeries, T: Batch, R: Room = Within> {
    kept: S::Kept<T>,
    /// What is kept of a start that is rounded otherwise.
    perturbed: Option<S::Kept<T>>,
    factors: R::Factors<S, T>,
    coefficients: R::Orders<S::Coefficients<T>>,
    events: R::Orders<S::Events<T>>,
    order: usize,
    rule: Rule,
    /// Whether the controls are held.
    is_held: bool,
}

impl<S: PowerSeries, T: Batch> Clone for Series<S, T> {
    fn clone(&self) -> Self {
        let Self { kept, perturbed, coefficients, events, order, rule, is_held, .. } = *self;
        Self { kept, perturbed, factors: self.factors.clone(), coefficients, events, order, rule, is_held }
    }
}

impl<S: PowerSeries, T: Batch, R: Room> Series<S, T, R> {
    /// Room for series of this order.
    pub(crate) fn new(order: usize) -> Self {
        let zero = T::of(0.0);
        let coefficients = R::all(S::Coefficients::splat(zero));
        let events = R::all(S::Events::splat(zero));
        let (kept, factors) = (S::Kept::splat(zero), R::Factors::new());
        let rule = Rule::new(order, T::EPSILON);
        Self { kept, perturbed: None, factors, coefficients, events, order, rule, is_held: true }
    }

    pub(crate) fn order(&self) -> usize {
        self.order
    }

    pub(crate) fn set_order(&mut self, order: usize) {
        self.order = order;
    }

    /// Computes all coefficients of the motion from a state on.
    #[inline(always)]
    fn expand<P: Processor>(&mut self, start: &Start<'_, S, T>) {
        let Start { parameters, state, time, control, velocity, input } = start;
        let Leading { kept, start, change, events } = S::leading(parameters, state, *time, control, velocity);
        (self.kept, self.perturbed, self.is_held) = (kept, None, input.is_none());
        let coefficients = self.coefficients.as_mut();
        (coefficients[0], coefficients[1], self.events.as_mut()[0]) = (start, change, events);
        self.drive(*input, 1);
        for k in 1..self.order.min(MOST_COEFFICIENTS) {
            let sums = self.factors.sums::<P>(k);
            let Next { mut change, operands, events } =
                S::next(&self.kept, &self.coefficients.as_ref()[k], &sums, T::of(k as f64));
            self.factors.put(k, &operands);
            self.events.as_mut()[k] = events;
            let share = T::of(1.0 / (k as f64 + 1.0));
            for x in change.as_mut() {
                *x = *x * share;
            }
            self.coefficients.as_mut()[k + 1] = change;
            self.drive(*input, k + 1);
        }
    }

    /// Puts the coefficients of one order of an input in the place of those of controls that are held.
    #[inline(always)]
    fn drive(&mut self, input: Option<&Input<S>>, order: usize) {
        let Some(input) = input else { return };
        let coefficients = self.coefficients.as_mut()[order].as_mut();
        for (place, order, factor) in driven(order, [S::CONTROLS, S::RATES]) {
            let numbers = input.order(order).map_or(&[][..], |numbers| numbers.as_ref());
            for (to, number) in coefficients.iter_mut().skip(place).zip(numbers) {
                *to = T::of(factor * *number);
            }
        }
    }

    /// The values a time `h` after the start.
    #[inline(always)]
    fn sum(&self, h: T) -> S::Coefficients<T> {
        let coefficients = self.coefficients.as_ref();
        let mut sum = coefficients[self.order];
        for k in (0..self.order).rev() {
            for (x, &c) in sum.as_mut().iter_mut().zip(coefficients[k].as_ref()) {
                *x = x.mul_add(h, c);
            }
        }
        sum
    }

    /// The same, and their derivatives by time.
    #[inline(always)]
    fn sum_and_slope(&self, h: T) -> [S::Coefficients<T>; 2] {
        let coefficients = self.coefficients.as_ref();
        let (mut sum, mut slope) = (coefficients[self.order], S::Coefficients::splat(T::of(0.0)));
        for k in (0..self.order).rev() {
            let terms = sum.as_mut().iter_mut().zip(slope.as_mut()).zip(coefficients[k].as_ref());
            for ((x, slope), &c) in terms {
                *slope = slope.mul_add(h, *x);
                *x = x.mul_add(h, c);
            }
        }
        [sum, slope]
    }

    /// How far the series miss their equation where they have come to, in a step of this length: see [`defect`].
    #[inline(always)]
    fn defect_at(
        &self,
        end: &S::Coefficients<T>,
        slope: &S::Coefficients<T>,
        perturbed: Option<&S::Coefficients<T>>,
        step: T,
    ) -> T {
        let ([zeroth, first, ..], rate) = (self.coefficients.as_ref(), S::rate(&self.kept, end)) else {
            return T::of(0.0);
        };
        let (mut sizes, mut misses) = (*zeroth, *slope);
        // each by itself, so that they are computed side by side
        for ((x, first), end) in sizes.as_mut().iter_mut().zip(first.as_ref()).zip(end.as_ref()) {
            *x = size(*x, *first, *end, step);
        }
        for (x, rate) in misses.as_mut().iter_mut().zip(rate.as_ref()) {
            *x = (*x - *rate).abs();
        }
        if let Some(perturbed) = perturbed {
            for ((x, rate), perturbed) in
                misses.as_mut().iter_mut().zip(rate.as_ref()).zip(perturbed.as_ref())
            {
                *x = *x - noise(*rate, *perturbed);
            }
        }
        defect(S::BLOCKS, S::CONTROLS, [sizes.as_ref(), misses.as_ref()], step, self.rule.allowed)
    }

    /// Keeps what a start is that rounding has left elsewhere.
    #[inline(always)]
    fn perturb(&mut self, start: &Start<'_, S, T>) {
        let Start { parameters, state, time, control, velocity, .. } = start;
        let (mut state, mut time) = (**state, [*time]);
        perturb(state.as_mut(), 0);
        perturb(&mut time, S::StateComponents::<T>::LENGTH);
        self.perturbed = Some(S::leading(parameters, &state, time[0], control, velocity).kept);
    }

    /// The state a time `h` after the start.
    #[inline(always)]
    pub(crate) fn state(&self, h: T) -> S::StateComponents<T> {
        S::finish(&self.kept, &self.sum(h))
    }
}

impl<S: PowerSeries, T: Real> Series<S, T> {
    /// Writes the series of an event of the description in shares of a step of this length, the constant coefficient first, and how many coefficients
    /// there are. None if the event has no series.
    pub(crate) fn event(&self, event: usize, step: f64, coefficients: &mut Coefficients) -> Option<usize> {
        let place = S::EVENTS_WITH_SERIES.iter().position(|known| *known == event)?;
        let mut power = 1.0;
        for (coefficient, events) in coefficients.iter_mut().zip(self.events.as_ref().iter().take(self.order))
        {
            *coefficient = events.as_ref().get(place)?.to_f64() * power;
            power *= step;
        }
        Some(self.order)
    }

    /// Takes the series that lie in a lane of others, of the same order.
    #[cfg(all(feature = "std", target_arch = "x86_64"))]
    pub(crate) fn take_lane<L: Batch, R: Room>(&mut self, of: &Series<S, L, R>, lane: usize) {
        let take = |to: &mut [T], from: &[L]| {
            to.iter_mut().zip(from).for_each(|(to, from)| *to = T::of(from.lane(lane).to_f64()));
        };
        self.is_held = of.is_held;
        take(self.kept.as_mut(), of.kept.as_ref());
        for (to, from) in self.coefficients.iter_mut().zip(of.coefficients.as_ref()) {
            take(to.as_mut(), from.as_ref());
        }
        for (to, from) in self.events.iter_mut().zip(of.events.as_ref()) {
            take(to.as_mut(), from.as_ref());
        }
    }
}

impl<S: PowerSeries, T: Batch, R: Room> Terms for Series<S, T, R> {
    type Each<X: Copy + Send + Sync> = T::Each<X>;

    #[inline(always)]
    fn each(value: f64) -> T::Each<f64> {
        T::all(value)
    }

    #[inline(always)]
    fn last(&self) -> usize {
        self.order
    }

    #[inline(always)]
    fn blocks(&self) -> &[usize] {
        S::BLOCKS
    }

    #[inline(always)]
    fn held(&self) -> usize {
        let from = if self.is_held { S::CONTROLS } else { S::RATES };
        from.unwrap_or(S::Coefficients::<T>::LENGTH)
    }

    #[inline(always)]
    fn largest(&self, order: usize, from: usize, length: usize) -> T::Each<f64> {
        let mut largest = T::all(0.0);
        for x in &self.coefficients.as_ref()[order].as_ref()[from..from + length] {
            for (lane, largest) in largest.as_mut().iter_mut().enumerate() {
                let size = x.lane(lane).to_f64().abs();
                *largest = if size > *largest { size } else { *largest };
            }
        }
        largest
    }

    #[inline(always)]
    fn rule(&self) -> Rule {
        self.rule
    }

    #[inline(always)]
    fn defect(&mut self, at: &T::Each<f64>, step: &T::Each<f64>) -> T::Each<f64> {
        let [end, slope] = self.sum_and_slope(of_lanes(at));
        let mut perturbed = None;
        if let Some(kept) = &self.perturbed {
            let mut end = end;
            perturb(end.as_mut(), S::StateComponents::<T>::LENGTH + 1);
            perturbed = Some(S::rate(kept, &end));
        }
        let defect = self.defect_at(&end, &slope, perturbed.as_ref(), of_lanes(step));
        T::each(|lane| defect.lane(lane).to_f64())
    }
}

/// A number for each lane.
#[inline(always)]
fn of_lanes<T: Batch>(numbers: &T::Each<f64>) -> T {
    let mut lanes = T::of(0.0);
    for (lane, number) in numbers.as_ref().iter().enumerate() {
        lanes.set_lane(lane, T::Number::of(*number));
    }
    lanes
}

/// Where a step starts.
pub(crate) struct Start<'s, S: System + PowerSeries, T: Scalar> {
    pub(crate) parameters: &'s S::Parameters<T>,
    pub(crate) state: &'s S::StateComponents<T>,
    pub(crate) time: T,
    pub(crate) control: &'s S::ControlComponents<T>,
    pub(crate) velocity: &'s S::Velocity<T>,
    /// What drives the controls, if they are not held.
    pub(crate) input: Option<&'s Input<S>>,
}

/// Writes the rates at which an input changes at the start, to the last numbers of a velocity there.
#[inline(always)]
pub(crate) fn write_rates<S: PowerSeries, T: Scalar>(
    velocity: &mut S::Velocity<T>,
    input: Option<&Input<S>>,
) {
    let (Some(rates), Some(_)) = (input.and_then(|input| input.order(1)), S::RATES) else { return };
    for (to, rate) in velocity.as_mut().iter_mut().rev().zip(rates.as_ref().iter().rev()) {
        *to = T::of(*rate);
    }
}

/// An input as a power series.
pub(crate) type Input<S> = Polynomial<<S as System>::ControlComponents<f64>>;

/// One step, or some side by side: its series, how long it may be, and where it leads.
pub(crate) struct Advance<'s, S: PowerSeries, T: Batch, R: Room> {
    pub(crate) series: &'s mut Series<S, T, R>,
    pub(crate) start: Start<'s, S, T>,
    /// The length of the step before, if there was one.
    pub(crate) before: T::Each<Option<f64>>,
    /// How long it has to be, or may be at most, backwards in time if negative.
    pub(crate) length: T::Each<Length>,
}

impl<S: PowerSeries, T: Batch, R: Room> LongWork for Advance<'_, S, T, R> {
    type CallSite = S::Kept<T>;
    /// The step, and the state at its end.
    type Result = (Checked<T::Each<f64>>, S::StateComponents<T>);

    #[inline(always)]
    fn done<P: Processor>(self) -> Self::Result {
        let Self { series, start, before, length } = self;
        series.expand::<P>(&start);
        let [steps, natural] = series.step(before.as_ref(), length.as_ref());
        let [mut end, slope] = series.sum_and_slope(of_lanes(&steps));
        let defect = series.defect_at(&end, &slope, None, of_lanes(&steps));
        let look = T::each(|lane| {
            let [step, natural] = [&steps, &natural].map(|steps| steps.as_ref()[lane]);
            Look::at(length.as_ref()[lane], [step, natural], defect.lane(lane).to_f64())
        });
        let mut checked = Checked { steps, shares: T::all(f64::INFINITY) };
        if look.as_ref().iter().any(|look| *look != Look::No) {
            checked = T::dispatch(Shorten { series: &mut *series, start, steps, look });
            end = series.sum_and_slope(of_lanes(&checked.steps))[0];
        }
        (checked, S::finish(&series.kept, &end))
    }
}

/// Steps over which the series may not keep to their equation: [`Terms::shorten`].
struct Shorten<'a, 's, S: PowerSeries, T: Batch, R: Room> {
    series: &'a mut Series<S, T, R>,
    start: Start<'s, S, T>,
    steps: T::Each<f64>,
    look: T::Each<Look>,
}

impl<S: PowerSeries, T: Batch, R: Room> Work for Shorten<'_, '_, S, T, R> {
    type CallSite = S::Kept<T>;
    type Result = Checked<T::Each<f64>>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { series, start, steps, look } = self;
        series.perturb(&start);
        let time = T::each(|lane| start.time.lane(lane).to_f64());
        series.shorten(&steps, look.as_ref(), time.as_ref())
    }
}
