//! Modules for systems that are compiled ahead.

use coadjoint::erased::EnsembleSystem;
use pyo3::prelude::*;

use crate::system::Model;

/// Adds a system that is compiled ahead to a module, under the struct's name: what [`module!`](crate::module) calls.
///
/// # Errors
/// If the package `coadjoint` cannot be imported.
pub fn add<S>(module: &Bound<'_, PyModule>) -> PyResult<()>
where
    S: coadjoint::System<Scalar = f64> + EnsembleSystem,
{
    let py = module.py();
    let made = py.import("coadjoint._system")?.getattr("compiled")?;
    let system = made.call1((Py::new(py, Model::compiled::<S>())?, module.name()?))?;
    module.add(S::NAME, system)
}

/// A Python module with systems of your own, compiled ahead: its name, and the structs.
///
/// ```ignore
/// use coadjoint::prelude::*;
///
/// #[lie_poisson_system(group = SO3)]
/// pub struct Body {
///     #[inertia]
///     pub inertia: Vector3<f64>,
/// }
///
/// coadjoint_python::module!(my_bodies: Body);
/// ```
///
/// In Python they are what `co.System` makes of a text: `my_bodies.Body(inertia=[1, 2, 3]).run(…)`. `python/examples/compiled` is a whole package.
#[macro_export]
macro_rules! module {
    ($name:ident: $($system:ty),+ $(,)?) => {
        /// The module that Python imports.
        #[$crate::pyo3::pymodule]
        #[pyo3(crate = "::coadjoint_python::pyo3")]
        fn $name(module: &$crate::pyo3::Bound<'_, $crate::pyo3::types::PyModule>) -> $crate::pyo3::PyResult<()> {
            $($crate::add::<$system>(module)?;)+
            Ok(())
        }
    };
}
