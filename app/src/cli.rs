//! The command line.

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::command::{certify, ensemble, init, list, play, run};
use crate::entry::{Catalogue, Entry};
use crate::error::Error;

/// Runs structure-preserving steppers of mechanical systems.
#[derive(Debug, Parser)]
#[command(version)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the systems, their parameters and their initial states
    List,
    /// Run a system and write its trajectory
    Run(run::RunArguments),
    /// Go on with a run that was interrupted
    Resume(run::ResumeArguments),
    /// Run a system and write a page that shows it moving
    View(run::RunArguments),
    /// Write a page that shows data of any program's moving
    Play(play::PlayArguments),
    /// Write a file that describes a run, to be changed and given to `run --config`
    Init(init::InitArguments),
    /// Run many members of a system at once, and draw how they spread
    Ensemble(ensemble::EnsembleArguments),
    /// Print the code generated for a system
    #[cfg(feature = "show")]
    Show(crate::command::show::ShowArguments),
    /// Measure what the schemes claim of their steps of a system
    Certify(certify::CertifyArguments),
}

/// What runs a command of the program's own.
type RunFn = Box<dyn Fn(Catalogue, &ArgMatches, &mut dyn Write) -> Result<(), Error>>;

/// A program for some systems: [`main`](crate::main), with commands of its own.
pub struct App {
    catalogue: Catalogue,
    commands: Vec<(clap::Command, RunFn)>,
    default: Option<RunFn>,
}

impl std::fmt::Debug for App {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("App").field("catalogue", &self.catalogue).finish_non_exhaustive()
    }
}

impl App {
    /// A program for these systems.
    pub fn new(entries: impl IntoIterator<Item = Entry>) -> Self {
        Self { catalogue: Catalogue::new(entries), commands: Vec::new(), default: None }
    }

    /// With one more command, of this name, with a line about it: what runs it gets its arguments, and writes to the console.
    #[must_use]
    pub fn command<A: clap::Args + 'static>(
        mut self,
        name: &'static str,
        about: &'static str,
        run: fn(Catalogue, &A, &mut dyn Write) -> Result<(), Error>,
    ) -> Self {
        let command = A::augment_args(clap::Command::new(name)).about(about);
        let run: RunFn = Box::new(move |catalogue, matches, console| {
            let arguments = A::from_arg_matches(matches).unwrap_or_else(|error| error.exit());
            run(catalogue, &arguments, console)
        });
        self.commands.push((command, run));
        self
    }

    /// What it does without a command, in place of showing its help.
    #[must_use]
    pub fn without_command(self, run: fn(Catalogue, &mut dyn Write) -> Result<(), Error>) -> Self {
        Self { default: Some(Box::new(move |catalogue, _, console| run(catalogue, console))), ..self }
    }

    /// Runs the program with the arguments it was started with; its exit code says how it went: 0 well, 2 wrong input, 3 a motion that cannot
    /// be computed, 4 output that cannot be written, 130 ended by Ctrl-C, 1 a bug.
    pub fn main(self) -> ExitCode {
        match self.run(std::env::args_os(), &mut io::stdout().lock()) {
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

    /// All commands, as clap knows them.
    fn parser(&self) -> clap::Command {
        let own = self.commands.iter().map(|(arguments, _)| arguments.clone());
        CommandLine::command()
            .name(program())
            .subcommands(own)
            .subcommand_required(self.default.is_none())
            .arg_required_else_help(self.default.is_none())
    }

    fn run(
        &self,
        arguments: impl IntoIterator<Item = OsString>,
        console: &mut dyn Write,
    ) -> Result<(), Error> {
        let matches = self.parser().get_matches_from(arguments);
        let own = matches.subcommand().and_then(|(name, matches)| {
            let own = self.commands.iter().find(|(arguments, _)| arguments.get_name() == name);
            own.map(|(_, run)| (run, matches))
        });
        match (own, &self.default, matches.subcommand_name()) {
            (Some((run, matches)), ..) => run(self.catalogue, matches, console)?,
            (None, Some(run), None) => run(self.catalogue, &matches, console)?,
            _ => {
                let line = CommandLine::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
                line.command.run(self.catalogue, console)?;
            }
        }
        Ok(console.flush()?)
    }
}

impl Command {
    fn run(&self, catalogue: Catalogue, console: &mut dyn Write) -> Result<(), Error> {
        match self {
            Command::List => list::list(catalogue, console),
            Command::Run(arguments) => run::run(catalogue, arguments, console),
            Command::Resume(arguments) => run::resume(catalogue, arguments, console),
            Command::View(arguments) => run::view(catalogue, arguments, console),
            Command::Play(arguments) => play::play(arguments, console),
            Command::Init(arguments) => init::init(catalogue, arguments, console),
            Command::Ensemble(arguments) => ensemble::ensemble(catalogue, arguments, console),
            #[cfg(feature = "show")]
            Command::Show(arguments) => crate::command::show::show(catalogue, arguments, console),
            Command::Certify(arguments) => certify::certify(catalogue, arguments, console),
        }
    }
}

/// The name by which the program was started, for messages that say what to type.
pub(crate) fn program() -> String {
    let path = std::env::args_os().next().unwrap_or_default();
    Path::new(&path)
        .file_stem()
        .map_or_else(|| "coadjoint".to_owned(), |name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        App::new([]).parser().debug_assert();
    }
}
