//! The measurements.

use nalgebra::{DMatrix, DVector};

use super::CertifyError;
use super::definition::ReferenceStep;
use super::frame::{Degenerate, Frame, derivative, jacobian, larger, relative, slope, worst};
use super::probe::KernelPart;
use super::report::{Bound, Certificate, Report};
use crate::erased::{At, Description, Geometry, Method, NotGenerated, check};
use crate::error::{ParameterError, StepError};
use crate::method::Clock;
use crate::retraction::RetractionKind;
use crate::scheme::Rule;
use crate::schemes::{ConservedCasimirs, Properties, Scheme};
use crate::stepper::check_step;

/// Part of a radian, or of what else the motion takes, that a step covers unless another is asked for.
pub(super) const STEP: f64 = 0.1;
/// Differences of states below this are too near to roundoff to tell an order from.
const NOISE: f64 = 3e-12;

/// Steps there and back.
const RETURN: usize = 20;
/// How far a step may be from the converged one, in units of what rounding may leave of all its operations.
const WARM: Bound = Bound::AtMost(8.0);

/// Why a figure cannot be measured.
pub(super) enum MeasureError {
    Parameter(ParameterError),
    NotGenerated(NotGenerated),
    Step(StepError),
    Degenerate,
}

impl From<Degenerate> for MeasureError {
    fn from(_: Degenerate) -> Self {
        Self::Degenerate
    }
}

/// Steps under the claims of a scheme, as values: the measurements are compiled once for all systems and schemes.
pub struct Claimed<'a> {
    /// The scheme's name.
    pub name: String,
    /// What it promises.
    pub properties: Properties,
    /// The scheme from whose definition the same steps are to follow; none if there is nothing to compare with.
    pub definition: Option<Scheme>,
    /// Makes what takes steps of a length.
    pub method: &'a dyn Fn(f64) -> Result<Box<dyn Method<f64>>, NotGenerated>,
    /// The kernel of an index from 0, of those that a step from there is made of, where the ones before it have led.
    pub kernels: &'a dyn Fn(usize, &At<'_>) -> Option<KernelPart>,
}

/// States to measure at, each with its control, and how.
pub(super) struct Subject<'a> {
    pub(super) system: &'a dyn Geometry,
    pub(super) states: Vec<Vec<f64>>,
    pub(super) controls: Vec<Vec<f64>>,
    pub(super) time: f64,
    pub(super) step: Option<f64>,
}

/// A state to measure at.
pub(super) struct Sample<'a> {
    pub(super) system: &'a dyn Geometry,
    pub(super) description: Description,
    pub(super) frame: Frame<'a>,
    pub(super) state: &'a [f64],
    pub(super) control: &'a [f64],
    pub(super) time: f64,
    pub(super) step: f64,
    pub(super) scheme: &'a Claimed<'a>,
}

/// A figure; none if there is nothing to measure.
pub(super) type Figure = Result<Option<f64>, MeasureError>;

pub(super) fn certificates(subject: &Subject<'_>, scheme: &Claimed<'_>) -> Result<Report, CertifyError> {
    let Subject { system, states, controls, time, step } = subject;
    let description = system.description();
    system.validate()?;
    if let Some(step) = *step {
        check_step(step)?;
    }
    let none = Vec::new();
    let mut held = controls.iter().cycle();
    let mut samples = Vec::new();
    for (index, state) in states.iter().enumerate() {
        let control = held.next().unwrap_or(&none);
        check(*system, state).map_err(|error| named("sample", index, MeasureError::Step(error)))?;
        let frame = Frame::new(*system, state, control, *time)
            .ok_or(CertifyError::Structure { system: description.name })?;
        let step = step.unwrap_or(if frame.rate > 0.0 { STEP / frame.rate } else { STEP });
        samples.push(Sample {
            system: *system,
            description,
            frame,
            state,
            control,
            time: *time,
            step,
            scheme,
        });
    }
    let step = samples.iter().map(|sample| sample.step).reduce(f64::min).ok_or(CertifyError::NoStates)?;
    let mut bench = Certifier { samples: &samples, description, certificates: Vec::new() };
    bench.scheme(scheme)?;
    bench.geometry()?;
    Ok(Report {
        system: description.name,
        scheme: Some(scheme.name.clone()),
        properties: Some(scheme.properties),
        step: Some(step),
        certificates: bench.certificates,
    })
}

fn named(certificate: &str, state: usize, trouble: MeasureError) -> CertifyError {
    let certificate = certificate.to_owned();
    match trouble {
        MeasureError::Parameter(error) => error.into(),
        MeasureError::NotGenerated(error) => error.into(),
        MeasureError::Step(source) => CertifyError::Step { certificate, state, source },
        MeasureError::Degenerate => CertifyError::Degenerate { certificate, state },
    }
}

/// Figures against their bounds.
struct Certifier<'a> {
    samples: &'a [Sample<'a>],
    description: Description,
    certificates: Vec<Certificate>,
}

impl<'a> Certifier<'a> {
    /// What the scheme claims.
    fn scheme(&mut self, claimed: &Claimed<'_>) -> Result<(), CertifyError> {
        let claim = claimed.properties;
        // such a step has a matrix of terms of lower order
        let is_other = |(_, rule, _): &(_, Rule, _)| !matches!(rule, Rule::HamiltonJacobi(_));
        let parts = claimed.definition.as_ref().map(|scheme| scheme.parts(self.description.invariant, 1.0));
        let is_exact = parts.is_none_or(|parts| parts.iter().all(is_other));
        let order = f64::from(claim.order);
        self.certify("order", Some(Bound::AtLeast(order - (0.05 * order).max(0.15))), &Sample::order)?;
        self.certify("consistency", Some(Bound::AtMost(1e-9)), &Sample::consistency)?;
        self.certify("Poisson map", claim.poisson.then_some(Bound::AtMost(1e-9)), &Sample::poisson_map)?;
        for (index, name) in self.description.casimirs.iter().enumerate() {
            let kept = match claim.casimirs {
                ConservedCasimirs::All => true,
                ConservedCasimirs::Advected => self.samples.iter().all(|sample| sample.is_advected(index)),
                ConservedCasimirs::None => false,
            };
            let bound = kept.then_some(Bound::AtMost(1e-11));
            self.certify(name, bound, &|sample| sample.casimir_drift(index))?;
        }
        if self.description.autonomous {
            // backward error analysis asks for a smooth energy
            let is_claimed = claim.poisson && !self.description.piecewise;
            let claimed = |bound| is_claimed.then_some(bound);
            self.certify("energy drift", claimed(Bound::AtMost(0.5)), &Sample::energy_drift)?;
            self.certify("energy order", claimed(Bound::AtLeast(order - 0.5)), &Sample::energy_order)?;
        }
        self.certify(
            "reversibility",
            claim.symmetric.then_some(Bound::AtMost(1e-13)),
            &Sample::reversibility,
        )?;
        let bound = is_exact.then_some(Bound::AtMost(1e-6));
        self.certify("Newton correction", bound, &Sample::correction)?;
        self.certify("definition", Some(Bound::AtMost(1e-10)), &Sample::definition)?;
        self.warm()
    }

    /// That a step is a map of the state, whatever the stepper remembers of earlier ones.
    fn warm(&mut self) -> Result<(), CertifyError> {
        self.certify("warm steps", Some(WARM), &Sample::warm_steps)?;
        self.certify("restarts", Some(WARM), &Sample::restarts)?;
        if !self.description.controls.is_empty() {
            self.certify("control jumps", Some(WARM), &Sample::control_jumps)?;
        }
        self.certify("long steps", Some(WARM), &Sample::long_steps)?;
        self.certify("zeros", Some(WARM), &Sample::zeros)
    }

    /// What the system's geometry is.
    fn geometry(&mut self) -> Result<(), CertifyError> {
        self.certify("energy differential", Some(Bound::AtMost(1e-9)), &Sample::differential)?;
        self.certify("antisymmetry", Some(Bound::AtMost(1e-14)), &Sample::antisymmetry)?;
        self.certify("Jacobi identity", Some(Bound::AtMost(1e-8)), &Sample::jacobi)?;
        self.certify("exponential", Some(Bound::AtMost(1e-10)), &Sample::exponential)?;
        self.certify("inverse", Some(Bound::AtMost(1e-13)), &Sample::inverse)
    }

    /// The worst figure of all samples, against its bound.
    fn certify(
        &mut self,
        name: &str,
        bound: Option<Bound>,
        measure: &dyn Fn(&Sample<'a>) -> Figure,
    ) -> Result<(), CertifyError> {
        let mut worst = None;
        for (index, sample) in self.samples.iter().enumerate() {
            let figure = match measure(sample) {
                Ok(figure) => figure,
                // of what is not claimed, nothing can be expected; nor that a step over a jump has a solution
                Err(MeasureError::Step(_)) if bound.is_none() || self.description.piecewise => None,
                Err(trouble) => return Err(named(name, index, trouble)),
            };
            let Some(figure) = figure else { continue };
            let is_worse = |than: f64| match bound {
                Some(Bound::AtLeast(_)) => !(figure >= than),
                _ => !(figure <= than),
            };
            if worst.is_none_or(|(than, _): (f64, usize)| !than.is_nan() && is_worse(than)) {
                worst = Some((figure, index));
            }
        }
        self.certificates.push(Certificate::new(name, worst, bound));
        Ok(())
    }
}

impl Sample<'_> {
    /// Takes steps from a time and a state, and shows the state after each.
    fn steps(
        &self,
        (step, count): (f64, usize),
        time: f64,
        state: &[f64],
        seen: &mut dyn FnMut(&[f64]),
    ) -> Result<(), MeasureError> {
        check_step(step).map_err(MeasureError::Parameter)?;
        let mut method = (self.scheme.method)(step).map_err(MeasureError::NotGenerated)?;
        let (mut state, mut next) = (state.to_vec(), state.to_vec());
        for taken in 0..count as u64 {
            let now = Clock { start: time, step, taken }.after(0);
            let outcome = method.advance(&state, &mut next, now, self.control, taken > 0);
            outcome.map_err(|failure| MeasureError::Step(failure.first()))?;
            core::mem::swap(&mut state, &mut next);
            seen(&state);
        }
        Ok(())
    }

    /// Takes steps from the sample.
    fn run(&self, step: f64, count: usize, seen: &mut dyn FnMut(&[f64])) -> Result<(), MeasureError> {
        self.steps((step, count), self.time, self.state, seen)
    }

    /// The state after one step from a time and a state, by a stepper that remembers nothing: what is differenced by states and steps has no
    /// trajectory of its own. That warm steps are the same ones, others [measure](super::warm).
    fn one(&self, step: f64, time: f64, state: &[f64]) -> Result<Vec<f64>, MeasureError> {
        let mut next = Vec::new();
        self.steps((step, 1), time, state, &mut |state| next = state.to_vec())?;
        Ok(next)
    }

    /// Steps of the long runs: forces held on and on lead to where steps of this size cannot be taken.
    fn long(&self) -> usize {
        if self.description.forced { 100 } else { 1000 }
    }

    /// By the ends of one interval, crossed with ever shorter steps.
    fn order(&self) -> Figure {
        // kinks lower it: of what has some, the shortest interval that shows an order, since that has none
        let (shortest, longer) = if self.description.piecewise { (10.0 / 64.0, 7) } else { (10.0, 6) };
        let mut interval = shortest * self.step;
        for _ in 0..longer {
            let mut last: Option<Vec<f64>> = None;
            let mut errors = Vec::new();
            for halvings in 0..10 {
                let steps = 1 << halvings;
                let mut end = self.state.to_vec();
                match self.run(interval / steps as f64, steps, &mut |state| end = state.to_vec()) {
                    Ok(()) => {}
                    // too long a step, which shorter ones make up for
                    Err(MeasureError::Step(_)) if halvings < 5 => {
                        last = None;
                        errors.clear();
                        continue;
                    }
                    Err(trouble) => return Err(trouble),
                }
                if let Some(last) = &last {
                    let error = self.frame.distance(last, &end);
                    if !(error > NOISE) {
                        break;
                    }
                    errors.push(error);
                }
                last = Some(end);
            }
            if let [.., _, b, c] = errors.as_slice() {
                // nearest to the limit
                return Ok(Some((b / c).log2()));
            }
            interval *= 2.0;
        }
        Ok(None)
    }

    /// The derivative by the step's size at 0: by differences of long steps or of short ones, which have more digits of it where a force has a kink.
    fn consistency(&self) -> Figure {
        let [long, short] = [0.1, 1e-3].map(|share| self.consistency_by(share * self.step.abs()));
        Ok(match (long?, short?) {
            (Some(long), Some(short)) => Some(long.min(short)),
            (long, short) => long.or(short),
        })
    }

    /// The same by differences of steps so long.
    fn consistency_by(&self, length: f64) -> Figure {
        let change =
            derivative(length, &mut |step| self.one(step, self.time, self.state).map(DVector::from))?;
        let change = self.frame.local(self.state, &DMatrix::from_columns(&[change]))?;
        let motion = self.frame.motion(self.state, self.time, self.control);
        let scale = DVector::from_column_slice(&self.frame.scale);
        let size = |vector: &DVector<f64>| largest(vector.component_div(&scale).as_slice());
        Ok(Some(relative(size(&(change.column(0) - &motion)), size(&motion))))
    }

    /// The derivative of a step in local coordinates, and where it leads.
    fn linearized(&self) -> Result<(DMatrix<f64>, Vec<f64>), MeasureError> {
        let frame = &self.frame;
        let end = self.one(self.step, self.time, self.state)?;
        let changes = jacobian(frame.scale.iter().copied(), &mut |i, at| {
            let there = frame.displace(self.state, RetractionKind::Exponential, &frame.unit(i, at));
            self.one(self.step, self.time, &there).map(DVector::from)
        })?;
        Ok((frame.local(&end, &changes)?, end))
    }

    fn poisson_map(&self) -> Figure {
        let (derivative, end) = self.linearized()?;
        let carried = &derivative * self.frame.poisson(self.state) * derivative.transpose();
        let expected = self.frame.poisson(&end);
        let size = self.frame.scaled(&expected).amax();
        Ok(Some(largest(self.frame.scaled(&(carried - expected)).as_slice()) / size))
    }

    /// Whether a Casimir is a function of advected parameters alone.
    fn is_advected(&self, index: usize) -> bool {
        let mut other = self.frame.linear_part(self.state);
        for (k, x) in other.iter_mut().take(self.frame.configuration.len()).enumerate() {
            *x = 1.7 * *x + (0.3 + 0.1 * k as f64) * self.frame.scale[self.frame.linear[k].tangent];
        }
        let other = self.frame.with_linear_part(self.state, &other);
        self.casimir(index, &other) == self.casimir(index, self.state)
    }

    fn casimir(&self, index: usize, state: &[f64]) -> f64 {
        // of a system that names more than it has, the rest is none
        self.system.casimirs(state).get(index).copied().unwrap_or(f64::NAN)
    }

    fn casimir_drift(&self, index: usize) -> Figure {
        let start = self.casimir(index, self.state);
        // what it may be where it happens to be small
        let size = self.frame.linear.iter().fold(start.abs(), |size, linear| {
            let by = self.frame.unit(linear.tangent, self.frame.scale[linear.tangent]);
            let there = self.frame.displace(self.state, RetractionKind::Exponential, &by);
            size.max((self.casimir(index, &there) - start).abs())
        });
        let mut drift = 0.0;
        self.run(self.step, self.long(), &mut |state| {
            drift = larger(drift, (self.casimir(index, state) - start).abs());
        })?;
        Ok(Some(relative(drift, size)))
    }

    /// The energies along a run.
    fn energies(&self, step: f64, count: usize) -> Result<Vec<f64>, MeasureError> {
        let mut energies = vec![self.system.energy(self.state, self.time, self.control)];
        self.run(step, count, &mut |state| {
            energies.push(self.system.energy(state, self.time, self.control))
        })?;
        Ok(energies)
    }

    /// What errors of the energy count relative to.
    fn energy_size(&self) -> f64 {
        let differential = self.system.differential(self.state, self.time, self.control);
        let parts = differential.iter().zip(&self.frame.scale).map(|(x, scale)| (x * scale).abs());
        parts.fold(f64::MIN_POSITIVE, f64::max)
    }

    /// How much of the range of the energy's error is a straight line's.
    fn energy_drift(&self) -> Figure {
        let mut figure = None;
        for length in [1, 4, 16, 64] {
            let energies = self.energies(self.step, length * self.long())?;
            let range = range(&energies);
            if range < 1e-11 * self.energy_size() {
                return Ok(None);
            }
            let middle = 0.5 * (energies.len() - 1) as f64;
            let times = || (0..energies.len()).map(|k| k as f64 - middle);
            let slope = times().zip(&energies).map(|(time, energy)| time * energy).sum::<f64>()
                / times().map(|time| time * time).sum::<f64>();
            let share = slope.abs() * 2.0 * middle / range;
            figure = Some(share);
            // a slow oscillation is a line at first
            if !self.scheme.properties.poisson || share < 0.5 {
                break;
            }
        }
        Ok(figure)
    }

    /// By the ranges of the energy's error with steps and half as long ones.
    fn energy_order(&self) -> Figure {
        let error = |halvings: usize| {
            let step = self.step / (1 << halvings) as f64;
            self.energies(step, 100 << halvings).map(|energies| range(&energies))
        };
        let (one, half) = (error(0)?, error(1)?);
        let measurable = half > 1e-12 * self.energy_size();
        Ok(measurable.then(|| (one / half).log2()))
    }

    /// Steps, and as many back that start when the last one ends: one, and some with one stepper there and one back.
    fn reversibility(&self) -> Figure {
        worst([1, RETURN].into_iter().map(|count| {
            let mut there = Vec::new();
            self.run(self.step, count, &mut |state| there = state.to_vec())?;
            let mut back = Vec::new();
            let end = self.time + count as f64 * self.step;
            self.steps((-self.step, count), end, &there, &mut |state| back = state.to_vec())?;
            Ok(Some(self.frame.distance(self.state, &back)))
        }))
    }

    fn correction(&self) -> Figure {
        let at = At { step: self.step, state: self.state, time: self.time, control: self.control };
        Ok(self.scheme.corrections(&at))
    }

    fn definition(&self) -> Figure {
        let Some(scheme) = &self.scheme.definition else { return Ok(None) };
        let mut step = self.step;
        // a fixed-point iteration asks for shorter steps than Newton's
        for _ in 0..6 {
            let mut walk = ReferenceStep::new(&self.frame, self.state, self.time, self.control);
            if !walk.step(scheme, self.description.invariant, step) {
                return Ok(None);
            }
            if !walk.lost {
                let is = self.one(step, self.time, self.state)?;
                return Ok(Some(self.frame.distance(&is, &walk.state)));
            }
            step *= 0.5;
        }
        Ok(None)
    }

    fn differential(&self) -> Figure {
        let frame = &self.frame;
        let differential = self.system.differential(self.state, self.time, self.control);
        let mut error = 0.0;
        for (i, scale) in frame.scale.iter().enumerate() {
            for map in RetractionKind::ALL {
                let change = slope(1e-2 * scale, &|at| {
                    let there = frame.displace(self.state, map, &frame.unit(i, at));
                    DVector::from_element(1, self.system.energy(&there, self.time, self.control))
                });
                error = larger(error, (change[0] - differential[i]).abs() * scale);
            }
        }
        // where all forces vanish, what the energy itself is counts
        let size = self.energy_size().max(self.system.energy(self.state, self.time, self.control).abs());
        Ok(Some(error / size))
    }

    fn antisymmetry(&self) -> Figure {
        let tensor = self.frame.scaled(&self.frame.poisson(self.state));
        Ok(Some(largest((&tensor + tensor.transpose()).as_slice()) / tensor.amax()))
    }

    /// `Σ_l P^{il} ∂_l P^{jk}` and the other two of the cycle, in the coordinates that displacements are.
    fn jacobi(&self) -> Figure {
        let frame = &self.frame;
        let n = frame.dimension();
        // a tangent vector in these coordinates is another one at the displaced state, of which only the configuration's part differs
        let in_coordinates = |by: &[f64]| {
            let there = frame.displace(self.state, RetractionKind::Exponential, by);
            let turn = frame.configuration_of(by);
            let small = frame
                .logarithmic_derivative(self.state, RetractionKind::Exponential, &turn)?
                .try_inverse()
                .ok_or(Degenerate)?;
            let mut inverse = DMatrix::identity(n, n);
            for (r, &i) in frame.configuration.iter().enumerate() {
                for (c, &j) in frame.configuration.iter().enumerate() {
                    inverse[(i, j)] = small[(r, c)];
                }
            }
            Ok::<_, Degenerate>(frame.scaled(&(&inverse * frame.poisson(&there) * inverse.transpose())))
        };
        let tensor = frame.scaled(&frame.poisson(self.state));
        // each a column
        let changes = jacobian((0..n).map(|_| 1.0), &mut |l, at| {
            in_coordinates(&frame.unit(l, at * frame.scale[l]))
                .map(|there| DVector::from_column_slice(there.as_slice()))
        })?;
        let along = |i: usize, j: usize, k: usize| tensor.row(i).dot(&changes.row(j + n * k));
        // a constant tensor changes by rounding alone
        let least = tensor.amax().max(f64::MIN_POSITIVE);
        let size = least * least.max(changes.amax());
        let mut error = 0.0;
        for i in 0..n {
            for j in 0..i {
                for k in 0..j {
                    error = larger(error, (along(i, j, k) + along(j, k, i) + along(k, i, j)).abs());
                }
            }
        }
        Ok(Some(error / size))
    }

    /// A displacement of the size of a radian.
    fn turn(&self) -> DVector<f64> {
        self.frame.element(|k| 0.5 * (2.0 * k + 1.0).sin())
    }

    /// `(dR exp_x)* = φ₁(ad*_x)`: displacements and Poisson structure are of one group.
    fn exponential(&self) -> Figure {
        let [measured, expected] = self.frame.d_right_exponential(self.state, &self.turn())?;
        let scale = self.frame.element(|_| 1.0);
        let error = DMatrix::from_fn(scale.len(), scale.len(), |i, j| {
            (measured[(i, j)] - expected[(i, j)]) * scale[j] / scale[i]
        });
        Ok(Some(largest(error.as_slice())))
    }

    /// `τ(−ξ) = τ(ξ)⁻¹` of those that are odd
    fn inverse(&self) -> Figure {
        let odd = RetractionKind::ALL.into_iter().filter(|map| map.is_matrix_function());
        Ok(odd.map(|map| self.frame.not_inverse(self.state, map, &self.turn())).reduce(larger))
    }
}

/// The largest magnitude; not-a-number if one is.
fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |size, x| larger(size, x.abs()))
}

fn range(values: &[f64]) -> f64 {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    high - low
}
