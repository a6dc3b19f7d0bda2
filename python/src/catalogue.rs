//! The catalogue: the texts of its systems.

use pyo3::prelude::*;

/// Texts of files of the folder `systems/src`, and their names.
macro_rules! texts {
    ($($name:ident)*) => {
        &[$((stringify!($name), include_str!(concat!("../../systems/src/", stringify!($name), ".rs")))),*]
    };
}

const TEXTS: &[(&str, &str)] = texts! {
    affine_body coupled_bodies double_pendulum driven_pendulum ellipsoidal_fluid four_dimensional_body
    free_rigid_body full_rigid_body gyrostat hanging_plate harmonic_oscillator heavy_top heavy_top_on_se3 kepler
    kirchhoff magnetic_top navigation nuclear_spin planar_pendulum quadrotor rigid_body_in_space
    satellite_with_wheels spherical_pendulum spin_chain three_level_atom two_bodies
};

/// The names and the texts of the catalogue's systems.
#[pyfunction]
pub(crate) fn catalogue() -> Vec<(&'static str, &'static str)> {
    TEXTS.to_vec()
}
