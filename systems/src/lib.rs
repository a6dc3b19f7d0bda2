//! Mechanical systems described with `coadjoint`, and the program that runs, plots and shows them.
//!
//! A system is one file holding its annotated struct and the example it is shown with, plus its line in the program's
//! `catalogue`. Everything else here treats all systems alike and contains no mechanics.
//!
//! The feature `program` (on by default) is for the program; without it there are only the systems, and few dependencies.

pub mod catalogued;
pub mod classical;
pub mod coupled_bodies;
pub mod driven_pendulum;
pub mod free_rigid_body;
pub mod full_rigid_body;
pub mod gyrostat;
pub mod harmonic_oscillator;
pub mod heavy_top;
pub mod kepler;
pub mod kirchhoff;
pub mod magnetic_top;
pub mod planar_pendulum;
pub mod quadrotor;
pub mod rigid_body_in_space;
pub mod spherical_pendulum;

#[cfg(feature = "program")]
pub mod catalogue;
#[cfg(feature = "program")]
mod checkpoint;
#[cfg(feature = "program")]
pub mod cli;
#[cfg(feature = "program")]
mod command;
#[cfg(feature = "program")]
mod config;
#[cfg(feature = "program")]
pub mod error;
#[cfg(feature = "program")]
pub mod figures;
#[cfg(feature = "program")]
mod film;
#[cfg(feature = "program")]
mod interrupt;
#[cfg(feature = "program")]
pub mod ledger;
#[cfg(feature = "program")]
pub mod output;
#[cfg(feature = "program")]
pub mod plot;
#[cfg(feature = "program")]
pub mod portrait;
#[cfg(feature = "program")]
mod progress;
#[cfg(feature = "program")]
pub mod report;
#[cfg(feature = "program")]
mod session;
#[cfg(feature = "program")]
pub mod setting;
#[cfg(feature = "program")]
pub mod simulation;
#[cfg(feature = "program")]
mod suggest;
