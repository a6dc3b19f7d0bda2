//! Steps with their derivatives.

use core::marker::PhantomData;

use super::{DerivativeOf, HasDerivative, JacobianBlocksOf, StartOf, StepDerivative, StepStart};
use crate::error::StepError;
use crate::method::Method;
use crate::scalar::{Batch, Scalar, Work};
use crate::stepper::{StepReport, Stepper};
use crate::system::{Control, Discretized, MethodOf, State, System};

/// The derivatives of the last step, which started so.
struct JacobianWork<'a, D: Method, B> {
    method: &'a D,
    start: StartOf<'a, D>,
    blocks: PhantomData<B>,
}

impl<S: System, D: MethodOf<S>, B: JacobianBlocksOf<S, D>> Work for JacobianWork<'_, D, (S, B)> {
    type CallSite = D::CallSite;
    type Result = B::Jacobian;

    #[inline(always)]
    fn done(self) -> B::Jacobian {
        B::matrices(self.method, &self.start)
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
        let is_finite = S::Method::<S::Scalar>::is_finite;
        let (derivative, report) =
            self.differentiated(state, control, |method, start| method.last_derivative(&start), is_finite)?;
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
    ) -> Result<(B::Jacobian, StepReport), StepError>
    where
        B: JacobianBlocksOf<S, S::Method<S::Scalar>>,
    {
        // for wide registers where there are some: what comes of it is the same, the operations are
        let blocks = PhantomData::<(S, B)>;
        self.differentiated(
            state,
            control,
            |method, start| S::Scalar::dispatch_fused(JacobianWork { method, start, blocks }),
            B::is_finite,
        )
    }

    /// Takes one step, and gives what is made of its method and its start; takes it back if that is not finite.
    #[inline(always)]
    fn differentiated<J>(
        &mut self,
        state: &mut S::State,
        control: &S::Control,
        of: impl FnOnce(&S::Method<S::Scalar>, StartOf<'_, S::Method<S::Scalar>>) -> J,
        is_finite: impl FnOnce(&J) -> bool,
    ) -> Result<(J, StepReport), StepError> {
        let (components, time, before) =
            (state.to_components(), S::Scalar::of(self.time()), (state.clone(), self.left));
        let report = self.step_with(state, control)?;
        let (parameters, control) = (&self.system.to_parameters(), &control.to_components());
        let start = StepStart { parameters, step: self.step, state: &components, time, control };
        let made = of(&self.method, start);
        if is_finite(&made) { Ok((made, report)) } else { Err(self.take_back(state, before)) }
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
