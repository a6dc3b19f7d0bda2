//! Descriptions that were read, and systems that are made of them.

use std::sync::Arc;

use coadjoint::__private::Components as _;
use coadjoint::certify::{self, certify_erased};
use coadjoint::erased::dynamic::Rule;
use coadjoint::erased::{self, Description, EnsembleSystem, RetractionKind};
use coadjoint::{Kind, Quantity, Role, Scheme, Side};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::error::{self, Place};
use crate::numbers::{Numbers, array, check, numbers, rows, slice};

/// A quantity: its name, role, kind, shape, components, tangent, unit, and documentation.
type Described = (
    &'static str,
    &'static str,
    String,
    Vec<usize>,
    Vec<&'static str>,
    (usize, usize),
    Option<&'static str>,
    &'static str,
);

/// A description that was read and derived, or compiled ahead.
#[pyclass(frozen, module = "coadjoint._native")]
pub(crate) struct Model {
    description: Description,
    about: String,
    warnings: Vec<(String, Option<Place>)>,
    schemes: Vec<String>,
    make: Box<Make>,
}

/// Makes the system with some parameters.
type Make = dyn Fn(&[f64]) -> Arc<dyn EnsembleSystem> + Send + Sync;

impl Model {
    /// The model of a system that is compiled ahead.
    pub(crate) fn compiled<S>() -> Self
    where
        S: coadjoint::System<Scalar = f64> + EnsembleSystem,
    {
        let make = |parameters: &[f64]| -> Arc<dyn EnsembleSystem> {
            let mut own = S::Parameters::<f64>::splat(0.0);
            own.as_mut().iter_mut().zip(parameters).for_each(|(to, number)| *to = *number);
            Arc::new(S::from_parameters(&own))
        };
        let system = make(&[]);
        let maps = RetractionKind::ALL.into_iter();
        let schemes = maps.flat_map(|map| Rule::NAMED.iter().map(move |&rule| (map, rule)));
        let schemes = schemes.filter(|(map, rule)| system.method(*map, *rule, 1.0).is_some());
        Self {
            description: Description::of::<S>(),
            about: String::new(),
            warnings: Vec::new(),
            schemes: schemes.map(|(map, rule)| Scheme::Step(map, rule).to_string()).collect(),
            make: Box::new(make),
        }
    }
}

#[pymethods]
impl Model {
    /// Reads a description, and derives its equations.
    #[new]
    #[pyo3(signature = (text, name=None))]
    fn new(py: Python<'_>, text: &str, name: Option<&str>) -> PyResult<Self> {
        let made = py.detach(|| coadjoint_dynamic::Model::from_file(text, "description", name));
        let model = made.map_err(|error| error::description(py, &error))?;
        let steps = model.definition().steps.iter().flat_map(|step| &step.schemes);
        Ok(Self {
            description: model.description(),
            about: model.about().to_owned(),
            warnings: model.warnings().iter().map(error::problem).collect(),
            schemes: steps.map(|(map, rule)| Scheme::Step(*map, *rule).to_string()).collect(),
            make: Box::new(move |parameters| Arc::new(model.system(parameters))),
        })
    }

    /// The struct's name.
    #[getter]
    fn name(&self) -> &'static str {
        self.description.name
    }

    /// The first line of its documentation.
    #[getter]
    fn about(&self) -> &str {
        &self.about
    }

    /// What is no error, but worth knowing.
    #[getter]
    fn warnings(&self) -> Vec<(String, Option<Place>)> {
        self.warnings.clone()
    }

    /// Parameters, state and controls.
    #[getter]
    fn quantities(&self) -> [Vec<Described>; 3] {
        let Description { parameters, state, controls, .. } = self.description;
        [parameters, state, controls].map(|all| all.iter().map(described).collect())
    }

    /// The names of the Casimirs.
    #[getter]
    fn casimirs(&self) -> Vec<&'static str> {
        self.description.casimirs.to_vec()
    }

    /// What the system is, in words and truths.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let facts = PyDict::new(py);
        facts.set_item("autonomous", self.description.autonomous)?;
        facts.set_item("invariant", self.description.invariant)?;
        facts.set_item("forced", self.description.forced)?;
        facts.set_item("piecewise", self.description.piecewise)?;
        facts.set_item("side", if self.description.side == Side::Left { "left" } else { "right" })?;
        Ok(facts)
    }

    /// The schemes whose steps were derived.
    #[getter]
    fn schemes(&self) -> Vec<String> {
        self.schemes.clone()
    }

    /// The system with these parameters.
    fn system(&self, parameters: Numbers<'_>) -> PyResult<System> {
        let expected = length(self.description.parameters);
        let parameters = numbers(&parameters, expected, "the parameters")?;
        let system = (self.make)(&parameters);
        system.validate().map_err(error::value)?;
        Ok(System { system })
    }
}

fn described(quantity: &Quantity) -> Described {
    let role = match quantity.role {
        Role::Parameter => "parameter",
        Role::Configuration => "configuration",
        Role::Momentum => "momentum",
        Role::Advected => "advected",
        Role::Control => "control",
        _ => "other",
    };
    let count = quantity.components.len();
    let (kind, shape) = match quantity.kind {
        Kind::Scalar => ("scalar", vec![]),
        Kind::Vector(n) => ("vector", vec![n]),
        Kind::SymmetricMatrix(n) => ("symmetric matrix", vec![n, n]),
        Kind::Matrix(rows, columns) => ("matrix", vec![rows, columns]),
        Kind::UnitComplex => ("unit complex", vec![2]),
        Kind::UnitQuaternion => ("unit quaternion", vec![4]),
        Kind::RigidMotion2 => ("rigid motion 2", vec![4]),
        Kind::RigidMotion3 => ("rigid motion 3", vec![7]),
        _ => ("other", vec![count]),
    };
    let components = quantity.components.to_vec();
    (quantity.name, role, kind.to_owned(), shape, components, quantity.tangent, quantity.unit, quantity.doc)
}

/// How many numbers these quantities are.
pub(crate) fn length(quantities: &[Quantity]) -> usize {
    quantities.iter().map(|quantity| quantity.components.len()).sum()
}

/// A system with its parameters.
#[pyclass(frozen, module = "coadjoint._native")]
pub(crate) struct System {
    pub(crate) system: Arc<dyn EnsembleSystem>,
}

impl System {
    /// The system as the library's calls take it.
    pub(crate) fn erased(&self) -> Arc<dyn erased::System> {
        self.system.clone()
    }

    pub(crate) fn of(&self) -> &dyn erased::System {
        &*self.system
    }

    /// How many numbers a state is, and how many the controls are.
    pub(crate) fn lengths(&self) -> (usize, usize) {
        let description = self.of().description();
        (length(description.state), length(description.controls))
    }

    /// What is computed at each of some states, each at a time and with a control of its own.
    fn at_each(
        &self,
        py: Python<'_>,
        (states, times, controls): (Numbers<'_>, Numbers<'_>, Numbers<'_>),
        f: impl Fn(&[f64], f64, &[f64], &mut Vec<f64>) + Sync,
    ) -> PyResult<Py<PyArray1<f64>>> {
        let (width, inputs) = self.lengths();
        let (states, times, controls) = (slice(&states)?, slice(&times)?, slice(&controls)?);
        let count = rows(states, width, "states")?;
        check(times, count, "times")?;
        check(controls, count * inputs, "controls")?;
        let all = py.detach(|| {
            let mut all = Vec::new();
            for (place, state) in states.chunks_exact(width).enumerate() {
                f(state, times[place], &controls[place * inputs..(place + 1) * inputs], &mut all);
            }
            all
        });
        Ok(array(py, all))
    }
}

#[pymethods]
impl System {
    /// The parameters, with the constants of the description behind them.
    #[getter]
    fn parameters(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.of().parameters())
    }

    /// How far each state is off its group.
    fn deviation(&self, py: Python<'_>, states: Numbers<'_>) -> PyResult<Py<PyArray1<f64>>> {
        let states = slice(&states)?;
        let (width, _) = self.lengths();
        rows(states, width, "states")?;
        Ok(array(py, states.chunks_exact(width).map(|state| self.of().deviation(state)).collect()))
    }

    /// The energies of states.
    fn energy(
        &self,
        py: Python<'_>,
        states: Numbers<'_>,
        times: Numbers<'_>,
        controls: Numbers<'_>,
    ) -> PyResult<Py<PyArray1<f64>>> {
        let system = self.of();
        self.at_each(py, (states, times, controls), |state, time, control, all| {
            all.push(system.energy(state, time, control));
        })
    }

    /// The Casimirs of states, one state after the other.
    fn casimirs(&self, py: Python<'_>, states: Numbers<'_>) -> PyResult<Py<PyArray1<f64>>> {
        let (width, _) = self.lengths();
        let states = slice(&states)?;
        rows(states, width, "states")?;
        let system = self.of();
        Ok(array(
            py,
            py.detach(|| states.chunks_exact(width).flat_map(|state| system.casimirs(state)).collect()),
        ))
    }

    /// The motion as derivatives of the stored numbers.
    fn vector_field(
        &self,
        py: Python<'_>,
        states: Numbers<'_>,
        times: Numbers<'_>,
        controls: Numbers<'_>,
    ) -> PyResult<Py<PyArray1<f64>>> {
        let system = self.of();
        self.at_each(py, (states, times, controls), |state, time, control, all| {
            all.extend(system.vector_field(state, time, control));
        })
    }

    /// The motion in the coordinates of tangent vectors: velocities, then what changes the momenta.
    fn motion(
        &self,
        py: Python<'_>,
        states: Numbers<'_>,
        times: Numbers<'_>,
        controls: Numbers<'_>,
    ) -> PyResult<Py<PyArray1<f64>>> {
        let system = self.of();
        self.at_each(py, (states, times, controls), |state, time, control, all| {
            all.extend(system.motion(state, time, control));
        })
    }

    /// The state with a velocity in the places of momenta turned into momenta.
    fn with_velocity(
        &self,
        py: Python<'_>,
        state: Numbers<'_>,
        time: f64,
        control: Numbers<'_>,
    ) -> PyResult<Py<PyArray1<f64>>> {
        let (width, inputs) = self.lengths();
        let (state, control) =
            (numbers(&state, width, "the state")?, numbers(&control, inputs, "the controls")?);
        Ok(array(py, self.of().with_velocity(&state, time, &control).map_err(error::value)?))
    }

    /// The state displaced by a tangent vector.
    fn displace(&self, py: Python<'_>, state: Numbers<'_>, by: Numbers<'_>) -> PyResult<Py<PyArray1<f64>>> {
        let (width, _) = self.lengths();
        let state = numbers(&state, width, "the state")?;
        let by = numbers(&by, self.dimension(), "the tangent vector")?;
        Ok(array(py, self.of().displace(&state, RetractionKind::Exponential, &by)))
    }

    /// The names of the description's events.
    #[getter]
    fn events(&self) -> Vec<&'static str> {
        self.of().description().events.iter().map(|(name, _)| *name).collect()
    }

    /// How many coordinates a tangent vector of the states has.
    #[getter]
    fn dimension(&self) -> usize {
        self.of().description().state.iter().map(|quantity| quantity.tangent.1).max().unwrap_or(0)
    }

    /// How the stored numbers of a state change by each coordinate of a tangent vector: a matrix, column by column.
    fn tangent_map(&self, py: Python<'_>, state: Numbers<'_>) -> PyResult<Py<PyArray1<f64>>> {
        let (width, _) = self.lengths();
        let state = numbers(&state, width, "the state")?;
        Ok(array(py, tangent_map(self.of(), &state)))
    }

    /// The next state, and its derivatives by state, controls and parameters: their numbers of columns, and their entries column by column.
    #[pyo3(signature = (scheme, step, state, time, control))]
    #[allow(clippy::type_complexity, reason = "arrays, one after the other")]
    fn jacobian(
        &self,
        py: Python<'_>,
        scheme: &str,
        step: f64,
        state: Numbers<'_>,
        time: f64,
        control: Numbers<'_>,
    ) -> PyResult<(Py<PyArray1<f64>>, [(usize, Py<PyArray1<f64>>); 3])> {
        let (width, inputs) = self.lengths();
        let (mut state, control) =
            (numbers(&state, width, "the state")?, numbers(&control, inputs, "the controls")?);
        let mut stepper =
            erased::Stepper::new(self.erased(), &self::scheme(scheme)?, step).map_err(error::stepper)?;
        stepper.set_time(time);
        let derived = stepper.step_with_jacobian(&mut state, &control);
        let (jacobian, _) = derived.map_err(|error| error::jacobian(py, &error, time, &state))?;
        let parts = [jacobian.state, jacobian.control, jacobian.parameters];
        Ok((array(py, state), parts.map(|part| (part.ncols(), array(py, part.as_slice().to_vec())))))
    }

    /// What the derivatives of a run make of covectors on its states: one on the first state, one on the parameters, and one on each control.
    #[allow(clippy::type_complexity, reason = "arrays, one after the other")]
    #[allow(clippy::too_many_arguments, reason = "Python's own words are on the other side")]
    fn pull_back(
        &self,
        py: Python<'_>,
        scheme: &str,
        times: Numbers<'_>,
        states: Numbers<'_>,
        controls: Numbers<'_>,
        covectors: Numbers<'_>,
    ) -> PyResult<(Py<PyArray1<f64>>, Py<PyArray1<f64>>, Py<PyArray1<f64>>)> {
        let (width, inputs) = self.lengths();
        let (times, states, controls, covectors) =
            (slice(&times)?, slice(&states)?, slice(&controls)?, slice(&covectors)?);
        let (count, dimension) = (rows(states, width, "states")?, self.dimension());
        check(times, count, "times")?;
        check(controls, count * inputs, "controls")?;
        check(covectors, count * dimension, "covectors")?;
        let scheme = self::scheme(scheme)?;
        // none where the description does not ask for them
        let (mut by_parameters, mut by_controls) = (Vec::new(), vec![0.0; count * inputs]);
        let mut has_controls = true;
        let mut covector = covectors[(count - 1) * dimension..].to_vec();
        let watch = crate::watch::Watch::new(None);
        let mut until = watch.look(0.0);
        let mut stepper: Option<erased::Stepper> = None;
        for place in (0..count - 1).rev() {
            let mut state = states[place * width..(place + 1) * width].to_vec();
            let (time, step) = (times[place], times[place + 1] - times[place]);
            let control = &controls[(place + 1) * inputs..(place + 2) * inputs];
            // steps of one length differ by the roundoff of times
            let mut own = match stepper.take() {
                Some(known) if (known.step_size() - step).abs() <= 1e-9 * step.abs() => known,
                _ => erased::Stepper::new(self.erased(), &scheme, step).map_err(error::stepper)?,
            };
            own.set_time(time);
            let derived = own.step_with_jacobian(&mut state, control);
            let (jacobian, _) = derived.map_err(|error| error::jacobian(py, &error, time, &state))?;
            stepper = Some(own);
            has_controls = jacobian.control.ncols() == inputs;
            by_parameters.resize(jacobian.parameters.ncols(), 0.0);
            for (column, sum) in jacobian.parameters.column_iter().zip(&mut by_parameters) {
                *sum += column.iter().zip(&covector).map(|(a, b)| a * b).sum::<f64>();
            }
            let own = &mut by_controls[(place + 1) * inputs..(place + 2) * inputs];
            for (column, sum) in jacobian.control.column_iter().zip(own) {
                *sum += column.iter().zip(&covector).map(|(a, b)| a * b).sum::<f64>();
            }
            let before: Vec<f64> = jacobian
                .state
                .column_iter()
                .map(|column| column.iter().zip(&covector).map(|(a, b)| a * b).sum::<f64>())
                .collect();
            let more = &covectors[place * dimension..(place + 1) * dimension];
            covector = before.iter().zip(more).map(|(a, b)| a + b).collect();
            until -= 1;
            if until == 0 {
                until = watch.look(0.0);
                if watch.has_failed() {
                    break;
                }
            }
        }
        match watch.into_error() {
            Some(error) => Err(error),
            None => {
                let by_controls = if has_controls { by_controls } else { Vec::new() };
                Ok((array(py, covector), array(py, by_parameters), array(py, by_controls)))
            }
        }
    }

    /// What a scheme promises of its steps, measured at states.
    #[pyo3(signature = (scheme, states, controls, step=None))]
    fn certify<'py>(
        &self,
        py: Python<'py>,
        scheme: &str,
        states: Numbers<'py>,
        controls: Numbers<'py>,
        step: Option<f64>,
    ) -> PyResult<(String, bool, Bound<'py, PyList>)> {
        let (width, inputs) = self.lengths();
        let (states, controls) = (slice(&states)?, slice(&controls)?);
        rows(states, width, "states")?;
        let states: Vec<Vec<f64>> = states.chunks_exact(width).map(<[f64]>::to_vec).collect();
        let controls: Vec<Vec<f64>> =
            if inputs == 0 { vec![] } else { controls.chunks_exact(inputs).map(<[f64]>::to_vec).collect() };
        let scheme = self::scheme(scheme)?;
        // where a table or a ramp of time begins there is a kink, and mostly that is zero
        let is_timed = !self.of().description().autonomous;
        let time = if is_timed { 25.25 * step.unwrap_or(0.01) } else { 0.0 };
        let report = py
            .detach(|| certify_erased(self.of(), &scheme, &states, &controls, time, step))
            .map_err(error::value)?;
        let certificates = PyList::empty(py);
        for one in &report.certificates {
            let (bound, at_most) = match one.bound {
                Some(certify::Bound::AtMost(bound)) => (Some(bound), Some(true)),
                Some(certify::Bound::AtLeast(bound)) => (Some(bound), Some(false)),
                _ => (None, None),
            };
            certificates.append((
                &one.name,
                one.figure,
                bound,
                at_most,
                one.verdict.to_string(),
                one.state,
            ))?;
        }
        Ok((report.to_string(), report.passed(), certificates))
    }
}

/// A scheme of its name.
pub(crate) fn scheme(text: &str) -> PyResult<Scheme> {
    text.parse::<Scheme>().map_err(error::value)
}

/// How the stored numbers of a state change by each coordinate of a tangent vector, column by column: by differences of displacements, which know how
/// each group is stored, to some parts in 10¹⁴.
fn tangent_map(system: &dyn erased::System, state: &[f64]) -> Vec<f64> {
    /// Of a central difference of order 8.
    const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    const TURN: f64 = 1.0 / 64.0;
    let description = system.description();
    let dimension = description.state.iter().map(|quantity| quantity.tangent.1).max().unwrap_or(0);
    let mut columns = Vec::with_capacity(dimension * state.len());
    for direction in 0..dimension {
        let at = |by: f64| {
            let mut tangent = vec![0.0; dimension];
            tangent[direction] = by;
            system.displace(state, RetractionKind::Exponential, &tangent)
        };
        let mut column = vec![0.0; state.len()];
        for (k, weight) in (1..).zip(WEIGHTS) {
            let by = f64::from(k) * TURN;
            let ends = at(by).into_iter().zip(at(-by));
            column
                .iter_mut()
                .zip(ends)
                .for_each(|(sum, (after, before))| *sum += (after - before) * weight / TURN);
        }
        columns.extend(column);
    }
    columns
}
