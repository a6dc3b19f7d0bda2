//! What a system makes: what takes its Taylor steps. What it does stands in [`taylor`](crate::taylor).

#[cfg(doc)]
use super::System;
use super::series::{MOST_COEFFICIENTS, PowerSeries, Series};
use crate::error::ParameterError;
use crate::scalar::{Batch, Components as _, Scalar};

/// The lowest order: the rule for the step looks at the last two terms.
pub(crate) const LEAST_ORDER: usize = 4;

/// Takes Taylor steps along one trajectory, each as long as the tolerance allows.
///
/// Built by [`System::adaptive`]. The local error of a step, relative to the largest of what has the same unit, is about the tolerance.
/// Time is carried in twice the digits.
pub struct Adaptive<S: PowerSeries> {
    pub(crate) system: S,
    pub(crate) tolerance: f64,
    /// A step that is always the same, if it is.
    pub(crate) fixed: Option<f64>,
    /// No step is longer.
    pub(crate) most: f64,
    /// No step goes past this time, if it is one.
    pub(crate) end: f64,
    /// The time in two numbers.
    pub(crate) time: [f64; 2],
    pub(crate) taken: u64,
    /// The last step: how long it was.
    pub(crate) last: Option<f64>,
    /// When it started; not a number where the series are not those of the last step.
    pub(crate) from: f64,
    pub(crate) series: Series<S, S::Scalar>,
    /// The largest that an input has been.
    pub(crate) sizes: S::ControlComponents<f64>,
}

impl<S: PowerSeries> Adaptive<S> {
    pub(crate) fn new(system: &S, tolerance: f64) -> Result<Self, ParameterError> {
        system.validate()?;
        if !(tolerance > 0.0 && tolerance < 1.0) {
            return Err(ParameterError::Tolerance { tolerance });
        }
        // no number has more digits
        let attainable = tolerance.max(S::Scalar::EPSILON / 2.0);
        // one more than what is whole of it, which rounds up
        let order = 2 - (0.5 * Scalar::ln(attainable)) as i32;
        Ok(Self {
            system: S::from_parameters(&system.to_parameters()),
            tolerance,
            fixed: None,
            most: f64::INFINITY,
            end: f64::INFINITY,
            time: [0.0; 2],
            taken: 0,
            last: None,
            from: f64::NAN,
            series: Series::new((order as usize).clamp(LEAST_ORDER, MOST_COEFFICIENTS)),
            sizes: S::ControlComponents::splat(0.0),
        })
    }
}
