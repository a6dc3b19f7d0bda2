//! The measurements.

use nalgebra::{DMatrix, DVector};

use super::CertifyError;
use super::definition::ReferenceStep;
use super::frame::{Degenerate, Frame, derivative, jacobian, larger, relative, slope, worst};
use super::probe::KernelPart;
use super::report::{Bound, Certificate, Report};
use super::series::REACH;
use super::warm::noise;
use crate::erased::{At, Description, Geometry, Method, NotGenerated, check};
use crate::error::{ParameterError, StepError};
use crate::method::Clock;
use crate::retraction::RetractionKind;
use crate::scheme::Parameter;
use crate::schemes::{ConservedCasimirs, Part, Properties, Scheme};
use crate::stepper::check_step;

/// Part of a radian, or of what else the motion takes, that a step covers unless another is asked for.
pub(super) const STEP: f64 = 0.1;
/// The longest step that an order is looked for at, in such steps.
const LONGEST: f64 = 320.0;
/// After how many half octaves it is a radian.
const RADIAN: usize = 10;
/// At how many states along the motion it is.
const ALONG: usize = 8;
/// How many times what rounding leaves of it a difference of states is to be, to tell an order from.
const CLEAR: f64 = 40.0;

/// Steps there and back.
const RETURN: usize = 20;
/// How far another way back begins, relative to the state: so little that what grows stays small, and farther than rounding.
const BESIDE: f64 = 64.0 * f64::EPSILON;
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

impl Claimed<'_> {
    /// The generated steps that a step is made of; none if there is no definition.
    fn parts(&self, invariant: bool) -> Vec<Part> {
        self.definition.as_ref().map(|scheme| scheme.parts(invariant, 1.0)).unwrap_or_default()
    }

    /// The order of the series of Hamilton–Jacobi steps among those.
    fn series(&self, invariant: bool) -> Option<u32> {
        self.parts(invariant).iter().find_map(|(_, rule, _)| match rule.row().1 {
            Parameter::Order(order) => Some(order),
            Parameter::Share(..) => None,
        })
    }

    /// What rounding leaves of a step, in terms of what it does of one of those: errors are at random, and of many the root of their number is left.
    fn rounding(&self, invariant: bool) -> f64 {
        (self.parts(invariant).len().max(1) as f64).sqrt()
    }
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

/// How far two steps of half the length lead from where one does.
#[derive(Clone, Copy)]
struct Defect {
    size: f64,
    /// What rounding has of it.
    noise: f64,
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
        let order = f64::from(claim.order);
        self.certify("order", Some(Bound::AtLeast(order - (0.05 * order).max(0.15))), &Sample::order)?;
        let series = claimed.series(self.description.invariant);
        if let Some(order) = series {
            self.certify("series", Some(Bound::AtMost(REACH)), &|sample| sample.series(order))?;
        }
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
        let most = 1e-13 * claimed.rounding(self.description.invariant);
        self.certify(
            "reversibility",
            claim.symmetric.then_some(Bound::AtMost(most)),
            &Sample::reversibility,
        )?;
        // such a step has a matrix of terms of lower order
        let bound = series.is_none().then_some(Bound::AtMost(1e-6));
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

    /// By what two steps of half the length change of one, which falls with the order and one more: at states along the motion, for ever shorter
    /// steps, in half octaves. Over a few short steps rounding leaves less than over an interval, so that steps of high order are measured where
    /// they are short; together these states have no error whose first term happens to vanish.
    fn order(&self) -> Figure {
        let states = self.along()?;
        let mut defects = Vec::new();
        for halves in 0..40 {
            let step = LONGEST * self.step * 0.5_f64.powf(0.5 * f64::from(halves));
            match self.defect(step, &states) {
                Ok(defect) => defects.push(Some(defect)),
                // too long a step, which shorter ones make up for
                Err(MeasureError::Step(_)) if step.abs() > self.step.abs() => defects.push(None),
                Err(trouble) => return Err(trouble),
            }
        }
        let is_clear =
            |of: &Option<Defect>| of.is_some_and(|Defect { size, noise }| !(size <= CLEAR * noise));
        let Some(finest) = defects.iter().rposition(is_clear) else { return Ok(None) };
        let slope = |at: usize| {
            let (long, short) = (defects.get(at.checked_sub(2)?)?.as_ref()?, defects[at].as_ref()?);
            Some((long.size / short.size).log2() - 1.0)
        };
        // a slope is the order and what vanishes with the step: where it rises, it goes on as far as on a line, which is asked for up to the
        // claim alone; by one octave of steps longer than a radian there is no telling
        let claimed = f64::from(self.scheme.properties.order);
        let settled = |at: usize| match (slope(at)?, at.checked_sub(1).and_then(slope)) {
            (slope, Some(before)) => {
                let limit = slope + (slope - before) / (2_f64.sqrt() - 1.0);
                Some(slope.max(limit.min(claimed)))
            }
            (slope, None) => (at >= RADIAN).then_some(slope),
        };
        // nearest to the limit, of an octave the best
        Ok((finest.saturating_sub(2)..=finest).filter_map(settled).reduce(f64::max))
    }

    /// The sample, and where a few steps lead from there; of what has kinks the sample alone, since none is near.
    fn along(&self) -> Result<Vec<(f64, Vec<f64>)>, MeasureError> {
        let mut states = vec![(self.time, self.state.to_vec())];
        while states.len() < ALONG && !self.description.piecewise {
            let (time, state) = &states[states.len() - 1];
            match self.one(self.step, *time, state) {
                Ok(next) => states.push((time + self.step, next)),
                // that it cannot be taken is another certificate's
                Err(MeasureError::Step(_)) => break,
                Err(trouble) => return Err(trouble),
            }
        }
        Ok(states)
    }

    /// What two steps of half the length change of one. What rounding has of it is how much it differs at states beside these, where the
    /// difference itself is the same but for the last digits that it has.
    fn defect(&self, step: f64, states: &[(f64, Vec<f64>)]) -> Result<Defect, MeasureError> {
        let at = |time: f64, state: &[f64]| -> Result<Vec<f64>, MeasureError> {
            let whole = self.one(step, time, state)?;
            let mut halves = Vec::new();
            self.steps((0.5 * step, 2), time, state, &mut |state| halves = state.to_vec())?;
            Ok(self.frame.difference(&whole, &halves))
        };
        let square = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>();
        let (mut size, mut noise) = (0.0, 0.0);
        for (time, state) in states {
            let beside = self.frame.moved(state, RetractionKind::Exponential, &self.frame.element(|_| 1e-9));
            let (here, beside) = (at(*time, state)?, at(*time, &beside)?);
            size += square(&mut here.iter().copied());
            noise += 0.5 * square(&mut here.iter().zip(&beside).map(|(here, beside)| here - beside));
        }
        let mean = |sum: f64| (sum / states.len() as f64).sqrt();
        // at states that are a rounding apart it may be the same
        let least = f64::EPSILON * self.scheme.rounding(self.description.invariant);
        Ok(Defect { size: mean(size), noise: mean(noise).max(least) })
    }

    /// How much of its reach the series uses that a step is made of.
    fn series(&self, order: u32) -> Figure {
        let whole = self.one(self.step, self.time, self.state)?;
        let mut halves = Vec::new();
        self.run(0.5 * self.step, 2, &mut |state| halves.push(state.to_vec()))?;
        let [middle, end] = &halves[..] else { return Ok(None) };
        Ok(Some(self.frame.share(order, [self.state, middle, end, &whole]).0))
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
        // a slow oscillation is a line at first, and what becomes faster on its way may ask for shorter steps
        for (halvings, length) in [(0, 1), (0, 4), (0, 16), (0, 64), (1, 64), (2, 64)] {
            let energies = self.energies(self.step / f64::from(1 << halvings), length * self.long())?;
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
            if !self.scheme.properties.poisson || share < 0.5 {
                break;
            }
        }
        Ok(figure)
    }

    /// By the ranges of the energy's error along an interval with steps and half as long ones: in half octaves, of the shortest that show one the better.
    fn energy_order(&self) -> Figure {
        let mut ranges: Vec<f64> = Vec::new();
        for halves in 0..9 {
            let steps = (100.0 * 2_f64.powf(0.5 * f64::from(halves))).round();
            let range = range(&self.energies(100.0 * self.step / steps, steps as usize)?);
            if !(range > 1e-12 * self.energy_size()) {
                break;
            }
            ranges.push(range);
        }
        let slopes = ranges.windows(3).map(|ranges| (ranges[0] / ranges[2]).log2());
        Ok(slopes.rev().take(2).reduce(f64::max))
    }

    /// Steps, and as many back that start when the last one ends: one, and some with one stepper there and one back. What was damped on the way
    /// there grows on the way back, rounding too: the distance is that by which the way back has to begin elsewhere.
    fn reversibility(&self) -> Figure {
        worst([1, RETURN].into_iter().map(|count| {
            let mut there = Vec::new();
            self.run(self.step, count, &mut |state| there = state.to_vec())?;
            let end = self.time + count as f64 * self.step;
            let back_from = |there: &[f64]| {
                let mut back = Vec::new();
                let kept = self.steps((-self.step, count), end, there, &mut |state| back = state.to_vec());
                kept.map(|()| back)
            };
            let (frame, back) = (&self.frame, back_from(&there)?);
            let distance = frame.distance(self.state, &back);
            let by: Vec<f64> = (0..frame.dimension()).map(|i| BESIDE * frame.scale[i] * noise(i)).collect();
            let beside = frame.displace(&there, RetractionKind::Exponential, &by);
            let growth = match back_from(&beside) {
                Ok(other) => frame.distance(&other, &back) / frame.distance(&beside, &there),
                Err(_) => 1.0,
            };
            Ok(Some(if growth > 1.0 { distance / growth } else { distance }))
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
