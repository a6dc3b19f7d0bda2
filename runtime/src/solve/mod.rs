//! Solves the equations of successive steps, `left(x) = right(x)`.
//!
//! Successive solutions are samples of a smooth trajectory: the [`predictor`] continues them by one step, and in small steps the next solution
//! is known to many digits before anything is solved. One fixed-point iteration `x ← L⁻¹ right(x)` takes off the factor by which it contracts,
//! about the angle turned in a step, and mostly brings what is left below rounding ([`one_step`]). Whether it did is seen at every step: its
//! change, relative to the unknown as it is now ([`stopping`]), times the rate of contraction. Where it did not there are a few more
//! ([`fixed_point`]), if that promises to do, or else [Newton's iteration](newton). What is remembered saves time, and nothing else.

mod damped;
mod fixed_point;
mod newton;
pub(crate) mod one_step;
pub(crate) mod predictor;
pub(crate) mod stopping;
pub(crate) mod terms;

use crate::kernel::{Components, Evaluation, Kernel};
use crate::scalar::{Batch, Mask, Real, Work};
use crate::simd::lanes::{Portable, Processor};
use fixed_point::{Iterated, Open, SHARP};
use predictor::{Predictor, RECENT, WINDOW};
use stopping::{change, select};

/// Steps between two calibrations: at first, and in the long run.
const INTERVALS: [u32; 2] = [WINDOW as u32, 1024];
/// Fixed-point iterations are made if they contract at least by this.
const STRONG: f64 = 0.25;
/// What the rate of contraction is multiplied by, for it may grow until it is measured again.
const SAFETY: f64 = 2.0;
/// An error of the unknown this small, in units of epsilon, is roundoff, and never is one that is larger than this.
const ROUNDOFF: [f64; 2] = [2.0, 8.0];
/// An error this small, in units of epsilon, makes no difference to the state, next to what is rounded there. The unknown changes the state
/// by about as much as iterations contract: by the angle turned in a step.
const NO_DIFFERENCE: f64 = 0.1;
/// The change of the last iteration, in units of epsilon. Not less, if only for rounding; not more, for what is evaluated before it serves for
/// the solution too.
const LAST_CHANGE: [f64; 2] = [8.0, 128.0];
/// A prediction that is off by more than this has missed something: the solutions before are no guide.
const MISSED: f64 = 1e-9;
/// How far a prediction was off where there was none: finite, so that what is remembered can be written in any format.
const NONE: f64 = 1e30;
/// By how much more it is then off than the last one that missed.
const SUDDENLY: f64 = 8.0;
/// A prediction that is off by more than this is not used.
const LOST: f64 = 0.1;

/// A solution of the step's equation.
#[derive(Clone, Copy)]
pub(crate) struct Solution<T: Batch, U, I> {
    /// The unknown.
    pub unknown: U,
    /// The equation evaluated there, or so near that it makes no difference.
    pub evaluation: Evaluation<U, I>,
    /// How it was found.
    pub convergence: Convergence<T>,
    /// The lanes in which the residual did not come down to roundoff.
    pub unsolved: T::Mask,
}

/// The solution of a kernel's equation.
pub(crate) type SolutionOf<T, K> = Solution<T, <K as Kernel<T>>::Unknown, <K as Kernel<T>>::Iterate>;

/// What is remembered of the solutions of earlier steps.
#[derive(Clone, Copy)]
pub(crate) struct Solver<T: Batch, U> {
    /// The earlier solutions, and where they point.
    predictor: Predictor<T, U>,
    /// The next prediction.
    prediction: U,
    /// Steps until the next calibration.
    due: u32,
    /// Steps from the next calibration to the one after it.
    interval: u32,
    /// The factor by which the fixed-point iteration contracts, as far as it is known.
    rate: T,
    /// The relative change of a last iteration; negative where iterations do not contract strongly.
    tolerance: T,
    /// Whether they do in any lane.
    is_strong: bool,
    /// How many solutions the prediction continues while these are few; zero since it was calibrated.
    order: T,
    /// How far the last prediction was off that was off too far.
    missed: T,
}

/// Remembers nothing.
impl<T: Batch, U: Components<T>> Default for Solver<T, U> {
    fn default() -> Self {
        let mut solver = Self {
            predictor: Predictor::default(),
            prediction: U::splat(T::of(0.0)),
            due: INTERVALS[0],
            interval: INTERVALS[0],
            rate: T::of(0.0),
            tolerance: T::of(0.0),
            is_strong: true,
            order: T::of(1.0),
            missed: T::of(NONE),
        };
        solver.set_rate(T::of(STRONG));
        solver
    }
}

/// How a step's equation was solved.
#[derive(Clone, Copy)]
pub(crate) struct Convergence<T: Batch> {
    /// Iterations made.
    pub iterations: T::Each<u32>,
    /// The residual left, relative to the equation's terms.
    pub residual: T,
    /// The lanes in which there were fixed-point iterations.
    tried: T::Mask,
    /// How far the prediction was off: the relative change of the first iteration, or of the first of Newton's corrections.
    off: T,
    /// The factor by which fixed-point iterations contracted at least, as far as that can be told from roundoff; zero where it cannot.
    rate: T,
    /// Where nothing of that is roundoff.
    is_sharp: T::Mask,
}

impl<T: Batch> Convergence<T> {
    /// That of one iteration, of which the residual is no more than that.
    #[inline(always)]
    fn of_one(residual: T) -> Self {
        let (none, nothing) = (T::Mask::splat(false), T::of(0.0));
        Self { iterations: T::all(1), residual, tried: none, off: nothing, rate: nothing, is_sharp: none }
    }

    /// With what Newton's iteration did after it in the lanes that had not been `solved`.
    #[inline(always)]
    fn then(&self, newton: &Self, solved: T::Mask) -> Self {
        Self {
            iterations: sum::<T>(self.iterations, newton.iterations),
            residual: T::select(solved, self.residual, newton.residual),
            off: T::select(solved | self.tried, self.off, newton.off),
            ..*self
        }
    }
}

impl<T: Batch, U: Components<T>> Solver<T, U> {
    /// Whether there is nothing to solve for: known when the code is compiled.
    pub(crate) const IS_IDLE: bool = U::LENGTH == 0;

    /// Whether the next step is to be tried on the fast path: where iterations contract strongly, or it is to be seen whether they do.
    #[inline(always)]
    pub(crate) fn is_fast(&self) -> bool {
        Self::IS_IDLE || ((self.is_strong || self.due == 0) && self.predictor.count() > 0)
    }

    /// The next calibration is after so many steps, or in the next one.
    #[inline(always)]
    pub(crate) fn expected(&self) -> u64 {
        if const { Self::IS_IDLE } { u64::MAX } else { self.due.max(1).into() }
    }

    /// The relative change of a last iteration on the fast path; negative where iterations do not contract strongly, and for calibration.
    #[inline(always)]
    pub(crate) fn limit(&self) -> T {
        if self.due == 0 { T::of(-1.0) } else { self.tolerance }
    }

    /// Where the earlier solutions point.
    #[inline(always)]
    pub(crate) fn prediction(&self) -> U {
        self.prediction
    }

    /// Where the solutions will point after this one.
    #[inline(always)]
    pub(crate) fn next<P: Processor>(&self, solution: &U) -> U {
        self.predictor.then(&self.predictor.begun::<P>(), solution)
    }

    /// Remembers the solution of a step on the fast path.
    #[inline(always)]
    pub(crate) fn keep<P: Processor>(&mut self, solution: &U) {
        if const { !Self::IS_IDLE } {
            self.predictor.push::<P>(solution);
        }
    }

    /// There were so many steps on the fast path, after which this is the prediction.
    #[inline(always)]
    pub(crate) fn took(&mut self, steps: u64, prediction: &U) {
        self.due = u64::from(self.due).saturating_sub(steps) as u32;
        self.predictor.count_more(steps);
        self.prediction = *prediction;
    }

    /// How the equation of a step is solved on the fast path, with a bound for the residual.
    #[inline(always)]
    pub(crate) fn on_fast_path(&self) -> Convergence<T> {
        if const { Self::IS_IDLE } {
            Convergence { iterations: T::all(0), ..Convergence::of_one(T::of(0.0)) }
        } else {
            Convergence::of_one(self.rate * self.tolerance)
        }
    }

    /// Whether there is anything to forget.
    #[inline(always)]
    pub(crate) fn remembers(&self) -> bool {
        self.predictor.count() > 0
    }

    /// Forgets all.
    #[inline(always)]
    pub(crate) fn forget(&mut self) {
        self.predictor.forget();
        (self.due, self.interval) = (INTERVALS[0], INTERVALS[0]);
        self.set_rate(T::of(STRONG));
        (self.order, self.missed) = (T::of(1.0), T::of(NONE));
    }

    /// The latest solution.
    pub(crate) fn latest(&self) -> U {
        self.predictor.latest()
    }

    #[inline(always)]
    fn set_rate(&mut self, rate: T) {
        let bound = T::of(SAFETY) * rate;
        let error = clamped(T::of(NO_DIFFERENCE) / bound, ROUNDOFF);
        let tolerance = T::of(T::EPSILON) * clamped(error / bound, LAST_CHANGE);
        let strong = rate.le(T::of(STRONG));
        self.rate = rate;
        self.tolerance = T::select(strong, tolerance, T::of(-1.0));
        self.is_strong = strong.any();
    }

    /// Solves a step's equation by whatever it takes; `first` is where an iteration from the prediction led to.
    #[inline(always)]
    pub(crate) fn solve<K>(
        &self,
        kernel: &K,
        state: &K::State,
        step: &K::Step,
        first: Option<U>,
    ) -> SolutionOf<T, K>
    where
        K: Kernel<T, Unknown = U>,
    {
        let (none, prediction) = (T::Mask::splat(false), &self.prediction);
        if const { Self::IS_IDLE } {
            let evaluation = kernel.evaluate(state, step, prediction);
            let convergence = self.on_fast_path();
            return Solution { unknown: *prediction, evaluation, convergence, unsolved: none };
        }
        let mut left = None;
        if let (true, Some(first)) = (const { K::HAS_FIXED_POINT_UPDATE }, first) {
            match fixed_point::iterate(kernel, state, step, self, &first) {
                Iterated::Solved(unknown, evaluation, convergence) => {
                    return Solution { unknown, evaluation, convergence, unsolved: none };
                }
                Iterated::Open(open) => left = Some(open),
            }
        }
        let mut from = kernel.start(state, step);
        if self.predictor.count() == 0 {
            return newton::solve(kernel, state, step, &from, !none);
        }
        let is_near = change::<T, _>(K::BLOCKS, prediction, &from).le(T::of(1.0));
        let Some(Open { point, unknown, open, convergence }) = left else {
            // from the prediction, unless that is far off
            from = select(is_near, prediction, &from);
            return newton::solve(kernel, state, step, &from, !none);
        };
        // from where iterations led to, unless the prediction was far off
        let iterated = convergence.tried & convergence.off.le(T::of(LOST));
        from = select(iterated, &unknown, &select(!convergence.tried & is_near, prediction, &from));
        from = select(open, &from, &point);
        let solution = newton::solve(kernel, state, step, &from, open);
        let convergence = convergence.then(&solution.convergence, !open);
        Solution { unknown: select(open, &solution.unknown, &unknown), convergence, ..solution }
    }

    /// The solution of a step's equation from nothing that is remembered. None if it is not found.
    #[cfg(feature = "std")]
    pub(crate) fn cold<K: Kernel<T, Unknown = U>>(kernel: &K, state: &K::State, step: &K::Step) -> Option<U> {
        let start = kernel.start(state, step);
        if const { Self::IS_IDLE } {
            return Some(start);
        }
        let solution = newton::solve(kernel, state, step, &start, T::Mask::splat(true));
        (!solution.unsolved.any()).then_some(solution.unknown)
    }

    /// Whether the rate of contraction is to be measured, by one more iteration.
    #[inline(always)]
    fn measures(&self) -> bool {
        self.due == 0 || self.predictor.count() <= 2
    }

    /// The lanes in which fixed-point iterations are to be made: where they contract strongly, and where it is to be seen whether they do.
    #[inline(always)]
    fn tries(&self) -> T::Mask {
        T::of(0.0).lt(self.tolerance) | T::Mask::splat(self.due == 0)
    }

    /// Remembers the solution of a step that one iteration did not solve as expected, and learns from it.
    pub(crate) fn learn(&mut self, solution: &U, blocks: &'static [usize], convergence: &Convergence<T>) {
        if const { Self::IS_IDLE } {
            return;
        }
        T::dispatch(Learn { solver: self, solution, blocks, convergence });
    }

    #[inline(always)]
    fn learned(&mut self, solution: &U, blocks: &[usize], convergence: &Convergence<T>) {
        let one = T::of(1.0);
        let Convergence { tried, off, rate, is_sharp, .. } = *convergence;
        if self.predictor.count() == 0 {
            // the next solution is as near to it as any
            self.missed = T::select(T::of(0.0).lt(off), off, self.missed);
            self.prediction = *solution;
            self.due -= 1;
            self.predictor.push::<Portable>(solution);
            self.predictor.count_more(1);
            return;
        }
        let open = T::of(0.0).lt(off) & (!tried | !off.le(self.tolerance));
        // if it is smaller than it was, that may be by chance
        let is_known = self.predictor.count() > 2;
        let before = T::of(if is_known { 0.5 } else { 0.0 }) * self.rate;
        let improves = is_sharp & T::Mask::splat(self.due == 0 || !is_known);
        let renewed = self.rate.lt(rate) | improves;
        if renewed.any() {
            let rate = T::select(rate.lt(before), before, rate);
            let least = T::of(1.0 / SHARP);
            let rate = T::select(rate.lt(least), least, rate);
            let rate = T::select(rate.le(one), rate, one);
            self.set_rate(T::select(renewed, rate, self.rate));
        }
        // One more solution to continue while that helps, and fewer when it does not; of a calibrated prediction all are forgotten if it suddenly
        // is off.
        let missed = T::of(MISSED).lt(off);
        let ramps = T::of(0.0).lt(self.order);
        // a prediction that needs few iterations more is left to the next calibration
        let far = missed | (ramps & T::of(SHARP * T::EPSILON).lt(off));
        let open = open & (far | T::Mask::splat(self.due == 0 || self.predictor.count() < WINDOW));
        let helps = off.lt(self.missed) | !missed;
        let suddenly = (T::of(SUDDENLY) * self.missed).lt(off) & missed;
        let fewer = T::select(T::of(3.0).le(self.order), self.order - T::of(2.0), one);
        let order = T::select(helps & ramps, self.order + one, fewer);
        let most = T::of(RECENT.min(self.predictor.count() + 1) as f64);
        let order = T::select(order.le(most), order, most);
        let ramps = open & (ramps | suddenly) & (order.lt(self.order) | self.order.lt(order));
        self.order = T::select(ramps, order, self.order);
        self.missed = T::select(open, off, self.missed);
        if self.due == 0 {
            self.due = self.interval;
            self.interval = (4 * self.interval).min(INTERVALS[1]);
            self.predictor.choose(blocks, solution, self.tolerance);
            self.order = T::of(0.0);
        } else {
            self.due -= 1;
            if ramps.any() {
                self.predictor.continue_through(self.order, ramps);
            }
        }
        // before the solution is stored, for what was just stored is waited for
        self.prediction = self.next::<Portable>(solution);
        self.predictor.push::<Portable>(solution);
        self.predictor.count_more(1);
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub(crate) fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.predictor.memory(visit);
        let mut numbers = [T::of(f64::from(self.due)), T::of(f64::from(self.interval))];
        visit(&mut numbers);
        // the same in all lanes
        let [due, interval] = [numbers[0].lane(0).to_f64() as u32, numbers[1].lane(0).to_f64() as u32];
        (self.due, self.interval) = (due, interval.min(INTERVALS[1]));
        visit(core::slice::from_mut(&mut self.rate));
        visit(core::slice::from_mut(&mut self.order));
        visit(core::slice::from_mut(&mut self.missed));
        self.set_rate(self.rate);
        self.prediction = self.predictor.next();
    }
}

/// [`Solver::learn`], out of line: once for all steps with as many unknowns.
struct Learn<'a, T: Batch, U> {
    solver: &'a mut Solver<T, U>,
    solution: &'a U,
    blocks: &'static [usize],
    convergence: &'a Convergence<T>,
}

impl<T: Batch, U: Components<T>> Work for Learn<'_, T, U> {
    type Home = ();
    type Result = ();

    #[inline(always)]
    fn done(self) {
        let Self { solver, solution, blocks, convergence } = self;
        solver.learned(solution, blocks, convergence);
    }
}

/// No closure, which would not be compiled for the processor that the caller is compiled for.
#[inline(always)]
fn clamped<T: Batch>(x: T, [least, most]: [f64; 2]) -> T {
    let x = T::select(x.le(T::of(most)), x, T::of(most));
    T::select(x.le(T::of(least)), T::of(least), x)
}

/// What is counted in each lane, together.
#[inline(always)]
pub(crate) fn sum<T: Batch>(mut a: T::Each<u32>, b: T::Each<u32>) -> T::Each<u32> {
    for (a, b) in a.as_mut().iter_mut().zip(b.as_ref()) {
        *a += *b;
    }
    a
}

/// Counts one more in the lanes where the mask is true.
#[inline(always)]
pub(crate) fn count<T: Batch>(counts: &mut T::Each<u32>, mask: T::Mask) {
    for (lane, count) in counts.as_mut().iter_mut().enumerate() {
        *count = count.saturating_add(u32::from(mask.lane(lane)));
    }
}
