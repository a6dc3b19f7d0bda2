//! The program `coadjoint`: `coadjoint_app` for the systems of the catalogue, with the paper's figures and the benchmarks.
// they panic where the stream is closed
#![warn(clippy::print_stdout, clippy::print_stderr)]

mod command;
mod figures;

use std::process::ExitCode;

use coadjoint_app::App;

/// Without a command it runs the paper's heavy top.
fn main() -> ExitCode {
    App::new(coadjoint_systems::catalogue::entries())
        .command(
            "bench",
            "Time the steps of the standard cases against classical methods",
            command::bench::bench,
        )
        .command("figures", "Draw the paper's figures, and five of our own", command::figures::figures)
        .command(
            "paper",
            "The paper's heavy top: 30 minutes, both retractions, a table and a figure",
            command::paper::paper,
        )
        .default_command("paper")
        .main()
}
