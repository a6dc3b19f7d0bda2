//! The command line.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

use crate::command;
use crate::error::Error;
use crate::output::Format;
use coadjoint_systems::simulation::{Method, Order, Retraction};

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
    /// Go on with a run that was interrupted
    Resume(ResumeArguments),
    /// Run a system and write a page that shows it moving
    View(RunArguments),
    /// Write a file that describes a run, to be changed and given to `run --config`
    Init(InitArguments),
    /// Run many members of a system at once, and draw how they spread
    Ensemble(EnsembleArguments),
    /// Print the code generated for a system
    Show(ShowArguments),
    /// Measure what the schemes claim of their steps of a system
    Certify(CertifyArguments),
    /// Time the steps of the standard cases against classical methods
    Bench(BenchArguments),
    /// Draw the paper's figures, and five of our own
    Figures(FiguresArguments),
}

/// Which run to make, and where to write it.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: Option<String>,
    /// A TOML file that describes the run; options given here take precedence
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// The map that the step is built on; `exp` for short [default: exponential]
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
    /// What the step makes of it [default: standard], or a classical method to compare with, by the system's vector field: these have no
    /// retraction and an order of their own, and are not fast; with most of those in stored numbers rotations drift off their group
    #[arg(long)]
    pub(crate) method: Option<Method>,
    /// The order: steps of order 2, or symmetric compositions of them [default: 2]
    #[arg(long, value_enum)]
    pub(crate) order: Option<Order>,
    #[command(flatten)]
    pub(crate) motion: MotionArguments,
    /// Write the state after every N-th step [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: Option<u64>,
    /// Draw the run too: what moves, and the errors of what is conserved
    #[arg(long)]
    pub(crate) plot: bool,
    /// Write a page that shows the run moving, to be opened in a browser
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,
    /// Keep a checkpoint here, so that `coadjoint resume FILE` can go on if the run is interrupted
    #[arg(long, value_name = "FILE")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// The format of the trajectory [default: csv]
    #[arg(long, value_enum)]
    pub(crate) format: Option<Format>,
}

/// What every motion needs.
#[derive(Debug, Args)]
pub(crate) struct MotionArguments {
    /// Set a parameter or a part of the initial state: `weight=9.81`, `chi=0,0,0.3`, `momentum_z=5`; or a control, to be held in place of
    /// what the system's own law chooses: `thrust=9`
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) set: Vec<String>,
    /// The step, s; negative to go back in time [default: the system's own]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    pub(crate) step: Option<f64>,
    /// How long to run, s [default: the system's own]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(crate) duration: Option<f64>,
    /// The directory to write to
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub(crate) out: PathBuf,
}

/// Which run to go on with.
#[derive(Debug, Args)]
pub(crate) struct ResumeArguments {
    /// Its checkpoint
    pub(crate) checkpoint: PathBuf,
}

/// Which file to write.
#[derive(Debug, Args)]
pub(crate) struct InitArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: String,
    /// Where to write it [default: `<system>.toml`]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Replace a file that is there
    #[arg(long)]
    pub(crate) force: bool,
}

/// Which ensemble to run.
#[derive(Debug, Args)]
pub(crate) struct EnsembleArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: String,
    /// How many members
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) members: u64,
    /// What differs between members, evenly within plus or minus the width: `momentum_z=0.01`, `inertia=2%`, `chi=0,0,0.1`
    /// [default: momentum=1%]
    #[arg(long, value_name = "NAME=WIDTH")]
    pub(crate) spread: Vec<String>,
    #[command(flatten)]
    pub(crate) motion: MotionArguments,
    /// What to show: `energy` or a component of the state [default: the momentum]
    #[arg(long, value_name = "NAME")]
    pub(crate) quantity: Vec<String>,
    /// Look at the members after every N-th step [default: 300 times in all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: Option<u64>,
    /// Another seed draws other members
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub(crate) seed: u64,
}

/// What to do with the times.
#[derive(Debug, Args)]
pub(crate) struct BenchArguments {
    /// Write them to this file too
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
}

/// Which figures to draw.
#[derive(Debug, Args)]
pub(crate) struct FiguresArguments {
    /// By number or name [default: all]
    pub(crate) figures: Vec<String>,
    /// The directory to write to
    #[arg(long, value_name = "DIR", default_value = "out/figures")]
    pub(crate) out: PathBuf,
}

/// Which code to show.
#[derive(Debug, Args)]
pub(crate) struct ShowArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: String,
    /// Only the step built on this map; `exp` for short
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
    /// The code of the steps' derivatives, too
    #[arg(long)]
    pub(crate) derivatives: bool,
}

/// Which steps to certify.
#[derive(Debug, Args)]
pub(crate) struct CertifyArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: String,
    /// Only this method, in place of the standard one and the midpoint
    #[arg(long)]
    pub(crate) method: Option<Method>,
    /// Only the steps built on this map; `exp` for short
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
}

/// Runs the program with the arguments it was started with.
pub(crate) fn main() -> ExitCode {
    let command_line = CommandLine::parse();
    match run(&command_line, &mut io::stdout().lock()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is_broken_pipe() => ExitCode::SUCCESS,
        // the message has been printed
        Err(Error::Interrupted) => ExitCode::from(Error::Interrupted.exit_code()),
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
        Some(Command::Resume(arguments)) => command::run::resume(arguments, console)?,
        Some(Command::View(arguments)) => command::run::view(arguments, console)?,
        Some(Command::Init(arguments)) => {
            let entry = crate::suggest::system(&arguments.system)?;
            let path = arguments.out.clone().unwrap_or_else(|| format!("{}.toml", entry.name).into());
            command::run::init(entry, &path, arguments.force, console)?;
        }
        Some(Command::Ensemble(arguments)) => command::ensemble::ensemble(arguments, console)?,
        #[cfg(feature = "bench")]
        Some(Command::Bench(arguments)) => command::bench::bench(arguments, console)?,
        #[cfg(not(feature = "bench"))]
        Some(Command::Bench(_)) => {
            return Err(Error::Input(
                "this program was built without its benchmarks: `cargo run --profile bench --features bench -- bench` builds and runs them"
                    .to_owned(),
            ));
        }
        Some(Command::Figures(arguments)) => command::figures::figures(arguments, console)?,
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
