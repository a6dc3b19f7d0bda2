//! Derivatives of methods: of one solved equation, and by the chain rule of what is composed of such.

use super::blocks::all_finite;
use super::{
    ControlPerturbation, Differentiable, Linearized, ParameterPerturbation, PerturbationArrays,
    StatePerturbation, add, no_columns, zeros,
};
use crate::composition::{Coefficients, Composition};
use crate::method::{AdjointPair, Method};
use crate::scalar::{Batch, Components, Scalar};
use crate::solve::step::OneStep;
use crate::system::{ConservedMomentum, Isolated, MethodOf, System};

/// The start of a step, and what the step is made with.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct StepStart<'a, T, P, X, U> {
    /// The system's parameters.
    pub parameters: &'a P,
    /// The step size.
    pub step: T,
    /// The state.
    pub state: &'a X,
    /// The time.
    pub time: T,
    /// The controls.
    pub control: &'a U,
}

/// The start of a method's step.
pub type StartOf<'a, D> = StepStart<
    'a,
    <D as Method>::Scalar,
    <D as Method>::Parameters,
    <D as Method>::State,
    <D as Method>::Control,
>;

impl<'a, T, P, X, U> StepStart<'a, T, P, X, U> {
    /// The start of one of the steps that this one is composed of.
    fn stage<'b>(&'b self, state: &'b X, time: T, step: T) -> StepStart<'b, T, P, X, U>
    where
        'a: 'b,
    {
        StepStart { parameters: self.parameters, step, state, time, control: self.control }
    }
}

/// Which of the derivatives are selected.
pub trait DerivativeSelection {
    /// Those with respect to the state.
    const STATE: bool;
    /// Those with respect to the controls.
    const CONTROL: bool;
    /// Those with respect to the parameters.
    const PARAMETERS: bool;
}

/// A method whose steps of the system `S` have derivatives.
#[diagnostic::on_unimplemented(
    message = "there are no derivatives of the steps of `{S}`",
    note = "derivatives are asked for in the description, with `derivatives`"
)]
#[doc(hidden)]
pub trait Linearizable<S: Differentiable>: Method {
    /// The solutions of a step's equations.
    #[doc(hidden)]
    type Trace: Clone + Send + Sync;
    /// The derivative of a step.
    #[doc(hidden)]
    type Derivative: Clone + Send + Sync;

    /// The solutions of the last step's equations, if it succeeded.
    #[doc(hidden)]
    fn trace(&self) -> Self::Trace;

    /// Where a step leads to, from the solutions of its equations.
    #[doc(hidden)]
    fn replay(&self, start: &StartOf<'_, Self>, trace: &Self::Trace) -> Self::State;

    /// The derivative of a step, from the solutions of its equations.
    #[doc(hidden)]
    fn derivative(&self, start: &StartOf<'_, Self>, trace: &Self::Trace) -> Self::Derivative;

    /// The perturbation of the next state.
    #[doc(hidden)]
    fn tangent(
        derivative: &Self::Derivative,
        state: &StatePerturbation<S, Self::Scalar>,
        control: &ControlPerturbation<S, Self::Scalar>,
        parameters: &ParameterPerturbation<S, Self::Scalar>,
    ) -> StatePerturbation<S, Self::Scalar>;

    /// The transpose.
    #[doc(hidden)]
    fn adjoint(
        derivative: &Self::Derivative,
        costate: &StatePerturbation<S, Self::Scalar>,
    ) -> PerturbationArrays<S, Self::Scalar>;

    /// As matrices, column by column. Zeros in the place of those that are not selected.
    #[doc(hidden)]
    fn columns<W: DerivativeSelection>(derivative: &Self::Derivative) -> AllColumns<S, Self::Scalar>;
}

/// A method whose steps of the system `S` have derivatives: all that there is to ask for, so that the compiler says once that they were not
/// generated.
#[diagnostic::on_unimplemented(
    message = "there are no derivatives of the steps of `{S}`",
    note = "derivatives are asked for in the description, with `derivatives`"
)]
#[doc(hidden)]
pub trait HasDerivative<S: System>: MethodOf<S> {
    /// The derivative of a step.
    #[doc(hidden)]
    type Point;

    /// That of the last step, which started so.
    #[doc(hidden)]
    fn last_derivative(&self, start: &StartOf<'_, Self>) -> Self::Point;

    /// Whether all that can be made of it is finite.
    #[doc(hidden)]
    fn is_finite(point: &Self::Point) -> bool;
}

#[diagnostic::do_not_recommend]
impl<S: Differentiable, D: MethodOf<S> + Linearizable<S>> HasDerivative<S> for D {
    type Point = D::Derivative;

    #[inline(always)]
    fn last_derivative(&self, start: &StartOf<'_, D>) -> D::Derivative {
        self.derivative(start, &self.trace())
    }

    fn is_finite(point: &D::Derivative) -> bool {
        // of the maps that were generated the first tells: the others give zeros
        let one = D::Scalar::of(1.0);
        let (state, control, parameters) =
            (Components::splat(one), Components::splat(one), Components::splat(one));
        let tangent = D::tangent(point, &state, &control, &parameters);
        if tangent.as_ref().iter().any(|x| *x != D::Scalar::of(0.0)) {
            return all_finite(tangent.as_ref());
        }
        let (state, control, parameters) = D::adjoint(point, &state);
        let adjoint = [state.as_ref(), control.as_ref(), parameters.as_ref()];
        if adjoint.iter().any(|part| part.iter().any(|x| *x != D::Scalar::of(0.0))) {
            return adjoint.iter().all(|part| all_finite(part));
        }
        let (state, control, parameters) = D::columns::<All>(point);
        let columns = state.as_ref().iter().chain(control.as_ref()).chain(parameters.as_ref());
        columns.fold(true, |all, column| all & all_finite(column.as_ref()))
    }
}

/// The selection of all derivatives.
struct All;

impl DerivativeSelection for All {
    const STATE: bool = true;
    const CONTROL: bool = true;
    const PARAMETERS: bool = true;
}

/// The columns of derivatives with respect to state, controls and parameters.
pub type AllColumns<S, T> = PerturbationArrays<S, StatePerturbation<S, T>>;

#[diagnostic::do_not_recommend]
impl<T: Batch, S: Differentiable, K: Linearized<T, S>> Linearizable<S> for OneStep<T, K> {
    type Trace = K::Unknown;
    type Derivative = K::Point;

    #[inline]
    fn trace(&self) -> K::Unknown {
        self.solution()
    }

    #[inline]
    fn replay(&self, start: &StartOf<'_, Self>, trace: &K::Unknown) -> K::State {
        self.next(start.state, start.time, start.control, trace)
    }

    #[inline(always)]
    fn derivative(&self, start: &StartOf<'_, Self>, trace: &K::Unknown) -> K::Point {
        K::point(start.parameters, start.step, start.state, start.time, start.control, trace)
    }

    #[inline]
    fn tangent(
        point: &K::Point,
        state: &StatePerturbation<S, T>,
        control: &ControlPerturbation<S, T>,
        parameters: &ParameterPerturbation<S, T>,
    ) -> StatePerturbation<S, T> {
        K::tangent(point, state, control, parameters)
    }

    #[inline]
    fn adjoint(point: &K::Point, costate: &StatePerturbation<S, T>) -> PerturbationArrays<S, T> {
        K::adjoint(point, costate)
    }

    #[inline(always)]
    fn columns<W: DerivativeSelection>(point: &K::Point) -> AllColumns<S, T> {
        // no closures: these would not be compiled for the processor that this is compiled for
        let through = &K::through(point);
        let wrt_state = if W::STATE { K::wrt_state(point, through) } else { no_columns::<T, _, _>() };
        let wrt_control = if W::CONTROL { K::wrt_control(point, through) } else { no_columns::<T, _, _>() };
        let wrt_parameters =
            if W::PARAMETERS { K::wrt_parameters(point, through) } else { no_columns::<T, _, _>() };
        (wrt_state, wrt_control, wrt_parameters)
    }
}

/// Takes derivatives back through one stage of a step: those with respect to the state are replaced; those with respect to controls and
/// parameters are added to what the later stages contribute.
fn back<S: Differentiable, D: Linearizable<S>>(
    derivative: &D::Derivative,
    (costate, mut control, mut parameters): PerturbationArrays<S, D::Scalar>,
) -> PerturbationArrays<S, D::Scalar> {
    let (state, here, own) = D::adjoint(derivative, &costate);
    add(control.as_mut(), here.as_ref());
    add(parameters.as_mut(), own.as_ref());
    (state, control, parameters)
}

/// Where taking derivatives back begins.
fn end<S: Differentiable, D: Linearizable<S>>(
    costate: &StatePerturbation<S, D::Scalar>,
) -> PerturbationArrays<S, D::Scalar> {
    (*costate, zeros(), zeros())
}

/// The selection for the stages of a composed step, from that for the whole step.
struct OfStages<W>(core::marker::PhantomData<W>);

impl<W: DerivativeSelection> DerivativeSelection for OfStages<W> {
    const STATE: bool = true;
    const CONTROL: bool = W::CONTROL;
    const PARAMETERS: bool = W::PARAMETERS;
}

/// The derivatives of the stages so far, followed by one more: the chain rule.
fn chain<S: Differentiable, D: Linearizable<S>, W: DerivativeSelection>(
    derivative: &D::Derivative,
    (mut state, mut control, mut parameters): AllColumns<S, D::Scalar>,
) -> AllColumns<S, D::Scalar> {
    let (wrt_state, wrt_control, wrt_parameters) = D::columns::<OfStages<W>>(derivative);
    let through = |column: &StatePerturbation<S, D::Scalar>, mut sum: StatePerturbation<S, D::Scalar>| {
        for (coefficient, column) in column.as_ref().iter().zip(wrt_state.as_ref()) {
            for (sum, entry) in sum.as_mut().iter_mut().zip(column.as_ref()) {
                *sum = entry.mul_add(*coefficient, *sum);
            }
        }
        sum
    };
    if W::STATE {
        state.as_mut().iter_mut().for_each(|column| *column = through(column, zeros()));
    }
    for (column, own) in control.as_mut().iter_mut().zip(wrt_control.as_ref()) {
        if W::CONTROL {
            *column = through(column, *own);
        }
    }
    for (column, own) in parameters.as_mut().iter_mut().zip(wrt_parameters.as_ref()) {
        if W::PARAMETERS {
            *column = through(column, *own);
        }
    }
    (state, control, parameters)
}

/// The derivatives before the first stage.
fn start<S: Differentiable, D: Linearizable<S>>() -> AllColumns<S, D::Scalar> {
    let mut state: StatePerturbation<S, StatePerturbation<S, D::Scalar>> = no_columns::<D::Scalar, _, _>();
    for (i, column) in state.as_mut().iter_mut().enumerate() {
        column.as_mut()[i] = D::Scalar::of(1.0);
    }
    (state, no_columns::<D::Scalar, _, _>(), no_columns::<D::Scalar, _, _>())
}

#[diagnostic::do_not_recommend]
impl<S, A, B> Linearizable<S> for AdjointPair<A, B>
where
    S: Differentiable,
    A: Linearizable<S>,
    B: Linearizable<
            S,
            Scalar = A::Scalar,
            Parameters = A::Parameters,
            State = A::State,
            Control = A::Control,
        >,
{
    type Trace = (A::Trace, B::Trace);
    type Derivative = (A::Derivative, B::Derivative);

    fn trace(&self) -> Self::Trace {
        (self.first.trace(), self.second.trace())
    }

    fn replay(&self, start: &StartOf<'_, A>, (first, second): &Self::Trace) -> A::State {
        let middle = self.first.replay(start, first);
        self.second.replay(&start.stage(&middle, start.time + self.half, self.half), second)
    }

    fn derivative(&self, start: &StartOf<'_, A>, (first, second): &Self::Trace) -> Self::Derivative {
        let middle = self.first.replay(start, first);
        let half = |state, time| start.stage(state, time, self.half);
        let second = self.second.derivative(&half(&middle, start.time + self.half), second);
        (self.first.derivative(&half(start.state, start.time), first), second)
    }

    fn tangent(
        (first, second): &Self::Derivative,
        state: &StatePerturbation<S, A::Scalar>,
        control: &ControlPerturbation<S, A::Scalar>,
        parameters: &ParameterPerturbation<S, A::Scalar>,
    ) -> StatePerturbation<S, A::Scalar> {
        B::tangent(second, &A::tangent(first, state, control, parameters), control, parameters)
    }

    fn adjoint(
        (first, second): &Self::Derivative,
        costate: &StatePerturbation<S, A::Scalar>,
    ) -> PerturbationArrays<S, A::Scalar> {
        back::<S, A>(first, back::<S, B>(second, end::<S, B>(costate)))
    }

    fn columns<W: DerivativeSelection>((first, second): &Self::Derivative) -> AllColumns<S, A::Scalar> {
        chain::<S, B, W>(second, A::columns::<W>(first))
    }
}

#[diagnostic::do_not_recommend]
impl<S: Differentiable, C: Coefficients, B: Linearizable<S>> Linearizable<S> for Composition<C, B> {
    type Trace = C::Steps<B::Trace>;
    type Derivative = C::Steps<B::Derivative>;

    fn trace(&self) -> Self::Trace {
        C::steps(|k| self.steps.as_ref()[k].trace())
    }

    fn replay(&self, start: &StartOf<'_, B>, trace: &Self::Trace) -> B::State {
        let (mut state, mut done) = (*start.state, 0.0);
        for ((part, trace), gamma) in self.steps.as_ref().iter().zip(trace.as_ref()).zip(C::GAMMA) {
            let time = start.time + B::Scalar::of(done) * self.step;
            state = part.replay(&start.stage(&state, time, B::Scalar::of(*gamma) * self.step), trace);
            done += gamma;
        }
        state
    }

    fn derivative(&self, start: &StartOf<'_, B>, trace: &Self::Trace) -> Self::Derivative {
        let (mut state, mut done) = (*start.state, 0.0);
        C::steps(|k| {
            let (part, trace, gamma) = (&self.steps.as_ref()[k], &trace.as_ref()[k], C::GAMMA[k]);
            let time = start.time + B::Scalar::of(done) * self.step;
            let stage = start.stage(&state, time, B::Scalar::of(gamma) * self.step);
            let (derivative, next) = (part.derivative(&stage, trace), part.replay(&stage, trace));
            state = next;
            done += gamma;
            derivative
        })
    }

    fn tangent(
        derivative: &Self::Derivative,
        state: &StatePerturbation<S, B::Scalar>,
        control: &ControlPerturbation<S, B::Scalar>,
        parameters: &ParameterPerturbation<S, B::Scalar>,
    ) -> StatePerturbation<S, B::Scalar> {
        let parts = derivative.as_ref().iter();
        parts.fold(*state, |state, part| B::tangent(part, &state, control, parameters))
    }

    fn adjoint(
        derivative: &Self::Derivative,
        costate: &StatePerturbation<S, B::Scalar>,
    ) -> PerturbationArrays<S, B::Scalar> {
        derivative.as_ref().iter().rfold(end::<S, B>(costate), |later, part| back::<S, B>(part, later))
    }

    fn columns<W: DerivativeSelection>(derivative: &Self::Derivative) -> AllColumns<S, B::Scalar> {
        derivative.as_ref().iter().fold(start::<S, B>(), |earlier, stage| chain::<S, B, W>(stage, earlier))
    }
}

/// Carrying the momentum changes what rounding makes of it, not the map.
#[diagnostic::do_not_recommend]
impl<S, B> Linearizable<S> for ConservedMomentum<S, B>
where
    S: Isolated + Differentiable,
    B: Linearizable<S>,
    B: Method<State = S::StateComponents<<B as Method>::Scalar>>,
{
    type Trace = B::Trace;
    type Derivative = B::Derivative;

    fn trace(&self) -> B::Trace {
        self.base.trace()
    }

    fn replay(&self, start: &StartOf<'_, B>, trace: &B::Trace) -> B::State {
        self.base.replay(start, trace)
    }

    fn derivative(&self, start: &StartOf<'_, B>, trace: &B::Trace) -> B::Derivative {
        self.base.derivative(start, trace)
    }

    fn tangent(
        derivative: &B::Derivative,
        state: &StatePerturbation<S, B::Scalar>,
        control: &ControlPerturbation<S, B::Scalar>,
        parameters: &ParameterPerturbation<S, B::Scalar>,
    ) -> StatePerturbation<S, B::Scalar> {
        B::tangent(derivative, state, control, parameters)
    }

    fn adjoint(
        derivative: &B::Derivative,
        costate: &StatePerturbation<S, B::Scalar>,
    ) -> PerturbationArrays<S, B::Scalar> {
        B::adjoint(derivative, costate)
    }

    fn columns<W: DerivativeSelection>(derivative: &B::Derivative) -> AllColumns<S, B::Scalar> {
        B::columns::<W>(derivative)
    }
}
