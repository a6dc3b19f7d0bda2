//! A step's kernels, looked at one after the other: their Newton corrections, or the step itself in twice the digits.

use nalgebra::{DMatrix, DVector};

use super::frame::{larger, slope};
use crate::erased::{At, Equation, converged, equation};
use crate::system::Generated;

/// A state that a step's kernels are shown.
pub struct Probe<'a> {
    pub(super) parameters: &'a [f64],
    pub(super) time: f64,
    pub(super) control: &'a [f64],
    state: Vec<f64>,
    sought: Sought,
}

/// What is looked at.
enum Sought {
    /// Newton corrections, at the first state: the largest difference so far, if there was anything to solve for.
    Corrections(Option<f64>),
    /// The state after all the kernels: what the numbers leave out, unless a kernel's equation could not be solved, and how many kernels
    /// there were.
    End(Option<Vec<f64>>, usize),
}

impl<'a> Probe<'a> {
    /// The largest difference between Newton corrections of the kernels and those that a Jacobian of differences makes, if there is anything
    /// to solve for.
    pub(super) fn corrections(
        parameters: &'a [f64],
        (state, time, control): (&[f64], f64, &'a [f64]),
        show: impl FnOnce(&mut Self),
    ) -> Option<f64> {
        let mut probe =
            Self { parameters, time, control, state: state.to_vec(), sought: Sought::Corrections(None) };
        show(&mut probe);
        match probe.sought {
            Sought::Corrections(worst) => worst,
            Sought::End(..) => None,
        }
    }

    /// The state after steps with the kernels, in turns, and what its numbers leave out. None if there are no kernels, or one's equation
    /// could not be solved.
    pub(super) fn end(
        parameters: &'a [f64],
        (state, time, control): (&[f64], f64, &'a [f64]),
        show: impl FnOnce(&mut Self),
    ) -> Option<[Vec<f64>; 2]> {
        let sought = Sought::End(Some(vec![0.0; state.len()]), 0);
        let mut probe = Self { parameters, time, control, state: state.to_vec(), sought };
        show(&mut probe);
        match probe.sought {
            Sought::End(Some(rest), 1..) => Some([probe.state, rest]),
            _ => None,
        }
    }

    /// Looks at a generated kernel of the system.
    pub fn kernel<S: Generated<M>, M>(&mut self, step: f64) {
        let Self { parameters, time, control, .. } = *self;
        let equation = equation::<S::Kernel<f64>>(parameters, step, &self.state, time, control);
        self.look(&*equation, step);
    }

    /// Where equations are looked at, of a step of this length.
    pub(super) fn at(&self, step: f64) -> At<'_> {
        At { step, state: &self.state, time: self.time, control: self.control }
    }

    pub(super) fn look(&mut self, equation: &dyn Equation, step: f64) {
        let at = At { step, state: &self.state, time: self.time, control: self.control };
        match &mut self.sought {
            Sought::Corrections(worst) => {
                if let Some(difference) = compare(equation) {
                    *worst = Some(worst.map_or(difference, |worst| larger(worst, difference)));
                }
            }
            Sought::End(rest, kernels) => {
                let end = rest.take().and_then(|rest| converged(equation, self.parameters, &at, &rest));
                *rest = end.map(|[state, rest]| {
                    self.state = state;
                    rest
                });
                *kernels += 1;
                self.time += step;
            }
        }
    }
}

/// The difference between an equation's Newton correction and the one that a Jacobian of differences makes, at a point off the solution.
fn compare(equation: &dyn Equation) -> Option<f64> {
    let mut unknown = equation.start();
    if unknown.iter().all(|x| *x == 0.0) {
        // at rest, or where no closed form gives the velocity: nearer to the solution, if it is elsewhere
        let [_, correction] = equation.correction(&unknown, None);
        unknown.iter_mut().zip(&correction).for_each(|(x, correction)| *x -= correction);
    }
    let largest = unknown.iter().fold(0.0, |x: f64, y| x.max(y.abs()));
    // a component that is small may be so by chance; turns, which stand beside momenta of any size, count in radians
    let floor = if largest > 0.0 { (1e-3 * largest).min(1.0) } else { 0.1 };
    let scales: Vec<f64> = unknown.iter().map(|x| x.abs().max(floor)).collect();
    if scales.is_empty() {
        return None;
    }
    for (i, (x, scale)) in unknown.iter_mut().zip(&scales).enumerate() {
        *x += 0.1 * scale * (1.0 + i as f64).sin();
    }
    let residual = |unknown: &[f64]| {
        let [residual, _] = equation.correction(unknown, None);
        DVector::from_vec(residual)
    };
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
    let [_, correction] = equation.correction(&unknown, None);
    let correction = correction.iter().zip(&scales).map(|(correction, scale)| correction / scale);
    let correction = DVector::from_iterator(scales.len(), correction);
    let difference = match DMatrix::from_columns(&columns).lu().solve(&residual(&unknown)) {
        Some(expected) => (correction - &expected).norm() / expected.norm().max(f64::MIN_POSITIVE),
        None => f64::NAN,
    };
    Some(difference)
}
