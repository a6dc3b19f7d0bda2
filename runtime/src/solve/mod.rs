//! Solves the equations of successive steps, `left(x) = right(x)`.
//!
//! Successive solutions are samples of a smooth trajectory: the [`predictor`] continues them by one step, and in small steps the next solution
//! is known to many digits before anything is solved. A fixed-point iteration, such as `x ← L⁻¹ right(x)`, takes off the factor by which it
//! contracts, about the angle turned in a step, and mostly brings what is left below rounding ([`one_step`]). Whether it did is seen at every step: its
//! change, relative to the unknown as it is now ([`stopping`]), times the rate of contraction. Where it did not, and from a new state, there are
//! a few more ([`fixed_point`]), if that promises to do, or else [Newton's iteration](newton). What is remembered saves time, and nothing else.

mod damped;
mod fixed_point;
mod newton;
pub(crate) mod one_step;
pub(crate) mod predictor;
pub(crate) mod stopping;

use crate::kernel::{Evaluation, Kernel};
use crate::method::sum;
use crate::scalar::simd::lanes::Processor;
use crate::scalar::{Batch, Components, Mask, Real, Work};
pub(crate) use fixed_point::Open;
use fixed_point::{Iterated, MOST, SHARP};
use predictor::{Predictor, Wide};
use stopping::{change, relative, select, weights};

/// Steps between two measurements of the rate of contraction: at first, and in the long run.
const INTERVALS: [u16; 2] = [16, 1024];
/// Fixed-point iterations are made if they contract at least by this.
const STRONG: f64 = 0.25;
/// What the rate of contraction is multiplied by, for it may grow until it is measured again.
const SAFETY: f64 = 2.0;
/// An error of the unknown this small, in units of epsilon, is roundoff, and never is one that is larger than this.
const ROUNDOFF: [f64; 2] = [1.0, 8.0];
/// An error this small, in units of epsilon, makes no difference to the state, next to what is rounded there. The unknown changes the state
/// by about as much as iterations contract: by the angle turned in a step.
const NO_DIFFERENCE: f64 = 0.1;
/// The change of the last iteration, in units of epsilon. Not less, if only for rounding; not more, for what is evaluated before it serves for
/// the solution too.
const LAST_CHANGE: [f64; 2] = [8.0, 128.0];
/// The most iterations on the fast path from all earlier solutions that there is place for, and what the tolerance is multiplied by for the second of them: it mostly ends far below.
const QUICK: u8 = 2;
const SECOND: f64 = 0.25;
/// A guess that is off by more than this is not used.
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

/// Where Newton's iteration begins.
pub(crate) struct Beginning<T: Batch, U> {
    /// The first approximation; in the lanes that are solved, where the equation is to be evaluated.
    pub from: U,
    /// The lanes that are not solved.
    pub wanted: T::Mask,
    /// The solution in the others, and how it was found.
    pub unknown: U,
    pub convergence: Convergence<T>,
}

impl<T: Batch, U: Components<T>> Beginning<T, U> {
    /// The solution of a step's equation by Newton's iteration.
    #[inline(always)]
    pub(crate) fn corrected<K>(&self, kernel: &K, state: &K::State, step: &K::Step) -> SolutionOf<T, K>
    where
        K: Kernel<T, Unknown = U>,
    {
        let solution = newton::solve(kernel, state, step, &self.from, self.wanted);
        Solution {
            unknown: select(self.wanted, &solution.unknown, &self.unknown),
            convergence: self.convergence.then(&solution.convergence, !self.wanted),
            ..solution
        }
    }
}

/// What is remembered of the solutions of earlier steps.
#[derive(Clone, Copy)]
pub(crate) struct Solver<T: Batch, U> {
    /// Where the earlier solutions point.
    predictor: Predictor<T, U>,
    /// The factor by which the fixed-point iteration contracts, as far as it is known.
    rate: T,
    /// The relative change of a last iteration; negative where iterations do not contract strongly.
    tolerance: T,
    /// The largest change after which a few iterations more are enough. Kept, for on the fast path it takes a register to compute it.
    reach: T,
    /// Steps until the next measurement of the rate.
    due: u16,
    /// Steps from the next measurement to the one after it.
    interval: u16,
    /// See [`most`](Self::most).
    most: u8,
}

/// Remembers nothing.
impl<T: Batch, U: Components<T>> Default for Solver<T, U> {
    fn default() -> Self {
        let (rate, tolerance) = (T::of(STRONG), T::of(-1.0));
        Self {
            predictor: Predictor::default(),
            rate,
            tolerance,
            reach: T::of(0.0),
            due: INTERVALS[0],
            interval: INTERVALS[0],
            most: 0,
        }
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
    /// Where no more iterations were needed than on the fast path.
    is_quick: T::Mask,
}

impl<T: Batch> Convergence<T> {
    /// That of one iteration, of which the residual is no more than that.
    #[inline(always)]
    fn of_one(residual: T) -> Self {
        let (none, nothing) = (T::Mask::splat(false), T::of(0.0));
        Self {
            iterations: T::all(1),
            residual,
            tried: none,
            off: nothing,
            rate: nothing,
            is_sharp: none,
            is_quick: none,
        }
    }

    /// That of no iteration.
    #[inline(always)]
    fn of_none() -> Self {
        Self { iterations: T::all(0), ..Self::of_one(T::of(0.0)) }
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

    /// The most iterations of the next step on the fast path: none where that is not to be tried. It is where iterations contract strongly, and
    /// the solutions before point to the next one. [Few](Self::is_growing) of them point less far, and there may be more iterations then.
    #[inline(always)]
    pub(crate) fn most(&self) -> u32 {
        if const { Self::IS_IDLE } { 1 } else { self.most.into() }
    }

    /// After all of which it depends on.
    #[inline(always)]
    fn set_most(&mut self) {
        self.most = if self.due == 0 || !self.is_strong().any() {
            0
        } else if self.predictor.is_full() {
            QUICK
        } else if const { T::LANES == 1 } && self.remembers() {
            MOST
        } else {
            // in lanes, what is enough for one would be one more for it
            0
        };
    }

    /// Whether so many iterations are for few solutions that point to the next.
    #[inline(always)]
    pub(crate) fn is_growing(most: u32) -> bool {
        most > QUICK.into()
    }

    /// For so many steps all is as it is now: until the rate of contraction is measured, or there may be all solutions that are of use.
    #[inline(always)]
    pub(crate) fn expected(&self) -> u64 {
        if const { Self::IS_IDLE } {
            return u64::MAX;
        }
        let due = self.due.max(1).into();
        if Self::is_growing(self.most()) { self.predictor.room().min(due) } else { due }
    }

    /// Where iterations contract strongly.
    #[inline(always)]
    fn is_strong(&self) -> T::Mask {
        self.rate.le(T::of(STRONG))
    }

    /// The relative change of a last iteration on the fast path; negative where iterations do not contract strongly.
    #[inline(always)]
    pub(crate) fn tolerance(&self) -> T {
        self.tolerance
    }

    /// Where the earlier solutions point.
    #[inline(always)]
    pub(crate) fn prediction(&self) -> U {
        self.predictor.next()
    }

    /// Remembers the solution of a step on the fast path, which was missed by so much. Returns where they point then.
    #[inline(always)]
    pub(crate) fn follow<P: Processor>(&mut self, missed: &U) -> U {
        self.predictor.follow::<P>(missed)
    }

    /// What [follows](Wide::follow) instead for many steps, where that is faster. To be [taken back](Self::take).
    #[inline(always)]
    pub(crate) fn widened<P: Processor>(&self) -> Option<Wide<T, U>> {
        self.predictor.widened::<P>()
    }

    /// Remembers what has followed instead.
    #[inline(always)]
    pub(crate) fn take(&mut self, wide: &mut Wide<T, U>) {
        self.predictor.take(wide);
    }

    /// [`follow`](Self::follow) while there are few solutions.
    #[inline(always)]
    pub(crate) fn grow(&mut self, solution: &U, off: T, blocks: &[usize]) -> U {
        if !self.predictor.keep_to(solution, off) {
            let weights = &weights::<T, _>(blocks, solution);
            T::dispatch(Grow { predictor: &mut self.predictor, weights, solution, off });
            self.set_most();
        }
        self.predictor.next()
    }

    /// There were so many steps on the fast path.
    #[inline(always)]
    pub(crate) fn took(&mut self, steps: u64) {
        self.due = u64::from(self.due).saturating_sub(steps) as u16;
        if self.due == 0 {
            self.most = 0;
        }
    }

    /// How the equation of a step is solved on the fast path, with a bound for the residual.
    #[inline(always)]
    pub(crate) fn on_fast_path(&self, iterations: u32) -> Convergence<T> {
        if const { Self::IS_IDLE } {
            Convergence::of_none()
        } else {
            Convergence { iterations: T::all(iterations), ..Convergence::of_one(self.rate * self.tolerance) }
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
        self.most = 0;
        (self.due, self.interval) = (INTERVALS[0], INTERVALS[0]);
        self.rate = T::of(STRONG);
    }

    /// The latest solution.
    pub(crate) fn latest(&self) -> U {
        self.predictor.latest()
    }

    #[inline(always)]
    fn set_tolerance(&mut self) {
        let inverse = T::of(1.0) / self.rate;
        self.tolerance = T::select(self.is_strong(), tolerance(inverse), T::of(-1.0));
        self.reach = fixed_point::reach(inverse);
    }

    /// The solution of a step's equation by a few fixed-point iterations, if these do; else where they ended, if there were any. `first` is where
    /// the first iteration on the fast path led to.
    #[inline(always)]
    pub(crate) fn iterate<K>(
        &self,
        kernel: &K,
        state: &K::State,
        step: &K::Step,
        first: Option<U>,
    ) -> Result<SolutionOf<T, K>, Option<Open<T, U>>>
    where
        K: Kernel<T, Unknown = U>,
    {
        let unsolved = T::Mask::splat(false);
        if const { Self::IS_IDLE } {
            let unknown = kernel.start(state, step);
            let (evaluation, convergence) = (kernel.evaluate(state, step, &unknown), self.on_fast_path(0));
            return Ok(Solution { unknown, evaluation, convergence, unsolved });
        }
        if !const { K::HAS_FIXED_POINT_UPDATE } || !self.tries().any() {
            return Err(None);
        }
        let guess = if self.remembers() { self.predictor.next() } else { kernel.start(state, step) };
        match fixed_point::iterate(kernel, state, step, self, &guess, first) {
            Iterated::Solved(unknown, evaluation, convergence) => {
                Ok(Solution { unknown, evaluation, convergence, unsolved })
            }
            Iterated::Open(open) => Err(Some(open)),
        }
    }

    /// Where Newton's iteration begins: where fixed-point iterations ended, where the solutions before point, or at a first approximation.
    #[inline(always)]
    pub(crate) fn beginning(
        &self,
        blocks: &[usize],
        start: &U,
        ended: Option<&Open<T, U>>,
    ) -> Beginning<T, U> {
        let guess = if self.remembers() { self.predictor.next() } else { *start };
        // unless that is far off; rest may stand for a velocity that is not known
        let is_rest = relative::<T, _>(blocks, start, &guess).le(T::of(0.0));
        let is_near = change::<T, _>(blocks, &guess, start).le(T::of(1.0)) | is_rest;
        let guess = select(is_near, &guess, start);
        let Some(&Open { point, unknown, open, convergence }) = ended else {
            let (wanted, convergence) = (T::Mask::splat(true), Convergence::of_none());
            return Beginning { from: guess, wanted, unknown: guess, convergence };
        };
        // from where iterations led to, unless the guess was far off
        let iterated = convergence.tried & convergence.off.le(T::of(LOST));
        let from = select(iterated, &unknown, &select(convergence.tried, start, &guess));
        Beginning { from: select(open, &from, &point), wanted: open, unknown, convergence }
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

    /// Whether the rate of contraction is to be measured, by one more iteration: in the first step, and now and then.
    #[inline(always)]
    fn measures(&self) -> bool {
        // before the first step; asked of the predictor, the compiler makes a slower loop of the iterations
        self.due == 0 || (self.due >= INTERVALS[0] && self.interval <= INTERVALS[0])
    }

    /// Whether after an iteration with such a change a few more are enough.
    #[inline(always)]
    pub(crate) fn continues(&self, change: T) -> bool {
        change.le(self.reach).all()
    }

    /// Whether an iteration contracts as it is known: that has changed the unknown by so much, after one with the `last` change.
    #[inline(always)]
    pub(crate) fn contracts(&self, last: T, change: T) -> bool {
        let bound = T::of(SAFETY) * self.rate * last + T::of(fixed_point::NOISE * T::EPSILON);
        change.le(bound).all()
    }

    /// Whether an iteration that contracts as it is known, and has changed the unknown by so much, was the last.
    #[inline(always)]
    pub(crate) fn solves(&self, change: T) -> bool {
        fixed_point::is_last(change, self.rate * change).all()
    }

    /// The lanes in which fixed-point iterations are to be made: where they contract strongly, and where it is to be seen whether they do.
    #[inline(always)]
    fn tries(&self) -> T::Mask {
        self.is_strong() | T::Mask::splat(self.due == 0)
    }

    /// Remembers the solution of a step that was not as those on the fast path are, and learns from how it was found.
    #[inline(always)]
    pub(crate) fn learn(&mut self, solution: &U, blocks: &[usize], convergence: &Convergence<T>) {
        if const { Self::IS_IDLE } {
            return;
        }
        if self.predictor.count() > 0 {
            let weights = &weights::<T, _>(blocks, solution);
            return T::dispatch(Learn { solver: self, weights, solution, convergence });
        }
        let rate = clamped(convergence.rate, [1.0 / SHARP, 1.0]);
        self.rate = T::select(convergence.is_sharp, rate, self.rate);
        self.set_tolerance();
        self.due = self.due.saturating_sub(1);
        self.predictor.begin(solution);
        self.set_most();
    }

    #[inline(always)]
    fn learned(&mut self, weights: &U, solution: &U, convergence: &Convergence<T>) {
        let Convergence { rate, is_sharp, is_quick, off, .. } = *convergence;
        // if it is smaller than it was, that may be by chance
        let improves = is_sharp & T::Mask::splat(self.due == 0);
        let renewed = (self.rate.lt(rate) | improves) & !is_quick;
        if renewed.any() {
            let before = T::of(0.5) * self.rate;
            let rate = T::select(rate.lt(before), before, rate);
            self.rate = T::select(renewed, clamped(rate, [1.0 / SHARP, 1.0]), self.rate);
            self.set_tolerance();
        }
        if self.due == 0 {
            self.due = self.interval;
            self.interval = (4 * self.interval).min(INTERVALS[1]);
        } else {
            self.due -= 1;
        }
        self.predictor.learn(weights, solution, is_quick, off);
        self.set_most();
    }

    /// Shows all that is remembered, for [`Method::memory`](crate::method::Method::memory).
    pub(crate) fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.predictor.memory(visit);
        let mut numbers = [T::of(f64::from(self.due)), T::of(f64::from(self.interval))];
        visit(&mut numbers);
        // the same in all lanes
        let [due, interval] = [numbers[0].lane(0).to_f64() as u16, numbers[1].lane(0).to_f64() as u16];
        (self.due, self.interval) = (due, interval.min(INTERVALS[1]));
        visit(core::slice::from_mut(&mut self.rate));
        self.set_tolerance();
        self.set_most();
    }
}

/// [`Solver::learn`], out of line: once for all steps with as many unknowns.
struct Learn<'a, T: Batch, U> {
    solver: &'a mut Solver<T, U>,
    weights: &'a U,
    solution: &'a U,
    convergence: &'a Convergence<T>,
}

impl<T: Batch, U: Components<T>> Work for Learn<'_, T, U> {
    type Home = ();
    type Result = ();

    #[inline(always)]
    fn done(self) {
        let Self { solver, weights, solution, convergence } = self;
        solver.learned(weights, solution, convergence);
    }
}

/// [`Solver::grow`], out of line: once for all steps with as many unknowns.
struct Grow<'a, T: Batch, U> {
    predictor: &'a mut Predictor<T, U>,
    weights: &'a U,
    solution: &'a U,
    off: T,
}

impl<T: Batch, U: Components<T>> Work for Grow<'_, T, U> {
    type Home = ();
    type Result = ();

    #[inline(always)]
    fn done(self) {
        self.predictor.learn(self.weights, self.solution, T::Mask::splat(true), self.off);
    }
}

/// The relative change of a last iteration, for the inverse of a rate of contraction.
#[inline(always)]
fn tolerance<T: Batch>(inverse: T) -> T {
    let per_bound = T::of(1.0 / SAFETY) * inverse;
    let error = clamped(T::of(NO_DIFFERENCE) * per_bound, ROUNDOFF);
    T::of(T::EPSILON) * clamped(error * per_bound, LAST_CHANGE)
}

/// The sum of two unknowns.
#[inline(always)]
pub(crate) fn added<T: Batch, U: Components<T>>(a: &U, b: &U) -> U {
    let mut sum = *a;
    let mut i = 0;
    while i < U::LENGTH {
        sum.as_mut()[i] = a.as_ref()[i] + b.as_ref()[i];
        i += 1;
    }
    sum
}

/// The difference of two unknowns.
#[inline(always)]
pub(crate) fn less<T: Batch, U: Components<T>>(a: &U, b: &U) -> U {
    let mut difference = *a;
    let mut i = 0;
    while i < U::LENGTH {
        difference.as_mut()[i] = a.as_ref()[i] - b.as_ref()[i];
        i += 1;
    }
    difference
}

/// No closure, which would not be compiled for the processor that the caller is compiled for.
#[inline(always)]
fn clamped<T: Batch>(x: T, [least, most]: [f64; 2]) -> T {
    let x = T::select(T::of(most).lt(x), T::of(most), x);
    T::select(x.lt(T::of(least)), T::of(least), x)
}

/// Counts one more in the lanes where the mask is true.
#[inline(always)]
pub(crate) fn count<T: Batch>(counts: &mut T::Each<u32>, mask: T::Mask) {
    for (lane, count) in counts.as_mut().iter_mut().enumerate() {
        *count = count.wrapping_add(u32::from(mask.lane(lane)));
    }
}
