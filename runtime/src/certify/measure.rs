//! The measurements.

use core::marker::PhantomData;

use nalgebra::{DMatrix, DVector};

use super::claims::{Claims, Kept};
use super::definition::{Walk, series};
use super::frame::{Frame, derivative, larger, slope};
use super::probe::Probe;
use super::report::{Bound, Certificate, Report, Verdict};
use super::{Certification, CertifyError};
use crate::error::{ParameterError, StepError};
use crate::geometry::{Geometry, Map};
use crate::system::{Discretized, State};

/// Part of a radian, or of what else the motion takes, that a step covers unless another is asked for.
const STEP: f64 = 0.1;
/// Differences of states below this are too near to roundoff to tell an order from.
const NOISE: f64 = 3e-12;

/// Why a figure cannot be measured.
enum Trouble {
    Parameter(ParameterError),
    Step(StepError),
    Degenerate,
}

/// The steps of the scheme `M` at the sample states.
struct Bench<'a, S: Geometry<Scalar = f64>, M> {
    system: &'a S,
    frame: Frame<'a, S>,
    samples: &'a [(S::State, S::Control)],
    time: f64,
    step: f64,
    certificates: Vec<Certificate>,
    scheme: PhantomData<M>,
}

pub(super) fn report<S, M>(what: &Certification<'_, S>) -> Result<Report, CertifyError>
where
    S: Geometry<Scalar = f64> + Discretized<M>,
    M: Claims<S>,
{
    let Certification { system, states, controls, time, step } = what;
    system.validate()?;
    if let Some(step) = step.filter(|step| !step.is_finite() || *step == 0.0) {
        return Err(ParameterError::Step { step }.into());
    }
    for (index, state) in states.iter().enumerate() {
        let finite = state.to_components().as_ref().iter().all(|x| x.is_finite());
        if !finite {
            return Err(named("sample", index, Trouble::Step(StepError::NotFinite)));
        }
    }
    let mut held = controls.iter().cycle();
    let samples: Vec<_> =
        states.iter().map(|state| (state.clone(), held.next().cloned().unwrap_or_default())).collect();
    if samples.is_empty() {
        return Err(CertifyError::NoStates);
    }
    let frame = Frame::new(*system, &samples, *time).ok_or(CertifyError::Structure { system: S::NAME })?;
    let step = step.unwrap_or(if frame.rate > 0.0 { STEP / frame.rate } else { STEP });
    let mut bench = Bench::<S, M> {
        system,
        frame,
        samples: &samples,
        time: *time,
        step,
        certificates: Vec::new(),
        scheme: PhantomData,
    };
    bench.scheme()?;
    bench.geometry()?;
    let scheme = without_paths(core::any::type_name::<M>());
    Ok(Report { system: S::NAME, scheme, claim: M::CLAIM, step, certificates: bench.certificates })
}

fn named(certificate: &str, state: usize, trouble: Trouble) -> CertifyError {
    let certificate = certificate.to_owned();
    match trouble {
        Trouble::Parameter(error) => error.into(),
        Trouble::Step(source) => CertifyError::Step { certificate, state, source },
        Trouble::Degenerate => CertifyError::Degenerate { certificate, state },
    }
}

/// `Family<Cayley, 1, 2>` of `coadjoint::scheme::Family<coadjoint::retraction::Cayley, 1, 2>`.
fn without_paths(name: &str) -> String {
    let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let mut short = String::new();
    let mut rest = name;
    while let Some(next) = rest.chars().next() {
        let end = rest.find(|c| is_path(c) != is_path(next)).unwrap_or(rest.len());
        let (token, others) = rest.split_at(end);
        short.push_str(token.rsplit("::").next().unwrap_or(token));
        rest = others;
    }
    short
}

impl<S, M> Bench<'_, S, M>
where
    S: Geometry<Scalar = f64> + Discretized<M>,
    M: Claims<S>,
{
    /// What the scheme claims.
    fn scheme(&mut self) -> Result<(), CertifyError> {
        let claim = M::CLAIM;
        let order = f64::from(claim.order);
        self.certify("order", Some(Bound::AtLeast(order - ORDER_SLACK)), Self::order)?;
        self.certify("consistency", Some(Bound::AtMost(1e-9)), Self::consistency)?;
        self.certify("Poisson map", claim.poisson.then_some(Bound::AtMost(1e-9)), Self::poisson_map)?;
        for (index, name) in S::CASIMIRS.iter().enumerate() {
            let kept = match claim.casimirs {
                Kept::All => true,
                Kept::Advected => self.is_advected(index),
                Kept::None => false,
            };
            self.certify(name, kept.then_some(Bound::AtMost(1e-11)), |bench, state, control| {
                bench.casimir_drift(index, state, control)
            })?;
        }
        if S::AUTONOMOUS {
            let claimed = |bound| claim.poisson.then_some(bound);
            self.certify("energy drift", claimed(Bound::AtMost(0.5)), Self::energy_drift)?;
            self.certify("energy order", claimed(Bound::AtLeast(order - 0.5)), Self::energy_order)?;
        }
        self.certify("reversibility", claim.symmetric.then_some(Bound::AtMost(1e-13)), Self::reversibility)?;
        self.certify("Newton correction", Some(Bound::AtMost(1e-6)), Self::correction)?;
        self.certify("definition", Some(Bound::AtMost(1e-10)), Self::definition)
    }

    /// What the system's geometry is.
    fn geometry(&mut self) -> Result<(), CertifyError> {
        self.certify("energy differential", Some(Bound::AtMost(1e-9)), Self::differential)?;
        self.certify("antisymmetry", Some(Bound::AtMost(1e-14)), Self::antisymmetry)?;
        self.certify("Jacobi identity", Some(Bound::AtMost(1e-8)), Self::jacobi)?;
        self.certify("exponential", Some(Bound::AtMost(1e-10)), Self::exponential)?;
        self.certify("inverse", Some(Bound::AtMost(1e-13)), Self::inverse)
    }

    /// The worst figure of all samples, against its bound.
    fn certify(
        &mut self,
        name: &str,
        bound: Option<Bound>,
        measure: impl Fn(&Self, &S::State, &S::Control) -> Result<Option<f64>, Trouble>,
    ) -> Result<(), CertifyError> {
        let mut worst = None;
        for (index, (state, control)) in self.samples.iter().enumerate() {
            let figure = match measure(self, state, control) {
                Ok(figure) => figure,
                // of what is not claimed, nothing can be expected
                Err(Trouble::Step(_)) if bound.is_none() => None,
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
        let verdict = match (worst, bound) {
            (None, _) => Verdict::NotMeasured,
            (_, None) => Verdict::NotClaimed,
            (Some((figure, _)), Some(bound)) if bound.holds(figure) => Verdict::Passed,
            _ => Verdict::Failed,
        };
        let (figure, state) = worst.unwrap_or((f64::NAN, 0));
        self.certificates.push(Certificate { name: name.to_owned(), figure, state, bound, verdict });
        Ok(())
    }

    /// The state after one step.
    fn one(&self, step: f64, time: f64, state: &S::State, control: &S::Control) -> Result<S::State, Trouble> {
        let mut next = state.clone();
        self.walk(step, 1, time, state, control, |state| next = state.clone())?;
        Ok(next)
    }

    /// Takes steps, and shows the state after each.
    fn walk(
        &self,
        step: f64,
        steps: usize,
        time: f64,
        state: &S::State,
        control: &S::Control,
        mut seen: impl FnMut(&S::State),
    ) -> Result<(), Trouble> {
        let mut stepper = self.system.stepper::<M>(step).map_err(Trouble::Parameter)?;
        stepper.set_time(time);
        let mut state = state.clone();
        for _ in 0..steps {
            stepper.step_with(&mut state, control).map_err(Trouble::Step)?;
            seen(&state);
        }
        Ok(())
    }

    /// Steps of the long runs: forces held on and on lead to where steps of this size cannot be taken.
    const LONG: usize = if S::FORCED { 100 } else { 1000 };

    /// By the ends of one interval, crossed with ever shorter steps.
    fn order(&self, state: &S::State, control: &S::Control) -> Result<Option<f64>, Trouble> {
        let mut interval = 10.0 * self.step;
        for _ in 0..6 {
            let mut last = None;
            let mut errors = Vec::new();
            for halvings in 0..10 {
                let steps = 1 << halvings;
                let mut end = state.clone();
                match self.walk(interval / steps as f64, steps, self.time, state, control, |state| {
                    end = state.clone()
                }) {
                    Ok(()) => {}
                    // too long a step, which shorter ones make up for
                    Err(Trouble::Step(_)) if halvings < 5 => {
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
            if let [.., a, b, c] = errors.as_slice() {
                // the last ones are nearest to the limit, and nearest to roundoff
                return Ok(Some((b / c).log2().max(if *c < 100.0 * NOISE { (a / b).log2() } else { 0.0 })));
            }
            interval *= 2.0;
        }
        Ok(None)
    }

    /// The derivative by the step's size at 0.
    fn consistency(&self, state: &S::State, control: &S::Control) -> Result<Option<f64>, Trouble> {
        let change = derivative(0.1 * self.step.abs(), |step| {
            Ok(Frame::<S>::components(&self.one(step, self.time, state, control)?))
        })?;
        let change = DMatrix::from_columns(&[change]);
        let change = self.frame.local(state, &change).ok_or(Trouble::Degenerate)?;
        let motion = self.frame.motion(state, self.time, control);
        let scaled = |i: usize, x: f64| (x / self.frame.scale[i]).abs();
        let size = motion.iter().enumerate().fold(0.0, |size, (i, x)| larger(size, scaled(i, *x)));
        let error =
            (0..motion.len()).fold(0.0, |error, i| larger(error, scaled(i, change[(i, 0)] - motion[i])));
        Ok(Some(if error == 0.0 { 0.0 } else { error / size }))
    }

    /// The derivative of a step in local coordinates, and where it leads.
    fn linearized(
        &self,
        state: &S::State,
        control: &S::Control,
    ) -> Result<(DMatrix<f64>, S::State), Trouble> {
        let frame = &self.frame;
        let end = self.one(self.step, self.time, state, control)?;
        let columns: Result<Vec<_>, _> = (0..frame.dimension())
            .map(|i| {
                derivative(1e-2 * frame.scale[i], |at| {
                    let there = frame.displace(state, Map::Exponential, &frame.unit(i, at));
                    Ok(Frame::<S>::components(&self.one(self.step, self.time, &there, control)?))
                })
            })
            .collect();
        let derivative = frame.local(&end, &DMatrix::from_columns(&columns?)).ok_or(Trouble::Degenerate)?;
        Ok((derivative, end))
    }

    fn poisson_map(&self, state: &S::State, control: &S::Control) -> Result<Option<f64>, Trouble> {
        let (derivative, end) = self.linearized(state, control)?;
        let carried = &derivative * self.frame.poisson(state) * derivative.transpose();
        let expected = self.frame.poisson(&end);
        let size = self.frame.scaled(&expected).amax();
        Ok(Some(largest(&self.frame.scaled(&(carried - expected))) / size))
    }

    /// Whether a Casimir is a function of advected parameters alone.
    fn is_advected(&self, index: usize) -> bool {
        self.samples.iter().all(|(state, _)| {
            let mut other = self.frame.linear_part(state);
            for (k, x) in other.iter_mut().take(self.frame.configuration.len()).enumerate() {
                *x = 1.7 * *x + (0.3 + 0.1 * k as f64) * self.frame.scale[self.frame.linear[k].tangent];
            }
            self.casimir(index, &self.frame.with_linear_part(state, &other)) == self.casimir(index, state)
        })
    }

    fn casimir(&self, index: usize, state: &S::State) -> f64 {
        self.system.casimirs(state).as_ref()[index]
    }

    fn casimir_drift(
        &self,
        index: usize,
        state: &S::State,
        control: &S::Control,
    ) -> Result<Option<f64>, Trouble> {
        let start = self.casimir(index, state);
        // what it may be where it happens to be small
        let size = self.frame.linear.iter().fold(start.abs(), |size, linear| {
            let by = self.frame.unit(linear.tangent, self.frame.scale[linear.tangent]);
            let there = self.frame.displace(state, Map::Exponential, &by);
            size.max((self.casimir(index, &there) - start).abs())
        });
        let mut drift = 0.0;
        self.walk(self.step, Self::LONG, self.time, state, control, |state| {
            drift = larger(drift, (self.casimir(index, state) - start).abs());
        })?;
        Ok(Some(if drift == 0.0 { 0.0 } else { drift / size }))
    }

    /// The energies along a run.
    fn energies(
        &self,
        step: f64,
        steps: usize,
        state: &S::State,
        control: &S::Control,
    ) -> Result<Vec<f64>, Trouble> {
        let mut energies = vec![self.system.energy_at(state, self.time)];
        self.walk(step, steps, self.time, state, control, |state| {
            energies.push(self.system.energy_at(state, self.time));
        })?;
        Ok(energies)
    }

    /// What errors of the energy count relative to.
    fn energy_size(&self, state: &S::State) -> f64 {
        let differential = self.frame.differential(state, self.time);
        differential
            .iter()
            .zip(&self.frame.scale)
            .fold(f64::MIN_POSITIVE, |size, (x, scale)| size.max((x * scale).abs()))
    }

    /// How much of the range of the energy's error is a straight line's.
    fn energy_drift(&self, state: &S::State, control: &S::Control) -> Result<Option<f64>, Trouble> {
        let energies = self.energies(self.step, Self::LONG, state, control)?;
        let range = range(&energies);
        if range < 1e-11 * self.energy_size(state) {
            return Ok(None);
        }
        let middle = 0.5 * (energies.len() - 1) as f64;
        let times = || (0..energies.len()).map(|k| k as f64 - middle);
        let slope = times().zip(&energies).map(|(time, energy)| time * energy).sum::<f64>()
            / times().map(|time| time * time).sum::<f64>();
        Ok(Some(slope.abs() * 2.0 * middle / range))
    }

    /// By the ranges of the energy's error with steps and half as long ones.
    fn energy_order(&self, state: &S::State, control: &S::Control) -> Result<Option<f64>, Trouble> {
        let error = |halvings: usize| {
            let step = self.step / (1 << halvings) as f64;
            self.energies(step, 100 << halvings, state, control).map(|energies| range(&energies))
        };
        let (one, half) = (error(0)?, error(1)?);
        let measurable = half > 1e-12 * self.energy_size(state);
        Ok(measurable.then(|| (one / half).log2()))
    }

    /// A step, and one back that starts when the first one ends.
    fn reversibility(&self, state: &S::State, control: &S::Control) -> Result<Option<f64>, Trouble> {
        let there = self.one(self.step, self.time, state, control)?;
        let back = self.one(-self.step, self.time + self.step, &there, control)?;
        Ok(Some(self.frame.distance(state, &back)))
    }

    fn correction(&self, state: &S::State, control: &S::Control) -> Result<Option<f64>, Trouble> {
        let mut probe = Probe { system: self.system, state, time: self.time, control, worst: None };
        M::kernels(&mut probe, self.step);
        Ok(probe.worst)
    }

    fn definition(&self, state: &S::State, control: &S::Control) -> Result<Option<f64>, Trouble> {
        let mut step = self.step;
        // a fixed-point iteration asks for shorter steps than Newton's
        for _ in 0..6 {
            let mut walk = Walk::new(&self.frame, state, self.time, control);
            if !M::walk(&mut walk, step) {
                return Ok(None);
            }
            if !walk.lost {
                let is = self.one(step, self.time, state, control)?;
                return Ok(Some(self.frame.distance(&is, &walk.state)));
            }
            step *= 0.5;
        }
        Ok(None)
    }

    fn differential(&self, state: &S::State, _: &S::Control) -> Result<Option<f64>, Trouble> {
        let frame = &self.frame;
        let differential = frame.differential(state, self.time);
        let mut error = 0.0;
        for (i, scale) in frame.scale.iter().enumerate() {
            for map in [Map::Exponential, Map::Cayley] {
                let change = slope(1e-2 * scale, |at| {
                    let there = frame.displace(state, map, &frame.unit(i, at));
                    DVector::from_element(1, self.system.energy_at(&there, self.time))
                });
                error = larger(error, (change[0] - differential[i]).abs() * scale);
            }
        }
        // where all forces vanish, what the energy itself is counts
        let size = self.energy_size(state).max(self.system.energy_at(state, self.time).abs());
        Ok(Some(error / size))
    }

    fn antisymmetry(&self, state: &S::State, _: &S::Control) -> Result<Option<f64>, Trouble> {
        let tensor = self.frame.scaled(&self.frame.poisson(state));
        Ok(Some(largest(&(&tensor + tensor.transpose())) / tensor.amax()))
    }

    /// `Σ_l P^{il} ∂_l P^{jk}` and the other two of the cycle, in the coordinates that displacements are.
    fn jacobi(&self, state: &S::State, _: &S::Control) -> Result<Option<f64>, Trouble> {
        let frame = &self.frame;
        let n = frame.dimension();
        // a tangent vector in these coordinates is another one at the displaced state, of which only the configuration's part differs
        let in_coordinates = |by: &[f64]| {
            let there = frame.displace(state, Map::Exponential, by);
            let turn = frame.configuration_of(&DVector::from_column_slice(by));
            let small = frame.logarithmic_derivative(state, Map::Exponential, &turn)?.try_inverse()?;
            let mut inverse = DMatrix::identity(n, n);
            for (r, &i) in frame.configuration.iter().enumerate() {
                for (c, &j) in frame.configuration.iter().enumerate() {
                    inverse[(i, j)] = small[(r, c)];
                }
            }
            Some(frame.scaled(&(&inverse * frame.poisson(&there) * inverse.transpose())))
        };
        let tensor = frame.scaled(&frame.poisson(state));
        let mut changes = Vec::new();
        for l in 0..n {
            let column = derivative(1e-2, |at| {
                let there = in_coordinates(&frame.unit(l, at * frame.scale[l])).ok_or(Trouble::Degenerate)?;
                Ok(DVector::from_column_slice(there.as_slice()))
            })?;
            changes.push(DMatrix::from_column_slice(n, n, column.as_slice()));
        }
        let along = |i: usize, j: usize, k: usize| -> f64 {
            (0..n).map(|l| tensor[(i, l)] * changes[l][(j, k)]).sum()
        };
        let size =
            tensor.amax() * changes.iter().fold(f64::MIN_POSITIVE, |size, change| size.max(change.amax()));
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
        let scales = self.frame.configuration.iter().enumerate();
        DVector::from_iterator(
            self.frame.configuration.len(),
            scales.map(|(k, &i)| 0.5 * self.frame.scale[i] * (2.0 * k as f64 + 1.0).sin()),
        )
    }

    /// `(dR exp_x)* = φ₁(ad*_x)`: displacements and Poisson structure are of one group.
    fn exponential(&self, state: &S::State, _: &S::Control) -> Result<Option<f64>, Trouble> {
        let frame = &self.frame;
        let turn = self.turn();
        let n = turn.len();
        let measured =
            frame.logarithmic_derivative(state, Map::Exponential, &-&turn).ok_or(Trouble::Degenerate)?;
        let eta = turn.resize_vertically(frame.linear.len(), 0.0);
        let ad = frame.coadjoint(state, &eta);
        let mut error = 0.0;
        for k in 0..n {
            let mut m = DVector::zeros(frame.linear.len());
            m[k] = 1.0;
            let expected = series(&ad, &m).ok_or(Trouble::Degenerate)?;
            for i in 0..n {
                let [row, column] = [k, i].map(|k| frame.scale[frame.configuration[k]]);
                error = larger(error, (measured[(k, i)] - expected[i]).abs() * column / row);
            }
        }
        Ok(Some(error))
    }

    /// `τ(−ξ) = τ(ξ)⁻¹`
    fn inverse(&self, state: &S::State, _: &S::Control) -> Result<Option<f64>, Trouble> {
        let turn = self.turn();
        let error = [Map::Exponential, Map::Cayley].map(|map| {
            let there = self.frame.moved(state, map, &turn);
            self.frame.distance(state, &self.frame.moved(&there, map, &-&turn))
        });
        Ok(Some(larger(error[0], error[1])))
    }
}

/// How much less than claimed a measured order may be: halvings end before the limit.
const ORDER_SLACK: f64 = 0.15;

/// The largest entry; not-a-number if one is.
fn largest(matrix: &DMatrix<f64>) -> f64 {
    matrix.iter().fold(0.0, |size, x| larger(size, x.abs()))
}

fn range(values: &[f64]) -> f64 {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    high - low
}
