//! The text of a kernel for CUDA that takes steps of many members.

use coadjoint::composition::{Coefficients, KahanLi6, KahanLi8, SofroniouSpaletta10, Suzuki4};
use coadjoint_codegen::emit::c99::{Options, Steps, header};
use coadjoint_codegen::source::Source;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::error;
use crate::system::scheme;

/// Room for what derives a description: within its bounds the generator needs less than 2 MB.
const STACK: usize = 16 << 20;

/// The scheme that is composed, and with which coefficients.
fn composed(name: &str) -> (&str, &'static [f64]) {
    let sets: [(&str, &'static [f64]); 4] = [
        ("Order4<", Suzuki4::GAMMA),
        ("Order6<", KahanLi6::GAMMA),
        ("Order8<", KahanLi8::GAMMA),
        ("Order10<", SofroniouSpaletta10::GAMMA),
    ];
    let of = |(order, gamma): (&str, &'static [f64])| {
        Some((name.strip_prefix(order)?.strip_suffix('>')?.trim(), gamma))
    };
    sets.into_iter().find_map(of).unwrap_or((name, &[]))
}

/// The header of a description's steps with a scheme, and what the names in it begin with.
#[pyfunction]
#[pyo3(signature = (text, scheme, name=None))]
pub(crate) fn cuda(
    py: Python<'_>,
    text: &str,
    scheme: &str,
    name: Option<&str>,
) -> PyResult<(String, String)> {
    let known = self::scheme(scheme)?.to_string();
    let (base, gamma) = composed(&known);
    let steps = Steps { scheme: base.to_owned(), gamma: gamma.to_vec() };
    let made = || -> Result<(String, String), String> {
        let tokens = text.parse().map_err(|error: proc_macro2::LexError| error.to_string())?;
        let derived =
            coadjoint_codegen::derived(&Source::find(tokens), name).map_err(|error| error.to_string())?;
        let constants = derived.constants;
        let options = Options { steps: vec![steps], kernels: true, constants, ..Options::default() };
        let prefix = options.prefixes(&derived.program.interface.name).swap_remove(0);
        header(&derived.program, &options).map(|text| (text, prefix)).map_err(|error| error.to_string())
    };
    py.detach(|| {
        std::thread::scope(|scope| {
            let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, made);
            thread.map(std::thread::ScopedJoinHandle::join)
        })
    })
    .map_err(error::value)?
    .map_err(|_| PyRuntimeError::new_err("the description could not be derived"))?
    .map_err(PyValueError::new_err)
}
