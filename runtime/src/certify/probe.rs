//! A kernel's Newton correction against differences of its residual.

use nalgebra::{DMatrix, DVector};

use super::frame::{larger, slope};
use crate::geometry::Geometry;
use crate::kernel::Kernel;
use crate::system::{Control, State};

/// A state at which kernels show their Newton corrections.
pub struct Probe<'a, S: Geometry<Scalar = f64>> {
    pub(super) system: &'a S,
    pub(super) state: &'a S::State,
    pub(super) time: f64,
    pub(super) control: &'a S::Control,
    /// The largest difference so far, if there was anything to solve for.
    pub(super) worst: Option<f64>,
}

impl<S: Geometry<Scalar = f64>> Probe<'_, S> {
    /// Compares the correction with the one that a Jacobian of differences makes, at a point off the solution.
    pub fn kernel<K>(&mut self, step: f64)
    where
        K: Kernel<
                f64,
                Parameters = S::Parameters<f64>,
                State = S::StateComponents<f64>,
                Control = S::ControlComponents<f64>,
            >,
    {
        let kernel = K::new(&self.system.to_parameters(), step);
        let state = self.state.to_components();
        let begun = kernel.begin(&state, self.time, &self.control.to_components());
        let mut unknown = kernel.start(&state, &begun);
        let largest = unknown.as_ref().iter().fold(0.0, |x: f64, y| x.max(y.abs()));
        // a component that is small may be so by chance; turns, which stand beside momenta of any size, count in radians
        let floor = if largest > 0.0 { (1e-3 * largest).min(1.0) } else { 0.1 };
        let scale = |x: f64| x.abs().max(floor);
        let scales: Vec<f64> = unknown.as_ref().iter().map(|x| scale(*x)).collect();
        if scales.is_empty() {
            return;
        }
        for (i, (x, scale)) in unknown.as_mut().iter_mut().zip(&scales).enumerate() {
            *x += 0.1 * scale * (1.0 + i as f64).sin();
        }
        let residual = |unknown: &K::Unknown| {
            DVector::from_column_slice(kernel.evaluate(&state, &begun, unknown).residual.as_ref())
        };
        let columns: Vec<_> = scales
            .iter()
            .enumerate()
            .map(|(i, scale)| {
                // in units in which all corrections are alike
                slope(1e-2 * scale, |at| {
                    let mut there = unknown;
                    there.as_mut()[i] += at;
                    residual(&there)
                }) * *scale
            })
            .collect();
        let evaluation = kernel.evaluate(&state, &begun, &unknown);
        let correction = kernel.correction(&state, &begun, &unknown, &evaluation);
        let correction = DVector::from_iterator(
            scales.len(),
            correction.as_ref().iter().zip(&scales).map(|(correction, scale)| correction / scale),
        );
        let difference = match DMatrix::from_columns(&columns).lu().solve(&residual(&unknown)) {
            Some(expected) => (correction - &expected).norm() / expected.norm().max(f64::MIN_POSITIVE),
            None => f64::NAN,
        };
        self.worst = Some(self.worst.map_or(difference, |worst| larger(worst, difference)));
    }
}
