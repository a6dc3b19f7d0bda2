//! The motion as a vector field on lists of stored numbers, and steps along it that were not generated: those of methods that know nothing
//! of groups, to compare with.

use std::sync::Arc;
use std::vec::Vec;

use super::system::{At, Geometry, System, length};
use crate::error::StepError;
use crate::flat::Method;
use crate::method::{Advanced, Counted, Failure};
use crate::retraction::RetractionKind;
use crate::system::{Quantity, Role};

/// How far a configuration is moved along a direction that turns it, in radians: differences of order 8 then miss about as much as rounding.
const TURN: f64 = 1.0 / 32.0;

/// Of central differences of order 8.
const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

/// The derivative of the stored numbers along the motion.
pub(super) fn vector_field(system: &dyn Geometry, state: &[f64], time: f64, control: &[f64]) -> Vec<f64> {
    let motion = system.motion(state, time, control);
    // of a state with fewer numbers the rest is zero
    let mut rates = std::vec![0.0; length(system.description().state)];
    for (quantity, stored) in Quantity::with_ranges(system.description().state) {
        let rates = &mut rates[stored.clone()];
        if quantity.role != Role::Configuration {
            rates.copy_from_slice(&motion[quantity.tangent()]);
            continue;
        }
        for direction in quantity.tangent().filter(|direction| motion[*direction] != 0.0) {
            let change = along(system, state, direction, motion.len(), stored.clone());
            rates.iter_mut().zip(change).for_each(|(rate, change)| *rate += motion[direction] * change);
        }
    }
    rates
}

/// How the stored numbers of a configuration change along one direction of the algebra: by differences of displacements, which know how each
/// group is stored, to some parts in 10¹⁵.
fn along(
    system: &dyn Geometry,
    state: &[f64],
    direction: usize,
    length: usize,
    stored: core::ops::Range<usize>,
) -> Vec<f64> {
    let at = |by: f64| {
        let mut tangent = std::vec![0.0; length];
        tangent[direction] = by;
        system.displace(state, RetractionKind::Exponential, &tangent)[stored.clone()].to_vec()
    };
    let difference = |by: f64, weight: f64| -> Vec<f64> {
        at(by).iter().zip(at(-by)).map(|(after, before)| (after - before) * (weight / by)).collect()
    };
    let (after, here, before) = (at(1.0), at(0.0), at(-1.0));
    let size = here.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    let bends = after.iter().zip(&here).zip(&before).map(|((a, x), b)| (a - x - x + b).abs());
    if bends.fold(0.0, f64::max) <= 1e-12 * size {
        // a straight line: as far as the numbers are large, so that nothing of the difference is lost beside them
        return difference(size.log2().ceil().exp2(), 0.5);
    }
    let mut sum = std::vec![0.0; here.len()];
    for (k, weight) in (1..).zip(WEIGHTS) {
        let part = difference(f64::from(k) * TURN, f64::from(k) * weight);
        sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
    }
    sum
}

/// Writes the state after a step of a system to its last argument, and returns how many iterations that took.
pub(super) type StepFn = dyn Fn(&dyn System, &At<'_>, &mut [f64]) -> Result<u32, StepError> + Send + Sync;

/// A step that was not generated.
pub(super) struct ByFunction {
    pub(super) system: Arc<dyn System>,
    pub(super) step: f64,
    pub(super) function: Arc<StepFn>,
}

impl Method<f64> for ByFunction {
    fn advance(
        &mut self,
        state: &[f64],
        next: &mut [f64],
        time: f64,
        control: &[f64],
        _: bool,
    ) -> Counted<f64> {
        let at = At { step: self.step, state, time, control };
        let (iterations, error) = match (self.function)(&*self.system, &at, next) {
            Ok(iterations) if next.iter().all(|x| x.is_finite()) => (iterations, None),
            Ok(iterations) => (iterations, Some(StepError::NotFinite)),
            Err(error) => (0, Some(error)),
        };
        let advanced = Advanced { state: (), iterations: [iterations], residual: 0.0 };
        if error.is_none() { Ok(advanced) } else { Err(Failure { errors: [error], advanced }) }
    }

    // it remembers nothing
    fn memory(&mut self, _: &mut dyn FnMut(&mut [f64])) {}
}
