//! A program for systems described with [`coadjoint`]: it runs and plots them, shows them moving in three dimensions,
//! makes ensembles of them and measures the claims of their steps.
//!
//! ```no_run
//! use coadjoint::prelude::*;
//! use coadjoint_app::Example;
//!
//! /// A pendulum that swings in a plane.
//! #[lie_poisson_system(group = SO2, potential = -weight * length * angle.cos_angle(), methods(Midpoint))]
//! struct Pendulum {
//!     /// Moment of inertia about the pivot, kg m².
//!     #[inertia]
//!     inertia: f64,
//!     /// N.
//!     weight: f64,
//!     /// From the pivot to the centre of mass, m.
//!     length: f64,
//! }
//!
//! impl Example for Pendulum {
//!     fn example() -> (Self, PendulumState) {
//!         let pendulum = Pendulum { inertia: 0.1, weight: 9.81, length: 0.3 };
//!         (pendulum, PendulumState { angle: UnitComplex::new(1.0), momentum: vector![0.0] })
//!     }
//! }
//!
//! fn main() -> std::process::ExitCode {
//!     coadjoint_app::main([Pendulum::entry()])
//! }
//! ```
//!
//! Then `cargo run --release -- run pendulum --plot`, `view pendulum`, `ensemble pendulum`, `certify pendulum`, `list`.
//!
//! The program offers what was generated: `methods(Midpoint)` adds its method `midpoint`, `retractions(Cayley)` leaves
//! the exponential out.
//!
//! The feature `program`, on by default, is all of it; without it there is only the trait [`Example`], for libraries of
//! systems. Pictures are SVG and, with the feature `png`, on by default too, PNG.
#![cfg_attr(not(feature = "program"), allow(rustdoc::broken_intra_doc_links))]
// they panic where the stream is closed
#![warn(clippy::print_stdout, clippy::print_stderr)]

// each layer uses those above it alone
#[cfg(feature = "program")]
pub mod error;
#[cfg(feature = "program")]
pub mod units;

pub mod catalogue;

#[cfg(feature = "program")]
pub mod setup;

#[cfg(feature = "program")]
pub mod record;

#[cfg(feature = "program")]
pub mod simulate;

#[cfg(feature = "program")]
pub mod picture;

pub mod scene;

#[cfg(feature = "program")]
pub mod page;

#[cfg(feature = "program")]
pub mod files;

#[cfg(feature = "program")]
pub mod cli;

#[cfg(all(test, feature = "program"))]
mod tests;

pub use catalogue::{Example, Observables, shape};
#[cfg(feature = "program")]
pub use {
    catalogue::{BuildFn, Catalogue, Entry, Observable},
    clap,
    cli::App,
    error::Error,
    files::Trajectory,
};

/// The guide's page, whose code is compiled here.
#[cfg(all(doctest, feature = "program"))]
#[doc = include_str!("../../runtime/src/guide/your_program.md")]
mod your_program {}

/// A program for these systems, with the arguments it was started with.
#[cfg(feature = "program")]
pub fn main(entries: impl IntoIterator<Item = Entry>) -> std::process::ExitCode {
    App::new(entries).main()
}
