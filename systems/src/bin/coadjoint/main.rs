//! The program `coadjoint`: runs the systems of the catalogue, draws and shows them.
//!
//! It contains no mechanics, and treats all systems alike.
// they panic where the stream is closed
#![warn(clippy::print_stdout, clippy::print_stderr)]

mod checkpoint;
mod cli;
mod command;
mod config;
mod error;
mod figures;
mod html_player;
mod interrupt;
mod output;
mod plot;
mod progress;
mod report;
mod run_plot;
mod session;
mod setting;
mod suggest;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
