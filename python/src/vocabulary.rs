//! Words for schemes, of the generator's tables.

use pyo3::prelude::*;

macro_rules! retractions {
    ($($(#[$_doc:meta])* $name:ident {
        is_odd: $_is_odd:literal,
        is_matrix_function: $_is_matrix_function:literal,
        spoken: $_spoken:literal,
        word: $word:literal,
        short: $_short:literal,
        about: $_about:literal
    })*) => {
        const RETRACTIONS: &[(&str, &str)] = &[$(($word, stringify!($name))),*];
    };
}
coadjoint_macros::retractions!(retractions);

macro_rules! methods {
    (
        share { $($(#[$_share_doc:meta])* $_share:ident {
            word: $_share_word:literal,
            about: $_share_about:literal,
            is_symplectic: $_share_is_symplectic:literal,
            is_one_map: $_is_one_map:literal,
            named: { $($(#[$_doc:meta])* $name:ident($_n:literal, $_d:literal) {
                word: $word:literal, about: $_about:literal
            })* }
        })* }
        order { $($_order:tt)* }
    ) => {
        const STEPS: &[(&str, &str)] = &[$($(($word, stringify!($name)),)*)* ("verlet", "StormerVerlet")];
    };
}
coadjoint_macros::methods!(methods);

/// The words for retractions, and the library's names.
#[pyfunction]
pub(crate) fn retractions() -> Vec<(&'static str, &'static str)> {
    RETRACTIONS.to_vec()
}

/// The words for steps on a retraction that need no number, and the library's names.
#[pyfunction]
pub(crate) fn steps() -> Vec<(&'static str, &'static str)> {
    STEPS.to_vec()
}
