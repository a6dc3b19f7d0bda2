//! A kernel's Newton correction against differences of its residual.

use nalgebra::{DMatrix, DVector};

use super::frame::{larger, slope};
use crate::erased::{At, Equation, equation};
use crate::kernel::Kernel;

/// A state at which kernels show their Newton corrections.
pub struct Probe<'a> {
    pub(super) parameters: &'a [f64],
    pub(super) state: &'a [f64],
    pub(super) time: f64,
    pub(super) control: &'a [f64],
    /// The largest difference so far, if there was anything to solve for.
    pub(super) worst: Option<f64>,
}

impl Probe<'_> {
    /// Compares the correction of a kernel of the system with the one that a Jacobian of differences makes, at a point off the solution.
    pub fn kernel<K: Kernel<f64> + 'static>(&mut self, step: f64) {
        let Self { parameters, state, time, control, .. } = *self;
        self.compare(&*equation::<K>(parameters, step, state, time, control));
    }

    /// Where equations are looked at, of a step of this length.
    pub(super) fn at(&self, step: f64) -> At<'_> {
        At { step, state: self.state, time: self.time, control: self.control }
    }

    pub(super) fn compare(&mut self, equation: &dyn Equation) {
        let mut unknown = equation.start();
        let largest = unknown.iter().fold(0.0, |x: f64, y| x.max(y.abs()));
        // a component that is small may be so by chance; turns, which stand beside momenta of any size, count in radians
        let floor = if largest > 0.0 { (1e-3 * largest).min(1.0) } else { 0.1 };
        let scales: Vec<f64> = unknown.iter().map(|x| x.abs().max(floor)).collect();
        if scales.is_empty() {
            return;
        }
        for (i, (x, scale)) in unknown.iter_mut().zip(&scales).enumerate() {
            *x += 0.1 * scale * (1.0 + i as f64).sin();
        }
        let residual = |unknown: &[f64]| DVector::from(equation.residual(unknown));
        let columns: Vec<_> = scales
            .iter()
            .enumerate()
            .map(|(i, scale)| {
                // in units in which all corrections are alike
                slope(1e-2 * scale, &|at| {
                    let mut there = unknown.clone();
                    there[i] += at;
                    residual(&there)
                }) * *scale
            })
            .collect();
        let correction = equation.correction(&unknown);
        let correction = correction.iter().zip(&scales).map(|(correction, scale)| correction / scale);
        let correction = DVector::from_iterator(scales.len(), correction);
        let difference = match DMatrix::from_columns(&columns).lu().solve(&residual(&unknown)) {
            Some(expected) => (correction - &expected).norm() / expected.norm().max(f64::MIN_POSITIVE),
            None => f64::NAN,
        };
        self.worst = Some(self.worst.map_or(difference, |worst| larger(worst, difference)));
    }
}
