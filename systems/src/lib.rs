//! Mechanical systems described with `coadjoint`, and the program that runs, plots and shows them.
//!
//! A system is one file holding its annotated struct and the example it is shown with, plus its line in the
//! [`catalogue`]. Everything else here treats all systems alike and contains no mechanics.

pub mod catalogue;
pub mod cli;
mod command;
pub mod error;
pub mod output;
pub mod plot;
mod progress;
pub mod report;
pub mod setting;
pub mod simulation;
mod suggest;

pub mod free_rigid_body;
pub mod heavy_top;
