//! The native half of the Python package `coadjoint`: systems from text, their steps, runs and ensembles, on arrays of numpy.
//!
//! Everything here takes and gives flat arrays of `f64`; names, shapes and words of scipy are the other half's, in `python/coadjoint`. While steps are
//! taken, Python's lock is released, and signals are looked for every few hundredths of a second.

mod catalogue;
mod cuda;
mod ensemble;
mod error;
mod module;
mod numbers;
mod run;
mod statistics;
mod stepper;
mod system;
mod vocabulary;
mod watch;

pub use module::add;
pub use pyo3;

/// The module that the package imports.
#[pyo3::pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::catalogue::catalogue;
    #[pymodule_export]
    use crate::cuda::cuda;
    #[pymodule_export]
    use crate::ensemble::Ensemble;
    #[pymodule_export]
    use crate::statistics::Statistics;
    #[pymodule_export]
    use crate::stepper::Stepper;
    #[pymodule_export]
    use crate::system::{Model, System};
    #[pymodule_export]
    use crate::vocabulary::{retractions, steps};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
