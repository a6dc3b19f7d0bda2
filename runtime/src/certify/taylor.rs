//! What Taylor steps claim: their order, group and Casimirs at every tolerance, errors of the trajectory and the energy that follow the tolerance.

use std::string::ToString;
use std::sync::Arc;
use std::vec::Vec;

use super::CertifyError;
use super::report::{Bound, Certificate, Report};
use crate::erased::{self, StepperError};
use crate::error::StepError;
use crate::run::Run;
use crate::stepper::Stepping;
use crate::system::Dynamics;

/// The tolerances that are tried.
const TOLERANCES: [f64; 4] = [1e-4, 1e-7, 1e-10, 1e-13];
/// The order that is measured.
const ORDER: usize = 6;

/// Certifies the Taylor steps of a system, at sample states, each with a control that is held, from the time 0.
///
/// Group and Casimirs are kept to rounding at every tolerance, the energy of a system on which nothing acts to the tolerance. That a step were
/// a Poisson map is not claimed: it is none.
///
/// ```
/// use coadjoint::certify::certify_taylor;
/// use coadjoint::prelude::*;
/// use std::sync::Arc;
///
/// #[lie_poisson_system(group = SO3, taylor)]
/// struct Body {
///     #[inertia]
///     inertia: Vector3<f64>,
/// }
///
/// let body = Arc::new(Body { inertia: vector![1.0, 2.0, 2.5] });
/// let report = certify_taylor(body, &[vec![1.0, 0.0, 0.0, 0.0, 0.4, -0.8, 1.5]], &[])?;
/// assert!(report.passed(), "{report}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// | certificate | figure | holds if |
/// |---|---|---|
/// | order | slope of the error of steps of order 6 by halving them | ≥ 5.5 |
/// | group | how far attitudes and matrices are off, at tolerances from 1e-4 to 1e-13 | ≤ 1e-14 |
/// | Casimirs | their change at these tolerances | ≤ 1e-12 |
/// | error by tolerance | the error of each of some ten steps, by the tolerance | ≤ 1 |
/// | energy by tolerance | the change of the energy in each, where it is an invariant | ≤ 1 |
/// | reversibility | distance from the start, there and back, at 1e-15 | ≤ 1e-12 |
///
/// # Errors
/// If the parameters are not valid, there is no state, a step cannot be taken, or the description has not the key `taylor`.
pub fn certify_taylor(
    system: Arc<dyn erased::System>,
    states: &[Vec<f64>],
    controls: &[Vec<f64>],
) -> Result<Report, CertifyError> {
    if states.is_empty() {
        return Err(CertifyError::NoStates);
    }
    let description = system.description();
    let mut rows: [Worst; 5] = Default::default();
    let mut casimirs: Vec<Worst> = description.casimirs.iter().map(|_| Worst::default()).collect();
    let mut least_step = f64::INFINITY;
    let none = system.no_control();
    for (place, state) in states.iter().enumerate() {
        let control = controls.get(place % controls.len().max(1)).unwrap_or(&none);
        let one = Sample { system: &system, state, control, place };
        let step = one.natural_step()?;
        let (end, reference) = (10.0 * step, one.after(1e-15, None, 10.0 * step)?);
        least_step = least_step.min(step);

        let coarse = one.after(1e-4, Some(0.5 * step), end)?;
        let fine = one.after(1e-4, Some(0.25 * step), end)?;
        let [coarse, fine] = [coarse, fine].map(|state| distance(&state, &reference));
        // below that all is rounding
        if fine > 1e-13 {
            // the least counts
            rows[0].see(-(coarse / fine).log2(), place);
        }
        let first = system.casimirs(state);
        for tolerance in TOLERANCES {
            let mut steps = one.steps(tolerance)?;
            let mut reached = state.clone();
            steps.set_end(end);
            while !steps.has_ended() {
                let (start, mut exact) = (steps.time(), reached.clone());
                let energy = system.energy(&reached, start, control);
                steps.step_with(&mut reached, control).map_err(|source| one.failed(source))?;
                one.run(&mut exact, 1e-15, None, start, steps.time())?;
                rows[2].see(distance(&reached, &exact) / tolerance, place);
                if description.autonomous {
                    let change = (system.energy(&reached, start, control) - energy).abs();
                    rows[3].see(change / (1.0 + energy.abs()) / tolerance, place);
                }
            }
            rows[1].see(system.deviation(&reached), place);
            for ((row, now), first) in casimirs.iter_mut().zip(system.casimirs(&reached)).zip(&first) {
                row.see((now - first).abs() / (1.0 + first.abs()), place);
            }
        }
        let mut back = reference.clone();
        one.run(&mut back, 1e-15, None, end, 0.0)?;
        rows[4].see(distance(&back, state), place);
    }
    let [order, group, error, energy, back] = rows;
    let order = order.0.map(|(figure, state)| (-figure, state));
    let mut certificates = std::vec![
        Certificate::new("order", order, Some(Bound::AtLeast(ORDER as f64 - 0.5))),
        Certificate::new("group", group.0, Some(Bound::AtMost(1e-14))),
    ];
    for (name, worst) in description.casimirs.iter().zip(casimirs) {
        certificates.push(Certificate::new(name, worst.0, Some(Bound::AtMost(1e-12))));
    }
    certificates.push(Certificate::new("error by tolerance", error.0, Some(Bound::AtMost(1.0))));
    if description.autonomous {
        certificates.push(Certificate::new("energy by tolerance", energy.0, Some(Bound::AtMost(1.0))));
    }
    certificates.push(Certificate::new("reversibility", back.0, Some(Bound::AtMost(1e-12))));
    let (scheme, step) = (Some("Taylor".to_string()), Some(least_step));
    Ok(Report { system: description.name, scheme, properties: None, step, certificates })
}

/// The worst figure, and the state that it belongs to.
#[derive(Default)]
struct Worst(Option<(f64, usize)>);

impl Worst {
    fn see(&mut self, figure: f64, state: usize) {
        if self.0.is_none_or(|(worst, _)| figure > worst || figure.is_nan()) {
            self.0 = Some((figure, state));
        }
    }
}

/// A state at which the steps are measured.
struct Sample<'a> {
    system: &'a Arc<dyn erased::System>,
    state: &'a [f64],
    control: &'a Vec<f64>,
    place: usize,
}

impl Sample<'_> {
    fn steps(&self, tolerance: f64) -> Result<erased::Adaptive, CertifyError> {
        erased::Adaptive::new(self.system.clone(), tolerance).map_err(|error| match error {
            StepperError::NotGenerated(error) => error.into(),
            StepperError::Parameter(error) => error.into(),
        })
    }

    fn failed(&self, source: StepError) -> CertifyError {
        CertifyError::Step { certificate: "Taylor".to_string(), state: self.place, source }
    }

    /// How long a step of the order that is measured is; 1 where there is no bound.
    fn natural_step(&self) -> Result<f64, CertifyError> {
        let mut steps = self.steps(1e-4)?.with_order(ORDER);
        match steps.step_with(&mut self.state.to_vec(), self.control) {
            Ok(step) => Ok(step),
            Err(StepError::NoEnd) => Ok(1.0),
            Err(source) => Err(self.failed(source)),
        }
    }

    fn after(&self, tolerance: f64, step: Option<f64>, end: f64) -> Result<Vec<f64>, CertifyError> {
        let mut state = self.state.to_vec();
        self.run(&mut state, tolerance, step, 0.0, end)?;
        Ok(state)
    }

    fn run(
        &self,
        state: &mut Vec<f64>,
        tolerance: f64,
        step: Option<f64>,
        start: f64,
        end: f64,
    ) -> Result<(), CertifyError> {
        let mut steps = self.steps(tolerance)?;
        if let Some(step) = step {
            steps = steps.with_order(ORDER);
            steps.set_step_size(step)?;
        }
        let run = Run::new(&mut steps, state).starting_at(start).with_control(self.control.clone());
        run.to(end).map(|_| ()).map_err(|error| self.failed(error.cause))
    }
}

/// The largest difference of numbers, relative to those of the size of 1 and more.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
    a.iter().zip(b).fold(0.0, |largest: f64, (a, b)| largest.max((a - b).abs())) / size
}
