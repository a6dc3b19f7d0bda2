//! What a system makes: a stepper. What it does stands in [`stepper`](crate::stepper).

use core::marker::PhantomData;

use super::{Discretized, MethodOf, System};
use crate::error::ParameterError;
use crate::scalar::Real;

/// Takes steps of one size through the motion of one system, with the scheme `M`.
///
/// Built by [`System::stepper`]. The result of a step depends on the state, the time and the control alone, up to roundoff: the
/// stepper only remembers where the last solutions were, to start the next one where they point. It counts the time from 0, or from where
/// [`set_time`](Self::set_time) put it; systems that do not depend on time take no notice. The method `D` follows from system and scheme.
///
/// Its size is that of sixteen earlier solutions, the state, and what depends on the parameters: with three unknowns 0.8 to 1.0 kB, and 1.4 to 1.9 kB
/// where a step solves two equations, as [`StormerVerlet`](crate::StormerVerlet) does on most groups; up to 0.2 kB more where there are many
/// parameters or advected ones. A composition has one for each of its steps.
pub struct Stepper<S: System, M, D = <S as Discretized<M>>::Method<<S as System>::Scalar>> {
    pub(crate) system: S,
    pub(crate) method: D,
    pub(crate) scheme: PhantomData<fn() -> M>,
    pub(crate) step: S::Scalar,
    /// The time before the steps counted by `taken`.
    pub(crate) start: f64,
    /// Steps since `start`, all of this size.
    pub(crate) taken: u64,
    /// Steps before these, of other sizes.
    pub(crate) before: u64,
    /// The state that the last step led to.
    pub(crate) left: Option<S::StateComponents<S::Scalar>>,
}

impl<S: System, M, D: MethodOf<S>> Stepper<S, M, D> {
    pub(crate) fn new(system: &S, step: S::Scalar) -> Result<Self, ParameterError> {
        system.validate()?;
        check_step(step.to_f64())?;
        let parameters = system.to_parameters();
        let system = S::from_parameters(&parameters);
        let method = D::new(&parameters, step);
        Ok(Self { system, method, scheme: PhantomData, step, start: 0.0, taken: 0, before: 0, left: None })
    }
}

/// A step leads somewhere.
pub(crate) fn check_step(step: f64) -> Result<(), ParameterError> {
    if step.is_finite() && step != 0.0 { Ok(()) } else { Err(ParameterError::Step { step }) }
}
