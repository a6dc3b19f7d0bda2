//! Arrays of numpy as slices, and back.

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyBufferError, PyMemoryError, PyValueError};
use pyo3::prelude::*;

/// An array of one dimension that is only read.
pub(crate) type Numbers<'py> = PyReadonlyArray1<'py, f64>;

/// Its numbers.
pub(crate) fn slice<'a>(numbers: &'a Numbers<'_>) -> PyResult<&'a [f64]> {
    numbers.as_slice().map_err(|_| {
        PyBufferError::new_err("the array is not contiguous; `numpy.ascontiguousarray` copies it")
    })
}

/// A copy of its numbers, as many as there are to be.
pub(crate) fn numbers(given: &Numbers<'_>, expected: usize, what: &str) -> PyResult<Vec<f64>> {
    let given = slice(given)?;
    check(given, expected, what)?;
    Ok(given.to_vec())
}

/// Whether there are as many numbers as there are to be.
pub(crate) fn check(given: &[f64], expected: usize, what: &str) -> PyResult<()> {
    match given.len() {
        got if got == expected => Ok(()),
        got => Err(PyValueError::new_err(format!("{what}: {got} numbers in place of {expected}"))),
    }
}

/// How many rows of this length there are.
pub(crate) fn rows(given: &[f64], length: usize, what: &str) -> PyResult<usize> {
    if length == 0 || !given.len().is_multiple_of(length) {
        let got = given.len();
        return Err(PyValueError::new_err(format!("{what}: {got} numbers are no rows of {length}")));
    }
    Ok(given.len() / length)
}

/// The numbers as an array, which takes them over.
pub(crate) fn array(py: Python<'_>, numbers: Vec<f64>) -> Py<PyArray1<f64>> {
    PyArray1::from_vec(py, numbers).unbind()
}

/// Appends numbers, if there is room for them.
pub(crate) fn append(to: &mut Vec<f64>, more: &[f64]) -> PyResult<()> {
    to.try_reserve(more.len()).map_err(|_| {
        PyMemoryError::new_err("there is no room for so many states; record fewer, by `every` or `t_eval`")
    })?;
    to.extend_from_slice(more);
    Ok(())
}

/// What a function of the user's returns: so many numbers.
pub(crate) fn returned(value: &Bound<'_, PyAny>, expected: usize, what: &str) -> PyResult<Vec<f64>> {
    let given = match value.cast::<PyArray1<f64>>() {
        Ok(array) => {
            slice(&array.try_readonly().map_err(|error| PyBufferError::new_err(error.to_string()))?)?.to_vec()
        }
        Err(_) => value.extract::<Vec<f64>>()?,
    };
    check(&given, expected, what)?;
    Ok(given)
}
