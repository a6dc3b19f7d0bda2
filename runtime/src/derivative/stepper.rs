//! Steps with their derivatives.

use core::marker::PhantomData;

use super::{
    DerivativeOf, Differentiable, HasDerivative, JacobianBlocksOf, Linearizable, StepDerivative, StepJacobian,
};
use crate::error::StepError;
use crate::scalar::{Batch, Scalar, Work};
use crate::stepper::{StepReport, Stepper};
use crate::system::{Control, Discretized, MethodOf, State, System};

/// The derivatives of the last step, which started so.
struct JacobianWork<'a, S: System, M, D, B> {
    stepper: &'a Stepper<S, M, D>,
    state: &'a S::StateComponents<S::Scalar>,
    time: S::Scalar,
    control: &'a S::ControlComponents<S::Scalar>,
    blocks: PhantomData<B>,
}

impl<S: System, M, D: MethodOf<S>, B: JacobianBlocksOf<S, D>> Work for JacobianWork<'_, S, M, D, B> {
    type CallSite = D::CallSite;
    type Result = B::Jacobian;

    #[inline(always)]
    fn done(self) -> B::Jacobian {
        let Self { stepper: Stepper { system, method, step, .. }, state, time, control, .. } = self;
        B::matrices(method, &system.to_parameters(), *step, state, time, control)
    }
}

// what derivatives need is asked for by each function, in one word, so that the compiler says what is missing where it is, and once
impl<S: Discretized<M>, M> Stepper<S, M> {
    /// Takes one step with `control` held from its start to its end, and gives its [derivative](crate::derivative) as a linear map.
    ///
    /// # Errors
    /// As [`step_with`](Self::step_with), or if the step has [no derivative](StepError::NoDerivative). State and time
    /// are then as before.
    #[inline]
    pub fn step_with_derivative(
        &mut self,
        state: &mut S::State,
        control: &S::Control,
    ) -> Result<(DerivativeOf<S, M>, StepReport), StepError>
    where
        S::Method<S::Scalar>: HasDerivative<S>,
    {
        let (components, time, before) =
            (state.to_components(), S::Scalar::of(self.time()), (state.clone(), self.left));
        let report = self.step_with(state, control)?;
        let (parameters, control) = (self.system.to_parameters(), control.to_components());
        let derivative = self.method.last_derivative(&parameters, self.step, &components, time, &control);
        if !S::Method::<S::Scalar>::is_finite(&derivative) {
            return Err(self.take_back(state, before));
        }
        Ok((StepDerivative::new(derivative), report))
    }

    /// Takes one step with `control` held from its start to its end, and gives the derivatives of the next state that are asked for:
    /// [`WrtState`](crate::derivative::WrtState), [`WrtControl`](crate::derivative::WrtControl),
    /// [`WrtParameters`](crate::derivative::WrtParameters), or several of them, `(WrtState, WrtControl)`. In [left-trivialized
    /// coordinates](crate::derivative#coordinates).
    ///
    /// # Errors
    /// As [`step_with`](Self::step_with), or if the step has [no derivative](StepError::NoDerivative). State and time
    /// are then as before.
    #[inline]
    pub fn step_with_jacobian<B>(
        &mut self,
        state: &mut S::State,
        control: &S::Control,
        _: B,
    ) -> Result<StepJacobian<B::Jacobian>, StepError>
    where
        B: JacobianBlocksOf<S, S::Method<S::Scalar>>,
    {
        let (components, time, before) =
            (state.to_components(), S::Scalar::of(self.time()), (state.clone(), self.left));
        let report = self.step_with(state, control)?;
        let work = JacobianWork::<S, M, S::Method<S::Scalar>, B> {
            stepper: self,
            state: &components,
            time,
            control: &control.to_components(),
            blocks: PhantomData,
        };
        // for wide registers where there are some: what comes of it is the same, the operations are
        let jacobian = S::Scalar::dispatch_fused(work);
        if !B::is_finite(&jacobian) {
            return Err(self.take_back(state, before));
        }
        Ok(StepJacobian { jacobian, report })
    }

    /// Takes back a step that has no derivative.
    #[cold]
    fn take_back(
        &mut self,
        state: &mut S::State,
        (start, left): (S::State, Option<S::StateComponents<S::Scalar>>),
    ) -> StepError {
        *state = start;
        self.left = left;
        self.taken -= 1;
        StepError::NoDerivative
    }
}

impl<S: Differentiable, M, D: MethodOf<S> + Linearizable<S>> Stepper<S, M, D> {
    /// The solutions of the last step's equations.
    #[cfg(feature = "std")]
    pub(crate) fn trace(&self) -> D::Trace {
        self.method.trace()
    }

    /// The derivative of a step of this size.
    #[inline(always)]
    #[cfg(feature = "std")]
    pub(crate) fn derivative(
        &self,
        state: &S::StateComponents<S::Scalar>,
        time: S::Scalar,
        control: &S::ControlComponents<S::Scalar>,
        trace: &D::Trace,
    ) -> D::Derivative {
        self.method.derivative(&self.system.to_parameters(), self.step, state, time, control, trace)
    }
}
