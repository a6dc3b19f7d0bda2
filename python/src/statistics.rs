//! What is known of a quantity over many members.

use coadjoint::ensemble::{Spread, Statistics as Known};
use numpy::{AllowTypeChange, PyArrayLike1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::numbers::slice;

/// How a quantity is distributed over members that come in parts.
#[pyclass(module = "coadjoint._native")]
pub(crate) struct Statistics {
    of: Known,
}

impl Statistics {
    fn spread(&self) -> Spread {
        self.of.spread(0.0)
    }
}

#[pymethods]
impl Statistics {
    #[new]
    #[pyo3(signature = (values=None, /))]
    fn new(values: Option<PyArrayLike1<'_, f64, AllowTypeChange>>) -> PyResult<Self> {
        let of = match &values {
            Some(values) => Known::of(slice(values)?.iter().copied()),
            None => Known::default(),
        };
        Ok(Self { of })
    }

    /// Reads what `to_bytes` wrote.
    #[staticmethod]
    #[pyo3(signature = (data, /))]
    fn from_bytes(data: &[u8]) -> PyResult<Self> {
        let of = Known::from_bytes(data);
        let of =
            of.ok_or_else(|| PyValueError::new_err("these are no bytes that `Statistics.to_bytes` wrote"))?;
        Ok(Self { of })
    }

    /// Writes what is known; of the same members always the same bytes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.of.to_bytes())
    }

    /// Adds what is known of other members.
    #[pyo3(signature = (other, /))]
    fn merge(slf: &Bound<'_, Self>, other: &Bound<'_, Self>) -> PyResult<()> {
        // a copy: it may be this one
        let other = other.try_borrow()?.of.clone();
        slf.try_borrow_mut()?.of.merge(&other);
        Ok(())
    }

    /// How many members there are.
    #[getter]
    fn members(&self) -> u64 {
        self.of.members()
    }

    /// Their mean: the exact one, rounded once.
    #[getter]
    fn mean(&self) -> f64 {
        self.spread().mean
    }

    /// Their standard deviation from the mean: the root of the exact variance, which is rounded once.
    #[getter]
    fn deviation(&self) -> f64 {
        self.spread().deviation
    }

    /// The least value.
    #[getter]
    fn min(&self) -> f64 {
        self.spread().quantiles[0]
    }

    /// The greatest value.
    #[getter]
    fn max(&self) -> f64 {
        self.spread().quantiles[6]
    }

    /// Quantiles by their levels: 0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.
    #[getter]
    fn quantiles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let quantiles = PyDict::new(py);
        for (level, quantile) in Spread::LEVELS.into_iter().zip(self.spread().quantiles) {
            quantiles.set_item(level, quantile)?;
        }
        Ok(quantiles)
    }

    /// How far a quantile may be off, relative to the size of the values next to it; 0 where they are exact.
    #[getter]
    fn relative_error(&self) -> f64 {
        self.of.relative_error()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        Ok((py.get_type::<Self>().getattr("from_bytes")?, (self.to_bytes(py),)))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.of == other.of
    }

    fn __repr__(&self) -> String {
        let Spread { members, mean, deviation, quantiles: [least, .., greatest], .. } = self.spread();
        format!("<statistics of {members} values: {mean} ± {deviation}, from {least} to {greatest}>")
    }
}
