//! What a system makes: what takes its Taylor steps. What it does stands in [`taylor`](crate::taylor).

#[cfg(doc)]
use super::System;
use super::series::{MOST_COEFFICIENTS, PowerSeries, Series};
use crate::error::ParameterError;
use crate::scalar::{Batch, Scalar};
use crate::taylor::Pace;

/// The lowest order: the rule for the step looks at the last two terms.
pub(crate) const LEAST_ORDER: usize = 4;

/// Takes Taylor steps along one trajectory, each as long as the tolerance allows.
///
/// Built by [`System::adaptive`]. The local error of a step, relative to the largest of what has the same unit, is about the tolerance.
/// Time is carried in twice the digits.
pub struct Adaptive<S: PowerSeries> {
    pub(crate) system: S,
    pub(crate) tolerance: f64,
    pub(crate) pace: Pace,
    pub(crate) series: Series<S, S::Scalar>,
}

impl<S: PowerSeries> Adaptive<S> {
    pub(crate) fn new(system: &S, tolerance: f64) -> Result<Self, ParameterError> {
        system.validate()?;
        let order = order(tolerance, S::Scalar::EPSILON)?;
        Ok(Self {
            system: S::from_parameters(&system.to_parameters()),
            tolerance,
            pace: Pace::default(),
            series: Series::new(order),
        })
    }
}

/// The order of steps to a tolerance, of numbers with this distance from 1 to the next.
pub(crate) fn order(tolerance: f64, unit: f64) -> Result<usize, ParameterError> {
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(ParameterError::Tolerance { tolerance });
    }
    // no number has more digits
    let attainable = tolerance.max(unit / 2.0);
    // one more than what is whole of it, which rounds up
    let order = 2 - (0.5 * Scalar::ln(attainable)) as i32;
    Ok((order as usize).clamp(LEAST_ORDER, MOST_COEFFICIENTS))
}
