//! Single steps.

use std::sync::Mutex;

use coadjoint::erased;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyBufferError, PyTypeError};
use pyo3::prelude::*;

use crate::error;
use crate::numbers::{Numbers, check, slice};
use crate::system::{System, scheme};
use crate::watch::Watch;

/// Takes steps of one size, one call for each.
#[pyclass(frozen, module = "coadjoint._native")]
pub(crate) struct Stepper {
    stepper: Mutex<erased::Stepper>,
    width: usize,
    controls: usize,
}

impl Stepper {
    fn with<T>(&self, f: impl FnOnce(&mut erased::Stepper) -> PyResult<T>) -> PyResult<T> {
        match self.stepper.try_lock() {
            Ok(mut stepper) => f(&mut stepper),
            Err(std::sync::TryLockError::Poisoned(poisoned)) => f(&mut poisoned.into_inner()),
            Err(std::sync::TryLockError::WouldBlock) => Err(error::in_use("stepper")),
        }
    }

    /// The state as its array: itself, or what it has by the name `flat`.
    fn state<'py>(&self, state: &Bound<'py, PyAny>) -> PyResult<numpy::PyReadwriteArray1<'py, f64>> {
        let wrong = || {
            PyTypeError::new_err(
                "the state must be a contiguous array of `float64` of one dimension, or a `State`",
            )
        };
        let array = match state.cast::<PyArray1<f64>>() {
            Ok(array) => array.clone(),
            Err(_) => state.getattr("flat")?.cast_into::<PyArray1<f64>>().map_err(|_| wrong())?,
        };
        array.try_readwrite().map_err(|error| PyBufferError::new_err(error.to_string()))
    }

    fn control<'a>(&self, control: &'a Option<Control<'_>>) -> PyResult<&'a [f64]> {
        let control = match control {
            Some(Control::Array(control)) => slice(control)?,
            Some(Control::Sequence(control)) => control,
            None => return Ok(&[]),
        };
        check(control, self.controls, "the controls")?;
        Ok(control)
    }
}

/// Controls of a step: an array is not copied.
#[derive(FromPyObject)]
enum Control<'py> {
    Array(Numbers<'py>),
    Sequence(Vec<f64>),
}

#[pymethods]
impl System {
    /// What takes steps of this length with a scheme.
    fn stepper(&self, scheme: &str, step: f64) -> PyResult<Stepper> {
        let (width, controls) = self.lengths();
        let stepper =
            erased::Stepper::new(self.erased(), &self::scheme(scheme)?, step).map_err(error::stepper)?;
        Ok(Stepper { stepper: Mutex::new(stepper), width, controls })
    }
}

#[pymethods]
impl Stepper {
    /// Takes one step: the state's array is the next one afterwards.
    #[pyo3(signature = (state, control=None))]
    fn step(&self, py: Python<'_>, state: &Bound<'_, PyAny>, control: Option<Control<'_>>) -> PyResult<()> {
        let mut state = self.state(state)?;
        let control = self.control(&control)?;
        let state = state.as_slice_mut().map_err(|error| PyBufferError::new_err(error.to_string()))?;
        self.with(|stepper| match stepper.step(state, control) {
            Ok(_) => Ok(()),
            Err(error) => Err(error::step(py, &error, stepper.time(), state)),
        })
    }

    /// Takes some steps, with a control that is held.
    #[pyo3(signature = (state, count, control=None))]
    fn steps(
        &self,
        py: Python<'_>,
        state: &Bound<'_, PyAny>,
        count: u64,
        control: Option<Control<'_>>,
    ) -> PyResult<()> {
        let mut state = self.state(state)?;
        let control = self.control(&control)?;
        let state = state.as_slice_mut().map_err(|error| PyBufferError::new_err(error.to_string()))?;
        check(state, self.width, "the state")?;
        self.with(|stepper| {
            // out of it `steps` leaves what was reached
            let outcome = py.detach(|| {
                let watch = Watch::new(None);
                let (mut left, mut most) = (count, 64);
                while left > 0 && !watch.has_failed() {
                    let some = left.min(most);
                    if let Err(error) = stepper.steps(state, control, some) {
                        return Ok(Some(error));
                    }
                    left -= some;
                    most = watch.look((count - left) as f64 / count as f64);
                }
                watch.into_error().map_or(Ok(None), Err)
            })?;
            outcome.map_or(Ok(()), |error| Err(error::run(py, &error, state)))
        })
    }

    /// The time at which the next step starts.
    #[getter]
    fn t(&self) -> PyResult<f64> {
        self.with(|stepper| Ok(stepper.time()))
    }

    /// Sets the time.
    #[setter]
    fn set_t(&self, time: f64) -> PyResult<()> {
        self.with(|stepper| {
            stepper.set_time(time);
            Ok(())
        })
    }

    /// The length of the steps.
    #[getter]
    fn step_size(&self) -> PyResult<f64> {
        self.with(|stepper| Ok(stepper.step_size()))
    }

    /// The steps taken since the start, or since the time was set.
    #[getter]
    fn steps_taken(&self) -> PyResult<u64> {
        self.with(|stepper| Ok(stepper.steps_taken()))
    }

    /// What is carried from one step to the next.
    fn snapshot(&self) -> PyResult<Vec<f64>> {
        self.with(|stepper| Ok(stepper.snapshot()))
    }

    /// Takes back what `snapshot` gave.
    fn restore(&self, memory: Vec<f64>) -> PyResult<()> {
        self.with(|stepper| stepper.restore(&memory).map_err(error::value))
    }
}
