//! Derivatives of steps of any system and scheme.

use nalgebra::DMatrix;
use std::string::{String, ToString};
use std::vec::Vec;

use thiserror::Error;

use super::system::{At, System};
use crate::derivative::{Differentiable, Linearized, LinearizedVisitor, Parts};
use crate::error::StepError;
use crate::flat::array;
use crate::kernel::{self, AtState, Kernel};
use crate::scalar::Components;
use crate::schemes::Scheme;
use crate::solve;
use crate::system;

/// The derivatives of the state after a step, in [left-trivialized coordinates](crate::derivative#coordinates); no columns where the description does
/// not ask for them.
pub type Jacobian = Parts<DMatrix<f64>>;

/// A step that could not be taken with its derivatives.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum JacobianError {
    /// The step itself could not be taken, or has no derivative.
    #[error(transparent)]
    Step(#[from] StepError),
    /// No derivatives of a step that the scheme is made of were generated, or no matrices.
    #[error(
        "no {key} of the scheme `{scheme}` were generated for `{system}`; `{key}` in its description asks for them"
    )]
    NotGenerated {
        /// The key of the description that asks for them: `derivatives` or `derivatives(state)`.
        key: &'static str,
        /// The scheme.
        scheme: String,
        /// The system's name.
        system: &'static str,
    },
}

/// A generated step with its derivatives.
pub struct Linearization {
    /// The state that it leads to.
    pub next: Vec<f64>,
    /// Its derivatives, as they are computed.
    pub jacobian: Jacobian,
}

/// Differentiates a generated step.
pub(super) struct OfDerivatives<'a> {
    pub(super) parameters: &'a [f64],
    pub(super) at: &'a At<'a>,
}

impl<S: system::System<Scalar = f64>> LinearizedVisitor<S> for OfDerivatives<'_> {
    type Output = Result<Linearization, StepError>;

    fn visit<K>(self) -> Self::Output
    where
        S: Differentiable,
        K: Linearized<f64, S>
            + Kernel<
                f64,
                Parameters = S::Parameters<f64>,
                State = S::StateComponents<f64>,
                Control = S::ControlComponents<f64>,
            >,
    {
        let At { step, time, .. } = *self.at;
        let (parameters, state, control) =
            (array(self.parameters), array(self.at.state), array(self.at.control));
        let kernel: K = kernel::new(&parameters, step);
        let begun = kernel.begin(&state, time, &control);
        let equation = AtState { kernel: &kernel, state: &state, step: &begun };
        let unknown = solve::cold(&equation)?;
        let evaluation = kernel.evaluate(&state, &begun, &unknown);
        let next = kernel.finish(&state, &begun, &unknown, &evaluation).as_ref().to_vec();
        let point = K::point(&parameters, step, &state, time, &control, &unknown);
        let through = K::through(&point);
        let rows = S::StatePerturbation::<f64>::LENGTH;
        let [state, control, parameters] = K::MATRICES;
        let jacobian = Jacobian {
            state: dense(rows, state, K::wrt_state(&point, &through).as_ref()),
            control: dense(rows, control, K::wrt_control(&point, &through).as_ref()),
            parameters: dense(rows, parameters, K::wrt_parameters(&point, &through).as_ref()),
        };
        Ok(Linearization { next, jacobian })
    }
}

/// The matrix of these columns, if they are asked for.
fn dense<C: AsRef<[f64]>>(rows: usize, is_asked_for: bool, columns: &[C]) -> DMatrix<f64> {
    let columns = if is_asked_for { columns } else { &[] };
    let entries = columns.iter().flat_map(|column| column.as_ref().iter().copied());
    DMatrix::from_iterator(rows, columns.len(), entries)
}

/// Differentiates a step of a scheme, by the chain rule.
pub(super) fn jacobian(system: &dyn System, scheme: &Scheme, at: &At<'_>) -> Result<Jacobian, JacobianError> {
    let description = system.description();
    let (mut state, mut time) = (at.state.to_vec(), at.time);
    let mut whole: Option<Jacobian> = None;
    for (map, rule, step) in scheme.parts(description.invariant, at.step) {
        let part = At { step, state: &state, time, control: at.control };
        let missing = |key: &'static str| JacobianError::NotGenerated {
            key,
            scheme: scheme.to_string(),
            system: description.name,
        };
        let Linearization { next, jacobian } =
            system.linearization(map, rule, &part).ok_or_else(|| missing("derivatives"))??;
        // who asks for another matrix has that with respect to the state, too
        if !jacobian.state.is_square() {
            return Err(missing("derivatives(state)"));
        }
        whole = Some(match whole {
            None => jacobian,
            Some(before) => Jacobian {
                control: &jacobian.state * before.control + jacobian.control,
                parameters: &jacobian.state * before.parameters + jacobian.parameters,
                state: jacobian.state * before.state,
            },
        });
        (state, time) = (next, time + step);
    }
    let jacobian = whole.ok_or(StepError::NoDerivative)?;
    let parts = [&jacobian.state, &jacobian.control, &jacobian.parameters];
    match parts.iter().all(|part| part.iter().all(|x| x.is_finite())) {
        true => Ok(jacobian),
        false => Err(StepError::NoDerivative.into()),
    }
}
