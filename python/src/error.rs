//! Errors as exceptions: those of the package, `coadjoint._errors`.

use coadjoint::erased::{JacobianError, StepperError};
use coadjoint::{RunError, StepError};
use coadjoint_dynamic::{DescriptionError, Problem};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// A value that is refused, with all that caused it.
pub(crate) fn value(error: impl std::error::Error) -> PyErr {
    PyValueError::new_err(message(&error))
}

/// What an error says, and what its causes say.
pub(crate) fn message(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        let more = cause.to_string();
        if !text.contains(&more) {
            text.push_str(": ");
            text.push_str(&more);
        }
        source = cause.source();
    }
    text
}

/// The exception of this name in the package.
fn exception<'py>(py: Python<'py>, name: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made = py
        .import("coadjoint._errors")
        .and_then(|module| module.getattr(name))
        .and_then(|class| class.call1(arguments));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// A problem of a description: what is wrong, and where: line, column, width, and the line's text.
pub(crate) type Place = (usize, usize, usize, String);

/// A problem of a description as Python has it.
pub(crate) fn problem(problem: &Problem) -> (String, Option<Place>) {
    let place = problem.place.as_ref();
    (problem.message.clone(), place.map(|place| (place.line, place.column, place.width, place.text.clone())))
}

/// A description that no system can be made of.
pub(crate) fn description(py: Python<'_>, error: &DescriptionError) -> PyErr {
    let problems: Vec<_> = error.problems().iter().map(problem).collect();
    exception(py, "DescriptionError", (error.to_string(), problems))
}

/// A step that could not be taken from a state at a time.
pub(crate) fn step(py: Python<'_>, error: &StepError, time: f64, state: &[f64]) -> PyErr {
    exception(py, "StepError", (message(error), time, numpy::PyArray1::from_slice(py, state)))
}

/// A run that ended at a step which could not be taken.
pub(crate) fn run(py: Python<'_>, error: &RunError, state: &[f64]) -> PyErr {
    let text = message(error);
    exception(py, "StepError", (text, error.time, numpy::PyArray1::from_slice(py, state), error.step))
}

/// A stepper that cannot be built.
pub(crate) fn stepper(error: StepperError) -> PyErr {
    value(error)
}

/// Derivatives that there are not.
pub(crate) fn jacobian(py: Python<'_>, error: &JacobianError, time: f64, state: &[f64]) -> PyErr {
    match error {
        JacobianError::Step(error) => step(py, error, time, state),
        other => PyValueError::new_err(message(other)),
    }
}

/// What another thread works with at this moment.
pub(crate) fn in_use(what: &str) -> PyErr {
    PyRuntimeError::new_err(format!(
        "this {what} is in use in another thread; each thread needs one of its own"
    ))
}
