//! Mechanical systems described with `coadjoint`; the program of that name runs, plots and shows them.
//!
//! A system is one file holding its annotated struct and the example it is shown with, plus its line in the `catalogue`.
//! Everything else here treats all systems alike.
//!
//! * `catalogue`: all systems as entries of the program, which is `coadjoint_app`
//! * `applications`: identification, steering and estimation with the exact derivatives of steps
//! * [`classical`]: the integrators that ours are compared with
//! * [`guide`]: the figures that the program draws, and when a structure-preserving step pays
//!
//! The feature `program` (on by default) is for the program; without it there are only the systems and the classical integrators, and few
//! dependencies. The feature `bench` adds what `coadjoint bench` times.

pub use coadjoint_classical as classical;

pub mod affine_body;
pub mod coupled_bodies;
#[cfg(feature = "program")]
pub mod double_pendulum;
pub mod driven_pendulum;
pub mod ellipsoidal_fluid;
pub mod four_dimensional_body;
pub mod free_rigid_body;
pub mod full_rigid_body;
pub mod guide;
pub mod gyrostat;
pub mod hanging_plate;
pub mod harmonic_oscillator;
pub mod heavy_top;
pub mod heavy_top_on_se3;
pub mod kepler;
pub mod kirchhoff;
pub mod magnetic_top;
pub mod navigation;
pub mod nuclear_spin;
pub mod planar_pendulum;
pub mod quadrotor;
pub mod rigid_body_in_space;
pub mod satellite_with_wheels;
pub mod spherical_pendulum;
pub mod spin_chain;
pub mod three_level_atom;
pub mod two_bodies;

#[cfg(feature = "program")]
pub mod applications;
#[cfg(feature = "bench")]
pub mod cases;
#[cfg(feature = "program")]
pub mod catalogue;
