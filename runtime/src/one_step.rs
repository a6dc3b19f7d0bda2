//! A step that is one equation, from its kernel, solved from where the solutions of earlier steps point.
//!
//! Nearly all steps are usual: known state, one sweep or a few, everything finite. These have a way of their own, without a look at anything
//! else, which many steps in a row take together (`March`). Whatever is not usual sends a step the other way, that of any step (`Anyhow`).

use crate::error::StepError;
use crate::kernel::{Components, Kernel};
use crate::lanes::{Portable, Processor};
use crate::method::{Advanced, Clock, Failure, Marched, Method, Outcome};
use crate::newton::SolutionOf;
use crate::scalar::{Batch, LongWork, Mask, Real, Work};
use crate::solver::Solver;

/// One generated kernel: a step is one equation, solved from where the solutions of earlier steps point.
#[derive(Clone, Copy, Debug)]
pub struct OneStep<T: Batch, K: Kernel<T>> {
    kernel: K,
    solver: Solver<T, K::Unknown>,
}

impl<T: Batch, K: Kernel<T>> Method for OneStep<T, K> {
    type Home = K;
    type Scalar = T;
    type Parameters = K::Parameters;
    type State = K::State;
    type Control = K::Control;

    fn new(parameters: &K::Parameters, step: T) -> Self {
        Self { kernel: K::new(parameters, step), solver: Solver::default() }
    }

    #[inline(always)]
    fn advance(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
    ) -> Outcome<T, K::State> {
        // Nearly all steps go this way. Whatever is not as usual sends them the other. Side by side, they have gone it before, together.
        if const { T::LANES == 1 && Self::HAS_USUAL } && known && self.solver.usual() > 0 {
            let mut guess = self.solver.guess();
            if let Some(advanced) = self.usual::<Portable, true>(state, time, control, &mut guess) {
                self.solver.took(1);
                self.solver.set_guess(&guess);
                return Ok(advanced);
            }
        }
        self.anyhow(state, time, control, known)
    }

    #[inline(always)]
    fn march(&mut self, state: &mut K::State, clock: Clock, control: &K::Control, most: u64) -> Marched<T> {
        if const { !Self::HAS_USUAL } {
            return Marched::default();
        }
        // out of line: once for all that take steps with it
        T::outline_long(March::new(self, state, clock, control, most)).unwrap_or_default()
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.solver.memory(visit);
    }
}

/// Steps of [`OneStep`] as nearly all are.
pub(crate) struct March<'a, T: Batch, K: Kernel<T>> {
    method: &'a mut OneStep<T, K>,
    state: &'a mut K::State,
    clock: Clock,
    control: &'a K::Control,
    most: u64,
}

impl<'a, T: Batch, K: Kernel<T>> March<'a, T, K> {
    #[inline(always)]
    pub(crate) fn new(
        method: &'a mut OneStep<T, K>,
        state: &'a mut K::State,
        clock: Clock,
        control: &'a K::Control,
        most: u64,
    ) -> Self {
        Self { method, state, clock, control, most }
    }
}

impl<T: Batch, K: Kernel<T>> LongWork for March<'_, T, K> {
    type Home = K;
    type Result = Marched<T>;

    #[inline(always)]
    fn done<P: Processor>(self) -> Marched<T> {
        let Self { method, state, clock, control, most } = self;
        method.solver.effort();
        // not in memory
        let (mut now, mut guess) = (*state, method.solver.guess());
        let most = most.min(method.solver.usual());
        let mut steps = 0;
        while steps < most {
            let mut next = guess;
            let Some(advanced) =
                method.usual::<P, false>(&now, T::of(clock.after(steps)), control, &mut next)
            else {
                break;
            };
            (now, guess) = (advanced.state, next);
            steps += 1;
        }
        *state = now;
        method.solver.took(steps);
        method.solver.set_guess(&guess);
        let (effort, residual) = method.solver.effort();
        if steps == 0 || method.solver.is_idle() {
            return Marched { steps, ..Marched::default() };
        }
        let mut iterations = effort.more;
        iterations.as_mut().iter_mut().for_each(|count| *count += steps);
        Marched { steps, iterations, max_iterations: effort.most, max_residual: residual }
    }
}

/// A step of [`OneStep`], with all that can happen.
struct Anyhow<'a, T: Batch, K: Kernel<T>> {
    method: &'a mut OneStep<T, K>,
    state: &'a K::State,
    time: T,
    control: &'a K::Control,
    known: bool,
}

impl<T: Batch, K: Kernel<T>> Work for Anyhow<'_, T, K> {
    type Home = K;
    type Result = Outcome<T, K::State>;

    #[inline(always)]
    fn done(self) -> Outcome<T, K::State> {
        let Self { method, state, time, control, known } = self;
        let given = finite(state) & finite(control) & time.is_finite();
        let begun = method.kernel.begin(state, time, control);
        let solution = method.solver.solve(&method.kernel, state, &begun, known);
        let inside = method.is_inside(state, &begun, &solution);
        let advanced = method.finish(state, &begun, &solution);
        let reached = finite(&advanced.state);
        let good = given & !solution.unsolved & inside & reached;
        if good.any() {
            method.solver.push(&solution.unknown);
        } else {
            method.solver.forget();
        }
        if good.all() {
            return Ok(advanced);
        }
        let errors = T::each(|lane| {
            if !given.lane(lane) {
                return Some(StepError::NotFinite);
            }
            if solution.unsolved.lane(lane) {
                let iterations = solution.iterations.as_ref()[lane];
                let residual = solution.residual.lane(lane).to_f64();
                return Some(StepError::NoConvergence { iterations, residual });
            }
            if !inside.lane(lane) {
                return Some(StepError::OutsideDomain);
            }
            (!reached.lane(lane)).then_some(StepError::NotFinite)
        });
        Err(Failure { errors, advanced })
    }
}

impl<T: Batch, K: Kernel<T>> OneStep<T, K> {
    /// Whether there is a way for steps as most are: where there is nothing to solve for, or sweeps solve it.
    const HAS_USUAL: bool = K::SWEEPS || <K::Unknown as Components<T>>::LENGTH == 0;

    /// A step by whatever it takes.
    #[inline(always)]
    fn anyhow(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
    ) -> Outcome<T, K::State> {
        // copies, so that the other way needs no addresses
        let (state, control) = (*state, *control);
        T::outline(Anyhow { method: self, state: &state, time, control: &control, known })
    }

    /// A step as nearly all are, from a guess that becomes the next one's. None if something is not as usual, be it a number that is not
    /// finite: then nothing else has changed, but that sweeps beyond the first are counted if they were made and what followed was not usual.
    /// `BY_ITSELF` as for [sweeps](Solver::by_sweeps).
    #[inline(always)]
    fn usual<P: Processor, const BY_ITSELF: bool>(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        guess: &mut K::Unknown,
    ) -> Option<Advanced<T, K::State>> {
        let begun = self.kernel.begin(state, time, control);
        let solution = self.solver.by_sweeps::<P, BY_ITSELF, _>(&self.kernel, state, &begun, guess)?;
        let advanced = self.finish(state, &begun, &solution);
        let inside = self.is_inside(state, &begun, &solution).all();
        let finite = self.is_surely_finite(&advanced.state, control).all();
        if inside & finite {
            self.solver.push_usual::<P>(&solution.unknown);
            return Some(advanced);
        }
        // asked for here too, so that the compiler does not put it off until it is known that the step is usual: the next one waits for it
        core::hint::black_box(*guess);
        None
    }

    /// Whether all numbers of a lane are finite after a usual step, of which state and solution were; not so if their sum is too large.
    #[inline(always)]
    fn is_surely_finite(&self, state: &K::State, control: &K::Control) -> T::Mask {
        // four sums, for each has to wait for itself; the compiler knows that −0 is nothing to add
        let mut sums = [T::of(-0.0); 4];
        let mut terms = 0;
        for (k, component) in state.as_ref().iter().enumerate() {
            if !K::is_bounded(k) {
                sums[terms % 4] = sums[terms % 4] + *component;
                terms += 1;
            }
        }
        for component in control.as_ref() {
            sums[terms % 4] = sums[terms % 4] + *component;
            terms += 1;
        }
        (T::of(0.0) * ((sums[0] + sums[1]) + (sums[2] + sums[3]))).at_most(T::of(0.0))
    }

    /// The solution of the last step's equation.
    pub(crate) fn solution(&self) -> K::Unknown {
        self.solver.latest()
    }

    /// The state after a step whose equation has this solution.
    pub(crate) fn next(
        &self,
        state: &K::State,
        time: T,
        control: &K::Control,
        unknown: &K::Unknown,
    ) -> K::State {
        let begun = self.kernel.begin(state, time, control);
        let evaluation = self.kernel.evaluate(state, &begun, unknown);
        self.kernel.finish(state, &begun, unknown, &evaluation)
    }

    #[inline(always)]
    fn is_inside(&self, state: &K::State, begun: &K::Step, solution: &SolutionOf<T, K>) -> T::Mask {
        match self.kernel.domain(state, begun, &solution.unknown, &solution.evaluation) {
            Some(margin) => T::of(0.0).below(margin),
            None => T::Mask::splat(true),
        }
    }

    #[inline(always)]
    fn finish(
        &self,
        state: &K::State,
        begun: &K::Step,
        solution: &SolutionOf<T, K>,
    ) -> Advanced<T, K::State> {
        let state = self.kernel.finish(state, begun, &solution.unknown, &solution.evaluation);
        Advanced { state, iterations: solution.iterations, residual: solution.residual }
    }
}

/// Whether all numbers of a lane are finite: no branch.
#[inline(always)]
fn finite<T: Batch, C: Components<T>>(components: &C) -> T::Mask {
    // what is finite times nothing is nothing, and nothing else is; four sums, for each has to wait for itself
    let mut sums = [T::of(0.0); 4];
    for (k, component) in components.as_ref().iter().enumerate() {
        sums[k % 4] = sums[k % 4] + T::of(0.0) * *component;
    }
    ((sums[0] + sums[1]) + (sums[2] + sums[3])).at_most(T::of(0.0))
}
