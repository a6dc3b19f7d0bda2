//! What takes a step: one solved equation, or several steps composed.

use crate::error::StepError;
use crate::geometry::Isolated;
use crate::kernel::{Components, Kernel};
use crate::newton;
use crate::scalar::{Real, Scalar};
use crate::stepper::StepReport;

/// A discretization of one system with one step size, on flat arrays.
pub trait Method: Clone {
    /// `f64` or `f32`.
    type Scalar: Real;
    /// The system's parameters.
    type Parameters: Components<Self::Scalar>;
    /// The state.
    type State: Components<Self::Scalar>;
    /// The controls.
    type Control: Components<Self::Scalar>;

    /// The method for these parameters and this step.
    fn new(parameters: &Self::Parameters, step: Self::Scalar) -> Self;

    /// The state after a step that starts at `time`, with `control` held until it ends. If the state is `known`, the one that the last
    /// step led to, the solution is sought from the last one on, which only makes it faster.
    ///
    /// # Errors
    /// If state, time or control is not finite, the step's equation cannot be solved, or its solution lies outside the retraction's
    /// domain.
    fn advance(
        &mut self,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
        known: bool,
    ) -> Result<(Self::State, StepReport), StepError>;

    /// Shows what the method carries from one step to the next, in pieces of always the same lengths, to be read or replaced. What is in
    /// no piece follows from the parameters and the step.
    fn memory(&mut self, visit: &mut dyn FnMut(&mut [Self::Scalar]));
}

/// Shows a truth as a number.
pub(crate) fn visit_flag<T: Scalar>(flag: &mut bool, visit: &mut dyn FnMut(&mut [T])) {
    let mut number = [T::of(if *flag { 1.0 } else { 0.0 })];
    visit(&mut number);
    *flag = number != [T::of(0.0)];
}

/// One generated kernel: a step is one equation, solved by Newton's iteration from the last solution.
#[derive(Clone, Copy, Debug)]
pub struct OneStep<T: Real, K: Kernel<T>> {
    kernel: K,
    /// Whether there was a step.
    solved: bool,
    /// Its solution.
    unknown: K::Unknown,
}

impl<T: Real, K: Kernel<T>> Method for OneStep<T, K> {
    type Scalar = T;
    type Parameters = K::Parameters;
    type State = K::State;
    type Control = K::Control;

    fn new(parameters: &K::Parameters, step: T) -> Self {
        let nothing = K::Unknown::from_fn(|_| T::of(0.0));
        Self { kernel: K::new(parameters, step), solved: false, unknown: nothing }
    }

    #[inline]
    fn advance(
        &mut self,
        state: &K::State,
        time: T,
        control: &K::Control,
        known: bool,
    ) -> Result<(K::State, StepReport), StepError> {
        if !(finite(state.as_ref()) && time.is_finite() && finite(control.as_ref())) {
            return Err(StepError::NotFinite);
        }
        let begun = self.kernel.begin(state, time, control);
        let start = if known && self.solved { self.unknown } else { self.kernel.start(state, &begun) };
        let solution = newton::solve(&self.kernel, state, &begun, start)?;
        if !(self.kernel.domain(state, &begun, &solution.unknown, &solution.evaluation) > T::of(0.0)) {
            return Err(StepError::OutsideDomain);
        }
        let next = self.kernel.finish(state, &begun, &solution.unknown, &solution.evaluation);
        if !finite(next.as_ref()) {
            return Err(StepError::NotFinite);
        }
        (self.solved, self.unknown) = (true, solution.unknown);
        Ok((next, StepReport { iterations: solution.iterations, residual: solution.residual }))
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        visit_flag(&mut self.solved, visit);
        visit(self.unknown.as_mut());
    }
}

/// A step that is part of a larger one. Not inlined: what is composed of several is compiled once for all that it is part of, and next
/// to a step a call is nothing.
#[inline(never)]
pub(crate) fn part<B: Method>(
    method: &mut B,
    state: &B::State,
    time: B::Scalar,
    control: &B::Control,
    known: bool,
) -> Result<(B::State, StepReport), StepError> {
    method.advance(state, time, control, known)
}

/// Half a step with the method `A`, then half a step with `B`, which starts at the time at which the first ends.
#[derive(Clone, Copy, Debug)]
pub struct Halves<A: Method, B> {
    first: A,
    second: B,
    /// Half of the step.
    half: A::Scalar,
    /// Whether both halves remember solutions of one and the same step.
    whole: bool,
}

impl<A, B> Method for Halves<A, B>
where
    A: Method,
    B: Method<Scalar = A::Scalar, Parameters = A::Parameters, State = A::State, Control = A::Control>,
{
    type Scalar = A::Scalar;
    type Parameters = A::Parameters;
    type State = A::State;
    type Control = A::Control;

    fn new(parameters: &A::Parameters, step: A::Scalar) -> Self {
        let half = A::Scalar::of(0.5) * step;
        Self { first: A::new(parameters, half), second: B::new(parameters, half), half, whole: false }
    }

    #[inline]
    fn advance(
        &mut self,
        state: &A::State,
        time: A::Scalar,
        control: &A::Control,
        known: bool,
    ) -> Result<(A::State, StepReport), StepError> {
        let known = known && self.whole;
        // until both are through
        self.whole = false;
        let (middle, first) = part(&mut self.first, state, time, control, known)?;
        let (next, second) = part(&mut self.second, &middle, time + self.half, control, known)?;
        self.whole = true;
        let report = StepReport {
            iterations: first.iterations + second.iterations,
            residual: first.residual.max(second.residual),
        };
        Ok((next, report))
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [A::Scalar])) {
        visit_flag(&mut self.whole, visit);
        self.first.memory(visit);
        self.second.memory(visit);
    }
}

/// A method between whose steps the momentum is carried in space coordinates.
pub struct Carried<S: Isolated, B> {
    base: B,
    /// Whether there was a step.
    has_stepped: bool,
    /// The momentum since then.
    spatial: S::Spatial,
}

impl<S: Isolated, B: Clone> Clone for Carried<S, B> {
    fn clone(&self) -> Self {
        Self { base: self.base.clone(), has_stepped: self.has_stepped, spatial: self.spatial }
    }
}

impl<S, B> Method for Carried<S, B>
where
    S: Isolated,
    B: Method<Scalar = S::Scalar, State = S::StateComponents<S::Scalar>>,
{
    type Scalar = B::Scalar;
    type Parameters = B::Parameters;
    type State = B::State;
    type Control = B::Control;

    fn new(parameters: &B::Parameters, step: B::Scalar) -> Self {
        let nothing = S::Spatial::from_fn(|_| B::Scalar::of(0.0));
        Self { base: B::new(parameters, step), has_stepped: false, spatial: nothing }
    }

    #[inline]
    fn advance(
        &mut self,
        state: &B::State,
        time: B::Scalar,
        control: &B::Control,
        known: bool,
    ) -> Result<(B::State, StepReport), StepError> {
        let spatial = if known && self.has_stepped { self.spatial } else { S::in_space(state) };
        let (next, report) = part(&mut self.base, state, time, control, known)?;
        (self.has_stepped, self.spatial) = (true, spatial);
        Ok((S::in_body(&next, &spatial), report))
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [B::Scalar])) {
        visit_flag(&mut self.has_stepped, visit);
        visit(self.spatial.as_mut());
        self.base.memory(visit);
    }
}

#[inline(always)]
fn finite<T: Real>(components: &[T]) -> bool {
    components.iter().all(|x| x.is_finite())
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;

    /// Goes nowhere, and fails after the time in its control.
    #[derive(Clone)]
    struct Half {
        /// Whether it was told, the last time, that it knows the state.
        known: bool,
    }

    impl Method for Half {
        type Scalar = f64;
        type Parameters = [f64; 0];
        type State = [f64; 0];
        type Control = [f64; 1];

        fn new(_: &[f64; 0], _: f64) -> Self {
            Self { known: false }
        }

        fn advance(
            &mut self,
            _: &[f64; 0],
            time: f64,
            &[limit]: &[f64; 1],
            known: bool,
        ) -> Result<([f64; 0], StepReport), StepError> {
            self.known = known;
            if time > limit {
                return Err(StepError::OutsideDomain);
            }
            Ok(([], StepReport { iterations: 1, residual: time }))
        }

        fn memory(&mut self, _: &mut dyn FnMut(&mut [f64])) {}
    }

    #[test]
    fn halves_remember_whole_steps_only() {
        let mut halves = Halves::<Half, Half>::new(&[], 2.0);
        let mut advance = |limit: f64| {
            let report = halves.advance(&[], 3.0, &[limit], true).map(|(_, report)| report);
            (report, [halves.first.known, halves.second.known])
        };
        let solved = Ok(StepReport { iterations: 2, residual: 4.0 });
        // nothing to remember yet
        assert_eq!(advance(9.0), (solved, [false, false]));
        assert_eq!(advance(9.0), (solved, [true, true]));
        // the second half fails: what the first one remembers is of another step
        assert_eq!(advance(3.5), (Err(StepError::OutsideDomain), [true, true]));
        assert_eq!(advance(9.0), (solved, [false, false]));
        assert_eq!(advance(9.0), (solved, [true, true]));
    }
}
