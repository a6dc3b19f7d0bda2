//! The command line.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

use crate::command;
use crate::error::Error;
use crate::output::Format;
use crate::simulation::{Method, Order, Retraction};

/// Runs structure-preserving steppers of mechanical systems.
///
/// Without a command: the heavy top for 30 minutes of its motion with both retractions, as a table, trajectories and a
/// picture under `out/`.
#[derive(Debug, Parser)]
#[command(name = "coadjoint", version)]
struct CommandLine {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the systems, their parameters and their initial states
    List,
    /// Run a system and write its trajectory
    Run(RunArguments),
    /// Print the code generated for a system
    Show(ShowArguments),
    /// Measure what the schemes claim of their steps of a system
    Certify(CertifyArguments),
}

/// Which run to make, and where to write it.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: String,
    /// The map that the step is built on; `exp` for short
    #[arg(long, value_enum, default_value = "exponential")]
    pub(crate) retraction: Retraction,
    /// What the step makes of it
    #[arg(long, value_enum, default_value = "standard")]
    pub(crate) method: Method,
    /// The order: steps of order 2, or symmetric compositions of them
    #[arg(long, value_enum, default_value = "2")]
    pub(crate) order: Order,
    /// The step, s; negative to go back in time [default: the system's own]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    pub(crate) step: Option<f64>,
    /// How long to run, s [default: the system's own]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(crate) duration: Option<f64>,
    /// Write the state after every N-th step
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: u64,
    /// Set a parameter or a part of the initial state: `weight=9.81`, `chi=0,0,0.3`, `momentum_z=5`
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) set: Vec<String>,
    /// Draw the run too: what moves, and the errors of what is conserved
    #[arg(long)]
    pub(crate) plot: bool,
    /// The directory to write to
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub(crate) out: PathBuf,
    /// The format of the trajectory
    #[arg(long, value_enum, default_value = "csv")]
    pub(crate) format: Format,
}

/// Which code to show.
#[derive(Debug, Args)]
pub(crate) struct ShowArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: String,
    /// Only the step built on this map; `exp` for short
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
}

/// Which steps to certify.
#[derive(Debug, Args)]
pub(crate) struct CertifyArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: String,
    /// Only this method, in place of the standard one and the midpoint
    #[arg(long, value_enum)]
    pub(crate) method: Option<Method>,
    /// Only the steps built on this map; `exp` for short
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
}

/// Runs the program with the arguments it was started with.
pub fn main() -> ExitCode {
    let command_line = CommandLine::parse();
    match run(&command_line, &mut io::stdout().lock()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is_broken_pipe() => ExitCode::SUCCESS,
        Err(error) => {
            // if standard error is closed too, the exit code still speaks
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn run(command_line: &CommandLine, console: &mut dyn Write) -> Result<(), Error> {
    match &command_line.command {
        None => command::paper::paper(console)?,
        Some(Command::List) => command::list::list(console)?,
        Some(Command::Run(arguments)) => command::run::run(arguments, console)?,
        Some(Command::Show(arguments)) => command::show::show(arguments, console)?,
        Some(Command::Certify(arguments)) => command::certify::certify(arguments, console)?,
    }
    Ok(console.flush()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        CommandLine::command().debug_assert();
    }
}
