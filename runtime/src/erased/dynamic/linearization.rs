//! The derivative of a step that is made at run time.

use std::sync::Arc;
use std::vec::Vec;

use super::kernel::{DynamicKernel, Frame, Handled, OfKernel, of_kernel};
use super::step::{Solution, Step, StepDerivative, StepFunction};
use crate::erased::jacobian::Linearization;
use crate::erased::system::At;
use crate::error::StepError;
use crate::kernel::{AtState, Kernel};
use crate::scalar::simd::frame::Joined;
use crate::solve;

/// Solves a step, and differentiates it there.
pub(super) fn linearization(
    step: &Arc<Step>,
    derivative: &dyn StepDerivative,
    parameters: &[f64],
    at: &At<'_>,
) -> Result<Linearization, StepError> {
    let (unknown, next) = of_kernel(step, OfSolution { parameters, at })?;
    let At { step: step_size, state, time, control } = *at;
    let solution = Solution { parameters, step_size, state, time, control, unknown: &unknown };
    Ok(Linearization { next, jacobian: derivative.jacobian(&solution) })
}

struct OfSolution<'a> {
    parameters: &'a [f64],
    at: &'a At<'a>,
}

impl OfKernel<f64> for OfSolution<'_> {
    /// The unknown, and the state after the step.
    type Made = Result<(Vec<f64>, Vec<f64>), StepError>;

    fn made<const U: usize>(self, step: &Arc<Step>) -> Self::Made {
        let At { step: length, state, time, control } = *self.at;
        let mut frame = Frame::new(step, self.parameters, length);
        frame.write(step.layout.state.clone(), state);
        frame.write(step.layout.control.clone(), control);
        frame.rows[step.layout.time] = time;
        frame.call(step, StepFunction::Begin);
        let mut joined = Joined::new(frame, step, |handle: Handled<f64>| DynamicKernel::<f64, U>(handle));
        let kernel = *joined.user();
        let unknown = solve::cold(&AtState { kernel: &kernel, state: &[], step: &[] })?;
        let evaluation = kernel.evaluate(&[], &[], &unknown);
        kernel.finish(&[], &[], &unknown, &evaluation);
        let next = joined.frame().read(step.layout.next.clone()).collect();
        Ok((unknown[..step.layout.unknown.len()].to_vec(), next))
    }
}
