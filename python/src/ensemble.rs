//! Ensembles.

use std::sync::Mutex;

use coadjoint::erased;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::error;
use crate::numbers::{Numbers, array, check, rows, slice};
use crate::system::{System, length, scheme};
use crate::watch::Watch;

/// Many states of one system that move at the same time, each with parameters of its own.
#[pyclass(frozen, module = "coadjoint._native")]
pub(crate) struct Ensemble {
    moving: Mutex<Moving>,
    members: usize,
    width: usize,
    controls: usize,
}

struct Moving {
    ensemble: erased::Ensemble,
    /// What each member holds.
    controls: Vec<f64>,
}

impl Ensemble {
    fn with<T>(&self, f: impl FnOnce(&mut Moving) -> PyResult<T>) -> PyResult<T> {
        match self.moving.try_lock() {
            Ok(mut moving) => f(&mut moving),
            Err(std::sync::TryLockError::Poisoned(poisoned)) => f(&mut poisoned.into_inner()),
            Err(std::sync::TryLockError::WouldBlock) => Err(error::in_use("ensemble")),
        }
    }
}

impl Moving {
    /// The states of all members, of those that failed the last that they reached.
    fn states(&mut self, members: usize, width: usize) -> Vec<f64> {
        let mut all = vec![f64::NAN; members * width];
        if self.ensemble.failed().is_empty() {
            for (member, _, state) in self.ensemble.members() {
                all[member * width..(member + 1) * width].copy_from_slice(&state);
            }
            return all;
        }
        // whoever chooses controls is shown all states
        let held = &self.controls;
        self.ensemble.control(|member, state, control| {
            all[member * width..(member + 1) * width].copy_from_slice(state);
            let count = control.len();
            control.copy_from_slice(&held[member * count..(member + 1) * count]);
        });
        all
    }
}

#[pymethods]
impl System {
    /// An ensemble of states, each with its parameters.
    fn ensemble(
        &self,
        py: Python<'_>,
        scheme: &str,
        step: f64,
        states: Numbers<'_>,
        parameters: Numbers<'_>,
    ) -> PyResult<Ensemble> {
        let (width, controls) = self.lengths();
        let (states, parameters) = (slice(&states)?, slice(&parameters)?);
        let members = rows(states, width, "states")?;
        let scheme = self::scheme(scheme)?;
        let fields = length(self.of().description().parameters);
        check(parameters, members * fields, "parameters")?;
        // behind the fields there are the constants of the description
        let all = self.of().parameters();
        let constants = &all[fields.min(all.len())..];
        let each = (0..members).map(|member| {
            let own = &parameters[member * fields..(member + 1) * fields];
            ([own, constants].concat(), states[member * width..(member + 1) * width].to_vec())
        });
        let ensemble =
            py.detach(|| erased::Ensemble::new(&*self.system, &scheme, each, step)).map_err(error::value)?;
        let held = vec![0.0; members * controls];
        let moving = Mutex::new(Moving { ensemble, controls: held });
        Ok(Ensemble { moving, members, width, controls })
    }
}

#[pymethods]
impl Ensemble {
    /// Sets the controls that members hold.
    fn control(&self, controls: Numbers<'_>) -> PyResult<()> {
        let controls = slice(&controls)?;
        check(controls, self.members * self.controls, "controls")?;
        self.with(|moving| {
            moving.controls.copy_from_slice(controls);
            let count = self.controls;
            moving.ensemble.control(|member, _, control| {
                control.copy_from_slice(&controls[member * count..(member + 1) * count]);
            });
            Ok(())
        })
    }

    /// Takes some steps with all members, on all cores.
    #[pyo3(signature = (steps, progress=None))]
    fn run(&self, py: Python<'_>, steps: u64, progress: Option<Py<PyAny>>) -> PyResult<u64> {
        self.with(|moving| {
            py.detach(|| {
                let watch = Watch::new(progress);
                let (mut left, mut most, mut taken) = (steps, 16, 0);
                while left > 0 && !watch.has_failed() {
                    let some = left.min(most);
                    taken += moving.ensemble.run(some);
                    left -= some;
                    most = watch.look((steps - left) as f64 / steps as f64);
                }
                watch.into_error().map_or(Ok(taken), Err)
            })
        })
    }

    /// The states of all members, of those that failed the last that they reached.
    fn states(&self, py: Python<'_>) -> PyResult<Py<PyArray1<f64>>> {
        let (members, width) = (self.members, self.width);
        self.with(|moving| Ok(array(py, moving.states(members, width))))
    }

    /// The members that failed: their numbers, the steps they could not take, and why.
    #[getter]
    fn failed(&self) -> PyResult<Vec<(usize, u64, String)>> {
        self.with(|moving| {
            let failed = moving.ensemble.failed().iter();
            Ok(failed.map(|one| (one.member, one.step, one.source.to_string())).collect())
        })
    }

    /// The time.
    #[getter]
    fn t(&self) -> PyResult<f64> {
        self.with(|moving| Ok(moving.ensemble.time()))
    }

    /// How many members are stepped side by side.
    #[getter]
    fn width(&self) -> PyResult<usize> {
        self.with(|moving| Ok(moving.ensemble.width()))
    }
}
